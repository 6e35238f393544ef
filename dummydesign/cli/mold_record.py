"""``dummydesign mold record``: what was really poured, judged and kept."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.shared_options import add_replace_option

HELP = "keep what was really poured, and say which limits the pad misses"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the measured values."""
    parser.add_argument("folder", metavar="DIR", help="folder that mold wrote")
    add = parser.add_argument
    add("--thickness", metavar="NAME=MM,..", required=True,
        help="at the gauge points of the pour sheet; of a flat pad also five or more numbers")  # fmt: skip
    add("--mass", type=float, metavar="G", required=True, help="of the trimmed pad")
    add("--modulus", type=float, metavar="KPA", help="of the witness puck, from resins add-compression")
    add("--level", type=float, metavar="DEG", help="as read when the mould was filled")
    add("--bubbles", type=int, metavar="N", help="over 1 mm, under the punch")
    add("--gauge", type=float, metavar="MM", help="standard error of the gauge on a gel (default 0.05)")
    add("--note", default="", metavar="TEXT", help="anything else")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Judge and keep the record.

    Raises
    ------
    NoAnswerError
        ``pad_not_accepted`` when a limit is missed; the record is kept and is the error's ``result``.
    """
    from dummydesign.api import record_pad
    from dummydesign.core.errors import NoAnswerError

    result = record_pad(
        options.folder, _readings(options.thickness), options.mass, modulus_kPa=options.modulus,
        level_deg=options.level, bubbles=options.bubbles, gauge_mm=options.gauge, note=options.note,
        replace=options.replace,
    ).to_dict()  # fmt: skip
    if not result["accepted"]:
        message = f"the pad is not accepted: {', '.join(result['missed'])}"
        raise NoAnswerError("pad_not_accepted", message, result)
    return result


def _readings(text: str) -> list[float] | dict[str, float]:
    """Thicknesses as typed: ``tip=4.51,corner1=2.48`` or numbers alone. [mm]"""
    from dummydesign.core.errors import InputError

    named: dict[str, float] = {}
    plain: list[float] = []
    for part in text.split(","):
        name, sign, value = (one.strip() for one in part.rpartition("="))
        try:
            number = float(value)
        except ValueError:
            raise InputError(f"--thickness {part.strip()!r} must be a number in mm, or NAME=MM") from None
        if name in named:
            raise InputError(f"--thickness {name} is listed twice")
        if sign:
            named[name] = number
        else:
            plain.append(number)
    if named and plain:
        raise InputError(f"--thickness {plain[0]:g} has no name; give NAME=MM for every point or for none")
    return named or plain


def render(result: dict[str, Any]) -> str:
    """Each limit in a line, then what it does to the force."""
    size = f"{result['thickness_mm']:.2f} +- {result['thickness_sd_mm']:.2f} mm"
    lines = [f"Pad of {size} (designed {result['design_thickness_mm']:g} mm), mould {result['specification']}"]
    for one in result["limits"]:
        allowed = f"at most {one['high']:.4g}" if one["low"] is None else f"{one['low']:.4g} to {one['high']:.4g}"
        cost = "" if one["force_percent"] is None else f"{one['force_percent']:+.1f} % force"
        state = "MISSED" if one["missed"] else "kept"
        lines.append(f"  {one['what']:<34}{one['value']:>8.4g} {one['unit']:<4}{allowed:<18}{state:<7}{cost}")
        if one["missed"]:
            lines.append(f"      {one['advice']}")
    force = result["force_percent"]
    if force is None:
        lines.append("force at a given depth: not known for this shape")
    else:
        by = "" if result["inputs"]["modulus_kPa"] is not None else ", its modulus taken as designed"
        lines.append(f"force at a given depth: {force:+.1f} % off the designed pad's{by}")
    lines.append("accepted" if result["accepted"] else f"not accepted: {len(result['missed'])} limits missed")
    lines.append(f"record: {result['files']['record']}")
    lines.append('in a campaign: record = "PATH" under [pad] or [[trial]]; compare TRACE.csv --record PATH')
    return "\n".join(lines)
