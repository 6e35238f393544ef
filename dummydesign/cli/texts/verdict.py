"""The verdict as the first line on a terminal: a light in colour, and the same in a word."""

from __future__ import annotations

from typing import Any

from dummydesign.cli.texts.screen import labelled

NO_LAW = "measured_curves"
FIRST = (NO_LAW, "tissue_punch", "force_not_in_band", "speed_not_in_band", "calibration_resin")
"""Codes of what is said right after the verdict: it rests on what nobody measured, or on another resin's campaign."""
CODES = {"green": "32", "amber": "33", "red": "31"}


def verdict_lines(verdict: dict[str, Any] | None, coloured: bool | None = None) -> list[str]:
    """The verdict and an empty line; nothing where there is none.

    Parameters
    ----------
    verdict : dict or None
        As in the JSON of the commands.
    coloured : bool, optional
        By default where standard output is a terminal and ``NO_COLOR`` is not set.
    """
    if verdict is None:
        return []
    if coloured is None:
        coloured = _wants_colour()
    lines = labelled(verdict["light"].upper(), verdict["text"])
    if coloured:
        light = verdict["light"].upper()
        lines[0] = f"\033[1;{CODES[verdict['light']]}m{light}\033[0m{lines[0].removeprefix(light)}"
    return [*lines, ""]


def tissue_lines(result: dict[str, Any]) -> list[str]:
    """What a tissue does not have, or is not known for in this test, before anything that is held against it.

    Parameters
    ----------
    result : dict
        The answer of a command.
    """
    said = [item["message"] for item in result["warnings"] if item["code"] in FIRST]
    return [*said, ""] if said else []


def warning_lines(result: dict[str, Any]) -> list[str]:
    """Warnings that were not said first."""
    return [f"warning: {item['message']}" for item in result["warnings"] if item["code"] not in FIRST]


def first_lines(result: dict[str, Any]) -> list[str]:
    """What must be read next: a pad that bottoms out, the impact, a puck to be measured first, and why this pad.

    Parameters
    ----------
    result : dict
        The answer of ``suggest``.
    """
    lines = [f"BOTTOMS OUT: {item['message']}" for item in result["warnings"] if item["code"] == "bottoms_out"]
    pad, known = impact_of(result)
    if pad and known:
        with_ = f"the subjects with {min(known):.3g} to {max(known):.3g} N" if len(known) > 1 else (
            f"the subject with {known[0]:.3g} N")  # fmt: skip
        lines.append(f"impact: the pad stops it with {pad['peak_force_N']:.3g} N at {pad['depth_mm']:.3g} mm, {with_}")
    first = result.get("measure_first")
    lines += [f"{first['text']}: {first['protocol']}", f"then: {first['command']}"] if first and first["text"] else []
    choice = result.get("choice")
    lines += [f"why this pad: {choice['text']}"] if choice else []
    lines += [choice["expectation"]["text"]] if choice and choice["expectation"]["differs"] else []
    lines += [choice["expectation"]["undecided"]] if choice and choice["expectation"]["undecided"] else []
    return [*lines, ""] if lines else []


def impact_of(result: dict[str, Any]) -> tuple[dict[str, Any] | None, list[float]]:
    """The row of a pad that stops a free mass, None where none does, and the peaks of the people who stop it. [N]"""
    rows = [row for row in result.get("safety", {}).get("impact", []) if row["peak_force_N"] is not None]
    pad = next((row for row in rows if row["body"] == "pad"), None)
    return pad, [row["peak_force_N"] for row in rows if row["body"] != "pad"]


def _wants_colour() -> bool:
    import os
    import sys

    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")
