"""A shaped pad under a punch in space, and the grid lines and levels that fit it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from dummydesign.geometry.shapes import PadShape
from dummydesign.pad.fem import mesh_hexahedra as space

Array = np.ndarray

# Cell at the first touch: this over ``Grid.cells``, of the contact radius sqrt(R d) at the first depth.
APEX_CELLS = 4.0
# Height of the uppermost cells over the thickness: this over ``Grid.cells``.
HEIGHT_CELLS = 1.0


@dataclass(frozen=True)
class Grid:
    """How fine the grid is.

    Attributes
    ----------
    cells : int
        Cells over half the punch's width, at least.
    rim : float
        Fillet at the punch's edge over the smaller of the punch's half side and the thickness.
    slope : float
        Growth of the cells per distance from where they are fine.
    height_growth : float
        Largest ratio of the heights of neighbouring cells.
    """

    cells: int = 7
    rim: float = 0.1
    slope: float = 0.7
    height_growth: float = 1.6

    def coarser(self) -> Grid:
        """Cells about 1.5 times as large, the same fillet."""
        return replace(self, cells=max(3, round(self.cells / 1.5)), slope=1.2 * self.slope)


@dataclass(frozen=True)
class Load:
    """A pad and the punch on it, lengths in thicknesses (those of the shape in mm).

    ``half_sides`` are those of a rectangular punch; a round one has its radius in both and ``is_round`` set.
    ``first`` is the smallest depth of interest. ``homogeneous`` leaves out bone and second resin.
    """

    shape: PadShape
    thickness_mm: float
    half_sides: tuple[float, float]
    half_extents: tuple[float, float]
    is_round: bool = False
    offset: tuple[float, float] = (0.0, 0.0)
    base: str = "bonded"
    condition: str = "bonded"
    poisson: float = 0.5
    first: float = 0.05
    homogeneous: bool = False

    @property
    def scale(self) -> float:
        """The smaller of half side and thickness, over the thickness."""
        return min(*self.half_sides, 1.0)

    @property
    def multiplicity(self) -> int:
        """How often the meshed part makes up the whole."""
        return 2 ** sum(shift == 0.0 for shift in self.offset)

    def heights(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Level of the bone and of the tested face, the highest point at 0 and the base at -1."""
        h = self.thickness_mm
        bone = 0.0 * x if self.homogeneous else self.shape.bone_mm(x * h, y * h) / h
        return bone - 1.0, -self.shape.drop_mm(x * h, y * h) / h


def graded_lines(start: float, stop: float, marks: Sequence[float], size: Callable[[Array], Array]) -> Array:
    """Points whose cells follow a wanted size and which meet every mark.

    Parameters
    ----------
    start, stop : float
        First and last point, in thicknesses.
    marks : sequence of float
        Points that must be met; those outside do not count.
    size : callable
        Maps places (n,) to the wanted size of a cell there.

    Returns
    -------
    ndarray, shape (cells + 1,)
    """
    ends = np.unique(np.concatenate([[start, stop], [mark for mark in marks if start < mark < stop]]))
    found = [start]
    for low, high in pairwise(ends):
        fine = np.linspace(low, high, 400)
        density = 1.0 / size(fine)
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
        cells = max(1, int(np.ceil(count[-1] - 0.3)))
        found.extend(np.interp(count[-1] * np.arange(1, cells + 1) / cells, count, fine))
    return np.array(found)


def _tip(load: Load, axis: int) -> float:
    """Radius of curvature of the tested face at its highest point along one axis, in thicknesses; inf if flat."""
    at = np.zeros((2, 1))
    at[axis] = 1e-3
    fall = float(-load.heights(*at)[1][0])
    return np.inf if fall <= 0.0 else 1e-6 / (2.0 * fall)


def axis_lines(load: Load, grid: Grid, axis: int) -> Array:
    """Grid lines along one side of the pad.

    Parameters
    ----------
    load : Load
        Pad and punch in thicknesses.
    grid : Grid
        Cells under the punch and their growth.
    axis : int
        0 along the length, 1 across.

    Returns
    -------
    ndarray, shape (cells + 1,)
    """
    half, shift, extent = load.half_sides[axis], load.offset[axis], load.half_extents[axis]
    rim = grid.rim * load.scale
    coarse = half / grid.cells
    places, sizes = [shift + half - rim, shift - half + rim], [min(coarse, rim)] * 2
    tip = _tip(load, axis)
    if np.isfinite(tip):
        places.append(0.0)
        # A first contact of radius sqrt(R d) is to span some cells.
        sizes.append(min(coarse, APEX_CELLS / grid.cells * np.sqrt(tip * load.first)))

    def size(x: Array) -> Array:
        near = [least + grid.slope * np.abs(x - place) for place, least in zip(places, sizes)]
        away = np.maximum(np.abs(x - shift) - half, 0.0)
        return np.minimum(np.min(near, axis=0), coarse + grid.slope * away)

    start = 0.0 if shift == 0.0 else -extent
    return graded_lines(start, extent, (places[0], places[1], 0.0), size)


def levels(load: Load, grid: Grid) -> Array:
    """Levels of the reference slab from -1 to 0; one lies between the layers."""
    first = min(min(load.half_sides), HEIGHT_CELLS) / grid.cells
    layers = load.shape.layers()
    if layers is None:
        return -space.lines(1.0, first, grid.height_growth)[::-1]
    between = layers[0] / load.thickness_mm
    upper = space.lines(between, min(first, between / 3.0), grid.height_growth)
    lower = between + space.lines(1.0 - between, min(upper[-1] - upper[-2], (1.0 - between) / 3.0), grid.height_growth)
    return -np.concatenate([upper, lower[1:]])[::-1]
