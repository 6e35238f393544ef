"""Prony relaxation on top of an elastic force (quasi-linear law), exact for piecewise-linear histories."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.core.serialise import Serialised


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
