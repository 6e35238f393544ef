"""The enlarged detail of a crown or cap: its profile from the shape's own formula, tip radius, height, foot. No CAD."""

from __future__ import annotations

import numpy as np

from dummydesign.geometry.shapes import PadShape
from dummydesign.mold.files.drawings.layout import Measure, View
from dummydesign.mold.files.drawings.sheet import number

LETTER = "A"
BESIDE, UNDER = 1.3, 0.5
"""How far a detail reaches beyond the foot, over the foot, and below the flat, over the height."""
POINTS, SEARCH_MM, SCAN_MM = 161, 200.0, 0.01


def foot_mm(shape: PadShape) -> float:
    """Distance from the tip at which a raised face has come down to its flat. [mm]"""
    for known in shape.lines_mm():
        if _drop(shape, np.array([known]))[0] >= shape.relief_mm - 1e-9:
            return float(known)
    at = np.arange(0.0, SEARCH_MM, SCAN_MM)
    low = at[np.argmax(_drop(shape, at) >= shape.relief_mm - 1e-9)] - SCAN_MM
    fine = low + np.linspace(0.0, SCAN_MM, 1001)
    return float(fine[np.argmax(_drop(shape, fine) >= shape.relief_mm - 1e-9)])


def _drop(shape: PadShape, at_mm: np.ndarray) -> np.ndarray:
    """Drop below the tip, across what runs along the length. [mm]"""
    still = np.zeros_like(at_mm)
    return shape.drop_mm(still, at_mm) if shape.runs_out else shape.drop_mm(at_mm, still)


def crown_detail(shape: PadShape, factor: float = 1.0) -> View:
    """Show the crown, or the highest cap, enlarged, with its dimensions.

    Parameters
    ----------
    shape : PadShape
        With a tested face that is raised.
    factor : float
        Size of the part over the pad.

    Returns
    -------
    View
        Its tip at height 0, hatched, broken off beyond the foot and below the flat.
    """
    foot, high = foot_mm(shape), shape.relief_mm
    wide, low = factor * BESIDE * foot, -factor * (1.0 + UNDER) * high
    across = np.union1d(np.linspace(-BESIDE * foot, BESIDE * foot, POINTS), [-foot, 0.0, foot])
    # Other caps than this one are not shown.
    drop = np.where(np.abs(across) < foot, _drop(shape, across), high)
    profile = tuple((factor * float(x), -factor * float(z)) for x, z in zip(across, drop))
    border = (*profile, (wide, low), (-wide, low), profile[0])
    foot, high = factor * foot, factor * high
    axis = ((0.0, 0.15 * high), (0.0, low))
    measures = (Measure((0.0, 0.0), (foot, -high), "above"), Measure((wide, -high), (0.0, 0.0), "right"))
    leaders = []
    if shape.tip_radius_mm is not None:
        at = -0.35 * foot
        depth = float(_drop(shape, np.array([abs(at) / factor]))[0])
        leaders.append(((at, -factor * depth), f"R{number(factor * shape.tip_radius_mm)} at the tip"))
    runs = ((border, "bound"), (profile, "cut"), (axis, "thin"))
    return View(f"detail {LETTER}", runs, measures, tuple(leaders), True, True)
