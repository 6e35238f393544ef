"""Nodes and acceleration of one reduced trial, against a motion that is known."""

import numpy as np
import pytest

from dummydesign.loop.data.reduction import ReducedPress, reduce_press
from dummydesign.measurement.trace import Trace

SPEED_MM_S, DEPTH_MM, BRAKE_S, TOUCH_S, HOLD_S = 250.0, 5.0, 0.014, 0.1, 5.0
STOP_S = TOUCH_S + DEPTH_MM / SPEED_MM_S + 0.5 * BRAKE_S


def braked(time: np.ndarray) -> np.ndarray:
    """Displacement of a punch that is braked evenly to a stop. [mm]"""
    left = np.maximum(STOP_S - time, 0.0)
    late = DEPTH_MM - 0.5 * SPEED_MM_S / BRAKE_S * left**2
    return np.where(time < STOP_S - BRAKE_S, SPEED_MM_S * (time - TOUCH_S), late)


def reduced(force, resolution_mm: float = 0.0) -> ReducedPress:
    """A press sampled at 1 kHz around the stop and at 50 Hz in the hold."""
    time = np.r_[np.arange(0.0, 0.6, 1e-3), np.arange(0.61, STOP_S + HOLD_S, 0.02)]
    x = braked(time)
    if resolution_mm:
        x = resolution_mm * np.round(x / resolution_mm)
    return reduce_press(Trace("press.csv", time, x, force(time)), None)


def test_the_pulse_of_a_stop_takes_off_the_speed_and_is_as_short_as_the_brake():
    press = reduced(lambda time: np.maximum(braked(time), 0.0))
    time, pulse = press.time_s, -press.acceleration_mm_s2 / SPEED_MM_S
    assert np.trapezoid(pulse, time) == pytest.approx(1.0, abs=2e-3)
    middle = np.trapezoid(pulse * time, time)
    assert middle == pytest.approx(STOP_S - 0.5 * BRAKE_S, abs=5e-5)
    # an even pulse of length b has the variance b^2 / 12; straight lines between samples add a sixth of their step^2
    variance = np.trapezoid(pulse * (time - middle) ** 2, time)
    assert variance == pytest.approx(BRAKE_S**2 / 12.0, abs=0.3e-6)


def test_a_fast_rise_has_nodes_half_way_between_its_samples():
    time = reduced(lambda time: np.maximum(braked(time), 0.0)).time_s
    rise = time[(time > TOUCH_S) & (time < STOP_S)]
    np.testing.assert_allclose(np.diff(rise), 0.5e-3, atol=1e-5)


def test_a_coarse_position_does_not_change_the_speed_that_is_taken_off():
    press = reduced(lambda time: np.maximum(braked(time), 0.0), resolution_mm=0.005)
    near = np.abs(press.time_s - STOP_S) < 0.05
    taken_off = np.trapezoid(press.acceleration_mm_s2[near], press.time_s[near])
    assert taken_off == pytest.approx(-SPEED_MM_S, rel=0.01)


@pytest.mark.parametrize("early_s", [0.004, 0.008, 0.015])
def test_nodes_show_a_force_whose_clock_is_early(early_s):
    def force(time):
        return np.clip((time + early_s - TOUCH_S) / 0.02, 0.0, 1.0)

    press = reduced(force)
    at_nodes = np.interp(press.time_s + early_s, press.time_s, np.clip((press.time_s - TOUCH_S) / 0.02, 0.0, 1.0))
    modelled = press.operator @ at_nodes
    impulse = (modelled - press.force_N) @ press.samples * 1e-3
    # the force ends at one: an impulse is a time
    assert abs(impulse) < 5e-3 * early_s
