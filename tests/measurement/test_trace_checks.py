"""What looks wrong in traces that are fitted together."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.importing.press_checks import allowed_offset, copies_among, doubts_of, subjects_among
from dummydesign.measurement.trace import Trace
from tests.support.machine_presses import _slow, recording


def trace(seed=4, tare=0.0, place=0.0, scale=1.0, name="a.csv"):
    record = recording(seed, velocity_mm_s=10.0, hold_s=10.0, filtered=False)
    return Trace(name, record.time_s, record.displacement_mm + place, scale * record.force_N + tare)


def codes(found):
    return [warning["code"] for warning in found]


def test_a_tared_press_with_its_zero_at_contact_is_not_doubted():
    assert doubts_of(trace()) == []


def test_a_force_before_contact_is_told_with_the_command_that_mends_it():
    found = doubts_of(trace(tare=0.8))
    assert codes(found) == ["force_before_contact"]
    assert "0.799 N" in found[0]["message"] and "dummydesign import a.csv" in found[0]["message"]


def noisy(seed, white=0.02, slow=0.01, peak=3.0, tare=None):
    """A clean press of small force; zeroed on one reading of its sensor unless a tare is given."""
    record, draw = recording(seed), np.random.default_rng([seed, 9])
    force = record.true_force_N * peak / record.true_force_N.max()
    force = force + draw.normal(0.0, white, len(force)) + _slow(draw, record.time_s, slow)
    force = force + (draw.normal(0.0, white) if tare is None else tare)
    return Trace(f"{seed}.csv", record.time_s, record.displacement_mm, np.round(force, 3))


@pytest.mark.slow
@pytest.mark.parametrize(("white", "slow"), [(0.02, 0.01), (0.05, 0.05), (0.005, 0.01)])
def test_noise_and_the_zero_of_a_noisy_sensor_are_hardly_ever_a_fault_in_200_presses(white, slow):
    """A drift or a slope counts from 2.5 errors on: noise alone passes that in 1.2 % of presses for each."""
    found = [(seed, codes(doubts_of(noisy(seed, white, slow)))) for seed in range(200)]
    assert [one for one in found if "contact_off" in one[1]] == []
    assert sum("force_before_contact" in one[1] for one in found) <= 0.024 * len(found)


@pytest.mark.parametrize("seed", range(20, 36))
def test_a_small_zero_within_the_noise_is_no_fault_and_an_offset_beyond_it_is(seed):
    assert "force_before_contact" not in codes(doubts_of(noisy(seed, tare=-0.044)))
    found = doubts_of(noisy(seed, tare=-0.2))
    assert codes(found)[0] == "force_before_contact" and found[0]["message"].startswith(f"{seed}.csv")


def test_the_limit_counts_noise_force_and_the_step_of_the_sensor():
    assert allowed_offset(3.0, 0.02, 0.004) == pytest.approx(0.084)
    assert allowed_offset(15.0, 0.02, 0.004) == pytest.approx(0.15)
    assert allowed_offset(3.0, 0.0, 0.0, 0.1) == pytest.approx(0.1)
    assert "force_before_contact" in codes(doubts_of(trace(tare=0.8)))
    assert "force_before_contact" not in codes(doubts_of(trace(tare=0.8), resolution_N=1.0))


def test_a_force_before_contact_within_its_noise_is_not_told():
    assert doubts_of(trace(tare=0.005)) == []


def test_a_contact_that_lies_elsewhere_is_told_with_its_interval():
    found = doubts_of(trace(seed=6, place=0.6))
    assert codes(found) == ["contact_off"] and "95 %" in found[0]["message"]


def test_a_copy_under_another_name_is_told_and_a_repeat_is_not():
    assert codes(copies_among([trace(name="anna.csv"), trace(name="bert.csv")])) == ["same_press"]
    record = trace()
    force = record.force_N + np.r_[0.01, np.zeros(len(record.force_N) - 1)]
    again = Trace("c.csv", record.time_s, record.displacement_mm, force)
    assert copies_among([record, again]) == []


def row(file, depth, force, speed=10.0):
    forces = {"steady_force_N": force, "peak_force_N": 1.5 * force}
    return {"file": file, "depth_mm": depth, "velocity_mm_s": speed, **forces}


def test_two_subjects_in_one_fit_are_told():
    assert codes(subjects_among([row("a", 3.0, 5.0), row("b", 3.1, 9.0)])) == ["several_subjects"]
    # less force at a third more depth: a softer hand
    assert codes(subjects_among([row("a", 3.0, 5.0), row("b", 4.1, 4.5)])) == ["several_subjects"]


def test_depths_repeats_and_speeds_of_one_subject_are_not_taken_for_two():
    for power in (1.0, 1.5, 3.0):
        rows = [row(str(depth), depth, 0.5 * depth**power) for depth in (2.0, 2.5, 3.0, 4.0)]
        assert subjects_among([*rows, row("repeat", 3.0, 0.45 * 3.0**power)]) == []
    assert subjects_among([row("slow", 3.0, 5.0), row("fast", 3.0, 9.0, 250.0)]) == []
