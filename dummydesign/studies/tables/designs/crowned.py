"""Crowns: a design point is (ln h/a, c/h, ln b/a, s), s = R c / b^2; the surface is over ln s and levels of d / c."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.axisymmetric import climb, sharp
from dummydesign.pad.shaped.problem import CELLS, RIMS
from dummydesign.studies.tables.designs.base import FOOT, RADIUS_MM, THICK, Array, Design

# Points that are even in s; all others are even in ln s.
EVEN = 160
DEPTHS = np.array([0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6])
# Levels of the response surface (d / c): depth over the height of the crown.
LEVELS = np.array(
    [0.03, 0.06, 0.1, 0.16, 0.23, 0.32, 0.42, 0.53, 0.65, 0.78, 0.92, 1.07, 1.25, 1.45, 1.7, 2.0, 2.4, 2.9, 3.5]
)
# Curves that reached the last depth are carried on straight to here, so that the surface has no free end.
CARRIED_ON = 0.9


@dataclass(frozen=True)
class CrownedDesign(Design):
    """Ranges and depths of crowned pads."""

    kind: ClassVar[str] = "crowned"
    meaning: ClassVar[str] = "ln(F / (16/9 E sqrt(R) d^1.5)) over ln h/a, c/h, ln b/a, ln s and d/c; s = R c / b^2"
    punch: ClassVar[str] = "round, flat, what touches sticks, sharp edge from beads of 0.1 and 0.05"
    usual: ClassVar[tuple[int, int, int]] = (400, 36, 8)

    def shape(self, point: Array) -> tuple[Crowned, float]:
        """Shape and thickness [mm] of a point."""
        h = float(RADIUS_MM * np.exp(point[0]))
        height, foot = float(point[1] * h), float(RADIUS_MM * np.exp(point[2]))
        return Crowned(float(point[3] * foot**2 / height), height, foot), h

    def points(self, count: int) -> Array:
        """Castable points of the Sobol sequence, shape (count, k).

        The first 160 are even in s, all others in ln s: soft tissues ask for pointed crowns.
        """
        raw = self._sobol()
        points = self.low + (self.high - self.low) * raw
        even = [point for point in points[:8000] if self.castable(point)][: min(count, EVEN)]
        later = points[8000:].copy()
        later[:, 3] = self.low[3] * (self.high[3] / self.low[3]) ** raw[8000:, 3]
        pointed = [point for point in later if self.castable(point)][: count - len(even)]
        return np.array(even + pointed)

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad with both fillets, F / (E a^2); ``finer`` halves the cells."""
        press, cells = self._press(point), self.cells * 2 if finer else self.cells
        paths = [climb(press, Yeoh(1.0), self.depths, cells, rim) for rim in RIMS]
        values = [path.force / 3.0 * (press.thickness_mm / RADIUS_MM) ** 2 for path in paths]
        return self._answer(point, values, [path.stop for path in paths])

    def joined(self, curves: list[Array]) -> tuple[Array, Array]:
        """The limit of a sharp edge."""
        return sharp(*curves)

    def tips(self, points: Array) -> Array:
        """s b^2 / c."""
        return points[:, 3] * np.exp(2.0 * points[:, 2]) / (points[:, 1] * np.exp(points[:, 0]))

    def over_levels(self, points: Array, rows: Array) -> tuple[Array, Array]:
        """Levels of d / c, and the curves there."""
        return LEVELS, at_levels(self.depths, points, rows)

    def depth_unit(self, points: Array) -> Array:
        """The crown's height over the thickness."""
        return points[:, 1:2]

    def plain(self, point: Array) -> Array:
        """s stands in a point as it is."""
        return np.append(super().plain(point)[:3], point[3])

    def coordinates(self, points: Array) -> Array:
        """The surface is over ln s."""
        return np.column_stack([points[:, :3], np.log(points[:, 3])])


def at_levels(depths: Array, points: Array, rows: Array) -> Array:
    """Curves over d / h, shape (n, depths), at the levels of d / c; NaN where they were not solved.

    A natural cubic spline in sqrt(d / h) from 0 at first touch, extrapolated linearly.

    Parameters
    ----------
    depths : ndarray, shape (depths,)
        Increasing depths over thickness.
    points : ndarray, shape (n, 4)
        The design points; column 1 is c / h.
    rows : ndarray, shape (n, depths)
        Values at those depths, NaN where none was reached.
    """
    from scipy.interpolate import CubicSpline

    out = np.full((len(points), len(LEVELS)), np.nan)
    for row, share, values in zip(out, points[:, 1], rows):
        known = np.isfinite(values)
        last = depths[known][-1]
        place = np.sqrt(np.concatenate([[0.0], depths[known]]))
        spline = CubicSpline(place, np.concatenate([[0.0], values[known]]), bc_type="natural")
        x = LEVELS * share
        inside = np.minimum(np.sqrt(x), place[-1])
        carried = spline(inside) + (np.sqrt(x) - inside) * spline(place[-1], 1)
        wanted = x <= (CARRIED_ON if last >= depths[-1] else last * (1.0 + 1e-9))
        row[wanted] = carried[wanted]
    return out


DESIGN = CrownedDesign(
    np.array([THICK[0], 0.17, FOOT[0], 0.085]), np.array([THICK[1], 0.78, FOOT[1], 0.72]), DEPTHS, CELLS
)
