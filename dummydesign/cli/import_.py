"""``dummydesign import``: what a test machine wrote becomes traces, one press each."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError

if TYPE_CHECKING:
    from dummydesign.measurement.importing.core.decisions import Settings

HELP = (
    "Read files of test machines, spreadsheets and robots, and write each press as a trace: tared, zero at contact, "
    "compression positive. What is not sure is asked, with the option that settles it; the files are never changed."
)
ROLES = ("time", "displacement", "force")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("files", nargs="*", metavar="FILE|FOLDER", help="text in any usual form, or .xlsx (extra xlsx)")
    add("--profile", metavar="NAME|FILE", help="settings kept for a machine; other options win over it")
    add("--save-profile", metavar="NAME", help="keep what was given and found under this name")
    add("--list", action="store_true", help="show the profiles")
    add("--columns", metavar="time=NAME,...", help="column of time, displacement or force: its name or number")
    add("--units", metavar="time=s,...", help="unit of time, displacement or force; 0.5N is what one count is")
    add("--separator", metavar="C", help="between columns: tab, semicolon, comma, bar or spaces")
    add("--decimal", metavar="C", help="decimal sign: . or ,")
    add("--encoding", metavar="E", help="such as utf-8, utf-16, cp1252, cp932")
    add("--skip", metavar="N", help="lines to leave out at the start of the file")
    add("--flip", metavar="WHICH", help="displacement, force, both with a comma, or none (default: by what they do)")
    add("--tare", metavar="auto|none|N", help="reading at no force, as the file counts it (default auto: lead-in)")
    add("--contact", metavar="auto|none|MM", help="reading at contact, as the file counts it (default auto: by force)")
    add("--split", metavar="auto|none", help="auto: parted where force and depth return to zero; none: one press")
    add("--out", metavar="DIR", help="folder of the traces (default import-NAME)")
    add("--replace", action="store_true", help="let --save-profile take the place of a profile of this name")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read, decide, write traces and preview."""
    if options.list:
        return {"inputs": {"list": True}, "profiles": _profiles()}
    if not options.files:
        raise InputError("import needs a FILE or FOLDER (or --list for the profiles)")
    from dummydesign.core.files import output_folder
    from dummydesign.measurement.importing.batch import import_files, write_traces
    from dummydesign.measurement.importing.profiles import learned, save_profile
    from dummydesign.report.imported import write_preview

    settings = _settings(options)
    imported, warnings = import_files(options.files, settings)
    # before anything is written: a name that is taken must not leave traces behind
    profile = options.save_profile and save_profile(options.save_profile, learned(settings, imported), options.replace)
    out = options.out or _default_folder(options.files)
    folder = output_folder(out)
    files = write_traces(imported, folder)
    preview = write_preview(folder, imported, files, warnings)
    result: dict[str, Any] = {
        "inputs": {"files": [str(name) for name in options.files], **settings.to_dict(), "out": out},
        "files": files,
        "preview": preview,
        "warnings": [*(warning for one in files for warning in one["warnings"]), *warnings],
    }
    if profile:
        result["profile"] = str(profile)
    return result


def _profiles() -> list[dict[str, str]]:
    from dummydesign.measurement.importing.profile_names import list_profiles

    return [{"name": entry.name, "origin": entry.origin, "path": str(entry.path)} for entry in list_profiles()]


def _settings(options: argparse.Namespace) -> Settings:
    """What the options and the profile settle together."""
    from dataclasses import replace

    from dummydesign.measurement.importing.core.decisions import Settings
    from dummydesign.measurement.importing.profiles import load_profile

    base = load_profile(options.profile) if options.profile else Settings()
    given: dict[str, Any] = {}
    for name in ("separator", "encoding", "tare", "contact"):
        if getattr(options, name) is not None:
            given[name] = getattr(options, name)
    if options.columns is not None:
        given["columns"] = {**base.columns, **pairs("columns", options.columns)}
    if options.units is not None:
        given["units"] = {**base.units, **pairs("units", options.units)}
    if options.decimal is not None:
        given["decimal"] = {"dot": ".", "point": ".", "comma": ","}.get(options.decimal, options.decimal)
    if options.skip is not None:
        if not options.skip.isdigit():
            raise InputError(f"--skip {options.skip} is not a whole number of lines from 0")
        given["skip"] = int(options.skip)
    if options.flip is not None:
        given["flip"] = frozenset() if options.flip == "none" else frozenset(options.flip.split(","))
    if options.split is not None:
        given["split"] = options.split
    return replace(base, **given)


def pairs(option: str, text: str) -> dict[str, str]:
    """Read ``time=NAME,displacement=NAME,force=NAME``; a name may hold commas, for only a role begins a new part.

    Raises
    ------
    InputError
        When the text has another form, or a role comes twice.
    """
    parts = re.split(rf"(?:^|,)\s*({'|'.join(ROLES)})\s*=", text)
    if parts[0].strip() or len(parts) < 3:
        raise InputError(f"--{option} {text} must give ROLE=VALUE,... with roles {', '.join(ROLES)}")
    found: dict[str, str] = {}
    for role, value in zip(parts[1::2], parts[2::2]):
        if role in found or not value.strip():
            raise InputError(f"--{option} {text}: {role} is given twice or is empty")
        found[role] = value.strip()
    return found


def _default_folder(names: list[str]) -> str:
    from pathlib import Path

    if len(names) > 1:
        return "import"
    path = Path(names[0]).resolve()
    return f"import-{path.name if path.is_dir() else path.stem}"


def render(result: dict[str, Any]) -> str:
    """Make the readable tables."""
    if "profiles" in result:
        rows = [f"{one['name']:<20} {one['origin']:<9} {one['path']}" for one in result["profiles"]]
        return "\n".join(rows) if rows else "no profiles yet; 'dummydesign import FILE --save-profile NAME' keeps one"
    lines = []
    for one in result["files"]:
        lines.append(one["source"])
        wide = max(len(decision["what"]) for decision in one["decisions"])
        for decision in one["decisions"]:
            lines.append(f"  {decision['what']:<{wide}}  {decision['value']}: {decision['why']}")
        head = ("samples", "mm/s", "hold s", "mm", "peak N", "steady N")
        lines.append(f"  {'trace':<28}" + "".join(f" {text:>8}" for text in head))
        for trace in one["traces"]:
            steady = "-" if trace["steady_force_N"] is None else f"{trace['steady_force_N']:.3f}"
            lines.append(
                f"  {trace['file'][:28]:<28} {trace['samples']:>8} {trace['velocity_mm_s']:>7.4g} "
                f"{trace['hold_s']:>7.3g} "
                f"{trace['depth_mm']:>7.3f} {trace['peak_force_N']:>8.3f} {steady:>9}"
            )
    lines += [f"warning: {warning['message']}" for warning in result["warnings"]]
    lines.append(f"traces in: {result['inputs']['out']}")
    lines.append(f"preview: {result['preview']}")
    if "profile" in result:
        lines.append(f"profile: {result['profile']}")
    return "\n".join(lines)
