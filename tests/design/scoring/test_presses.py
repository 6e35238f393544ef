"""Slab curves, their inversion, and presses on them against closed forms."""

import numpy as np
import pytest

from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves, press_to_depth, steady_depth
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from tests.support.exact_law import ExactLaw

RADIUS = 7.9


class Crown(ExactLaw):
    """F = E (1 mm^-2) d^4: bends upwards as a crowned pad does when its face is in full contact."""

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return np.asarray(young_MPa) * np.asarray(depth_mm) ** 4 * np.ones_like(np.asarray(thickness_mm))

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


class Linear(ExactLaw):
    """F = E (100 mm) d, whatever the thickness."""

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return 100.0 * np.asarray(young_MPa) * np.asarray(depth_mm) * np.ones_like(np.asarray(thickness_mm))

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


def slabs_of(law, thickness, young, tau=(), beta=()):
    curves = make_curves(law, thickness, RADIUS, 0.6)
    count = len(thickness)
    return PadBatch(
        curves,
        np.arange(count),
        np.broadcast_to(np.asarray(young, float), count),
        tuple(tau),
        np.broadcast_to(np.asarray(beta, float), (count, len(tau))),
    )


def test_depth_is_the_inverse_of_force(layer_law):
    thickness = np.array([4.0, 9.0, 25.0])
    slabs = slabs_of(layer_law, thickness, 0.03)
    depth = np.linspace(0.02, 0.58, 40) * thickness[:, None]
    force = layer_law.force(depth, thickness[:, None], 0.03, RADIUS)
    np.testing.assert_allclose(slabs.curves.depth_at(slabs.slab, force / 0.03), depth, rtol=2e-4)


def test_slope_is_that_of_the_closed_form(layer_law):
    thickness = np.array([5.0, 15.0])
    slabs = slabs_of(layer_law, thickness, 1.0)
    share = np.linspace(0.05, 0.55, 20)
    depth = share * thickness[:, None]
    area = layer_law.force(depth, thickness[:, None], 1.0, RADIUS)
    exponent = 1.0 + 2 * 1.5 * share**2 / (1.0 + 1.5 * share**2)
    np.testing.assert_allclose(
        slabs.curves.slope_at(slabs.slab, depth) * depth / area, np.broadcast_to(exponent, (2, 20)), rtol=1e-3
    )


def test_a_linear_slab_with_one_arm_follows_the_closed_form_of_a_ramp():
    slabs = slabs_of(Linear(), [20.0], 0.02, [0.5], [0.8])
    sampling = Sampling(deceleration_mm_s2=np.inf)
    press = press_to_depth(slabs, np.array([6.0]), 10.0, sampling)
    t, stop = press.time_s[0], 0.6
    rise = 2.0 * (10.0 * t + 0.8 * 10.0 * 0.5 * (1 - np.exp(-t / 0.5)))
    held = 2.0 * (6.0 + 0.8 * 5.0 * (1 - np.exp(-stop / 0.5)) * np.exp(-(t - stop) / 0.5))
    np.testing.assert_allclose(press.force_N[0], np.where(t <= stop + 1e-9, rise, held), rtol=1e-6, atol=1e-9)
    assert press.peak_N[0] == pytest.approx(rise[t <= stop + 1e-9].max())


@pytest.mark.parametrize("exact", [False, True])
def test_the_force_at_the_end_of_the_hold_is_the_one_asked_for(layer_law, exact):
    """a slow arm of 30 s has hardly relaxed after 10 s, so the depth must be smaller than the relaxed one"""
    slabs = slabs_of(layer_law, [5.0, 12.0, 20.0], 0.06, [0.1, 3.0, 30.0], [0.6, 0.2, 0.4])
    depth = steady_depth(slabs, 8.0, 10.0, Sampling(), exact)
    press = press_to_depth(slabs, depth, 10.0, Sampling())
    np.testing.assert_allclose(press.force_N[:, -1], 8.0, rtol=1e-5 if exact else 3e-3)
    assert np.all(depth < slabs.curves.depth_at(slabs.slab, np.full(3, 8.0 / 0.06)))


def test_the_quick_remainder_is_exact_when_arms_die_out(layer_law):
    slabs = slabs_of(layer_law, [5.0, 12.0], 0.03, [0.03, 0.3, 3.0], [0.6, 0.15, 0.04])
    quick, exact = (steady_depth(slabs, 5.0, 10.0, Sampling(), flag) for flag in (False, True))
    np.testing.assert_allclose(quick, exact, rtol=2e-5)


def test_what_is_out_of_reach_has_no_depth_and_no_force(layer_law):
    slabs = slabs_of(layer_law, [5.0, 20.0], 0.005, [0.3], [0.5])
    depth = steady_depth(slabs, np.array([0.5, 15.0]), 10.0)
    assert np.all(np.isfinite(depth[:, 0])) and np.all(np.isnan(depth[:, 1]))
    press = press_to_depth(slabs, depth[:, 1], 10.0, Sampling())
    assert np.all(np.isnan(press.peak_N)) and np.all(np.isnan(press.depth_mm))


def test_faster_presses_peak_higher_and_without_arms_not_at_all(layer_law):
    slabs = slabs_of(layer_law, [10.0], 0.03, [0.3], [0.5])
    peaks = [press_to_depth(slabs, np.array([4.0]), v, Sampling()).peak_N[0] for v in (1.0, 10.0, 250.0)]
    assert peaks[0] < peaks[1] < peaks[2]
    plain = slabs_of(layer_law, [10.0], 0.03)
    press = press_to_depth(plain, np.array([4.0]), 250.0, Sampling())
    assert press.peak_N[0] == pytest.approx(press.force_N[0, -1])


def test_the_depth_limit_of_the_law_wins_when_it_is_smaller():
    class Shallow(Linear):
        def depth_limit_mm(self, thickness_mm, radius_mm):
            return 0.2 * np.asarray(thickness_mm, float)

    assert make_curves(Shallow(), [10.0], RADIUS, 0.6).limit_mm[0] == pytest.approx(2.0)
    assert make_curves(Linear(), [10.0], RADIUS, 0.6).limit_mm[0] == pytest.approx(6.0)


def test_arms_of_a_press_are_those_of_the_relaxed_force_along_its_samples(layer_law):
    terms = [PronyTerm(0.02, 0.9), PronyTerm(0.4, 0.3), PronyTerm(30.0, 0.2)]
    slabs = slabs_of(layer_law, [6.0, 14.0], 0.03, [t.tau_s for t in terms], [t.beta for t in terms])
    press = press_to_depth(slabs, np.array([2.0, 5.0]), 250.0, Sampling())
    elastic = 0.03 * slabs.curves.area_at(slabs.slab, press.displacement_mm)
    np.testing.assert_allclose(press.force_N, relaxed_force(press.time_s, elastic, terms), rtol=1e-9)


@pytest.mark.parametrize("exact", [False, True])
def test_forces_and_speeds_worked_out_together_are_those_of_each_alone(layer_law, exact):
    slabs = slabs_of(layer_law, [5.0, 9.0, 20.0], [0.02, 0.06, 0.03], [0.1, 30.0], [0.6, 0.4])
    forces, speeds = np.array([0.5, 5.0, 40.0, 5.0]), np.array([10.0, 10.0, 10.0, 250.0])
    together = steady_depth(slabs, forces, speeds, Sampling(), exact)
    for column, (force, speed) in enumerate(zip(forces, speeds)):
        np.testing.assert_array_equal(together[:, column], steady_depth(slabs, force, speed, Sampling(), exact))
    assert np.isnan(together[0, 2]) and np.isfinite(together[:, [0, 1, 3]]).all()
    for row in range(3):
        alone = steady_depth(slabs.take(np.array([row])), forces, speeds, Sampling(), exact)
        np.testing.assert_array_equal(alone[0], together[row])
    some = press_to_depth(slabs, together[:, 1], np.array([10.0, 250.0, 50.0]), Sampling())
    for row, speed in enumerate((10.0, 250.0, 50.0)):
        one = press_to_depth(slabs.take(np.array([row])), together[row : row + 1, 1], speed, Sampling())
        np.testing.assert_allclose(some.force_N[row], one.force_N[0], rtol=1e-9)


def test_weights_of_the_samples_are_half_the_rise_and_half_the_hold_from_five_milliseconds(layer_law):
    slabs = slabs_of(layer_law, [10.0], 0.03, [0.3], [0.5])
    press = press_to_depth(slabs, np.array([4.0]), 10.0, Sampling())
    time, weights = press.time_s[0, press.counted], press.sample_weights[0]
    rise = time <= press.stop_s[0]
    assert weights.sum() == pytest.approx(1.0) and weights[~rise].sum() == pytest.approx(0.5, abs=0.01)
    since = time[~rise] - press.stop_s[0]
    assert np.sum(since < 0.005) <= 1 and (weights[1:] > 0.0).all()
    late = weights[~rise][since > np.sqrt(0.005 * 10.0)].sum()
    assert late == pytest.approx(0.25, abs=0.02)


@pytest.mark.parametrize("braking", [30_000.0, np.inf])
@pytest.mark.parametrize("speed", [10.0, 250.0])
def test_the_energy_of_a_press_on_the_coarse_grid_is_the_integral_of_the_curve(speed, braking):
    slabs = slabs_of(Crown(), [4.5, 20.0], 0.02)
    depth = np.array([1.1, 9.0])
    press = press_to_depth(slabs, depth, speed, Sampling(deceleration_mm_s2=braking).coarse)
    np.testing.assert_allclose(press.energy_mJ, 0.02 * depth**5 / 5.0, rtol=2e-3)


def test_a_press_out_of_reach_has_no_energy():
    slabs = slabs_of(Crown(), [4.5, 20.0], 0.02)
    press = press_to_depth(slabs, np.array([np.nan, 9.0]), 250.0, Sampling().coarse)
    assert np.isnan(press.energy_mJ).tolist() == [True, False]
