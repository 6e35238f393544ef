"""Caps and ridges with a conic profile: heights, slope, volumes in closed form, limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import SMALLEST_HEIGHT_MM, SMALLEST_TIP_MM
from dummydesign.geometry.pad_shape import Array, PadBlock, PadShape

GAUSS_POINTS = 40


def _curvature(tip: Any, height: Any, foot: Any) -> Array:
    """The e of a profile; see :class:`Conic`."""
    return np.asarray((2.0 * tip * height - foot**2) / height**2)


def conic_sag(r: Any, tip: Any, height: Any, foot: Any) -> Array:
    """Drop below the apex at radii of conic caps (broadcast), held at the height from the foot on."""
    inside = np.minimum(r, foot)
    root = np.sqrt(np.maximum(1.0 - _curvature(tip, height, foot) * (inside / tip) ** 2, 0.0))
    # Exactly the height from the foot on: rounding must not leave a bone of -1e-15 mm there.
    return np.where(r < np.asarray(foot), inside**2 / (tip * (1.0 + root)), height)


def conic_radius(drop: Any, tip: Any, height: Any, foot: Any) -> Array:
    """Radius at which conic caps (broadcast) have fallen so far, at most to their foot."""
    z = np.minimum(drop, height)
    return np.sqrt(np.maximum(2.0 * tip * z - _curvature(tip, height, foot) * z**2, 0.0))


@dataclass(frozen=True)
class Conic:
    """A cap with a conic profile: apex radius R, height c, foot radius b; a sphere, a paraboloid, a rounded cone.

    sag(r) = r^2 / (R (1 + sqrt(1 - e r^2 / R^2))) with e = (2 R c - b^2) / c^2, so that sag(b) = c. e = 1 is a
    sphere, 0 a paraboloid, below 0 a hyperboloid that comes near to a cone.
    """

    radius_mm: float
    height_mm: float
    foot_mm: float

    @property
    def factor(self) -> float:
        """The e of the profile: 1 for a sphere, 0 a paraboloid, below 0 a hyperboloid."""
        return float(_curvature(self.radius_mm, self.height_mm, self.foot_mm))

    def sag_mm(self, r_mm: Array) -> Array:
        """Drop below the apex at a radius; held at ``height_mm`` beyond the foot."""
        return conic_sag(np.abs(np.asarray(r_mm, dtype=float)), self.radius_mm, self.height_mm, self.foot_mm)

    @property
    def foot_slope_deg(self) -> float:
        """Slope of the profile where it meets the flat."""
        root = 1.0 - self.factor * (self.foot_mm / self.radius_mm) ** 2
        # sag'(b) = b / (R sqrt(root)); where the root's branch ends the profile is vertical.
        return float(np.degrees(np.arctan2(self.foot_mm, self.radius_mm * np.sqrt(max(root, 0.0)))))

    def cap_volume_mm3(self) -> float:
        """Volume of a round cap, pi times the integral of r^2: pi (R c^2 - e c^3 / 3). [mm3]

        For a sphere this is pi c^2 (3 R - c) / 3.
        """
        return math.pi * (self.radius_mm * self.height_mm**2 - self.factor * self.height_mm**3 / 3)

    def ridge_volume_mm3(self, half_length_mm: float, slope: float) -> float:
        """Volume of the profile drawn out along a line whose ends lean outwards. [mm3]"""
        node, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        root = (node + 1) / 2
        z = self.height_mm * root**2
        r = np.sqrt(2 * self.radius_mm * z - self.factor * z**2)
        grown = 2 * r * 2 * (half_length_mm + slope * z)
        return float(np.sum(grown * self.height_mm * root * weight))

    def check_cap(self, what: str, steepest_deg: float) -> None:
        """Refuse what is no cap or too steep."""
        if not all(np.isfinite(value) for value in (self.radius_mm, self.height_mm, self.foot_mm)):
            raise InputError(f"{what}: radius, height and foot must be finite numbers", "out_of_range", what)
        sharpest = ("radius", self.radius_mm, SMALLEST_TIP_MM), ("height", self.height_mm, SMALLEST_HEIGHT_MM)
        for name, value, least in sharpest:
            if value < least:
                message = f"{what} {name} = {value:g} mm is below {least:g} mm"
                raise InputError(message, "out_of_range", f"{what}_{name}_mm", value, (least, None))
        # On the lower half of an ellipse: past it the profile would turn inwards.
        if self.foot_mm <= 0.0 or self.factor * self.height_mm > self.radius_mm * (1.0 - 1e-9):
            sizes = f"radius {self.radius_mm:g}, height {self.height_mm:g} and foot {self.foot_mm:g} mm"
            message = f"{what}: {sizes} make no cap that widens downwards; take a lower height or a wider foot"
            raise InputError(message, "cannot_be_made", what)
        slope = self.foot_slope_deg
        if slope > steepest_deg:
            advice = "take a lower height, a larger radius or a wider foot"
            message = f"{what} slope at its foot = {slope:.0f} deg is above {steepest_deg:g} deg; {advice}"
            raise InputError(message, "out_of_range", f"{what}_foot_slope_deg", slope, (None, steepest_deg))


def sphere_foot_mm(radius_mm: float, height_mm: float) -> float:
    """Foot radius of a spherical cap, sqrt(2 R c - c^2); 0 when the cap is higher than the sphere."""
    return float(np.sqrt(max(2.0 * radius_mm * height_mm - height_mm**2, 0.0)))


# Feet that are tried in a search, over the punch's radius.
FOOT_SHARES = np.geomspace(0.4, 1.7, 9)


@dataclass(frozen=True)
class ConicProfile(Conic, PadShape):
    """A shape with a conic profile: apex radius, height and foot radius (0: that of a sphere)."""

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
    def steepest_deg(self) -> float:
        """The slope at the foot."""
        return self.foot_slope_deg

    def lines_mm(self) -> tuple[float, ...]:
        """The foot."""
        return (self.foot_mm,)

    def ends(self, block: PadBlock) -> tuple[float, float]:
        """Half length at the apex [mm] and its growth per depth, of a profile along a block with drafted walls."""
        raise NotImplementedError

    def volume_mm3(self, block: PadBlock) -> float:
        """Volume under the profile. [mm3]"""
        return self.ridge_volume_mm3(*self.ends(block)) if self.along else self.cap_volume_mm3()

    def across_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Distance from the apex, or from the line of apices. [mm]"""
        return np.hypot(0.0 * np.asarray(x_mm), y_mm) if self.along else np.hypot(x_mm, y_mm)

    @classmethod
    def in_proportion(cls, k: Array) -> dict[str, Array]:
        """Heights go with the thickness, feet stay, and so does the form of the cap."""
        return {"height": k, "radius": 1.0 / k}


def wall_slope(block: PadBlock) -> float:
    """How far a drafted wall moves outwards per height."""
    return math.tan(math.radians(block.draft_deg))
