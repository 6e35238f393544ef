"""A square punch over the round punch of equal area."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import user_library as json_table
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.conic import conic_radius, conic_sag
from dummydesign.geometry.punch import punch_sides_mm
from dummydesign.pad.force_law import Array, ForceLaw, ScaledLaw
from dummydesign.pad.tables.slab import SeriesTable, check_base, check_ratio, square_doubt

# Half side of a square over the radius of the circle of its area.
SIDE_OVER_RADIUS = float(np.sqrt(np.pi) / 2.0)
# Relative error added at twice the solved depth, an assumption: half of the corner's effect on a thick pad.
HELD_ERROR = 0.015
# Share of what the factor of sharp edges changes that is doubted where the edge is a fillet, an assumption.
DOUBTED_WITH_FILLET = 0.5


def combined_depth(depth: ArrayLike, ratio: ArrayLike) -> Array:
    """Depth over thickness times sqrt(1 + (h/a)^2): d/h on thin pads, d/a on thick ones, smooth between."""
    return np.asarray(depth, dtype=float) * np.sqrt(1.0 + 1.0 / np.asarray(ratio, dtype=float) ** 2)


class SquareTable(SeriesTable):
    """Square over circle on one kind of base, over the combined depth; see ``studies.tables.square``."""

    def factor(self, depth: ArrayLike, ratio: ArrayLike) -> tuple[Array, Array]:
        """Factor and its relative error at d / h and a / h (broadcast)."""
        ratio = np.asarray(ratio, dtype=float)
        y, ratio = np.broadcast_arrays(np.maximum(combined_depth(depth, ratio), 0.0), ratio)
        reach = self.depth_limit(ratio)
        inside = np.minimum(y, reach)
        error = self.error_at(inside, ratio) + HELD_ERROR * (y / reach - inside / reach)
        return np.exp(self.log(inside, ratio)), error


@lru_cache(maxsize=4)
def load_square(base: str = "bonded") -> SquareTable:
    """Read the factors of one base."""
    check_base(base)
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


@dataclass(frozen=True)
class CrownTable:
    """A square punch on a crown over the circle of its area; see :func:`crown_factor`."""

    coefficients: Array
    error: float
    foot_error: float


@lru_cache(maxsize=1)
def load_crown() -> CrownTable:
    """Read the numbers of the factor of crowns."""
    command = "python -m studies.tables.square_crown"
    return json_table.read("square-crowned.json", "factor of crowns", command, partial(fill_table, CrownTable))


NODES, WEIGHTS = (0.5 * one for one in np.polynomial.legendre.leggauss(6))
NODES = NODES + 0.5
# Radii over the circle's at which its area and the square's differ, and how much of each ring the square has more.
_RINGS = [SIDE_OVER_RADIUS, 1.0, SIDE_OVER_RADIUS * np.sqrt(2.0)]
RING = np.concatenate([low + (high - low) * NODES for low, high in pairwise(_RINGS)])
RING_WEIGHT = np.concatenate([(high - low) * WEIGHTS for low, high in pairwise(_RINGS)])
RING_WEIGHT = RING_WEIGHT * RING * ((RING > 1.0) - 4.0 / np.pi * np.arccos(SIDE_OVER_RADIUS / RING))
# Share of the depth at which the contact reaches the square's side from which the error begins.
ERROR_BEGINS = 0.7
# Feet over the circle's radius up to which the solved factors scatter on thin pads, and how far beyond.
FOOT, FOOT_WIDTH = 0.96, 0.12


def crown_factor(
    depth_mm: ArrayLike,
    thickness_mm: ArrayLike,
    radius_mm: ArrayLike,
    crown: Mapping[str, ArrayLike],
    table: CrownTable | None = None,
) -> tuple[Array, Array]:
    """Static force on a round crown under a square punch over that under the circle of its area, and its error.

    The crown's corners lie deeper than the circle's rim. Pressures go with a power of the overlap e = k d - sag, so
    that the factor is 1 + A (S - C) / C, with S and C the integrals of e^m over square and circle; k, A and m go with
    powers of thickness over radius. It is 1 until the contact reaches the square's sides. Where the corners are in
    contact it has as much of the slab's factor as the overlap there is of that at the tip.

    Parameters
    ----------
    depth_mm, thickness_mm, radius_mm : array_like, broadcast
        Depth, thickness at the tip, radius of the circle. [mm]
    crown : mapping of str to array_like
        ``radius`` of the tip, ``height`` and ``foot``, broadcast with the depth. [mm]
    """
    table = table or load_crown()
    given = (depth_mm, thickness_mm, radius_mm, *(crown[name] for name in ("radius", "height", "foot")))
    depth, h, a, tip, height, foot = (np.asarray(one, float)[..., None] for one in given)
    log = np.log(h / a)
    k, m, strength = (np.exp(one + slope * log) for one, slope in table.coefficients.reshape(3, 2))
    reach = k * np.maximum(depth, 1e-9 * h)

    def overlap(r: Array) -> Array:
        return np.maximum(reach - conic_sag(r, tip, height, foot), 0.0)

    inner = np.minimum(foot, a)
    # to the contact's rim on the crown, then over the flat around it
    rim = np.where(reach < height, np.minimum(conic_radius(reach, tip, height, foot), inner), inner)
    circle = (overlap(rim * NODES) ** m * rim**2 * NODES) @ WEIGHTS
    circle += 0.5 * (np.maximum(reach - height, 0.0) ** m * (a**2 - inner**2))[..., 0]
    more = (overlap(a * RING) ** m * a**2) @ RING_WEIGHT
    value = 1.0 + strength[..., 0] * more / circle
    # of pads beyond the slab's table the factor is that of its end
    ends = load_square().ratio_range
    of_slab, doubt = load_square().factor((depth / h)[..., 0], np.clip(a / h, *ends)[..., 0])
    corner = (overlap(np.sqrt(2.0) * SIDE_OVER_RADIUS * a) / reach)[..., 0]
    value = value * (1.0 + (of_slab - 1.0) * corner)
    met = (reach / conic_sag(SIDE_OVER_RADIUS * a, tip, height, foot))[..., 0]
    begun = np.clip((met - ERROR_BEGINS) / (1.0 - ERROR_BEGINS), 0.0, 1.0)
    near = np.exp(-((np.maximum(foot / a - FOOT, 0.0) / FOOT_WIDTH) ** 2)) * np.clip((1.35 - h / a) / 0.35, 0.0, 1.0)
    return value, begun * (table.error + table.foot_error * near[..., 0]) + doubt * corner


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
