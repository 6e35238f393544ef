"""Meshes of 27-node hexahedra: a quarter of a slab, graded to the edge of a punch in all three directions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dummydesign.pad.fem.mixed_solid import Discretisation
from dummydesign.pad.material.hyperelastic import Array, Spatial

_TOLERANCE = 1e-9


def lines(length: float, first: float, growth: float, like: float | None = None) -> Array:
    """Points 0 to ``length`` whose first cell is exactly ``first`` and whose cells grow by at most ``growth``.

    As many cells as the largest growth needs; the growth is then lowered until they fit. A length of
    less than 1.5 first cells is one cell.
    """
    if length < 1.5 * first:
        return np.array([0.0, length])
    count = int(np.ceil(np.log(1.0 + (like or length) * (growth - 1.0) / first) / np.log(growth) - 1e-9))
    low, high = 1e-6, growth if like is None else 2.0 * growth
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if first * (middle ** np.arange(count)).sum() < length else (low, middle)
    points = np.concatenate([[0.0], np.cumsum(first * high ** np.arange(count))])
    return points * (length / points[-1])


def lines_around(edge: float, extent: float, first: float, growth: float, like: float | None = None) -> Array:
    """Points 0 to ``extent``, finest on both sides of ``edge``."""
    inside = edge - lines(edge, first, growth)[::-1]
    return np.concatenate([inside, edge + lines(extent - edge, first, growth, like and like - edge)[1:]])


def rectangle_plan(x: Array, y: Array) -> tuple[Array, Array]:
    """Quadrilaterals of a tensor grid: points, shape (2, n), and vertices, shape (4, cells), x fastest last."""
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    points = np.stack([np.repeat(x, len(y)), np.tile(y, len(x))])
    return points, np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]).reshape(4, -1)


# Corners of scikit-fem's reference hexahedron as (vertex of the plan's quadrilateral, 0 below or 1 above).
_CORNERS = {(0, 0): 0, (1, 0): 1, (1, 1): 2, (0, 1): 3}


def extrude(points: Array, quads: Array, z: Array) -> object:
    """Hexahedra over quadrilaterals, level by level."""
    from skfem import MeshHex

    count = points.shape[1]
    places = np.concatenate([np.tile(points, len(z)), np.repeat(z, count)[None]])
    corners = MeshHex.elem.refdom.p.T.astype(int)
    vertices = [quads[_CORNERS[i, j]][None] + count * (np.arange(len(z) - 1) + k)[:, None] for i, j, k in corners]
    return MeshHex(places, np.stack([v.ravel() for v in vertices]), validate=False)


def discretise(mesh: Any, bend: Callable[[Array], Array] | None = None) -> Discretisation:
    """Build the triquadratic discretisation of a mesh of hexahedra, pressure linear in each."""
    from skfem import Basis, ElementHex2, MeshHex2

    curved = MeshHex2.from_mesh(mesh)
    if bend is not None:
        curved = MeshHex2(bend(curved.doflocs), curved.t, validate=False)
    basis = Basis(curved, ElementHex2(), intorder=4)
    elements, count = basis.dx.shape
    gradient = np.zeros((elements, count, 9, 81))
    for i in range(27):
        slope = np.moveaxis(basis.basis[i][0].grad, 0, 2)
        for direction in range(3):
            gradient[:, :, 3 * direction : 3 * direction + 3, 3 * i + direction] = slope
    node = basis.element_dofs.T
    return Discretisation(
        gradient=gradient,
        weight=basis.dx,
        pressure_basis=np.concatenate([np.ones((1, count)), 2.0 * basis.X - 1.0]).T,
        dofs=(3 * node[:, :, None] + np.arange(3)).reshape(elements, 81),
        nodes=basis.doflocs,
        kinematics=Spatial,
    )


@dataclass(frozen=True)
class Quarter:
    """A quarter of a slab, or half of it for what mirrors in the plane x = y."""

    mesh: Discretisation
    lattice: Array
    faces: Array
    share: Array
    unknowns: Array


def quarter(
    x: Array, y: Array, z: Array, folded: bool = False, bend: Callable[[Array], Array] | None = None
) -> Quarter:
    """Hexahedra on a tensor grid."""
    points, quads = rectangle_plan(x, y)
    lattice = np.indices((len(z) - 1, len(x) - 1, len(y) - 1)).reshape(3, -1)
    if folded:
        before = lattice[1] <= lattice[2]
        used, places = np.unique(quads[:, before[: quads.shape[1]]], return_inverse=True)
        points, quads, lattice = points[:, used], places.reshape(4, -1), lattice[:, before]
    mesh = discretise(extrude(points, quads, z), bend)
    upper, share = np.nonzero(lattice[0] == len(z) - 2)[0], np.ones(len(mesh.dofs))
    faces, unknowns = horizontal_faces(mesh, upper), np.arange(mesh.size)
    if folded:
        share[lattice[1] == lattice[2]] = 0.5
        unknowns = _mirrored(mesh.nodes)
        mesh = replace(mesh, weight=mesh.weight * share[:, None], dofs=unknowns[mesh.dofs])
    return Quarter(mesh, lattice, faces, share[upper], unknowns)


def _mirrored(nodes: Array) -> Array:
    """The unknown before or on the plane x = y that takes the place of each one."""
    from scipy.spatial import cKDTree

    x, y, _ = nodes
    unknowns = np.arange(nodes.size).reshape(-1, 3)
    beyond = np.nonzero(x > y + _TOLERANCE)[0]
    _, mirror = cKDTree(nodes.T).query(nodes[[1, 0, 2]][:, beyond].T)
    unknowns[beyond] = 3 * mirror[:, None] + np.array([1, 0, 2])
    between = np.abs(x - y) <= _TOLERANCE
    unknowns[between, 1] = unknowns[between, 0]
    return unknowns.ravel()


def horizontal_faces(mesh: Discretisation, cells: Array, upper: bool = True) -> Array:
    """Nodes of the upper or lower faces of cells, on a lattice of 3 x 3, y fastest."""
    from skfem import ElementHex2

    local = ElementHex2().doflocs
    here = np.nonzero(local[:, 2] == float(upper))[0]
    order = here[np.lexsort((local[here, 1], local[here, 0]))]
    return mesh.dofs.reshape(len(mesh.dofs), 27, 3)[cells][:, order, 0] // 3
