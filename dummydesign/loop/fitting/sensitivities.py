"""Sensitivities of the bins to base parameters and law error from one evaluation of the force law.

The relaxation is linear in the elastic force, so modulus, level, slope and curvature of the law error share three
relaxations of E law(depth) s^k, s = (d/h) / 0.4; the arms are moved one at a time with the same elastic force.
Signal effects act on each moved force. Effects that feed back on the depth are left to plain differences.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.model.base_law import REFERENCE_DEPTH
from dummydesign.loop.model.effect import Arm
from dummydesign.loop.model.forward_model import arms_of, at_the_surface, before_the_pad, sensed
from dummydesign.loop.model.parameters import BaseParameters
from dummydesign.loop.model.relaxing import arm_forces, loaded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dummydesign.loop.data.trials import Presses
    from dummydesign.loop.fitting.problem import Problem

ARMS = (1, 2, 3, 4)
"""Places of the arms' logarithms in the vector."""


def shares_the_law(problem: Problem, vector: NDArray) -> bool:
    """Whether the depth does not depend on the force, so that one evaluation of the law serves."""
    return not any(one.effect.feeds_back for one in problem.active_of(vector) if not one.absent)


def base_and_law_columns(problem: Problem, vector: NDArray, step: float) -> tuple[NDArray, NDArray]:
    """Forward differences with respect to the base logarithms, and to the law error of each trial's pad.

    Parameters
    ----------
    problem : Problem
        The campaign with its effects.
    vector : ndarray, shape (n,)
        Where the differences are taken.
    step : float
        Size of the step in each entry.

    Returns
    -------
    base : ndarray, shape (T, B, 5)
    law : ndarray, shape (T, B, 3)
        Level, slope, curvature.
    """
    presses, logs = problem.presses, vector[:5]
    acting = [one for one in problem.active_of(vector) if not one.absent]
    law, depth = before_the_pad(presses, problem.law, acting)
    thickness = presses.thickness_mm[:, None]
    unit = law(depth, thickness)
    for one in acting:
        unit = unit * one.effect.scale(presses, depth, one.values)
    share = np.maximum(depth, 0.0) / thickness / REFERENCE_DEPTH
    base, error = problem.base_of(vector), problem.law_error_of(vector)
    level, slope, curve = (term[:, None] for term in (error.level, error.slope, error.curve))
    arms = arms_of(presses, base, acting, depth)
    plain = base.young_MPa * unit
    powers = np.stack([plain, plain * share, plain * share**2])
    weights = np.stack([1.0 + level, slope, curve])
    elastic = (weights * powers).sum(axis=0)
    held = arm_forces(presses.time_s, powers, arms)
    shapes = [loaded(power, arms, held[:, k]) for k, power in enumerate(powers)]
    force = (weights * np.stack(shapes)).sum(axis=0)
    moved = [force, force * np.exp(step), *(force + step * one for one in shapes)]
    total = (weights * held).sum(axis=1)
    for place in ARMS:
        other = logs.copy()
        other[place] += step
        changed = arms_of(presses, BaseParameters.from_logs(other), acting, depth)
        moved.append(_with_arms(presses, elastic, arms, total, changed))
    shown = [sensed(presses, at_the_surface(presses, one, acting, depth), acting) for one in moved]
    bins = presses.measured(np.stack(shown, axis=-1))
    change = (bins[..., 1:] - bins[..., :1]) / step
    return change[..., [0, 4, 5, 6, 7]], change[..., 1:4]


def _with_arms(
    presses: Presses, elastic_N: NDArray, arms: Sequence[Arm], held_N: NDArray, changed: Sequence[Arm]
) -> NDArray:
    """Force (T, N) with other arms; what those with an old time and weight hold (arms, T, N) is known. [N]"""
    known = []
    for place, arm in enumerate(changed):
        old = arms[place] if place < len(arms) else None
        if old is not None and np.array_equal(old.tau_s, arm.tau_s) and _same(old.weight, arm.weight):
            known.append(held_N[place])
        else:
            known.append(arm_forces(presses.time_s, elastic_N[None], [arm])[0, 0])
    return loaded(elastic_N, changed, np.stack(known))


def _same(one: NDArray | None, other: NDArray | None) -> bool:
    return one is other if one is None or other is None else np.array_equal(one, other)
