"""What a comparison's answer states on one screen and on its report's first page: presses, steady curve, parameters."""

from __future__ import annotations

from typing import Any


def law_text(result: dict[str, Any]) -> str:
    """By what the people are known."""
    return "measured curves, no law" if result["law"] == "curves" else f"law {result['law']}"


def pad_text(result: dict[str, Any]) -> str:
    """The pad as it was cast; empty without its record."""
    pad = result.get("pad")
    if pad is None:
        return ""
    force = "" if pad["force_percent"] is None else f", force {pad['force_percent']:+.1f} % off the designed pad's"
    state = "accepted" if pad["accepted"] else "not accepted"
    return f"{pad['thickness_mm']:.2f} +- {pad['thickness_sd_mm']:.2f} mm as cast, {state}{force}"


def press_rows(result: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Head and rows of the table of presses."""
    rows = [
        [f"{row['steady_force_N']:.3g}", f"{row['velocity_mm_s']:.4g}", f"{row['depth_mm']:.2f}",
         f"{row['peak_force_N']:.2f}", f"{row['range_peak_low_N']:.2f} to {row['range_peak_high_N']:.2f}",
         f"{100 * row['inside_fraction']:.0f} %"]
        for row in result["force_variation_range"]
    ]  # fmt: skip
    return ["steady N", "mm/s", "depth mm", "pad peak N", "people N", "samples inside"], rows


def steady_text(result: dict[str, Any]) -> str:
    """How much of the steady curve is inside the people's range, below and within the forces of the test."""
    steady = result["steady_state_range"]
    low, high = steady["span_N"]
    shares = {f"{0.1 * low:g} to {low:g} N": steady["below_5N_fraction"],
              f"{low:g} to {high:g} N": steady["above_5N_fraction"]}  # fmt: skip
    return "; ".join(f"{span}: {'not reached' if share is None else f'{100 * share:.0f} %'}"
                     for span, share in shares.items())  # fmt: skip


def parameters_text(result: dict[str, Any]) -> str:
    """Which parameters of the law are outside the subjects' band; empty without a law."""
    outside = [name for name, row in result["parametric"].items() if row["inside"] is False]
    known = [name for name, row in result["parametric"].items() if row["inside"] is not None]
    if outside:
        return f"{len(outside)} of {len(known)} outside the subjects' band: {', '.join(outside)}"
    return f"all {len(known)} inside the subjects' band" if known else ""


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do with the pad, by the light of its verdict; nothing without one."""
    verdict = result["verdict"] or {"light": ""}
    if verdict["light"] == "green":
        return ["use the pad; its readings need no correction"]
    if verdict["light"] == "amber" and verdict["correction"]["factor"] is not None:
        force, energy = verdict["correction"]["force"], verdict["correction"]["factor"]
        return [f"use the pad; multiply forces by {max(force or 1.0, 1.0):.2f}, energies by {max(energy, 1.0):.2f}"]
    if verdict["light"] != "red":
        return []
    return ["do not use this pad for these presses", "press a campaign of it: dummydesign campaign new DIR",
            "let it correct the next design: dummydesign loop DIR"]  # fmt: skip
