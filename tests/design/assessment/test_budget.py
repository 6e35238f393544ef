"""Uncertainty budget and statements of conformity: closed forms, limits, recovery of known parts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dummydesign.design.assessment.budget import (
    STATEMENTS,
    SUBJECTS,
    Budget,
    EndSpread,
    Reading,
    UncertaintyComponent,
    budget_of_pad,
    combined_percent,
    decide,
    spread_of_ends,
)
from dummydesign.design.scoring.verdict import ENERGY, PEAK, STEADY, Readings
from tests.support.judged_pads import away, pad, ranges
from tests.support.refusal import raises_code

LIMITS = (1.2, 1.25)
PHI_2 = 0.5 * math.erfc(2.0 / math.sqrt(2.0))


def test_the_combined_uncertainty_is_the_root_sum_of_squares_of_what_is_known():
    parts = tuple(
        UncertaintyComponent(name, value) for name, value in (("a", 3.0), ("b", 4.0), ("c", None), ("d", 12.0))
    )
    assert combined_percent(parts) == 13.0
    assert combined_percent(()) == 0.0


@pytest.mark.parametrize(
    "room, statement, risk",
    [
        (2.5, 0, None),
        (2.0001, 0, PHI_2),
        (1.9999, 1, PHI_2),
        (1e-6, 1, 0.5),
        (-1e-6, 2, 0.5),
        (-1.9999, 2, 1.0 - PHI_2),
        (-2.0001, 3, 1.0 - PHI_2),
    ],
)
def test_the_statement_changes_at_the_limit_and_at_either_end_of_the_guard_band(room, statement, risk):
    u = 0.1
    for value, tolerance in ((math.exp(-room * u), (None, 1.0)), (math.exp(room * u), (1.0, None))):
        made = decide(value, tolerance, (u, u))
        assert made.statement == STATEMENTS[statement]
        if risk is not None:
            assert made.false_acceptance == pytest.approx(risk, abs=1e-3)
        edge = made.acceptance.high or made.acceptance.low
        assert abs(math.log(edge)) == pytest.approx(2.0 * u)


def test_two_limits_add_their_tails_as_counted_in_draws():
    low, high, value, u = 0.8, 1.3, 1.1, (0.12, 0.2)
    made = decide(value, (low, high), u)
    deviates = np.random.default_rng(1).standard_normal((2, 400_000))
    counted = np.mean(value * np.exp(u[0] * deviates[0]) < low) + np.mean(value * np.exp(u[1] * deviates[1]) > high)
    assert made.false_acceptance == pytest.approx(counted, abs=3e-3)


def test_without_uncertainty_nothing_is_conditional():
    assert decide(1.0, (0.5, 1.0), (0.0, 0.0)).statement == "pass"
    over = decide(1.0 + 1e-9, (0.5, 1.0), (0.0, 0.0))
    assert (over.statement, over.false_acceptance) == ("fail", 1.0)
    assert decide(0.9, (0.5, 1.0), (0.0, 0.0)).false_acceptance == 0.0


def test_with_much_uncertainty_nothing_is_known():
    wide = decide(1.0, (0.8, 1.25), (1e3, 1e3), k=0.01)
    assert wide.false_acceptance == pytest.approx(1.0, abs=1e-3)
    assert decide(1.0, (None, 1.25), (0.0, 1e3), k=0.01).false_acceptance == pytest.approx(0.5, abs=1e-3)


POSITIVE, SPREAD = st.floats(0.2, 5.0), st.floats(0.01, 1.0)


@given(value=POSITIVE, low=POSITIVE, width=st.floats(1.01, 4.0), u=st.floats(0.0, 1.0), k=st.floats(0.0, 4.0))
def test_a_wider_guard_band_never_makes_a_statement_more_certain(value, low, width, u, k):
    narrow, wide = (decide(value, (low, low * width), (u, u), one) for one in (k, k + 0.5))
    at = [STATEMENTS.index(made.statement) for made in (narrow, wide)]
    accepted = at[0] < 2
    assert (at[1] < 2) == accepted
    assert at[1] >= at[0] if accepted else at[1] <= at[0]
    assert wide.false_acceptance == narrow.false_acceptance
    # a reading that passes has at most the two tails of its guard band
    if at[1] == 0 and u > 0.0:
        assert wide.false_acceptance <= math.erfc((k + 0.5) / math.sqrt(2.0)) + 1e-12


@given(value=POSITIVE, low=POSITIVE, width=st.floats(1.01, 4.0), first=SPREAD, second=SPREAD)
def test_a_reading_and_its_inverse_are_decided_alike(value, low, width, first, second):
    made = decide(value, (low, low * width), (first, second))
    turned = decide(1.0 / value, (1.0 / (low * width), 1.0 / low), (second, first))
    assert turned.false_acceptance == pytest.approx(made.false_acceptance, abs=1e-9)


@given(room=st.floats(-3.0, 3.0), more=st.floats(0.01, 3.0), u=st.floats(0.01, 1.0))
def test_further_inside_a_false_acceptance_is_less_probable(room, more, u):
    near, far = (decide(math.exp(-one * u), (None, 1.0), (u, u)) for one in (room, room + more))
    assert far.false_acceptance < near.false_acceptance
    assert STATEMENTS.index(far.statement) <= STATEMENTS.index(near.statement)


@pytest.mark.parametrize(
    "quantity, arguments",
    [
        ("reading", (0.0, (0.5, 1.0), (0.1, 0.1))),
        ("limit", (1.0, (-0.5, 1.0), (0.1, 0.1))),
        ("standard_uncertainty", (1.0, (0.5, 1.0), (0.1, math.nan))),
        ("k", (1.0, (0.5, 1.0), (0.1, 0.1), -1.0)),
    ],
)
def test_numbers_that_mean_nothing_are_refused(quantity, arguments):
    with raises_code("out_of_range", quantity):
        decide(*arguments)


def drawn(rng, n=4000, **spreads):
    """Pads like the one in the middle, whose peaks, energies and steady forces scatter by these logarithms."""
    one, power = away(over=1.1), ranges().power
    factors = {name: np.exp(spreads.get(name, 0.0) * rng.standard_normal((n, 1))) for name in (PEAK, ENERGY, STEADY)}
    peak, energy, steady = factors.values()
    return Readings(one.peak_N * peak, one.energy_mJ * energy, one.depth_mm * steady ** (-1.0 / power))


def test_parts_that_are_known_are_found_again_and_the_nearest_reading_decides():
    rng = np.random.default_rng(7)
    parts = {"first": drawn(rng, peak=0.03), "second": drawn(rng, peak=0.04, energy=0.01)}
    budget = budget_of_pad(ranges(), away(over=1.1), LIMITS, parts, drawn(rng, peak=0.05), None)
    # the peak that is 10 % above all, of the presses that judged_pads lays out
    assert (budget.reading.steady_force_N, budget.reading.velocity_mm_s) == (10.0, 250.0)
    assert [one.standard_percent for one in budget.components[:2]] == pytest.approx([3.0, 4.0], rel=0.04)
    assert budget.combined_percent == pytest.approx(5.0, rel=0.04)
    assert budget.not_known == (SUBJECTS,) and budget.exact_range is None
    made = budget.to_dict()
    u = 0.01 * budget.combined_percent
    tail = 0.5 * math.erfc(math.log(1.25 / 1.1) / u / math.sqrt(2.0))
    assert made["false_acceptance"] == pytest.approx(tail, rel=1e-6)
    assert made["expanded_percent"] == 2.0 * made["combined_percent"] and made["k"] == 2.0
    assert made["decision"]["tolerance"]["high"] == pytest.approx(budget.reading.value / 1.1 * 1.25)
    assert made["statement"] == "pass" if math.log(1.25 / 1.1) > 2.0 * u else "conditional pass"


@pytest.mark.parametrize("name", [PEAK, ENERGY, STEADY])
def test_the_reading_that_scatters_most_decides_where_all_are_in_the_middle(name):
    rng = np.random.default_rng(3)
    whole = drawn(rng, **{PEAK: 0.01, ENERGY: 0.01, STEADY: 0.01, name: 0.2})
    budget = budget_of_pad(ranges(), pad(), LIMITS, {"all": whole}, whole, None)
    words = {PEAK: "peak force", ENERGY: "energy", STEADY: "steady force at the pad's depth"}
    assert budget.reading.quantity == words[name]
    assert budget.components[0].standard_percent == pytest.approx(20.0, rel=0.05)


def test_the_spread_of_the_subjects_is_a_part_and_is_left_out_of_the_exact_range():
    rng, band = np.random.default_rng(11), ranges()
    factors = np.exp(0.2 * rng.standard_normal(400))
    ends = spread_of_ends(
        [replace(band, peak_low_N=f * band.peak_low_N, peak_high_N=f * band.peak_high_N) for f in factors]
    )
    assert isinstance(ends, EndSpread) and ends.low[PEAK] == pytest.approx(0.2, rel=0.1)
    assert ends.low[ENERGY] == pytest.approx(0.0, abs=1e-9) and ends.high[STEADY] == pytest.approx(0.0, abs=1e-9)
    whole = drawn(rng, peak=0.03)
    budget = budget_of_pad(band, away(over=1.1), LIMITS, {"pad": whole}, whole, ends)
    assert budget.components[-1].name == SUBJECTS
    assert budget.components[-1].standard_percent == pytest.approx(20.0, rel=0.1)
    assert budget.statement == "conditional pass" and budget.exact_range.statement == "pass"
    assert budget.exact_range.false_acceptance < budget.false_acceptance


def test_the_strict_side_has_one_limit_at_the_highest_subject():
    rng, band = np.random.default_rng(2), replace(ranges(), strict=True)
    whole, one = drawn(rng, peak=0.05), away(over=1.1)
    one = replace(one, peak_N=one.peak_N * 1.2)
    budget = budget_of_pad(band, one, (1.01, None), {"pad": whole}, whole, None)
    assert budget.decision.tolerance.high is None
    assert budget.decision.tolerance.low is not None


def test_a_press_out_of_reach_fails_and_a_pad_that_reaches_none_has_no_budget():
    rng, one = np.random.default_rng(2), away(over=1.1)
    whole = drawn(rng, peak=0.05)
    one.peak_N[3] = one.energy_mJ[3] = np.nan
    budget = budget_of_pad(ranges(), one, LIMITS, {"pad": whole}, whole, None)
    assert (budget.statement, budget.false_acceptance, budget.missing) == ("fail", 1.0, 1)
    nothing = Readings(*(np.full_like(values, np.nan) for values in vars(one).values()))
    assert budget_of_pad(ranges(), nothing, LIMITS, {"pad": whole}, whole, None) is None


def test_a_doubt_of_unknown_size_makes_a_pass_conditional_and_its_risk_unknown():
    made = decide(1.0, (None, 2.0), (0.0, 0.1))
    budget = Budget(
        Reading("peak force", 1.0, "N"), (UncertaintyComponent("trace", 10.0),), "at most 2 N", made, doubt="beyond"
    )
    assert made.statement == "pass" and budget.statement == "conditional pass"
    assert budget.to_dict()["false_acceptance"] is None
