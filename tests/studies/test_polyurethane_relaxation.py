"""The inference of the resin's relaxation: repeatable, free of its draws, and what the resin file says."""

import numpy as np
import pytest

from dummydesign.resin import load_resin
from studies.resins.polyurethane_relaxation import STEADY_N, _weight, infer


@pytest.fixture(scope="module")
def found():
    return infer()


def test_it_repeats():
    assert infer(draws=1000) == infer(draws=1000)


@pytest.mark.slow
def test_other_draws_give_the_same_within_their_sampling_error(found):
    """A quantile of 8000 draws has a standard error of at most 3.1 % (measured over 8 seeds), one of 20,000 of 2 %."""
    other = infer(draws=8000, seed=31)
    np.testing.assert_allclose(other.beta, found.beta, rtol=3.0 * np.hypot(0.031, 0.02))


def test_the_resin_file_holds_what_the_inference_gives(found):
    """The same draws; the file has two digits of the ends and three of the middle."""
    resin = load_resin("polyurethane-nagoya")
    for arm, tau, (low, middle, high) in zip(resin.arms, found.tau_s, found.beta, strict=True):
        assert arm.tau_s.value == tau
        np.testing.assert_allclose([arm.beta.low, arm.beta.value, arm.beta.high], [low, middle, high], rtol=0.02)
        assert low < arm.beta.value < high and arm.beta.low < middle < arm.beta.high


def test_strengths_fall_with_time_and_the_intervals_are_wide(found):
    low, middle, high = np.array(found.beta).T
    assert np.all(np.diff(middle) < 0) and np.all(high / low > 1.5)


def test_a_press_out_of_reach_meets_no_statement():
    peaks = np.array([np.nan, 1.3, 1.45, 1.7]) * STEADY_N
    weight = _weight(peaks, 13.5, 16.0)
    assert weight[0] == 0.0 and weight[2] == 1.0 and 0.0 < weight[3] < weight[1] < 1.0
