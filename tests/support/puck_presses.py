"""A small campaign of pucks between plates, whose force law has a closed form, made by the loop's own model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses, planned_trace, stack
from dummydesign.loop.fitting.fit import CampaignFit, fit_base, start_vector
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.measurement.campaign import Trial
from tests.support.known_laws import puck_law

DIAMETER_MM, YOUNG_MPA, NOISE_N = 30.0, 0.05, 0.1
STEP_S = 0.8371e-3  # between samples, no part of a millisecond
LAW = puck_law(DIAMETER_MM)


def trial(
    name: str, thickness_mm: float, velocity_mm_s: float, share: float, repeat: int, sequence: int, **more: float
) -> Trial:
    """One press to a share of the thickness, held for two seconds and taken back, without its force."""
    plan = planned_trace(name, velocity_mm_s, share * thickness_mm, 2.0, True)
    # no sample lies on the edge of a bin, where rounding would decide
    fine = np.arange(plan.time_s[0] + STEP_S, share * thickness_mm / velocity_mm_s + 0.4, STEP_S)
    time = np.r_[fine, plan.time_s[plan.time_s > fine[-1] + 2e-3] + 0.137 * STEP_S]
    time = time[time < plan.time_s[-1]]
    trace = replace(
        plan,
        time_s=time,
        displacement_mm=np.interp(time, plan.time_s, plan.displacement_mm),
        force_N=np.zeros_like(time),
    )
    given = {"rest_s": 300.0, "temperature_C": 21.0 + 0.5 * sequence, "age_days": 7.0 + thickness_mm, **more}
    return Trial(
        name,
        thickness_mm,
        velocity_mm_s,
        2.0,
        None,
        repeat,
        sequence,
        given["rest_s"],
        given["temperature_C"],
        given["age_days"],
        trace,
    )


@lru_cache(maxsize=1)
def planned() -> Presses:
    """Two pucks, two speeds, two depths, two repeats."""
    every = product((1, 2), (0.15, 0.3), (4.7, 190.0), (8.0, 12.0))
    rows = [(h, v, share, repeat) for repeat, share, v, h in every]
    return stack(tuple(trial(f"p{n}.csv", *row, n) for n, row in enumerate(rows, 1)), None)


def truth() -> NDArray:
    """The vector of which the campaign is made: no law error."""
    return start_vector(CampaignProblem(planned(), LAW), YOUNG_MPA)


def pressed(change: Callable[[Presses, NDArray], NDArray] | None = None, seed: int = 1) -> Presses:
    """The presses with the model's force and white noise; ``change`` gives a factor of it at the bins (T, B)."""
    presses, chance = planned(), np.random.default_rng(seed)
    problem = CampaignProblem(presses, LAW)
    forces = problem.predict(truth())
    factor = np.ones_like(forces) if change is None else change(presses, forces)
    trials, bins = [], np.zeros_like(forces)
    for row, (one, press, model) in enumerate(zip(presses.trials, presses.presses, problem.at_samples(truth()))):
        time, count = one.trace.time_s, len(press.start_s)
        more = np.interp(time, 0.5 * (press.start_s + press.end_s), factor[row, :count])
        force = model * more + NOISE_N * chance.normal(size=len(time))
        trials.append(replace(one, trace=replace(one.trace, force_N=force)))
        inside = [(time >= start) & (time < end) for start, end in zip(press.start_s, press.end_s)]
        bins[row, :count] = [force[at].mean() for at in inside]
        # of the model's own means: a bin of a steep rise is not the mean of its samples' model
        bins[row, :count] += forces[row, :count] - [model[at].mean() for at in inside]
    reduced = tuple(replace(one, white_N=NOISE_N) for one in presses.presses)
    return replace(presses, trials=tuple(trials), presses=reduced, force_N=bins)


@lru_cache(maxsize=1)
def clean_fit() -> CampaignFit:
    """The base fit of the campaign with nothing but noise."""
    return fit_base(pressed(), LAW, YOUNG_MPA)
