"""Force of a pad of a one-term Ogden law over that of the neo-Hookean pad of the same modulus."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import user_library as json_table
from dummydesign.core.interpolation import between
from dummydesign.core.quantity import Quantity
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.material.hyperelastic import Array, HyperelasticLaw, Ogden, Yeoh

NAME = "elastic-law.json"
COMMAND = "python -m studies.tables.elastic_law"
RINGS = 24


@dataclass(frozen=True)
class ElasticTable:
    """s and q over a / h and d / h: ln of the factor is (alpha - 2) s + (alpha - 2)^2 q; and what it misses.

    ``crown_slope`` and ``crown_bend`` over d / h are what is added to s and q of a crowned pad. ``error`` over d / h is
    that of ln of the factor over alpha - 2 at an exponent that was not used, ``crown_error`` that of crowned pads.
    """

    ratio: Array
    depth: Array
    slope: Array
    bend: Array
    error: Array
    crown_slope: Array
    crown_bend: Array
    crown_error: Array
    alpha_range: tuple[float, float]

    def factor(
        self, alpha: float, depth: ArrayLike, ratio: ArrayLike, shape: str = "slab", drop: ArrayLike = 0.0
    ) -> tuple[Array, Array]:
        """Factor and its relative error at d / h and a / h (broadcast), held at the table's ends.

        A crowned pad is first taken as a slab that is thinner, and pressed less deep, by the crown's mean drop under
        the punch over h (:func:`mean_drop_mm`). Any other ``shape`` than these has 1, and the slabs' as error.
        """
        share, left = np.asarray(depth, float), 1.0 - np.asarray(drop, float)
        pressed = np.maximum(share - drop, 0.0) / left
        x, y = np.broadcast_arrays(pressed, np.log(np.asarray(ratio, float) / left))
        away, rows = alpha - 2.0, np.log(self.ratio)
        slope, bend = (between(x, y, self.depth, rows, one) for one in (self.slope, self.bend))
        error = abs(away) * np.interp(x, self.depth, self.error)
        if shape == "crowned":
            own = (self.crown_slope, self.crown_bend, self.crown_error)
            of_slope, of_bend, of_error = (np.interp(share, self.depth, one) for one in own)
            slope, bend, error = slope + of_slope, bend + of_bend, error + abs(away) * of_error
        factor = np.exp(away * slope + away**2 * bend)
        if shape not in ("slab", "crowned"):
            return np.ones_like(factor), error + np.abs(factor - 1.0)
        return factor, error


@lru_cache(maxsize=1)
def load_elastic_table() -> ElasticTable:
    """Read the shipped table."""
    return json_table.read(NAME, "table", COMMAND, lambda data: fill_table(ElasticTable, data))


def mean_drop_mm(shape: PadShape, radius_mm: float) -> float:
    """Mean drop of a pad's face under a punch. [mm]"""
    rings = radius_mm * np.sqrt((np.arange(RINGS) + 0.5) / RINGS)
    return float(np.mean(shape.drop_mm(rings, np.zeros(RINGS))))


def exponent_of(law: HyperelasticLaw) -> float | None:
    """Exponent of a law that the table holds: neo-Hookean, or one Ogden term; None of any other."""
    if law == Yeoh(1.0):
        return 2.0
    if not isinstance(law, Ogden) or len(law.alpha) > 1:
        return None
    low, high = load_elastic_table().alpha_range
    return law.alpha[0] if low <= law.alpha[0] <= high else None


def ogden_law(alpha: float) -> Ogden:
    """The one-term law of unit shear modulus."""
    return Ogden([2.0 / alpha], [alpha])


def elastic_factor(
    depth_mm: ArrayLike,
    thickness_mm: ArrayLike,
    radius_mm: ArrayLike,
    alpha: Quantity,
    shape: str = "slab",
    drop_mm: ArrayLike = 0.0,
) -> tuple[Array, Array]:
    """Factor of an exponent known to an interval, which is in the error; see :meth:`ElasticTable.factor`.

    Parameters
    ----------
    depth_mm, thickness_mm, radius_mm : array_like
        Depth, thickness of the pad, radius of the circle of the punch's area; broadcast. [mm]
    alpha : Quantity
        Exponent of the Ogden law.
    shape : str
        Kind of the pad on a glued base under a glued flat punch; another word for what is not.
    drop_mm : array_like
        Mean drop of a crown under the punch. [mm]
    """
    thickness = np.asarray(thickness_mm, float)
    at = np.divide(depth_mm, thickness), np.divide(radius_mm, thickness), shape, np.divide(drop_mm, thickness)
    table = load_elastic_table()
    (value, error), (low, _), (high, _) = (table.factor(one, *at) for one in (alpha.value, alpha.low, alpha.high))
    return value, error + np.maximum(np.abs(low / value - 1.0), np.abs(high / value - 1.0))
