"""Which shaped pads a response table is made from, and how one of them is solved.

A design point is a list of numbers of order 1 for each kind: crowned (ln h/a, c/h, ln b/a, s), layered (ln h/a,
top/h, ln of the moduli's ratio), boned (ln h/a, height/h, ln b/a; a spherical dome).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.standard import EXTENT_OVER_RADIUS, PUNCH_RADIUS_MM
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.axisymmetric import CELLS, RIMS, Press, climb

Array = np.ndarray

# The punch of the tables, which makes castability (in mm) a matter of ratios: 14 x 14 mm as a circle.
RADIUS_MM = PUNCH_RADIUS_MM
EVEN = 160


@dataclass(frozen=True)
class Design:
    """Ranges and depths of one kind.

    Attributes
    ----------
    low, high : ndarray, shape (k,)
        Ends of the points; solved a little beyond what the table offers, so that its ends lie inside.
    depths : ndarray
        d / h that are solved.
    cells : int
        Under the punch.
    """

    kind: str
    low: Array
    high: Array
    depths: Array
    cells: int

    @property
    def margin(self) -> Array:
        """What the table leaves away at each end."""
        return 0.02 * (self.high - self.low)

    def shape(self, point: Array) -> tuple[PadShape, float]:
        """Shape and thickness [mm] of a point."""
        h = float(RADIUS_MM * np.exp(point[0]))
        first = float(point[1] * h)
        if self.kind == "layered":
            return Layered(first, float(np.exp(point[2]))), h
        foot = float(RADIUS_MM * np.exp(point[2]))
        if self.kind == "boned":
            return Boned((foot**2 + first**2) / (2.0 * first), first, foot), h
        return Crowned(float(point[3] * foot**2 / first), first, foot), h

    def castable(self, point: Array) -> bool:
        """Whether the pad of a point can be cast."""
        shape, h = self.shape(point)
        try:
            shape.check(h)
        except InputError:
            return False
        return True

    def points(self, count: int) -> Array:
        """Castable points of the Sobol sequence, shape (count, k).

        Of crowned pads the first 160 are even in s, all others in ln s: soft tissues ask for pointed crowns.
        """
        from scipy.stats import qmc

        raw = qmc.Sobol(len(self.low), scramble=False).random_base2(14)[1:]
        points = self.low + (self.high - self.low) * raw
        if self.kind != "crowned":
            return np.array([point for point in points[: 12 * count] if self.castable(point)][:count])
        even = [point for point in points[:8000] if self.castable(point)][: min(count, EVEN)]
        later = points[8000:].copy()
        later[:, 3] = self.low[3] * (self.high[3] / self.low[3]) ** raw[8000:, 3]
        pointed = [point for point in later if self.castable(point)][: count - len(even)]
        return np.array(even + pointed)

    def fresh(self, count: int) -> Array:
        """Random castable points inside the table's own ranges, for its error."""
        rng = np.random.default_rng(20)
        inside = 2.0 * self.margin
        points = rng.uniform(self.low + inside, self.high - inside, (800, len(self.low)))
        return np.array([point for point in points if self.castable(point)][:count])

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad; ``finer`` halves the cells (and the bead of a flat-topped pad).

        Returns
        -------
        dict
            ``point``; ``force``: F / (E a^2) with each bead (crowned) or the factor over the slab, at the depths that
            were reached; ``stop``: why they ended.
        """
        shape, h = self.shape(point)
        press = Press(shape, h, RADIUS_MM / h, EXTENT_OVER_RADIUS * RADIUS_MM / h)
        cells = self.cells * 2 if finer else self.cells
        law = Yeoh(1.0)
        if self.kind == "crowned":
            paths = [climb(press, law, self.depths, cells, rim) for rim in RIMS]
            values = [path.force / 3.0 * (h / RADIUS_MM) ** 2 for path in paths]
        else:
            rim = RIMS[1] if finer else RIMS[0]
            paths = [climb(press, law, self.depths, cells, rim, twin) for twin in (False, True)]
            count = min(len(path.force) for path in paths)
            values = [paths[0].force[:count] / paths[1].force[:count]]
        return {
            "point": [float(x) for x in point],
            "force": [[float(f"{value:.7g}") for value in row] for row in values],
            "stop": [path.stop for path in paths],
        }


_CROWNED_DEPTHS = np.array([0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6])
_FLAT_DEPTHS = np.array([0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6])
_THICK = np.log(0.48), np.log(3.3)
_FOOT = np.log(0.36), np.log(1.8)
_STIFF = np.log(0.08), np.log(12.5)

DESIGNS = {
    "crowned": Design(
        "crowned", np.array([_THICK[0], 0.17, _FOOT[0], 0.085]), np.array([_THICK[1], 0.78, _FOOT[1], 0.72]),
        _CROWNED_DEPTHS, CELLS,
    ),
    "layered": Design(
        "layered", np.array([_THICK[0], 0.14, _STIFF[0]]), np.array([_THICK[1], 0.86, _STIFF[1]]), _FLAT_DEPTHS, 12
    ),
    "boned": Design(
        "boned", np.array([_THICK[0], 0.14, _FOOT[0]]), np.array([_THICK[1], 0.76, _FOOT[1]]), _FLAT_DEPTHS, 12
    ),
}  # fmt: skip
