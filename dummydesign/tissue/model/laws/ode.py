"""The law as the differential equation of its arms, which follows any motion."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, MotionResponse

_GAUSS_X, _GAUSS_W = (0.5 * (x + shift) for x, shift in zip(np.polynomial.legendre.leggauss(4), (1.0, 0.0)))


class Ode(MaxwellLaw):
    """Springs gamma x^2 in series with dampers c: stretch e' = x' - (gamma / c) x^2 e, arm force gamma x^2 e."""

    name = "ode"
    words = "the differential equation of the arms along the measured motion"
    reference = (
        "our reading of figure 6(b) of 'Development of Dummy Based on Impedance Properties of Human Soft Tissue Using "
        "a Nonlinear Viscoelastic Model', IEEE Access"
    )

    def drive(self, motion: Motion) -> OdeDrive:
        """Drive by the motion as it is."""
        return OdeDrive(motion)

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """Gain 1, decay r x^2."""
        return np.ones_like(rate), rate * (depth_mm**2)[..., None]


class OdeDrive(MotionResponse):
    """X = x^3, and A = x^2 e by the exact integrating factor of each step on which x is linear."""

    def __init__(self, motion: Motion) -> None:
        time = np.asarray(motion.time_s, float)
        self._x = np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        self._step = np.diff(time, axis=-1)
        self.elastic = self._x**3

    def arm(self, rate: ArrayLike) -> NDArray:
        """A(t; r). [mm3]"""
        rate = np.asarray(rate, float)[..., None]
        before, after = self._x[..., :-1], self._x[..., 1:]
        rise = after - before
        decay = rate * self._step * (before**2 + before * after + after**2) / 3.0
        # nothing is added to the stretch while nothing moves: the hold's samples are left out
        moving = np.flatnonzero((rise != 0.0).any(axis=tuple(range(rise.ndim - 1))))
        added = np.zeros(decay.shape)
        if len(moving):
            rate_step = (rate * self._step)[..., moving]
            parts = after[..., moving], rise[..., moving], decay[..., moving]
            added[..., moving] = parts[1] * _mean_survival(rate_step, *parts)
        stretch = linear_recurrence(np.exp(-decay), added)
        response = np.zeros(np.broadcast_shapes(rate.shape[:-1] + (1,), self._x.shape))
        response[..., 1:] = after**2 * stretch
        return response


def _mean_survival(rate_step: NDArray, after: NDArray, rise: NDArray, decay: NDArray) -> NDArray:
    """Mean over a step of exp(-decay from then to the step's end): the rest of stretch added evenly.

    With w the share of the step still to go, the decay is r dt (x1^2 w - x1 dx w^2 + dx^2 w^3 / 3). Four
    Gauss points per panel; panels halve towards the end of the step, where a fast arm keeps its memory.
    The relative error stays below 2e-6.
    """
    strongest = float(np.max(decay, where=np.broadcast_to(rise != 0, decay.shape), initial=0.0))
    panels = 1 if strongest < 0.25 else 2 + int(np.ceil(np.log2(max(strongest, 1.0))))
    edges = np.r_[0.0, 0.5 ** np.arange(panels - 1, -1, -1)]
    linear, square, cubic = rate_step * after**2, rate_step * after * rise, rate_step * rise**2 / 3.0
    total, left = np.zeros(decay.shape), np.empty(decay.shape)
    for low, high in itertools.pairwise(edges):
        for point, weight in zip(_GAUSS_X, _GAUSS_W):
            w = low + (high - low) * point
            # exp(-w (linear - w (square - w cubic))), in place
            np.subtract(square, np.multiply(cubic, w, out=left), out=left)
            np.subtract(linear, np.multiply(left, w, out=left), out=left)
            np.exp(np.multiply(left, -w, out=left), out=left)
            total += np.multiply(left, (high - low) * weight, out=left)
    return total


ODE = Ode()
