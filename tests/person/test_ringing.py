"""An arm that rings: closed forms of its swing, its mean, and what is made of its noise."""

import numpy as np
import pytest

from dummydesign.person.drives import read_drive
from dummydesign.person.drives.spring import press_by_spring
from dummydesign.person.integrate import run_robot
from dummydesign.person.on_person import on_person
from dummydesign.person.people import People
from dummydesign.person.press import read_press
from dummydesign.person.smoothing import RobotArm, quiet_noise, real_bends, slow_mean
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.laws import SPRING
from tests.support.robot_presses import Run, by_robot, command, gel_pad, sampled, skin_of

TISSUE = load_tissue("forefinger")


def springs(*stiffness):
    k = np.array(stiffness)
    return People(SPRING, k, np.zeros((len(k), 0)), np.zeros((len(k), 0)))


def rung(ratio=0.0, stiffness=60.0, mass=0.2, hold=1.5, velocity=150.0):
    path, speed, end = command(velocity, 1.2, hold, 0.002)
    begin = -0.6 / velocity
    pad = by_robot(gel_pad(), path, speed, end, begin, stiffness, mass, 30001, ratio=ratio, method="LSODA")
    return pad, (path, speed, end, begin, stiffness, mass)


@pytest.mark.parametrize("ratio", (0.0, 0.02, 0.3))
def test_a_damped_arm_on_a_spring_swings_as_in_closed_form(ratio):
    """M u'' + D u' + (K + k) u = F for even F: u = F / (K + k) (1 - exp(-d t) (cos w t + d / w sin w t))."""
    stiffness, mass, k, force = 30.0, 2.0, 12.0, 7.0
    arm = RobotArm(stiffness, mass, ratio)
    end = 12.0 * arm.period_s

    def given(time):
        return force, 0.0

    run = run_robot(
        springs(k), arm, given, end, np.zeros(1), np.ones(1), lambda time: arm.period_s / 48.0, tolerance=1.0
    )
    d = arm.damping_N_s_per_mm / (2e-3 * mass)
    w = np.sqrt((stiffness + k) / (1e-3 * mass) - d**2)
    t = run.time_s
    own = force / (stiffness + k) * (1.0 - np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t)))
    assert np.max(np.abs(run.depth_curve_mm[0] - own)) < 1e-3 * own.max()


def test_even_bends_are_second_differences_and_a_parabola_bends_alike_on_uneven_nodes():
    assert real_bends(np.arange(6.0)) == pytest.approx(np.diff(np.eye(6), 2, axis=0))
    nodes = np.r_[np.linspace(0.0, 1.0, 41), np.linspace(1.0, 9.0, 81)[1:]]
    rows = real_bends(nodes) @ nodes**2
    least = np.diff(nodes).min()
    # sum of squares = integral of (x'')^2 dt / least^3 times least^4
    assert (rows**2).sum() == pytest.approx(4.0 * 9.0 * least**3, rel=2e-2)


def test_a_slow_mean_keeps_a_line_and_takes_a_swing_away():
    t = np.arange(0.0, 1.0, 5e-4)
    line = 2.0 + 0.3 * t
    at, found = slow_mean(t, line + 0.2 * np.sin(2 * np.pi * 60.0 * t + 1.0), 4.0 / 60.0)
    inside = (at > 0.04) & (at < 0.96)
    assert np.max(np.abs(found - line)[inside]) < 2e-3
    assert slow_mean(t, line, 0.07)[1] == pytest.approx(line, abs=1e-9)


def test_the_noise_beside_a_ringing_is_found():
    t = np.arange(0.0, 2.0, 5e-4)
    noise = 0.001 * np.random.default_rng(8).standard_normal(len(t))
    assert quiet_noise(0.2 * np.sin(2 * np.pi * 90.0 * t) + noise) == pytest.approx(0.001, rel=0.05)


@pytest.mark.slow
def test_noise_of_the_trace_does_not_drive_the_arm():
    """Exact people under presses drawn from the errors of a noisy trace of an arm that rings: as on the true arm."""
    pad, robot = rung()
    drive = read_drive("spring:60,0.2")
    press = read_press(sampled(pad, 2000.0, 0.02, 0.001, seed=4), None, drive.arm)
    assert np.isfinite(press.mean_from_s)
    person = TISSUE.parameter_sets[2]
    many = People.of([person] * 20, press.velocity_mm_s)
    found = drive.respond(press.drawn(20, np.random.default_rng(1)), many, keep=False)
    path, speed, end, begin, *arm = robot
    own = by_robot(skin_of(person, press.velocity_mm_s), path, speed, end, begin, *arm, 30001, method="LSODA")
    assert found.peak_N.mean() == pytest.approx(own.peak, rel=0.01)
    assert found.depth_mm.mean() == pytest.approx(own.depth, abs=0.01)
    assert found.energy_mJ.mean() == pytest.approx(own.energy, rel=0.03)
    # contact is known to 0.01 mm, and nothing else is as wide
    assert 0.005 < found.depth_mm.std() < 0.02


@pytest.mark.slow
def test_a_filter_of_the_sensor_does_not_drive_it_either():
    from dummydesign.measurement.sensor import Lowpass

    passed = Lowpass(55.0, 2, 1)
    pad, robot = rung()
    drive = read_drive("spring:60,0.2")
    press = read_press(sampled(pad, 2000.0, 0.02, 0.001, seed=5, lowpass=passed), passed, drive.arm)
    assert float(press.peak_N) == pytest.approx(pad.peak, rel=0.015)
    person = TISSUE.parameter_sets[2]
    found = drive.respond(press, People.of([person], press.velocity_mm_s))
    path, speed, end, begin, *arm = robot
    own = by_robot(skin_of(person, press.velocity_mm_s), path, speed, end, begin, *arm, 30001, method="LSODA")
    assert float(found.peak_N[0]) == pytest.approx(own.peak, rel=0.015)
    assert float(found.depth_mm[0]) == pytest.approx(own.depth, rel=0.015)


@pytest.mark.slow
def test_what_the_trace_cannot_show_is_said():
    pad, _ = rung(hold=0.8)
    codes = {}
    for text, rate in (("spring:60,0.2", 2000.0), ("spring:60,0.2,0.03", 2000.0), ("spring:60,0.2", 400.0)):
        trace = sampled(pad, rate, 0.01, 0.001)
        codes[text, rate] = {one["code"] for one in on_person([trace], TISSUE, read_drive(text)).warnings}
    assert "arm_rings" in codes["spring:60,0.2", 2000.0]
    assert not {"arm_rings", "arm_unseen"} & codes["spring:60,0.2,0.03", 2000.0]
    assert "arm_unseen" in codes["spring:60,0.2", 400.0]


@pytest.mark.slow
def test_an_arm_that_is_still_does_not_move_and_means_change_nothing():
    """On the pad itself as a person, the press is the pad's own: through the ringing, and through its means."""
    k = 9.0
    t = np.linspace(0.0, 1.2, 24001)
    omega = np.sqrt((60.0 + k) / 0.2e-3)
    x = np.where(t < 0.008, 150.0 * t, 1.2 + 0.05 * np.cos(omega * (t - 0.008)) - 0.05)
    lead = np.linspace(-0.01, 0.0, 200)[:-1]
    run = Run(np.r_[lead, t], np.r_[150.0 * lead, x], np.r_[0.0 * lead, k * np.maximum(x, 0.0)])
    press = read_press(sampled(run, 4000.0), None, RobotArm(60.0, 0.2))
    found = press_by_spring(press, springs(k), RobotArm(60.0, 0.2))
    deep = np.interp(found.time_s, press.time_s, press.x_mm)
    before = found.time_s < press.mean_from_s
    assert np.max(np.abs(found.depth_curve_mm[0] - deep)[before]) < 2e-3
    after = (found.time_s > press.mean_from_s + 0.01) & (found.time_s < 1.1)
    swing = found.depth_curve_mm[0][after] - np.interp(found.time_s[after], t, x)
    assert np.max(np.abs(swing)) < 0.03


def test_presses_drawn_of_a_ringing_trace_that_no_arm_explains_keep_its_peak():
    path, speed, end = command(100.0, 3.0, 0.5, 1e-3)
    pad = by_robot(gel_pad(), path, speed, end, -0.006, 30.0, 0.4, 20001, method="LSODA")
    press = read_press(sampled(pad, 1000.0, 0.01, 0.001))
    drawn = press.drawn(400, np.random.default_rng(5)).peak_N
    low, high = np.quantile(drawn, (0.025, 0.975))
    assert low < pad.peak < high and high - low < 0.02 * pad.peak
    assert float(np.median(drawn)) == pytest.approx(pad.peak, rel=3e-3)
