"""Limits of pads, and checks against them: what a master can show, a mould can release and a gel survives.

Workshop judgement, see docs/mould.md.
"""

from __future__ import annotations

from dummydesign.core.errors import InputError

SMALLEST_TIP_MM = 1.0
SMALLEST_HEIGHT_MM = 0.3
THINNEST_GEL_MM = 1.5
THINNEST_COVER_MM = 2.0
STEEPEST_TOP_DEG = 70.0
STEEPEST_BONE_DEG = 60.0
RIM_FREE_MM = 8.0
# Half the width that the foot of a thickness gauge needs on a flat. [mm]
GAUGE_FOOT_MM = 4.0
# Pockets deeper than this share of their diameter keep their air.
DEEPEST_POCKET = 0.3
MODULUS_RATIO = (0.05, 20.0)
# A bar ends this much before the drafted walls, so that it does not bind when it is lowered. [mm]
BAR_END_GAP_MM = 0.5


def check_flag(name: str, value: float) -> None:
    """Refuse what is neither 0 nor 1.

    Raises
    ------
    InputError
        Naming the quantity and its value.
    """
    if value not in (0.0, 1.0):
        raise InputError(f"{name} = {value:g} is not 0 or 1")


def check_left(what: str, height_mm: float, thickness_mm: float, least_mm: float) -> None:
    """Refuse a part that leaves too little of the pad's thickness.

    Parameters
    ----------
    what : str
        Name of the part.
    height_mm, thickness_mm : float
        Height of the part and thickness of the pad. [mm]
    least_mm : float
        What must stay. [mm]

    Raises
    ------
    InputError
        Naming what is left and what must stay.
    """
    if not thickness_mm - height_mm >= least_mm - 1e-9:
        raise InputError(
            f"{what} height = {height_mm:g} mm leaves {thickness_mm - height_mm:.3g} mm of a pad of "
            f"{thickness_mm:g} mm; at least {least_mm:g} mm must stay"
        )


def check_inside(what: str, reach_mm: float, across_mm: float) -> None:
    """Refuse a part that comes nearer than ``RIM_FREE_MM`` to the pad's rim.

    Parameters
    ----------
    what : str
        Name of the part.
    reach_mm : float
        Its farthest distance from the middle. [mm]
    across_mm : float
        Length or width of the pad. [mm]

    Raises
    ------
    InputError
        Naming the reach and what is allowed.
    """
    if reach_mm > 0.5 * across_mm - RIM_FREE_MM:
        raise InputError(
            f"{what} reaches {reach_mm:.3g} mm from the middle; a pad {across_mm:g} mm across allows "
            f"{0.5 * across_mm - RIM_FREE_MM:g} mm"
        )
