"""``dummydesign tissues``: list, show, add a tissue from traces, or update one by points read off figures."""

from __future__ import annotations

import argparse
from importlib import import_module
from typing import Any

from dummydesign.cli import text
from dummydesign.cli.common_options import ACTIONS, add_own_actions, call, render_own, run_own
from dummydesign.cli.text import file_lines, labelled, screen, warning_lines
from dummydesign.core.errors import InputError
from dummydesign.core.tables import Table

HELP = "List the known tissues, show one with all its numbers and sources, and add, rename or remove your own."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    words = "list|show|add|add-curves|add-points|add-spring|template|add-regions|remove|rename|path"
    actions = parser.add_subparsers(dest="action", metavar=words, help="what to do")
    actions.add_parser("list", help="names, origin and kind of the known tissues")
    show = actions.add_parser("show", help="every number of one tissue with its interval and source")
    show.add_argument("name", metavar="NAME", help="a known tissue or a TOML file")
    add = actions.add_parser("add", help="make a tissue from traces or from fits, one subject per file or folder")
    add.add_argument("name", metavar="NAME", help="name of the new tissue")
    add.add_argument(
        "files", nargs="+", metavar="FILE", help="trace NAME_....csv, folder of one subject or more, or fit TOML"
    )
    add.add_argument(
        "--law", default="ode", help="ode (default), consistent or published; none keeps the curves, auto decides"
    )
    add.add_argument("--elements", default="5", help="3, 5 or 7 (default 5)")
    add.add_argument("--lowpass", metavar="HZ[:ORDER[:PASSES]]", help="filter of the recorded force")
    add.add_argument("--replace", action="store_true", help="take the place of a tissue of your own with this name")
    curves = actions.add_parser("add-curves", help="make a tissue from one table of several people's curves")
    curves.add_argument("name", metavar="NAME", help="name of the new tissue")
    columns = "columns subject,velocity_mm_s,time_s,depth_mm,force_N; a hold with its times is needed"
    curves.add_argument("table", metavar="FILE.csv", help=columns)
    law = "auto (default: ode where it follows the curves, else none), none (the curves themselves), "
    curves.add_argument("--law", default="auto", help=law + "ode, consistent or published")
    curves.add_argument("--elements", default="5", help="3, 5 or 7 (default 5)")
    curves.add_argument("--replace", action="store_true", help="take the place of a tissue of your own with this name")
    points = actions.add_parser("add-points", help="update a tissue by points read off figures")
    points.add_argument("name", metavar="NAME", help="the tissue to update")
    points.add_argument("points", metavar="POINTS.csv", help="columns subject,depth_mm,force_N")
    spring = actions.add_parser("add-spring", help="make a tissue of one spring constant with its spread")
    spring.add_argument("name", metavar="NAME", help="name of the new tissue")
    spring.add_argument("--stiffness", required=True, metavar="N_PER_MM", help="spring constant, such as 35 or 35kN/m")
    spring.add_argument("--spread", metavar="N_PER_MM", help="plus and minus, in N/mm or percent (20%%)")
    spring.add_argument("--source", required=True, metavar="TEXT", help="where the numbers were read")
    spring.add_argument("--kind", default="digitised", help="measured, fitted, digitised (default), inferred, assumed")
    template = actions.add_parser("template", help="write a table of body regions to fill from your copy of a standard")
    template.add_argument("path", metavar="FILE.csv", help="file to write")
    regions = actions.add_parser("add-regions", help="make a tissue of every filled row of such a table")
    regions.add_argument("table", metavar="FILE.csv", help="columns region,stiffness_N_per_mm,spread_N_per_mm,source")
    for one in (spring, regions):
        one.add_argument("--replace", action="store_true", help="take the place of your own of these names")
    add_own_actions(actions, "tissue")


ADDING = {
    "add": ("from_traces", "add_tissue"),
    "add-curves": ("from_traces", "add_curves"),
    "add-points": ("from_points", "add_points"),
    "add-spring": ("from_springs", "add_spring"),
    "template": ("from_springs", "write_template"),
    "add-regions": ("from_springs", "add_regions"),
}
"""Module and function of each action that makes or changes a tissue."""


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Run the chosen action."""
    if options.action in ACTIONS:
        return run_own(options, "materials/tissues", "tissue")
    if options.action == "list":
        return _list()
    if options.action == "show":
        return _show(options.name)
    if options.action in ADDING:
        module, function = ADDING[options.action]
        add = getattr(import_module(f"dummydesign.tissue.adding.{module}"), function)
        return call(add, options, **({"replace_own": options.replace} if "replace" in options else {}))
    raise InputError(
        "tissues needs an action: list, show NAME, add NAME FILE..., add-curves NAME FILE.csv, "
        "add-points NAME POINTS.csv, add-spring NAME, template FILE.csv, add-regions FILE.csv, "
        "remove NAME, rename OLD NEW or path NAME",
        "missing",
        "action",
    )


def _list() -> dict[str, Any]:
    from dummydesign.tissue.model.maxwell_law import law_named
    from dummydesign.tissue.model.tissue_file import readable_tissues

    tissues, problems = readable_tissues()
    warnings = [{"code": "unreadable_tissue", "message": problem} for problem in problems]
    rows = []
    for tissue in tissues:
        steady = next(iter(tissue.bands)) if tissue.measured else law_named(tissue.law).steady_name
        gamma1 = tissue.bands[steady]
        known = {name: getattr(tissue, name) for name in ("name", "title", "origin", "law", "elements")}
        rows.append(
            {
                **known,
                "kinds": list(tissue.kinds),
                "subjects": [one.name for one in tissue.subjects],
                "velocities_mm_s": list(tissue.velocities_mm_s),
                steady: [gamma1.low, gamma1.high],
            }
        )
    return {"inputs": {"action": "list"}, "tissues": rows, "warnings": warnings}


def _show(name: str) -> dict[str, Any]:
    from dummydesign.tissue.model.tissue_file import load_tissue

    tissue = load_tissue(name)
    inferred = {"code": "inferred_tissue", "message": tissue.notes[0] if tissue.notes else "inferred"}
    warnings = [inferred] if "inferred" in tissue.kinds else []
    return {"inputs": {"action": "show", "name": name}, **tissue.to_dict(), "warnings": warnings}


def render(result: dict[str, Any]) -> str:
    """Bands of the parameters and the subjects on one screen; other actions are short as they are."""
    if "bands" not in result:
        return render_details(result)
    rows = render_details(result).splitlines()
    words = "subject ", "note: ", "source: ", "warning: ", "what would narrow"
    files = set(file_lines({"files": {}, **result}))
    shown = [row for row in rows[1:] if not row.startswith(words) and row not in files]
    people = [row.removeprefix("subject ") for row in rows if row.startswith("subject ")]
    if result["law"] != "curves":
        people = [f"{row.partition(', ')[0]})" if "(" in row else row for row in people]
    shown += ["", *(f"  {row}" for row in people)]
    left = [one for one in result["warnings"] if one["message"] not in result["notes"]]
    following = result["next_measurement"]["text"] if "next_measurement" in result else ""
    return screen(
        labelled("TISSUE", rows[0]),
        shown,
        [""],
        text.notes_block(result["notes"]),
        text.warning_block({"warnings": left}, most=2),
        labelled("NEXT", following, 2),
        text.files_block(result, ()),
        labelled("MORE", "--details: where every number comes from, all notes"),
    )


LISTED = {
    "tissue": "name:<14",
    "origin": "origin:<9",
    "kind": "kind:<20",
    "law": "law:<11",
    "subjects": "people:>8",
    " gamma1 N/mm3, or k N/mm": "steady:<1",
}
BANDS = {
    "parameter": "label:<26",
    "mean": "value:>10.4g",
    "lowest": "low:>10.4g",
    "highest": "high:>10.4g",
    " kind": "kind:<1",
}


def render_details(result: dict[str, Any]) -> str:
    """Make the readable table."""
    from dummydesign.core.serialise import parameter_rows

    own = render_own(result)
    if own is not None:
        return own
    if "regions" in result:
        return f"fill and read by 'dummydesign tissues add-regions': {result['files']['template']}"
    if "added" in result:
        lines = [
            f"{row['name']:<14} {' / '.join(f'{k:.4g}' for k in row['k_N_per_mm'])} N/mm" for row in result["added"]
        ]
        return "\n".join(lines + warning_lines(result))
    if "tissues" in result:
        rows = []
        for row in result["tissues"]:
            name, (low, high) = list(row.items())[-1]
            at = f" mm at {name.removeprefix('depth_at_').removesuffix('_mm')}" if name.startswith("depth_at_") else ""
            rows.append(
                {
                    **row,
                    "kind": "+".join(row["kinds"]),
                    "people": len(row["subjects"]),
                    "steady": f" {low:.3g} to {high:.3g}{at}",
                }
            )
        return "\n".join(Table.of(rows, LISTED).lines(indent="") + warning_lines(result))
    measured = result["law"] == "curves"
    law = "measured curves, no law" if measured else f"law {result['law']}"
    lines = [f"{result['name']} ({result['title']}), {result['origin']}, {law}"]
    lines += [note for note in result["notes"] if measured]
    bands = [{"label": label, **one, "kind": f" {one['kind']}"} for label, one in parameter_rows(result["bands"])]
    lines += Table.of(bands, BANDS).lines(indent="")
    for subject in result["subjects"]:
        if measured:
            cells = [
                f"{value['value']:.3g} mm at {key.removeprefix('depth_at_').removesuffix('N_mm')} N"
                for key, value in subject.items()
                if key.startswith("depth_at_")
            ]
            lines.append(f"subject {subject['name']:<16} {', '.join(cells)}")
            continue
        key, name, unit = (
            ("k_N_per_mm", "k", "N/mm") if "k_N_per_mm" in subject else ("gamma1_N_per_mm3", "gamma1", "N/mm3")
        )
        one = subject[key]
        lines.append(
            f"subject {subject['name']:<16} {name} {one['value']:.4g} {unit} (95 %: {one['low']:.4g} to "
            f"{one['high']:.4g}, {one['kind']}: {one['source']})"
        )
    lines += [f"note: {note}" for note in result["notes"] if not measured]
    lines += [f"source: {source}" for source in result["sources"]]
    lines += file_lines({"files": {}, **result})
    first = ("measured_curves",) if measured else ()
    left = [w for w in result["warnings"] if w["message"] not in result["notes"] and w["code"] not in first]
    lines += [f"warning: {w['message']}" for w in left]
    if "next_measurement" in result:
        lines.append(f"what would narrow it most: {result['next_measurement']['text']}")
    return "\n".join(lines)
