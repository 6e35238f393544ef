"""Scores: perfect for a pad that is the tissue, monotone, honest about what is out of reach."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.scoring.law_parameters import _Problem, fit_presses, parametric_score
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, SimulatedPress, make_curves, press_to_depth
from dummydesign.design.scoring.score import evaluate, evaluated_gamma1, steady_gamma1
from dummydesign.design.scoring.targets import make_targets
from dummydesign.measurement.motion import ramp_and_hold
from tests.support.exact_law import ExactLaw
from tests.support.slab_by_formula import make_tissue


class Cubic(ExactLaw):
    """F = E (1 / mm) d^3 / 1 mm2: with E in MPa a pad whose gamma1 in N/mm3 is E."""

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return np.asarray(young_MPa) * np.asarray(depth_mm) ** 3 * np.ones_like(np.asarray(thickness_mm))

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


def cubic_slabs(gamma1, thickness=10.0):
    curves = make_curves(Cubic(), [thickness], 7.9, 0.6)
    count = len(gamma1)
    return PadBatch(curves, np.zeros(count, int), np.asarray(gamma1, float), (0.3,), np.full((count, 1), 0.7))


@pytest.fixture(scope="module")
def targets(finger):
    return make_targets(finger, "average", Sampling())


def test_a_cubic_pad_inside_the_band_is_wholly_inside_and_one_outside_not_at_all(targets):
    found = evaluate(cubic_slabs([0.5, 0.9, 1.4, 2.1, 3.0]), targets)
    np.testing.assert_array_equal(found.steady_state_range, [0, 1, 1, 1, 0])
    np.testing.assert_array_equal(found.low_force_range, [0, 1, 1, 1, 0])


def test_closeness_to_the_aim_falls_on_both_sides_of_it(targets):
    gamma1 = np.array([0.7, 1.0, targets.parameters.gamma1_N_per_mm3, 2.0, 2.8])
    slabs = cubic_slabs(gamma1)
    depth = slabs.curves.depth_at(slabs.slab, 10.0 / gamma1)
    close = evaluate(slabs, targets).aim
    assert close[0] < close[1] < close[2] > close[3] > close[4]
    assert depth[2] == pytest.approx(targets.aim_depth_mm(10.0), rel=1e-3)


def test_a_pad_on_the_aim_in_depth_and_peak_is_wholly_close_and_one_off_in_either_in_part(targets):
    gamma1 = targets.parameters.gamma1_N_per_mm3
    found = evaluate(cubic_slabs([gamma1]), targets)
    pressed = list(zip(targets.conditions, found.presses))
    for factor, aim in ((1.0, 1.0), (1e6, 0.5)):
        peaks = [
            replace(one, aim=SimpleNamespace(peak_high_N=factor * float(press.peak_N[0]))) for one, press in pressed
        ]
        aimed = evaluate(found.slabs, replace(targets, conditions=tuple(peaks)))
        assert aimed.aim[0] == pytest.approx(aim, abs=0.01)


def test_gamma1_of_an_evaluation_is_that_of_the_designs():
    slabs = cubic_slabs([0.5, 0.9, 1.4, 2.1, 3.0, 1e-3])
    other = make_targets(make_tissue(), "safe-side", Sampling())
    np.testing.assert_array_equal(evaluated_gamma1(evaluate(slabs, other)), steady_gamma1(slabs))


def test_what_is_out_of_reach_counts_as_zero_and_not_as_missing(targets):
    deep, shallow = (evaluate(cubic_slabs([1.3], thickness), targets) for thickness in (10.0, 3.0))
    assert np.isnan(shallow.depth_mm).any() and not shallow.feasible[0]
    assert shallow.steady_state_range[0] < deep.steady_state_range[0] == 1.0
    assert shallow.force_variation_range[0] < deep.force_variation_range[0]
    assert shallow.aim[0] < deep.aim[0]


def test_the_quick_share_of_the_map_agrees_with_the_definition_of_the_tissue(layer_law, targets):
    rng = np.random.default_rng(2)
    curves = make_curves(layer_law, rng.uniform(3.5, 12.0, 40), 7.9, 0.6)
    beta = rng.uniform(0.05, 0.9, (40, 3))
    slabs = PadBatch(curves, np.arange(40), rng.uniform(0.01, 0.08, 40), (0.03, 0.3, 3.0), beta)
    quick, exact = evaluate(slabs, targets), evaluate(slabs, targets, Sampling(), exact=True)
    difference = quick.force_variation_range - exact.force_variation_range
    assert np.abs(difference).max() < 0.08 and np.abs(difference.mean()) < 0.02
    np.testing.assert_array_equal(quick.steady_state_range, exact.steady_state_range)


@pytest.mark.parametrize("law", ["consistent", "ode"])
def test_parameters_are_recovered_from_presses_that_follow_the_law(law):
    tissue = make_tissue(law=law)
    targets = make_targets(tissue, "average", Sampling())
    truth = tissue.subjects[2].parameters
    sampling = Sampling(16, 8, 24)
    presses = []
    for condition in targets.conditions:
        depth = np.cbrt(condition.steady_force_N / truth.gamma1_N_per_mm3)
        motion = ramp_and_hold(
            condition.velocity_mm_s, np.array([depth]), ramp_points=16, brake_points=8, hold_points=24
        )
        force = truth.force(motion, condition.velocity_mm_s)
        stop, x = motion.time_s[:, 24], motion.displacement_mm
        presses.append(SimulatedPress(motion.time_s, force, stop, np.array([depth]), x, 24))
    problem = _Problem(presses, sampling, targets, np.array([0, 0, 0, 1, 1, 1]))
    rates = problem.solve()
    springs = problem.fit(problem.responses(rates))[0][0]
    wanted = [truth.gamma1_N_per_mm3, *truth.gamma_N_per_mm3]
    np.testing.assert_allclose(springs, wanted, rtol=0.02)
    dampers = springs[1:] / rates[0]
    np.testing.assert_allclose(dampers, [truth.dampers_at(10.0), truth.dampers_at(250.0)], rtol=0.02)


def test_a_pad_without_relaxation_has_gamma1_of_its_steady_curve(targets):
    slabs = PadBatch(
        make_curves(Cubic(), [10.0], 7.9, 0.6), np.zeros(2, int), np.array([0.9, 1.6]), (), np.zeros((2, 0))
    )
    np.testing.assert_allclose(steady_gamma1(slabs), [0.9, 1.6], rtol=1e-3)
    found = fit_presses(slabs, targets, evaluate(slabs, targets).depth_mm, Sampling())
    np.testing.assert_allclose([p.gamma1_N_per_mm3 for p in found], [0.9, 1.6], rtol=0.01)


def test_parameters_at_the_aim_score_one_and_half_a_band_away_one_half(finger, targets):
    assert parametric_score([targets.parameters], targets)[0] == pytest.approx(1.0)

    shift = np.sqrt(2.2 / 0.8)  # half of the band of gamma1 in the logarithm
    moved = replace(targets.parameters, gamma1_N_per_mm3=shift * targets.parameters.gamma1_N_per_mm3)
    assert parametric_score([moved], targets)[0] == pytest.approx((6 + 0.5) / 7)
    assert parametric_score([None], targets)[0] == 0.0


def test_peaks_are_those_of_the_presses(layer_law, targets):
    curves = make_curves(layer_law, [6.0], 7.9, 0.6)
    slabs = PadBatch(curves, np.array([0]), np.array([0.04]), (0.3,), np.array([[0.5]]))
    found = evaluate(slabs, targets, Sampling(), exact=True)
    press = press_to_depth(slabs, found.depth_mm[:, 1], 10.0, Sampling())
    assert found.presses[1].peak_N[0] == pytest.approx(press.peak_N[0])
    assert found.presses[1].force_N[0, -1] == pytest.approx(10.0, rel=1e-5)
