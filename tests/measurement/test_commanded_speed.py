"""The speed that was commanded lies in its interval, whatever is sampled; what is not sampled is not said."""

import numpy as np
import pytest

from dummydesign.measurement.commanded_speed import CommandedSpeed
from dummydesign.measurement.ramp_detection import find_ramp


def pressed(speed, braking, depth, rate, phase=0.0, above_mm=0.0, noise_mm=0.0, digits_mm=1e-4, seed=0):
    """A robot with a constant speed and braking that stops at 0 s: from a rest at contact, or seen from above."""
    brakes, way = speed / braking, depth + above_mm
    short = 0.5 * speed * brakes
    rise = np.sqrt(2.0 * way / braking) if way < short else brakes + (way - short) / speed
    time = np.arange(-rise - (20.0 - phase) / rate * (above_mm == 0.0), 3.0, 1.0 / rate)
    left = np.maximum(-time, 0.0)
    left = np.where(left < brakes, 0.5 * braking * left**2, speed * (left - 0.5 * brakes))
    x = depth - left if above_mm else np.maximum(depth - left, 0.0)
    x = x + noise_mm * np.random.default_rng(seed).standard_normal(len(x))
    return time, np.round(x / digits_mm) * digits_mm


def test_the_interval_holds_the_speed_of_drawn_presses_and_no_wrong_one_is_sure():
    """Speeds 50 to 300 mm/s, brakings 0.5 to 20 m/s2, 100 to 1000 Hz; some brake from contact on, or from above it."""
    draw, held, wrong = np.random.default_rng(5800), [], []
    for number in range(150):
        speed, braking = 50.0 * 6.0 ** draw.uniform(), 500.0 * 40.0 ** draw.uniform()
        depth, rate = draw.uniform(5.0, 20.0) * draw.uniform(0.1, 0.45), draw.choice([100.0, 250.0, 500.0, 1000.0])
        noise, digits = draw.choice([0.0, 0.001, 0.003]), draw.choice([1e-4, 1e-3, 5e-3])
        above = draw.choice([0.0, draw.uniform(2.0, 15.0)])
        time, x = pressed(speed, braking, depth, rate, draw.uniform(), above, noise, digits, number)
        ramp = find_ramp(time, x, "slowed")
        found = ramp.speed
        held.append(found.low_mm_s <= speed <= found.high_mm_s)
        wrong.append(found.sure and abs(found.value_mm_s / speed - 1.0) > 0.05)
    assert np.mean(held) >= 0.95 and np.mean(wrong) <= 0.01


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.5, 0.75])
def test_a_short_fast_ramp_at_250_hz_is_not_read_as_a_slower_one(phase):
    time, x = pressed(250.0, 20_000.0, 4.0, 250.0, phase)
    found = find_ramp(time, x, "slowed").speed
    assert isinstance(found, CommandedSpeed) and found.low_mm_s <= 250.0 <= found.high_mm_s
    assert found.value_mm_s > 0.94 * 250.0 or not found.sure


def test_speed_and_braking_of_a_ramp_with_many_samples_are_those_of_the_robot():
    time, x = pressed(100.0, 5_000.0, 6.0, 1000.0, 0.3)
    found = find_ramp(time, x, "slowed").speed
    assert found.sure and found.value_mm_s == pytest.approx(100.0, rel=0.01)
    assert found.braking_mm_s2 == pytest.approx(5_000.0, rel=0.02)


@pytest.mark.parametrize("rate", [250.0, 1000.0])
def test_a_press_that_brakes_from_contact_on_has_no_upper_speed(rate):
    time, x = pressed(250.0, 2_000.0, 4.0, rate, 0.3)
    found = find_ramp(time, x, "slowed").speed
    assert np.isinf(found.high_mm_s) and not found.sure and "or more" in found.words
    assert found.low_mm_s < np.sqrt(2.0 * 2_000.0 * 4.0) * 1.01


@pytest.mark.parametrize("seed", range(6))
def test_times_that_scatter_do_not_make_the_robot_faster(seed):
    time, x = pressed(20.0, 5_000.0, 5.0, 100.0, 0.3)
    late = time + 0.05 / 100.0 * np.random.default_rng(seed).standard_normal(len(time))
    found = find_ramp(late, x, "slowed").speed
    assert found.low_mm_s <= 20.0 <= found.high_mm_s and found.value_mm_s == pytest.approx(20.0, rel=0.1)
