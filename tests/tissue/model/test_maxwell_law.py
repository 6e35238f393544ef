"""The tissue law: limits, the ODE against another integrator, printed forms, orders, invariance."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.tissue.model.maxwell_law import law_named
from tests.support.refusal import raises_code

V, DEPTH = 250.0, 2.0


def ideal(velocity=V, depth=DEPTH, **options):
    return ramp_and_hold(velocity, depth, deceleration_mm_s2=np.inf, **options)


def peak(law, number, **options):
    """Arm force at the stop over c v, for gamma x^3 / (c v) = ``number``."""
    c = 0.01
    motion = ideal(**options)
    return law_named(law).force(motion, 0.0, [number * c * V / DEPTH**3], [c])[60] / (c * V)


def reference(motion, gamma1, gamma, c, times):
    """Force by scipy's LSODA, restarted at every sample of the motion so that no kink is smoothed."""
    stretch, out = np.zeros(len(gamma)), []
    t, x = motion.time_s, motion.displacement_mm
    for k in range(len(t) - 1):
        speed = (x[k + 1] - x[k]) / (t[k + 1] - t[k])

        def change(s, e, k=k, speed=speed):
            return speed - gamma * max(x[k] + speed * (s - t[k]), 0.0) ** 2 * e / c

        inside = times[(times > t[k]) & (times <= t[k + 1])]
        run = solve_ivp(
            change, (t[k], t[k + 1]), stretch, "LSODA", np.union1d(inside, t[k + 1]), rtol=1e-10, atol=1e-13
        )
        stretch = run.y[:, -1]
        at = np.maximum(x[k] + speed * (inside - t[k]), 0.0)
        out += list(gamma1 * at**3 + (gamma[:, None] * at**2 * run.y[:, : len(inside)]).sum(axis=0))
    return np.array(out)


@pytest.mark.parametrize("law", ["ode", "consistent"])
def test_a_fast_press_meets_the_springs_and_a_slow_one_the_dampers(law):
    assert peak(law, 1e-6) == pytest.approx(1e-6, rel=1e-5)
    assert peak(law, 1e6) == pytest.approx(1.0, rel=1e-4)


def test_the_ode_overshoots_the_damper_force_by_1_63_and_reaches_it_from_above():
    assert peak("ode", 5.0) == pytest.approx(1.63, abs=0.005)
    numbers = np.array([30.0, 100.0, 1000.0])
    above = np.array([peak("ode", number) for number in numbers]) - 1.0
    assert np.all(above > 0)
    # slow limit: e = v / lambda (1 + 2 v / (x lambda)), so the excess is 2 / number
    assert above[-1] == pytest.approx(2 / numbers[-1], rel=0.02)


def test_the_ode_gives_1_24_times_the_frozen_stiffness_form_at_one():
    assert peak("ode", 1.0) / peak("consistent", 1.0) == pytest.approx(1.24, abs=0.006)


def test_the_first_correction_is_one_quarter_in_the_ode_and_one_half_in_the_frozen_form():
    small = 1e-3
    assert (1 - peak("ode", small) / small) / small == pytest.approx(0.25, rel=2e-3)
    assert (1 - peak("consistent", small) / small) / small == pytest.approx(0.5, rel=2e-3)


def test_in_a_hold_the_arm_decays_at_gamma_x2_over_c():
    gamma, c = 0.4, 1.7
    for law in ("ode", "consistent"):
        motion = ideal(hold_s=5.0)
        arm = law_named(law).force(motion, 0.0, [gamma], [c])
        held = slice(-40, None)
        slope = np.polyfit(motion.time_s[held], np.log(arm[held]), 1)[0]
        assert slope == pytest.approx(-gamma * DEPTH**2 / c, rel=1e-7)


def test_the_published_hold_exponent_grows_with_time_squared():
    gamma, c = 0.02, 3.0
    motion = ideal(hold_s=5.0)
    consistent = law_named("consistent").force(motion, 0.0, [gamma], [c])
    published = law_named("published").force(motion, 0.0, [gamma], [c])
    stop = DEPTH / V
    assert np.allclose(published[:61], consistent[:61])
    late = motion.time_s[-1]
    printed = consistent[60] * np.exp(-gamma / c * V**2 * late**2 * (late - stop))
    assert published[-1] == pytest.approx(printed, rel=1e-4)


def test_the_steady_force_is_the_cube_law_and_only_gamma1_sets_it():
    motion = ramp_and_hold(10.0, 3.0, hold_s=1e4)
    for law in ("ode", "consistent", "published"):
        assert law_named(law).force(motion, 0.3, [0.5, 0.2], [1.0, 0.05])[-1] == pytest.approx(0.3 * 27, rel=1e-9)


@pytest.mark.parametrize("velocity, depth", [(10.0, 5.0), (250.0, 5.0), (250.0, 0.8)])
def test_the_ode_agrees_with_an_independent_integrator_on_a_braked_press(velocity, depth):
    motion = ramp_and_hold(velocity, depth, hold_s=2.0, ramp_points=12, brake_points=8, hold_points=6)
    times = motion.time_s[1:]
    gamma, c = np.array([0.05, 0.6]), np.array([0.4, 0.004])
    exact = reference(motion, 0.08, gamma, c, times)
    assert np.allclose(law_named("ode").force(motion, 0.08, gamma, c)[1:], exact, rtol=2e-6, atol=1e-8)


def test_the_ode_follows_an_unloading_and_a_second_press():
    motion = Motion(np.array([0.0, 0.3, 1.0, 1.2, 1.5, 2.0]), np.array([-0.5, 3.0, 3.0, 1.0, 4.0, 4.0]))
    gamma, c = np.array([0.3, 2.0]), np.array([0.8, 0.1])
    clipped = Motion(np.r_[0.0, 0.3 / 7, motion.time_s[1:]], np.r_[0.0, 0.0, motion.displacement_mm[1:]])
    exact = reference(clipped, 0.1, gamma, c, motion.time_s[1:])
    got = law_named("ode").force(clipped, 0.1, gamma, c)[2:]
    assert np.allclose(got, exact, rtol=1e-5)


def test_on_an_ideal_ramp_the_number_of_samples_does_not_matter():
    exact = law_named("ode").force(ideal(ramp_points=400), 0.1, [3.0], [0.004])[400]
    for points in (5, 20, 80):
        got = law_named("ode").force(ideal(ramp_points=points), 0.1, [3.0], [0.004])[points]
        assert got == pytest.approx(exact, rel=2e-4 if points == 5 else 2e-6)


def test_a_curved_motion_is_followed_to_second_order_in_the_step():
    def end(steps):
        time = np.linspace(0.0, 0.05, steps + 1)
        motion = Motion(time, 3.0 * np.sin(0.5 * np.pi * time / 0.05))
        return law_named("ode").force(motion, 0.1, [0.5], [0.1])[-1]

    exact = end(20_000)
    error = np.abs(np.array([end(steps) for steps in (25, 50, 100)]) - exact)
    assert np.allclose(np.log2(error[:-1] / error[1:]), 2.0, atol=0.05)


@pytest.mark.parametrize("law", ["ode", "consistent", "published"])
def test_metres_give_the_same_newtons_as_millimetres(law):
    motion = ideal()
    in_metres = Motion(motion.time_s, motion.displacement_mm / 1000)
    gamma, c = np.array([0.5, 0.1]), np.array([0.01, 0.5])
    mm = law_named(law).force(motion, 0.2, gamma, c)
    if law == "ode":
        m = law_named(law).force(in_metres, 0.2e9, gamma * 1e9, c * 1e3)
        assert np.allclose(m, mm, rtol=1e-9)
    # the same press twice as slow with dampers twice as strong is the same force on a stretched clock
    slow = Motion(2 * motion.time_s, motion.displacement_mm)
    assert np.allclose(law_named(law).force(slow, 0.2, gamma, 2 * c), mm, rtol=2e-4)


def test_many_parameter_sets_and_motions_at_once_equal_one_by_one():
    rng = np.random.default_rng(0)
    motion = ramp_and_hold(np.array([[10.0], [250.0]]), np.array([1.0, 2.0, 3.0]))
    gamma1, gamma, c = (
        rng.uniform(0.1, 1, (5, 1, 1)),
        rng.uniform(0.1, 1, (5, 1, 1, 2)),
        rng.uniform(0.01, 1, (5, 2, 1, 2)),
    )
    for law in ("ode", "consistent", "published"):
        many = law_named(law).force(motion, gamma1, gamma, c)
        one = law_named(law).force(ramp_and_hold(250.0, 2.0), gamma1[3, 0, 0], gamma[3, 0, 0], c[3, 1, 0])
        assert many.shape == (5, 2, 3, motion.time_s.shape[-1])
        assert np.allclose(many[3, 1, 1], one, rtol=1e-9)


def test_the_force_is_linear_in_the_springs_at_a_fixed_rate():
    drive = law_named("ode").drive(ideal())
    one, three = (law_named("ode").force(ideal(), 0.0, [0.2 * k], [0.1 * k]) for k in (1, 3))
    assert np.allclose(three, 3 * one)
    assert np.allclose(0.2 * drive.arm(2.0), one)


def test_the_depth_for_a_steady_force_gives_that_force_at_the_end_of_the_hold():
    def press(depth):
        return ramp_and_hold(10.0, depth)

    gamma1, gamma, c = np.array([0.05, 0.5]), np.array([[0.02], [0.4]]), np.array([[2.0], [3.0]])
    depth = law_named("ode").steady_depth(press, 10.0, gamma1, gamma, c)
    assert np.allclose(law_named("ode").force(press(depth), gamma1, gamma, c)[:, -1], 10.0, rtol=1e-6)
    assert np.all(depth < np.cbrt(10.0 / gamma1))


def test_parameters_are_named_by_their_arms_and_units():
    assert law_named("ode").parameter_names(5) == [
        "gamma1_N_per_mm3",
        "gamma2_N_per_mm3",
        "gamma3_N_per_mm3",
        "c2_N_s_per_mm",
        "c3_N_s_per_mm",
    ]


@pytest.mark.parametrize(
    "make, code",
    [
        (lambda: law_named("odes").force(ideal(), 1.0, [1.0], [1.0]), "unknown_name"),
        (lambda: law_named("ode").force(ideal(), 1.0, [1.0], [0.0]), "out_of_range"),
        (lambda: law_named("ode").force(ideal(), 1.0, [-1.0], [1.0]), "out_of_range"),
        (lambda: law_named("ode").force(ideal(), 1.0, [1.0], [1.0, 2.0]), "inconsistent"),
        (lambda: law_named("ode").parameter_names(4), "unknown_name"),
    ],
)
def test_bad_parameters_are_named(make, code):
    with raises_code(code):
        make()
