"""The inference of the resin's relaxation: repeatable, and what the resin file says."""

import numpy as np
import pytest

from dummydesign.resin import load_resin
from dummydesign.studies.resins.polyurethane_relaxation import STEADY_N, _weight, infer


@pytest.fixture(scope="module")
def found():
    return infer(draws=8000)


def test_it_repeats(found):
    assert infer(draws=8000) == found


def test_the_resin_file_holds_what_the_inference_gives(found):
    resin = load_resin("polyurethane-nagoya")
    for arm, tau, (low, middle, high) in zip(resin.arms, found.tau_s, found.beta):
        assert arm.tau_s.value == tau
        np.testing.assert_allclose([arm.beta.low, arm.beta.value, arm.beta.high], [low, middle, high], rtol=0.25)
        assert low < arm.beta.value < high and arm.beta.low < middle < arm.beta.high


def test_strengths_fall_with_time_and_the_intervals_are_wide(found):
    low, middle, high = np.array(found.beta).T
    assert np.all(np.diff(middle) < 0) and np.all(high / low > 1.5)


def test_a_press_out_of_reach_meets_no_statement():
    peaks = np.array([np.nan, 1.3, 1.45, 1.7]) * STEADY_N
    weight = _weight(peaks, 13.5, 16.0)
    assert weight[0] == 0.0 and weight[2] == 1.0 and 0.0 < weight[3] < weight[1] < 1.0
