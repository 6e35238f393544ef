"""What looks wrong in a press is told by its name; a good press gives no warning."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.importing.contact import find_contact
from dummydesign.measurement.importing.press_checks import check_press, doubts_of
from dummydesign.measurement.importing.sign_convention import find_presses
from dummydesign.measurement.ramp_detection import summarise
from dummydesign.measurement.trace import Trace


def checked(time, x, force):
    """Codes of what looks wrong in one press."""
    codes = []
    span = find_presses("a.csv", x, force, True)[0]
    contact = find_contact(time, x, force, span)
    summary = summarise("a.csv", time, x, force)
    check_press(time, x, force, contact, summary, lambda code, text: codes.append(code))
    return codes


@pytest.fixture
def press():
    """A slow ball press with a long hold, as arrays that a test may damage."""
    rng = np.random.default_rng(11)
    time = np.arange(0, 12.0, 0.004)
    x = np.clip(-1.0 + 5.0 * (time - 0.4), -1.0, 4.0)
    force = 2.0 * np.maximum(x, 0) ** 1.5 * np.where(time > 1.4, 0.8 + 0.2 * np.exp(-(time - 1.4) / 0.4), 1.0)
    return time, x + rng.normal(0, 0.0005, len(x)), force + rng.normal(0, 0.01, len(x))


def test_a_good_press_gives_no_warning(press):
    assert checked(*press) == []


def test_a_load_cell_at_its_end_is_told(press):
    time, x, force = press
    assert "clipped" in checked(time, x, np.minimum(force, 11.0))


def test_a_position_that_relaxes_while_the_force_stands_is_the_force(press):
    time, x, force = press
    assert checked(time, force, x) == ["columns_swapped"]
    # held force: the pad creeps, its depth grows to where the steady force is that of the ramp's end
    ramp = np.clip(time / 1.4, 0.0, 1.0)
    creep = ramp * np.where(time > 1.4, 1.25 - 0.25 * np.exp(-(time - 1.4) / 0.4), 1.0)
    assert "columns_swapped" not in checked(time, 4.0 * creep - 0.01, 16.0 * ramp**1.5)


def test_a_coarse_resolution_is_not_taken_for_a_load_cell_at_its_end(press):
    time, x, force = press
    assert checked(time, x, np.round(force, 1)) == []


def test_single_samples_far_off_are_told(press):
    time, x, force = press
    force[[900, 1500]] += 4.0
    assert checked(time, x, force) == ["spike"]


def test_a_force_that_is_lost_in_the_hold_is_told(press):
    time, x, force = press
    force[1000:1010] = 0.0
    assert checked(time, x, force) == ["not_explained"]


def test_missing_samples_in_the_rise_are_told_and_a_sparser_hold_is_not(press):
    time, x, force = press
    keep = np.r_[0:200, 240 : len(time)]
    assert "drop_out" in checked(time[keep], x[keep], force[keep])
    keep = np.r_[0:500, 500 : len(time) : 25]
    assert checked(time[keep], x[keep], force[keep]) == []


def test_a_short_hold_whose_force_still_falls_is_told(press):
    time, x, force = press
    keep = time < 2.4
    assert checked(time[keep], x[keep], force[keep]) == ["hold_too_short"]


def test_a_staircase_is_told(press):
    time, _, _ = press
    x = np.interp(time, [0, 0.4, 1.0, 4.0, 4.4, 8.0, 8.4, 12.0], [-1, -1, 2, 2, 3, 3, 4, 4])
    assert "several_holds" in checked(time, x, 2.0 * np.maximum(x, 0) ** 1.5)


def test_a_staircase_is_told_where_it_ends_without_standing(press):
    # four steps held for 150 s each; rises fewer samples apart than holds, and the last rise ends the test
    corners, time = [0.0], [np.zeros(1)]
    for step in (2.4, 6.0) * 5:
        time.append(corners[-1] + np.arange(step, (120.0 if step < 5 else 150.0) + 0.1, step))
        corners.append(float(time[-1][-1]))
    time = np.concatenate(time[:-1])
    x = np.interp(time, corners[:-1], [0, 0.26, 0.26, 0.52, 0.52, 0.78, 0.78, 1.04, 1.04, 1.27])
    assert "several_holds" in checked(time, x, 4.0 * np.maximum(x, 0))


@pytest.mark.parametrize("change", ["grams", "inches"])
def test_a_press_far_from_any_hand_or_pad_is_doubted(press, change):
    time, x, force = press
    x, force = (x, force / 9.80665e-3) if change == "grams" else (x / 25.4, force)
    assert "far_from_known" in checked(time, x, force)


def test_a_position_that_creeps_during_its_hold_is_no_staircase(press):
    """A drift of 6 % of the depth, quantised to 5 um, as position encoders record it; a step at speed is told."""
    time, _, _ = press
    creep = np.interp(time, [0, 0.4, 0.56, 4.0, 6.0, 12.0], [-1, -1, 0.54, 0.54, 0.505, 0.505])
    step = np.interp(time, [0, 0.4, 0.56, 4.0, 4.01, 12.0], [-1, -1, 0.54, 0.54, 0.44, 0.44])
    for way, told in ((creep, False), (step, True)):
        x = np.round(way / 0.005) * 0.005
        found = checked(time, x, 8.0 * np.maximum(x, 0))
        assert ("several_holds" in found) is told, found


def test_a_press_that_does_not_stand_is_named_at_import_alone(press):
    time, _, _ = press
    x = np.maximum(4.0 - np.abs(time - 6.0), -1.0)
    force = 2.0 * np.maximum(x, 0.0) ** 1.5
    assert checked(time, x, force) == ["no_hold"]
    assert "no_hold" not in {one["code"] for one in doubts_of(Trace("turn.csv", time, x, force))}
