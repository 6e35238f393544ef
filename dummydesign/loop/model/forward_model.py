"""The forward model: motion, pad, sensor, in a plain order; effects act at their hook."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.base_law import REFERENCE_DEPTH, UnitForce
from dummydesign.loop.model.effect import Arm, Effect, Values
from dummydesign.loop.model.parameters import BaseParameters
from dummydesign.loop.model.relaxing import relax

FEEDBACK_TOLERANCE_MM = 3e-7
FEEDBACK_STEPS = 15


@dataclass(frozen=True)
class Active:
    """An effect with its parameter values."""

    effect: Effect
    values: Values

    @property
    def absent(self) -> bool:
        """Whether the size is at its null value."""
        size = self.effect.parameters[0]
        return self.values[size.name] == size.null


@dataclass(frozen=True)
class LawError:
    """Relative error of the force law per trial: level, slope and curvature at d/h = 0.4, shapes (T,)."""

    level: NDArray
    slope: NDArray
    curve: NDArray

    def factor(self, share: NDArray) -> NDArray:
        """1 + level + slope s + curve s^2, s = (d/h) / 0.4, of relative depths (T, N)."""
        s = share / REFERENCE_DEPTH
        return 1.0 + self.level[:, None] + s * (self.slope[:, None] + s * self.curve[:, None])


def simulate(
    presses: Presses,
    law: UnitForce,
    base: BaseParameters,
    active: Sequence[Active] = (),
    error: LawError | None = None,
    offset_mm: NDArray | float = 0.0,
    near_mm: NDArray | None = None,
) -> NDArray:
    """Force before the declared sensor filter at the nodes.

    depth = displacement - offset (- effects); F_inf = E law(depth) (x effects);
    F = F_inf + sum beta_i integral exp(-(t - s) / tau_i) dF_inf(s), not below zero; then the sensor.

    Parameters
    ----------
    presses : Presses
    law : callable
        F / E of the base. [mm2]
    base : BaseParameters
    active : sequence of Active
        Effects with values; those at their null value are left out.
    error : LawError, optional
    offset_mm : float or ndarray, shape (T,)
        Contact position of each trial. [mm]
    near_mm : ndarray, shape (T, N), optional
        Where to start looking for how much the set-up gives way, see :func:`given_way`. [mm]

    Returns
    -------
    ndarray, shape (T, N)
        [N]
    """
    return _simulate(presses, law, base, active, error, offset_mm, near_mm)[0]


def given_way(
    presses: Presses,
    law: UnitForce,
    base: BaseParameters,
    active: Sequence[Active] = (),
    error: LawError | None = None,
) -> NDArray:
    """How much the set-up gives way (T, N) under the force of :func:`simulate`. [mm]

    Parameters
    ----------
    presses : Presses
        T trials.
    law : callable
        F / E of the base. [mm2]
    base : BaseParameters
        Modulus and arms.
    active : sequence of Active
        Effects with values.
    error : LawError, optional
        Relative error of the law per trial.
    """
    return _simulate(presses, law, base, active, error, 0.0, None)[1]


def _simulate(
    presses: Presses,
    law: UnitForce,
    base: BaseParameters,
    active: Sequence[Active],
    error: LawError | None,
    offset_mm: NDArray | float,
    near_mm: NDArray | None,
) -> tuple[NDArray, NDArray]:
    acting = [one for one in active if not one.absent]
    thickness = presses.thickness_mm[:, None]
    law, start = before_the_pad(presses, law, acting, offset_mm)
    loops = [one for one in acting if one.effect.feeds_back]

    def pressed(depth: NDArray) -> NDArray:
        return _pad_force(presses, law, thickness, base, acting, error, depth)

    def yielded(force: NDArray) -> NDArray:
        return start - sum(one.effect.yielding(presses, force, one.values) for one in loops)

    if loops:
        depth, force = _balance(pressed, yielded, start if near_mm is None else start - near_mm)
    else:
        depth, force = start, pressed(start)
    return sensed(presses, force, acting), start - depth


def before_the_pad(
    presses: Presses, law: UnitForce, acting: Sequence[Active], offset_mm: NDArray | float = 0.0
) -> tuple[UnitForce, NDArray]:
    """The law with all that effects change of it, and the depth (T, N) before the set-up gives way. [mm]

    Parameters
    ----------
    presses : Presses
        T trials.
    law : callable
        F / E of the base. [mm2]
    acting : sequence of Active
        Effects that are not at their null value.
    offset_mm : ndarray, shape (T,), or float
        Contact position of each trial. [mm]
    """
    law = presses.remembered(law)
    for one in acting:
        law = one.effect.law(law, one.values)
    start = presses.displacement_mm - np.broadcast_to(offset_mm, presses.thickness_mm.shape)[:, None]
    for one in acting:
        start = one.effect.depth(presses, start, one.values)
    return law, start


def sensed(presses: Presses, force_N: NDArray, acting: Sequence[Active]) -> NDArray:
    """The signal that a force on the punch (T, N) gives. [N]

    Parameters
    ----------
    presses : Presses
        T trials.
    force_N : ndarray, shape (T, N)
        Force on the punch. [N]
    acting : sequence of Active
        Effects that are not at their null value.
    """
    for one in acting:
        force_N = one.effect.sensor(presses, force_N, one.values)
    return force_N


def _balance(pressed: Callable, yielded: Callable, depth: NDArray) -> tuple[NDArray, NDArray]:
    """Depth that agrees with the yielding under its force, and that force: fixed point, a secant jump per node after
    two steps."""
    for _ in range(FEEDBACK_STEPS):
        force = pressed(depth)
        first = yielded(force)
        change = first - depth
        if float(np.max(np.abs(change))) < FEEDBACK_TOLERANCE_MM:
            return depth, force
        second = yielded(pressed(first))
        again = second - first
        rate = np.clip(np.divide(again, change, out=np.zeros_like(change), where=np.abs(change) > 1e-9), -0.9, 0.5)
        depth = first + again / (1.0 - rate)
    return depth, pressed(depth)


def _pad_force(
    presses: Presses,
    law: UnitForce,
    thickness: NDArray,
    base: BaseParameters,
    acting: Sequence[Active],
    error: LawError | None,
    depth: NDArray,
) -> NDArray:
    """Force of the pad on the punch (T, N). [N]"""
    elastic = base.young_MPa * law(depth, thickness)
    if error is not None:
        elastic = elastic * error.factor(np.maximum(depth, 0.0) / thickness)
    for one in acting:
        elastic = elastic * one.effect.scale(presses, depth, one.values)
    force = relax(presses.time_s, elastic, arms_of(presses, base, acting, depth))
    return at_the_surface(presses, force, acting, depth)


def arms_of(presses: Presses, base: BaseParameters, acting: Sequence[Active], depth_mm: NDArray) -> tuple[Arm, ...]:
    """The relaxing arms of the base with all that effects change of them.

    Parameters
    ----------
    presses : Presses
        T trials.
    base : BaseParameters
        Modulus and arms.
    acting : sequence of Active
        Effects that are not at their null value.
    depth_mm : ndarray, shape (T, N)
        Depth of the punch in the pad. [mm]
    """
    arms = tuple(Arm(tau, beta) for tau, beta in zip(base.tau_s, base.beta))
    for one in acting:
        arms = one.effect.arms(presses, arms, depth_mm, one.values)
    return arms


def at_the_surface(presses: Presses, force_N: NDArray, acting: Sequence[Active], depth_mm: NDArray) -> NDArray:
    """Force on the punch (T, N): the contact cannot pull, but for what effects change of it. [N]

    Parameters
    ----------
    presses : Presses
        T trials.
    force_N : ndarray, shape (T, N)
        Force of the pad. [N]
    acting : sequence of Active
        Effects that are not at their null value.
    depth_mm : ndarray, shape (T, N)
        Depth of the punch in the pad. [mm]
    """
    floor = np.zeros((1, 1))
    for one in acting:
        floor = one.effect.floor(presses, floor, one.values)
    force_N = np.maximum(force_N, floor)
    for one in acting:
        force_N = one.effect.surface(presses, depth_mm, force_N, one.values)
    return force_N
