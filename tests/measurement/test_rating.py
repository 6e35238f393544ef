"""The objective rating of ISO/TS 18571: closed forms, another implementation's numbers, brute force."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from dummydesign.measurement.rating import WEIGHTS, averaged_slope, best_shift, rate, warped
from tests.support.rated_curves import COUNT, FILE, drawn_pair, rated_by_package
from tests.support.refusal import raises_code

PAIR = Path(__file__).parent / "rating"


def pulse(n=300, middle=0.5, width=0.1):
    """A bell that is zero well before the ends."""
    return np.exp(-0.5 * ((np.linspace(0.0, 1.0, n) - middle) / width) ** 2)


def test_the_public_pair_of_curves_is_rated_as_published():
    """Curves and ratings of objective_rating_metrics, MIT; see LICENSE beside the curves."""
    files = (PAIR / f"{name}.csv" for name in ("reference", "comparison"))
    reference, compared = (np.loadtxt(file, delimiter=",")[:, 1] for file in files)
    rating = rate(reference, compared)
    published = {"R": 0.831, "Z": 0.653, "EP": 0.942, "EM": 0.951, "ES": 0.957}
    assert {name: round(value, 3) for name, value in rating.to_dict().items()} == published


@pytest.mark.parametrize("seed", range(COUNT))
def test_drawn_curves_are_rated_as_by_another_implementation(seed):
    known = json.loads(FILE.read_text())["ratings"][seed]
    assert [*rate(*drawn_pair(seed)).to_dict().values()] == pytest.approx(known, abs=1e-9)


@pytest.mark.slow
def test_new_curves_are_rated_as_by_the_package_where_it_is_installed():
    pytest.importorskip("objective_rating_metrics.rating", exc_type=ImportError)
    first = int(np.random.default_rng().integers(1000, 10**9))
    for seed in range(first, first + 50):
        pair = drawn_pair(seed)
        assert [*rate(*pair).to_dict().values()] == pytest.approx(rated_by_package(*pair), abs=1e-9), seed


def test_equal_curves_are_rated_one_and_the_total_is_weighted():
    curve = pulse()
    assert set(rate(curve, curve).to_dict().values()) == {1.0}
    rating = rate(curve, 0.8 * np.roll(curve, 9))
    parts = [rating.Z, rating.EP, rating.EM, rating.ES]
    assert rating.R == pytest.approx(np.dot(WEIGHTS, parts)) and all(0.0 < part < 1.0 for part in parts)


def test_the_unit_of_the_curves_does_not_matter():
    first, second = drawn_pair(0)
    for factor in (1e-3, 250.0):
        wanted = [*rate(first, second).to_dict().values()]
        assert [*rate(factor * first, factor * second).to_dict().values()] == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("away", [0.0, 0.04, 0.1, 0.3, 0.49, 0.6])
def test_the_corridor_is_quadratic_between_its_two_half_widths(away):
    curve = pulse()
    wanted = 1.0 if away < 0.05 else max((0.5 - away) / 0.45, 0.0) ** 2
    assert rate(curve, curve + away * curve.max()).Z == pytest.approx(wanted)


@pytest.mark.parametrize("shift", [-80, -60, -30, -1, 0, 1, 17, 59])
def test_the_phase_is_linear_in_the_shift_up_to_a_fifth_of_the_length(shift):
    # waves of many lengths, so that no other shift correlates as well
    long = np.cumsum(np.random.default_rng(5).standard_normal(600))
    reference, compared = long[150:450], long[150 - shift : 450 - shift]
    if abs(shift) < 60:
        assert best_shift(reference, compared) == shift
        rating = rate(reference, compared)
        assert rating.EP == pytest.approx(1.0 - abs(shift) / 60.0)
        assert rating.EM == rating.ES == 1.0
    else:
        assert abs(best_shift(reference, compared)) <= 60


@pytest.mark.parametrize("factor", [0.3, 0.8, 1.0, 1.4, 3.5])
def test_the_slope_of_a_scaled_curve_is_off_by_its_factor(factor):
    curve = pulse()
    assert rate(curve, factor * curve).ES == pytest.approx(max(1.0 - abs(factor - 1.0) / 2.0, 0.0))


def test_slopes_are_averaged_over_nine_samples_or_as_many_as_there_are():
    curve = np.random.default_rng(3).standard_normal(40)
    slope = np.gradient(curve)
    wanted = [slope[at - half : at + half + 1].mean() for at in range(40) for half in [min(at, 39 - at, 4)]]
    assert averaged_slope(curve) == pytest.approx(wanted)


@pytest.mark.parametrize("seed", range(5))
def test_the_warping_path_has_the_least_sum_of_all_paths_in_the_window(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(20, 45))
    reference, compared = rng.standard_normal((2, n))
    wide = int(np.ceil(0.1 * n)) - 1
    least = np.full((n + 1, n + 1), np.inf)
    least[0, 0] = 0.0
    for i in range(n):
        for j in range(max(0, i - wide), min(n, i + wide + 1)):
            before = min(least[i, j + 1], least[i + 1, j], least[i, j])
            least[i + 1, j + 1] = before + (reference[i] - compared[j]) ** 2
    first, second = warped(reference, compared)
    assert ((reference[first] - compared[second]) ** 2).sum() == pytest.approx(least[n, n])
    steps = np.stack([np.diff(first), np.diff(second)])
    assert (first[0], second[0], first[-1], second[-1]) == (0, 0, n - 1, n - 1)
    assert steps.min() >= 0 and steps.max() == 1 and (steps.sum(axis=0) > 0).all()
    assert np.abs(first - second).max() <= wide


@pytest.mark.parametrize(
    "code, reference, compared",
    [
        ("inconsistent", np.arange(30.0), np.arange(31.0)),
        ("inconsistent", np.arange(19.0), np.arange(19.0)),
        ("inconsistent", np.ones(30), np.arange(30.0)),
        ("malformed", np.arange(30.0), np.r_[np.arange(29.0), np.nan]),
    ],
)
def test_curves_that_cannot_be_rated_are_refused(code, reference, compared):
    with raises_code(code, "curve"):
        rate(reference, compared)


def test_a_curve_that_never_changes_is_rated_and_keeps_its_place():
    rating = rate(pulse(), np.full(300, 0.2))
    assert rating.EP == 1.0 and rating.ES == pytest.approx(0.5) and np.isfinite(rating.R)
