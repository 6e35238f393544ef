"""The path of a robot from one pad to another body: the same speeds and braking, begun earlier or later."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.motion import COARSE_STEPS, RISE_STEPS, RobotPath

SPEED, HOLD, DEPTH = 50.0, 2.0, 5.0
TIME = np.r_[np.linspace(0.0, DEPTH / SPEED, 51), DEPTH / SPEED + np.linspace(0.0, HOLD, 401)[1:]]
STEADY = RobotPath(TIME, np.minimum(SPEED * TIME, DEPTH), DEPTH / SPEED, SPEED, SPEED, 1e4)
BRAKING = RobotPath(TIME, np.minimum(SPEED * TIME, DEPTH), DEPTH / SPEED, SPEED, 250.0, 1e4)
"""The second braked from 250 mm/s before it touched: over (250^2 - 50^2) / 2e4 = 3 mm and 20 ms."""


def test_its_depth_is_that_at_the_end_of_the_hold():
    assert STEADY.depth_mm == DEPTH


@pytest.mark.parametrize("deeper", [-4.0, -0.5, 0.0, 0.7, 3.0])
def test_a_robot_that_does_not_brake_touches_earlier_by_the_way_over_its_speed(deeper):
    assert STEADY.contact_s(np.array(deeper)) == pytest.approx(-deeper / SPEED, abs=1e-12)


@pytest.mark.parametrize("deeper", [0.3, 2.999, 3.0, 8.0])
def test_a_robot_that_brakes_came_at_the_speed_before(deeper):
    """Within the way of braking the root of v^2 + 2 a s; before it, 250 mm/s."""
    slow = min(deeper, 3.0)
    wanted = (np.sqrt(SPEED**2 + 2e4 * slow) - SPEED) / 1e4 + max(deeper - 3.0, 0.0) / 250.0
    assert -BRAKING.contact_s(np.array(deeper)) == pytest.approx(wanted, rel=1e-12)
    # where the robot was then is as far above the pad
    assert BRAKING.at(np.array(-wanted)) == pytest.approx(-deeper, rel=1e-9)


def test_its_place_is_the_path_after_contact_and_has_the_speed_of_both_sides_there():
    np.testing.assert_array_equal(BRAKING.at(TIME), BRAKING.x_mm)
    step = 1e-6
    assert -BRAKING.at(np.array(-step)) / step == pytest.approx(SPEED, rel=1e-3)
    far = BRAKING.at(np.array([-1.0, -1.0 - step]))
    assert (far[0] - far[1]) / step == pytest.approx(250.0, rel=1e-6)


@pytest.mark.parametrize("path", [STEADY, BRAKING], ids=["steady", "braking"])
@pytest.mark.parametrize("coarse", [False, True])
def test_motions_to_other_depths_begin_at_contact_and_end_there(path, coarse):
    depths = np.array([1.0, DEPTH, 9.0])
    motion = path.to(depths, coarse)
    assert np.all(motion.time_s[:, 0] == 0.0) and np.all(motion.displacement_mm[:, 0] == 0.0)
    np.testing.assert_allclose(motion.displacement_mm[:, -1], depths)
    assert np.all(np.diff(motion.time_s) > 0.0) and np.all(np.diff(motion.displacement_mm) > -1e-12)
    count = COARSE_STEPS if coarse else RISE_STEPS
    np.testing.assert_allclose(motion.displacement_mm[:, count], depths, rtol=1e-12)
    # the whole hold, or to the middle of its last twentieth
    np.testing.assert_allclose(motion.time_s[:, -1] - motion.time_s[:, count], (0.975 if coarse else 1.0) * HOLD)


def test_to_its_own_depth_it_is_the_path_itself():
    motion = STEADY.to(np.array([DEPTH]))
    np.testing.assert_allclose(motion.displacement_mm[0], np.interp(motion.time_s[0], TIME, STEADY.x_mm), atol=1e-12)


def test_deeper_bodies_are_hit_at_the_higher_speed_of_the_approach():
    motion = BRAKING.to(np.array([DEPTH, DEPTH + 6.0]))
    first = np.diff(motion.displacement_mm)[:, 0] / np.diff(motion.time_s)[:, 0]
    np.testing.assert_allclose(first, [SPEED, 250.0], rtol=1e-6)


def test_a_body_that_would_hardly_be_touched_still_has_a_rise():
    """Nothing touches later than just before the stop."""
    motion = STEADY.to(np.array([0.0]))
    assert motion.time_s[0, RISE_STEPS] == pytest.approx(0.001 * STEADY.stop_s)
