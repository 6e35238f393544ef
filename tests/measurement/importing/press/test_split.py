"""A recording is parted into presses where the punch is out, and nowhere else."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import lfilter

from dummydesign.measurement.importing.read import import_files
from dummydesign.measurement.importing.sign_convention import find_presses
from dummydesign.measurement.ramp_detection import ramp_of
from dummydesign.measurement.trace import Trace, check_one_press
from tests.support.machine_presses import recording
from tests.support.parted_press import parts_of


@pytest.mark.parametrize("presses", [1, 2, 3])
@pytest.mark.parametrize("seed", range(6))
def test_presses_are_parted_where_the_punch_is_out_and_hold_all_samples(seed, presses):
    record = recording(seed, presses)
    _, spans, _ = parts_of(record)
    assert len(spans) == presses
    assert spans[0].start == 0 and spans[-1].stop == len(record.time_s)
    assert all(a.stop == b.start for a, b in pairwise(spans))
    cuts = [span.start for span in spans[1:]]
    assert np.all(record.displacement_mm[cuts] < 0) and np.all(np.abs(record.true_force_N[cuts]) < 1e-6)


def test_a_lost_signal_within_a_hold_parts_nothing():
    record = recording(3, velocity_mm_s=10.0)
    force = record.force_N.copy()
    middle = int(np.argmax(force)) + 300
    force[middle : middle + 20] = 0.0
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 1


def test_presses_are_parted_although_the_zero_of_the_force_drifts():
    record = recording(4, presses=3, velocity_mm_s=10.0)
    drift = 0.08 * record.force_N.max() * record.time_s / record.time_s[-1]
    assert len(find_presses("a.csv", record.displacement_mm, record.force_N + drift, True)) == 3


def test_presses_on_a_surface_that_pulls_are_parted():
    record = recording(4, presses=2, velocity_mm_s=10.0)
    leaving = np.r_[np.diff(record.displacement_mm) < -0.005, False] & (record.displacement_mm > -0.5)
    force = np.where(leaving & (record.force_N < 1.0), -1.5, record.force_N)
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 2


def test_a_jolt_of_the_robot_in_the_air_is_no_press():
    record = recording(5, velocity_mm_s=10.0)
    force = record.force_N.copy()
    start = int(np.argmax(np.diff(record.displacement_mm) > 0.01))
    force[start : start + 8] += 0.15 * force.max()
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 1


def test_presses_of_two_days_are_parted_at_the_pause(tmp_path):
    """The next press does not begin with the last samples of the day before."""
    from datetime import datetime, timedelta

    t = np.arange(0.0, 8.0, 0.01)
    x = np.clip(np.where(t < 5.0, 10.0 * (t - 1.0), 3.0 - 10.0 * (t - 5.0)), -5.0, 3.0)
    force = 2.0 * np.maximum(x, 0.0) ** 1.3 + 0.002 * np.sin(91.0 * t)
    lines = ["Zeit;Weg [mm];Kraft [N]"]
    for start in (datetime(2026, 2, 27, 23, 59, 57), datetime(2026, 3, 2, 9)):
        stamps = [(start + timedelta(seconds=float(at))).strftime("%Y-%m-%d %H:%M:%S.%f") for at in t]
        lines += [f"{stamp};{a:.4f};{b:.4f}" for stamp, a, b in zip(stamps, x, force)]
    (tmp_path / "two.csv").write_text("\n".join(lines) + "\n")
    first, second = import_files([tmp_path / "two.csv"])[0][0].presses
    assert len(first.time_s) == len(second.time_s) == len(t)
    assert first.time_s == pytest.approx(t, abs=1e-5) and second.time_s == pytest.approx(t, abs=1e-5)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("what", ["drift", "spikes"])
def test_a_drifting_zero_or_short_spikes_make_no_further_presses(seed, what):
    rng = np.random.default_rng([seed, 90])
    time = np.arange(0.0, 20.0, 0.002)
    x = np.interp(time, [0.0, 1.9, 2.2, 12.2, 12.6, 20.0], [-1.0, 0.0, 2.0, 2.0, -1.0, -1.0])
    force = rng.uniform(3.0, 15.0) * (np.clip(x, 0.0, None) / 2.0) ** 1.5 + rng.normal(0.0, 0.03, len(time))
    if what == "drift":
        force += 0.07 * time
    for at in rng.integers(0, len(time) - 4, 3) if what == "spikes" else ():
        force[at : at + 4] += 0.5 * force.max()
    assert len(find_presses("a.csv", x, force, True, time)) == 1


def cycled(seed):
    """Two to six cycles that end pressed, then a ramp and a hold: time, position, force, depth, hold, steady force."""
    draw = np.random.default_rng([seed, 78])
    depth, speed, back, hold = draw.uniform((2.0, 4.0, 0.12, 3.0), (8.0, 40.0, 0.42, 10.0))
    cycles, gap, power = int(draw.integers(2, 7)), 2.0, draw.uniform(1.0, 3.0)
    places = [-gap, -gap, *(0.95 * depth, back * depth) * cycles, depth]
    lasts = np.r_[1.0, np.abs(np.diff(places[1:])) / speed, hold]
    corners = np.r_[0.0, np.cumsum(lasts)]
    fine = np.arange(0.0, corners[-1], 1e-3)
    elastic = np.maximum(np.interp(fine, corners, [*places, depth]), 0.0) ** power
    kept = np.exp(-1e-3 / 1.5)
    force = elastic + 0.6 * lfilter([np.sqrt(kept)], [1.0, -kept], np.diff(elastic, prepend=0.0))
    force = 15.0 * np.where(elastic > 0.0, np.maximum(force, 0.0), 0.0) / force.max()
    steady = float(force[fine > corners[-1] - 0.05 * hold].mean())
    time = fine[::4]
    measured = force[::4] + draw.normal(0.0, 0.01, len(time))
    return time, np.interp(time, corners, [*places, depth]), measured, depth, hold, steady


@pytest.mark.parametrize("seed", range(6))
def test_of_cycles_that_end_pressed_the_last_ramp_and_its_hold_are_read(seed, tmp_path):
    time, x, force, depth, hold, steady = cycled(seed)
    rows = np.stack([time, x, force], axis=1)
    head = "time_s,displacement_mm,force_N"
    np.savetxt(tmp_path / "a.csv", rows, "%.5f", ",", header=head, comments="")
    (found,) = import_files([tmp_path / "a.csv"])[0]
    (press,) = found.presses
    assert press.summary.depth_mm == pytest.approx(depth, rel=0.01) and press.judged.explains
    assert press.summary.hold_s == pytest.approx(hold, abs=0.1)
    assert press.summary.steady_force_N == pytest.approx(steady, rel=0.01)
    trace = Trace("a", press.time_s, press.displacement_mm, press.force_N)
    check_one_press(trace)
    assert ramp_of(trace).hold_end_s - ramp_of(trace).stop_time_s == pytest.approx(hold, abs=0.1)
