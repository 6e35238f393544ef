"""``dummydesign resins``: list, show and add resins."""

from __future__ import annotations

import argparse
import shlex
from collections import Counter
from typing import Any

from dummydesign.cli import text
from dummydesign.cli.common_options import ACTIONS, add_own_actions, number, render_own, run_own
from dummydesign.cli.text import file_lines, labelled, screen, warning_lines
from dummydesign.core.errors import InputError
from dummydesign.core.tables import Table

HELP = "List the known resins, show one with all its numbers and sources, and add, rename or remove your own."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the actions."""
    words = "list|show|add|add-compression|add-hardness|remove|rename|path"
    actions = parser.add_subparsers(dest="action", required=True, metavar=words, help="what to do")
    actions.add_parser("list", help="names, origin, ratio and modulus range")
    show = actions.add_parser("show", help="one resin, every number with its source")
    show.add_argument("name", metavar="NAME", help="a known resin or a TOML file")
    show.add_argument("--out", metavar="DIR", help="also write a plot and its CSV")
    add = actions.add_parser("add", help="keep a resin file, or update a resin by a file of measured points")
    add.add_argument("file", metavar="FILE", help="TOML file of a resin, or of points: base, name and [[point]]s")
    add.add_argument("--replace", action="store_true", help="take the place of a resin of your own that has this name")
    puck = actions.add_parser("add-compression", help="modulus and relaxation of a batch from its puck's curve")
    words = "time_s, displacement_mm, force_N: one slow loading, or ramps and holds"
    puck.add_argument("file", metavar="TRACE.csv", nargs="+", help=f"{words}; several presses of one puck together")
    puck.add_argument("--diameter", type=number("diameter in mm"), required=True, metavar="MM", help="of the puck")
    puck.add_argument("--height", type=number("height in mm"), required=True, metavar="MM", help="of the puck")
    puck.add_argument("--name", required=True, help="of the resin that results")
    puck.add_argument("--ratio", type=number("ratio"), required=True, metavar="R", help="mixing ratio of the puck")
    puck.add_argument("--resin", metavar="BASE", help="resin whose law is updated")
    words = "plates: lubricated, bonded or a friction coefficient (default: any friction)"
    puck.add_argument("--friction", metavar="lubricated|bonded|MU", help=words)
    puck.add_argument("--mass", type=number("mass in g"), metavar="G", help="of the puck, checked against its size")
    puck.add_argument("--replace", action="store_true", help="begin NAME again, without the points it has")
    _add_hardness_options(actions)
    add_own_actions(actions, "resin")


def _add_hardness_options(actions: Any) -> None:
    hard = actions.add_parser("add-hardness", help="a resin of a supplier's Shore value alone, with its scatter")
    scale = hard.add_mutually_exclusive_group(required=True)
    scale.add_argument(
        "--shore-00", type=number("shore 00"), metavar="S", help="Shore 00 as the supplier states it, 5 to 90"
    )
    scale.add_argument(
        "--shore-a", type=number("shore a"), metavar="S", help="Shore A as the supplier states it, 10 to 90"
    )
    hard.add_argument("--name", required=True, help="of the resin that results")
    base = "resin whose law of the ratio and relaxation are kept (none: one fixed mix)"
    hard.add_argument("--resin", metavar="BASE", help=base)
    hard.add_argument("--replace", action="store_true", help="take the place of a resin of your own that has this name")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Do the action and return plain values."""
    if options.action in ACTIONS:
        return run_own(options, "materials/resins", "resin")
    actions = {
        "list": _list,
        "show": _show,
        "add": _add,
        "add-compression": _add_compression,
        "add-hardness": _add_hardness,
    }
    return actions[options.action](options)


def _list(options: argparse.Namespace) -> dict[str, Any]:
    """A broken file of the user gives a warning and is left out, so that it never hides the others."""
    from dummydesign.core.user_library import entries
    from dummydesign.resin.model.hardness import expected_hardness
    from dummydesign.resin.model.resin_file import KIND, read_resin

    rows, warnings, sources = [], [], []
    for entry in entries(KIND).values():
        try:
            resin = read_resin(entry)
        except InputError as problem:
            warnings.append({"code": "unreadable_resin", "message": str(problem)})
            continue
        by_end = sorted((1e3 * resin.young_MPa(end), end) for end in (resin.ratio_min, resin.ratio_max))
        ends = [young for young, _ in by_end]
        rows.append(
            {
                "name": entry.name,
                "origin": entry.origin,
                "ratio_range": [resin.ratio_min, resin.ratio_max],
                "ratio_meaning": resin.ratio_meaning,
                "young_kPa_range": ends,
                "hardness": [expected_hardness(resin, end).to_dict() for _, end in by_end],
            }
        )
        sources += [text for text in resin.references if text not in sources]
    return {"inputs": {"action": "list"}, "warnings": warnings, "sources": sources, "resins": rows}


def _show(options: argparse.Namespace) -> dict[str, Any]:
    from dummydesign.resin import load_resin
    from dummydesign.resin.describe import explain

    resin = load_resin(options.name)
    inputs = {"action": "show", "name": options.name, "out": options.out}
    result = {"inputs": inputs, **explain(resin), "sources": list(resin.references)}
    if options.out is not None:
        from dummydesign.core.files import output_folder
        from dummydesign.resin.describe import write_plot

        result["files"] = write_plot(resin, output_folder(options.out))
    return result


def _add(options: argparse.Namespace) -> dict[str, Any]:
    from dummydesign.core.user_library import hidden_by
    from dummydesign.resin.describe import explain
    from dummydesign.resin.update import add_resin

    resin, path = add_resin(options.file, options.replace)
    explained = explain(resin)
    warnings = [*hidden_by("materials/resins", "resin", path.stem), *explained["warnings"]]
    return {
        "inputs": {"action": "add", "file": options.file},
        **explained,
        "warnings": warnings,
        "sources": list(resin.references),
        "files": {"resin": str(path)},
    }


def _add_compression(options: argparse.Namespace) -> dict[str, Any]:
    from dummydesign.resin.puck_test.add_compression import add_compression

    file = options.file[0] if len(options.file) == 1 else options.file
    given = {
        "file": file,
        "friction": options.friction,
        "diameter_mm": options.diameter,
        "height_mm": options.height,
        "name": options.name,
        "ratio": options.ratio,
        "mass_g": options.mass,
    }
    done = add_compression(**given, base=options.resin, replace_own=options.replace)
    inputs = {"action": "add-compression", **given, "resin": options.resin}
    return {"inputs": inputs, "sources": [done["young_kPa"]["source"]], **done}


def _add_hardness(options: argparse.Namespace) -> dict[str, Any]:
    from dummydesign.resin.from_hardness import add_hardness

    given = {"name": options.name, "shore_00": options.shore_00, "shore_a": options.shore_a}
    done = add_hardness(**given, base=options.resin, replace_own=options.replace)
    inputs = {"action": "add-hardness", **given, "resin": options.resin}
    return {"inputs": inputs, "sources": [done["young_kPa"]["source"]], **done}


def render(result: dict[str, Any]) -> str:
    """Modulus over ratio on one screen; lists and pucks are short as they are."""
    if "curve" not in result:
        return render_details(result)
    from dummydesign.resin.describe import hardness_text

    rows = _render_resin(result)
    end = next((row for row, line in enumerate(rows) if line.startswith("numbers (")), len(rows))
    kinds = Counter(item["kind"] for item in result["numbers"].values())
    counted = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    return screen(
        [*labelled("RESIN", rows[0], 2), *rows[1:3]],
        rows[3 : end - 1],
        [""],
        labelled("SHORE", hardness_text(result["curve"]), 3),
        labelled("NUMBERS", counted),
        text.notes_block(result["resin"]["notes"]),
        text.warning_block(result, most=2),
        text.files_block(result, ()),
        labelled("MORE", "--details: every number with its interval and source, all notes"),
    )


LISTED = {
    "name": "name:<20",
    "origin": "origin:<9",
    "ratio": "ratio:<9",
    "E in kPa": "young:<13",
    "ratio definition": "ratio_meaning:<1",
}


def render_details(result: dict[str, Any]) -> str:
    """Lay the answer out as short tables."""
    own = render_own(result)
    if own is not None:
        return own
    from dummydesign.resin.model.hardness import Hardness

    lines: list[str] = []
    if "resins" in result:
        rows = [
            {
                **row,
                "ratio": _span([f"{end:g}" for end in row["ratio_range"]]),
                "young": _span([_kPa(end) for end in row["young_kPa_range"]]),
            }
            for row in result["resins"]
        ]
        lines += [
            *Table.of(rows, LISTED).lines(indent=""),
            "",
            "hardness to expect of the softest and of the hardest mix:",
        ]
        lines += [f"  {row['name']}: {_span([Hardness(**end).text for end in row['hardness']])}" for row in rows]
    elif "shore" in result:
        lines += _render_hardness(result)
    elif "young_kPa" in result:
        lines += _render_puck(result)
    else:
        lines += _render_resin(result)
    return "\n".join(lines + warning_lines(result))


def _kPa(value: float) -> str:
    """Three figures, without a power of ten."""
    return f"{value:.3g}" if value < 1e3 else f"{float(f'{value:.3g}'):.0f}"


def _span(ends: list[str]) -> str:
    return ends[0] if ends[0] == ends[1] else f"{ends[0]} to {ends[1]}"


def _render_hardness(result: dict[str, Any]) -> list[str]:
    young, base = result["young_kPa"], result["base"]
    form = "one fixed mix, no ratio" if base is None else f"law of {base}, moved to this modulus at its reference ratio"
    return [
        f"modulus   {young['value']:.3g} kPa (95 %: {young['low']:.3g} to {young['high']:.3g}) from Shore "
        f"{result['shore']['scale']} {result['shore']['value']:g}",
        f"resin     {result['name']}: {form}",
        f"file      {result['files']['resin']}",
    ]


def _render_puck(result: dict[str, Any]) -> list[str]:
    young, friction = result["young_kPa"], result["friction"]
    # plates that rub more than this hold a puck as glue does
    low, high = ("bonded" if (one := friction[end]) is None or one > 1.0 else f"{one:.2g}" for end in ("low", "high"))
    span = low if low == high else f"{low} to {high}"
    how = f"plates declared {result['plates']}" if result["plates"] else "plates not declared"
    known = "Modulus and relaxation of the batch are measured: it needs no other puck."
    if not (result["relaxation"] or {}).get("prony"):
        known = "Only the modulus is measured: hold the position for 10 s to measure the relaxation too."
    first = [
        line for one in result["warnings"] if one["code"] in text.FIRST for line in labelled("CHECK", one["message"])
    ]
    return [
        *first,
        *labelled(
            "RESULT",
            f"{young['value']:.3g} kPa at ratio {result['ratio']:g} (95 %: {young['low']:.3g} to {young['high']:.3g}); "
            f"friction {span} ({how}). {known}",
        ),
        "",
        f"misfit    {result['rmse_N']:.3g} N rms over {result['compression_mm'][0]:.3g} to "
        f"{result['compression_mm'][1]:.3g} mm",
        *_render_relaxation(result["relaxation"]),
        f"resin     {result['name']}: "
        + {
            "added": f"law of {result['base']} updated at ratio {result['ratio']:g}",
            "unchanged": f"has this puck at ratio {result['ratio']:g} already; nothing was changed",
            "replaced": f"had this puck at {result['before']}; that point was replaced by ratio {result['ratio']:g}",
        }[result["action"]],
        f"file      {result['files']['resin']}",
        "",
        *labelled("NEXT", _suggest_with(result["name"])),
    ]


def _suggest_with(resin: str) -> str:
    """The search with a batch that was measured: for the project's tissue, else for the forefinger."""
    from dummydesign.project.folder import find_project

    project = find_project()
    tissue = "forefinger" if project is None or project.tissue is None else project.tissue
    return f"dummydesign suggest --tissue {shlex.quote(tissue)} --resin {shlex.quote(resin)}"


def _render_relaxation(relaxation: dict[str, Any] | None) -> list[str]:
    if relaxation is None:
        return []
    pairs = ((arm["beta"], arm["tau_s"]) for arm in relaxation["prony"])
    lines = [
        f"term      {beta['value']:.3g} of the long-term modulus (95 %: {beta['low']:.3g} to {beta['high']:.3g}) "
        f"at {tau['value']:.3g} s ({tau['low']:.3g} to {tau['high']:.3g})"
        for beta, tau in pairs
    ]
    seen = "seen      terms from {:.2g} to {:.2g} s".format(*relaxation["seen_s"])
    return [*(lines or ["term      none that the holds resolve"]), seen]


def _render_resin(result: dict[str, Any]) -> list[str]:
    from dummydesign.resin.describe import hardness_text

    resin = result["resin"]
    columns = "  ratio   E kPa (95 % interval)     % of E per"
    below = f"{'':34}% of ratio   Prony terms, relative to the long-term modulus"
    lines = [resin["title"], f"ratio: {resin['ratio_meaning']}", "", columns, below]
    for row in result["curve"]:
        young = row["young_kPa"]
        arms = ", ".join(f"{arm['beta']:.2g} at {arm['tau_s']:g} s" for arm in row["prony"])
        interval = f"({_kPa(young['low'])} to {_kPa(young['high'])})"
        slope = row["d_ln_young_per_percent_ratio"] * 100
        lines.append(f"  {row['ratio']:<6g}  {_kPa(young['value']):<7}{interval:<19} {slope:>6.1f}       {arms}")
    for point in resin.get("point", []):
        young, puck = point["young_kPa"], point.get("puck")
        came = f"{puck['diameter_mm']:g} x {puck['height_mm']:g} mm puck, {puck['file']}" if puck else young["source"]
        span = f"({young['low']:.3g} to {young['high']:.3g}, {young['kind']})"
        lines.append(f"  point at ratio {point['ratio']:g}: {young['value']:.3g} kPa {span} from {came}")
    lines += ["", "numbers (value, low to high, kind):"]
    for name, item in result["numbers"].items():
        lines.append(f"  {name:<26} {item['value']:<8.4g} {item['low']:.4g} to {item['high']:.4g}  {item['kind']}")
        lines.append(f"      {item['source']}")
    lines += ["", f"hardness: {hardness_text(result['curve'])}"]
    return [*lines, *(f"note: {note}" for note in resin["notes"]), *file_lines({"files": {}, **result})]
