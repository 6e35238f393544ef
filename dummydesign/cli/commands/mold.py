"""`dummydesign mold`: mould, master, frame and pour sheet of a pad; `mold record`."""

from __future__ import annotations

import argparse
import shlex
from collections import Counter
from pathlib import Path
from typing import Any

from dummydesign.cli.common_options import add_options, call
from dummydesign.cli.progress import Watch
from dummydesign.cli.text import files_block, labelled, screen, step_lines, warning_block
from dummydesign.core.errors import InputError, NoAnswerError

CALL, RECORD = "moulds.make_mould", "moulds.record_pad"


def run_record(options: argparse.Namespace) -> dict[str, Any]:
    """Judge and keep the record."""
    weighed = None if options.weighed_g is None else _weighed(options.weighed_g)
    result = call(RECORD, options, thicknesses_mm=_readings(options.thicknesses_mm), weighed_g=weighed).to_dict()
    if not result["accepted"]:
        message = f"the pad is not accepted: {', '.join(result['missed'])}"
        raise NoAnswerError("pad_not_accepted", message, result, "pad")
    return result


def _readings(text: str) -> list[float] | dict[str, float]:
    """Thicknesses as typed: ``tip=4.51,corner1=2.48`` or numbers alone. [mm]"""
    named: dict[str, float] = {}
    plain: list[float] = []
    for part in text.split(","):
        name, sign, value = (one.strip() for one in part.rpartition("="))
        try:
            number = float(value)
        except ValueError:
            message = f"--thickness {part.strip()!r} must be a number in mm, or NAME=MM"
            raise InputError(message, "not_a_number", "thickness", part.strip()) from None
        if name in named:
            raise InputError(f"--thickness {name} is listed twice", "duplicate", "thickness", name)
        if sign:
            named[name] = number
        else:
            plain.append(number)
    if named and plain:
        message = f"--thickness {plain[0]:g} has no name; give NAME=MM for every point or for none"
        raise InputError(message, "missing", "thickness", plain[0])
    return named or plain


def _weighed(text: str) -> dict[str, float]:
    """Masses as typed, ``polyol=174.1,isocyanate=26.1``. [g]"""
    weights: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = (one.strip() for one in part.partition("="))
        try:
            weights[name] = float(value)
        except ValueError:
            message = f"--weighed {part.strip()!r} must be NAME=G"
            raise InputError(message, "not_a_number", "weighed", part.strip()) from None
    return weights


def render_record(result: dict[str, Any]) -> str:
    """Each limit in a line, then what it does to the force."""
    from dummydesign.mold.pour.record import allowed_words

    size = f"{result['thickness_mm']:.2f} +- {result['thickness_sd_mm']:.2f} mm"
    lines = [f"Pad of {size} (designed {result['design_thickness_mm']:g} mm), mould {result['specification']}"]
    for one in result["limits"]:
        allowed, unlimited = allowed_words(one["low"], one["high"]), one["high"] is None
        cost = "" if one["force_percent"] is None else f"{one['force_percent']:+.1f} % force"
        state = "MISSED" if one["missed"] else "" if unlimited else "kept"
        lines.append(f"  {one['what']:<34}{one['value']:>8.4g} {one['unit']:<4}{allowed:<18}{state:<7}{cost}")
        if one["missed"] or unlimited:
            lines.append(f"      {one['advice']}")
    force = result["force_percent"]
    if force is None:
        lines.append("force at a given depth: not known for this shape")
    else:
        by = "" if result["inputs"]["modulus_kPa"] is not None else ", its modulus taken as designed"
        error = result["force_sd_percent"]
        gauged = "" if error is None else f" +- {error:.1f} (gauge)"
        lines.append(f"force at a given depth: {force:+.1f}{gauged} % off the designed pad's{by}")
    lines.append("accepted" if result["accepted"] else f"not accepted: {len(result['missed'])} limits missed")
    lines.append(f"record: {result['files']['record']}")
    lines.append('in a campaign: record = "PATH" under [pad] or [[trial]]; compare TRACE.csv --record PATH')
    return "\n".join(lines)


HELP = "Make the silicone mould of a pad: STEP files, printable master and frame, pour sheet, all checked."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of contracts: thickness, size, shape, preset, resin, ratio, output folder; and ``record``."""
    actions = parser.add_subparsers(dest="action", metavar="[record]", help="without 'record' a mould is made")
    words = "store what was poured and list the limits that the pad misses"
    add_options(actions.add_parser("record", help=words), RECORD)
    add_options(parser, CALL)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Build the mould, or keep the record of a pad, and return the answer."""
    if options.action == "record":
        return run_record(options)
    if options.thickness_mm is None and options.puck is None:
        message = "--thickness is missing: the thickness of the pad in mm, 3 to 30; or --puck 50x30 for a witness puck"
        raise InputError(message, "missing", "thickness")

    with Watch():
        return call(CALL, options).to_dict()


def default_in_project(options: argparse.Namespace) -> str | None:
    """Name of the folder in a project when none is typed; elsewhere the call names it. A record has its folder."""
    if options.action == "record" or options.thickness_mm is None:
        return f"puck_{options.puck.lower().replace(',', '_')}" if getattr(options, "puck", None) else None
    from dummydesign.mold.model.spec import read_thickness

    shape = options.shape.partition(":")[0].lower()
    kind = "" if shape in ("slab", "puck") else shape  # as ``PadSpec.prefix``
    several = [f"x{options.count}"] if options.count > 1 else []
    size = f"t{read_thickness(options.thickness_mm):g}"
    return "_".join(["mould", *([kind] if kind else []), size, *several])


def render(result: dict[str, Any]) -> str:
    """What to pour, whether the checks pass, what to mind, and the file to begin with."""
    if "specification" in result:
        return render_record(result)
    if "puck" in result["inputs"]:
        return _render_pucks(result)
    inputs, pour, batch = result["inputs"], result["pour"], result["batch"]
    count = inputs.get("count", 1)
    size = f"{inputs['length_mm']:g} x {inputs['width_mm']:g} x {inputs['thickness_mm']:g} mm"
    head = labelled("MOULD", f"{inputs['preset']}, for {count} pad{'s' * (count > 1)} {inputs['shape']} of {size}", 2)
    weights = (
        [("", batch)]
        if "base" not in batch
        else [("upper layer, poured first: ", batch), ("base layer, poured second: ", batch["base"])]
    )
    for words, one in weights:
        parts = " + ".join(map(_part, one["components"]))
        head += labelled("WEIGH", f"{words}{parts} = {one['total_g']:.1f} g; pour {one['pour_g']:.1f} g of it")
    head += labelled("", f"ratio {inputs['ratio']:g} ({inputs['ratio_meaning']}), {inputs['resin']}")
    if pour["silicone_mass_g"]:
        lid = f", {pour['lid_silicone_mass_g']:.0f} g for its lid" if pour["lid_silicone_mass_g"] else ""
        head += labelled("", f"silicone {pour['silicone_mass_g']:.0f} g for the mould itself{lid}")
    head += labelled("CHECKS", _counted(result["checks"]) if result.get("checks") else "")
    more = labelled("MORE", "--details: volumes, every check, every file and caution")
    return screen(
        head,
        _not_passed(result),
        warning_block(result),
        files_block(result, ("pour_sheet", "mould")),
        more,
        more="  ... and {} more checks: --details",
    )


def _part(part: dict[str, Any]) -> str:
    """A component with its mass, and its volume where the ratio is by volume."""
    volume = f" ({part['volume_ml']:.1f} ml)" if "volume_ml" in part else ""
    return f"{part['name']} {part['mass_g']:.1f} g{volume}"


def _render_pucks(result: dict[str, Any], details: bool = False) -> str:
    """What to print, mix and pour for pucks, and the sheet to begin with."""
    from dummydesign.mold.puck.plan import command, trace_names

    inputs, pour = result["inputs"], result["pour"]
    sizes = ", ".join(f"{one['count']} x {one['diameter_mm']:g} x {one['height_mm']:g} mm" for one in inputs["puck"])
    count = sum(one["count"] for one in inputs["puck"])
    parts = " + ".join(map(_part, pour["components"]))
    each = ", ".join(f"{mass:.1f} g" for mass in pour["pour_g"])
    head = labelled(
        "PUCK",
        f"{sizes} (diameter x height): {'a printed ring' if count == 1 else 'printed rings'}, two halves each",
        2,
    )
    head += labelled("PRINT", f"about {result['printing_h']:.1f} h, {result['filament_g']:.0f} g")
    head += labelled("WEIGH", f"{parts} = {pour['total_g']:.1f} g; pour {each} into each ring, strike off at the rim")
    head += labelled("", f"ratio {inputs['ratio']:g} ({inputs['ratio_meaning']}), {inputs['resin']}")
    head += labelled("CHECKS", _counted(result["checks"]) if result.get("checks") else "")
    first = inputs["puck"][0]
    size = f"{first['diameter_mm']:g}", f"{first['height_mm']:g}"
    names = trace_names("x".join(size), 1, first["count"])
    read = command(names, *size, inputs["ratio"], shlex.quote(inputs["resin"]))
    head += step_lines(["cast it and press it as the pour sheet says", read])
    if details:
        head += [
            f"  {one['status']:<8}{one['id']}: {one['value']} (limit {one['limit']})"
            for one in result.get("checks", [])
        ]
        head += [f"  {name:<24}{volume / 1000:10.3f} cm3" for name, volume in result.get("volumes_mm3", {}).items()]
        rows = [*head, *_not_passed(result), *(f"  - {item['message']}" for item in result["warnings"])]
        return "\n".join(rows + [f"  {role:<24}{path}" for role, path in result["files"].items()])
    more = labelled("MORE", "--details: volumes, every check, every file")
    files = files_block(result, ("pour_sheet", "assembly"))
    return screen(head, _not_passed(result), warning_block(result), files, more)


def _counted(checks: list[dict[str, Any]]) -> str:
    """How many checks passed, failed and were skipped."""
    counts = Counter(one["status"] for one in checks)
    return f"{counts['pass']} passed, {counts['fail']} failed, {counts['skipped']} skipped"


def _not_passed(result: dict[str, Any]) -> list[str]:
    """A line for each check that failed or was skipped."""
    return [
        f"  {item['status']:<8}{item['id']}: {item.get('note', '')}"
        for item in result.get("checks", [])
        if item["status"] in ("fail", "skipped")
    ]


def render_details(result: dict[str, Any]) -> str:
    """Write the answer as short tables."""
    if "specification" in result:
        return render_record(result)
    if "puck" in result["inputs"]:
        return _render_pucks(result, details=True)
    inputs, pour = result["inputs"], result["pour"]
    size = f"{inputs['length_mm']:g} x {inputs['width_mm']:g} x {inputs['thickness_mm']:g} mm"
    count, batch = inputs.get("count", 1), result["batch"]
    pads = f"a {inputs['shape']} pad" if count == 1 else f"{count} pads ({inputs['shape']}), each"
    first = "upper layer, poured first: " if "base" in batch else ""
    lines = [
        f"Mould ({inputs['preset']}) for {pads} of {size}, specification {result['spec_hash']}",
        "",
        f"Mix ({first}{inputs['resin']}, ratio {inputs['ratio']:g} {inputs['ratio_meaning']})",
        *_weights(batch, count),
    ]
    if "base" in batch:
        lines.append(f"Mix (base layer, poured second: {inputs['resin']}, ratio {inputs['base_ratio']:.4g})")
        lines += _weights(batch["base"], count)
    for part, name in (("the mould itself", "silicone_mass_g"), ("its lid", "lid_silicone_mass_g")):
        lines += [f"  {'silicone':<14}{pour[name]:10.0f} g   for {part}"] if pour[name] else []
    volumes = result.get("volumes_mm3", {})
    if volumes:
        lines += ["", "Volumes", *(f"  {name:<16}{volume / 1000:10.2f} cm3" for name, volume in volumes.items())]
    if result.get("checks"):
        lines += ["", f"Checks: {_counted(result['checks'])}", *_not_passed(result)]
    if result["files"]:
        folder = Path(next(iter(result["files"].values()))).parent
        files = (f"  {role:<24}{Path(path).name}" for role, path in result["files"].items())
        lines += ["", f"Files in {folder}", *files]
    if result["warnings"]:
        lines += ["", "Cautions", *(f"  - {item['message']}" for item in result["warnings"])]
    return "\n".join(lines)


def _weights(batch: dict[str, Any], count: int) -> list[str]:
    lines = [f"  {part['name']:<14}{part['mass_g']:10.1f} g" for part in batch["components"]]
    where = "into the mould" if count == 1 else f"into the {count} cavities"
    lines.append(f"  {'total':<14}{batch['total_g']:10.1f} g   pour {batch['pour_g']:.1f} g of it {where}")
    witness = batch["witness"]
    if witness["total_g"] > batch["total_g"]:
        masses = " + ".join(f"{part['name']} {part['mass_g']:.1f} g" for part in witness["components"])
        lines.append(f"  with a witness puck: {masses} = {witness['total_g']:.1f} g")
    return lines
