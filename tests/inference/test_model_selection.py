"""Choice between nested models."""

import numpy as np
import pytest

from dummydesign.inference.least_squares import CHI_SQUARE_95, PARSIMONY, aicc, simplest, within


def test_the_correction_vanishes_for_many_numbers_and_punishes_few():
    assert aicc(100.0, 5, 10**7) == pytest.approx(110.0, abs=1e-4)
    # Hurvich and Tsai (1989): 2 k n / (n - k - 1)
    assert aicc(0.0, 3, 10) == pytest.approx(2 * 3 * 10 / (10 - 3 - 1))


def test_more_parameters_must_earn_more_than_the_gain():
    assert simplest({3: 10.0 + PARSIMONY, 5: 10.0, 7: 12.0}) == 3
    assert simplest({3: 10.1 + PARSIMONY, 5: 10.0, 7: 4.1}) == 5
    assert simplest({3: 100.0, 5: 50.0, 7: 10.0}) == 7


def test_the_interval_on_a_grid_is_what_chi_square_allows():
    from scipy.stats import chi2

    assert CHI_SQUARE_95 == pytest.approx(chi2.ppf(0.95, 1), abs=1e-4)
    grid = np.linspace(-3.0, 3.0, 601)
    kept = within(list(grid**2))  # 1.95 squared is below 3.84, 1.96 squared is not
    assert grid[kept[0]] == pytest.approx(-1.95) and grid[kept[-1]] == pytest.approx(1.95)
    assert within([1.0, 5.0, 30.0], unit=4.0) == [0, 1]
    assert within([1.0, 5.0], lowest=4.0) == [0, 1]
