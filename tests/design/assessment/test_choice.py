"""The reasons of a choice add up, and a puck is asked for where the resin is the largest unknown."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity
from dummydesign.design.assessment.choice import expected_totals, measure_first, terms
from dummydesign.design.assessment.pour_yield import Tolerances
from dummydesign.design.inputs import resolve
from dummydesign.design.request import Request
from dummydesign.design.suggest import design


@pytest.fixture(scope="module")
def answered():
    inputs = resolve(Request("forefinger", shape="slab", verify=False))
    return inputs, design(inputs)


def surer(resin):
    """The same resin with every number known exactly."""

    def exact(number):
        return Quantity(number.value, number.value, number.value, number.kind, number.source)

    arms = tuple(dataclasses.replace(arm, tau_s=exact(arm.tau_s), beta=exact(arm.beta)) for arm in resin.arms)
    numbers = {name: exact(number) for name, number in resin.numbers.items()}
    return dataclasses.replace(resin, numbers=numbers, arms=arms, softness_exponent=exact(resin.softness_exponent))


def test_the_terms_of_two_designs_sum_to_the_difference_of_what_they_are_ranked_by(answered):
    _, answer = answered
    best, other = answer.best, answer.alternatives[0].candidate
    assert sum(terms(best, other).values()) == pytest.approx(best.merit() - other.merit())
    assert all(abs(gain) < 1e-12 for gain in terms(best, best).values())


def test_a_puck_is_asked_for_where_the_resin_is_the_largest_unknown_and_not_where_it_is_known(answered):
    inputs, answer = answered
    tolerances = Tolerances(100.0)
    asked = measure_first(answer.best, answer.cast, inputs.space, tolerances)
    assert asked is not None and asked.text.startswith("measure a puck first")
    assert asked.either_fraction >= max(asked.each_fraction)
    assert asked.ratios[0] < asked.ratios[1]
    known = dataclasses.replace(inputs.space, resin=surer(inputs.space.resin))
    assert measure_first(answer.best, answer.cast, known, tolerances) is None


def test_no_puck_is_asked_for_where_no_modulus_makes_the_pad_fit(answered):
    inputs, answer = answered
    thick = dataclasses.replace(answer.best, thickness_mm=30.0)
    assert measure_first(thick, answer.cast, inputs.space, Tolerances(100.0)) is None


def test_an_expected_total_without_any_error_is_the_total_of_the_design(answered):
    inputs, answer = answered
    targets = dataclasses.replace(inputs.space.targets)
    targets.__dict__["drawn"] = ()
    known = dataclasses.replace(inputs.space, resin=surer(inputs.space.resin), targets=targets)
    totals = expected_totals(answer.cast, answer.best, known, Tolerances(1e6, 1e-9, 1e-9))
    assert np.ptp(totals) < 0.05 and totals.mean() == pytest.approx(answer.best.total, abs=0.05)
