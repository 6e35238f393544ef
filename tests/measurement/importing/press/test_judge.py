"""A press is explained as a whole, or the recording is told to be none; presses by other code (machine_presses)."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.importing.decisions import ImportLog, Settings
from dummydesign.measurement.importing.judge import find_delay, judge_press
from dummydesign.measurement.importing.read import import_files
from dummydesign.measurement.importing.times import read_between_changes
from dummydesign.measurement.ramp_detection import summarise
from tests.support.machine_presses import recording

SLOW = {"velocity_mm_s": 10.0, "hold_s": 5.0, "filtered": False}


def judged(time, x, force):
    summary = summarise("a.csv", time, x, force)
    return judge_press(time, x, force, summary, 0.0, find_delay(time, x, force, summary)[0])


def read(tmp_path, time, x, force, **settings):
    file = tmp_path / "press.csv"
    rows = np.stack([time, x, force], axis=1)
    np.savetxt(file, rows, "%.6f", ",", header="time_s,displacement_mm,force_N", comments="")
    found = import_files([file], Settings(**settings))[0][0]
    return found.presses[0], {one["code"] for one in found.warnings}


@pytest.mark.parametrize("seed", range(300, 316))
def test_tissue_pads_and_balls_are_explained_whatever_they_are_made_of(seed):
    record = recording(seed)
    assert judged(record.time_s, record.displacement_mm, record.force_N).explains


@pytest.mark.parametrize("seed", range(370, 382))
def test_a_low_crown_whose_slab_is_touched_in_the_press_is_explained(seed):
    """Beside the crown the slab begins to carry at once: a force whose slope has a kink, on one arm or two."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 8.0, 1e-3)
    depth, speed = rng.uniform(3.0, 7.0), rng.uniform(5.0, 15.0)
    x = np.clip((time - 0.5) * speed - 1.5, -1.5, depth)
    crown, beside = rng.uniform(0.3, 0.7) * depth, rng.uniform(2.0, 5.0)
    elastic = np.clip(x, 0.0, None) ** 1.5 / crown**0.5 + beside * np.clip(x - crown, 0.0, None)
    force = elastic.copy()
    for tau_s, strength in zip(rng.uniform((0.02, 0.5), (0.2, 3.0)), (0.5, rng.choice([0.0, 0.3]))):
        held = linear_recurrence(np.full(len(time), np.exp(-1e-3 / tau_s)), np.diff(elastic, prepend=0.0))
        force += strength * held
    assert judged(time, x, force + rng.normal(0.0, 0.02, len(time))).explains


@pytest.mark.slow
def test_five_elements_whose_dampers_are_quick_are_explained():
    """The published law by small steps of its own, with times at depth of 3 to 30 ms and 0.1 to 1 s."""
    rng, time, explained = np.random.default_rng(406), np.arange(0.0, 8.0, 1e-3), []
    for _ in range(16):
        depth, speed = rng.uniform(2.0, 5.0), rng.uniform(8.0, 25.0)
        x = np.clip((time - 0.5) * speed - 1.5, -1.5, depth)
        force = np.clip(x, 0.0, None) ** 3
        for tau_s, strength in zip(np.exp(rng.uniform(np.log((0.003, 0.1)), np.log((0.03, 1.0)))), (3.0, 1.0)):
            stretch, arm = 0.0, np.zeros(len(time))
            share = np.clip(x, 0.0, None) / depth
            for at in range(1, len(time)):
                rate = 1e-3 / tau_s * (0.5 * (share[at] + share[at - 1])) ** 2
                stretch = stretch * np.exp(-rate) + (share[at] - share[at - 1]) * np.exp(-0.5 * rate) * depth
                arm[at] = strength * np.clip(x[at], 0.0, None) ** 2 * stretch
            force += arm
        force *= 7.0 / force[-1]
        explained.append(judged(time, x, force + rng.normal(0.0, 0.015, len(time))).explains)
    assert sum(explained) >= 15


def test_a_force_that_comes_late_is_told_with_its_delay(tmp_path):
    """A delay that is named is right; one that is not is told as a contact in doubt."""
    named = 0
    for seed, late_s in zip(range(320, 328), (0.03, -0.03, 0.05, -0.05, 0.04, -0.04, 0.03, -0.05)):
        record = recording(seed, **SLOW)
        time, x = record.time_s, record.displacement_mm
        press, codes = read(tmp_path, time, x + 50.0, np.interp(time - late_s, time, record.force_N), contact="auto")
        found = press.judged
        assert codes - {"force_drifts", "hold_too_short"}
        if found.delay_s:
            named += 1
            assert found.delay_s == pytest.approx(late_s, abs=0.006) and "force_delayed" in codes
            assert found.to_dict()["by"] == f"--delay {found.delay_s:.3g}" and not found.explains
    assert named >= 4


def test_a_force_that_jumps_while_nothing_moves_is_not_explained():
    record = recording(330, **SLOW)
    time, force = record.time_s, record.force_N.copy()
    stop = summarise("a.csv", time, record.displacement_mm, force).stop_time_s
    force[time > stop + 1.0] *= 1.2
    found = judged(time, record.displacement_mm, force)
    assert not found.explains and found.where == "in the hold" and found.misfit > 6.0


@pytest.mark.parametrize("seed", range(340, 346))
@pytest.mark.parametrize("kind", ["digits", "held"])
def test_a_position_in_steps_is_read_where_it_changes(seed, kind, tmp_path):
    record = recording(seed, **SLOW, unload=False)
    time, x = record.time_s, record.displacement_mm
    if kind == "digits":
        x = np.round(x / 0.05) * 0.05
    else:
        x = np.interp(np.floor(time / 0.02) * 0.02, time, x)
    press, _ = read(tmp_path, time, x, record.force_N)
    whole, _ = read(tmp_path, time, record.displacement_mm, record.force_N)
    assert press.summary.depth_mm == pytest.approx(whole.summary.depth_mm, abs=0.05)
    assert press.summary.steady_force_N == pytest.approx(whole.summary.steady_force_N, rel=0.01)
    assert press.summary.velocity_mm_s == pytest.approx(10.0, rel=0.1)
    assert press.summary.hold_s == pytest.approx(5.0, abs=0.06) and press.judged.explains


def test_a_recording_that_stands_still_in_the_rise_is_told(tmp_path):
    """Both columns repeat and then jump: the rise looks many times as fast as it was."""
    told, rng = 0, np.random.default_rng(78)
    for seed in range(740, 752):
        record = recording(seed, **SLOW)
        time, x, force = record.time_s, record.displacement_mm.copy(), record.force_N.copy()
        found = summarise("a.csv", time, x, force)
        rise = found.depth_mm / 10.0
        first = int(np.searchsorted(time, found.stop_time_s - rng.uniform(0.4, 0.7) * rise))
        count = max(int(rng.uniform(0.1, 0.3) * rise / (time[1] - time[0])), 6)
        x[first : first + count], force[first : first + count] = x[first], force[first]
        told += "drop_out" in read(tmp_path, time, x, force)[1]
    assert told >= 10


@pytest.mark.parametrize("rows", [7, 40])
def test_stamps_that_come_in_packets_are_spread_evenly(rows, tmp_path):
    record = recording(350, **SLOW)
    time = record.time_s
    arrival = time[np.minimum((np.arange(len(time)) // rows + 1) * rows - 1, len(time) - 1)]
    stamps = arrival + 2e-5 * (np.arange(len(time)) % rows)
    press, _ = read(tmp_path, stamps, record.displacement_mm, record.force_N)
    assert press.summary.velocity_mm_s == pytest.approx(10.0, rel=0.01)
    assert press.summary.hold_s == pytest.approx(5.0, rel=0.02)


def test_a_recording_that_becomes_slower_has_no_packets(tmp_path):
    record = recording(351, **SLOW, unload=False)
    time = record.time_s
    stop = summarise("a.csv", time, record.displacement_mm, record.force_N).stop_time_s
    kept = (time < stop + 0.5) | (np.arange(len(time)) % 250 == 0)
    columns = (values[kept] for values in (time, record.displacement_mm, record.force_N))
    press, _ = read(tmp_path, *columns)
    assert press.summary.velocity_mm_s == pytest.approx(10.0, rel=0.01)
    assert press.summary.hold_s == pytest.approx(5.0, rel=0.11)


def test_a_position_computed_from_the_force_and_a_zero_at_a_touch_are_told(tmp_path):
    record = recording(360, **SLOW)
    _, codes = read(tmp_path, record.time_s, record.true_force_N / 5.0, record.true_force_N)
    assert "proportional" in codes
    touched = record.displacement_mm > 0.3
    begin = int(np.argmax(touched))
    _, codes = read(
        tmp_path, *(one[begin:] for one in (record.time_s, record.displacement_mm - 0.3, record.force_N)), tare="none"
    )
    assert "no_free_travel" in codes


def test_a_position_that_moves_with_each_sample_or_hardly_in_steps_is_left_as_it_is():
    record, log = recording(370, **SLOW), ImportLog("a.csv", Settings())
    for x in (record.displacement_mm, np.round(record.displacement_mm / 0.002) * 0.002):
        read, step_mm = read_between_changes(record.time_s, x, log)
        assert read is x and step_mm == 0.0
    assert log.decisions == []


def test_a_position_of_few_digits_is_told_where_every_sample_changes_too():
    """At 100 Hz it changes by several digits each sample until it brakes; it is known to half of one."""
    time = np.arange(0.0, 6.0, 0.01)
    x = np.round((1.53 - 4.53 * np.exp(-6.0 * np.maximum(time - 1.0, 0.0))) / 0.05) * 0.05
    log = ImportLog("a.csv", Settings())
    read, step_mm = read_between_changes(time, x, log)
    assert read is x and step_mm == pytest.approx(0.05, rel=1e-3)
    assert [warning["code"] for warning in log.warnings] == ["coarse_position"]


def test_an_even_path_has_no_digits():
    """Written to a micrometre, 10 mm/s at 20 Hz: 0.5 mm a sample are the speed, not the last digit."""
    time = np.arange(0.0, 8.0, 0.05)
    x = np.round(np.interp(time, [0.0, 1.0, 1.6, 6.0, 6.6], [-1.0, -1.0, 5.0, 5.0, -1.0]), 3)
    log = ImportLog("a.csv", Settings())
    read, step_mm = read_between_changes(time, x, log)
    assert read is x and step_mm == 0.0 and log.warnings == []


@pytest.mark.parametrize("seed, late_s", [(390, 0.02), (392, -0.02), (394, -0.03), (396, 0.025)])
def test_a_delay_is_named_although_the_force_is_nearly_explained_without_it(seed, late_s):
    """No part is missed by six times its error, but all of them by much less with the delay."""
    record = recording(seed, **SLOW)
    time, x = record.time_s, record.displacement_mm
    assert judged(time, x, record.force_N).explains
    found = judged(time, x, np.interp(time - late_s, time, record.force_N))
    assert not found.explains and found.delay_s == pytest.approx(late_s, abs=0.006)


@pytest.mark.parametrize("seed, late_s", [(400, 0.03), (402, -0.03), (404, 0.05), (406, -0.05)])
def test_the_interval_of_the_contact_holds_it_although_the_force_is_late(seed, late_s, tmp_path):
    record = recording(seed, **SLOW)
    time, x = record.time_s, record.displacement_mm
    press, _ = read(tmp_path, time, x + 50.0, np.interp(time - late_s, time, record.force_N))
    assert press.contact_low_mm <= 50.0 - press.zero_mm <= press.contact_high_mm
    # a third of what the punch goes in the delay
    assert abs(press.zero_mm - 50.0) < abs(10.0 * late_s) / 3.0


def test_an_early_force_of_a_punch_that_rings_is_found_among_the_delays_that_look_like_it():
    """Periods of 31 ms: what a delay explains has a nearest best one each period."""
    time = np.arange(0.0, 8.0, 1e-3)
    way = np.clip(time - 1.0, 0.0, None)
    since = np.clip(time - 1.5, 0.0, None)
    x = np.minimum(10.0 * way, 5.0) - 1.0 + 0.15 * np.exp(-30.0 * since) * np.sin(200.0 * since)
    force = 2.0 * np.clip(x, 0.0, None) ** 1.5 + np.random.default_rng(411).normal(0.0, 0.01, len(time))
    for late_s in (-0.04, 0.0, 0.026):
        late = np.interp(time - late_s, time, force)
        delay_s, low_s, high_s = find_delay(time, x, late, summarise("a.csv", time, x, late))
        assert delay_s == pytest.approx(late_s, abs=0.002) and low_s <= late_s <= high_s


@pytest.mark.parametrize("rate_Hz", [5.0, 8.0])
def test_a_position_of_few_changes_widens_the_contact_by_its_step(rate_Hz, tmp_path):
    """With two or three readings in the rise nothing can be read between them."""
    record = recording(410, velocity_mm_s=20.0, hold_s=5.0, filtered=False, unload=False)
    time = record.time_s
    x = np.interp(np.floor(time * rate_Hz) / rate_Hz, time, record.displacement_mm)
    press, codes = read(tmp_path, time, x, record.force_N, flip=frozenset())
    assert "coarse_position" in codes and press.contact_low_mm <= -press.zero_mm <= press.contact_high_mm
    assert press.contact_high_mm - press.contact_low_mm > 20.0 / rate_Hz


def test_a_foam_that_gives_way_is_explained():
    """F = 30 (1 - exp(-x / 1.2)): no power of the depth."""
    time = np.arange(0.0, 30.0, 0.05)
    x = np.interp(time, [0.0, 2.0, 12.0], [-0.5, -0.5, 4.5])
    noise = np.random.default_rng(420).normal(0.0, 0.01, len(time))
    assert judged(time, x, 30.0 * -np.expm1(-np.maximum(x, 0.0) / 1.2) + noise).explains


@pytest.mark.parametrize("seed", range(430, 434))
def test_digits_that_a_subtracted_drift_hides_are_no_fault(seed, tmp_path):
    record = recording(seed, **SLOW)
    time, force = record.time_s, record.force_N
    drifting = np.round(force + 0.08 * time, 1)
    _, codes = read(tmp_path, time, record.displacement_mm, drifting)
    assert not codes & {"not_explained", "clipped", "force_delayed"}
