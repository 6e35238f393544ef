"""What a load cell does to its readings: clipping is named, a curve is learned, the pad stays as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.cross_validation import leave_out
from dummydesign.loop.selection.nonparametric_effect import FOLDS, refitted_squares
from dummydesign.measurement.campaign_file import read_campaign


def reading(campaign, change):
    """The campaign with other readings of the same forces."""
    trials = [replace(one, trace=replace(one.trace, force_N=change(one.trace.force_N))) for one in campaign.trials]
    return replace(campaign, trials=tuple(trials))


def largest(campaign):
    return max(float(trial.trace.force_N.max()) for trial in campaign.trials)


@pytest.mark.slow
def test_clipped_readings_are_named_and_the_modulus_is_that_without(campaigns):
    campaign = read_campaign(campaigns("none", 411))
    limit = 0.8 * largest(campaign)
    clipped, clean = close_loop(reading(campaign, lambda force: np.minimum(force, limit))), close_loop(campaign)
    assert [one.candidate.effect.name for one in clipped.effects] == ["sensor_clipping"]
    assert clipped.verdict == "effect" and clean.verdict == "none"
    assert clipped.after.fit.base.young_MPa == pytest.approx(clean.after.fit.base.young_MPa, rel=0.01)
    (active,) = clipped.after.fit.active
    assert active.values["share"] == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_errors_by_real_fits_are_those_of_linear_steps_where_nothing_is_missing(campaigns):
    campaign = read_campaign(campaigns("none", 412))
    base = fit_base(make_presses(campaign), law_of(campaign), 0.03)
    presses, total = base.problem.presses, 0.0
    part = np.unique(presses.cell, return_inverse=True)[1] % FOLDS
    weight = presses.samples * presses.used
    for fold, change in leave_out(base, part).items():
        out = part == fold
        total += (weight[out] * (base.residual[out] - base.jacobian[out] @ change) ** 2).sum()
    assert refitted_squares(base) == pytest.approx(total / weight.sum(), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("seed, curve_per_N", [(413, -0.015), (414, 0.01), (415, -0.03)])
def test_a_quadratic_amplifier_is_named_and_the_modulus_is_that_without(campaigns, seed, curve_per_N):
    campaign = read_campaign(campaigns("none", seed))
    found = close_loop(reading(campaign, lambda force: force + curve_per_N * force * np.abs(force)))
    assert [one.candidate.effect.name for one in found.effects] == ["sensor_curve"]
    assert found.verdict == "effect" and found.learnt is None
    (active,) = found.after.fit.active
    assert active.values["relative_change"] == pytest.approx(10.0 * curve_per_N, rel=0.15)
    assert active.values["exponent"] == pytest.approx(1.0, abs=0.2)
    assert found.after.fit.base.young_MPa == pytest.approx(close_loop(campaign).after.fit.base.young_MPa, rel=0.015)


@pytest.mark.slow
def test_a_curve_within_what_load_cells_are_good_for_is_not_named(campaigns):
    campaign = read_campaign(campaigns("none", 416))
    found = close_loop(reading(campaign, lambda force: force * (1.0 - 0.0005 * np.abs(force))))
    assert "sensor_curve" not in [one.candidate.effect.name for one in found.effects]


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed, height",
    [pytest.param(413, -0.12, marks=pytest.mark.xfail(reason="learned to 0.048, 0.042 wanted")), (414, 0.1)],
)
def test_a_bump_of_the_amplifier_is_learned_as_a_function_of_the_reading(campaigns, seed, height):
    campaign = read_campaign(campaigns("none", seed))
    top = largest(campaign)

    def bump(force):
        return height * np.exp(-(((force - 0.45 * top) / (0.12 * top)) ** 2))

    found = close_loop(reading(campaign, lambda force: force * (1.0 + bump(force))))
    assert found.verdict == "unexplained"
    assert found.learnt is not None and found.learnt.effect.name == "learned_reading_n"
    assert found.learnt.effect.belongs_to == "sensor"
    at = np.linspace(0.2, 0.9, 15) * top
    off = found.learnt.effect.shape(at * (1.0 + bump(at))) - bump(at)
    assert np.ptp(off) < 0.35 * abs(height)
