"""Axisymmetric meshes of quadrilaterals: a slab, fine in a spider web around the punch edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.pad.fem.mixed_solid import Discretisation
from dummydesign.pad.fem.quadratic import POINTS, integrate, nine_nodes
from dummydesign.pad.material.kinematics import Axisymmetric

Array = np.ndarray
_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Resolution:
    """How fine a mesh is: cells per half box at the edge, growth away from it, and the web's rings."""

    cells: int = 3
    growth: float = 1.35
    box: float = 0.32

    def finer(self) -> Resolution:
        """A mesh of about half the cell size everywhere."""
        return Resolution(2 * self.cells, self.growth**0.5, self.box)


def graded(start: float, stop: float, first: float, growth: float) -> Array:
    """Points from ``start`` to ``stop`` whose cells grow by ``growth`` from about ``first``.

    Parameters
    ----------
    start, stop : float
        First and last point, in any unit of length.
    first, growth : float
        Size of the first cell, and of each cell over the one before; 1 for even cells.

    Returns
    -------
    ndarray, shape (cells + 1,)
    """
    length = abs(stop - start)
    if growth > 1.0:
        count = max(1, int(np.ceil(np.log(1.0 + length * (growth - 1.0) / first) / np.log(growth))))
    else:
        count = max(1, round(length / first))
    edges = np.concatenate([[0.0], np.cumsum(growth ** np.arange(count))])
    return start + (stop - start) * edges / edges[-1]


def web_mesh(
    edge: float, thickness: float, extent: float, half_box: float, rings: int, resolution: Resolution
) -> tuple[Array, Array, Array]:
    """Mesh the slab 0 <= r <= extent, -thickness <= z <= 0 with a web of quadrilaterals around (edge, 0).

    Parameters
    ----------
    edge, thickness, extent : float
        Radius at which the web is centred, thickness and outer radius of the slab, in one unit of length.
    half_box : float
        Half width and depth of the box that holds the web.
    rings : int
        Rings of the web, each half the size of the one outside; the innermost is collapsed to the edge.
    resolution : Resolution
        Cells along the box, and their growth outside it.

    Returns
    -------
    points : ndarray, shape (2, vertices)
    quads : ndarray of int, shape (4, elements)
    centre : ndarray of int
        The vertices at the edge; they coincide.
    """
    cells, growth = resolution.cells, resolution.growth
    first = half_box / cells
    box = np.linspace(-half_box, half_box, 2 * cells + 1)
    inner = graded(edge - half_box, 0.0, first, growth)[::-1]
    outer = graded(edge + half_box, extent, first, growth)
    r = np.concatenate([inner[:-1], edge + box, outer[1:]])
    z = np.concatenate([np.linspace(0.0, -half_box, cells + 1)[:-1], graded(-half_box, -thickness, first, growth)])
    left, right = len(inner) - 1, len(inner) - 1 + 2 * cells
    number = np.full((len(r), len(z)), -1)
    points: list[tuple[float, float]] = []
    for i in range(len(r)):
        for j in range(len(z)):
            if not (left < i < right and j < cells):
                number[i, j] = len(points)
                points.append((r[i], z[j]))
    quads = [
        (number[i, j + 1], number[i + 1, j + 1], number[i + 1, j], number[i, j])
        for i in range(len(r) - 1)
        for j in range(len(z) - 1)
        if not (left <= i < right and j < cells)
    ]
    rim = [number[left, j] for j in range(cells)]
    rim += [number[i, cells] for i in range(left, right)]
    rim += [number[right, j] for j in range(cells, -1, -1)]
    corner = np.array([edge, 0.0])
    ring = rim
    for k in range(rings):
        scale = 0.5 ** (k + 1) if k < rings - 1 else 0.0
        smaller = []
        for vertex in rim:
            smaller.append(len(points))
            points.append(tuple(corner + (np.array(points[vertex]) - corner) * scale))
        quads += [(ring[e], ring[e + 1], smaller[e + 1], smaller[e]) for e in range(len(rim) - 1)]
        ring = smaller
    return np.array(points).T, np.array(quads).T, np.array(ring)


def discretise(
    points: Array,
    quads: Array,
    centre: Array | None = None,
    quarter_points: bool = False,
    move: Callable[[Array], Array] | None = None,
) -> Discretisation:
    """Build the biquadratic discretisation of a quadrilateral mesh in the (r, z) plane.

    Parameters
    ----------
    points, quads : ndarray
        Vertices, shape (2, n), and quadrilaterals, shape (4, n).
    centre : ndarray of int, shape (k,), optional
        Coinciding vertices of collapsed quadrilaterals; their nodes are made one.
    quarter_points : bool
        Move the mid-side nodes next to the centre to a quarter of their side, so that displacements
        vary as the square root of the distance there, as the small-strain solution at a punch edge does.
    move : callable, optional
        Takes all nine nodes of every element, shape (2, n), to where they belong: curved sides.
    """
    places, node = nine_nodes(points, quads)
    if quarter_points:
        places = _to_quarter(places, quads, node, centre)
    if move is not None:
        places = move(places)
    at = integrate(places, node)
    r = at.place[0]
    elements, n_points = r.shape
    gradient = np.zeros((elements, n_points, 5, 18))
    gradient[:, :, 0:2, 0::2] = gradient[:, :, 2:4, 1::2] = at.slope
    gradient[:, :, 4, 0::2] = at.value / r[..., None]
    x, y = POINTS
    if centre is not None:
        place = points[:, centre[0]]
        together = np.nonzero(np.all(np.abs(places - place[:, None]) < 1e-12, axis=0))[0]
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
    )


SIDES = ((4, 0, 1), (5, 1, 2), (6, 2, 3), (7, 3, 0))


def _to_quarter(places: Array, quads: Array, node: Array, centre: Array | None) -> Array:
    if centre is None:
        raise ValueError("quarter points need a centre")
    places = places.copy()
    corner = places[:, centre[0]][:, None]
    at_centre = np.zeros(places.shape[1], dtype=bool)
    at_centre[centre] = True
    nodes = node.T
    for element in np.nonzero(at_centre[quads].sum(axis=0) == 2)[0]:
        vertices = quads[:, element]
        far = vertices[~at_centre[vertices]]
        for side, i, j in SIDES:
            ends = vertices[[i, j]]
            if at_centre[ends].sum() == 1:
                end = ends[~at_centre[ends]][0]
                places[:, nodes[side, element]] = (corner[:, 0] * 3.0 + places[:, end]) / 4.0
        places[:, nodes[8, element]] = (corner[:, 0] * 3.0 + places[:, far].mean(axis=1)) / 4.0
    return places


def cell_nodes(mesh: Discretisation) -> Array:
    """Nodes of each element, shape (elements, 9): corners, mid-sides, middle."""
    return mesh.dofs.reshape(len(mesh.dofs), 9, 2)[:, :, 0] // 2


def edges_on(mesh: Discretisation, on: Array) -> Array:
    """Sides whose three nodes all satisfy ``on`` (bool per node); node numbers, shape (sides, 3), by r or z."""
    nodes = cell_nodes(mesh)
    found = []
    for side, i, j in SIDES:
        three = nodes[:, [i, side, j]]
        length = np.linalg.norm(mesh.nodes[:, three[:, 0]] - mesh.nodes[:, three[:, 2]], axis=0)
        found.append(three[on[three].all(axis=1) & (length > 1e-12)])
    return np.concatenate(found)


def on_top(mesh: Discretisation) -> Array:
    """Nodes on z = 0."""
    return np.abs(mesh.nodes[1]) < _TOLERANCE


def on_base(mesh: Discretisation, thickness: float) -> Array:
    """Nodes on z = -thickness."""
    return np.abs(mesh.nodes[1] + thickness) < _TOLERANCE


def on_axis(mesh: Discretisation) -> Array:
    """Nodes on r = 0."""
    return mesh.nodes[0] < _TOLERANCE
