"""The motions: kinematics of the braked ramp, and what is read back from a measured one."""

import numpy as np
import pytest

from dummydesign.measurement.motion import contact_velocity, ramp_and_hold
from dummydesign.measurement.ramp_detection import find_ramp
from tests.support.refusal import raises_code


def test_the_ramp_ends_exactly_at_the_depth_and_stays_there():
    motion = ramp_and_hold(250.0, 6.0, hold_s=10.0)
    assert motion.displacement_mm[0] == 0 and motion.time_s[0] == 0
    assert motion.displacement_mm.max() == 6.0 and np.all(motion.displacement_mm[-60:] == 6.0)
    stop = 5 / 250 - 0.5 * 250 / 30000 + 1 / 250 + 250 / 30000
    assert stop == pytest.approx(6 / 250 + 0.5 * 250 / 30000)
    assert motion.time_s[-1] == pytest.approx(stop + 10.0)


def test_braking_takes_the_stated_deceleration_from_the_commanded_speed():
    motion = ramp_and_hold(250.0, 6.0, deceleration_mm_s2=20_000.0, ramp_points=400, brake_points=400)
    speed = np.diff(motion.displacement_mm) / np.diff(motion.time_s)
    middle = 0.5 * (motion.time_s[1:] + motion.time_s[:-1])
    assert np.allclose(speed[:400], 250.0)
    braking = slice(401, 799)
    slope = np.diff(speed[braking]) / np.diff(middle[braking])
    assert np.allclose(slope, -20_000.0, rtol=1e-6)
    distance = 250.0**2 / (2 * 20_000.0)
    assert motion.displacement_mm[400] == pytest.approx(6.0 - distance)


def test_a_stop_longer_than_the_depth_means_touching_while_braking():
    depth, braking = 1.0, 10_000.0
    motion = ramp_and_hold(250.0, depth, deceleration_mm_s2=braking, brake_points=500)
    touch = np.sqrt(2 * braking * depth)
    assert contact_velocity(250.0, depth, braking) == pytest.approx(touch) and touch < 250
    x = np.interp(0.4 * touch / braking, motion.time_s, motion.displacement_mm)
    assert x == pytest.approx(depth * (1 - 0.6**2), rel=1e-4)


def test_an_infinite_deceleration_is_the_ideal_ramp():
    motion = ramp_and_hold(10.0, 3.0, deceleration_mm_s2=np.inf)
    rising = motion.displacement_mm < 3.0 - 1e-6
    assert np.allclose(motion.displacement_mm[rising], 10.0 * motion.time_s[rising], rtol=1e-7)


def test_many_motions_at_once_are_the_same_as_one_by_one():
    speeds, depths = np.array([[10.0], [250.0]]), np.array([0.5, 2.0, 8.0])
    many = ramp_and_hold(speeds, depths)
    assert many.time_s.shape == many.displacement_mm.shape == (2, 3, many.time_s.shape[-1])
    one = ramp_and_hold(250.0, 0.5)
    assert np.array_equal(many.time_s[1, 0], one.time_s)
    assert np.all(np.diff(many.time_s, axis=-1) > 0)


@pytest.mark.parametrize("speed, depth", [(10.0, 7.0), (250.0, 7.0), (250.0, 1.5)])
def test_speed_depth_and_stop_are_found_in_a_quantised_noisy_motion(speed, depth):
    ideal = ramp_and_hold(speed, depth, hold_s=2.0)
    time = np.arange(-0.1, ideal.time_s[-1], 1e-3)
    x = np.where(time < 0, speed * time, np.interp(time, ideal.time_s, ideal.displacement_mm))
    x = x + 0.005 * np.sin(2 * np.pi * 0.7 * time) * (time > 0)
    x = np.round(x / 0.005) * 0.005
    back = np.arange(1, 200) * 4e-3
    time, x = np.r_[time, time[-1] + back], np.r_[x, depth - 10.0 * back]
    found = find_ramp(time, x)
    stop = depth / speed + 0.5 * speed / 30000
    assert found.depth_mm == pytest.approx(depth, abs=0.015)
    assert found.contact_time_s == pytest.approx(0.0, abs=0.006 / speed + 5e-4)
    assert found.stop_time_s == pytest.approx(stop, abs=0.03 / speed + 1.6e-3)
    assert found.hold_end_s == pytest.approx(stop + 2.0, abs=0.02)


@pytest.mark.parametrize(
    "make, code",
    [
        (lambda: ramp_and_hold(0.0, 1.0), "out_of_range"),
        (lambda: ramp_and_hold(10.0, [1.0, -1.0]), "out_of_range"),
        (lambda: ramp_and_hold(10.0, 1.0, hold_s=np.nan), "out_of_range"),
        (lambda: ramp_and_hold(10.0, 1.0, deceleration_mm_s2=0.0), "out_of_range"),
        (lambda: find_ramp(np.arange(5.0), -np.arange(5.0)), "nothing_found"),
        (lambda: find_ramp(np.arange(5.0), np.full(5, 2.0)), "not_enough_data"),
    ],
)
def test_impossible_motions_are_refused(make, code):
    with raises_code(code):
        make()
