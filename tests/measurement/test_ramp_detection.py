"""Both rules for the stop and the search for holds agree where a motion is clean, and differ where they should."""

import numpy as np
import pytest

from benchmarks.accuracy.overshoot import drawn
from dummydesign.measurement.motion import contact_velocity, ramp_and_hold
from dummydesign.measurement.ramp_detection import find_holds, find_ramp, planned_velocity, ringing_times, summarise
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


@pytest.mark.parametrize("creep_mm", [0.0, 0.08, 0.2])
@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_creep_after_the_stop_moves_it_by_neither_rule(stop, creep_mm):
    assert find_ramp(*ramp(creep_mm), stop).stop_time_s == pytest.approx(0.7, abs=0.02)


@pytest.mark.parametrize("share", [0.62, 0.7, 0.8])
@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_a_rest_on_the_way_in_is_no_stop(stop, share):
    """1.5 s at 62 to 80 % of the depth: the hold begins where the punch arrives."""
    rests = 0.2 + 0.5 * share
    time = np.arange(0.0, 8.0, 1e-3)
    x = np.clip(10.0 * (np.clip(time, None, rests) + np.maximum(time - rests - 1.5, 0.0) - 0.2), -2.0, 5.0)
    found = find_ramp(time, x + np.random.default_rng(4).normal(0.0, 0.001, len(time)), stop)
    assert (found.stop_time_s, found.depth_mm) == pytest.approx((2.2, 5.0), abs=0.02)


@pytest.mark.parametrize("share", [0.62, 0.7, 0.8])
@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_a_rest_on_the_way_out_is_no_part_of_the_hold(stop, share):
    time = np.arange(0.0, 8.0, 1e-3)
    x = np.interp(time, [0.0, 0.7, 5.0, 5.5 - 0.5 * share, 6.5, 7.0], [-2.0, 5.0, 5.0, 5.0 * share, 5.0 * share, -2.0])
    found = find_ramp(time, x + np.random.default_rng(4).normal(0.0, 0.001, len(time)), stop)
    assert (found.stop_time_s, found.hold_end_s, found.depth_mm) == pytest.approx((0.7, 5.0, 5.0), abs=0.02)


@pytest.mark.parametrize("samples", [1, 5, 30])
@pytest.mark.parametrize("stop", ["reached", "slowed"])
def test_outliers_of_the_position_in_the_hold_are_no_way_on(stop, samples):
    """A position that jumps by 40 % of the depth for up to 30 ms makes no stage of the hold before it."""
    time = np.arange(0.0, 8.0, 1e-3)
    x = np.minimum(np.clip(10.0 * (time - 0.4), -2.0, 5.0), np.maximum(75.0 - 10.0 * time, -2.0))
    x[4000 : 4000 + samples] += 2.0
    found = find_ramp(time, x + np.random.default_rng(4).normal(0.0, 0.001, len(time)), stop)
    assert (found.stop_time_s, found.hold_end_s, found.depth_mm) == pytest.approx((0.9, 7.0, 5.0), abs=0.02)


def drawn_press(draw, most_noise_mm):
    """A rest at an offset, an approach or none, a constant speed and braking, hold with creep; stop at 0 s."""
    speed, braking = 250.0 ** draw.uniform(), 1e3 * 30.0 ** draw.uniform()
    depth, noise, rate = draw.uniform(1.0, 7.0), draw.uniform(0.0, most_noise_mm), 200.0 * 50.0 ** draw.uniform()
    level = draw.uniform(-0.05, 0.05) if draw.random() < 0.6 else -draw.uniform(1.0, 20.0)

    def back(x):
        way, brake = depth - x, 0.5 * speed**2 / braking
        return np.sqrt(2.0 * way / braking) if way < brake else speed / braking + (way - brake) / speed

    time = np.arange(-back(level) - draw.uniform(0.02, 1.0) + draw.uniform() / rate, 4.0, 1.0 / rate)
    left = np.maximum(-time, 0.0)
    left = np.where(left < speed / braking, 0.5 * braking * left**2, speed * (left - 0.5 * speed / braking))
    creep = draw.uniform(0.0, 0.02) * depth * (1.0 - np.exp(-np.maximum(time, 0.0) / 0.5))
    x = np.maximum(depth - left, level) + creep + noise * draw.standard_normal(len(time))
    return time, x, speed, braking, depth, noise, rate, -back(max(level, 0.0))


@pytest.mark.parametrize("stop", ["reached", "slowed"])
@pytest.mark.parametrize("most_noise_mm", [0.0, 0.005])
@pytest.mark.parametrize("seed", range(30))
def test_contact_stop_and_depth_are_those_drawn_whatever_the_rest_before(seed, most_noise_mm, stop):
    """Contact to a sample and the noise; the stop within what a mean over a window w lets see of a braking a.

    The mean falls to a tenth of v at most sqrt(0.2 v w / a) or 0.1 v / a + w / 2 before the stop. The window is of the
    mean speed of the ramp, which is half of v or more. Noise may end a window of slowness early: not held to here.
    """
    time, x, speed, braking, depth, noise, rate, contact = drawn_press(np.random.default_rng([seed, 58]), most_noise_mm)
    found, step = find_ramp(time, x, stop), 1.0 / rate
    window = max(3.0 * step, 10.0 * max(0.005, noise) / (0.5 * speed))
    assert found.contact_time_s == pytest.approx(contact, abs=step + (0.02 + 5.0 * noise) / speed)
    tenth = 0.1 * speed / braking
    early = max(np.sqrt(2.0 * tenth * window), tenth + 0.5 * window) + step
    assert found.stop_time_s <= window + tenth + step
    assert noise or found.stop_time_s >= -early
    assert found.depth_mm == pytest.approx(depth, abs=0.022 * depth + 4.0 * noise)


@pytest.mark.parametrize("offset_mm", [-0.05, -0.001, 0.0, 0.001, 0.03])
def test_a_rest_at_an_offset_is_not_part_of_the_ramp(offset_mm):
    time = np.arange(0.0, 3.0, 1e-3)
    x = np.clip(250.0 * (time - 0.2), 0.0, 4.0) + offset_mm
    found = find_ramp(time, x)
    assert (found.contact_time_s, found.stop_time_s) == pytest.approx((0.2, 0.216), abs=1e-3)
    assert found.velocity_mm_s == pytest.approx(250.0, rel=0.08)


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


@pytest.mark.parametrize("seed", range(12))
def test_depth_hold_and_steady_force_are_those_before_and_after_an_overshoot(seed):
    """Drawn overshoot, ringing, damping, depth, speed and sampling, by an integrator of its own."""
    press = drawn(np.random.default_rng(3000 + seed))
    found = summarise("drawn", press.time_s, press.displacement_mm, press.force_N)
    hold = press.end_s - press.stop_s
    assert found.depth_mm == pytest.approx(press.depth_mm, rel=0.01)
    assert found.hold_s == pytest.approx(hold, abs=max(0.3, 0.03 * hold))
    assert found.steady_force_N == pytest.approx(press.steady_N, rel=0.01)


def test_overshoot_period_and_end_of_a_ringing_are_those_that_were_drawn():
    time = np.arange(-0.3, 8.5, 5e-4)
    since = np.maximum(time - 0.5, 0.0)
    x = np.clip(10.0 * time, -1.0, 5.0) + 0.3 * np.exp(-4.0 * since) * np.sin(2.0 * np.pi * 10.0 * since)
    found = find_ramp(time, x)
    assert found.overshoot_mm == pytest.approx(0.3 * np.exp(-4.0 * 0.025), rel=0.02)
    assert found.period_s == pytest.approx(0.1, rel=0.02)
    assert found.settled_s == pytest.approx(0.5 + np.log(0.3 / 0.005) / 4.0, abs=0.1)
    times = ringing_times(found)
    assert np.diff(times[times <= found.settled_s]).max() < 0.1 / 15 and times[-1] > found.settled_s
    beyond = np.diff(times[times >= found.settled_s])
    assert np.allclose(beyond[1:] / beyond[:-1], 1.3) and beyond[-1] > 5.0 * beyond[0]
    clean = find_ramp(*ramp())
    assert (clean.overshoot_mm, clean.period_s, len(ringing_times(clean))) == (0.0, 0.0, 0)


@pytest.mark.parametrize("noise_mm", [0.0, 0.001, 0.003])
@pytest.mark.parametrize("form", ["triangle", "half sine", "parabola"])
def test_a_turn_has_no_hold(form, noise_mm):
    time = np.arange(-1.0, 21.0, 2e-3)
    share = np.clip(time / 20.0, 0.0, 1.0)
    x = (
        5.0
        * {
            "triangle": 1.0 - np.abs(2.0 * share - 1.0),
            "half sine": np.sin(np.pi * share),
            "parabola": 4.0 * share * (1.0 - share),
        }[form]
    )
    x = np.where(time < 0.0, 0.5 * time, x) + noise_mm * np.random.default_rng(1).standard_normal(len(time))
    for stop in ("reached", "slowed"):
        found = find_ramp(time, x, stop)
        assert found.hold_end_s == found.stop_time_s and found.depth_mm == pytest.approx(5.0, abs=0.02)
    shown = summarise("turn", time, x, np.maximum(x, 0.0) ** 3)
    assert (shown.hold_s, shown.steady_force_N) == (0.0, None)


@pytest.mark.parametrize("noise_mm", [0.0, 0.002])
def test_a_slow_release_at_fast_sampling_does_not_end_the_hold_early(noise_mm):
    """The path falls by less than its noise over a few samples."""
    time = np.arange(-0.2, 12.0, 2e-4)
    x = np.minimum(np.clip(10.0 * time, -1.0, 5.0), np.maximum(5.0 - 1.0 * (time - 6.0), -1.0))
    x = x + noise_mm * np.random.default_rng(2).standard_normal(len(time))
    found = find_ramp(time, x, "slowed")
    assert (found.stop_time_s, found.hold_end_s) == pytest.approx((0.5, 6.0), abs=0.02)


def test_a_punch_that_creeps_under_a_held_force_holds_from_where_it_slows():
    time = np.arange(-0.2, 10.0, 2e-3)
    x = np.clip(10.0 * time, -1.0, 4.0) + 1.0 * (1.0 - np.exp(-np.maximum(time - 0.4, 0.0) / 2.0))
    for stop in ("reached", "slowed"):
        found = find_ramp(time, x, stop)
        assert 0.38 < found.stop_time_s < 0.8 and found.hold_end_s == time[-1]
        assert found.depth_mm == pytest.approx(5.0, rel=0.01) and found.overshoot_mm == 0.0


def pressed(draw, sent_mm_s, depth_mm, braking_mm_s2, approach):
    """A ramp and hold of a robot, recorded from contact, from a rest at it, or from far above, with noise and steps."""
    motion, rate = ramp_and_hold(sent_mm_s, depth_mm, 1.0, braking_mm_s2), draw.choice([1000.0, 2000.0, 10000.0])
    touch = float(contact_velocity(sent_mm_s, depth_mm, braking_mm_s2))
    time = np.arange({"contact": 0.0, "rest": -0.05, "above": -3.0 / sent_mm_s}[approach], 1.0, 1.0 / rate)
    back = np.maximum(-time, 0.0)
    braked = np.minimum(back, (sent_mm_s - touch) / braking_mm_s2)
    before = touch * braked + 0.5 * braking_mm_s2 * braked**2 + sent_mm_s * (back - braked)
    x = np.interp(time, motion.time_s, motion.displacement_mm) - before * (approach == "above")
    x = x + draw.choice([0.0, 2e-4, 1e-3]) * draw.standard_normal(len(x))
    return time, np.round(x, 3)


@pytest.mark.parametrize("approach", ["contact", "rest", "above"])
def test_a_press_that_brakes_from_contact_on_has_an_open_upper_speed_and_others_keep_theirs(approach):
    draw = np.random.default_rng([58, len(approach)])

    def read(planned_mm_s, sent_mm_s, depth_mm, braking_mm_s2):
        time, x = pressed(draw, sent_mm_s, depth_mm, braking_mm_s2, approach)
        return planned_velocity(find_ramp(time, x, "slowed"), planned_mm_s) / planned_mm_s

    seen = []
    for _ in range(60):
        depth, braking = draw.uniform(0.15, 0.9), draw.uniform(15_000.0, 60_000.0)
        usual, touch = (float(contact_velocity(np.inf, depth, one)) for one in (30_000.0, braking))
        # as planned to the usual braking, or to a speed that nobody reaches; the robot brakes as it can
        assert read(usual, usual, depth, 30_000.0) == pytest.approx(1.0, abs=0.15)
        assert read(1.3 * touch, 1.3 * touch, depth, braking) == pytest.approx(1.0, abs=0.15)
        assert read(usual, 1.3 * max(usual, touch), depth, max(braking, 30_000.0)) == pytest.approx(1.0, abs=0.2)
        # far too slow, far too fast
        seen += [read(usual, 0.5 * usual, depth, 30_000.0) < 0.8, read(0.5 * usual, usual, depth, 30_000.0) > 1.2]
        assert read(10.0, 250.0, depth, braking) > 4.0
    # steps of a micrometre at 1 kHz leave single presses unread
    assert np.mean(seen) > 0.95


def test_a_slow_press_that_eases_to_its_stop_is_no_fast_one():
    time, x = pressed(np.random.default_rng(3), 10.0, 1.0, 50.0, "contact")
    assert planned_velocity(find_ramp(time, x, "slowed"), 250.0) < 12.0
