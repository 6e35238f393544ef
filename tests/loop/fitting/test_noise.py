"""Noise model, screening limits, lack of fit and the checks of the raw residual, on made residuals."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.inference.noise import Noise
from dummydesign.loop.fitting.fit import fit, fit_base, start_vector
from dummydesign.loop.fitting.noise import NoiseSizes, contrasts, estimate_slow_noise, repeat_pairs, repeat_scatter
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import SLAB_ERROR
from dummydesign.loop.selection.cross_validation import errors, jackknife, lack_of_fit
from dummydesign.loop.selection.residuals import dependences, run_checks
from dummydesign.loop.selection.verdict import GAIN_FLOOR, gain_threshold


@pytest.fixture(scope="module")
def base(plain):
    presses, law = plain
    return fit_base(presses, law, 0.03)


def test_bins_keep_the_mean_of_the_samples(plain):
    presses, _ = plain
    for press, trial in zip(presses.presses, presses.trials):
        covered = (trial.trace.time_s >= press.start_s[0]) & (trial.trace.time_s < press.end_s[-1])
        assert press.samples.sum() <= covered.sum() + 1
        assert np.all(np.diff(press.start_s) > 0) and np.all(press.end_s > press.start_s)


def test_a_constant_force_passes_filter_and_bins_unchanged(plain):
    presses, _ = plain
    ones = presses.measure(np.ones_like(presses.time_s))
    np.testing.assert_allclose(ones[presses.used], 1.0, atol=1e-9)


def test_repeats_are_paired_within_their_condition(plain):
    presses, _ = plain
    pairs = repeat_pairs(presses)
    assert len(pairs) == 18
    for a, b in pairs:
        one, two = presses.trials[a], presses.trials[b]
        assert (one.thickness_mm, one.velocity_mm_s, one.target_force_N) == (
            two.thickness_mm,
            two.velocity_mm_s,
            two.target_force_N,
        )


def test_repeats_are_compared_bin_by_bin_of_one_label_and_only_where_both_were_sampled():
    """A bin before contact that one of two repeats lacks is no partner of the other's."""
    label = np.r_[0, 1, 2, 100 + np.arange(12), 200, 300]
    used = np.ones((2, len(label)), bool)
    used[1, 0] = used[0, 7] = False
    edges = SimpleNamespace(start_s=np.arange(17.0), end_s=np.arange(1.0, 18.0))
    made = SimpleNamespace(
        cell=np.zeros(2),
        history=SimpleNamespace(repeat=np.arange(2)),
        label=np.stack([label] * 2),
        used=used,
        presses=(edges, edges),
        samples=np.ones((2, 17)),
    )
    [(_, _, a, b)] = contrasts(made, np.zeros((2, 17)))[1]
    np.testing.assert_array_equal(a, [*range(1, 7), *range(8, 16)])
    np.testing.assert_array_equal(a, b)


@pytest.mark.slow
def test_slow_noise_is_recovered_and_does_not_see_what_changes_with_force(base):
    """Size and time scatter by 3.8 % and 12 % from draw to draw (of 24): 3.5 such errors, the mean within 3."""
    presses = base.problem.presses
    rng = np.random.default_rng(5)
    truth = Noise(0.03, 0.025, 1.0, 0.0)
    factor = np.linalg.cholesky(presses.bins.covariance(truth, np.zeros_like(base.slope)))
    start = NoiseSizes.first(presses, SLAB_ERROR).noise
    found = []
    for _ in range(8):
        made = np.einsum("tij,tj->ti", factor, rng.normal(size=presses.used.shape)) * presses.used
        gains = 1.0 + rng.normal(0, 0.03, len(made))[:, None]
        shifts = rng.normal(0, 0.02, len(made))[:, None]
        disturbed = made + (gains - 1.0) * base.forces + shifts * base.slope + 0.3 * np.sin(presses.label / 40.0)
        noise = estimate_slow_noise(presses, disturbed * presses.used, base.slope, base.forces, start)
        found.append(np.log([noise.slow_N / truth.slow_N, noise.slow_time_s / truth.slow_time_s]))
    scatter = np.array([0.038, 0.12])
    assert np.all(np.abs(found) < 3.5 * scatter)
    assert np.all(np.abs(np.mean(found, axis=0)) < 3.0 * scatter / np.sqrt(len(found)))


def test_the_fit_recovers_the_parameters_that_made_the_forces(plain):
    presses, law = plain
    problem = CampaignProblem(presses, law)
    truth = start_vector(problem, 0.04)
    truth[:5] += [0.0, 0.2, -0.3, 0.3, 0.2]
    made = replace(presses, force_N=problem.predict(truth))
    found = fit(CampaignProblem(made, law), start_vector(problem, 0.03), NoiseSizes.first(presses, SLAB_ERROR))
    np.testing.assert_allclose(found.vector[:5], truth[:5], atol=2e-3)
    assert np.abs(found.residual[presses.used]).max() < 2e-3


def test_lack_of_fit_is_quiet_for_noise_and_speaks_for_a_shared_misfit(base):
    quiet = lack_of_fit(base)
    assert 0.6 < quiet.ratio < 1.4
    misfit = 0.15 * np.exp(-np.maximum(base.problem.presses.label - 200, 0) / 5.0)
    shared = replace(base, residual=base.residual + misfit)
    loud = lack_of_fit(shared)
    assert loud.ratio > 2.0 and loud.p < 0.01


def disturbed(base, change):
    """The fit with something added to the raw force of every trial."""
    presses = base.problem.presses
    trials = []
    for row, trial in enumerate(presses.trials):
        force = trial.trace.force_N + change(row, trial.trace.time_s, presses.stop_s[row])
        trials.append(replace(trial, trace=replace(trial.trace, force_N=force)))
    problem = replace(base.problem, presses=replace(presses, trials=tuple(trials)))
    return replace(base, problem=problem)


def exceeded(found):
    return {check.name for check in run_checks(found) if check.exceeded}


def test_clean_residuals_pass_all_checks(base):
    assert exceeded(base) == set()


def test_hum_is_seen_as_a_line_and_before_contact(base):
    found = disturbed(base, lambda row, t, stop: 0.08 * np.sin(2 * np.pi * 50.0 * t + row))
    assert exceeded(found) == {"spectral line", "noise before contact"}
    line = next(check for check in run_checks(found) if check.name == "spectral line")
    assert "50" in line.text.split("Hz")[0]


def test_a_drop_in_one_hold_is_seen_as_a_step(base):
    found = disturbed(base, lambda row, t, stop: -0.3 * (t > stop + 4.0) * (row == 11))
    assert exceeded(found) == {"step in the hold"}
    step = next(check for check in run_checks(found) if check.name == "step in the hold")
    assert base.problem.presses.trials[11].file in step.text
    assert float(step.text.split(", ")[1].split(" s ")[0]) == pytest.approx(4.0, abs=0.2)


def test_a_residual_that_follows_the_logarithm_of_time_in_the_hold_is_put_to_the_time_since_the_stop(base):
    presses = base.problem.presses
    since = 0.5 * (presses.bins.start + presses.bins.end) - presses.stop_s[:, None]
    wave = 0.03 * base.forces * np.cos(np.log(np.maximum(since, 1e-3))) * (since > 0.0)
    first, second = dependences(replace(base, residual=np.where(presses.used, wave, 0.0)))[:2]
    assert first.factor == "time since stop" and first.share > 0.75
    assert second.excess < 0.8 * first.excess


def test_leaving_conditions_out_of_a_fit_that_misses_nothing_gives_about_its_own_variances(base):
    """Of the relaxation; that of the modulus counts what pads differ by, which their conditions share."""
    ratio = np.diag(jackknife(base))[1:5] / np.diag(base.covariance)[1:5]
    assert np.all(ratio > 0.2) and np.all(ratio < 5.0)


def test_left_out_errors_are_not_smaller_than_fitted_ones_and_near_the_noise(base):
    found = errors(base)
    assert found.train_N <= found.heldout_N < 1.3 * found.train_N


def test_the_threshold_has_a_floor_and_grows_with_lack_of_fit():
    assert gain_threshold([], None) == GAIN_FLOOR
    from dummydesign.loop.fitting.candidates import Screened

    rng = np.random.default_rng(1)
    made = []
    for _ in range(20):
        vector = rng.normal(size=50)
        made.append(Screened(None, 0.0, 0.0, vector / np.linalg.norm(vector), np.ones(1)))
    assert gain_threshold(made, None) == GAIN_FLOOR
    assert gain_threshold(made, None, floor=0.0) == pytest.approx(16.5, abs=3.0)
    assert gain_threshold(made, 2.0) == 2.0 * GAIN_FLOOR


@pytest.mark.parametrize("of", ["nothing", "age_days", "temperature_C", "earlier_depth_mm"])
def test_a_gain_that_follows_the_history_of_a_pad_is_no_scatter(base, of):
    """Gains of 1 % drawn, or following the logarithm of the age, the temperature or the presses before."""
    presses, rng = base.problem.presses, np.random.default_rng(4711)
    count, shown = len(presses.trials), []
    for _ in range(12):
        ages, warm = rng.choice([7.0, 9.0, 14.0, 29.0], count), rng.uniform(18.0, 28.0, count)
        history = replace(presses.history, age_days=ages, temperature_C=warm)
        before = 1.0 / (1.0 + np.count_nonzero(history.earlier_depth_mm > 0.0, axis=1))
        laws = {"age_days": np.log(ages), "temperature_C": warm, "earlier_depth_mm": before}
        gain = laws.get(of, rng.normal(size=count))
        gain = 0.01 * (gain - gain.mean()) / gain.std() + 2e-4 * rng.normal(size=count)
        drawn = replace(presses, history=history)
        shown.append(repeat_scatter(drawn, gain[:, None] * base.forces, base.slope, base.forces, base.sizes.noise)[1])
    if of == "nothing":
        assert 0.006 < np.median(shown) < 0.015 and min(shown) > 0.003
    else:
        assert max(shown) < 0.002
