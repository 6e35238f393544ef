"""Each effect against the formula that its docstring states, on a small campaign of pucks."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.effects.history.ageing import Ageing
from dummydesign.loop.effects.history.incomplete_recovery import IncompleteRecovery
from dummydesign.loop.effects.history.softening_with_cycles import SofteningWithCycles
from dummydesign.loop.effects.history.temperature import Temperature
from dummydesign.loop.effects.material.adhesion import Adhesion
from dummydesign.loop.effects.material.compressibility import Compressibility
from dummydesign.loop.effects.material.rate_dependent_viscosity import RateDependentViscosity
from dummydesign.loop.effects.material.relaxation_mode import MEMBERS as MODES
from dummydesign.loop.effects.material.strain_stiffening import StrainStiffening
from dummydesign.loop.effects.rig.base_slip import BaseSlip
from dummydesign.loop.effects.rig.contact_offset import ContactOffset
from dummydesign.loop.effects.rig.friction_hysteresis import FrictionHysteresis, dahl
from dummydesign.loop.effects.rig.machine_compliance import MachineCompliance
from dummydesign.loop.effects.rig.punch_edge import PunchEdge
from dummydesign.loop.effects.rig.punch_tilt import PunchTilt
from dummydesign.loop.effects.rig.thickness_error import ThicknessError
from dummydesign.loop.effects.sensor.force_bias import ForceBias
from dummydesign.loop.effects.sensor.force_drift import ForceDrift
from dummydesign.loop.effects.sensor.inertia import Inertia
from dummydesign.loop.effects.sensor.sensor_clipping import SensorClipping
from dummydesign.loop.effects.sensor.sensor_curve import SensorCurve
from dummydesign.loop.effects.sensor.time_skew import TimeSkew
from dummydesign.loop.model.effect import Arm
from tests.support import puck_presses as pucks

PRESSES = pucks.planned()
DEPTH = np.maximum(PRESSES.displacement_mm, 0.0)
FORCE = np.linspace(-2.0, 18.0, DEPTH.size).reshape(DEPTH.shape)
H = PRESSES.thickness_mm[:, None]


def acting(kind, **values):
    effect = kind()
    return effect, {**effect.null_values(), **values}


def test_stiffening_is_stated_at_three_tenths_of_the_thickness_and_squared_is_yeohs():
    depth, h = np.array([[0.6, 2.4, 4.8, -1.0]]), np.array([[8.0]])
    for exponent in (2.0, 3.5):
        effect, values = acting(StrainStiffening, coefficient=1.5, exponent=exponent)
        share = np.maximum(depth, 0.0) / h
        wanted = pucks.LAW(depth, h) * (1.0 + 1.5 * 0.09 * (share / 0.3) ** exponent)
        np.testing.assert_allclose(effect.law(pucks.LAW, values)(depth, h), wanted)
    effect, values = acting(StrainStiffening, coefficient=1.5)
    depth = np.array([[2.4]])
    np.testing.assert_allclose(effect.law(pucks.LAW, values)(depth, h), (1.0 + 1.5 * 0.09) * pucks.LAW(depth, h))


def test_a_machine_gives_way_by_its_compliance_at_ten_newtons_and_hardens_from_half_a_newton_on():
    force = np.array([[0.0, 5.0, 10.0, -10.0, 40.0]])
    effect, values = acting(MachineCompliance, compliance_mm_per_N=0.01)
    np.testing.assert_allclose(effect.yielding(PRESSES, force, values), 0.01 * force)
    effect, values = acting(MachineCompliance, compliance_mm_per_N=0.01, exponent=2.0 / 3.0)
    found = effect.yielding(PRESSES, force, values)
    np.testing.assert_allclose(found[0, 2:4], [0.1, -0.1])
    np.testing.assert_allclose(found, 0.01 * force * ((np.abs(force) + 0.5) / 10.5) ** (-1.0 / 3.0))


def test_friction_adds_on_the_way_in_and_takes_off_on_the_way_out():
    effect, values = acting(FrictionHysteresis, friction_fraction=0.1, turn_mm=0.2)
    found = effect.surface(PRESSES, DEPTH, FORCE, values) / FORCE
    away = PRESSES.time_s > PRESSES.hold_end_s[:, None]
    back = PRESSES.depth_mm[:, None] - PRESSES.displacement_mm
    np.testing.assert_allclose(found[~away], 1.1)
    np.testing.assert_allclose(found[away & (back >= 2.0)], 0.9, atol=1e-5)
    turned = 2.0 * 0.25 ** (np.maximum(back, 0.0) / 0.2) - 1.0
    np.testing.assert_allclose(found[away], (1.0 + 0.1 * turned)[away])


def test_a_tilted_punch_is_the_mean_over_strips_of_its_face():
    def cubic(depth, h):
        return np.maximum(depth, 0.0) ** 3

    cubic.radius_mm = 7.9
    effect, values = acting(PunchTilt, tilt_deg=2.0)
    depth = np.array([[2.0, 5.0]])
    reach = 0.5 * np.sqrt(np.pi) * 7.9 * np.tan(np.deg2rad(2.0))
    # mean of (d + u)^3 over u even in the reach: d^3 + d reach^2
    np.testing.assert_allclose(effect.law(cubic, values)(depth, H[:1]), depth**3 + depth * reach**2, rtol=1e-6)
    np.testing.assert_allclose(effect.law(cubic, acting(PunchTilt, tilt_deg=0.0)[1])(depth, H[:1]), depth**3)


def test_thickness_and_offset_are_added_to_what_is_stated():
    depth, h = np.array([[1.0]]), np.array([[8.0]])
    effect, values = acting(ThicknessError, thickness_error_mm=-0.5)
    assert effect.law(pucks.LAW, values)(depth, h) == pucks.LAW(depth, np.array([[7.5]]))
    effect, values = acting(ContactOffset, offset_mm=0.2)
    np.testing.assert_allclose(effect.depth(PRESSES, DEPTH, values), DEPTH - 0.2)


def test_a_base_that_slips_and_a_bulk_that_gives_are_shares_of_their_laws():
    def law(depth, h):
        return 6.0 * depth

    law.sliding = lambda: lambda depth, h: 2.0 * depth
    law.compressibility_coefficient = lambda depth, h: 3.0 + depth
    depth = np.array([[0.5, 2.0]])
    effect, values = acting(BaseSlip, slip_fraction=0.25)
    np.testing.assert_allclose(effect.law(law, values)(depth, H[:1]), 5.0 * depth)
    effect, values = acting(Compressibility, poisson_ratio=0.45)
    np.testing.assert_allclose(effect.law(law, values)(depth, H[:1]), 6.0 * depth / (1.0 + 0.1 * (3.0 + depth)))


def test_temperature_is_relative_to_23_degrees_and_shifts_times_by_its_power():
    effect, values = acting(Temperature, modulus_loss_per_K=0.01, times_over_modulus=2.0)
    warm = PRESSES.history.temperature_C[:, None] - 23.0
    np.testing.assert_allclose(effect.scale(PRESSES, DEPTH, values), 1.0 - 0.01 * warm)
    (arm,) = effect.arms(PRESSES, (Arm(0.5, 0.3),), DEPTH, values)
    np.testing.assert_allclose(arm.tau_s, 0.5 * np.exp(-0.02 * warm))
    even = {**values, "times_over_modulus": 0.0}
    assert effect.arms(PRESSES, (Arm(0.5, 0.3),), DEPTH, even)[0].tau_s == 0.5
    for spread, shown in ((0.51, True), (0.49, False)):
        history = SimpleNamespace(temperature_C=np.array([21.0, 21.0 + spread]))
        assert (effect.untestable(SimpleNamespace(history=history)) == "") is shown


def test_ageing_is_a_share_per_doubling_of_seven_days():
    effect, values = acting(Ageing, growth_per_doubling=0.04)
    history = replace(PRESSES.history, age_days=np.r_[7.0, 14.0, 28.0, 3.5, np.full(12, 7.0)])
    found = effect.scale(replace(PRESSES, history=history), DEPTH, values)[:, 0]
    np.testing.assert_allclose(found[:5], [1.0, 1.04, 1.08, 0.96, 1.0])
    for ratio, shown in ((1.11, True), (1.09, False)):
        made = SimpleNamespace(history=SimpleNamespace(age_days=np.array([7.0, 7.0 * ratio])))
        assert (effect.untestable(made) == "") is shown


def history_of(earlier, elapsed):
    count = len(PRESSES.trials)
    depth, since = np.zeros((count, count)), np.full((count, count), np.inf)
    depth[0, 1 : 1 + len(earlier)], since[0, 1 : 1 + len(earlier)] = earlier, elapsed
    return replace(PRESSES, history=replace(PRESSES.history, earlier_depth_mm=depth, elapsed_s=since))


def test_dents_of_earlier_presses_decay_and_add():
    effect, values = acting(IncompleteRecovery, fraction=0.1, tau_s=100.0, adding=0.5)
    presses = history_of([2.0, 3.0], [100.0, 200.0])
    left = np.array([2.0 * np.exp(-1.0), 3.0 * np.exp(-2.0)])
    found = DEPTH - effect.depth(presses, DEPTH, values)
    np.testing.assert_allclose(found[0], 0.1 * (left.max() + 0.5 * left.min()))
    np.testing.assert_allclose(found[1:], 0.0, atol=1e-12)


def test_softening_is_lost_at_the_first_reloading_and_more_at_later_ones():
    effect, values = acting(SofteningWithCycles, softening=0.2, width_share=0.02, cycles=1.5)
    shallow = np.full_like(DEPTH, 1.0)
    for count in (1, 2, 3):
        presses = history_of([4.0] * count, [60.0] * count)
        loss = 0.2 * (1.0 - np.exp(-count / 1.5)) / (1.0 - np.exp(-1.0 / 1.5))
        np.testing.assert_allclose(effect.scale(presses, shallow, values)[0], 1.0 - loss, rtol=1e-9)
    presses = history_of([4.0], [60.0])
    # at the rejoined depth half of a cycle counts, beyond it none
    for rejoin in (1.0, 1.2):
        own = {**values, "rejoin_share": rejoin}
        half = effect.scale(presses, np.full_like(DEPTH, 4.0 * rejoin), own)[0, 0]
        assert half == pytest.approx(1.0 - 0.2 * np.expm1(-0.5 / 1.5) / np.expm1(-1.0 / 1.5))
        assert effect.scale(presses, np.full_like(DEPTH, 5.5), own)[0, 0] == pytest.approx(1.0, abs=1e-5)
        width = effect.scale(presses, np.full_like(DEPTH, 4.0 * (rejoin + 0.02)), own)[0, 0]
        count = 0.5 * (1.0 - np.tanh(1.0))
        assert width == pytest.approx(1.0 - 0.2 * np.expm1(-count / 1.5) / np.expm1(-1.0 / 1.5))


def test_viscosity_thins_with_speed_about_fifty_millimetres_a_second_above_its_plateau():
    effect, values = acting(RateDependentViscosity, exponent=0.4, plateau_mm_per_s=6.0)
    (arm,) = effect.arms(PRESSES, (Arm(0.5, 0.3),), DEPTH, values)
    speed = PRESSES.velocity_mm_s[:, None]
    np.testing.assert_allclose(arm.tau_s, 0.5 * ((speed**2 + 36.0) / (2500.0 + 36.0)) ** -0.2)
    (own,) = effect.arms(PRESSES, (Arm(0.5, 0.3),), DEPTH, {**values, "way_back": 1.0})
    away = PRESSES.time_s > PRESSES.hold_end_s[:, None]
    slow = 0.5 * ((PRESSES.back_mm_s[:, None] ** 2 + 36.0) / (2500.0 + 36.0)) ** -0.2
    np.testing.assert_allclose(np.broadcast_to(own.tau_s, away.shape)[away], np.broadcast_to(slow, away.shape)[away])
    np.testing.assert_allclose(own.tau_s[~away], np.broadcast_to(arm.tau_s, away.shape)[~away])
    # the fast arm has an exponent of its own, wherever it stands; a third arm that of the slow one
    times = (1.5, 0.1, 0.01)
    arms = effect.arms(PRESSES, tuple(Arm(one, 0.3) for one in times), DEPTH, {**values, "fast_arm": -0.5})
    for arm, time, power in zip(arms, times, (-0.2, 0.1, -0.2)):
        np.testing.assert_allclose(arm.tau_s, time * ((speed**2 + 36.0) / (2500.0 + 36.0)) ** power)
    for ratio, shown in ((1.51, True), (1.49, False)):
        assert (effect.untestable(SimpleNamespace(velocity_mm_s=np.array([10.0, 10.0 * ratio]))) == "") is shown


def test_a_tacky_pad_pulls_on_the_way_back_alone():
    effect, values = acting(Adhesion, pull_off_N=2.0, release_mm=0.5, neck_mm=0.1)
    away = PRESSES.time_s > PRESSES.hold_end_s[:, None]
    floor = effect.floor(PRESSES, np.zeros((1, 1)), values)
    np.testing.assert_array_equal(floor, np.where(away, -2.0, 0.0))
    force = np.full_like(DEPTH, 5.0)
    for depth, pull in ((0.0, 2.0), (0.1, 2.0 * np.exp(-1.0)), (3.0, 0.0)):
        found = effect.surface(PRESSES, np.full_like(DEPTH, depth), force, values)
        np.testing.assert_allclose(found[away], 5.0 - pull, atol=1e-9)
        np.testing.assert_allclose(found[~away], 5.0)
    # above the surface it lets go over the release
    for depth, held in ((-0.125, 1.5), (-0.25, 1.0), (-0.6, 0.0)):
        found = effect.surface(PRESSES, np.full_like(DEPTH, depth), np.full_like(DEPTH, -9.0), values)
        np.testing.assert_allclose(found[away], -held, atol=1e-9)
    assert effect.unseen(SimpleNamespace(pulls=2)) == "" != effect.unseen(SimpleNamespace(pulls=1))


def test_a_peeling_edge_pulls_at_every_depth():
    effect, values = acting(Adhesion, pull_off_N=2.0, release_mm=0.5, neck_mm=0.1, deep=0.25)
    away = PRESSES.time_s > PRESSES.hold_end_s[:, None]
    force = np.full_like(DEPTH, 5.0)
    for depth, share in ((0.0, 1.0), (0.1, np.exp(-1.0)), (5.0, 0.0)):
        found = effect.surface(PRESSES, np.full_like(DEPTH, depth), force, values)
        np.testing.assert_allclose(found[away], 5.0 - 2.0 * share - 0.5 * np.sqrt(0.5), atol=1e-9)
        np.testing.assert_allclose(found[~away], 5.0)


def test_dry_friction_follows_small_moves_of_the_hold_in_part():
    path = np.array([[0.0, 1.0, 2.0, 1.99, 1.97, 1.98, 2.5, 2.0, 1.0]])
    turned = 2.0 * np.exp(-0.3) - 1.0  # 0.03 mm back
    forward = 1.0 - (1.0 - turned) * np.exp(-0.1)
    np.testing.assert_allclose(dahl(path, 0.1)[0, [2, 4, 5, 6, 8]], [1.0, turned, forward, 1.0, -1.0], atol=6e-3)
    presses = SimpleNamespace(displacement_mm=path, going_back=np.arange(9.0)[None] > 6.5, depth_mm=np.array([2.05]))
    effect, values = acting(FrictionHysteresis, friction_fraction=0.2, turn_mm=0.2 * np.log(2.0), in_hold=0.5)
    found = effect.surface(presses, path, np.full_like(path, 10.0), values)
    np.testing.assert_allclose(found[0, :3], 12.0)
    np.testing.assert_allclose(found[0, 4], 10.0 * (1.0 + 0.2 * (1.0 - 0.5 * (1.0 - turned))))
    # on the way back from the depth of the press
    np.testing.assert_allclose(found[0, 7:], [10.0 + 2.0 * (2.0 * np.exp(-0.5) - 1.0), 8.0], atol=1e-3)


def test_sensors_add_bend_and_clip_as_stated():
    effect, values = acting(ForceBias, bias_N=-0.4)
    np.testing.assert_allclose(effect.sensor(PRESSES, FORCE, values), FORCE - 0.4)
    effect, values = acting(ForceDrift, drift_N_per_s=0.02)
    late = replace(PRESSES, time_s=PRESSES.time_s + 50.0)
    for presses in (PRESSES, late):
        since = presses.time_s - presses.time_s[:, :1]
        np.testing.assert_allclose(effect.sensor(presses, FORCE, values), FORCE + 0.02 * since)
    effect, values = acting(Inertia, mass_kg=0.3)
    pulse = 1e-3 * 0.3 * PRESSES.acceleration_mm_s2
    assert np.abs(pulse).max() > 0.1
    np.testing.assert_allclose(effect.sensor(PRESSES, FORCE, values), FORCE + pulse)
    effect, values = acting(SensorCurve, relative_change=-0.1, exponent=2.0)
    bent = FORCE * (1.0 - 0.1 * (np.abs(FORCE) / 10.0) ** 2)
    np.testing.assert_allclose(effect.reading(PRESSES, FORCE, values), bent)
    effect, values = acting(SensorClipping, share=0.75)
    clipped = SimpleNamespace(flat_top_N=12.0)
    np.testing.assert_allclose(effect.reading(clipped, FORCE, values), FORCE - 0.75 * np.maximum(FORCE - 12.0, 0.0))
    np.testing.assert_array_equal(effect.reading(SimpleNamespace(flat_top_N=None), FORCE, values), FORCE)


@pytest.mark.parametrize("effect", MODES, ids=lambda effect: effect.name)
def test_a_third_arm_begins_from_two_arms_that_it_has_moved_or_used_up(effect):
    """Starts stay within the base's bounds, keep the modulus, and their arms stay in order of time."""
    from dummydesign.loop.model.material import UNDECLARED

    LOW, HIGH = UNDECLARED.bounds()

    logs = np.log([0.03, 0.06, 0.3, 1.4, 0.2])
    near, used_up = effect.base_starts(logs.copy())
    for start in (near, used_up):
        assert start[0] == logs[0] and np.all(start >= LOW) and np.all(start <= HIGH) and start[1] < start[3]
    moved = np.flatnonzero(near != logs)
    assert moved.tolist() == ([3] if effect.name.startswith("slow") else [1])
    # the arm that the mode has used up is the base's other one; one of usual size takes its place
    own = used_up[3:] if effect.name.startswith("slow") else used_up[1:3]
    other = logs[1:3] if effect.name.startswith("slow") else np.array([min(logs[3], np.log(0.3)), logs[4]])
    np.testing.assert_allclose(own, other)
    (term,) = effect.adds_terms({"tau_s": 9.0, "beta": 0.2, "variance": 0.0})
    assert (term.tau_s, term.beta) == (9.0, 0.2)
    wide = effect.adds_terms({"tau_s": 9.0, "beta": 0.2, "variance": 0.16})
    assert [term.beta for term in wide] == [0.1, 0.1]
    np.testing.assert_allclose(np.log([term.tau_s for term in wide]), np.log(9.0) + np.array([-0.4, 0.4]))


ALL = (
    *(Ageing, IncompleteRecovery, SofteningWithCycles, Temperature),
    *(Adhesion, Compressibility, RateDependentViscosity, StrainStiffening),
    *(BaseSlip, ContactOffset, FrictionHysteresis, MachineCompliance, PunchEdge, PunchTilt, ThicknessError),
    *(ForceBias, ForceDrift, Inertia, SensorClipping, SensorCurve, TimeSkew),
)


class AnyLaw:
    """A law with whatever an effect may ask of it."""

    radius_mm, diameter_mm, offers = 7.9, 15.8, frozenset({"flat_faces", "sharp_edge"})

    def __call__(self, depth, h):
        return 3.0 * np.maximum(depth, 0.0) ** 1.5 * h**-0.5

    def sliding(self):
        return lambda depth, h: 0.5 * self(depth, h)

    def compressibility_coefficient(self, depth, h):
        return 2.0 + depth / h

    def edge_factor(self, radius_mm, depth, h):
        return 1.0 - 0.1 * radius_mm * np.exp(-depth / h)


@pytest.mark.parametrize("kind", ALL, ids=lambda kind: kind.name)
def test_an_effect_of_null_size_changes_nothing_at_any_hook_whatever_its_form(kind):
    """With form parameters of their typical size; softening needs a history, clipping a top."""
    effect = kind()
    size, *others = effect.parameters
    values = {size.name: size.null, **{one.name: one.typical for one in others}}
    presses = history_of([2.0, 1.0], [60.0, 900.0])
    vars(presses)["flat_top_N"] = 5.0
    law, arms = AnyLaw(), (Arm(0.1, 0.2), Arm(1.5, 0.3))
    np.testing.assert_allclose(effect.law(law, values)(DEPTH, H), law(DEPTH, H), rtol=1e-12)
    for change in (effect.surface(presses, DEPTH, FORCE, values), effect.sensor(presses, FORCE, values)):
        np.testing.assert_allclose(np.maximum(change, 0.0), np.maximum(FORCE, 0.0), rtol=1e-12)
    np.testing.assert_allclose(effect.reading(presses, FORCE, values), FORCE, rtol=1e-12)
    np.testing.assert_array_equal(effect.depth(presses, DEPTH, values), DEPTH)
    np.testing.assert_array_equal(effect.yielding(presses, FORCE, values), 0.0)
    np.testing.assert_array_equal(effect.floor(presses, np.zeros_like(FORCE), values), 0.0)
    np.testing.assert_allclose(effect.scale(presses, DEPTH, values) * np.ones_like(DEPTH), 1.0, rtol=1e-12)
    for arm, plain in zip(effect.arms(presses, arms, DEPTH, values), arms, strict=True):
        np.testing.assert_allclose(arm.tau_s, plain.tau_s)
        assert arm.beta == plain.beta and arm.weight is None


@pytest.mark.parametrize("skew_s", [-0.02, 0.0, 0.013])
def test_a_late_force_clock_reads_what_was_before(skew_s):
    """A straight line in time moves by its slope; at the file's end it has no more to read."""
    effect, values = acting(TimeSkew, skew_s=skew_s)
    found = effect.sensor(PRESSES, 5.0 + 3.0 * PRESSES.time_s, values)
    at = np.clip(PRESSES.time_s - skew_s, PRESSES.time_s[:, :1], PRESSES.time_s[:, -1:])
    np.testing.assert_allclose(found, 5.0 + 3.0 * at)


def test_a_rounded_edge_is_the_factor_of_the_law_under_all_that_was_wrapped_around_it():
    law = AnyLaw()
    stiff = StrainStiffening().law(law, {"coefficient": 1.0, "exponent": 2.0})
    effect, values = acting(PunchEdge, edge_radius_mm=0.4)
    wanted = stiff(DEPTH, H) * (1.0 - 0.04 * np.exp(-DEPTH / H))
    np.testing.assert_allclose(effect.law(stiff, values)(DEPTH, H), wanted)


@pytest.mark.parametrize("kind", [SofteningWithCycles, IncompleteRecovery], ids=lambda kind: kind.name)
def test_what_earlier_presses_do_cannot_be_seen_on_pads_that_are_pressed_once(kind):
    assert kind().untestable(history_of([0.1], [60.0])) == ""
    assert kind().untestable(history_of([], [])) == "no pad is pressed twice"


@pytest.mark.parametrize("kind", [Adhesion, FrictionHysteresis], ids=lambda kind: kind.name)
def test_what_acts_on_the_way_back_needs_a_way_back(kind):
    ways = np.zeros(3, bool)
    assert "unloading" in kind().untestable(SimpleNamespace(unloads=ways))
    ways[2] = True
    assert kind().untestable(SimpleNamespace(unloads=ways)) == ""


def test_inertia_needs_a_motion_that_brakes_and_clipping_a_top_that_is_flat():
    still = np.zeros((2, 5))
    assert "400 Hz" in Inertia().untestable(SimpleNamespace(acceleration_mm_s2=still))
    still[1, 3] = -1.0
    assert Inertia().untestable(SimpleNamespace(acceleration_mm_s2=still)) == ""
    assert SensorClipping().untestable(SimpleNamespace(flat_top_N=12.0)) == ""
    assert "largest" in SensorClipping().untestable(SimpleNamespace(flat_top_N=None))


@pytest.mark.parametrize("kind", [SensorClipping, SensorCurve], ids=lambda kind: kind.name)
def test_a_sensor_that_bends_also_begins_from_usual_arms_with_the_same_modulus(kind):
    logs = np.log([0.03, 0.006, 0.9, 140.0, 0.01])
    first, second = kind().base_starts(logs)
    np.testing.assert_array_equal(first, logs)
    np.testing.assert_allclose(np.exp(second), [0.03, 0.07, 0.3, 1.5, 0.3])
    # declared arms stay where they are, any number of them
    (only,) = kind().base_starts(np.zeros(7))
    assert len(only) == 7


def test_an_age_of_nothing_has_no_logarithm():
    law = SimpleNamespace(shape="slab", offers=frozenset())
    for age, words in ((0.0, "above 0"), (0.1, "")):
        history = replace(PRESSES.history, age_days=np.full(len(PRESSES.trials), age))
        assert words in Ageing().undefined(replace(PRESSES, history=history), law)
        assert bool(Ageing().undefined(replace(PRESSES, history=history), law)) is bool(words)
