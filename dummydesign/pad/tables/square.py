"""A square punch over the round punch of equal area."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import between
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.punch import punch_sides_mm
from dummydesign.pad.force_law import ForceLaw, ScaledLaw
from dummydesign.pad.tables.slab import check_ratio, square_doubt

Array = np.ndarray
# Half side of a square over the radius of the circle of its area.
SIDE_OVER_RADIUS = float(np.sqrt(np.pi) / 2.0)
# Relative error added at twice the solved depth, an assumption: half of the corner's effect on a thick pad.
HELD_ERROR = 0.015
# Share of what the factor of sharp edges changes that is doubted where the edge is a fillet, an assumption.
DOUBTED_WITH_FILLET = 0.5


def combined_depth(depth: ArrayLike, ratio: ArrayLike) -> Array:
    """Depth over thickness times sqrt(1 + (h/a)^2): d/h on thin pads, d/a on thick ones, smooth between."""
    return np.asarray(depth, dtype=float) * np.sqrt(1.0 + 1.0 / np.asarray(ratio, dtype=float) ** 2)


@dataclass(frozen=True)
class SquareTable:
    """Square over circle on one kind of base; arrays as in the file, see ``studies.tables.square``."""

    coefficients: Array
    ratio_range: tuple[float, float]
    depth_range: tuple[float, float]
    reach_ratio: Array
    reach_depth: Array
    error_depth: Array
    error: Array
    provenance: dict[str, Any]

    def factor(self, depth: ArrayLike, ratio: ArrayLike) -> tuple[Array, Array]:
        """Factor and its relative error at d / h and a / h (broadcast)."""
        ratio = np.asarray(ratio, dtype=float)
        y, ratio = np.broadcast_arrays(np.maximum(combined_depth(depth, ratio), 0.0), ratio)
        reach = np.interp(np.log(ratio), np.log(self.reach_ratio), self.reach_depth)
        inside = np.minimum(y, reach)
        low, high = np.log(self.ratio_range)
        u = 2.0 * inside / self.depth_range[1] - 1.0
        v = 2.0 * (np.log(ratio) - low) / (high - low) - 1.0
        value = np.exp(np.polynomial.chebyshev.chebval2d(u, v, self.coefficients))
        error = between(inside, np.log(ratio), self.error_depth, np.log(self.reach_ratio), self.error)
        return value, error + HELD_ERROR * (y / reach - inside / reach)


@lru_cache(maxsize=4)
def load_square(base: str = "bonded") -> SquareTable:
    """Read the factors of one base."""
    if base not in BASES:
        message = f"base = '{base}' has no square factor; known are {', '.join(BASES)}"
        raise InputError(message, "not_tabulated", "base", base, BASES)
    command = "python -m studies.tables.square"
    return json_table.read(f"square-{base}.json", "table of square factors", command, partial(fill_table, SquareTable))


def square_factor(
    depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike, base: str = "bonded", filleted: bool = False
) -> tuple[Array, Array]:
    """Static force under a glued square punch over that under the round punch of equal area."""
    table = load_square(base)
    depth, thickness, radius = (np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, radius_mm))
    ratio = radius / thickness
    check_ratio(ratio, table.ratio_range)
    value, error = table.factor(depth / thickness, ratio)
    error = np.maximum(error, square_doubt(depth / thickness, ratio))
    return value, error + DOUBTED_WITH_FILLET * np.abs(value - 1.0) if filleted else error


def square_law(circle: ForceLaw, base: str, filleted: bool = False) -> ScaledLaw:
    """Force law of a glued square punch: that of the circle of its area times the square's factor."""
    return ScaledLaw(circle, partial(square_factor, base=base, filleted=filleted))


def circle_of(law: ForceLaw) -> ForceLaw:
    """The law of the circle of the punch's area, without the factors of a square and of another elastic law."""
    while isinstance(law, ScaledLaw):
        law = law.law
    return law


def punch_law(circle: ForceLaw, punch: str, base: str = "bonded", filleted: bool = False) -> ForceLaw:
    """The force law of a glued punch from that of the circle of its area; only squares differ.

    A rectangle counts as the circle: its factor depends on its sides and is solved by ``--fidelity 3d``.
    """
    sides = punch_sides_mm(punch)
    return square_law(circle, base, filleted) if sides is not None and sides[0] == sides[1] else circle
