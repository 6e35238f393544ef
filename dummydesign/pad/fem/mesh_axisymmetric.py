"""Axisymmetric meshes of biquadratic quadrilaterals, fine around the punch edge or in columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dummydesign.pad.fem.mesh_hexahedra import rectangle_plan
from dummydesign.pad.fem.mixed_solid import Discretisation
from dummydesign.pad.material.hyperelastic import Array, Axisymmetric

_GAUSS = 0.5 + 0.5 * np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
POINTS = np.stack([np.repeat(_GAUSS, 3), np.tile(_GAUSS, 3)])
"""Points of Gauss on the unit square, shape (2, 9), exact for polynomials of order five along each side."""
WEIGHTS = np.outer([5.0, 8.0, 5.0], [5.0, 8.0, 5.0]).ravel() / 18.0**2
# Middle and ends of the sides among the nine nodes of a cell.
PATCH_SIDES = ((4, 0, 1), (5, 1, 2), (6, 2, 3), (7, 3, 0))
# Which of the three parabolas along x and y make each of the nine functions: at 0, at 1, at 1/2.
_ALONG = ((0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (1, 2), (2, 1), (0, 2), (2, 2))


class Quadrature(NamedTuple):
    """Nodal functions at the points of all elements."""

    value: Array
    slope: Array
    position: Array
    area: Array
    turn: Array


def functions(places: Array) -> tuple[Array, Array]:
    """The nine functions (points, 9) and their slopes (points, 2, 9) at places (2, points) of the unit square."""
    back = 1.0 - places
    value = np.stack([back * (1.0 - 2.0 * places), places * (2.0 * places - 1.0), 4.0 * places * back])
    slope = np.stack([4.0 * places - 3.0, 4.0 * places - 1.0, 4.0 - 8.0 * places])
    pairs = [(value[i, 0], slope[i, 0], value[j, 1], slope[j, 1]) for i, j in _ALONG]
    slopes = np.stack([np.stack([dx * y, x * dy]) for x, dx, y, dy in pairs], axis=-1)
    return np.stack([x * y for x, _, y, _ in pairs], axis=-1), slopes.transpose(1, 0, 2)


def nine_nodes(points: Array, quads: Array) -> tuple[Array, Array]:
    """Places (2, n) of all nodes of straight quadrilaterals, and those of each, shape (elements, 9)."""
    vertices, elements = points.shape[1], quads.shape[1]
    ends = np.sort(np.concatenate([quads[[i, j]].T for _, i, j in PATCH_SIDES]), axis=1)
    sides, number = np.unique(ends, axis=0, return_inverse=True)
    middle = vertices + len(sides) + np.arange(elements)
    node = np.column_stack([quads.T, vertices + number.reshape(4, elements).T, middle])
    return np.hstack([points, points[:, sides].mean(axis=2), points[:, quads].mean(axis=1)]), node


def integrate(places: Array, node: Array) -> Quadrature:
    """Nodal functions, their slopes and areas at the points of elements with curved sides."""
    value, local = functions(POINTS)
    corners = places[:, node]
    turn = np.einsum("cei,qdi->eqcd", corners, local)
    area = turn[..., 0, 0] * turn[..., 1, 1] - turn[..., 0, 1] * turn[..., 1, 0]
    back = np.stack([turn[..., 1, 1], -turn[..., 1, 0], -turn[..., 0, 1], turn[..., 0, 0]], axis=-1)
    back = back.reshape(*area.shape, 2, 2) / area[..., None, None]
    return Quadrature(value, back @ local, corners @ value.T, np.abs(area) * WEIGHTS, back)


_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Resolution:
    """How fine a mesh is: cells per half box at the edge, growth away from it, and the web's rings."""

    cells: int = 3
    growth: float = 1.35
    box: float = 0.32


def graded(start: float, stop: float, first: float, growth: float) -> Array:
    """Points from ``start`` to ``stop`` whose cells grow by ``growth`` from about ``first``."""
    length = abs(stop - start)
    if growth > 1.0:
        count = max(1, int(np.ceil(np.log(1.0 + length * (growth - 1.0) / first) / np.log(growth))))
    else:
        count = max(1, round(length / first))
    edges = np.concatenate([[0.0], np.cumsum(growth ** np.arange(count))])
    return start + (stop - start) * edges / edges[-1]


def web_mesh(
    edge: float, extent: float, half_box: float, rings: int, resolution: Resolution
) -> tuple[Array, Array, Array]:
    """Mesh the slab 0 <= r <= extent, -1 <= z <= 0 with a web of quadrilaterals around (edge, 0)."""
    cells, growth = resolution.cells, resolution.growth
    first = half_box / cells
    box = np.linspace(-half_box, half_box, 2 * cells + 1)
    inner = graded(edge - half_box, 0.0, first, growth)[::-1]
    outer = graded(edge + half_box, extent, first, growth)
    r = np.concatenate([inner[:-1], edge + box, outer[1:]])
    z = np.concatenate([np.linspace(0.0, -half_box, cells + 1)[:-1], graded(-half_box, -1.0, first, growth)])
    left, right = len(inner) - 1, len(inner) - 1 + 2 * cells
    number, outside = np.full((len(r), len(z)), -1), np.ones((len(r), len(z)), dtype=bool)
    outside[left + 1 : right, :cells] = False
    number[outside] = np.arange(outside.sum())
    points = np.stack(np.meshgrid(r, z, indexing="ij"), axis=-1)[outside]
    kept = np.ones((len(r) - 1, len(z) - 1), dtype=bool)
    kept[left:right, :cells] = False
    quads = [np.stack([number[:-1, 1:], number[1:, 1:], number[1:, :-1], number[:-1, :-1]])[:, kept]]
    ring = np.concatenate([number[left, :cells], number[left:right, cells], number[right, cells::-1]])
    corner = np.array([edge, 0.0])
    rim = points[ring] - corner
    for k in range(rings):
        smaller = len(points) + np.arange(len(rim))
        points = np.concatenate([points, corner + rim * (0.5 ** (k + 1) if k < rings - 1 else 0.0)])
        quads.append(np.stack([ring[:-1], ring[1:], smaller[1:], smaller[:-1]]))
        ring = smaller
    return points.T, np.concatenate(quads, axis=1), ring


def discretise(
    points: Array,
    quads: Array,
    centre: Array | None = None,
    quarter_points: bool = False,
    move: Callable[[Array], Array] | None = None,
) -> Discretisation:
    """Build the biquadratic discretisation of a quadrilateral mesh in the (r, z) plane."""
    places, node = nine_nodes(points, quads)
    if quarter_points:
        assert centre is not None
        places = _to_quarter(places, quads, node, centre)
    if move is not None:
        places = move(places)
    at = integrate(places, node)
    r = at.position[0]
    elements, n_points = r.shape
    gradient = np.zeros((elements, n_points, 5, 18))
    gradient[:, :, 0:2, 0::2] = gradient[:, :, 2:4, 1::2] = at.slope
    gradient[:, :, 4, 0::2] = at.value / r[..., None]
    x, y = POINTS
    if centre is not None:
        centre_point = points[:, centre[0]]
        together = np.nonzero(np.all(np.abs(places - centre_point[:, None]) < 1e-12, axis=0))[0]
        alias = np.arange(places.shape[1])
        alias[together] = together[0]
        node = alias[node]
    return Discretisation(
        gradient=gradient,
        weight=at.area * 2.0 * np.pi * r,
        pressure_basis=np.stack([np.ones(n_points), 2.0 * x - 1.0, 2.0 * y - 1.0], axis=1),
        dofs=np.stack([2 * node, 2 * node + 1], axis=2).reshape(elements, 18),
        nodes=places,
        kinematics=Axisymmetric,
        reference=(np.concatenate([functions(POINTS)[1].transpose(1, 0, 2), at.value[None]]), at.turn),
    )


def _to_quarter(places: Array, quads: Array, node: Array, centre: Array) -> Array:
    places = places.copy()
    corner = places[:, centre[0]][:, None]
    at_centre = np.zeros(places.shape[1], dtype=bool)
    at_centre[centre] = True
    nodes = node.T
    for element in np.nonzero(at_centre[quads].sum(axis=0) == 2)[0]:
        vertices = quads[:, element]
        far = vertices[~at_centre[vertices]]
        for side, i, j in PATCH_SIDES:
            ends = vertices[[i, j]]
            if at_centre[ends].sum() == 1:
                end = ends[~at_centre[ends]][0]
                places[:, nodes[side, element]] = (corner[:, 0] * 3.0 + places[:, end]) / 4.0
        places[:, nodes[8, element]] = (corner[:, 0] * 3.0 + places[:, far].mean(axis=1)) / 4.0
    return places


def cell_nodes(mesh: Discretisation) -> Array:
    """Nodes of each element, shape (elements, 9): corners, mid-sides, middle."""
    return mesh.dofs.reshape(len(mesh.dofs), 9, 2)[:, :, 0] // 2


def cell_sides(mesh: Discretisation) -> Array:
    """Sides of all cells but those drawn together to a point; node numbers, shape (sides, 3), by r or z."""
    nodes = cell_nodes(mesh)
    three = np.concatenate([nodes[:, [i, side, j]] for side, i, j in PATCH_SIDES])
    length = np.linalg.norm(mesh.nodes[:, three[:, 0]] - mesh.nodes[:, three[:, 2]], axis=0)
    return three[length > 1e-12]


def edges_on(mesh: Discretisation, on: Array) -> Array:
    """Sides whose three nodes all satisfy ``on`` (bool per node); see :func:`cell_sides`."""
    three = cell_sides(mesh)
    return three[on[three].all(axis=1)]


def on_top(mesh: Discretisation) -> Array:
    """Nodes on z = 0."""
    return np.abs(mesh.nodes[1]) < _TOLERANCE


def on_base(mesh: Discretisation, thickness: float) -> Array:
    """Nodes on z = -thickness."""
    return np.abs(mesh.nodes[1] + thickness) < _TOLERANCE


def on_axis(mesh: Discretisation) -> Array:
    """Nodes on r = 0."""
    return mesh.nodes[0] < _TOLERANCE


Z_GROWTH = 1.35


@dataclass(frozen=True)
class Sizes:
    """Wanted sizes of cells by place, their growth away from there, the largest within ``reach`` of the ``middle``."""

    places: Sequence[float]
    sizes: Sequence[float]
    slope: float
    largest: float
    reach: float
    middle: float = 0.0

    def at(self, x: Array) -> Array:
        """Wanted cell size at radii, or distances across."""
        near = [size + self.slope * np.abs(x - centre) for centre, size in zip(self.places, self.sizes)]
        inside = self.largest + self.slope * np.maximum(np.abs(x - self.middle) - self.reach, 0.0)
        return np.minimum(np.min(near, axis=0), inside)


def lines_by_size(
    start: float, stop: float, marks: Sequence[float], size: Callable[[Array], Array], spare: float
) -> Array:
    """Points whose cells follow a wanted size and which meet every mark; a rest below ``spare`` of a cell adds none."""
    ends = np.unique(np.concatenate([[start, stop], [mark for mark in marks if start < mark < stop]]))
    lines = [start]
    for low, high in pairwise(ends):
        fine = low + (high - low) * np.linspace(0.0, 1.0, 400)
        density = 1.0 / size(fine)
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))])
        cells = max(1, int(np.ceil(count[-1] - spare)))
        lines.extend(np.interp(count[-1] * np.arange(1, cells + 1) / cells, count, fine))
    return np.array(lines)


def height_lines(first: float, interface: float | None = None) -> Array:
    """Shares of the column from 0 (tested face) to 1 (base), graded from ``first``; one lies on ``interface``."""
    if interface is None:
        return graded(0.0, 1.0, first, Z_GROWTH)
    upper = graded(0.0, interface, min(first, interface / 3.0), Z_GROWTH)
    # The lower layer begins with the cell at which the upper one ended, and no larger than a quarter of itself.
    lower = graded(interface, 1.0, min(upper[-1] - upper[-2], (1.0 - interface) / 4.0), Z_GROWTH)
    return np.concatenate([upper, lower[1:]])


def columns(r: Array, share: Array) -> tuple[Array, Array, Array]:
    """Points and quadrilaterals of a tensor grid in radius and -share of the column."""
    points, quads = rectangle_plan(r, -share)
    return points, quads[::-1], np.tile(np.arange(len(share) - 1), len(r) - 1)


def stretch(drop: Callable[[Array], Array], bone: Callable[[Array], Array]) -> Callable[[Array], Array]:
    """Map of (radius, -share) to the pad between -1 + bone(r) and -drop(r)."""

    def move(places: Array) -> Array:
        r, share = places[0], -places[1]
        top = -drop(r)
        return np.stack([r, top + (bone(r) - 1.0 - top) * share])

    return move
