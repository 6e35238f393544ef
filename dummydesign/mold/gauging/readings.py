"""Thickness readings by the names of gauge points: unknown, missing and impossible ones, and how far off. No CAD."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.mold.gauging.points import GaugePoint


def check_readings(readings: Mapping[str, float], points: Sequence[GaugePoint]) -> None:
    """Refuse readings of unknown points, missing points and values that this pad cannot have.

    Parameters
    ----------
    readings : mapping of str to float
        Thickness by the name of its gauge point. [mm]
    points : sequence of GaugePoint
        Of the pad.

    Raises
    ------
    InputError
        With the names that are known or missing, or the value and what is allowed.
    """
    names = [point.name for point in points]
    for name in readings:
        if name not in names:
            raise unknown_name("gauge point", name, names)
    if missing := [name for name in names if name not in readings]:
        raise InputError(f"--thickness lacks {', '.join(missing)}; give {example(points)}")
    for point in points:
        value, nominal = readings[point.name], point.nominal_mm
        if not 0.5 * nominal <= value <= 2.0 * nominal:
            raise out_of_range(f"--thickness {point.name}", f"{value:g} mm", f"{0.5 * nominal:g}",
                               f"{2 * nominal:g} mm", f"its nominal is {nominal:.2f} mm")  # fmt: skip


def example(points: Sequence[GaugePoint]) -> str:
    """How readings are typed: every name with its nominal thickness."""
    return ",".join(f"{point.name}={point.nominal_mm:.2f}" for point in points)


def offsets_mm(readings: Mapping[str, float], points: Sequence[GaugePoint]) -> dict[str, float]:
    """Reading less nominal thickness by name. [mm]"""
    return {point.name: readings[point.name] - point.nominal_mm for point in points}


def pressed_thickness_mm(readings: Mapping[str, float], points: Sequence[GaugePoint], thickness_mm: float) -> float:
    """Thickness of the pad as its force law means it. [mm]

    Of a pad with tips the mean reading at them; of a flat pad the designed thickness and the mean offset of all points.

    Parameters
    ----------
    readings : mapping of str to float
        By name, complete. [mm]
    points : sequence of GaugePoint
        Of the pad.
    thickness_mm : float
        Designed thickness. [mm]
    """
    flat = all(abs(point.nominal_mm - thickness_mm) < 1e-9 for point in points)
    off = offsets_mm(readings, points)
    counted = [off[point.name] for point in points if flat or point.pressed]
    return thickness_mm + sum(counted) / len(counted)
