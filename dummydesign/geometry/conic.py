"""Caps and ridges with a conic profile: heights, slope, volumes in closed form, and what can be cast of them.

A conic profile of apex radius R has r^2 = 2 R z - e z^2 at depth z below its apex (sphere e = 1, paraboloid
e = 0), which is all that the volumes need.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.limits import SMALLEST_HEIGHT_MM, SMALLEST_TIP_MM

Array = np.ndarray
GAUSS_POINTS = 40


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
        return (2.0 * self.radius_mm * self.height_mm - self.foot_mm**2) / self.height_mm**2

    def sag_mm(self, r_mm: Array) -> Array:
        """Drop below the apex at a radius; held at ``height_mm`` beyond the foot."""
        r = np.minimum(np.abs(np.asarray(r_mm, dtype=float)), self.foot_mm)
        root = np.sqrt(np.maximum(1.0 - self.factor * (r / self.radius_mm) ** 2, 0.0))
        # Exactly the height from the foot on: rounding must not leave a bone of -1e-15 mm there.
        return np.where(r < self.foot_mm, r**2 / (self.radius_mm * (1.0 + root)), self.height_mm)

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
        """Volume of the profile drawn out along a line whose ends lean outwards. [mm3]

        Parameters
        ----------
        half_length_mm : float
            Half the length at the apex. [mm]
        slope : float
            Growth of the half length per depth below the apex.

        Returns
        -------
        float
            Integral of 2 r(z) 2 (half + slope z) over the depth z, by Gauss-Legendre quadrature in sqrt(z), where
            the integrand is smooth; exact to rounding.
        """
        place, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        root = (place + 1) / 2
        z = self.height_mm * root**2
        r = np.sqrt(2 * self.radius_mm * z - self.factor * z**2)
        grown = 2 * r * 2 * (half_length_mm + slope * z)
        return float(np.sum(grown * self.height_mm * root * weight))

    def check(self, what: str, steepest_deg: float) -> None:
        """Refuse what is no cap or too steep.

        Parameters
        ----------
        what : str
            Name of the part, for the message.
        steepest_deg : float
            Largest slope at the foot. [deg]

        Raises
        ------
        InputError
            Naming the quantity, its value and what is allowed.
        """
        if not all(np.isfinite(value) for value in (self.radius_mm, self.height_mm, self.foot_mm)):
            raise InputError(f"{what}: radius, height and foot must be finite numbers")
        if self.radius_mm < SMALLEST_TIP_MM:
            raise InputError(f"{what} radius = {self.radius_mm:g} mm is below {SMALLEST_TIP_MM:g} mm, the sharpest tip")
        if self.height_mm < SMALLEST_HEIGHT_MM:
            raise InputError(f"{what} height = {self.height_mm:g} mm is below {SMALLEST_HEIGHT_MM:g} mm")
        # On the lower half of an ellipse: past it the profile would turn inwards.
        if self.foot_mm <= 0.0 or self.factor * self.height_mm > self.radius_mm * (1.0 - 1e-9):
            raise InputError(
                f"{what}: radius {self.radius_mm:g}, height {self.height_mm:g} and foot {self.foot_mm:g} mm "
                "make no cap that widens downwards; take a lower height or a wider foot"
            )
        if self.foot_slope_deg > steepest_deg:
            raise InputError(
                f"{what} slope at its foot = {self.foot_slope_deg:.0f} deg is above {steepest_deg:g} deg; "
                "take a lower height, a larger radius or a wider foot"
            )


def sphere_foot_mm(radius_mm: float, height_mm: float) -> float:
    """Foot radius of a spherical cap, sqrt(2 R c - c^2); 0 when the cap is higher than the sphere."""
    return float(np.sqrt(max(2.0 * radius_mm * height_mm - height_mm**2, 0.0)))
