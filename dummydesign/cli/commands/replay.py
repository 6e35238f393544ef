"""``dummydesign replay``: predict a campaign with a calibration."""

from __future__ import annotations

import shlex
from typing import Any

from dummydesign.cli.text import labelled, screen, verdict_lines, warning_block, warning_lines
from dummydesign.core.levels import level_name
from dummydesign.core.tables import Table

HELP = "Predict a campaign with a calibration written by 'loop', and compare with what was measured."
CALL = "campaigns.replay"


ABOUT_STEPS = 4
"""Presses, with what was found, with the base model; pads that are solved come on top."""


def render(result: dict[str, Any]) -> str:
    """Whether the calibration holds, the error over all presses, the pads, the presses with the largest errors."""
    text = f"{result['rmse_N']:.4f} N rms; the calibration has no effect, so this is the base model's error"
    if result["effects"]:
        text = f"{result['rmse_N']:.4f} N rms with {', '.join(result['effects'])}; "
        text += f"{result['base_rmse_N']:.4f} N with the base model"
    head = [*_held(result), *verdict_lines(result["verdict"]), *labelled("ERROR", text)]
    head += [line for pad in _pads(result) for line in labelled("PAD", pad, 1)]
    ordered = sorted(result["trials"], key=lambda row: -row["rmse_N"])
    presses = Table.of(ordered, {"press, largest error first": "file:<28.28", **ERRORS}).lines()
    following = "" if result["holds"] else f"dummydesign loop {shlex.quote(result['inputs']['campaign'])}"
    more = labelled("MORE", "--details: every press and pad")
    return screen([*head[:14], ""], presses, [""], warning_block(result), labelled("NEXT", following), more)


def _held(result: dict[str, Any]) -> list[str]:
    """Whether the calibration holds on these presses, with the numbers that decide."""
    numbers = f"{result['rmse_N']:.3g} N rms over {len(result['trials'])} presses"
    noise = f"twice the noise of its own campaign ({result['noise_floor_N']:.3g} N)"
    if result["holds"]:
        return labelled("HOLDS", f"The calibration holds here: {numbers}, at most {noise}.")
    worst = max(result["trials"], key=lambda row: abs(row["peak_error_N"]))
    peak = f"The largest error of a peak is {worst['peak_error_N']:+.3g} N ({worst['file']})."
    return labelled("FAILS", f"The calibration does not hold here: {numbers}, more than {noise}. {peak}")


ERRORS = {"rms N": "rmse_N:>9.4f", "base rms N": "base_rmse_N:>11.4f", "peak error N": "peak_error_N:>+13.4f"}


def _pads(result: dict[str, Any]) -> list[str]:
    """The verdict on each of several pads."""
    if len(result["pads"]) < 2:
        return []
    levels = (
        pad["reason"] if pad["verdict"] is None else level_name(pad["verdict"]["level"]) for pad in result["pads"]
    )
    return [f"{pad['shape']}, {pad['thickness_mm']:g} mm: {level}" for pad, level in zip(result["pads"], levels)]


def render_details(result: dict[str, Any]) -> str:
    """Make the readable table."""
    from dummydesign.report.sections import budget_lines

    lines = [*_held(result), *verdict_lines(result["verdict"])]
    if pads := _pads(result):
        lines += ["verdict of the worst pad; by pad:", *pads]
    lines += Table.of(result["trials"], {"press": "file:<28.28", **ERRORS}).lines()
    lines += budget_lines(result["budget"])
    effects = ", ".join(result["effects"]) or "no effect"
    lines.append(f"all: {result['rmse_N']:.4f} N with {effects}; {result['base_rmse_N']:.4f} N with the base model")
    return "\n".join(lines + warning_lines(result))
