"""The plateau of made presses whose depth, end, ringing and creep are known."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.plateau import crossings, find_plateau, noise_of, slowing

STEP = 1e-3
TIME = np.arange(0.0, 6.0, STEP)
START = 200


def press(depth=5.0, speed=50.0, end=4.0, back=20.0):
    """From 0.2 s to a depth, held until ``end``, and back."""
    x = np.clip(speed * (TIME - STEP * START), -1.0, depth)
    return np.where(TIME > end, depth - back * (TIME - end), x)


@pytest.mark.parametrize("depth", [0.5, 5.0])
@pytest.mark.parametrize("speed", [10.0, 50.0])
def test_a_clean_press_stands_at_its_depth_from_its_stop_to_its_release(depth, speed):
    found = find_plateau(TIME, press(depth, speed), START, 0.0)
    assert found.held
    assert found.depth_mm == pytest.approx(depth, rel=1e-6)
    # a window of 0.05 mm at the speed, or of three samples
    assert found.slowed_s == pytest.approx(0.2 + depth / speed, abs=0.05 / speed + 4 * STEP)
    assert found.end_s == pytest.approx(4.0, abs=0.01)
    assert (found.overshoot_mm, found.settled_s) == (0.0, found.slowed_s)


def test_a_recording_that_ends_in_the_hold_has_its_plateau_to_the_end():
    found = find_plateau(TIME, press(end=9.0), START, 0.0)
    assert found.held and found.end_s == TIME[-1]


def test_noise_of_a_tenth_of_a_millimetre_moves_depth_by_a_hundredth():
    x = press() + 0.02 * np.random.default_rng(5).normal(size=len(TIME))
    found = find_plateau(TIME, x, START, noise_of(x))
    assert found.held and found.depth_mm == pytest.approx(5.0, abs=0.01) and found.overshoot_mm == 0.0
    assert found.end_s == pytest.approx(4.0, abs=0.05)


def ringing(over=0.4, period=0.1, decay=0.15):
    x, at = press(), TIME - 0.3
    return x + np.where((at > 0) & (TIME < 4.0), over * np.exp(-at / decay) * np.sin(2 * np.pi * at / period), 0.0)


@pytest.mark.parametrize("over", [0.2, 0.6])
@pytest.mark.parametrize("period", [0.05, 0.1])
def test_an_overshoot_is_measured_with_its_period_and_its_end(over, period):
    found = find_plateau(TIME, ringing(over, period), START, 0.0)
    assert found.held and found.depth_mm == pytest.approx(5.0, abs=0.005)
    peak = float(ringing(over, period).max()) - 5.0
    assert found.overshoot_mm == pytest.approx(peak, rel=0.02)
    assert found.period_s == pytest.approx(period, rel=0.05)
    # over at a thousandth of the depth, or at 0.6 of a step of the position
    rest = max(0.001 * 5.0, min(0.6 * 0.005, 0.05))
    assert found.settled_s == pytest.approx(0.3 + 0.15 * np.log(over / rest), abs=0.6 * period)


def test_a_ringing_that_is_below_a_step_of_the_position_is_none():
    assert find_plateau(TIME, ringing(over=0.004), START, 0.0).overshoot_mm == 0.0
    assert find_plateau(TIME, ringing(over=0.1), START, 0.0).overshoot_mm > 0.05


@pytest.mark.parametrize("creep", [0.1, 0.6])
def test_a_punch_that_goes_on_deeper_stands_at_the_depth_it_ends_at(creep):
    at = np.clip(TIME - 0.3, 0.0, 3.7)
    x = press() + np.where(TIME < 4.0, creep * (1.0 - np.exp(-at / 0.4)), creep * (TIME <= 4.0))
    found = find_plateau(TIME, x, START, 0.0)
    assert found.held
    assert found.depth_mm == pytest.approx(5.0 + creep, abs=0.03)


def test_a_punch_that_only_turns_has_no_plateau():
    x = np.where(TIME < 1.2, 5.0 * np.sin(np.pi * np.clip(TIME - 0.2, 0.0, None)), -1.0)
    found = find_plateau(TIME, x, START, 0.0)
    assert not found.held and found.depth_mm == pytest.approx(5.0, abs=1e-4)
    sharp = 5.0 - np.abs(TIME - 1.2) * 5.0
    assert not find_plateau(TIME, sharp, START, 0.0).held


def test_slowing_is_where_the_speed_falls_to_a_tenth():
    """A speed that decays exponentially from 60 % of the depth on is at a tenth after ln 10 of its times."""
    decay = 0.1
    x = np.where(TIME < 0.1, 50.0 * TIME, 5.0 + 50.0 * decay * -np.expm1(-(TIME - 0.1) / decay))
    sample, window = slowing(TIME, x, 6.0, 0)
    assert window == pytest.approx(3 * STEP)
    # the mean speed over the window begins at it: a little less than a tenth ahead
    assert TIME[sample] == pytest.approx(0.1 + decay * np.log(10.0), abs=window)
    half, _ = slowing(TIME, x, 6.0, 0, share=0.5)
    assert TIME[half] == pytest.approx(0.1 + decay * np.log(2.0), abs=window)


def test_a_punch_that_never_slows_slows_at_its_last_sample():
    sample, _ = slowing(TIME, 3.0 * TIME, 18.0, 0)
    assert sample == len(TIME) - 1


@pytest.mark.parametrize("sigma", [0.001, 0.05])
def test_the_noise_of_a_path_is_its_own_and_not_that_of_its_bend(sigma):
    noise = np.random.default_rng(3).normal(scale=sigma, size=len(TIME))
    assert noise_of(10.0 * TIME + noise) == pytest.approx(sigma, rel=0.06)
    assert noise_of(0.5 * TIME**2) < 1e-6
    assert noise_of(np.array([0.0, 1.0, 0.0, 1.0])) == 0.0


def test_crossings_are_those_of_swings_beyond_the_least():
    at = crossings(TIME, np.sin(2 * np.pi * TIME), 0.5)
    np.testing.assert_allclose(at, np.arange(0.5, 6.0, 0.5), atol=2 * STEP)
    assert len(crossings(TIME, np.sin(2 * np.pi * TIME), 1.1)) == 0
    # a ripple about zero within a swing is no crossing
    assert len(crossings(TIME, np.sin(2 * np.pi * TIME) + 0.05 * np.sin(200 * TIME), 0.2)) == len(at)


def test_leaving_is_no_ringing():
    """An overshoot that has long settled when the punch goes back, read with noise: one of the first samples of the
    way back may lie beyond the noise."""
    time = np.arange(-1.0, 10.5, STEP)
    since = np.clip(time - 0.265, 0.0, 8.635)
    held = np.clip(5.0 * time, -1.0, 1.315) + 0.2 * np.exp(-13.3 * since) * np.sin(32.4 * since)
    path = np.where(time > 8.9, np.maximum(1.315 - 5.0 * (time - 8.9), -1.0), held)
    for seed in range(31, 43):
        x = np.round(path + 0.001 * np.random.default_rng(seed).normal(size=len(time)), 4)
        found = find_plateau(time, x, 1000, noise_of(x))
        assert found.overshoot_mm > 0.05 and found.settled_s < 1.0 and found.period_s < 0.3
