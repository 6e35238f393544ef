"""What crowns and bones share: a conic profile, round or along the whole length."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dummydesign.geometry.conic import Conic, sphere_foot_mm
from dummydesign.geometry.pad_block import PadBlock
from dummydesign.geometry.pad_shape import Array, PadShape

# Feet that are tried in a search, over the punch's radius.
FOOT_SHARES = np.geomspace(0.4, 1.7, 9)


@dataclass(frozen=True)
class ConicProfile(PadShape):
    """A conic profile of apex radius, height and foot radius (0: that of a sphere)."""

    radius_mm: float
    height_mm: float
    foot_mm: float = 0.0

    def __post_init__(self) -> None:
        if not self.foot_mm:
            object.__setattr__(self, "foot_mm", sphere_foot_mm(self.radius_mm, self.height_mm))

    def _implied(self, key: str) -> bool:
        """The foot of a sphere need not be typed."""
        sphere = key == "foot_mm" and self.foot_mm == sphere_foot_mm(self.radius_mm, self.height_mm)
        return sphere or super()._implied(key)

    @property
    def along(self) -> bool:
        """Whether the profile runs along the whole length instead of round."""
        return False

    @property
    def axisymmetric(self) -> bool:
        """Round unless it runs along the length."""
        return not self.along

    @property
    def runs_out(self) -> bool:
        """What runs along the length goes on into the end walls."""
        return self.along

    @property
    def conic(self) -> Conic:
        """The profile."""
        return Conic(self.radius_mm, self.height_mm, self.foot_mm)

    @property
    def steepest_deg(self) -> float:
        """The slope at the foot."""
        return self.conic.foot_slope_deg

    def lines_mm(self) -> tuple[float, ...]:
        """The foot."""
        return (self.foot_mm,)

    def ends(self, block: PadBlock) -> tuple[float, float]:
        """Half length at the apex [mm] and its growth per depth, of a profile along a block with drafted walls."""
        raise NotImplementedError

    def volume_mm3(self, block: PadBlock) -> float:
        """Volume under the profile. [mm3]"""
        return self.conic.ridge_volume_mm3(*self.ends(block)) if self.along else self.conic.cap_volume_mm3()

    def sag_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Drop below the apex. [mm]"""
        across = np.hypot(0.0 * np.asarray(x_mm), y_mm) if self.along else np.hypot(x_mm, y_mm)
        return self.conic.sag_mm(across)

    @classmethod
    def in_proportion(cls, k: Array) -> dict[str, Array]:
        """Heights go with the thickness, feet stay, and so does the form of the cap."""
        return {"height": k, "radius": 1.0 / k}


def wall_slope(block: PadBlock) -> float:
    """How far a drafted wall moves outwards per height."""
    return math.tan(math.radians(block.draft_deg))
