"""The relaxing arms: what each holds of an elastic force, and the force that they make together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.loop.model.effect import Arm


def relax(time_s: NDArray, elastic_N: NDArray, arms: Sequence[Arm]) -> NDArray:
    """Quasi-linear force of elastic forces, piecewise linear in time, with arms that may differ by trial.

    The same law as :func:`dummydesign.pad.material.relaxation.relaxed_force`, with an optional weight on what
    each arm is loaded with.

    Parameters
    ----------
    time_s : ndarray, shape (T, N)
        Increasing times of each trial. [s]
    elastic_N : ndarray, shape (T, N)
        Long-term elastic force there. [N]
    arms : sequence of Arm
        Time constants and strengths, equal for all trials or one each.

    Returns
    -------
    ndarray, shape (T, N)
        [N]
    """
    return loaded(elastic_N, arms, arm_forces(time_s, elastic_N[None], arms)[:, 0])


def arm_forces(time_s: NDArray, elastic_N: NDArray, arms: Sequence[Arm]) -> NDArray:
    """Force that each arm holds of several elastic forces, per unit strength, shape (arms, K, T, N). [N]

    Parameters
    ----------
    time_s : ndarray, shape (T, N)
        Increasing times of each trial. [s]
    elastic_N : ndarray, shape (K, T, N)
        K long-term elastic forces. [N]
    arms : sequence of Arm
        Their strengths do not matter here.
    """
    step, rise = np.diff(time_s, axis=1), np.diff(elastic_N, axis=-1)
    ratio = np.stack([np.broadcast_to(step / arm.tau_s, step.shape) for arm in arms])[:, None]
    lost = -np.expm1(-ratio)
    fed = np.stack([rise if arm.weight is None else rise * _middle(arm.weight) for arm in arms])
    first = np.stack([elastic_N[..., 0] * (1.0 if arm.weight is None else arm.weight[:, 0]) for arm in arms])
    state = linear_recurrence(1.0 - lost, fed * (lost / ratio), first)
    return np.concatenate([first[..., None], state], axis=-1)


def loaded(elastic_N: NDArray, arms: Sequence[Arm], held_N: NDArray) -> NDArray:
    """Elastic force (T, N) and what the arms add to it. [N]

    Parameters
    ----------
    elastic_N : ndarray, shape (T, N)
        Long-term elastic force. [N]
    arms : sequence of Arm
        With their strengths.
    held_N : ndarray, shape (arms, T, N)
        See :func:`arm_forces`. [N]
    """
    force = elastic_N.copy()
    for arm, held in zip(arms, held_N):
        force += arm.beta * held
    return force


def _middle(values: NDArray) -> NDArray:
    return 0.5 * (values[:, 1:] + values[:, :-1])
