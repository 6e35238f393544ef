"""Crowns: a design point is (ln h/a, c/h, ln b/a, s), s = R c / b^2; the surface is over ln s, in pieces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.shaped_pad import sharp
from dummydesign.pad.axisymmetric.shaped_problem import CELLS, RIMS, solve_path
from dummydesign.pad.tables.crowned import CrownResponse
from studies.tables.crowns.edge import EdgeWatch
from studies.tables.crowns.fit import Curves, fit_crowns
from studies.tables.designs.base import FOOT, RADIUS_MM, THICK, Array, Design

# Points that are even in s; all others are even in ln s.
EVEN = 160
# Points of all kinds; more have a foot below this share of the punch's radius.
MIXED, JUMPING = 400, 0.85
# Where errors are stated, and what is solved: the ends of the load steps, which cost nothing.
DEPTHS = np.array([0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6])
LATTICE = np.round(np.arange(0.02, 0.601, 0.01), 4)


@dataclass(frozen=True)
class CrownedDesign(Design):
    """Ranges and depths of crowned pads."""

    kind: ClassVar[str] = "crowned"
    meaning: ClassVar[str] = "ln(F / (16/9 E sqrt(R) d^1.5)) over ln h/a, c/h, ln b/a, ln s and depth; s = R c / b^2"
    punch: ClassVar[str] = "round, flat, what touches sticks, sharp edge from beads of 0.1 and 0.05"
    usual: ClassVar[tuple[int, int, int]] = (494, 40, 8)
    seed: ClassVar[int] = 2211

    def shape(self, point: Array) -> tuple[Crowned, float]:
        """Shape and thickness [mm] of a point."""
        h = float(RADIUS_MM * np.exp(point[0]))
        height, foot = float(point[1] * h), float(RADIUS_MM * np.exp(point[2]))
        return Crowned(float(point[3] * foot**2 / height), height, foot), h

    def points(self, count: int) -> Array:
        """Castable points of the Sobol sequence, shape (count, k).

        The first 160 are even in s, all others in ln s: soft tissues ask for pointed crowns. Beyond the first 400 only
        those with a foot below 0.85 punch radii are taken, whose force jumps.
        """
        raw = self._sobol()
        points = self.low + (self.high - self.low) * raw
        even = [point for point in points[:8000] if self.castable(point)][: min(count, EVEN)]
        later = points[8000:].copy()
        later[:, 3] = self.low[3] * (self.high[3] / self.low[3]) ** raw[8000:, 3]
        pointed = [point for point in later[: 10 * count] if self.castable(point)]
        rest = MIXED - len(even)
        rows = even + pointed[:rest] + [point for point in pointed[rest:] if np.exp(point[2]) < JUMPING]
        return np.array(rows[:count])

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad with both fillets, F / (E a^2) at ``depth``; ``finer`` halves the cells.

        Returns
        -------
        dict
            As of :class:`Design`; ``edge``: d / h at which the contact reaches the edge and what is not known of it.
        """
        press, cells = self.press(point), self.cells * 2 if finer else self.cells
        watch, fillet = EdgeWatch(press), RIMS[1] * press.scale / press.radius
        paths = [solve_path(press, LATTICE, cells, rim, visit=watch if rim == RIMS[1] else None) for rim in RIMS]
        values = [path.force / 3.0 * (press.thickness_mm / RADIUS_MM) ** 2 for path in paths]
        answer = self._answer(point, values, [path.stop for path in paths])
        edge = watch.reached(float(np.exp(point[2])), fillet)
        return {**answer, "depth": LATTICE.tolist(), "edge": edge}

    def joined(self, curves: list[Array]) -> tuple[Array, Array]:
        """The limit of a sharp edge."""
        return sharp(*curves)

    def tips(self, points: Array) -> Array:
        """s b^2 / c."""
        return points[:, 3] * np.exp(2.0 * points[:, 2]) / (points[:, 1] * np.exp(points[:, 0]))

    def surface(self, answers: list[dict[str, Any]]) -> CrownResponse:
        """In pieces joined where the edge is reached (:func:`fit_crowns`)."""
        points = np.array([answer["point"] for answer in answers])
        values, added = self.at_depths(answers, LATTICE)
        edges = [answer.get("edge") or (np.nan, np.nan) for answer in answers]
        y = self.reduced(points, values, LATTICE)
        edge, doubt = np.array(edges, dtype=float).T
        return fit_crowns(Curves(self.coordinates(points), LATTICE, y, added, edge, doubt, self.reach(y, LATTICE)))

    def plain(self, point: Array) -> Array:
        """s stands in a point as it is."""
        return np.append(super().plain(point)[:3], point[3])

    def coordinates(self, points: Array) -> Array:
        """The surface is over ln s."""
        return np.column_stack([points[:, :3], np.log(points[:, 3])])


DESIGN = CrownedDesign(
    np.array([THICK[0], 0.17, FOOT[0], 0.085]), np.array([THICK[1], 0.78, FOOT[1], 0.72]), DEPTHS, CELLS
)
