"""Stresses at the nodes and tractions on the tested face, from an equilibrium of the axisymmetric elements."""

from __future__ import annotations

import numpy as np

from dummydesign.pad.fem.mesh_axisymmetric import cell_nodes
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.fem.quadratic import POINTS
from dummydesign.pad.solve.equilibrium import Solution

Array = np.ndarray

# The nine nodes of a cell on the unit square, in the order of the elements: corners, mid-sides, middle.
NODES = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]])


def cauchy(solid: Solid, u: Array, p: Array, factor: Array) -> tuple[Array, Array]:
    """Cauchy stress (rr, zz, tt, rz) and principal stretches at the quadrature points.

    sigma = P F^T / J with the first Piola stress P of :mod:`dummydesign.pad.fem.mixed_solid`.

    Parameters
    ----------
    solid : Solid
        Its elements and law.
    u, p : ndarray, shape (unknowns,), (elements, 3)
        Displacements and pressures of the equilibrium.
    factor : ndarray, shape (elements,)
        Modulus of each element over the law's.

    Returns
    -------
    stress : ndarray, shape (elements, points, 4)
    stretch : ndarray, shape (elements, points, 3)
        Largest first.
    """
    kinematics, law = solid.mesh.kinematics, solid.law
    F = solid.deformation(u)
    J = kinematics.determinant(F)
    slope = -law.reference_stress_MPa / J + solid.stabilisation * (J - 1.0) + p @ solid.mesh.pressure_basis.T
    P = law.stress(F) + slope[..., None] * kinematics.cofactor(F)
    P = P * (factor[:, None] / J)[..., None]
    stress = np.stack(
        [
            P[..., 0] * F[..., 0] + P[..., 1] * F[..., 1],
            P[..., 2] * F[..., 2] + P[..., 3] * F[..., 3],
            P[..., 4] * F[..., 4],
            P[..., 0] * F[..., 2] + P[..., 1] * F[..., 3],
        ],
        axis=-1,
    )
    plane = F[..., :4].reshape(*F.shape[:-1], 2, 2)
    pair = np.linalg.svd(plane, compute_uv=False)
    stretch = -np.sort(-np.concatenate([pair, F[..., 4:5]], axis=-1), axis=-1)
    return stress, stretch


def to_nodes(solid: Solid, places: Array, values: Array) -> Array:
    """Values at quadrature points carried to the nodes: a bilinear fit in each cell, the mean of cells at a node.

    Parameters
    ----------
    solid : Solid
        Its elements.
    places : ndarray, shape (2, points)
        Quadrature points on the unit square.
    values : ndarray, shape (elements, points, k)
        What is known there.

    Returns
    -------
    ndarray, shape (nodes, k)
    """

    def bilinear(x: Array, y: Array) -> Array:
        return np.stack([np.ones_like(x), x, y, x * y], axis=1)

    carry = bilinear(NODES[:, 0], NODES[:, 1]) @ np.linalg.pinv(bilinear(*places))
    at_nodes = np.einsum("nq,eqk->enk", carry, values)
    node = cell_nodes(solid.mesh).ravel()
    size = solid.mesh.nodes.shape[1]
    count = np.bincount(node, minlength=size)
    sums = [np.bincount(node, at_nodes[..., k].ravel(), minlength=size) for k in range(values.shape[-1])]
    return np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]


def face_tractions(nodes: Array, u: Array, force: Array, sides: Array) -> dict[str, Array]:
    """Pressure and shear on the face from the nodal forces that hold it.

    A constant traction on a side with three nodes has the nodal forces t 2 pi r L (1, 4, 1) / 6; each node's force is
    divided by what its sides would have under a unit traction, so the pressures carry exactly the force of the solve.

    Parameters
    ----------
    nodes : ndarray, shape (2, n)
        Before the press, in one unit of length.
    u : ndarray, shape (2 n,)
        Displacements, in the same unit.
    force : ndarray, shape (2 n,)
        Nodal forces of the punch on the pad: the internal forces of the equilibrium.
    sides : ndarray of int, shape (sides, 3)
        End, middle and end node.

    Returns
    -------
    dict
        ``node`` in the order of the radius, ``pressure`` and ``shear`` per present area, ``down``: the vertical force
        per node.
    """
    moved = nodes + u.reshape(-1, 2).T
    x = np.array([-1.0, 0.0, 1.0])
    slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
    simpson = np.array([1.0, 4.0, 1.0]) / 3.0
    now = np.einsum("qi,cei->ceq", slope, moved[:, sides])
    area = 2.0 * np.pi * moved[0, sides] * np.linalg.norm(now, axis=0) * simpson
    size = nodes.shape[1]
    share = np.bincount(sides.ravel(), area.ravel(), minlength=size)
    along = np.stack([np.bincount(sides.ravel(), part.ravel(), minlength=size) for part in now])
    node = np.unique(sides)
    node = node[np.argsort(nodes[0, node], kind="stable")]
    along = along[:, node] / np.linalg.norm(along[:, node], axis=0)
    along = along * np.sign(along[0] + 1e-300)
    outward = np.stack([-along[1], along[0]])
    pull = force.reshape(-1, 2).T[:, node]
    area_of = share[node]
    safe = np.where(area_of > 1e-12 * area_of.max(), area_of, np.inf)
    pressure, shear = -(pull * outward).sum(0) / safe, (pull * along).sum(0) / safe
    if len(node) > 2 and not np.isfinite(safe[0]):
        # On the axis no area belongs to the node: the value of a parabola through its neighbours, even in r.
        r = moved[0, node[1:3]] ** 2
        pressure[0] = pressure[1] - (pressure[2] - pressure[1]) * r[0] / (r[1] - r[0])
    return {"node": node, "pressure": pressure, "shear": shear, "down": -pull[1]}


def quadrature_places(points: int) -> Array:
    """Quadrature points of the elements on the unit square, shape (2, points)."""
    if POINTS.shape[1] != points:
        raise ValueError(f"{points} quadrature points are not those of the elements")
    return POINTS


def recovered(solid: Solid, solution: Solution, factor: Array) -> tuple[Array, Array]:
    """Cauchy stress (n, 4) and principal stretches (n, 3) at the nodes of an equilibrium.

    Parameters
    ----------
    solid : Solid
        Its elements and law.
    solution : Solution
        The equilibrium.
    factor : ndarray, shape (elements,)
        Modulus of each element over the law's.
    """
    stress, stretch = cauchy(solid, solution.u, solution.p, factor)
    places = quadrature_places(stress.shape[1])
    both = to_nodes(solid, places, np.concatenate([stress, stretch], axis=-1))
    return both[:, :4], both[:, 4:]
