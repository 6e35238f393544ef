"""A tissue that is one spring constant: closed forms at rest and in motion, and designs scored by its ranges."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.measured_pad import verdict_of_traces
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves
from dummydesign.design.scoring.score import evaluate, steady_gamma1
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import deviations, ranges_of, readings_of
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.person.free_mass import stop_mass
from dummydesign.person.people import People
from dummydesign.tissue.adding.from_springs import spring_tissue
from dummydesign.tissue.comparison import compare_traces
from dummydesign.tissue.fitting.fit import fit_traces
from tests.support.exact_law import ExactLaw
from tests.support.judged_pads import judged

K = 10.0


@pytest.fixture(scope="module")
def spring():
    return spring_tissue("arm", K, "20%", "made up for a test", "assumed")


class Linear(ExactLaw):
    """F = E (1 mm) d: with E in MPa a pad whose spring constant in N/mm is E."""

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return np.asarray(young_MPa) * np.asarray(depth_mm) * np.ones_like(np.asarray(thickness_mm))

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.6 * np.asarray(thickness_mm, float)


def linear_pads(springs, beta=1e-9):
    count = len(springs)
    curves = make_curves(Linear(), [10.0], 7.9, 0.6)
    return PadBatch(curves, np.zeros(count, int), np.asarray(springs, float), (0.3,), np.full((count, 1), beta))


def test_force_is_k_times_depth_in_any_motion_and_steady_depth_is_force_over_k(spring):
    motion = ramp_and_hold(100.0, 1.5, hold_s=1.0)
    np.testing.assert_allclose(spring.parameter_sets[1].force(motion, 100.0), K * motion.displacement_mm, rtol=1e-12)
    stiff, soft = spring.steady_depth_range([5.0, 10.0])
    np.testing.assert_allclose([stiff, soft], [[5 / 12, 10 / 12], [5 / 8, 10 / 8]])


def test_peaks_are_the_steady_force_and_energies_those_of_a_spring_at_every_speed_and_hold(spring):
    for hold in (0.5, 10.0):
        targets = make_targets(spring, "average", Sampling(hold_s=hold))
        assert targets.settled and targets.power == 1.0
        for condition in targets.conditions:
            force = condition.steady_force_N
            assert condition.range.peak_low_N == pytest.approx(force) == condition.range.peak_high_N
            half = 0.5 * force**2
            np.testing.assert_allclose(condition.energy_mJ, (half / (1.2 * K), half / (0.8 * K)), rtol=2e-3)


def test_a_pad_that_is_the_spring_is_inside_and_one_half_as_stiff_reads_low(spring):
    targets = make_targets(spring, "average", Sampling())
    slabs = linear_pads([K, 0.5 * K, 2.0 * K])
    np.testing.assert_allclose(steady_gamma1(slabs, power=1.0), [10, 5, 20], rtol=1e-3)
    found = evaluate(slabs, targets)
    own, softer, stiffer = judged(ranges_of(targets), readings_of(found))
    assert own == ("stands_for", "inside")
    assert softer[0] == "reads_low" and stiffer[0] in ("reads_low", "over")
    away = deviations(ranges_of(targets), readings_of(found))
    np.testing.assert_allclose(away.short["steady"][1], 0.8 / 0.5, rtol=2e-3)
    np.testing.assert_allclose(away.above["steady"][2], 2.0 / 1.2, rtol=2e-3)
    # at the same force a stiffer spring takes less energy
    np.testing.assert_allclose(away.short["energy"][2], 2.0 / 1.2, rtol=2e-2)
    np.testing.assert_allclose(away.above["energy"][1], 0.8 / 0.5, rtol=2e-2)
    assert found.aim[0] > 0.99 and found.steady_state_range[0] == 1.0 and found.low_force_range[0] == 1.0
    assert found.steady_state_range[1] == found.steady_state_range[2] == 0.0


def test_the_safe_side_of_a_spring_is_a_shortfall_in_proportion_to_stiffness(spring):
    targets = make_targets(spring, "safe-side", Sampling())
    pads = readings_of(evaluate(linear_pads([12.0, 9.0]), targets))
    found = deviations(dataclasses.replace(ranges_of(targets), strict=True), pads)
    np.testing.assert_allclose(found.shortfall, [1.0, 12.0 / 9.0], rtol=0.01)


def test_a_free_mass_is_stopped_by_a_spring_at_v_times_the_root_of_m_k(spring):
    found = stop_mass(People.of(spring.parameter_sets, 100.0), 2.0, np.full(3, 100.0))
    # 2 kg at 0.1 m/s on N/mm: F = v sqrt(m k)
    wanted = [0.1 * np.sqrt(2.0 * 1000.0 * k) for k in (8.0, 10.0, 12.0)]
    np.testing.assert_allclose(found.peak_N, wanted, rtol=2e-3)


@pytest.mark.slow
def test_traces_are_compared_with_a_spring_by_ranges_alone_and_no_law_is_fitted_for_it(spring):
    traces = []
    for v in (10.0, 250.0):
        for force in (5.0, 15.0):
            motion = ramp_and_hold(v, force / K)
            traces.append(Trace(f"{v:g}-{force:g}", motion.time_s, motion.displacement_mm, K * motion.displacement_mm))
    found = compare_traces(traces, spring)
    assert found.result["parametric"] == {} and found.result["steady_state_range"]["above_5N_fraction"] == 1.0
    said = verdict_of_traces(found, spring)
    assert said.light != "red" and said.reads == "inside" and said.peaks_below == said.peaks_above == 0
    assert "spring_tissue" in [warning["code"] for warning in found.result["warnings"]]
    softer = [dataclasses.replace(trace, force_N=0.5 * trace.force_N) for trace in traces]
    low = verdict_of_traces(compare_traces(softer, spring), spring)
    assert low.level == "not_representative" and low.shortfall.quantity == "steady" and low.shortfall.central > 1.5
    with pytest.raises(InputError, match="law = spring is not fitted to traces"):
        fit_traces(traces, 5, "spring")
