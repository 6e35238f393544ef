"""Energy, impact of a mass and limits against mechanics that is known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.safety import ImpactBody, impact, pad_body, pad_press, tissue_body, tissue_press
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves, press_to_depth, steady_depth
from dummydesign.design.search.slabs import make_slabs
from dummydesign.pad.tables.slab import load_table
from dummydesign.resin import load_resin
from dummydesign.tissue.model.ranges import force_range
from tests.support.refusal import raises_code

RADIUS = 14.0 / math.sqrt(math.pi)


def spring(stiffness, power=1.0):
    """Bodies with F = k x^power and no inner states."""
    k = np.asarray(stiffness, float)

    return ImpactBody(len(k), 0, lambda x, q: k * np.maximum(x, 0.0) ** power, lambda x: (np.ones((len(k), 0)),) * 2)


@pytest.mark.parametrize("power", [1.0, 1.5, 3.0])
def test_a_mass_on_a_lossless_body_stops_where_its_energy_is_stored(power):
    stiffness = np.array([0.5, 4.0, 30.0])
    found = impact(spring(stiffness, power), 3.0, 200.0)
    energy = 0.5 * 3e-3 * 200.0**2
    depth = ((power + 1) * energy / stiffness) ** (1 / (power + 1))
    np.testing.assert_allclose(found.depth_mm, depth, rtol=1e-4)
    np.testing.assert_allclose(found.energy_mJ, energy, rtol=1e-4)
    np.testing.assert_allclose(found.peak_force_N, stiffness * depth**power, rtol=5e-4)


def test_a_linear_spring_stops_a_mass_after_a_quarter_of_its_period():
    found = impact(spring([2.0, 8.0]), 5.0, 100.0)
    np.testing.assert_allclose(found.stop_s, 0.5 * np.pi * np.sqrt(5e-3 / np.array([2.0, 8.0])), rtol=1e-4)


def test_a_spring_and_a_damper_stop_a_mass_as_the_damped_oscillator_says():
    """An arm much faster than a step is a damper c: q' = c v / tau - q / tau."""
    k, c, mass, tau = 4.0, 0.05, 5e-3, 1e-6
    rates = np.array([[c / tau]]), np.array([[1.0 / tau]])
    found = impact(ImpactBody(1, 1, lambda x, q: k * x + q[:, 0], lambda x: rates), 5.0, 100.0)
    omega, zeta = math.sqrt(k / mass), 0.5 * c / math.sqrt(k * mass)
    damped = omega * math.sqrt(1 - zeta**2)
    time = math.atan2(math.sqrt(1 - zeta**2), zeta) / damped
    depth = 100.0 / damped * math.exp(-zeta * omega * time) * math.sin(damped * time)
    assert found.stop_s[0] == pytest.approx(time, rel=1e-3) and found.depth_mm[0] == pytest.approx(depth, rel=1e-3)


def ode(tissue):
    """The same subjects by the law that follows any motion."""
    return tuple(replace(parameters, law="ode") for parameters in tissue.parameter_sets)


def pressed(pads, force, velocity, sampling=None):
    """Pads pressed to a steady force."""
    sampling = sampling or Sampling()
    return pad_press(pads, steady_depth(pads, force, velocity, sampling), velocity, sampling)


@pytest.fixture
def pads(layer_law):
    curves = make_curves(layer_law, [8.0, 15.0], RADIUS, 0.6)
    return make_slabs(curves, np.array([0, 1]), load_resin(), np.array([16.0, 16.0]))


@pytest.mark.slow
def test_the_mass_gives_all_its_energy_to_pad_and_tissue(pads, finger):
    found = impact(pad_body(pads), 1.5, 150.0)
    np.testing.assert_allclose(found.energy_mJ, 0.5 * 1.5e-3 * 150.0**2, rtol=2e-3)
    soft = impact(tissue_body(ode(finger), 150.0), 1.5, 150.0)
    np.testing.assert_allclose(soft.energy_mJ, 0.5 * 1.5e-3 * 150.0**2, rtol=2e-3)
    assert np.all(np.diff(soft.depth_mm) < 0) and np.all(np.diff(soft.peak_force_N) > 0)


def test_a_mass_that_the_pad_cannot_stop_has_no_depth(pads):
    assert np.isnan(impact(pad_body(pads), 50.0, 500.0).depth_mm).all()


def test_a_heavy_mass_feels_what_a_ramp_at_its_speed_feels(pads):
    one = pads.take(np.array([1]))
    body, seen = pad_body(one), []

    def force(x, q):
        value = body.force(x, q)
        seen.append((float(x[0]), float(value[0])))
        return value

    impact(ImpactBody(1, body.arms, force, body.rates), 1000.0, 250.0)
    ramp = press_to_depth(one, np.array([5.0]), 250.0, Sampling(400, 4, 4, deceleration_mm_s2=np.inf))
    depth, felt = np.array(sorted(pair for pair in seen if np.isfinite(pair[1]))).T
    time = np.array([0.004, 0.008, 0.012, 0.016])
    known = np.interp(time, ramp.time_s[0], ramp.force_N[0])
    np.testing.assert_allclose(np.interp(250.0 * time, depth, felt), known, rtol=5e-3)


def test_energy_of_a_slow_rise_is_the_area_under_the_relaxed_curve(pads):
    slow = pressed(pads, 5.0, 1e-3, Sampling(400, 24, 60))
    for index, depth in enumerate(slow.depth_mm):
        x = np.linspace(0, depth, 2001)
        force = pads.curves.area_at(np.array([index]), x[None])[0] * pads.young_MPa[index]
        assert slow.energy_mJ[index] == pytest.approx(np.trapezoid(force, x), rel=5e-3)


def test_tissue_that_is_purely_cubic_stores_a_quarter_of_force_times_depth(finger):
    for subjects, law in ((finger.parameter_sets, "consistent"), (ode(finger), "ode")):
        found = tissue_press(force_range(subjects, 10.0, 1e-2, 1000.0), law, Sampling(hold_s=1000.0))
        np.testing.assert_allclose(found.energy_mJ, 0.25 * 10.0 * found.depth_mm, rtol=0.02)


def test_a_subject_that_is_still_moving_when_the_range_ends_has_no_energy(finger):
    found = tissue_press(force_range(ode(finger), 10.0, 1e-2, 10.0))
    assert np.isnan(found.energy_mJ[0]) and np.isfinite(found.energy_mJ[-1])


def test_the_held_force_is_that_after_half_a_second(pads):
    found = pressed(pads, 10.0, 250.0)
    assert np.all(found.peak_force_N > found.held_force_N) and np.all(found.held_force_N > 10.0)


def test_faster_is_more_energy(pads, finger):
    for press in (
        lambda v: pressed(pads, 10.0, v).energy_mJ,
        lambda v: tissue_press(force_range(ode(finger), 10.0, v)).energy_mJ,
    ):
        assert np.all(press(250.0) > press(10.0))


def test_what_cannot_be_is_refused(pads, finger):
    for mass, speed, name in ((0.0, 1.0, "mass_kg"), (1.0, -1.0, "velocity_mm_s"), (math.nan, 1.0, "mass_kg")):
        with pytest.raises(InputError, match=name):
            impact(pad_body(pads), mass, speed)
    with raises_code("unsupported", "law"):
        tissue_body(finger.parameter_sets, 10.0)


@pytest.mark.parametrize("mass_kg", [0.05, 4.0, 80.0])
@pytest.mark.parametrize("velocity_mm_s", [1.0, 30.0, 1000.0])
def test_a_mass_on_a_spring_stops_where_its_energy_is_taken_at_any_speed(mass_kg, velocity_mm_s):
    stiffness = 60.0
    found = impact(spring([stiffness]), mass_kg, velocity_mm_s, longest_mm=400.0)
    wanted = velocity_mm_s * np.sqrt(1e-3 * mass_kg / stiffness)
    assert found.depth_mm[0] == pytest.approx(wanted, rel=1e-4)
    assert found.peak_force_N[0] == pytest.approx(stiffness * wanted, rel=1e-4)
    assert found.stop_s[0] == pytest.approx(0.5 * np.pi * np.sqrt(1e-3 * mass_kg / stiffness), rel=1e-3)


@pytest.mark.parametrize(
    "velocity_mm_s",
    [pytest.param(1.0, marks=pytest.mark.slow), pytest.param(10.0, marks=pytest.mark.slow), 100.0, 400.0],
)
def test_what_an_elastic_pad_stores_is_the_energy_of_the_mass(velocity_mm_s):
    curves = make_curves(load_table("bonded"), [12.0], 7.9, 0.6)
    slabs = PadBatch(curves, np.array([0]), np.array([0.03]), (), np.zeros((1, 0)))
    found = impact(pad_body(slabs), 0.5, velocity_mm_s)
    depth = np.linspace(0.0, found.depth_mm[0], 20001)
    stored = np.trapezoid(slabs.young_MPa[0] * curves.area_at(np.array([0]), depth[None])[0], depth)
    assert stored == pytest.approx(0.5e-3 * 0.5 * velocity_mm_s**2, rel=2e-3)
