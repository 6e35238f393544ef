"""The standard punch and pad, and the limits of pads with their checks."""

from __future__ import annotations

import math
from collections.abc import Iterable

from dummydesign.core.errors import InputError, quantity_name

PUNCH_SIDE_MM = 14.0
"""Side of the square punch."""
PUNCH = f"square:{PUNCH_SIDE_MM:g}"
"""It as typed."""
PUNCH_RADIUS_MM = PUNCH_SIDE_MM / math.sqrt(math.pi)
"""Radius of the circle of its area."""
PAD_LENGTH_MM, PAD_WIDTH_MM = 150.0, 120.0
PAD_EXTENT_MM = math.sqrt(PAD_LENGTH_MM * PAD_WIDTH_MM / math.pi)
"""Radius of the circle of the pad's area."""
EXTENT_OVER_RADIUS = math.sqrt(PAD_LENGTH_MM * PAD_WIDTH_MM) / PUNCH_SIDE_MM
MAX_DEPTH_OVER_THICKNESS = 0.6
"""To which depth pads are modelled and designed."""
LARGEST_EDGE_RADIUS = 0.3
"""Largest fillet of a punch's edge over its smaller half-width."""


SMALLEST_TIP_MM = 1.0
SMALLEST_HEIGHT_MM = 0.3
THINNEST_GEL_MM = 1.5
THINNEST_COVER_MM = 2.0
STEEPEST_TOP_DEG = 70.0
STEEPEST_BONE_DEG = 60.0
RIM_FREE_MM = 8.0
# Half the width that the foot of a thickness gauge needs on a flat. [mm]
GAUGE_FOOT_MM = 4.0
MODULUS_RATIO = (0.05, 20.0)
# A bar ends this much before the drafted walls, so that it does not bind when it is lowered. [mm]
BAR_END_GAP_MM = 0.5
THICKNESS_MM = (3.0, 30.0)
"""Slabs that can be cast. [mm]"""


def check_flag(name: str, value: float) -> None:
    """Refuse what is neither 0 nor 1."""
    if value not in (0.0, 1.0):
        raise InputError(f"{name} = {value:g} is not 0 or 1", "out_of_range", name, value, (0, 1))


def check_left(what: str, height_mm: float, thickness_mm: float, least_mm: float) -> None:
    """Refuse a part that leaves too little of the pad's thickness."""
    if not thickness_mm - height_mm >= least_mm - 1e-9:
        left = f"{thickness_mm - height_mm:.3g} mm of a pad of {thickness_mm:g} mm; at least {least_mm:g} mm must stay"
        message = f"{what} height = {height_mm:g} mm leaves {left}"
        raise InputError(message, "out_of_range", f"{what}_height_mm", height_mm, (None, thickness_mm - least_mm))


def check_covers(size: str, sides_mm: Iterable[float], widest_mm: float, punch: str) -> None:
    """Refuse a pad that is smaller than its punch."""
    if min(sides_mm) < widest_mm:
        message = f"pad = {size} mm is smaller than the punch {punch}; its sides must be at least {widest_mm:g} mm"
        raise InputError(message, "out_of_range", "pad", size)


def check_inside(what: str, reach_mm: float, across_mm: float) -> None:
    """Refuse a part that comes nearer than ``RIM_FREE_MM`` to the pad's rim."""
    most = 0.5 * across_mm - RIM_FREE_MM
    if reach_mm > most:
        quantity = quantity_name(f"{what.removeprefix('the ')} reach mm")
        message = f"{what} reaches {reach_mm:.3g} mm from the middle; a pad {across_mm:g} mm across allows {most:g} mm"
        raise InputError(message, "out_of_range", quantity, reach_mm, (None, most))
