"""Both rules for the stop and the search for holds agree where a motion is clean, and differ where they should."""

import numpy as np
import pytest

from dummydesign.measurement.landmarks import find_holds, find_ramp
from tests.support.refusal import raises_code


def ramp(creep_mm=0.0):
    time = np.arange(0.0, 6.0, 1e-3)
    x = np.clip(10.0 * (time - 0.2), -2.0, 5.0)
    held = time > 0.7
    x[held] += creep_mm * (1.0 - np.exp(-(time[held] - 0.7) / 0.3))
    return time, x


@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_a_clean_ramp_has_the_same_landmarks_by_either_rule(stop):
    found = find_ramp(*ramp(), stop)
    assert found.contact_time_s == pytest.approx(0.2, abs=1e-6)
    assert found.stop_time_s == pytest.approx(0.7, abs=5e-3)
    assert found.hold_end_s == pytest.approx(5.999)
    assert (found.depth_mm, found.velocity_mm_s) == pytest.approx((5.0, 10.0), rel=0.01)


def test_creep_after_the_stop_moves_the_reached_depth_but_not_the_slowing():
    time, x = ramp(0.08)
    assert find_ramp(time, x, "slowed").stop_time_s == pytest.approx(0.7, abs=0.01)
    assert find_ramp(time, x, "reached").stop_time_s > 0.75


def test_the_hold_of_a_ramp_is_the_one_hold_that_is_found():
    time, x = ramp()
    (hold,) = find_holds(time, x)
    assert (hold.start_s, hold.end_s, hold.displacement_mm) == pytest.approx((0.7, 5.999, 5.0), abs=2e-3)


@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_what_is_no_press_is_refused_by_either_rule(stop):
    time = np.arange(0.0, 1.0, 0.01)
    with raises_code("nothing_found", "displacement_mm"):
        find_ramp(time, -1.0 - time, stop)
    with raises_code("not_enough_data", "displacement_mm"):
        find_ramp(time, np.full(100, 3.0), stop)
