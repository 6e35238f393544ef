"""The mixed displacement-pressure solid: residual, exact tangent, pressure eliminated element by element.

Energy per reference volume [1]

    W(F) - s0 ln J + g mu / 2 (J - 1)^2 + p (J - 1) - p^2 / (2 L)

with displacement u quadratic and pressure p linear and discontinuous (inf-sup stable on quadrilaterals
and hexahedra [2]). L is the Lame modulus of the solid: 2 mu nu / (1 - 2 nu), or 1e6 mu when it is
incompressible. The g term vanishes at the incompressible solution and keeps Newton's method away from
inverted elements; it is off when nu < 1/2.

References
----------
.. [1] T. Sussman, K.-J. Bathe, Computers & Structures 26 (1987) 357, doi 10.1016/0045-7949(87)90265-3.
.. [2] D. Boffi, F. Brezzi, M. Fortin, Mixed Finite Element Methods and Applications, Springer 2013, ch. 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.pad.material.hyperelastic import Array, HyperelasticLaw, Spatial, Yeoh

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


class Tangent(NamedTuple):
    """Condensed tangent: coupling of displacements and pressures, and the same times the pressures' inverse."""

    stiffness: Array
    coupling: Array
    half: Array


# Relative compressibility of an "incompressible" pad: changes no reported force by more than 0.001 %.
INCOMPRESSIBLE_LAME_RATIO = 1e6
# Keeps pucks and crowns on coarse cells from folding early; a glued sharp edge, which it stiffens, takes less of it.
STABILISATION = 10.0


def lame_ratio(poisson: float) -> float:
    """Lame modulus over shear modulus, 2 nu / (1 - 2 nu), capped at the incompressible value."""
    if not 0.0 < poisson <= 0.5:
        message = f"Poisson's ratio = {poisson} is outside the allowed range 0 (excluded) to 0.5"
        raise InputError(message, "out_of_range", "poisson", poisson, (0.0, 0.5))
    if poisson > 0.4999995:
        return INCOMPRESSIBLE_LAME_RATIO
    return 2.0 * poisson / (1.0 - 2.0 * poisson)


@dataclass(frozen=True)
class Discretisation:
    """Everything of a mesh that does not change while it deforms."""

    gradient: Array
    weight: Array
    pressure_basis: Array
    dofs: Array
    nodes: Array
    kinematics: Any
    modulus_factor: Array | None = None
    # Of a section: functions on the unit square (slopes, value), and what makes slopes there slopes in r and z.
    reference: tuple[Array, Array] | None = None

    @property
    def size(self) -> int:
        """Number of displacement unknowns, fixed ones included."""
        return self.nodes.shape[0] * self.nodes.shape[1]


@dataclass
class SolidState:
    """Residual at one displacement and pressure; ``at`` holds deformation, cofactor and slope for the tangent."""

    internal_force: Array
    pressure_residual: Array
    J: Array
    at: tuple[Array, Array, Array]


class Solid:
    """A solid of one law on one discretisation; gives residual and tangent at any state."""

    def __init__(
        self, mesh: Discretisation, law: HyperelasticLaw, poisson: float = 0.5, stabilisation: float = STABILISATION
    ) -> None:
        self.mesh = mesh
        self.law = law
        ratio = lame_ratio(poisson)
        self.stabilisation = stabilisation * law.shear_MPa if ratio == INCOMPRESSIBLE_LAME_RATIO else 0.0
        mass = np.einsum("eq,qa,qb->eab", mesh.weight, mesh.pressure_basis, mesh.pressure_basis)
        self.compliance = mass / (ratio * law.shear_MPa)
        self.inverse = -np.linalg.inv(self.compliance)
        elements, _, _, width = mesh.gradient.shape
        self._weighted_basis = mesh.weight[:, :, None] * mesh.pressure_basis
        self._section = None if mesh.reference is None else SectionElements(mesh, self.inverse, law.shear_MPa)
        # The law's own tangent is the same at every state.
        self._constant = isinstance(law, Yeoh) and not law.c2_MPa
        if self._section is None:
            # In space, slopes of the nodes along x, y and z: those of displacements along each are alike.
            self._rows = np.ascontiguousarray(mesh.gradient[:, :, :3, 0::3].reshape(elements, -1, width // 3))
            self._back = np.ascontiguousarray(self._rows.transpose(0, 2, 1))
            self._same = self._of_law(law.shear_MPa * mesh.weight) if self._constant else None
        if not self._constant:
            # Kept, as making such large arrays anew takes as long as filling them.
            self._flat = np.ascontiguousarray(mesh.gradient.reshape(elements, -1, width))
            self._moduli = np.empty((*mesh.weight.shape, mesh.gradient.shape[2], mesh.gradient.shape[2]))
            self._work = np.empty(mesh.gradient.shape)

    def _of_law(self, moduli: Array) -> Array:
        """Tangent of each element in space for stresses of ``moduli``, shape (elements, points), times the slopes."""
        elements, nodes = len(moduli), self._rows.shape[-1]
        stiffness = np.zeros((elements, nodes, 3, nodes, 3))
        same = self._rows.transpose(0, 2, 1) @ (self._rows * np.repeat(moduli, 3, axis=1)[..., None])
        for direction in range(3):
            stiffness[:, :, direction, :, direction] = same
        return stiffness.reshape(elements, 3 * nodes, -1)

    def deformation(self, u: Array) -> Array:
        """Components of F at the quadrature points, shape (elements, points, components)."""
        if self._section is not None:
            return self._section.deformation(u)
        elements, points = self.mesh.weight.shape
        slopes = (self._rows @ u[self.mesh.dofs].reshape(elements, -1, 3)).reshape(elements, points, 3, 3)
        F = slopes.swapaxes(2, 3).reshape(elements, points, 9)
        F += Spatial.identity
        return F

    def _forces(self, stress: Array) -> Array:
        """Forces on all unknowns from stresses times weight, shape (elements, points, components)."""
        if self._section is not None:
            return self._section.forces(stress)
        elements, points, _ = stress.shape
        turned = stress.reshape(elements, points, 3, 3).swapaxes(2, 3)
        force = (self._back @ turned.reshape(elements, -1, 3)).ravel()
        return np.bincount(self.mesh.dofs.ravel(), force, minlength=self.mesh.size)

    def state(self, u: Array, p: Array) -> SolidState | None:
        """Evaluate the solid; None where an element is inverted at a quadrature point (J <= 0)."""
        mesh, kin = self.mesh, self.mesh.kinematics
        F = self.deformation(u)
        J = kin.determinant(F)
        if not np.all(J > 0.0):
            return None
        weight, basis = mesh.weight, mesh.pressure_basis
        cofactor = kin.cofactor(F)
        slope = -self.law.reference_stress_MPa / J + self.stabilisation * (J - 1.0) + p @ basis.T
        stress = self.law.stress(F) + slope[..., None] * cofactor
        stress *= weight[..., None]
        internal = self._forces(stress)
        pressure = (weight * (J - 1.0)) @ basis - np.einsum("eab,eb->ea", self.compliance, p)
        return SolidState(internal, pressure, J, (F, cofactor, slope))

    def linearise(self, state: SolidState) -> Tangent:
        """Return the condensed tangent at a state."""
        F, cofactor, slope = state.at
        mesh = self.mesh
        curvature = (self.law.reference_stress_MPa / state.J**2 + self.stabilisation) * mesh.weight
        if self._section is not None and self._constant:
            return Tangent(*self._section.tangent(F, slope * mesh.weight, curvature))
        if self._section is None and self._same is not None:
            stiffness = self._same.copy()
            self._add_second(stiffness, slope * mesh.weight, F)
        else:
            stiffness = self._by_moduli(F, slope * mesh.weight)
        # What changes J, and what the pressure takes off it, are of low rank in each element.
        dilation = self._dilation(cofactor)
        coupling = dilation.transpose(0, 2, 1) @ self._weighted_basis
        half = coupling @ self.inverse
        left = np.concatenate([dilation, coupling.transpose(0, 2, 1)], axis=1)
        right = np.concatenate([dilation * curvature[..., None], -half.transpose(0, 2, 1)], axis=1)
        stiffness += left.transpose(0, 2, 1) @ right
        return Tangent(stiffness, coupling, half)

    def _by_moduli(self, F: Array, factor: Array) -> Array:
        """Tangent of each element from the law's moduli and ``factor`` times the second derivative of J."""
        mesh = self.mesh
        np.multiply(self.law.tangent(F), mesh.weight[..., None, None], out=self._moduli)
        mesh.kinematics.add_second(self._moduli, factor, F)
        np.matmul(self._moduli, mesh.gradient, out=self._work)
        return self._flat.transpose(0, 2, 1) @ self._work.reshape(self._flat.shape)

    def _dilation(self, cofactor: Array) -> Array:
        """Change of J by each of the element's unknowns, shape (elements, points, element dofs)."""
        if self.mesh.kinematics is not Spatial:
            return np.einsum("eqc,eqcd->eqd", cofactor, self.mesh.gradient)
        elements, points = cofactor.shape[:2]
        slopes = self._rows.reshape(elements, points, 3, -1).transpose(0, 1, 3, 2)
        return (slopes @ cofactor.reshape(elements, points, 3, 3).transpose(0, 1, 3, 2)).reshape(elements, points, -1)

    def _add_second(self, stiffness: Array, factor: Array, F: Array) -> None:
        """Add ``factor`` times the second derivative of J to tangents in space, in place.

        d2J / dF_ij dF_kl = e_ikp e_jlr F_pr: displacements along i and k meet in one antisymmetric matrix of the
        nodes, which is found from the slopes of the nodes alone.
        """
        elements, points = factor.shape
        rows = F.reshape(elements, points, 3, 3) * factor[..., None, None]
        skew = np.zeros((elements, points, 3, 3, 3))
        for j, k, r in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            skew[..., j, :, k], skew[..., k, :, j] = rows[..., r], -rows[..., r]
        nodes = self._rows.shape[-1]
        turned = skew.reshape(elements, points, 9, 3) @ self._rows.reshape(elements, points, 3, nodes)
        matrix = (self._back @ turned.reshape(elements, 3 * points, 3 * nodes)).reshape(elements, nodes, 3, nodes)
        blocks = stiffness.reshape(elements, nodes, 3, nodes, 3)
        for i, k, p in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            blocks[:, :, i, :, k] += matrix[:, :, p]
            blocks[:, :, k, :, i] -= matrix[:, :, p]

    def force_of_pressure(self, tangent: Tangent, state: SolidState) -> Array:
        """What the eliminated pressure of a state adds to the load, by the tangent of that state or of one near it."""
        extra = (tangent.half @ state.pressure_residual[:, :, None])[:, :, 0]
        return np.bincount(self.mesh.dofs.ravel(), extra.ravel(), minlength=self.mesh.size)

    def pressure_step(self, tangent: Tangent, state: SolidState, du: Array) -> Array:
        """Pressure increment that belongs to a displacement increment of the linearised equations."""
        load = -state.pressure_residual - (du[self.mesh.dofs][:, None, :] @ tangent.coupling)[:, 0]
        return (load[:, None, :] @ self.inverse)[:, 0]
