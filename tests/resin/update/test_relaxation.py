"""Measured arms in a resin: weights by inverse variance, what was not seen is kept, contradiction is said."""

import math

import pytest

from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import Arm, save_resin
from dummydesign.resin.update.relaxation import POUR, update_relaxation


def arm(tau_s, beta, spread=0.05):
    ends = [beta * math.exp(k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)]
    return Arm(Quantity(tau_s, 0.9 * tau_s, 1.1 * tau_s, "fitted", "puck"), Quantity(*ends, "fitted", "puck"))


@pytest.fixture(scope="module")
def base():
    return load_resin()


def spread_of(quantity):
    return math.log(quantity.high / quantity.low) / (2 * HALF_WIDTH)


def strengths(resin):
    return {arm.tau_s.value: arm.beta for arm in resin.arms}


def test_a_measured_arm_and_the_bases_of_like_time_have_the_posterior_of_the_closed_form(base):
    """Two normal numbers of ln beta: weights 1 / variance."""
    own = max(base.arms, key=lambda arm: arm.tau_s.value)
    tau = 1.2 * own.tau_s.value
    resin, updates, said = update_relaxation(base, [arm(tau, own.beta.value, 0.1)], 15.0, (0.5, 50.0))
    found = strengths(resin)[tau]
    carried = next(one for one in updates if one.came_from == "both").base_beta
    first, second = math.log(carried[2] / carried[1]) / (2 * HALF_WIDTH), math.hypot(0.1, POUR)
    weights = first**-2, second**-2
    mean = (weights[0] * math.log(carried[0]) + weights[1] * math.log(own.beta.value)) / sum(weights)
    assert math.log(found.value) == pytest.approx(mean, abs=1e-9)
    assert spread_of(found) == pytest.approx(sum(weights) ** -0.5, rel=1e-9)
    assert not any("widened" in text for text in said)


def test_arms_outside_what_was_seen_stay_and_those_inside_without_counterpart_go(base):
    times = [arm.tau_s.value for arm in base.arms]
    seen = (2.0 * min(times), 1000.0)
    measured = 5.0 * max(times)
    resin, updates, said = update_relaxation(base, [arm(measured, 0.4)], 15.0, seen)
    kept = strengths(resin)
    assert measured in kept and min(times) in kept
    assert all(time not in kept for time in times if time > seen[0])
    assert {one.came_from for one in updates} == {"measured", "base", "gone"}
    assert any("is kept" in text for text in said) and any("is replaced" in text for text in said)
    assert kept[min(times)].value == pytest.approx(strengths(base)[min(times)].value, rel=0.05)


def test_what_the_base_states_and_the_puck_denies_is_widened_and_said(base):
    own = base.arms[-1]
    tau, beta = own.tau_s.value, 40.0 * own.beta.high
    resin, _, said = update_relaxation(base, [arm(tau, beta, 0.02)], 15.0, (0.5 * tau, 50.0 * tau))
    assert any("widened" in text for text in said)
    found = strengths(resin)[tau]
    assert found.low < beta and spread_of(found) > 2.0 * math.hypot(0.02, POUR)


def test_another_ratio_becomes_the_reference_and_arms_are_carried_there(base):
    # at its own ratio a strength is the median of its draws; elsewhere the median over the laws, which are not even
    for ratio, apart in ((base.relaxation_ratio_ref, 0.01), (17.0, 0.15)):
        resin, *_ = update_relaxation(base, [], ratio, (1e-6, 2e-6))
        assert resin.relaxation_ratio_ref == ratio
        for before, after in zip(base.prony(ratio), resin.prony(ratio), strict=True):
            assert after.tau_s == before.tau_s
            assert after.beta == pytest.approx(before.beta, rel=apart)
    # the law between the two ratios is not known exactly, and that is in the carried strength
    assert all(spread_of(a.beta) >= 0.99 * spread_of(b.beta) for a, b in zip(resin.arms, base.arms))


def test_two_pucks_narrow_a_strength_more_than_one_and_survive_the_file(base, tmp_path):
    tau = max(arm.tau_s.value for arm in base.arms)
    value = strengths(base)[tau].value
    one, *_ = update_relaxation(base, [arm(tau, value)], 15.0, (0.5 * tau, 50.0))
    two, *_ = update_relaxation(one, [arm(1.05 * tau, 1.02 * value)], 15.0, (0.5 * tau, 50.0))
    widths = [spread_of(max(r.arms, key=lambda a: a.tau_s.value).beta) for r in (base, one, two)]
    assert widths[0] > widths[1] > widths[2]
    path = save_resin(two, tmp_path / "two.toml")
    again = load_resin(str(path))
    assert strengths(again) == strengths(two) and again.notes == two.notes
