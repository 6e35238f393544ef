"""Measured arms in a resin: they replace guesses, two measurements are weighed, what was not seen is kept."""

import math

import numpy as np
import pytest

from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import ResinArm
from dummydesign.resin.model.resin_file import save_resin
from dummydesign.resin.update import update_relaxation


def arm(tau_s, beta, spread=0.05):
    ends = [beta * math.exp(k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)]
    return ResinArm(Quantity(tau_s, 0.9 * tau_s, 1.1 * tau_s, "fitted", "puck"), Quantity(*ends, "fitted", "puck"))


def notices(updates):
    return [one.notice for one in updates if one.notice]


@pytest.fixture(scope="module")
def base():
    return load_resin()


def spread_of(quantity):
    return math.log(quantity.high / quantity.low) / (2 * HALF_WIDTH)


def strengths(resin):
    return {arm.tau_s.value: arm.beta for arm in resin.arms}


def test_a_measured_arm_takes_the_place_of_the_bases_guess(base):
    """A guess of 35 % has no weight beside a measurement of 3 %: value and interval are the measured ones."""
    own = max(base.arms, key=lambda arm: arm.tau_s.value)
    assert own.beta.kind == "inferred"
    tau, beta = 1.2 * own.tau_s.value, 1.9 * own.beta.value
    resin, updates = update_relaxation(base, [arm(tau, beta, 0.03)], 15.0, (0.5, 50.0))
    found = strengths(resin)[tau]
    assert found.value == pytest.approx(beta, rel=1e-12)
    assert spread_of(found) == pytest.approx(0.03, rel=1e-9)
    assert own.tau_s.value not in strengths(resin) and not any("widened" in text for text in notices(updates))
    assert next(one for one in updates if one.tau_s == tau).came_from == "measured"
    drawn = resin.draw(4000, 1).beta(15.0)[:, [arm.tau_s.value for arm in resin.arms].index(tau)]
    assert np.std(np.log(drawn)) == pytest.approx(0.03, rel=0.05)


def test_two_measured_arms_of_like_time_have_the_posterior_of_the_closed_form(base):
    """Two normal numbers of ln beta: weights 1 / variance."""
    tau, first, second = 3.0, 0.10, 0.11
    once, _ = update_relaxation(base, [arm(tau, first, 0.1)], 15.0, (0.5, 50.0))
    twice, updates = update_relaxation(once, [arm(1.1 * tau, second, 0.05)], 15.0, (0.5, 50.0))
    # both times are known alike
    time, found = min(strengths(twice).items(), key=lambda pair: abs(pair[0] - tau))
    assert time == pytest.approx(tau * math.sqrt(1.1), rel=1e-6)
    carried = next(one for one in updates if one.came_from == "both").base_beta
    spreads = math.log(carried[2] / carried[1]) / (2 * HALF_WIDTH), 0.05
    weights = [spread**-2 for spread in spreads]
    mean = (weights[0] * math.log(carried[0]) + weights[1] * math.log(second)) / sum(weights)
    assert math.log(found.value) == pytest.approx(mean, abs=1e-9)
    assert spread_of(found) == pytest.approx(sum(weights) ** -0.5, rel=1e-9)
    assert spreads[0] == pytest.approx(0.1, rel=0.05) and not any("widened" in text for text in notices(updates))


def test_arms_outside_what_was_seen_stay_and_those_inside_without_counterpart_go(base):
    times = [arm.tau_s.value for arm in base.arms]
    seen = (2.0 * min(times), 1000.0)
    measured = 5.0 * max(times)
    resin, updates = update_relaxation(base, [arm(measured, 0.4)], 15.0, seen)
    kept = strengths(resin)
    assert measured in kept and min(times) in kept
    assert all(time not in kept for time in times if time > seen[0])
    assert {one.came_from for one in updates} == {"measured", "base", "gone"}
    assert any("is kept" in text for text in notices(updates)) and any(
        "is replaced" in text for text in notices(updates)
    )
    assert kept[min(times)].value == pytest.approx(strengths(base)[min(times)].value, rel=0.05)


def test_what_two_pucks_contradict_is_widened_and_said(base):
    tau, beta = 3.0, 0.4
    once, _ = update_relaxation(base, [arm(tau, 0.1, 0.02)], 15.0, (0.5 * tau, 50.0 * tau))
    resin, updates = update_relaxation(once, [arm(tau, beta, 0.02)], 15.0, (0.5 * tau, 50.0 * tau))
    assert any("widened" in text for text in notices(updates))
    found = min(strengths(resin).items(), key=lambda pair: abs(pair[0] - tau))[1]
    assert found.low < beta and spread_of(found) > 2.0 * 0.02


def test_another_ratio_becomes_the_reference_and_arms_are_carried_there(base):
    # at its own ratio a strength is the median of its draws; elsewhere the median over the laws, which are not even
    for ratio, apart in ((base.relaxation_ratio_ref, 0.01), (17.0, 0.15)):
        resin, _ = update_relaxation(base, [], ratio, (1e-6, 2e-6))
        assert resin.relaxation_ratio_ref == ratio
        for before, after in zip(base.prony(ratio), resin.prony(ratio), strict=True):
            assert after.tau_s == before.tau_s
            assert after.beta == pytest.approx(before.beta, rel=apart)
    # the law between the two ratios is not known exactly, and that is in the carried strength
    assert all(spread_of(a.beta) >= 0.99 * spread_of(b.beta) for a, b in zip(resin.arms, base.arms))


def test_two_pucks_narrow_a_strength_more_than_one_and_survive_the_file(base, tmp_path):
    tau = max(arm.tau_s.value for arm in base.arms)
    value = strengths(base)[tau].value
    one, _ = update_relaxation(base, [arm(tau, value)], 15.0, (0.5 * tau, 50.0))
    two, _ = update_relaxation(one, [arm(1.05 * tau, 1.02 * value)], 15.0, (0.5 * tau, 50.0))
    widths = [spread_of(max(r.arms, key=lambda a: a.tau_s.value).beta) for r in (base, one, two)]
    assert widths[0] > widths[1] > widths[2]
    path = save_resin(two, tmp_path / "two.toml")
    again = load_resin(str(path))
    assert strengths(again) == strengths(two) and again.notes == two.notes
