"""Prony relaxation: on top of an elastic force (quasi-linear, exact for piecewise-linear histories), and at finite
strain.

At finite strain a law remembers its history at each point. Form (Simo 1987 [1], isochoric part only): the long-term
response is any hyperelastic law; each arm adds a second Piola stress Q_i, a linear convolution on the isochoric
second Piola stress of that law,

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

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.core.serialise import Serialised
from dummydesign.pad.material.hyperelastic import Array, Axisymmetric, HyperelasticLaw, Spatial, join, parts


@dataclass(frozen=True)
class PronyTerm(Serialised):
    """One relaxing arm: time constant [s] and strength relative to the LONG-TERM modulus.

    ``beta`` = 0.3 means that this arm adds 30 % of the relaxed stiffness in a fast load.
    """

    tau_s: float
    beta: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.tau_s) and self.tau_s > 0):
            raise out_of_range("Prony time constant tau_s", self.tau_s, "above 0", "any finite time")
        if not (np.isfinite(self.beta) and self.beta >= 0):
            raise out_of_range("Prony strength beta", self.beta, 0, "any finite strength")


PressedForce = Callable[[NDArray, NDArray, NDArray, ArrayLike, Sequence[float], NDArray], NDArray]
"""Force (D, n) of presses whose arms change with depth or speed: of times [s], elastic forces [N] and depths over
thickness (D, n), speed of the ramp [mm/s], times of the arms [s], and their strengths (D, arms)."""


def relaxed_force(time_s: ArrayLike, elastic_force_N: ArrayLike, prony: Iterable[PronyTerm]) -> NDArray:
    """Force of a relaxing pad from the elastic force of its relaxed material.

    F(t) = integral of (1 + sum_i beta_i exp(-(t - s) / tau_i)) dF_inf(s)

    F_inf is taken as piecewise linear between the given times, for which the result is exact on any
    grid. A first value that is not zero counts as a jump at the first time; before it nothing was pressed.

    References
    ----------
    Y. C. Fung, Biomechanics: Mechanical Properties of Living Tissues (1993), chapter 7 (quasi-linear law);
    Taylor, Pister and Goudreau, Int. J. Numer. Meth. Eng. 2 (1970) 45 (recursion).
    """
    time = np.asarray(time_s, dtype=float)
    elastic = np.asarray(elastic_force_N, dtype=float)
    if time.shape[-1:] != elastic.shape[-1:] or time.ndim == 0:
        message = f"time_s has shape {time.shape} but elastic_force_N {elastic.shape}; the last axes must agree"
        raise InputError(message, "inconsistent", "elastic_force_N")
    step = np.diff(time, axis=-1)
    if np.any(step <= 0):
        raise InputError("time_s must increase strictly", "malformed", "time_s")
    force = np.broadcast_to(elastic, np.broadcast_shapes(time.shape, elastic.shape)).astype(float, copy=True)
    rise = np.diff(elastic, axis=-1)
    for term in prony:
        ratio = step / term.tau_s
        # -expm1(-x)/x keeps its digits when the step is tiny beside tau
        arm = linear_recurrence(np.exp(-ratio), rise * (-np.expm1(-ratio) / ratio), elastic[..., 0])
        force[..., 1:] += term.beta * arm
        force[..., 0] += term.beta * elastic[..., 0]
    return force


def arms_in_ramp_and_hold(
    steps_s: Sequence[ArrayLike], elastic_force_N: NDArray, hold_s: NDArray, tau_s: Sequence[float], beta: NDArray
) -> NDArray:
    """Force of all arms, what :func:`relaxed_force` adds to the elastic force, of many presses at once. [N]"""
    # every step of the recursion works on neighbouring numbers
    elastic, strength = np.ascontiguousarray(elastic_force_N.T), np.ascontiguousarray(beta.T)
    tau = np.array(tau_s)[:, None]
    rise, known = np.diff(elastic, axis=0), {}
    held = np.empty((len(elastic) + len(hold_s), len(beta)))
    state = strength * elastic[0]
    held[0] = state.sum(axis=0)
    for row, step in enumerate(steps_s):
        if id(step) not in known:
            ratio = np.asarray(step) / tau
            lost = -np.expm1(-ratio)
            known[id(step)] = strength * (lost / ratio), 1.0 - lost
        fed, kept = known[id(step)]
        state *= kept
        state += fed * rise[row]
        state.sum(axis=0, out=held[row + 1])
    np.matmul(np.exp(-hold_s[:, None] / tau[:, 0]), state, out=held[len(elastic) :])
    return held


def _product(A: Array, B: Array, transposed: bool = False) -> Array:
    """Components of A B, or of A^T B."""
    turn = (lambda a: np.swapaxes(a, -1, -2)) if transposed else (lambda a: a)
    return join([turn(a) @ b for a, b in zip(parts(A), parts(B))])


class Isochoric:
    """First Piola stress and tangent of W(J^(-1/3) F), of a law's energy at constant volume."""

    def __init__(self, law: HyperelasticLaw) -> None:
        self.law = law

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

    Use: ``begin(dt)``, then stress and tangent for any trial F, then ``commit(F)`` with the F that
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
            for part in parts(self._history):
                size = part.shape[-1]
                for i in range(size):
                    at = slice(start + size * i, start + size * (i + 1))
                    tangent[..., at, at] += part
                start += size * size
        return tangent

    def scaled(self, factor: float) -> Viscoelastic:
        """The same law without history, all moduli multiplied by ``factor``."""
        return Viscoelastic(self.law.scaled(factor), self.prony)
