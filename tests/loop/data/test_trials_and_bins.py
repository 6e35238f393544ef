"""Bins, history and conditions of trials, against what the docstrings say of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.data import reduction
from dummydesign.loop.data.reduction import HOLD, PRE, RISE, UNLOADING, _acceleration, _white, has_hold, reduce_press
from dummydesign.loop.data.trials import (
    KEPT,
    Presses,
    _cells,
    make_history,
    memoised_law,
    shows_tension,
    stack,
)
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.ramp_detection import Ramp, find_ramp
from dummydesign.measurement.trace import Trace
from tests.support import puck_presses as pucks

NOWHERE = Motion(np.zeros(0), np.zeros(0))


def motion(speed=5.0, depth=2.0, hold=3.0, back=10.0, step=0.83e-3, lead=0.2):
    """A press with even sampling that is no part of a millisecond, and its force in proportion to the depth."""
    time = np.arange(-lead, depth / speed + hold + (depth + 1.0) / back if back else depth / speed + hold, step)
    x = np.minimum(speed * time, depth)
    if back:
        x = np.where(time > depth / speed + hold, depth - back * (time - depth / speed - hold), x)
    return Trace("a.csv", time, x, np.maximum(3.0 * x, 0.0))


@pytest.mark.parametrize(("speed", "fast"), [(5.0, False), (30.0, False), (40.0, True), (200.0, True)])
def test_bins_are_as_many_as_the_docstring_says(speed, fast):
    """Three before contact; every millisecond of a rise below 60 ms or seventeen; twenty of the way back."""
    press = reduce_press(motion(speed), None)
    phase, place = np.divmod(press.label, 100)
    assert (phase == PRE).sum() == 3 and (phase == UNLOADING).sum() == 20
    # those before contact are thirds from the first sample to two milliseconds before it
    first, last = press.time_s[0], press.ramp.contact_time_s - 2e-3
    np.testing.assert_allclose(press.start_s[:3], first + (last - first) * np.arange(3) / 3.0, atol=1e-9)
    rise = phase == RISE
    length = press.end_s[rise] - press.start_s[rise]
    if fast:
        np.testing.assert_allclose(length[1:], 1e-3, rtol=1e-9)
        assert abs(length.sum() - (2.0 / speed + 2e-3)) < 1.5e-3
        # counted from the stop, so that repeats agree where they end
        assert place[rise][-1] == 1 and np.all(np.diff(place[rise]) <= -1)
    else:
        assert rise.sum() == 17
        np.testing.assert_allclose(length, (2.0 / speed + 2e-3) / 17.0, rtol=0.02)
    hold = phase == HOLD
    since = press.start_s[hold] - press.ramp.stop_time_s
    assert since[0] == pytest.approx(0.0, abs=1e-9)
    long = np.diff(since)[np.diff(since) > 4e-3]
    ratio = long[1:] / long[:-1]
    assert np.median(ratio) == pytest.approx(1.33, abs=0.01)
    assert np.all(press.samples >= 1) and np.all(press.end_s[:-1] <= press.start_s[1:] + 1e-9)
    assert press.end_s[hold][-1] < press.ramp.hold_end_s + 1e-6 < press.start_s[phase == UNLOADING][0]


def test_bins_of_a_press_hold_the_means_of_its_samples_and_its_nodes_a_straight_force():
    trace = motion(20.0)
    press = reduce_press(trace, None)
    for start, end, count, mean in zip(press.start_s, press.end_s, press.samples, press.force_N):
        inside = trace.force_N[(trace.time_s >= start) & (trace.time_s < end)]
        assert count == len(inside) and mean == pytest.approx(inside.mean(), abs=1e-9)
    # a force that is linear in time between the nodes is binned exactly
    time = press.time_s
    inside = [(trace.time_s >= a) & (trace.time_s < b) for a, b in zip(press.start_s, press.end_s)]
    np.testing.assert_allclose(press.operator.sum(axis=1), 1.0, atol=1e-9)
    np.testing.assert_allclose(press.operator @ time, [trace.time_s[at].mean() for at in inside], atol=1e-9)
    # nodes rise, begin and end with the trace, and the motion there is that of the trace
    assert np.all(np.diff(time) > 0.0) and (time[0], time[-1]) == (trace.time_s[0], trace.time_s[-1])
    np.testing.assert_allclose(press.displacement_mm, np.interp(time, trace.time_s, trace.displacement_mm), atol=0.02)
    for at in (press.ramp.contact_time_s, press.ramp.hold_end_s):
        assert np.abs(time - at).min() < 2e-3


def test_nodes_follow_a_slow_rise_closely_and_grow_in_the_hold():
    press = reduce_press(motion(2.0, hold=20.0), None)
    time, ramp = press.time_s, press.ramp
    near = time[(time > ramp.stop_time_s - 0.01) & (time < ramp.stop_time_s + 0.01)]
    assert np.diff(near).max() < 1.5e-3 and len(near) > 12
    held = time[(time > ramp.stop_time_s + 0.03) & (time < ramp.hold_end_s - 0.5)]
    steps = np.diff(held)[1:-1]
    assert np.all(np.diff(steps) > -1e-9) and steps.max() == pytest.approx(0.4) and steps.min() < 0.02
    growing = steps[(steps > 3e-3) & (steps < 0.39)]
    assert growing[1:] / growing[:-1] == pytest.approx(1.2, abs=0.01)
    away = time[time > ramp.hold_end_s]
    assert 20 <= len(away) <= 82 and len(time) < 290


@pytest.mark.parametrize("back_mm_s", [2.0, 20.0, 250.0])
def test_nodes_of_the_way_back_are_as_close_as_the_force_needs(back_mm_s):
    """A force of the third power of depth, linear between nodes, is off by little of its largest at every sample."""
    trace = motion(100.0, hold=5.0, back=back_mm_s)
    press = reduce_press(trace, None)
    away = trace.time_s >= press.ramp.hold_end_s
    force = np.maximum(trace.displacement_mm, 0.0) ** 3
    held = np.interp(trace.time_s, press.time_s, np.maximum(press.displacement_mm, 0.0) ** 3)
    assert np.abs(held - force)[away].max() < 0.03 * force.max()


@pytest.mark.parametrize("power", [0, 1, 2, 3, 4, 5])
def test_acceleration_is_exact_for_a_motion_up_to_the_fifth_power_of_time(power):
    time = 0.3 + 1.25e-3 * np.arange(60.0)
    x = (time - 0.33) ** power * 40.0**power
    wanted = power * (power - 1) * (time - 0.33) ** max(power - 2, 0) * 40.0**power
    found = _acceleration(time, x)
    np.testing.assert_allclose(found[3:-3], wanted[3:-3], atol=1e-6 * max(np.abs(wanted).max(), 1.0), rtol=1e-6)


def test_acceleration_is_read_at_400_hz_or_faster_only():
    for step, seen in ((2.4e-3, True), (2.6e-3, False)):
        time = step * np.arange(40.0)
        found = _acceleration(time, 500.0 * time**2)
        assert found[5:-5] == pytest.approx(1000.0 if seen else 0.0, rel=1e-6)
    # uneven samples by differences, also exact for a parabola in the middle of even parts
    time = np.cumsum(np.r_[np.full(20, 1e-3), np.full(20, 2e-3)])
    assert _acceleration(time, 500.0 * time**2)[[8, 30]] == pytest.approx(1000.0, rel=1e-6)
    assert _acceleration(np.arange(6.0) * 1e-3, 500.0 * (np.arange(6.0) * 1e-3) ** 2)[2:4] == pytest.approx(1000.0)


def test_white_noise_is_that_of_the_quiet_parts():
    """Before contact and from 0.1 s after the stop on; a swing at the stop and the way back are not counted."""
    chance = np.random.default_rng(3)
    trace = motion(20.0, hold=2.0)
    ramp = find_ramp(trace.time_s, trace.displacement_mm, "slowed")
    noise = 0.05 * chance.normal(size=len(trace.time_s))
    since = trace.time_s - ramp.stop_time_s
    swing = np.where((since > 0.0) & (since < 0.098), np.sin(900.0 * since), 0.0)
    late = np.where(trace.time_s > ramp.hold_end_s + 5e-3, 0.6 * chance.normal(size=len(noise)), 0.0)
    rise = np.where((since < 0.0) & (trace.time_s > 0.003), 0.4 * chance.normal(size=len(noise)), 0.0)
    found = _white(replace(trace, force_N=trace.force_N + noise + swing + late + rise), ramp)
    assert found == pytest.approx(0.05, rel=0.06)
    assert _white(replace(trace, force_N=5.0 + 0.0 * trace.force_N), ramp) == 1e-3
    # where the clock jumps the second difference of a rise is none of noise
    time = np.where(since > 1.0, trace.time_s + 0.3, trace.time_s)
    jumped = replace(trace, time_s=time, force_N=trace.force_N + noise)
    assert _white(jumped, replace(ramp, hold_end_s=ramp.hold_end_s + 0.3)) == pytest.approx(0.05, rel=0.06)


def test_a_press_without_a_hold_has_forty_bins_to_its_end():
    ramp = Ramp(0.2, 0.6, 0.6495, 2.0, 5.0, 0.0, 0.0, 0.0, NOWHERE)
    assert not has_hold(ramp) and has_hold(replace(ramp, hold_end_s=0.6505))
    time = np.arange(0.0, 0.9, 1e-3)
    edges, labels = reduction._bin_edges(time, ramp)
    assert len(edges) == 41 and labels.tolist() == [100 + n for n in range(40)]
    assert edges[0] == 0.2 and edges[-1] == pytest.approx(time[-1]) and edges[-1] > time[-1]
    np.testing.assert_allclose(np.diff(edges), (time[-1] - 0.2) / 40.0, rtol=1e-6)
    stopped = motion(5.0, 2.0, hold=0.02, back=0.0)
    press = reduce_press(stopped, None)
    assert len(press.label) <= 40 and set(press.label // 100) == {RISE}


def test_coarse_samples_leave_out_the_turn_of_the_motion():
    """Between coarse samples it is not known where the way back began."""
    for coarse in (0.83e-3, 0.03):
        fine = motion(20.0)
        kept = (fine.time_s < 1.0) | (np.arange(len(fine.time_s)) % round(coarse / 0.83e-3) == 0)
        trace = Trace("b.csv", fine.time_s[kept], fine.displacement_mm[kept], fine.force_N[kept])
        press = reduce_press(trace, None)
        end, phase = press.ramp.hold_end_s, press.label // 100
        before, after = end - press.end_s[phase == HOLD].max(), press.start_s[phase == UNLOADING].min() - end
        # a fiftieth of a second and a step either way
        assert 0.019 < before < 0.025 + coarse and 0.019 + 0.9 * coarse < after < 0.025 + 2.0 * coarse


def trial(sequence, thickness=8.0, rest=60.0, age=None, long_s=10.0, **more):
    trace = SimpleNamespace(time_s=np.array([5.0, 5.0 + long_s]))
    given = {"pad": ("", thickness), "repeat": 1, "temperature_C": None, "velocity_mm_s": 10.0, "target_force_N": None}
    return SimpleNamespace(sequence=sequence, rest_s=rest, age_days=age, trace=trace, **{**given, **more})


def test_the_history_of_a_pad_is_its_earlier_presses_and_the_time_since_each():
    """Time since is from the end of a press to the beginning of the next: rests, and the presses in between."""
    trials = (
        trial(3, rest=100.0),
        trial(1, rest=5.0, long_s=20.0),
        trial(2, rest=30.0, long_s=40.0),
        trial(4, 12.0, rest=9.0),
    )
    found = make_history(trials, np.array([3.0, 1.0, 2.0, 7.0]))
    inf = np.inf
    np.testing.assert_array_equal(found.earlier_depth_mm, [[0, 1, 2, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]])
    np.testing.assert_array_equal(
        found.elapsed_s, [[inf, 100 + 40 + 30, 100, inf], [inf] * 4, [inf, 30, inf, inf], [inf] * 4]
    )
    assert np.isnan(found.temperature_C).all() and found.sequence.tolist() == [3, 1, 2, 4]


def test_an_age_that_was_declared_counts_where_it_is_longer_and_a_rest_that_was_not_is_a_minute():
    trials = (trial(1, age=7.0), trial(2, rest=None, age=7.0), trial(3, rest=50.0, age=8.5))
    found = make_history(trials, np.ones(3))
    assert found.elapsed_s[1, 0] == 60.0
    assert found.elapsed_s[2, :2] == pytest.approx(1.5 * 86400.0)


def test_a_condition_is_a_pad_a_speed_and_a_force_or_a_depth_within_four_per_cent():
    rows = [trial(1), trial(2), trial(3), trial(4, velocity_mm_s=11.0), trial(5, 12.0), trial(6)]
    assert _cells(tuple(rows), np.array([2.0, 2.07, 2.09, 2.0, 2.0, 1.93])).tolist() == [0, 0, 1, 2, 3, 0]
    forces = [trial(n, target_force_N=f) for n, f in enumerate((5.0, 5.0, 5.01, 9.0))]
    assert _cells(tuple(forces), np.array([1.0, 9.0, 1.0, 1.0])).tolist() == [0, 0, 1, 2]


def test_the_values_of_a_law_are_remembered_and_are_those_of_the_law():
    asked = []

    def law(depth, thickness):
        asked.append(float(depth[0, 0]))
        return depth * thickness

    remembered, h = memoised_law(law), np.array([[2.0]])
    depths = [np.full((1, 3), float(n)) for n in range(KEPT)]
    for _ in range(2):
        for depth in depths:
            np.testing.assert_array_equal(remembered(depth, h), 2.0 * depth)
    assert asked == [float(n) for n in range(KEPT)]
    remembered(np.full((1, 3), 99.0), h)
    remembered(depths[-1], h)
    assert len(asked) == KEPT + 1
    remembered(depths[0], h)  # the oldest has made room
    assert len(asked) == KEPT + 2
    assert remembered(depths[0], np.array([[3.0]]))[0, 0] == 0.0 and len(asked) == KEPT + 3


def test_signals_are_binned_and_sampled_alike_by_one_operator():
    presses = pucks.planned()
    force = 20.0 * np.exp(-np.clip(presses.time_s - presses.stop_s[:, None], 0.0, None) / 0.15)
    both = presses.operator @ np.stack([force, 2.0 * force], axis=-1)
    np.testing.assert_allclose(both[..., 1], 2.0 * presses.measure(force))
    for row, (values, trial_) in enumerate(zip(presses.at_samples(force), presses.trials)):
        # what relaxes within the hold is followed between far nodes: linear ones are 45 mN off
        wanted = 20.0 * np.exp(-np.clip(trial_.trace.time_s - presses.stop_s[row], 0.0, None) / 0.15)
        np.testing.assert_allclose(values, wanted, atol=8e-3)
        one, time = presses.presses[row], trial_.trace.time_s
        means = [wanted[(time >= a) & (time < b)].mean() for a, b in zip(one.start_s, one.end_s)]
        np.testing.assert_allclose(presses.measure(force)[row, : len(means)], means, atol=8e-3)
    assert presses.unloads.all() and not presses.elastic_only
    assert presses.pads == (("", 8.0), ("", 12.0)) and presses.young_factor is None
    np.testing.assert_array_equal(presses.pad, (presses.thickness_mm > 10.0).astype(int))
    trace = presses.trials[0].trace
    kept = trace.time_s < presses.hold_end_s[0] - 0.01
    columns = (column[kept] for column in (trace.time_s, trace.displacement_mm, trace.force_N))
    held = replace(presses.trials[0], trace=Trace("c.csv", *columns))
    assert stack((held, presses.trials[1]), None).unloads.tolist() == [False, True]


def test_without_a_hold_speeds_must_differ_by_half_to_show_relaxation():
    ramp = Ramp(0.0, 0.4, 0.4, 2.0, 5.0, 0.0, 0.0, 0.0, NOWHERE)
    for fastest, elastic in ((7.4, True), (7.6, False)):
        made = SimpleNamespace(presses=[SimpleNamespace(ramp=ramp)] * 2, velocity_mm_s=np.array([5.0, fastest]))
        assert bool(Presses.elastic_only.fget(made)) is elastic
    holds = [SimpleNamespace(ramp=ramp), SimpleNamespace(ramp=replace(ramp, hold_end_s=2.0))]
    assert not Presses.elastic_only.fget(SimpleNamespace(presses=holds, velocity_mm_s=np.array([5.0, 5.0])))


@pytest.mark.parametrize(
    ("drift", "pull", "seen"), [(0.0, 0.0, False), (0.3, 0.0, False), (0.0, 0.2, True), (-0.3, 0.2, True)]
)
def test_tension_is_seen_below_the_zero_and_not_in_a_zero_that_drifts(drift, pull, seen):
    chance = np.random.default_rng(5)
    time = np.arange(0.0, 6.0, 0.004)
    force = np.where((time > 1.0) & (time < 4.5), 5.0, 0.0) - drift * (time > 4.6) * np.clip(time - 4.6, 0.0, 1.0)
    force = force - pull * ((time > 4.7) & (time < 4.9)) + 0.02 * chance.normal(size=len(time))
    assert shows_tension(time, force, 1.0, 4.4) is seen
    # a clock that began elsewhere, a bias of the cell and another scale see the same
    assert shows_tension(time + 9.0, 3.0 * (force + 0.7), 10.0, 13.4) is seen


def test_tension_is_so_many_standard_deviations_of_a_mean_of_five_or_none():
    time = np.arange(0.0, 5.0, 0.01)
    noise = 0.1 * (-1.0) ** np.arange(len(time)) * (time < 1.0)
    for depth, seen in ((-0.21, False), (-0.24, True)):
        # five standard deviations over root five of 0.1 are 0.224
        force = noise + depth * ((time > 3.5) & (time < 4.0)) + 2.0 * ((time > 1.0) & (time < 3.0))
        assert shows_tension(time, force, 1.0, 3.0) is seen
    assert not shows_tension(time[time < 3.03], force[time < 3.03], 1.0, 3.0)


@pytest.mark.parametrize(("lead", "bins"), [(0.3, 3), (0.02, 3), (0.004, 0), (0.0008, 0)])
def test_a_trace_that_begins_just_before_contact_has_no_bins_there(lead, bins):
    press = reduce_press(motion(20.0, lead=lead), None)
    assert (press.label // 100 == PRE).sum() == bins
    assert np.all(np.diff(press.start_s) > 0.0) and press.start_s[0] <= press.ramp.contact_time_s
    assert np.all(press.end_s[:-1] <= press.start_s[1:] + 1e-9)
