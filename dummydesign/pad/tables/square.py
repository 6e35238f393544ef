"""How much more a square punch carries than the round punch of equal area.

The factor was computed by finite elements in space (see ``pad.slab.square_sharp`` and ``studies.tables.square``) up
to the depth at which the cell at the punch's corner folds, about 0.5 of the smaller of radius and thickness. Beyond
that the factor of that depth is held, and its stated error grows by ``HELD_ERROR`` per such depth.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.interface import BASES
from dummydesign.pad.tables.edge_doubt import square_doubt
from dummydesign.pad.tables.interpolation import between

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
    """Read the factors of one base.

    Raises
    ------
    InputError
        For another base.
    NoAnswerError
        When the file is missing or damaged, with the command that rebuilds it.
    """
    if base not in BASES:
        raise InputError(f"base = '{base}' has no square factor; known are {', '.join(BASES)}")
    command = "python -m dummydesign.studies.tables.square"
    return json_table.read(f"square-{base}.json", "table of square factors", command, _from_dict)


def _from_dict(data: dict[str, Any]) -> SquareTable:
    listed = ("coefficients", "reach_ratio", "reach_depth", "error_depth", "error")
    fields: dict[str, Any] = {name: np.array(data[name]) for name in listed}
    fields |= {name: tuple(data[name]) for name in ("ratio_range", "depth_range")}
    return SquareTable(**fields, provenance=data["provenance"])


def square_factor(
    depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike, base: str = "bonded", filleted: bool = False
) -> tuple[Array, Array]:
    """Static force under a glued square punch over that under the round punch of equal area.

    Parameters
    ----------
    depth_mm, thickness_mm, radius_mm : array_like
        Depth, thickness of the slab, radius of the circle of equal area; broadcast. [mm]
    base : str
        ``bonded`` or ``sliding``.
    filleted : bool
        Whether the edge is a fillet: the factor is that of sharp edges, and half of what it changes is doubted.

    Returns
    -------
    factor, error : ndarray
        Factor, and its relative error (mesh, corner cell, and depth beyond what was solved).

    Raises
    ------
    InputError
        When a / h is outside the range of the response table.
    """
    table = load_square(base)
    depth, thickness, radius = (np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, radius_mm))
    ratio = radius / thickness
    low, high = table.ratio_range
    bad = ~((ratio >= low * (1.0 - 1e-9)) & (ratio <= high * (1.0 + 1e-9)))
    if np.any(bad):
        raise out_of_range("punch radius over pad thickness", f"{float(ratio[bad].flat[0]):.4g}", low, high)
    value, error = table.factor(depth / thickness, ratio)
    error = np.maximum(error, square_doubt(depth / thickness, ratio))
    return value, error + DOUBTED_WITH_FILLET * np.abs(value - 1.0) if filleted else error
