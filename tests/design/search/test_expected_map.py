"""The mean over castings along a row of the map of ratios: weights that sum to 1, and the mean of a line."""

import numpy as np
import pytest

from dummydesign.design.assessment.castings import FORCE_LAW, MAKING, Castings, Tolerances
from dummydesign.design.search.slabs import averaging
from dummydesign.resin import load_resin
from tests.support.cast_pads import known


@pytest.fixture(scope="module")
def resin():
    return load_resin()


@pytest.mark.parametrize("low, high", [(None, None), (15.0, 16.0), (14.0, 14.5), (18.0, 20.0)])
def test_weights_are_shares_that_sum_to_one(resin, low, high):
    ratio = resin.ratios(low, high)
    weights = averaging(resin, ratio)
    assert weights.shape == (len(ratio), len(ratio)) and (weights >= 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 40])
def test_a_resin_that_is_known_leaves_the_map_as_it_is(resin, count):
    ratio = resin.ratios()[:count]
    np.testing.assert_allclose(averaging(known(resin), ratio), np.eye(count), atol=1e-9)


def test_one_ratio_alone_is_its_own_mean(resin):
    np.testing.assert_array_equal(averaging(resin, np.array([15.0])), [[1.0]])


@pytest.mark.parametrize("ratio", [16.0, 16.5, 17.0])
def test_the_mean_over_castings_of_what_is_linear_in_the_ratio_is_met(resin, ratio):
    """a casting of another modulus counts as one of the ratio of that modulus; ends of the range count at the ends"""
    ratios = resin.ratios()
    here = int(np.argmin(np.abs(ratios - ratio)))
    drawn = Castings(resin, 20_000).pours(8.0, ratio, Tolerances(100.0), 0.0, (MAKING, FORCE_LAW)).young_MPa
    order = np.argsort(resin.young_MPa(ratios))
    as_ratio = np.interp(np.log(drawn), np.log(resin.young_MPa(ratios))[order], ratios[order])
    for slope, offset in ((1.0, 0.0), (-0.1, 2.5), (0.3, 1.0)):
        linear = offset + slope * ratios
        assert averaging(resin, ratios)[here] @ linear == pytest.approx(np.mean(offset + slope * as_ratio), rel=0.02)


def test_a_constant_map_loses_nothing_and_a_peak_loses_most_at_its_top(resin):
    ratios = resin.ratios()
    weights = averaging(resin, ratios)
    np.testing.assert_allclose(weights @ np.full(len(ratios), 0.7), 0.7)
    peak = np.exp(-(((ratios - 16.0) / 0.3) ** 2))
    expected = weights @ peak
    assert expected.max() < peak.max() and expected.sum() > 0.0
    loss = peak - expected
    assert abs(ratios[np.argmax(loss)] - 16.0) < 0.15
