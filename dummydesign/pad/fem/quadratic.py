"""Biquadratic quadrilaterals: shape functions, their nine nodes, and the nine points of Gauss they are integrated at.

Nodes of an element are its corners, the middles of its sides (first to second corner, and so on) and its own middle;
all are numbered corners first, then sides by their corners, then middles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray

_GAUSS = 0.5 + 0.5 * np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
POINTS = np.stack([np.repeat(_GAUSS, 3), np.tile(_GAUSS, 3)])
"""Points of Gauss on the unit square, shape (2, 9), exact for polynomials of order five along each side."""
WEIGHTS = np.outer([5.0, 8.0, 5.0], [5.0, 8.0, 5.0]).ravel() / 18.0**2
SIDES = ((0, 1), (1, 2), (2, 3), (0, 3))
# Which of the three parabolas along x and y make each of the nine functions: at 0, at 1, at 1/2.
_ALONG = ((0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (1, 2), (2, 1), (0, 2), (2, 2))


class Quadrature(NamedTuple):
    """Nodal functions at the points of all elements.

    Attributes
    ----------
    value : ndarray, shape (points, 9)
    slope : ndarray, shape (elements, points, 2, 9)
        Along both directions of the plane.
    place : ndarray, shape (2, elements, points)
    area : ndarray, shape (elements, points)
        Weight times area.
    """

    value: Array
    slope: Array
    place: Array
    area: Array


def functions(places: Array) -> tuple[Array, Array]:
    """The nine functions (points, 9) and their slopes (points, 2, 9) at places (2, points) of the unit square."""
    back = 1.0 - places
    value = np.stack([back * (1.0 - 2.0 * places), places * (2.0 * places - 1.0), 4.0 * places * back])
    slope = np.stack([4.0 * places - 3.0, 4.0 * places - 1.0, 4.0 - 8.0 * places])
    pairs = [(value[i, 0], slope[i, 0], value[j, 1], slope[j, 1]) for i, j in _ALONG]
    slopes = np.stack([np.stack([dx * y, x * dy]) for x, dx, y, dy in pairs], axis=-1)
    return np.stack([x * y for x, _, y, _ in pairs], axis=-1), slopes.transpose(1, 0, 2)


def nine_nodes(points: Array, quads: Array) -> tuple[Array, Array]:
    """Places (2, n) of all nodes of straight quadrilaterals, and those of each, shape (elements, 9).

    Parameters
    ----------
    points : ndarray, shape (2, vertices)
    quads : ndarray of int, shape (4, elements)
    """
    vertices, elements = points.shape[1], quads.shape[1]
    ends = np.sort(np.concatenate([quads[list(side)].T for side in SIDES]), axis=1)
    sides, number = np.unique(ends, axis=0, return_inverse=True)
    middle = vertices + len(sides) + np.arange(elements)
    node = np.column_stack([quads.T, vertices + number.reshape(4, elements).T, middle])
    return np.hstack([points, points[:, sides].mean(axis=2), points[:, quads].mean(axis=1)]), node


def integrate(places: Array, node: Array) -> Quadrature:
    """Nodal functions, their slopes and areas at the points of elements with curved sides.

    Parameters
    ----------
    places : ndarray, shape (2, n)
        Of all nodes.
    node : ndarray of int, shape (elements, 9)
    """
    value, local = functions(POINTS)
    corners = places[:, node]
    turn = np.einsum("cei,qdi->eqcd", corners, local)
    area = turn[..., 0, 0] * turn[..., 1, 1] - turn[..., 0, 1] * turn[..., 1, 0]
    back = np.stack([turn[..., 1, 1], -turn[..., 1, 0], -turn[..., 0, 1], turn[..., 0, 0]], axis=-1)
    back = back.reshape(*area.shape, 2, 2) / area[..., None, None]
    return Quadrature(value, back @ local, corners @ value.T, np.abs(area) * WEIGHTS)

