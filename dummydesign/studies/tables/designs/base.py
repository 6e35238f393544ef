"""Which shaped pads a response table is made from, and how one of them is solved: what the kinds share.

A design point is a list of numbers of order 1, the coordinates of the kind's response surface unless said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes import PadShape, Similarity, shape_kind
from dummydesign.geometry.standard import EXTENT_OVER_RADIUS, PUNCH_RADIUS_MM
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.axisymmetric import climb
from dummydesign.pad.shaped.problem import RIMS, Press

Array = np.ndarray

# The punch of the tables, which makes castability (in mm) a matter of ratios: 14 x 14 mm as a circle.
RADIUS_MM = PUNCH_RADIUS_MM
OVER_SLAB = "round, flat, what touches sticks, ratio to the slab with a bead of 0.1"


@dataclass(frozen=True)
class Design:
    """Ranges and depths of one kind.

    Attributes
    ----------
    kind, meaning, punch : str
        Name of the shape; what the table holds over which numbers, and under which punch, in words.
    usual : (int, int, int)
        Shapes that are solved, fresh ones for the table's error, and how many of these on smaller cells.
    low, high : ndarray, shape (k,)
        Ends of the points; solved a little beyond what the table offers, so that its ends lie inside.
    depths : ndarray
        d / h that are solved.
    cells : int
        Under the punch.
    """

    kind: ClassVar[str] = ""
    meaning: ClassVar[str] = ""
    punch: ClassVar[str] = OVER_SLAB
    usual: ClassVar[tuple[int, int, int]] = (80, 12, 4)
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
        found = shape_kind(self.kind).similarity
        if found is None:
            raise InputError(f"shape {self.kind} has no numbers for a table")
        return found

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

    def fresh(self, count: int) -> Array:
        """Random castable points inside the table's own ranges, for its error."""
        rng = np.random.default_rng(1126)
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
        press, cells = self._press(point), self.cells * 2 if finer else self.cells
        rim = RIMS[1] if finer else RIMS[0]
        paths = [climb(press, Yeoh(1.0), self.depths, cells, rim, twin) for twin in (False, True)]
        count = min(len(path.force) for path in paths)
        return self._answer(point, [paths[0].force[:count] / paths[1].force[:count]], [path.stop for path in paths])

    def _press(self, point: Array) -> Press:
        shape, h = self.shape(point)
        return Press(shape, h, RADIUS_MM / h, EXTENT_OVER_RADIUS * RADIUS_MM / h)

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

    def over_levels(self, points: Array, rows: Array) -> tuple[Array, Array]:
        """Levels of the response surface and curves (n, depths) there; NaN where they were not solved."""
        return self.depths, rows

    def depth_unit(self, points: Array) -> Array:
        """What relative depths are counted in, shape (n, 1)."""
        return np.ones((len(points), 1))

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
