"""Meshes of shaped pads: columns of quadrilaterals between a bone and a top, fine where the punch works.

Lengths are in thicknesses of the pad. Radii follow a size field; heights follow one graded list that is
stretched, column by column, between the bone and the tested face.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dummydesign.pad.fem.mesh_axisymmetric import graded

Array = np.ndarray

# Cells grow by this share of their distance from where they are wanted fine.
SIZE_SLOPE = 0.25
Z_GROWTH = 1.35


@dataclass(frozen=True)
class Sizes:
    """Where cells are to be how small: places and sizes, and the largest size inside ``reach``."""

    places: tuple[float, ...]
    sizes: tuple[float, ...]
    largest: float
    reach: float

    def at(self, r: Array) -> Array:
        """Wanted cell size at radii."""
        near = [size + SIZE_SLOPE * np.abs(r - place) for place, size in zip(self.places, self.sizes)]
        inside = self.largest + SIZE_SLOPE * np.maximum(r - self.reach, 0.0)
        return np.minimum(np.min(near, axis=0), inside)


def radial_lines(sizes: Sizes, lines: Sequence[float], extent: float) -> Array:
    """Radii from 0 to the outer radius that follow the wanted sizes and meet every marked radius.

    Parameters
    ----------
    sizes : Sizes
        Wanted size of a cell at each radius.
    lines : sequence of float
        Radii that must be met: kinks of the profile, the punch's edge.
    extent : float
        Outer radius, in the unit of the others.

    Returns
    -------
    ndarray, shape (cells + 1,)
    """
    marks = np.unique(np.concatenate([[0.0, extent], [x for x in lines if 0.0 < x < extent]]))
    found = [0.0]
    for start, stop in pairwise(marks):
        fine = start + (stop - start) * np.linspace(0.0, 1.0, 400)
        density = 1.0 / sizes.at(fine)
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
        cells = max(1, int(np.ceil(count[-1] - 0.2)))
        found.extend(np.interp(count[-1] * np.arange(1, cells + 1) / cells, count, fine))
    return np.array(found)


def height_lines(first: float, interface: float | None = None) -> Array:
    """Shares of the column from 0 (tested face) to 1 (base), graded from ``first``; one lies on ``interface``."""
    if interface is None:
        return graded(0.0, 1.0, first, Z_GROWTH)
    upper = graded(0.0, interface, min(first, interface / 3.0), Z_GROWTH)
    # The lower layer begins with the cell at which the upper one ended, and no larger than a quarter of itself.
    lower = graded(interface, 1.0, min(upper[-1] - upper[-2], (1.0 - interface) / 4.0), Z_GROWTH)
    return np.concatenate([upper, lower[1:]])


def columns(r: Array, share: Array) -> tuple[Array, Array, Array]:
    """Points and quadrilaterals of a tensor grid in radius and -share of the column.

    Returns
    -------
    points : ndarray, shape (2, vertices)
    quads : ndarray of int, shape (4, elements)
        Their third and fourth vertices are the upper ones.
    row : ndarray of int, shape (elements,)
        Which interval of ``share`` an element lies in.
    """
    points = np.stack([np.repeat(r, len(share)), np.tile(-share, len(r))])
    number = np.arange(len(r) * len(share)).reshape(len(r), len(share))
    quads = np.stack([number[:-1, 1:], number[1:, 1:], number[1:, :-1], number[:-1, :-1]]).reshape(4, -1)
    return points, quads, np.tile(np.arange(len(share) - 1), len(r) - 1)


def stretch(drop: Callable[[Array], Array], bone: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Map of (radius, -share) to the pad between -1 + bone(r) and -drop(r)."""

    def move(places: Array) -> Array:
        r, share = places[0], -places[1]
        top = -drop(r)
        return np.stack([r, top + (bone(r) - 1.0 - top) * share])

    return move
