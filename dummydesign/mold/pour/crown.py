"""A crown's height over the flat and its tip radius: what an error of either makes of the force, and what is allowed.

All forces are those at a quarter of the designed thickness from touch, glued, under a square punch of 14 mm, by the
shape's response table.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.mold.model.spec import PadGeometry

# Depth over thickness at which the force's sensitivity to lengths is stated.
COMPARED_DEPTH = 0.25
MOST_PERCENT = 5.0
"""Change of the force that one length of a crowned pad may make, the others as designed."""
# Lengths are gauged to a hundredth of a millimetre, tip radii to a tenth.
STEP_MM, RADIUS_STEP_MM = 0.01, 0.1
# Share of a crown's height or tip radius within which limits are sought.
SOUGHT = 0.4


@dataclass(frozen=True)
class CrownLimits:
    """Lowest and highest height over the flat, thickness of a pad whose crown is as designed, and tip radius. [mm]"""

    height_mm: tuple[float, float]
    thickness_mm: tuple[float, float]
    tip_radius_mm: tuple[float, float]


def crown_shape(shape: PadShape, higher_mm: float = 0.0, blunter: float = 1.0) -> PadShape:
    """The shape with its crown higher and its tip radius larger, on the same foot."""
    now: Any = shape
    # without the last digits of a sum: the shape is kept as text
    changed: dict[str, Any] = {"height_mm": round(now.height_mm + higher_mm, 9), "radius_mm": now.radius_mm * blunter}
    return replace(shape, **changed)


def crown_change_percent(
    pad: PadGeometry, higher_mm: float = 0.0, thicker_mm: float = 0.0, blunter: float = 1.0
) -> float | None:
    """Change of the force at a given depth for a crown that is higher, on a flat that is thicker. [%]

    None for a pad without a crown, and where the response table does not hold one of the two pads.
    """
    if pad.is_puck or not pad.shape.crowned:
        return None
    h, made = pad.thickness_mm, crown_shape(pad.shape, higher_mm, blunter)
    try:
        designed, cast = _force(pad.shape, h, h), _force(made, h + higher_mm + thicker_mm, h)
    except InputError:
        return None
    change = 100 * (cast / designed - 1)
    return change if math.isfinite(change) else None


@lru_cache(maxsize=512)
def _force(shape: PadShape, thickness_mm: float, designed_mm: float) -> float:
    """Force over modulus at a quarter of the designed thickness. [mm2]"""
    from dummydesign.pad.tables.shape import TabulatedShapeLaw

    depth = COMPARED_DEPTH * designed_mm
    return float(TabulatedShapeLaw(shape).force(depth, np.array([thickness_mm]), 1.0, PUNCH_RADIUS_MM)[0])


@lru_cache(maxsize=64)
def crown_limits(pad: PadGeometry, thickness_percent: float) -> CrownLimits | None:
    """Limits of the lengths of a crowned pad, each of which changes the force by 5 % at most.

    The thickness keeps the preset's limit too. None for a pad whose force is not known.
    """
    if crown_change_percent(pad) is None:
        return None
    shape: Any = pad.shape
    h, most = pad.thickness_mm, pad.thickness_mm * thickness_percent / 100
    height, tip = shape.height_mm, shape.radius_mm
    off = [_reach(lambda x: crown_change_percent(pad, higher_mm=x), side * SOUGHT * height) for side in (-1, 1)]
    thick = [_reach(lambda x: crown_change_percent(pad, thicker_mm=x), side * most) for side in (-1, 1)]
    blunt = [_reach(lambda x: crown_change_percent(pad, blunter=1 + x / tip), side * SOUGHT * tip) for side in (-1, 1)]
    return CrownLimits(
        _inwards(height, off, STEP_MM), _inwards(h, thick, STEP_MM), _inwards(tip, blunt, RADIUS_STEP_MM)
    )


def _reach(change: Callable[[float], float | None], most: float) -> float:
    """How far a length may be off, up to ``most`` (above or below 0), until the force has changed by 5 %."""

    def kept(off: float) -> bool:
        found = change(off)
        return found is not None and abs(found) <= MOST_PERCENT

    if kept(most):
        return most
    good, bad = 0.0, most
    for _ in range(10):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if kept(middle) else (good, middle)
    return good


def _inwards(nominal: float, off: list[float], step: float) -> tuple[float, float]:
    """Limits rounded to steps that are read, never outwards nor beyond the nominal."""
    low, high = (nominal + one for one in off)
    inner = math.ceil(low / step - 1e-6) * step, math.floor(high / step + 1e-6) * step
    return min(round(inner[0], 6), nominal), max(round(inner[1], 6), nominal)


@dataclass(frozen=True)
class MeasuredCrown:
    """How much a cast crown is higher over the flat than designed, and the flat thicker; number of tips gauged. [mm]"""

    higher_mm: float
    thicker_mm: float
    tips: int = 1

    def change_percent(self, pad: PadGeometry) -> float | None:
        """Change of the force at a given depth. [%]"""
        return crown_change_percent(pad, self.higher_mm, self.thicker_mm)

    def gauge_percent(self, pad: PadGeometry, gauge_mm: float) -> float | None:
        """Standard error of that change for the standard error of one reading, at tip and shoulder. [%]"""
        found = self.change_percent(pad)
        others = (
            crown_change_percent(pad, self.higher_mm + gauge_mm, self.thicker_mm),
            crown_change_percent(pad, self.higher_mm - gauge_mm, self.thicker_mm + gauge_mm),
        )
        if found is None or None in others:
            return None
        tip, shoulder = (float(one or 0.0) - found for one in others)
        return math.hypot(tip / math.sqrt(self.tips), shoulder)

    def differs(self, gauge_mm: float, limits: CrownLimits | None, relief_mm: float) -> bool:
        """Whether the height is beyond its limits, or off by more than twice the error with which it is gauged."""
        error = gauge_mm * math.sqrt(1.0 + 1.0 / self.tips)
        low, high = (-math.inf, math.inf) if limits is None else (one - relief_mm for one in limits.height_mm)
        return not low - 1e-9 <= self.higher_mm <= high + 1e-9 or abs(self.higher_mm) > 2.0 * error


SHOULDER, TIP = "shoulder", "tip"


def measured_crown(readings: Mapping[str, float], pad: PadGeometry) -> MeasuredCrown | None:
    """Read the lengths of a crown from its tips, by their mean, and the flat beside them; None of a pad without one.

    The flat is that of the gauge point next to the crown: at the corners a plate that sags or lies askew leaves
    another.
    """
    tips = [value for name, value in readings.items() if name.startswith(TIP)]
    if not (pad.shape.crowned and tips and SHOULDER in readings):
        return None
    thicker = readings[SHOULDER] - (pad.thickness_mm - pad.shape.relief_mm)
    return MeasuredCrown(sum(tips) / len(tips) - pad.thickness_mm - thicker, thicker, len(tips))
