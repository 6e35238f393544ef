"""The reasons of a choice add up, and its expected score is that of the castings of the answer."""

import dataclasses

import numpy as np
import pytest

from MISSING.dummydesign.design.assessment.choice import castings_for_tissues, terms
from dummydesign.design.assessment.decision import explain
from dummydesign.design.request import Request
from dummydesign.design.problem import read_problem
from dummydesign.design.suggest import design
from tests.support.cast_pads import SHARP, known, with_tissues


@pytest.fixture(scope="module")
def answered():
    inputs = read_problem(Request("forefinger", shape="slab", verify=False))
    return inputs, design(inputs)


def test_the_terms_of_two_designs_sum_to_the_difference_of_what_they_are_ranked_by(answered):
    _, answer = answered
    best, other = answer.best, answer.alternatives[0].candidate
    assert sum(terms(best, other).values()) == pytest.approx(best.merit() - other.merit())
    assert all(abs(gain) < 1e-12 for gain in terms(best, best).values())


def test_an_expected_total_without_any_error_is_the_total_of_the_design(answered):
    _, answer = answered
    cast = answer.castings
    sure = dataclasses.replace(
        cast, castings=dataclasses.replace(cast.castings, resin=known(cast.castings.resin)),
        space=with_tissues(cast.space, ()), tolerances=SHARP,
    )  # fmt: skip
    totals = castings_for_tissues(sure, 0.0).total
    assert np.ptp(totals) < 0.05 and totals.mean() == pytest.approx(answer.best.total, abs=0.05)


def test_the_reasons_have_the_expected_score_of_the_castings_of_the_answer(answered):
    _, answer = answered
    told = explain(answer.castings, "slab", ())
    totals = castings_for_tissues(answer.castings, 0.0).total
    assert told == answer.choice
    assert told.expected_total == totals.mean() and told.total_low == np.quantile(totals, 0.05)
    assert told.next_best is None and told.terms == {} and told.decided_by is None
