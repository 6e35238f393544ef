"""Bins of a trace and the operator that bins a model: the same facts for each of the three users."""

import numpy as np
import pytest

from dummydesign.inference.noise import HOLD_GROWTH, cut, hold_edges, interpolation, mean_around, repeatable_hold_edges
from tests.inference.users import DEPTH_MM, SPEED_MM_S, USERS, motion, reduced

STOP_S = 0.1 + DEPTH_MM / SPEED_MM_S


@pytest.mark.parametrize("user", USERS)
def test_a_force_linear_in_time_is_binned_by_the_operator_as_by_its_samples(user):
    found = reduced(user, lambda time, x: 3.0 * time)
    modelled = found.average @ (3.0 * found.nodes_s)
    # the puck's force is counted from its mean before contact
    assert np.ptp(modelled - found.force_N) < 1e-9
    whole = 0.0 if user == "puck" else 1.0
    assert found.average.sum(axis=1) == pytest.approx(np.full(len(found.samples), whole), abs=1e-12)


@pytest.mark.parametrize("user", USERS)
def test_an_elastic_force_follows_the_motion_of_the_nodes(user):
    found = reduced(user, lambda time, x: np.maximum(x, 0.0))
    modelled = found.average @ np.maximum(found.displacement_mm, 0.0)
    assert np.max(np.abs(modelled - found.force_N)) < 2e-3 * DEPTH_MM


@pytest.mark.parametrize("user", USERS)
def test_a_relaxing_force_is_binned_to_a_thousandth_of_its_fall(user):
    def force(time):
        return np.exp(-np.maximum(time - STOP_S, 0.0) / 2.0)

    found = reduced(user, lambda time, x: force(time))
    held = found.start_s >= STOP_S
    modelled = found.average @ force(found.nodes_s)
    assert np.max(np.abs(np.diff((modelled - found.force_N)[held]))) < 4e-3


@pytest.mark.parametrize("user", USERS)
def test_bins_follow_each_other_and_every_sample_of_rise_and_hold_is_in_one(user):
    found = reduced(user, lambda time, x: 0.0 * time)
    time, _ = motion()
    assert np.all(found.start_s[1:] >= found.end_s[:-1] - 1e-12) and np.all(found.samples >= 1)
    covered = (time >= found.start_s[0]) & (time <= found.end_s[-1] + 1e-9)
    assert found.samples.sum() == covered.sum()
    assert found.end_s[-1] == pytest.approx(time[-1], abs=0.01)


@pytest.mark.parametrize("user", USERS)
def test_bins_of_a_hold_grow_by_about_a_third(user):
    found = reduced(user, lambda time, x: 0.0 * time)
    late = found.start_s > STOP_S + 0.1
    ratio = (found.end_s[late] - STOP_S) / (found.start_s[late] - STOP_S)
    assert np.all(ratio[:-1] < 1.02 * HOLD_GROWTH) and np.all(ratio[:-1] > 1.2)


def test_means_of_bins_are_those_of_their_samples():
    rng = np.random.default_rng(0)
    time = np.sort(rng.uniform(0.0, 1.0, 200))
    values = rng.normal(size=200)
    binning = cut(time, np.array([0.1, 0.4, 0.41, 0.9, 1.0]), np.array([False, False, True, False]))
    for place, (start, end) in enumerate(zip(binning.start_s, binning.end_s)):
        own = values[(time >= start) & (time < end)]
        assert binning.mean(values)[place] == pytest.approx(own.mean())
    assert 2 not in binning.interval


def test_smooth_averages_are_exact_for_a_cubic_between_far_nodes():
    time = np.linspace(0.0, 10.0, 5001)
    nodes = np.r_[np.linspace(0.0, 1.0, 11), np.geomspace(1.5, 10.0, 6)]
    binning = cut(time, np.array([0.0, 1.0, 4.0, 10.0]))
    cubic = time**3 - 4.0 * time**2
    smooth = binning.average(time, nodes, (1.0, np.inf)) @ (nodes**3 - 4.0 * nodes**2)
    assert smooth[1:] == pytest.approx(binning.mean(cubic)[1:], rel=1e-9)
    linear = binning.average(time, nodes) @ (nodes**3 - 4.0 * nodes**2)
    assert abs(linear[2] - binning.mean(cubic)[2]) > 1.0


def test_a_node_beside_the_last_does_not_carry_its_jitter_over_the_interval_before():
    nodes = np.r_[np.linspace(0.0, 4.0, 11), 4.01]
    _, weight = interpolation(np.linspace(0.5, 4.0, 501), nodes, (0.0, np.inf))
    assert np.abs(weight).sum(axis=1).max() < 1.7, "the Lebesgue number of a cubic on four equal intervals is 1.63"


def test_edges_of_a_hold_end_with_it_or_are_those_of_every_repeat():
    edges = hold_edges(1e-3, 7.3)
    assert edges[[0, -1]] == pytest.approx([1e-3, 7.3]) and np.all(edges[1:] / edges[:-1] <= 1.02 * HOLD_GROWTH)
    short, long = repeatable_hold_edges(1e-3, 5.0), repeatable_hold_edges(1e-3, 7.3)
    assert np.array_equal(short, long[: len(short)]) and len(long) > len(short)


def test_means_around_nodes_keep_the_integral():
    rng = np.random.default_rng(1)
    time = np.linspace(0.0, 2.0, 81)
    values = np.cumsum(rng.normal(size=81))
    nodes = np.unique(np.r_[0.0, rng.uniform(0.0, 2.0, 9), 2.0])
    half = np.r_[nodes[0], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1]]
    whole = np.trapezoid(values, time)
    assert mean_around(nodes, time, values) @ np.diff(half) == pytest.approx(whole)
