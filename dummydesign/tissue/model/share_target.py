"""The parameters of a tissue at the bound above a share of people: what a dummy should have that aims at it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dummydesign.measurement.motion import DECELERATION_MM_S2
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.maxwell_law import SETTLED_S, stack
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.people_share import Population
from dummydesign.tissue.model.posterior import DRAWN, STEADY_N, posterior_tissues

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dummydesign.tissue.model.tissue import Tissue

STEPS = 24
"""Halvings of the interval of the arms' factor."""
LOG_FACTOR = -7.0, 7.0
"""Smallest and largest ln of the factor on the arms."""


def share_parameters(tissue: Tissue, share: float) -> Parameters:
    """Return one set of parameters at the bound of a share of people.

    gamma1 is the bound of the subjects' gamma1. The arms have the geometric means of the subjects' gamma_i / gamma1
    and of their times at 10 N, the strengths times the one factor with which the peaks at 10 N reach the bound of the
    subjects' peaks at the slowest and the fastest speed.

    Parameters
    ----------
    tissue : Tissue
        Of at least two subjects, with a law.
    share : float
        Of people, between 0 and 1.

    Raises
    ------
    InputError
        For one subject.
    """
    law = law_named(tissue.law)
    groups = [one.parameter_sets for one in posterior_tissues(tissue, DRAWN) or (tissue,)]
    gamma1 = float(Population.of_groups([[one.gamma1_N_per_mm3 for one in group] for group in groups]).bound(share))
    if not tissue.velocities_mm_s:
        return Parameters(tissue.law, gamma1, (), ())
    depth_mm = float(law.root(STEADY_N / gamma1))
    arms = {speed: _middle_arms(tissue, speed) for speed in tissue.velocities_mm_s}

    def at(log_factor: float) -> Parameters:
        strengths = gamma1 * np.exp(log_factor) * next(iter(arms.values()))[0]
        dampers = tuple(
            (speed, tuple((times * strengths * depth_mm**2).tolist())) for speed, (_, times) in arms.items()
        )
        return Parameters(tissue.law, gamma1, tuple(strengths.tolist()), dampers)

    speeds = (tissue.velocities_mm_s[0], tissue.velocities_mm_s[-1])
    everyone = [one for group in groups for one in group]
    shape = len(groups), len(groups[0])
    wanted = [float(Population.of_groups(_peaks(everyone, speed).reshape(shape)).bound(share)) for speed in speeds]
    low, high = LOG_FACTOR
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        enough = all(_peaks([at(middle)], speed)[0] >= peak for speed, peak in zip(speeds, wanted))
        low, high = (low, middle) if enough else (middle, high)
    return at(high)


def _middle_arms(tissue: Tissue, velocity_mm_s: float) -> tuple[NDArray, NDArray]:
    """Geometric means over the subjects of gamma_i / gamma1, and of the arms' times at 10 N. [s]"""
    gamma1, gamma, damper = stack(tissue.parameter_sets, velocity_mm_s)
    area = law_named(tissue.law).root(STEADY_N / gamma1)[:, None] ** 2
    return tuple(np.exp(np.log(one).mean(axis=0)) for one in (gamma / gamma1[:, None], damper / (gamma * area)))


def _peaks(subjects: Sequence[Parameters], velocity_mm_s: float) -> NDArray:
    """Peaks of presses to 10 N at the end of a settled hold, shape (subjects,). [N]"""
    press = law_named(subjects[0].law).press
    _, force, _ = press(subjects, STEADY_N, velocity_mm_s, SETTLED_S, DECELERATION_MM_S2)
    return np.asarray(force.max(axis=-1))
