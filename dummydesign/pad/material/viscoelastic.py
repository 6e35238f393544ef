"""Finite-strain viscoelasticity with Prony terms, as a law that remembers its history at each point.

Form (Simo 1987 [1], isochoric part only): the long-term response is any hyperelastic law; each arm adds a
second Piola stress Q_i, a linear convolution on the isochoric second Piola stress of that law,

    S(t) = S_inf(C) + sum_i Q_i,   Q_i' + Q_i / tau_i = beta_i d/dt S_iso,   S_iso = 2 d W(J^(-2/3) C) / dC,

with beta_i relative to the LONG-TERM modulus, as everywhere here. Over a step the isochoric stress is taken
as linear in time, for which the update is exact (Taylor, Pister and Goudreau [2]):

    Q_n+1 = exp(-x) Q_n + beta (1 - exp(-x)) / x (S_iso,n+1 - S_iso,n),   x = dt / tau.

That makes a step a hyperelastic problem of the energy W(F) + b W(J^(-1/3) F) + 1/2 H : C with constant H
and b, so the algorithmic tangent is exact and symmetric. That a gel follows this form and not another one
(dashpots in the deformed state, for example) is an assumption of the model.

References
----------
.. [1] J. C. Simo, Comput. Methods Appl. Mech. Eng. 60 (1987) 153, doi 10.1016/0045-7825(87)90107-1.
.. [2] R. L. Taylor, K. S. Pister, G. L. Goudreau, Int. J. Numer. Meth. Eng. 2 (1970) 45.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.pad.material.hyperelastic import HyperelasticLaw
from dummydesign.pad.material.kinematics import Axisymmetric, Spatial
from dummydesign.pad.material.relaxation import PronyTerm

Array = np.ndarray


def _parts(F: Array) -> list[Array]:
    """The matrices in the components of F: a 2 x 2 block and the hoop, or the 3 x 3 matrix."""
    if F.shape[-1] == 9:
        return [F.reshape(*F.shape[:-1], 3, 3)]
    return [F[..., :4].reshape(*F.shape[:-1], 2, 2), F[..., 4:, None]]


def _join(parts: Sequence[Array]) -> Array:
    return np.concatenate([part.reshape(*part.shape[:-2], -1) for part in parts], axis=-1)


def _product(A: Array, B: Array, transposed: bool = False) -> Array:
    """Components of A B, or of A^T B."""
    turn = (lambda a: np.swapaxes(a, -1, -2)) if transposed else (lambda a: a)
    return _join([turn(a) @ b for a, b in zip(_parts(A), _parts(B))])


class Isochoric:
    """First Piola stress and tangent of W(J^(-1/3) F), of a law's energy at constant volume."""

    def __init__(self, law: HyperelasticLaw) -> None:
        self.law = law

    def energy(self, F: Array) -> Array:
        """W(J^(-1/3) F)."""
        kinematics = Axisymmetric if F.shape[-1] == 5 else Spatial
        return self.law.energy(F * kinematics.determinant(F)[..., None] ** (-1.0 / 3.0))

    def stress(self, F: Array) -> Array:
        """J^(-1/3) (P - 1/3 (P : F) K), P at J^(-1/3) F and K = F^-T."""
        return self._stress(F)[0]

    def _stress(self, F: Array) -> tuple[Array, Array, Array, Array, Array]:
        kinematics = Axisymmetric if F.shape[-1] == 5 else Spatial
        J = kinematics.determinant(F)
        inverse = kinematics.cofactor(F) / J[..., None]
        root = J[..., None] ** (-1.0 / 3.0)
        plain = self.law.stress(root * F)
        work = np.einsum("...c,...c->...", plain, F)[..., None]
        return root * (plain - work * inverse / 3.0), plain, inverse, root, work

    def tangent(self, F: Array) -> Array:
        """Exact second derivative."""
        kinematics = Axisymmetric if F.shape[-1] == 5 else Spatial
        stress, plain, K, root, work = self._stress(F)
        A = self.law.tangent(root * F)
        AF = np.einsum("...cd,...d->...c", A, F)
        FAF = np.einsum("...c,...c->...", F, AF)[..., None]
        out = root[..., None] ** 2 * (A - AF[..., :, None] * K[..., None, :] / 3.0)
        out = out - stress[..., :, None] * K[..., None, :] / 3.0
        other = root * (root * (AF - FAF * K / 3.0) + plain)
        out = out - K[..., :, None] * other[..., None, :] / 3.0
        share = (root * work / 3.0)[..., 0]
        out = out + share[..., None, None] * K[..., :, None] * K[..., None, :]
        kinematics.add_second(out, -share / kinematics.determinant(F), F)
        return out

    def second_piola(self, F: Array) -> Array:
        """S = F^-1 P, in the components of F."""
        stress, _, inverse, _, _ = self._stress(F)
        return _product(inverse, stress, transposed=True)


class Viscoelastic:
    """A law with relaxing arms; its history is that of one discretisation.

    Use: ``begin(dt)``, then energy, stress and tangent for any trial F, then ``commit(F)`` with the F that
    was found. Without arms (or with all strengths zero) it is the hyperelastic law, to the last bit.
    """

    def __init__(self, law: HyperelasticLaw, prony: Sequence[PronyTerm] = ()) -> None:
        self.law = law
        self.prony = tuple(term for term in prony if term.beta > 0.0)
        self.isochoric = Isochoric(law)
        self._arms: list[Array] | None = None
        self._last: Array | float = 0.0
        self._strength = 0.0
        self._history: Array | None = None
        self._factors: list[tuple[float, float]] = []

    @property
    def shear_MPa(self) -> float:
        """Long-term shear modulus."""
        return self.law.shear_MPa

    @property
    def reference_stress_MPa(self) -> float:
        """As that of the long-term law."""
        return self.law.reference_stress_MPa

    def begin(self, dt_s: float) -> None:
        """Prepare a step of this length from the committed state. [s]"""
        if not dt_s > 0.0:
            raise InputError(f"time step = {dt_s} s must be above 0", "out_of_range", "time_step_s", dt_s)
        x = [dt_s / term.tau_s for term in self.prony]
        self._factors = [(float(np.exp(-r)), term.beta * float(-np.expm1(-r) / r)) for r, term in zip(x, self.prony)]
        self._strength = sum(jump for _, jump in self._factors)
        self._history = None
        if self._arms is not None:
            carried = sum(d * Q for (d, _), Q in zip(self._factors, self._arms))
            self._history = np.asarray(carried - self._strength * self._last)

    def commit(self, F: Array) -> None:
        """Accept F as the state at the end of the step."""
        if not self.prony:
            return
        now = self.isochoric.second_piola(F)
        old = self._arms or [np.zeros(())] * len(self.prony)
        self._arms = [d * Q + j * (now - self._last) for (d, j), Q in zip(self._factors, old)]
        self._last = now

    def energy(self, F: Array) -> Array:
        """Incremental energy of the step; its derivative is the stress."""
        energy = self.law.energy(F)
        if self._strength:
            energy = energy + self._strength * self.isochoric.energy(F)
        if self._history is not None:
            energy = energy + 0.5 * np.einsum("...c,...c->...", F, _product(F, self._history))
        return energy

    def stress(self, F: Array) -> Array:
        """First Piola stress at the end of the step."""
        stress = self.law.stress(F)
        if self._strength:
            stress = stress + self._strength * self.isochoric.stress(F)
        if self._history is not None:
            stress = stress + _product(F, self._history)
        return stress

    def tangent(self, F: Array) -> Array:
        """Exact algorithmic tangent."""
        tangent = self.law.tangent(F)
        if self._strength:
            tangent = tangent + self._strength * self.isochoric.tangent(F)
        if self._history is not None:
            start = 0
            for part in _parts(self._history):
                size = part.shape[-1]
                for i in range(size):
                    at = slice(start + size * i, start + size * (i + 1))
                    tangent[..., at, at] += part
                start += size * size
        return tangent

    def scaled(self, factor: float) -> Viscoelastic:
        """The same law without history, all moduli multiplied by ``factor``."""
        return Viscoelastic(self.law.scaled(factor), self.prony)
