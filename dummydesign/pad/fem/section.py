"""Kinematics, forces and tangents of the nine-node elements of a pad's section, as products with constant matrices.

Slopes in r and z are those on the unit square times a 2 x 2 matrix of the point, so that forces and tangents of all
elements are a few coefficients a point times products of functions on the unit square, which no element changes:
one large matrix product, where one small product for each element took four times as long.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray

# Pairs of what is summed up: slopes along both sides of the unit square (0, 1) and value (2); of a symmetric tangent,
# whose axial part has the first three, and of radial with axial displacements.
ALIKE = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
CROSSED = ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1))


class SectionElements:
    """All elements of one mesh of a section; ``mesh.reference`` has functions and matrices of the points."""

    def __init__(self, mesh: Any, inverse: Array, shear_MPa: float) -> None:
        functions, turn = mesh.reference
        nodes, points = functions.shape[-1], functions.shape[1]
        self._spread = np.ascontiguousarray(functions.reshape(-1, nodes).T)
        self._turn = [[np.ascontiguousarray(turn[..., d, a]) for a in (0, 1)] for d in (0, 1)]
        self._area = self._turn[0][0] * self._turn[1][1] - self._turn[0][1] * self._turn[1][0]
        self._hoop = mesh.gradient[:, :, 4, 0::2].sum(axis=-1)
        self._dofs = np.stack([mesh.dofs[:, 0::2], mesh.dofs[:, 1::2]])
        self._weight, self._inverse, self._size = mesh.weight, inverse, mesh.size

        def products(pairs: Any, symmetric: bool) -> Array:
            made = [np.einsum("qi,qj->qij", functions[a], functions[b]) for a, b in pairs]
            both = [m + m.transpose(0, 2, 1) if symmetric and a != b else m for m, (a, b) in zip(made, pairs)]
            return np.concatenate(both).reshape(-1, nodes * nodes)

        self._alike, self._crossed = products(ALIKE, True), products(CROSSED, False)
        self._loads = np.einsum("aqi,qm->aqim", functions, mesh.pressure_basis).reshape(3 * points, -1)
        (t00, t01), (t10, t11) = self._turn
        own = [t00 * t00 + t10 * t10, t00 * t01 + t10 * t11, t01 * t01 + t11 * t11, None, None, self._hoop**2]
        self._same = [None if one is None else shear_MPa * self._weight * one for one in own]

    def deformation(self, u: Array) -> Array:
        """Components of F, shape (elements, points, 5), each of which is contiguous."""
        elements, points = self._hoop.shape
        slopes = (u[self._dofs].reshape(2 * elements, -1) @ self._spread).reshape(2, elements, 3, points)
        F = np.empty((5, elements, points))
        for d, a in ((0, 0), (0, 1), (1, 0), (1, 1)):
            np.multiply(self._turn[a][0], slopes[d, :, 0], out=F[2 * d + a])
            F[2 * d + a] += self._turn[a][1] * slopes[d, :, 1]
        np.multiply(self._hoop, slopes[0, :, 2], out=F[4])
        for k in (0, 3, 4):
            F[k] += 1.0
        return np.moveaxis(F, 0, -1)

    def forces(self, stress: Array) -> Array:
        """Forces on all unknowns from stresses times weight, shape (elements, points, 5)."""
        elements, points = self._hoop.shape
        along = np.zeros((2, elements, 3, points))
        for d, a in ((0, 0), (0, 1), (1, 0), (1, 1)):
            np.multiply(stress[..., 2 * d], self._turn[0][a], out=along[d, :, a])
            along[d, :, a] += stress[..., 2 * d + 1] * self._turn[1][a]
        np.multiply(stress[..., 4], self._hoop, out=along[0, :, 2])
        local = along.reshape(2 * elements, -1) @ self._spread.T
        return np.bincount(self._dofs.ravel(), local.ravel(), minlength=self._size)

    def tangent(self, F: Array, factor: Array, curvature: Array) -> tuple[Array, Array, Array]:
        """Stiffness of each element without pressures, its coupling with them, and that times their inverse.

        ``factor`` (slope of the energy over J) and ``curvature`` have the weight in them. With A = det of F in the
        plane, J = A F_tt, the stiffness is c dJ x dJ + s d2J and what the law adds at every state.
        """
        rr, rz, zr, zz, tt = (F[..., k] for k in range(5))
        (t00, t01), (t10, t11) = self._turn
        elements, points = self._hoop.shape
        # Derivative of A by radial and by axial displacements, of J by both.
        out, up = (zz * t00 - zr * t10, zz * t01 - zr * t11), (rr * t10 - rz * t00, rr * t11 - rz * t01)
        radial = (tt * out[0], tt * out[1], (rr * zz - rz * zr) * self._hoop)
        axial = (tt * up[0], tt * up[1])
        around, skew = factor * self._hoop, factor * tt * self._area
        bent = [curvature * one for one in radial]
        sums = np.empty((elements, 3, len(ALIKE), points))
        for k, (a, b) in enumerate(ALIKE):
            np.multiply(bent[a], radial[b], out=sums[:, 0, k])
            if (same := self._same[k]) is None:
                sums[:, 0, k] += around * out[a]
                continue
            sums[:, 0, k] += same
            if b < 2:
                np.multiply(curvature * axial[a], axial[b], out=sums[:, 1, k])
                sums[:, 1, k] += same
        for k, (a, b) in enumerate(CROSSED):
            np.multiply(bent[a], axial[b], out=sums[:, 2, k])
            if a == 2:
                sums[:, 2, k] += around * up[b]
            elif a != b:
                sums[:, 2, k] += skew if a == 0 else -skew
        loads = np.zeros((2, elements, 3, points))
        for d, parts in enumerate((radial, axial)):
            for a, part in enumerate(parts):
                np.multiply(part, self._weight, out=loads[d, :, a])
        made = (loads.reshape(2 * elements, -1) @ self._loads).reshape(2, elements, -1, self._inverse.shape[-1])
        coupling = np.ascontiguousarray(made.transpose(1, 2, 0, 3)).reshape(elements, -1, made.shape[-1])
        half = coupling @ self._inverse
        stiffness = half @ -coupling.transpose(0, 2, 1)
        blocks = stiffness.reshape(elements, made.shape[2], 2, made.shape[2], 2)
        flat = sums.reshape(elements, 3, -1)
        shape = blocks[:, :, 0, :, 0].shape
        blocks[:, :, 0, :, 0] += (flat[:, 0] @ self._alike).reshape(shape)
        blocks[:, :, 1, :, 1] += (flat[:, 1, : 3 * points] @ self._alike[: 3 * points]).reshape(shape)
        both = (flat[:, 2] @ self._crossed).reshape(shape)
        blocks[:, :, 0, :, 1] += both
        blocks[:, :, 1, :, 0] += both.transpose(0, 2, 1)
        return stiffness, coupling, half
