"""Which shaped pads a response table is made from, and how one of them is solved: what the kinds share.

A design point is a list of numbers of order 1, the coordinates of the kind's response surface unless said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS, PUNCH_RADIUS_MM
from dummydesign.geometry.pad_shape import PadShape, Similarity
from dummydesign.geometry.shape_registry import shape_kind
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_problem import RIMS, solve_path
from dummydesign.pad.tables.shape import Surface
from studies.tables.surface_fit import fit

Array = np.ndarray

# The punch of the tables, which makes castability (in mm) a matter of ratios: 14 x 14 mm as a circle.
RADIUS_MM = PUNCH_RADIUS_MM
# Of the fresh pads that are solved on smaller cells too.
FIRST_SEED = 1126
# What a curve that reached the last depth counts in the mean that limits the table's depth.
COMPLETE = 0.7
OVER_SLAB = "round, flat, what touches sticks, ratio to the slab with a bead of 0.1"


@dataclass(frozen=True)
class Design:
    """Ranges and depths of one kind.

    Attributes
    ----------
    kind, meaning, punch : str
        Name of the shape; what the table holds over which numbers, and under which punch, in words.
    usual : (int, int, int)
        Shapes that are solved, fresh ones for the table's error, and how many on smaller cells.
    cells_are : str
        What ``cells`` count, in the table's provenance.
    seed : int
        Of the fresh ones: another one when a fit is changed after they were looked at.
    low, high : ndarray, shape (k,)
        Ends of the points; solved a little beyond what the table offers, so that its ends lie inside.
    depths : ndarray
        d / h that are solved.
    cells : int
        Of ``cells_are``.
    """

    kind: ClassVar[str] = ""
    meaning: ClassVar[str] = ""
    punch: ClassVar[str] = OVER_SLAB
    usual: ClassVar[tuple[int, int, int]] = (80, 12, 4)
    cells_are: ClassVar[str] = "cells_under_punch"
    seed: ClassVar[int] = FIRST_SEED
    low: Array
    high: Array
    depths: Array
    cells: int

    @property
    def margin(self) -> Array:
        """What the table leaves away at each end."""
        return 0.02 * (self.high - self.low)

    @property
    def similarity(self) -> Similarity:
        """The numbers of the table."""
        similarity = shape_kind(self.kind).similarity
        if similarity is None:
            raise InputError(f"shape {self.kind} has no numbers for a table", "unsupported", "shape", self.kind)
        return similarity

    def shape(self, point: Array) -> tuple[PadShape, float]:
        """Shape and thickness [mm] of a point."""
        raise NotImplementedError

    def castable(self, point: Array) -> bool:
        """Whether the pad of a point can be cast."""
        shape, h = self.shape(point)
        try:
            shape.check(h)
        except InputError:
            return False
        return True

    def points(self, count: int) -> Array:
        """Castable points of the Sobol sequence, shape (count, k)."""
        points = self.low + (self.high - self.low) * self._sobol()
        return np.array([point for point in points[: 12 * count] if self.castable(point)][:count])

    def _sobol(self) -> Array:
        from scipy.stats import qmc

        return qmc.Sobol(len(self.low), scramble=False).random_base2(14)[1:]

    def fresh(self, count: int, seed: int | None = None) -> Array:
        """Random castable points inside the table's own ranges, for its error; ``seed`` is the kind's when None."""
        rng = np.random.default_rng(self.seed if seed is None else seed)
        inside = 2.0 * self.margin
        points = rng.uniform(self.low + inside, self.high - inside, (800, len(self.low)))
        return np.array([point for point in points if self.castable(point)][:count])

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad; ``finer`` halves the cells, and the fillet of a flat-topped pad.

        Returns
        -------
        dict
            ``point``; ``force``: the factor over the slab at the depths that were reached, or F / (E a^2), one list a
            fillet; ``stop``: why they ended.
        """
        press, cells = self.press(point), self.cells * 2 if finer else self.cells
        rim = RIMS[1] if finer else RIMS[0]
        paths = [solve_path(press, self.depths, cells, rim, twin) for twin in (False, True)]
        count = min(len(path.force) for path in paths)
        return self._answer(point, [paths[0].force[:count] / paths[1].force[:count]], [path.stop for path in paths])

    def press(self, point: Array) -> Case:
        """The pad of a point under the punch."""
        shape, h = self.shape(point)
        return Case(RADIUS_MM / h, EXTENT_OVER_RADIUS * RADIUS_MM / h, shape=shape, thickness_mm=h)

    @staticmethod
    def _answer(point: Array, values: list[Array], stops: list[str | None]) -> dict[str, Any]:
        return {
            "point": [float(x) for x in point],
            "force": [[float(f"{value:.7g}") for value in row] for row in values],
            "stop": stops,
        }

    def joined(self, curves: list[Array]) -> tuple[Array, Array]:
        """One curve of those with each fillet, and what a sharp edge added, relative."""
        return curves[0], 0.0 * curves[0]

    def tips(self, points: Array) -> Array:
        """Radii of the tips over the punch's, of points (n, k); for tables over Hertz's force of the tip."""
        shapes = [self.shape(point)[0] for point in points]
        return np.array([shape.tip_radius_mm for shape in shapes]) / RADIUS_MM

    def at_depths(self, answers: list[dict[str, Any]], depths: Array) -> tuple[Array, Array]:
        """Forces (crowned, with a sharp edge) or factors at depths, and what the edge added, relative.

        Parameters
        ----------
        answers : list of dict
            From :meth:`solve`; solved at their ``depth``, or at the design's depths.
        depths : ndarray, shape (m,)
            In thicknesses.

        Returns
        -------
        ndarray, ndarray, shape (n, m)
            NaN where a pad was not solved.
        """
        values, added = np.full((2, len(answers), len(depths)), np.nan)
        for value, edge, answer in zip(values, added, answers):
            at = np.array(answer.get("depth", self.depths))
            padded = [np.array(row + [np.nan] * (len(at) - len(row)), dtype=float) for row in answer["force"]]
            of, i = np.nonzero(np.isclose(depths[:, None], at[None, :], rtol=0.0, atol=1e-6))
            joined = self.joined(padded)
            value[of], edge[of] = joined[0][i], joined[1][i]
        return values, added

    def reduced(self, points: Array, values: Array, depths: Array) -> Array:
        """ln of F over Hertz's force of the tip (crowned), or of the factor.

        Parameters
        ----------
        points : ndarray, shape (n, k)
            Design points; column 0 is ln h / a.
        values : ndarray, shape (n, m)
            Force over E a^2, or the factor on the slab's force.
        depths : ndarray, shape (m,)
            In thicknesses.

        Returns
        -------
        ndarray, shape (n, m)
        """
        if not self.similarity.over_tip:
            return np.log(values)
        h = np.exp(points[:, 0])
        return np.log(values / (16.0 / 9.0 * np.sqrt(self.tips(points))[:, None] * (depths * h[:, None]) ** 1.5))

    @staticmethod
    def reach(rows: Array, depths: Array) -> Array:
        """d / h to which curves (n, m) were solved; more than the last depth for those that reached it."""
        last = np.array([depths[np.isfinite(row)][-1] for row in rows])
        return np.where(last >= depths[-1], COMPLETE, last)

    def surface(self, answers: list[dict[str, Any]]) -> Surface:
        """The response surface through solved pads."""
        points = np.array([answer["point"] for answer in answers])
        rows = self.reduced(points, self.at_depths(answers, self.depths)[0], self.depths)
        low, high = (self.coordinates(end[None])[0] for end in (self.low, self.high))
        anchored, reach = self.similarity.over_tip, self.reach(rows, self.depths)
        return fit(self.coordinates(points), rows, self.depths, low, high, anchored, reach)

    def plain(self, point: Array) -> Array:
        """Numbers of the table at a design point: exponentials of its logarithms."""
        return np.where(self.similarity.logarithms, np.exp(point), point)

    def coordinates(self, points: Array) -> Array:
        """Coordinates of the response surface at design points (n, k)."""
        return points


FLAT_DEPTHS = np.array([0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6])
# Ends of ln h/a and of ln foot/a that the tables of round pads share.
THICK = np.log(0.48), np.log(3.3)
FOOT = np.log(0.36), np.log(1.8)
