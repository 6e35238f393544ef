"""``dummydesign import``: what a test machine wrote becomes traces, one press each."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any

from dummydesign.cli.common_options import add_options, call
from dummydesign.cli.text import labelled, screen, warning_block
from dummydesign.core.errors import InputError
from dummydesign.core.tables import Table

CALL = "traces.import_traces"
HELP = "Read test-machine files: one trace for each press, tared, zero at contact, compression positive."
FILES = "text in any usual form, or a workbook (extra xlsx)"
ROLES = ("time", "displacement", "force")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("files", nargs="*", metavar="FILE|FOLDER", help=FILES)
    parser.add_argument("--list", action="store_true", help="show the profiles")
    add_options(parser, CALL)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read, decide, write traces and preview; or list the profiles."""
    if options.list:
        from dummydesign.measurement.importing.read import list_profiles

        rows = [{"name": one.name, "origin": one.origin, "path": str(one.path)} for one in list_profiles()]
        return {"inputs": {"list": True}, "profiles": rows}
    if not options.files:
        raise InputError("import needs a FILE or FOLDER (or --list for the profiles)", "missing", "files")
    if options.skip is not None and options.skip < 0:
        message = f"--skip {options.skip} is not a whole number of lines from 0"
        raise InputError(message, "not_a_number", "skip", options.skip)
    return call(
        CALL,
        options,
        columns=None if options.columns is None else pairs("columns", options.columns),
        units=None if options.units is None else pairs("units", options.units),
        decimal={"dot": ".", "point": ".", "comma": ","}.get(options.decimal, options.decimal),
        flip=None if options.flip is None else [] if options.flip == "none" else options.flip.split(","),
    ).to_dict()


def pairs(option: str, text: str) -> dict[str, str]:
    """Read ``time=NAME,displacement=NAME,force=NAME``; a name may hold commas, for only a role begins a new part."""
    parts = re.split(rf"(?:^|,)\s*({'|'.join(ROLES)})\s*=", text)
    if parts[0].strip() or len(parts) < 3:
        message = f"--{option} {text} must give ROLE=VALUE,... with roles {', '.join(ROLES)}"
        raise InputError(message, "malformed", option, text)
    values: dict[str, str] = {}
    for role, value in zip(parts[1::2], parts[2::2]):
        if role in values or not value.strip():
            message = f"--{option} {text}: {role} is given twice or is empty"
            raise InputError(message, "duplicate" if role in values else "missing", option, text)
        values[role] = value.strip()
    return values


def default_out(options: argparse.Namespace) -> str | None:
    """Name of the folder when none is typed; None without files."""
    names = options.files
    if not names:
        return None
    if len(names) > 1:
        return "import"
    path = Path(names[0]).resolve()
    return f"import-{path.name if path.is_dir() else path.stem}"


def render(result: dict[str, Any]) -> str:
    """How each file was read in a line, then its presses."""
    if "profiles" in result:
        return render_details(result)
    count = sum(len(one["traces"]) for one in result["files"])
    files, sheets = len({one["source"] for one in result["files"]}), sum("sheet" in one for one in result["files"])
    origin = f"{files} file{'s' * (files != 1)}" + (f" ({sheets} sheets)" if sheets else "")
    head = labelled(
        "READ", f"{count} press{'es' * (count != 1)} from {origin}. Check units, signs and contact in the preview."
    )
    for one in result["files"][:3]:
        known = {decision["what"]: decision["value"] for decision in one["decisions"]}
        sheet = f" [{one['sheet']}]" if "sheet" in one else ""
        head += labelled("FILE", f"{Path(one['source']).name}{sheet}: {_decided(known)}", 3)
    more, kind = len(result["files"]) - 3, "sheets" if sheets else "files"
    head += labelled("", f"{more} more {kind}: --details" if more > 0 else "")
    presses = [
        {**trace, "file": trace["file"] if len(trace["file"]) <= 28 else "..." + trace["file"][-25:]}
        for one in result["files"]
        for trace in one["traces"]
    ]
    columns = {"press": "file:<28", **MOTION, "depth mm": "depth_mm:>8.3f", **FORCES}
    made = f"traces in {result['inputs']['out']}/, {result['preview']} (look at it first)"
    made += f", profile {result['profile']}" if "profile" in result else ""
    return screen(
        [*head, ""],
        Table.of(presses, columns).lines(),
        [""],
        warning_block(result),
        labelled("FILES", made),
        labelled("MORE", "--details: every decision and why"),
    )


MOTION = {"mm/s": "velocity_mm_s:>8.4g", "hold s": "hold_s:>8.3g"}
FORCES = {"peak N": "peak_force_N:>8.3f", "steady N": "steady_force_N:>8.3f", "+- N": "steady_error_N:>6.2g"}


def _decided(known: dict[str, str]) -> str:
    """The decisions that change time, force or depth: columns, units, signs, tare and contact."""
    parts = []
    for role in ("displacement", "force"):
        column, unit, sign = (known.get(f"{role} {what}") for what in ("column", "unit", "sign"))
        text = f"{role} from '{column}'" if column is not None else role
        text += f" in {unit}" if unit is not None else ""
        parts.append(text + (f", sign {sign}" if sign not in (None, "as written") else ""))
    named = ("time", "equal times", "two times", "tare", "contact")
    parts += [f"{name}: {known[name]}" for name in named if name in known]
    return "; ".join(parts)


def render_details(result: dict[str, Any]) -> str:
    """Make the readable tables."""
    if "profiles" in result:
        rows = [f"{one['name']:<20} {one['origin']:<9} {one['path']}" for one in result["profiles"]]
        return "\n".join(rows) if rows else "no profiles yet; 'dummydesign import FILE --save-profile NAME' keeps one"
    lines = []
    columns = {"trace": "file:<28.28", "samples": "samples:>8", **MOTION, "mm": "depth_mm:>8.3f", **FORCES}
    for one in result["files"]:
        wide = max(len(decision["what"]) for decision in one["decisions"])
        decisions = (f"  {made['what']:<{wide}}  {made['value']}: {made['why']}" for made in one["decisions"])
        lines += [one["source"], *decisions, *Table.of(one["traces"], columns).lines()]
    lines += [f"warning: {warning['message']}" for warning in result["warnings"]]
    lines += [f"traces in: {result['inputs']['out']}", f"preview: {result['preview']}"]
    return "\n".join([*lines, *([f"profile: {result['profile']}"] if "profile" in result else [])])
