"""A free mass on people: which of its numbers people were never pressed to, and the mass for a hand that is free."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dummydesign.core.quantity import Quantity
from dummydesign.core.toml_schema import read_table
from dummydesign.core.user_library import data_folder
from dummydesign.design.safety import SafetyView
from dummydesign.person.validity_range import FAR, NEAR, limits_of_subjects, short_number
from dummydesign.tissue.model.tissue import Tissue

EXTRAPOLATED, UNUSABLE = "extrapolated beyond the presses on people", "far beyond the presses on people: do not use"


def hand_mass_kg() -> Quantity:
    """Mass that moves with a hand that is free. [kg]"""
    return read_table(data_folder() / "materials" / "hand.toml", ("schema", "free")).table("free").quantity("mass_kg")


def reduced_mass_kg(robot_kg: float, hand_kg: float) -> float:
    """Return the mass that hits a clamped hand as hard as the robot hits a free one. [kg]

    m = m1 m2 / (m1 + m2): energy in the frame of the centre of mass, which the tissue has to take.

    References
    ----------
    ISO/TS 15066:2016, annex A (two-body model).
    """
    return robot_kg * hand_kg / (robot_kg + hand_kg)


def with_known_range(view: SafetyView, tissue: Tissue, robot_kg: float, velocity_mm_s: float) -> SafetyView:
    """Mark each subject's impact that goes beyond that subject's presses, and offer the mass for a free hand."""
    deepest, strongest = limits_of_subjects(tissue)
    rows: list[dict[str, Any]] = []
    times: list[tuple[float, float, float]] = []
    subject = 0
    for row in view.impact:
        if row["body"] == "pad" or row["peak_force_N"] is None:
            subject += row["body"] != "pad"
            rows.append({**row, "beyond_range": False})
            continue
        ends = float(deepest[subject]), float(strongest[subject])
        over = max(row["depth_mm"] / ends[0], row["peak_force_N"] / ends[1])
        if over > NEAR:
            times.append((over, row["peak_force_N"], ends[1]))
            row = {**row, "note": "; ".join(filter(None, (row["note"], UNUSABLE if over > FAR else EXTRAPOLATED)))}
        rows.append({**row, "beyond_range": over > NEAR})
        subject += 1
    hand_kg = hand_mass_kg().value
    reduced = float(f"{reduced_mass_kg(robot_kg, hand_kg):.3g}")
    free = (
        f"A hand that is free takes the reduced mass with its {hand_kg:g} kg: --robot-mass {reduced:g}"
        if robot_kg > hand_kg
        else ""
    )
    words = f"{view.impact_text} {free}." if free else view.impact_text
    if not times:
        return replace(view, impact=tuple(rows), impact_text=words)
    over, most, pressed = max(times)
    first = "do not use the subjects' numbers" if over > FAR else "the subjects' numbers are extrapolated"
    message = (
        f"{first}: {robot_kg:g} kg at {velocity_mm_s:g} mm/s bring {short_number(most)} N, people were pressed "
        f"to {short_number(pressed)} N"
    )
    warned = {"code": "impact_beyond_people", "message": f"{message}. {free}" if free else message}
    return replace(view, impact=tuple(rows), impact_text=words, warnings=(*view.warnings, warned))
