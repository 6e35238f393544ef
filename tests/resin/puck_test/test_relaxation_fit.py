"""Pucks with holds: holds are found, modulus and arms recovered from histories summed by other code, limits said.

``python -m benchmarks.accuracy.puck_hold`` counts over many draws, with friction by finite elements and a misfit of the
law.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from dummydesign.measurement.ramp_detection import find_holds
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.tables.puck import table_for
from dummydesign.resin.puck_test.loading_fit import REPEAT, PuckNoise, covariance, reduce_press
from dummydesign.resin.puck_test.plates import read_plates
from dummydesign.resin.puck_test.relaxation_fit import PuckProblem, _fastest_seen, fit_relaxation
from tests.support.puck_history import frictionless, ramps, relaxed

DIAMETER, HEIGHT, YOUNG_KPA, ALPHA = 40.0, 32.0, 30.0, 2.4
WINDOW = (0.03 * HEIGHT, 0.5 * HEIGHT)


def pressed(arms, levels=(0.12, 0.25), hold_s=80.0, seed=5, noise_N=0.01):
    """A press and its reduction."""
    time, x = ramps(levels, HEIGHT, 2.0, hold_s)
    force = relaxed(time, YOUNG_KPA * frictionless(x / HEIGHT, DIAMETER, ALPHA), arms)
    force += noise_N * np.random.default_rng(seed).normal(size=len(time))
    return reduce_press(time, x, force, find_holds(time, x), WINDOW)


def fitted(press):
    return fit_relaxation((press,), DIAMETER, HEIGHT, table_for(DIAMETER, HEIGHT))


@pytest.mark.parametrize("noise_mm", [0.0, 0.004])
def test_holds_are_found_where_they_are_and_unloading_is_none(noise_mm):
    time, x = ramps((0.1, 0.2, 0.3), 30.0, 1.0, 20.0)
    away = np.arange(1, 180) * 0.05
    time, x = np.r_[time, time[-1] + away], np.r_[x, np.maximum(x[-1] - away, 0.0)]
    x = x + noise_mm * np.random.default_rng(1).normal(size=len(x))
    found = find_holds(time, x)
    assert [hold.displacement_mm for hold in found] == pytest.approx([3.0, 6.0, 9.0], abs=0.01)
    assert [hold.start_s for hold in found] == pytest.approx([3.0, 26.0, 49.0], abs=0.15)
    assert [hold.end_s for hold in found] == pytest.approx([23.0, 46.0, 69.0], abs=0.15)


def test_a_loading_with_or_without_the_way_back_has_no_hold():
    time = np.arange(0.0, 120.0, 0.1)
    assert find_holds(time, time / 6.0) == ()
    assert find_holds(time, np.minimum(time, 120.0 - time) / 6.0) == ()


def test_a_hold_is_found_after_a_ramp_of_few_samples():
    time = np.arange(0.0, 30.0, 0.1)
    found = find_holds(time, np.minimum(time * 20.0, 6.0))
    assert len(found) == 1 and found[0].start_s == pytest.approx(0.3, abs=0.11) and found[0].end_s > 29.8


def test_the_model_of_the_bins_is_the_hereditary_integral():
    arms = ((0.7, 0.3), (9.0, 0.15))
    press = pressed(arms, noise_N=0.0)
    problem = PuckProblem((press,), DIAMETER, HEIGHT, table_for(DIAMETER, HEIGHT))
    truth = np.r_[np.log(YOUNG_KPA), ALPHA, 0.0, np.log([0.3, 0.15]), np.log([0.7, 9.0])]
    assert np.max(np.abs(problem.residual(truth, 0.0))) < 2e-3
    elastic = problem.elastic(ALPHA, 0.0, 0.0)
    own = elastic + sum(beta * problem.arm(elastic, tau) for tau, beta in arms)
    assert own == pytest.approx(relaxed_force(press.time_s, elastic, [PronyTerm(*arm) for arm in arms]), abs=1e-12)


@pytest.mark.slow
def test_modulus_and_arms_of_a_history_summed_elsewhere_come_back_within_their_intervals():
    arms = ((1.2, 0.3), (10.0, 0.15))
    found = fitted(pressed(arms))
    assert found.known.young_kPa.low <= YOUNG_KPA <= found.known.young_kPa.high
    # frictionless plates: a quantile over frictions from 0 on is not 0
    assert found.known.friction.low < 0.01
    assert len(found.arms) == 2
    for arm, (tau, beta) in zip(found.arms, arms):
        assert arm.reason == ""
        assert arm.tau_s.value == pytest.approx(tau, rel=0.08)
        assert arm.beta.value == pytest.approx(beta, rel=0.08)
    scores = [found.comparison[name]["aicc"] for name in "0123"]
    assert scores[2] < scores[1] < scores[0] and scores[2] < scores[3] + 6.0


@pytest.mark.slow
def test_a_puck_that_does_not_relax_has_no_arm():
    found = fitted(pressed((), levels=(0.25,)))
    assert found.arms == ()
    assert found.known.young_kPa.low <= YOUNG_KPA <= found.known.young_kPa.high


@pytest.mark.slow
def test_an_arm_slower_than_the_hold_has_no_value_and_the_modulus_reaches_down_to_its_end():
    found = fitted(pressed(((1.5, 0.2), (120.0, 0.2)), levels=(0.25,), hold_s=80.0))
    slow = [arm for arm in found.arms if arm.reason]
    assert slow and slow[0].slow and "longest hold" in slow[0].reason
    assert found.known.young_kPa.low <= YOUNG_KPA <= found.known.young_kPa.high
    assert found.seen_s[1] == pytest.approx(40.0, rel=0.01)


def test_misfit_of_the_law_is_the_same_all_through_a_hold_and_noise_falls_with_samples():
    press = pressed(((1.2, 0.3),), levels=(0.25,))
    late = np.nonzero(press.start_s > press.holds[0].start_s)[0]
    quiet = replace(press, white_N=0.0)
    matrix = covariance((quiet,), HEIGHT, PuckNoise(0.0, 0.0, 1.0, 0.03))[np.ix_(late, late)]
    assert matrix[0, 1:] == pytest.approx(0.03**2 + 0.0025**2, rel=1e-3)
    loud = replace(press, white_N=0.1)
    white = np.diag(covariance((loud,), HEIGHT, PuckNoise(0.1, 0.0, 1.0, 0.0)))
    expected = 0.01 / press.samples / press.force_N**2
    assert white - 0.0025**2 - 1e-8 == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_intervals_hold_the_truth_over_draws_with_friction_misfit_and_drift():
    """The whole study: python -m benchmarks.accuracy.puck_hold"""
    from benchmarks.accuracy.puck_hold import CASES, study

    got = study(20, 7, next(iter(CASES.values())))
    for name in ("young", "friction", "tau", "beta"):
        assert got[name].mean() > 0.85, name


FAST = ((0.02, 0.9), (0.3, 0.3))


def at_speed(velocity_mm_s, step_s, arms=FAST, noise_N=0.02, seed=3):
    """A press to 25 % with a hold of 4 s, stepped in time: each rise relaxes from the middle of its step on."""
    fine = 5
    end = 0.2 + 0.25 * HEIGHT / velocity_mm_s + 4.0
    time = np.arange(0.0, end, step_s / fine)
    x = np.clip((time - 0.2) * velocity_mm_s, -0.1, 0.25 * HEIGHT)
    elastic = YOUNG_KPA * frictionless(x / HEIGHT, DIAMETER, ALPHA)
    force, rise = elastic.copy(), np.diff(elastic, prepend=0.0)
    for tau, beta in arms:
        keep = np.exp(-step_s / fine / tau)
        force += beta * lfilter([np.sqrt(keep)], [1.0, -keep], rise)
    rows = slice(0, len(time), fine)
    noisy = force[rows] + noise_N * np.random.default_rng(seed).normal(size=len(time[rows]))
    return reduce_press(time[rows], x[rows], noisy, find_holds(time[rows], x[rows]), WINDOW)


def fastest_seen(velocity_mm_s, step_s, noise_N=0.02):
    """Shortest time that one press shows, with the true parameters."""
    problem = PuckProblem((at_speed(velocity_mm_s, step_s, (), noise_N),), DIAMETER, HEIGHT, SHAPE)
    truth = np.r_[np.log(YOUNG_KPA), ALPHA, 0.0]
    return _fastest_seen(problem, problem.fit([truth], 0.0))


SHAPE = table_for(DIAMETER, HEIGHT)


def test_a_slow_ramp_coarse_samples_and_noise_hide_fast_terms():
    slow, quick, quickest = (fastest_seen(v, 0.004) for v in (0.5, 10.0, 50.0))
    assert quickest < quick < 0.02 < slow
    assert fastest_seen(10.0, 0.1) > 0.1 and fastest_seen(10.0, 0.004, 1.0) > 2.0 * quick


def test_presses_of_one_puck_share_the_laws_misfit_and_have_noise_of_their_own():
    presses = (at_speed(10.0, 0.02), at_speed(40.0, 0.02))
    matrix = covariance(presses, HEIGHT, PuckNoise(0.0, 0.01, 1.0, 0.03))
    count = len(presses[0].samples)
    last = [np.argmax(press.start_s >= press.holds[0].start_s) + 3 for press in presses]
    across = matrix[last[0], count + last[1]]
    assert across == pytest.approx(0.03**2 + 0.0025**2, rel=1e-3)
    assert matrix[last[0], last[0] + 1] > across + 0.9 * REPEAT**2
    problem = PuckProblem(presses, DIAMETER, HEIGHT, SHAPE)
    truth = np.r_[np.log(YOUNG_KPA), ALPHA, 0.0, 0.0, np.log([0.9, 0.3]), np.log([0.02, 0.3])]
    assert np.max(np.abs(problem.residual(truth, 0.0))) < 0.02
    assert np.sqrt(np.mean(problem.residual(truth, 0.0) ** 2)) < 0.005


@pytest.mark.slow
def test_two_speeds_together_give_the_fast_arm_and_a_narrower_interval_than_one():
    presses = (at_speed(10.0, 0.001), at_speed(50.0, 0.001))
    plates = read_plates("0")
    both, one = (fit_relaxation(some, DIAMETER, HEIGHT, SHAPE, plates) for some in (presses, presses[:1]))
    for found in (both, one):
        assert found.known.young_kPa.low <= YOUNG_KPA <= found.known.young_kPa.high
        (fast, middle) = found.arms
        assert fast.beta.low <= 0.9 <= fast.beta.high and middle.beta.low <= 0.3 <= middle.beta.high
    widths = [np.log(found.arms[0].beta.high / found.arms[0].beta.low) for found in (both, one)]
    assert widths[0] < widths[1] < 0.3


@pytest.mark.parametrize("arms", [0, 1, 3])
def test_a_search_begins_near_the_modulus_where_least_squares_find_no_force_that_lasts(monkeypatch, arms):
    """As they do for too few arms under correlated noise: of batch 107 of seed 20261127 of ``batches_blind``."""
    problem = PuckProblem((pressed(((0.7, 0.3), (9.0, 0.15))),), DIAMETER, HEIGHT, table_for(DIAMETER, HEIGHT))
    monkeypatch.setattr("scipy.optimize.nnls", lambda columns, goal: (np.zeros(columns.shape[1]), 1.0))
    starts = problem.starts(arms, 0.0)
    assert len(starts) == 2 and all(len(one) == 3 + 2 * arms and np.isfinite(one).all() for one in starts)
    assert all(0.5 * YOUNG_KPA < np.exp(one[0]) < 2.0 * YOUNG_KPA for one in starts)
    assert len(set(starts[0][3 + arms :])) == arms


@pytest.mark.parametrize("grip", [0.0, 0.5])
def test_a_search_begins_on_both_sides_of_neo_hookean(grip):
    """Friction and contact can stand in for stiffening: fits ended in the farther of two valleys, at 80 for 83 kPa."""
    problem = PuckProblem((pressed(((0.7, 0.3), (9.0, 0.15))),), DIAMETER, HEIGHT, table_for(DIAMETER, HEIGHT))
    below, above = sorted(float(one[1]) for one in problem.starts(3, grip))
    assert below < 2.0 < above
