"""The nonlinear Maxwell law of soft tissue in its three forms: ``ode``, ``consistent`` and ``published``.

A spring gamma1 x^2 acts in parallel with arms of a spring gamma_i x^2 in series with a damper c_i: one arm
is the three-element law, two the five-element law, three the seven-element law. With the arm's rate
r_i = gamma_i / c_i the force is linear in all gammas,

    F(t) = gamma1 X(t) + sum_i gamma_i A(t; r_i),

and only the form of A differs between the three. ``ode`` follows any motion; the other two know an ideal
ramp (speed v, stop at t_p) only, and take mean speed and stop time of what they are given.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.landmarks import find_ramp
from dummydesign.measurement.motion import Motion

LAWS = ("ode", "consistent", "published")
ELEMENTS = (3, 5, 7)

_GAUSS_X, _GAUSS_W = (0.5 * (x + shift) for x, shift in zip(np.polynomial.legendre.leggauss(4), (1.0, 0.0)))


def check_law(law: str) -> str:
    """Return ``law`` when it is one of :data:`LAWS`, else raise InputError."""
    if law not in LAWS:
        raise unknown_name("law", law, LAWS)
    return law


def force(
    law: str, motion: Motion, gamma1_N_per_mm3: ArrayLike, gamma_N_per_mm3: ArrayLike, c_N_s_per_mm: ArrayLike
) -> NDArray:
    """Force of the tissue law under a motion, for one or many parameter sets at once.

    Parameters
    ----------
    law : str
        ``ode``, ``consistent`` or ``published``.
    motion : Motion
        Arrays of shape (n,) or (..., n).
    gamma1_N_per_mm3 : array_like, shape (...)
        Steady stiffness coefficient, F_s = gamma1 x^3. [N/mm3]
    gamma_N_per_mm3, c_N_s_per_mm : array_like, shape (..., arms)
        Spring and damper of each arm, c above 0. [N/mm3, N s/mm]

    Returns
    -------
    ndarray, shape (..., n)
        Force. [N]

    Raises
    ------
    InputError
        For an unknown law, a damper that is not positive or a negative gamma.

    References
    ----------
    :data:`dummydesign.core.references.PAPER`, equations (4) to (6) (``published``); the ODE is our reading of its
    figure 6(b).
    """
    gamma1 = np.asarray(gamma1_N_per_mm3, float)
    gamma, damper = np.asarray(gamma_N_per_mm3, float), np.asarray(c_N_s_per_mm, float)
    if not np.all(damper > 0):
        raise out_of_range("damper c_N_s_per_mm", float(damper.min()), "above 0", "any finite value")
    if np.any(gamma < 0) or np.any(gamma1 < 0):
        raise out_of_range("gamma", float(min(gamma.min(), gamma1.min())), 0, "any finite value")
    if gamma.shape[-1:] != damper.shape[-1:]:
        raise InputError(f"{gamma.shape[-1]} springs but {damper.shape[-1]} dampers; each arm needs one of both")
    drive = Drive(law, motion)
    total = gamma1[..., None] * drive.elastic
    for arm in range(gamma.shape[-1]):
        strength = gamma[..., arm]
        total = total + strength[..., None] * drive.arm(strength / damper[..., arm])
    return total


class Drive:
    """What a motion does to the law: the elastic shape X(t) and the response A(t; r) of an arm, both in mm3.

    Parameters
    ----------
    law : str
        One of :data:`LAWS`.
    motion : Motion
        Arrays of shape (n,) or (..., n).

    Attributes
    ----------
    elastic : ndarray, shape (..., n)
        X(t), the cube of the displacement (of the ideal ramp's for ``consistent`` and ``published``). [mm3]
    """

    def __init__(self, law: str, motion: Motion) -> None:
        self.law = check_law(law)
        time, x = np.asarray(motion.time_s, float), np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        if law == "ode":
            self._step, self._x = np.diff(time, axis=-1), x
            self.elastic = x**3
            return
        contact, stop, depth = ramps_of(motion)
        self._rise, self._depth = (stop - contact)[..., None], depth[..., None]
        self._velocity = self._depth / self._rise
        self._since = np.maximum(time - contact[..., None], 0.0)
        self.elastic = (self._velocity * np.minimum(self._since, self._rise)) ** 3

    def arm(self, rate: ArrayLike) -> NDArray:
        """Response A(t; r) of an arm with spring 1 x^2 and damper 1 / r. [mm3]

        Parameters
        ----------
        rate : array_like, shape (...)
            r = gamma / c, above or equal to 0. [1 / (mm2 s)]

        Returns
        -------
        ndarray, shape (..., n)
        """
        rate = np.asarray(rate, float)[..., None]
        return self._ode_arm(rate) if self.law == "ode" else self._ramp_arm(rate)

    def _ode_arm(self, rate: NDArray) -> NDArray:
        """Stretch e' = x' - r x^2 e by the exact integrating factor of each step on which x is linear."""
        before, after = self._x[..., :-1], self._x[..., 1:]
        rise = after - before
        decay = rate * self._step * (before**2 + before * after + after**2) / 3.0
        stretch = linear_recurrence(np.exp(-decay), rise * _mean_survival(rate * self._step, after, rise, decay))
        response = np.zeros(np.broadcast_shapes(rate.shape[:-1] + (1,), self._x.shape))
        response[..., 1:] = after**2 * stretch
        return response

    def _ramp_arm(self, rate: NDArray) -> NDArray:
        """Equation (5) of the paper for a unit spring; ``published`` keeps the printed hold exponent."""
        rate = np.maximum(rate, 1e-300)
        v, peak_time = self._velocity, self._rise
        rising = np.minimum(self._since, peak_time)
        held = np.maximum(self._since - peak_time, 0.0)
        clock = peak_time if self.law == "consistent" else np.maximum(self._since, peak_time)
        loaded = -np.expm1(-rate * v**2 * rising**3) * v / rate
        return loaded * np.exp(-rate * (v * clock) ** 2 * held)


def _mean_survival(rate_step: NDArray, after: NDArray, rise: NDArray, decay: NDArray) -> NDArray:
    """Mean over a step of exp(-decay from then to the step's end): what is left of stretch added evenly.

    With w the share of the step still to go, the decay is r dt (x1^2 w - x1 dx w^2 + dx^2 w^3 / 3). Four
    Gauss points per panel; panels halve towards the end of the step, where a fast arm keeps its memory.
    The relative error stays below 2e-6.
    """
    moving = np.broadcast_to(rise != 0, decay.shape)
    strongest = float(np.max(decay, where=moving, initial=0.0))
    panels = 1 if strongest < 0.25 else 2 + int(np.ceil(np.log2(max(strongest, 1.0))))
    edges = np.r_[0.0, 0.5 ** np.arange(panels - 1, -1, -1)]
    linear, square, cubic = rate_step * after**2, rate_step * after * rise, rate_step * rise**2 / 3.0
    total = np.zeros(decay.shape)
    for low, high in itertools.pairwise(edges):
        for point, weight in zip(_GAUSS_X, _GAUSS_W):
            w = low + (high - low) * point
            total += (high - low) * weight * np.exp(-w * (linear - w * (square - w * cubic)))
    return total


def ramps_of(motion: Motion) -> tuple[NDArray, NDArray, NDArray]:
    """Contact time [s], stop time [s] and depth [mm] of each motion, each of shape (...)."""
    time, x = np.broadcast_arrays(motion.time_s, motion.displacement_mm)
    flat_time, flat_x = time.reshape(-1, time.shape[-1]), x.reshape(-1, x.shape[-1])
    found = [find_ramp(t, d) for t, d in zip(flat_time, flat_x)]
    leading = time.shape[:-1]
    columns = np.array([[ramp.contact_time_s, ramp.stop_time_s, ramp.depth_mm] for ramp in found])
    return tuple(columns[:, index].reshape(leading) for index in range(3))


def parameter_names(elements: int) -> list[str]:
    """Names of the parameters of the 3, 5 or 7 element law, in the order gamma1, gamma2.., c2.."""
    if elements not in ELEMENTS:
        raise InputError(f"elements = {elements} is not one of 3, 5, 7")
    arms = range(2, 2 + (elements - 1) // 2)
    return [f"gamma{i}_N_per_mm3" for i in (1, *arms)] + [f"c{i}_N_s_per_mm" for i in arms]


def steady_depth(
    law: str, make_motion: Any, force_N: ArrayLike, gamma1: ArrayLike, gamma: ArrayLike, c: ArrayLike
) -> NDArray:
    """Depth whose force at the end of the hold is ``force_N``, found by iteration on the local cube law. [mm]

    Parameters
    ----------
    law : str
        One of :data:`LAWS`.
    make_motion : callable
        Maps depths of shape (...) to a Motion that ends with the hold.
    force_N, gamma1 : array_like, shape (...)
        Force at the end of the hold [N] and steady coefficient [N/mm3].
    gamma, c : array_like, shape (..., arms)
        Arms.

    Returns
    -------
    ndarray, shape (...)
    """
    target = np.asarray(force_N, float)
    depth = np.cbrt(target / np.asarray(gamma1, float))
    for _ in range(30):
        reached = force(law, make_motion(depth), gamma1, gamma, c)[..., -1]
        depth = depth * np.cbrt(target / reached)
        if np.all(np.abs(reached / target - 1.0) < 1e-7):
            break
    return depth
