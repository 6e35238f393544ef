"""Covariance of binned noise, restricted likelihood, its search; tissue fits and pucks (the loop: loop/fitting)."""

from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import block_diag, null_space

from dummydesign.inference.noise import (
    Bins,
    Noise,
    hold_edges,
    likeliest,
    noise_floor,
    restricted_likelihood,
    restricted_slope,
    white_noise,
    whitener,
)
from dummydesign.measurement.ramp_detection import Hold
from dummydesign.resin.puck_test.loading_fit import PuckNoise, covariance, estimate
from dummydesign.tissue.fitting.problem import LARGEST_POSITION_MM, estimate_noise


@dataclass(frozen=True)
class Press:
    start_s: np.ndarray
    end_s: np.ndarray
    samples: np.ndarray


def press(hold_s=20.0, rate_hz=1000.0):
    """Twenty bins of a rise of half a second and the growing ones of a hold."""
    edges = np.r_[np.linspace(0.0, 0.5, 21), 0.5 + hold_edges(2e-3, hold_s)]
    return Press(edges[:-1], edges[1:], np.maximum(np.diff(edges) * rate_hz, 1.0))


def test_slow_noise_of_bins_is_the_double_integral_of_its_correlation():
    edges = np.array([0.0, 0.3, 0.35, 1.6])
    bins = Bins([Press(edges[:-1], edges[1:], np.ones(3))])
    fine = [np.linspace(a, b, 2001)[:-1] + 0.5 * (b - a) / 2000 for a, b in pairwise(edges)]
    expected = [[np.exp(-np.abs(s[:, None] - t) / 0.4).mean() for t in fine] for s in fine]
    assert bins.slow(0.4)[0] == pytest.approx(np.array(expected), rel=1e-5)


def test_slow_noise_of_short_and_of_long_bins_has_its_limits():
    short = Bins([Press(np.array([0.0]), np.array([1e-6]), np.ones(1))]).slow(1.0)[0, 0, 0]
    long = Bins([Press(np.array([0.0]), np.array([1e4]), np.ones(1))]).slow(1.0)[0, 0, 0]
    assert short == pytest.approx(1.0, abs=1e-6) and long == pytest.approx(2e-4, rel=1e-3)


def test_whitening_makes_the_covariance_the_identity():
    bins = Bins([press(), press(5.0)])
    slope = bins.stacked(np.ones(int(bins.used.sum())))
    cover = bins.covariance(Noise(0.03, 0.02, 1.0, 0.01), slope)
    factor = whitener(cover)
    white = factor @ cover @ np.swapaxes(factor, 1, 2)
    assert white == pytest.approx(np.broadcast_to(np.eye(slope.shape[1]), cover.shape))


@pytest.mark.parametrize("shared", [True, False])
def test_refitted_restricted_likelihood_is_that_of_contrasts_free_of_the_parameters(shared):
    rng = np.random.default_rng(2)
    columns, residual = rng.normal(size=(2, 8, 2)), rng.normal(size=(2, 8))

    def contrasts(cover):
        groups = list(zip(columns, residual, cover))
        if shared:
            groups = [(np.concatenate(columns), residual.ravel(), block_diag(*cover))]
        total = 0.0
        for x, r, v in groups:
            free = null_space(x.T)
            own = free.T @ v @ free
            total += (free.T @ r) @ np.linalg.solve(own, free.T @ r) + np.linalg.slogdet(own)[1]
        return total

    apart = np.abs(np.subtract.outer(np.arange(8.0), np.arange(8.0)))
    one = np.stack([np.eye(8) + 0.5 * np.exp(-apart), 2.0 * np.eye(8)])
    two = np.stack([0.3 * np.eye(8), np.eye(8) + np.exp(-apart / 3.0)])
    gain = restricted_likelihood(one, residual, columns, shared, True)
    gain -= restricted_likelihood(two, residual, columns, shared, True)
    assert gain == pytest.approx(contrasts(one) - contrasts(two), abs=1e-6)


def test_without_a_refit_the_residual_counts_as_it_is():
    rng = np.random.default_rng(3)
    x = rng.normal(size=(1, 10, 2))
    cover = np.eye(10)[None]
    explained = (x[0] @ [1.0, -2.0])[None]
    kept = restricted_likelihood(cover, explained, x) - restricted_likelihood(cover, 0.0 * explained, x)
    taken = restricted_likelihood(cover, explained, x, refitted=True)
    assert kept == pytest.approx((explained**2).sum())
    assert taken == pytest.approx(restricted_likelihood(cover, 0.0 * explained, x), abs=1e-6)


def test_slopes_of_the_restricted_likelihood_are_its_finite_differences():
    rng = np.random.default_rng(11)
    bins = Bins([press(), press(5.0)])
    shape = bins.used.shape
    level, slope, residual = (np.where(bins.used, rng.normal(size=shape), 0.0) for _ in range(3))
    columns = np.where(bins.used[..., None], rng.normal(size=(*shape, 3)), 0.0)
    sizes = np.array([0.02, 0.05, 0.4, 0.03, 0.01])

    def value(sizes):
        noise = Noise(*sizes.tolist())
        cost, pull = restricted_slope(bins.covariance(noise, slope, level), residual, columns)
        assert cost == pytest.approx(restricted_likelihood(bins.covariance(noise, slope, level), residual, columns))
        return cost, np.array(list(bins.size_slopes(noise, slope, level, pull).values()))

    for at in range(5):
        step = 1e-4 * sizes[at] * np.eye(5)[at]
        by_differences = (value(sizes + step)[0] - value(sizes - step)[0]) / (2.0 * step[at])
        assert value(sizes)[1][at] == pytest.approx(by_differences, rel=1e-5)


@pytest.mark.parametrize(
    "centre, expected", [((0.02, 3.0), (0.02, 3.0)), ((1e-6, 3.0), (1e-3, 3.0)), ((9.0, 50.0), (1.0, 10.0))]
)
@pytest.mark.parametrize("start", [(1e-3, 1.0), (1.0, 10.0), (0.1, 0.5)])
def test_the_search_stays_in_its_bounds_and_finds_the_least_cost_inside(centre, expected, start):
    low, high = np.array([1e-3, 0.1]), np.array([1.0, 10.0])
    seen = []

    def cost(sizes):
        seen.append(sizes)
        return 40.0 * float((np.log(sizes / np.array(centre)) ** 2).sum())

    found, least = likeliest(cost, np.array(start), low, high)
    assert np.all(np.array(seen) >= low * (1 - 1e-12)) and np.all(np.array(seen) <= high * (1 + 1e-12))
    assert found == pytest.approx(np.array(expected), rel=2e-3)
    assert least == pytest.approx(cost(found))


def test_the_search_leaves_a_start_where_a_size_is_hardly_seen():
    """Twice the log likelihood of a variance s + t of 1 seen 100 times: flat in a small t, wherever it starts."""
    for start in (1e-4, 1e-2, 1.0):
        found, _ = likeliest(
            lambda z: 100.0 * float(np.log(1e-3 + z[0] ** 2) + 1.0 / (1e-3 + z[0] ** 2)),
            np.array([start]),
            np.array([1e-4]),
            np.array([10.0]),
        )
        assert found[0] == pytest.approx(np.sqrt(1.0 - 1e-3), rel=1e-2)


@pytest.mark.slow
def test_tissue_fits_find_white_and_slow_noise_and_no_misfit_where_none_is():
    """Means over draws: one draw of six presses knows the slow noise to 12 %, its time to a third."""
    presses = [press() for _ in range(6)]
    bins = Bins(presses)
    level = np.where(bins.used, 10.0, 0.0)
    slope = np.where(bins.used, 3.0, 0.0)
    columns = np.stack([np.where(bins.used, 1.0, 0.0), np.exp(-bins.start)], axis=-1) * bins.used[..., None]
    lower = np.linalg.cholesky(bins.covariance(Noise(0.03, 0.02, 0.5, 0.0), slope))
    rng = np.random.default_rng(4)
    found = []
    for _ in range(8):
        residual = (lower @ rng.normal(size=(*bins.used.shape, 1)))[..., 0] * bins.used
        found.append(estimate_noise(bins, level, slope, residual, columns, 0.2))
    assert np.mean([one.white_N for one in found]) == pytest.approx(0.03, rel=0.1)
    assert np.mean([one.slow_N for one in found]) == pytest.approx(0.02, rel=0.15)
    assert np.mean(np.log([one.slow_time_s for one in found])) == pytest.approx(np.log(0.5), abs=0.35)
    assert all(one.misfit_fraction == 0.0 and one.position_mm <= LARGEST_POSITION_MM for one in found)


def test_tissue_fits_put_what_exceeds_the_holds_noise_down_to_misfit():
    bins = Bins([press() for _ in range(6)])
    level = np.where(bins.used, 10.0, 0.0)
    residual = np.where(bins.used, 0.3 * np.sin(4.0 * np.arange(bins.used.shape[1])), 0.0)
    found = estimate_noise(bins, level, 0.0 * level, residual, level[..., None], 0.02)
    # 0.3 N of 10 N, a sine's rms, raised for neighbours that misfit alike
    assert found.misfit_fraction == pytest.approx(0.03 / np.sqrt(2.0) * np.sqrt(3.0), rel=0.15)
    assert found.slow_N <= 0.02 * (1 + 1e-9)


@pytest.mark.slow
def test_the_puck_test_finds_slow_noise_and_misfit():
    """Means over draws: a single puck tells its misfit, one smooth curve, to about a third."""
    one = press(60.0, 50.0)
    compression = np.minimum(one.end_s / 0.5, 1.0) * 9.0
    puck = SimpleNamespace(
        start_s=one.start_s,
        end_s=one.end_s,
        samples=one.samples,
        force_N=20.0 + 10.0 * compression,
        compression_mm=compression,
        white_N=0.02,
        holds=(Hold(0.5, 60.5, 9.0),),
    )
    truth = PuckNoise(0.02, 0.3, 6.0, 0.06)
    lower = np.linalg.cholesky(covariance([puck], 30.0, truth))
    rng = np.random.default_rng(5)
    columns = np.ones((len(one.samples), 1))
    found = [estimate([puck], 30.0, lower @ rng.normal(size=len(columns)), columns) for _ in range(24)]
    assert np.mean([one.slow_N for one in found]) == pytest.approx(0.3, rel=0.25)
    assert np.exp(np.mean(np.log([one.misfit for one in found]))) == pytest.approx(0.06, rel=0.3)


@pytest.mark.parametrize("robust", [False, True])
def test_white_noise_comes_from_second_differences_and_a_jump_moves_only_the_mean_square(robust):
    force = 5.0 + np.random.default_rng(6).normal(0.0, 0.03, 4000) + np.linspace(0.0, 1.0, 4000)
    assert white_noise(np.diff(force, 2), robust) == pytest.approx(0.03, rel=0.05)
    force[2000:] += 5.0
    assert bool(white_noise(np.diff(force, 2), robust) > 0.04) is (not robust)
    assert white_noise(np.zeros(0), robust) == 0.0


def test_the_noise_floor_of_a_relaxing_hold_is_its_noise():
    time = np.arange(1, 5001) * 2e-3
    noise = np.random.default_rng(7).normal(0.0, 0.05, len(time))
    force = 5.0 + np.exp(-time / 1.5) + 0.5 * np.exp(-time / 0.06)
    assert noise_floor([(time, force + noise)]) == pytest.approx(0.05, rel=0.05)
    assert noise_floor([(time[:15], force[:15])]) == 0.0
