"""Stress at the nodes and tractions on the tested face of a pressed pad."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.pad.fem.mesh_axisymmetric import POINTS, cell_nodes
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.solve.equilibrium import Solution

Array = np.ndarray

# The nine nodes of a cell on the unit square, in the order of the elements: corners, mid-sides, middle.
NODES = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]])


def cauchy(solid: Solid, u: Array, p: Array, factor: Array) -> tuple[Array, Array]:
    """Cauchy stress (rr, zz, tt, rz) and principal stretches at the quadrature points.

    sigma = P F^T / J with the first Piola stress P of :mod:`dummydesign.pad.fem.mixed_solid`.
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
    """Values at quadrature points carried to the nodes: a bilinear fit in each cell, the mean of cells at a node."""

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


def recovered(solid: Solid, solution: Solution, factor: Array) -> tuple[Array, Array]:
    """Cauchy stress (n, 4) and principal stretches (n, 3) at the nodes of an equilibrium."""
    both = to_nodes(solid, POINTS, np.concatenate(cauchy(solid, solution.u, solution.p, factor), axis=-1))
    return both[:, :4], both[:, 4:]


# State of a place on the tested face.
FREE, STICKS, SLIPS = 0, 1, 2
STATES = ("free", "sticks", "slips")


@dataclass(frozen=True)
class Face:
    """The tested face of a pressed pad, from the axis outwards."""

    node: Array
    radius_mm: Array
    height_mm: Array
    rest_mm: Array
    pressure_MPa: Array
    shear_MPa: Array
    state: Array
    contact_radius_mm: float


@dataclass(frozen=True)
class Pressed:
    """A pad pressed to one depth: a mesh of nine-node quadrilaterals in the (r, z) plane and its fields."""

    depth_mm: float
    force_N: float
    rest_mm: Array
    displacement_mm: Array
    cells: Array
    cauchy_MPa: Array
    stretch: Array
    face: Face
    punch_mm: Array

    @property
    def principal_MPa(self) -> Array:
        """Principal values of the Cauchy stress, largest first, shape (n, 3). [MPa]"""
        rr, zz, tt, rz = self.cauchy_MPa.T
        middle, half = 0.5 * (rr + zz), np.hypot(0.5 * (rr - zz), rz)
        return -np.sort(-np.stack([middle + half, middle - half, tt], axis=1), axis=1)

    @property
    def pressure_MPa(self) -> Array:
        """Minus the mean of the principal stresses, shape (n,). [MPa]"""
        return -self.cauchy_MPa[:, :3].mean(axis=1)

    @property
    def von_mises_MPa(self) -> Array:
        """sqrt(3/2 s:s) of the deviator s, shape (n,). [MPa]"""
        one, two, three = self.principal_MPa.T
        return np.sqrt(0.5 * ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2))

    def contact(self) -> dict[str, Any]:
        """Mean, peak and profile of the contact pressure as plain values; lengths in mm, pressures in kPa.

        The mean is the force over the contact seen from above, pi times the square of ``contact_radius_mm``. A sharp
        edge has no finite peak: ``peak_kPa`` is the largest value inside 0.9 of the contact's radius, ``edge_kPa`` the
        largest outside it, which depends on the fillet of the edge.
        """
        face, reach = self.face, self.face.contact_radius_mm
        touched = face.state != FREE
        inner = touched & (face.radius_mm <= 0.9 * reach)
        outer = touched & ~inner
        pressure = 1e3 * face.pressure_MPa
        at = int(np.argmax(np.where(inner, pressure, -np.inf))) if inner.any() else 0
        area = np.pi * reach**2
        return {
            "depth_mm": float(self.depth_mm),
            "force_N": float(self.force_N),
            "contact_radius_mm": reach,
            "mean_kPa": 1e3 * self.force_N / area if area else 0.0,
            "peak_kPa": float(pressure[at]) if inner.any() else 0.0,
            "peak_radius_mm": float(face.radius_mm[at]) if inner.any() else 0.0,
            "edge_kPa": float(pressure[outer].max()) if outer.any() else 0.0,
            "profile": {
                "radius_mm": np.minimum(face.radius_mm[touched], reach).tolist(),
                "pressure_kPa": pressure[touched].tolist(),
                "shear_kPa": (1e3 * face.shear_MPa[touched]).tolist(),
                "state": [STATES[k] for k in face.state[touched]],
            },
        }
