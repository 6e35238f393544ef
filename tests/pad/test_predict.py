"""Predictions of one pad: intervals from their parts, the inverse, few and many samples, finite strain, curves."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.user_library import data_folder, fill_table
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.pad import force_source, predict
from dummydesign.pad.axisymmetric import finite_strain
from dummydesign.pad.axisymmetric.finite_strain import RatioPath
from dummydesign.pad.first_touch import LowEnd, interpolate_curve, low_end
from dummydesign.pad.force_law import PadCurve, curve_at, depth_grid, slope_of
from dummydesign.pad.force_source import elastic_curve, has_square_factor
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.material.relaxation import PronyTerm, arms_in_ramp_and_hold, relaxed_force
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.predict import (
    QuickError,
    departure,
    depth_for_steady_force,
    kind_shares,
    predict_motion,
    predict_static,
    press_to_forces,
    slab_depth,
    sums_of_arms,
)
from dummydesign.pad.spatial import square_punch
from dummydesign.pad.spatial.square_punch import FactorCurve
from dummydesign.pad.tables.slab import load_table
from studies.tables.separability import grid_of, summary_of
from tests.support.refusal import raises_code

ARMS = (PronyTerm(0.02, 0.8), PronyTerm(0.4, 0.4))
COST = {"unknowns": 9, "load_steps": 2, "newton_iterations": 5, "seconds": 0.5}


def pad(**more) -> Pad:
    return Pad(**({"thickness_mm": 12.0, "young_MPa": 0.03, "radius_mm": 7.9, "prony": ARMS} | more))


def short_steps(depth: float = 2.4) -> Motion:
    """A press and hold, sampled so finely that nothing is divided."""
    time = np.concatenate([np.linspace(-0.01, 0.05, 91), 0.05 + np.geomspace(1e-3, 2.0, 30)])
    return Motion(time, np.clip(time / 0.05, -0.2, 1.0) * depth)


def test_the_interval_of_a_static_force_is_the_stated_error_and_its_exponent_the_slope():
    depth = np.array([0.0, 0.3, 2.0, 5.0])
    found, table = predict_static(pad(), depth), load_table()
    error = table.relative_error(depth, 12.0, 7.9)
    assert found.force_low_N == pytest.approx(found.force_N * (1.0 - error))
    assert found.force_high_N == pytest.approx(found.force_N * (1.0 + error)) and found.fidelity == "table"
    force, stiffness = (one(depth[1:], 12.0, 0.03, 7.9) for one in (table.force, table.stiffness))
    assert found.local_exponent[0] == pytest.approx(1.0, abs=2e-3)
    assert found.local_exponent[1:] == pytest.approx(depth[1:] * stiffness / force, abs=2e-3)
    with raises_code("out_of_range"):
        predict_static(pad(), [-0.1, 1.0])
    for wrong in ([], [np.nan], [[1.0, 2.0]]):
        with raises_code("malformed", "depth_mm"):
            predict_static(pad(), wrong)
    end = float(table.depth_limit_mm(12.0, 7.9))
    assert np.isfinite(predict_static(pad(), [end]).local_exponent).all()
    with raises_code("out_of_range", "depth_mm"):
        predict_static(pad(), [1.001 * end])


@pytest.mark.parametrize("kind", [{}, {"base": "sliding"}, {"geometry": Layered(6.0, 2.0)}])
def test_the_interval_of_a_motion_adds_the_error_of_the_curve_and_what_is_allowed_for(kind):
    own, motion = pad(**kind), short_steps()
    found = predict_motion(own, motion)
    curve = elastic_curve(own, "table")
    elastic = curve.force(motion.displacement_mm)
    force = np.maximum(relaxed_force(motion.time_s, elastic, ARMS), 0.0)
    error = force * curve.relative_error(np.maximum.accumulate(np.maximum(motion.displacement_mm, 0.0)))
    below, above = departure(
        own.base, 7.9 / 12.0, motion.displacement_mm / 12.0, motion.time_s, elastic, ARMS, own.geometry, 12.0
    )
    assert found.force_N == pytest.approx(force, abs=1e-12)
    assert found.force_high_N == pytest.approx(force + error + np.maximum(above, 0.0), abs=1e-12)
    assert found.force_low_N == pytest.approx(np.maximum(force - error + np.minimum(below, 0.0), 0.0), abs=1e-12)
    assert above.max() > 0.0 and found.peak_force_N == force.max() and found.steady_force_N == pytest.approx(force[-1])
    assert found.peak_time_s == motion.time_s[np.argmax(force)]


def test_a_motion_of_few_samples_gives_what_the_same_motion_finely_sampled_gives():
    few = Motion(np.array([0.0, 0.1, 0.2, 2.0]), np.array([0.0, 3.0, 3.0, 0.5]))
    time = np.union1d(np.linspace(0.0, 2.0, 8001), few.time_s)
    fine = Motion(time, np.interp(time, few.time_s, few.displacement_mm))
    coarse, whole = predict_motion(pad(), few), predict_motion(pad(), fine)
    at = np.searchsorted(time, few.time_s)
    assert coarse.force_N == pytest.approx(whole.force_N[at], rel=3e-4, abs=1e-9)
    assert len(coarse.force_N) == 4


def test_a_base_with_friction_allows_for_both_bases_and_a_puck_for_a_glued_slab(monkeypatch):
    asked = []

    def sums(base, ratio, depth, time, elastic, prony):
        asked.append((base, ratio))
        return np.full((2, len(time)), {"bonded": 0.2, "sliding": 0.1}[base])

    monkeypatch.setattr(predict, "sums_of_arms", sums)
    monkeypatch.setattr(predict, "kind_shares", lambda kind: np.array([[1.0, 0.0], [2.0, 0.0]]))
    curve, motion = curve_at(load_table(), 12.0, 0.03, 7.9), short_steps()
    rests = predict.motion_on_curve(pad(base="friction:0.3"), motion, curve)
    assert {base for base, _ in asked} == {"bonded", "sliding"} and asked[0][1] == pytest.approx(7.9 / 12.0)
    wide = rests.force_high_N - rests.force_N * (1.0 + curve.relative_error(np.maximum(motion.displacement_mm, 0.0)))
    assert wide == pytest.approx(np.full(len(wide), 0.6))
    asked.clear()
    predict.motion_on_curve(Puck(12.0, 0.03, 20.0, ARMS), motion, curve)
    assert asked == [("bonded", pytest.approx(10.0 / 12.0))]


def test_a_motion_solved_at_finite_strain_has_its_ratio_and_doubts_a_share_of_the_viscous_part(monkeypatch):
    asked, motion = [], short_steps()

    def solve(case, prony, time_s, depth):
        asked.append((case.radius, prony, depth.max()))
        separable = 1.0 + 0.0 * time_s
        return RatioPath(time_s, depth, separable, separable, 1.0 + 0.1 * time_s, COST | {"rim_over_scale": 0.05})

    monkeypatch.setattr(finite_strain, "solve_ratio", solve)
    quick, solved = (predict_motion(pad(), motion, fidelity) for fidelity in ("table", "viscoelastic"))
    assert asked == [(pytest.approx(7.9 / 12.0), ARMS, pytest.approx(2.4 / 12.0))]
    later = motion.time_s > 0.01
    assert solved.force_N[later] == pytest.approx((quick.force_N * (1.0 + 0.1 * motion.time_s))[later], rel=1e-4)
    curve = elastic_curve(pad(), "table")
    viscous = np.abs(quick.force_N - np.maximum(curve.force(motion.displacement_mm), 0.0))
    deepest = np.maximum.accumulate(np.maximum(motion.displacement_mm, 0.0))
    width = quick.force_N * curve.relative_error(deepest) + finite_strain.ratio_error(0.05) * viscous
    assert solved.force_high_N - solved.force_N == pytest.approx(width, abs=1e-9)
    assert solved.force_N - solved.force_low_N == pytest.approx(np.minimum(width, solved.force_N), abs=1e-9)
    twice = predict.motion_on_curve(pad(), motion, replace(curve, solver=COST), "viscoelastic").solver
    assert twice == {"unknowns": 9, "load_steps": 4, "newton_iterations": 10, "seconds": 1.0, "rim_over_scale": 0.05}


@pytest.mark.parametrize("force", [0.5, 5.0, 12.0])
def test_the_depth_for_a_steady_force_is_where_a_press_of_it_ends(force):
    def motion_to(depth):
        return ramp_and_hold(80.0, depth, 1.0)

    depth = depth_for_steady_force(pad(), force, 1.0, motion_to)
    assert predict_motion(pad(), motion_to(depth)).steady_force_N == pytest.approx(force, rel=1e-4)


def test_forces_that_no_depth_has_are_refused_and_other_faults_are_passed_on(monkeypatch):
    limit = float(load_table().depth_limit_mm(12.0, 7.9))
    most = predict_motion(pad(), ramp_and_hold(80.0, limit, 2.0)).steady_force_N
    presses = press_to_forces(pad(), [2.0, 1.1 * most], [20.0, 80.0], 2.0, 30_000.0)
    assert [one.velocity_mm_s for one in presses] == [20.0, 20.0, 80.0, 80.0]
    reached, beyond = presses[2].to_dict(), presses[3].to_dict()
    assert reached["peak_force_N"] > 1.05 * presses[0].prediction.peak_force_N > 2.0
    assert reached["force_N"][-1] == pytest.approx(2.0, rel=1e-4) and reached["depth_mm"] == presses[2].depth_mm
    assert beyond["peak_force_N"] is None and beyond["depth_mm"] is None and beyond["out_of_reach"]
    with pytest.raises(NoAnswerError) as none:
        press_to_forces(pad(), [1.1 * most], [80.0], 2.0, 30_000.0)
    assert none.value.code == "out_of_reach"
    tiny = predict_motion(pad(), ramp_and_hold(80.0, 0.001 * 12.0, 2.0)).steady_force_N
    with raises_code("out_of_range", "force_N"):
        press_to_forces(pad(), [0.95 * tiny], [80.0], 2.0, 30_000.0)
    assert press_to_forces(pad(), [1.05 * tiny], [80.0], 2.0, 30_000.0)[0].depth_mm == pytest.approx(0.0126, rel=0.01)
    fault = NoAnswerError("no_convergence", "a solve that ends", quantity="force_N")

    def failing(*words):
        raise fault

    monkeypatch.setattr(predict, "depth_for_steady_force", failing)
    with pytest.raises(NoAnswerError) as passed:
        press_to_forces(pad(), [2.0], [80.0], 2.0, 30_000.0)
    assert passed.value is fault


def test_the_end_of_a_solve_is_no_answer_and_the_end_of_a_law_a_limit():
    curve = curve_at(load_table(), 12.0, 0.03, 7.9)
    predict._check_depth(np.array([curve.limit_mm]), curve, pad())
    depth = np.array([1.0, 2.0])
    end = low_end(pad(), depth, depth, np.zeros(2))
    solved = interpolate_curve(PadCurve(depth, depth, np.zeros(2), COST, ("ends",)), end)
    faults = (2.5, solved, "no_convergence"), (7.3, solved, "out_of_range"), (7.3, curve, "out_of_range")
    for depth, of, code in faults:
        with pytest.raises((InputError, NoAnswerError)) as fault:
            predict._check_depth(np.array([0.1, depth]), of, pad())
        assert fault.value.code == code


def quick_error() -> QuickError:
    """rho = d (1 + 0.5 ln ratio + 0.25 ln rise), which is linear along every axis."""
    ratio, depth, rise = np.array([0.5, 1.0, 2.0]), np.array([0.0, 0.1, 0.4]), np.array([1.0, 4.0, 16.0])
    rho = depth[:, None] * (1.0 + 0.5 * np.log(ratio)[:, None, None] + 0.25 * np.log(rise))
    return QuickError(ratio, depth, rise, rho)


def test_the_quick_error_lies_on_straight_lines_inside_and_is_carried_on_as_stated():
    error, depth = quick_error(), np.array([0.05, 0.3])
    for ratio, rise in ((0.7, 3.0), (1.6, 9.0), (0.5, 1.0), (2.0, 16.0)):
        exact = depth * (1.0 + 0.5 * np.log(ratio) + 0.25 * np.log(rise))
        assert error.at(ratio, depth, rise) == pytest.approx(exact)
    assert error.at(9.0, depth, 99.0) == pytest.approx(error.at(2.0, depth, 16.0))
    assert error.at(0.1, depth, 0.25) == pytest.approx(0.25 * error.at(0.5, depth, 1.0))
    beyond = np.array([0.4, 0.5, 0.6])
    assert error.at(0.7, beyond, 3.0) == pytest.approx(beyond * (1.0 + 0.5 * np.log(0.7) + 0.25 * np.log(3.0)))


def test_the_quick_error_is_kept_as_a_share_of_the_viscous_force_and_must_fill_its_grid():
    error = quick_error()
    rows = [
        {
            "base": base,
            "radius_over_thickness": ratio,
            "relative_depth": depth,
            "rise_over_tau": rise,
            "viscous_share_at_peak": 0.5,
            "error_at_peak": sign * 0.5 * error.rho[i, j + 1, k],
        }
        for base, sign in (("bonded", 1.0), ("sliding", -1.0))
        for i, ratio in enumerate(error.ratio)
        for j, depth in enumerate(error.depth[1:])
        for k, rise in enumerate(error.rise)
    ]
    for base, sign in (("bonded", 1.0), ("sliding", -1.0)):
        read = fill_table(QuickError, grid_of(rows[::-1], base))
        assert read.rho == pytest.approx(sign * error.rho) and read.depth == pytest.approx(error.depth)
        assert read.ratio == pytest.approx(error.ratio) and read.rise == pytest.approx(error.rise)
    with pytest.raises(ValueError, match="grid"):
        grid_of(rows[1:], "bonded")


def test_the_shipped_grids_and_shares_are_those_of_the_shipped_rows():
    data = json.loads((data_folder() / "materials" / "tables" / predict.NAME).read_text(encoding="utf-8"))
    made = summary_of(data)
    for base, grid in made["grids"].items():
        assert all(np.array_equal(data["grids"][base][name], values) for name, values in grid.items())
    for kind, shares in made["shares"].items():
        assert data["shares"][kind] == pytest.approx(np.array(shares), rel=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sums_of_arms_are_rho_and_what_relaxes_of_every_arm_by_its_rise(monkeypatch, sign):
    """Every arm with the time from first touch to the stop over its own."""
    error = quick_error()
    error = QuickError(error.ratio, error.depth, error.rise, sign * error.rho)
    monkeypatch.setattr(predict, "load_quick_error", lambda base: error)
    time = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 2.0])
    depth = np.array([-0.1, 0.0, 0.15, 0.298, 0.3, 0.2])
    elastic = np.maximum(depth, 0.0)
    deepest, expected = np.array([0.0, 0.0, 0.15, 0.298, 0.3, 0.3]), np.zeros((2, 6))
    for arm in ARMS:
        viscous = relaxed_force(time, elastic, (arm,)) - elastic
        # 99 % of the depth count as the stop, at 0.3 s; the sample before the first inside is the touch.
        expected[0] += error.at(0.7, deepest, 0.2 / arm.tau_s) * viscous
        # of a force that rises evenly an arm keeps (1 - exp(-x)) / x of what a jump gives
        expected[1] += (1.0 - (1.0 - np.exp(-0.2 / arm.tau_s)) / (0.2 / arm.tau_s)) * viscous
    found = sums_of_arms("bonded", 0.7, depth, time, elastic, ARMS)
    assert found == pytest.approx(expected) and (sign * found[0, 2:5]).min() > 0.0
    assert np.abs(sums_of_arms("bonded", 0.7, -np.ones(6), time, elastic, ARMS)).max() < 1e-6


def test_a_shaped_pad_departs_as_the_slab_that_is_compressed_as_much_by_the_shares_of_its_kind(monkeypatch):
    bone, asked = Boned(9.0, 4.0, 6.0), []
    time = np.linspace(0.0, 1.0, 6)
    elastic = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0])
    sums = np.array([[0.0, 0.1, 0.2, 0.3, 0.2, 0.1], [0.0, 0.2, 0.2, 0.4, 0.1, 0.1]])

    def of_slab(base, ratio, depth, *rest):
        asked.append((base, ratio, depth))
        return sums

    monkeypatch.setattr(predict, "sums_of_arms", of_slab)
    monkeypatch.setattr(predict, "kind_shares", lambda kind: np.array([[2.0, -0.1], [0.3, 0.4]]))
    low, high = departure("bonded", 0.7, 0.1 * elastic, time, elastic, ARMS, bone, 12.0)
    assert 0.5 * (low + high) == pytest.approx(2.0 * sums[0] - 0.1 * sums[1])
    most = [[one[: k + 1].max() for k in range(6)] for one in sums]
    assert 0.5 * (high - low) == pytest.approx(0.3 * np.array(most[0]) + 0.4 * np.array(most[1]))
    assert asked[0][:2] == ("bonded", 0.7) and asked[0][2] == pytest.approx(0.15 * elastic)


def test_a_crown_is_compressed_by_its_mean_overlap_and_a_flat_top_over_its_gel():
    depth = np.array([0.0, 0.1, 0.3])
    assert slab_depth(Boned(9.0, 4.0, 6.0), 12.0, 0.7, depth) == pytest.approx(1.5 * depth)
    assert slab_depth(Layered(6.0, 2.0), 12.0, 0.7, depth) == pytest.approx(depth)
    # a spherical cap up to the punch's edge: mean drop (R^2 - a^2)^1.5 in closed form
    radius, thickness, sphere = 8.0, 12.0, 20.0
    cap = sphere - np.sqrt(sphere**2 - radius**2)
    mean = sphere - 2.0 * (sphere**3 - (sphere**2 - radius**2) ** 1.5) / (3.0 * radius**2)
    crown = Crowned(sphere, cap)
    deep = np.array([predict.SINK * cap / thickness, 0.4])
    found = slab_depth(crown, thickness, radius / thickness, deep)
    assert found == pytest.approx((deep * thickness - predict.SINK * mean) / (thickness - mean), rel=5e-3)
    assert slab_depth(Crowned(1e6, 1e-4), 12.0, 0.7, depth) == pytest.approx(depth, abs=1e-4)
    assert np.all(np.diff(slab_depth(crown, thickness, 0.7, depth)) > 0.0)


@pytest.mark.parametrize("kind", ["slab", "crowned", "layered", "boned", "unknown"])
def test_the_middle_of_what_was_solved_has_no_bias_and_its_ends_hold_95_percent(kind):
    data = json.loads((data_folder() / "materials" / "tables" / predict.NAME).read_text(encoding="utf-8"))
    rows = data["values"] if kind == "slab" else [row for row in data["shapes"] if kind in (row["kind"], "unknown")]
    names = ("rho_at_peak", "relaxing_at_peak", "error_at_peak")
    parts = np.array([[row[name] for name in names] for row in rows])
    middle, spread = kind_shares(kind)
    off, half = parts[:, 2] - parts[:, :2] @ middle, parts[:, :2] @ spread
    assert len(rows) >= 38 and abs(np.median(off)) < max(0.005, 0.25 * np.median(half))
    assert np.mean(np.abs(off) <= half) == pytest.approx(0.95, abs=0.02)


def test_arms_of_many_presses_at_once_are_those_of_each_alone():
    rng, hold = np.random.default_rng(5), np.array([0.05, 0.4, 3.0])
    steps = [np.full(4, 0.01), np.full(4, 0.03), np.array([0.02, 0.05, 0.01, 0.04])]
    elastic, beta = np.cumsum(rng.uniform(0.1, 1.0, (4, 4)), axis=1), rng.uniform(0.1, 1.0, (4, 2))
    found = arms_in_ramp_and_hold(steps, elastic, hold, (0.02, 0.4), beta)
    assert found.shape == (7, 4)
    for k in range(4):
        times = np.concatenate([[0.0], np.cumsum([one[k] for one in steps])])
        whole = np.concatenate([times, times[-1] + hold])
        force = np.concatenate([elastic[k], np.full(3, elastic[k, -1])])
        arms = [PronyTerm(tau, share) for tau, share in zip((0.02, 0.4), beta[k])]
        assert found[:, k] == pytest.approx(relaxed_force(whole, force, arms) - force, rel=1e-12)


def test_a_slope_is_central_inside_and_one_sided_at_the_surface_and_at_the_limit():
    def force(at):
        assert np.all((at >= 0.0) & (at <= 2.0))
        return at**2

    depth = np.array([-0.5, 0.0, 1e-3, 1.0, 2.0])
    assert slope_of(force, depth, 0.01, 2.0) == pytest.approx([0.0, 0.0, 0.011, 2.0, 3.99], abs=1e-9)


def test_the_depths_of_a_curve_are_even_and_those_asked_for_are_among_them():
    assert depth_grid(10.0, None, None) == pytest.approx(6.0 * np.arange(1, 17) / 16.0)
    asked = depth_grid(10.0, 3.0, np.array([-1.0, 0.0, 0.7, 2.9, 9.0]))
    assert {0.7, 2.9} <= set(asked) and asked.min() > 0.0 and asked.max() <= 3.0 and len(asked) == 10
    assert depth_grid(10.0, 0.01, None)[-1] == pytest.approx(0.2) and depth_grid(10.0, 99.0, None)[-1] == 6.0


@pytest.mark.parametrize("power", [1.0, 1.5])
def test_a_curve_through_solved_depths_is_exact_for_its_own_power_times_an_exponential(power):
    depth = np.array([0.5, 1.0, 2.0, 4.0])
    force = 3.0 * depth**power * np.exp(0.2 * depth)
    if power > 1.0:
        force = 3.0 * depth**power * np.exp(0.2 * np.sqrt(depth))
    end = LowEnd(0.5, float(force[0]), 0.005, None, 0.0, 0.0, 0.0, power)
    curve = interpolate_curve(PadCurve(depth, force, 0.01 * force * depth, COST, ("note",)), end)
    at = np.array([-1.0, 0.0, 0.7, 3.0, 4.0, 5.0])
    inside = np.clip(at, 0.0, 4.0)
    exact = 3.0 * inside**power * np.exp(0.2 * (inside if power == 1.0 else np.sqrt(inside)))
    assert curve.force(at) == pytest.approx(exact, rel=1e-9) and curve.limit_mm == 4.0 and curve.first_mm == 0.5
    assert curve.force(np.array([0.25])) == pytest.approx(force[:1] * 0.5**power)
    assert curve.relative_error(np.array([0.1, 1.5, 9.0])) == pytest.approx([0.005, 0.015, 0.04])
    with pytest.raises(NoAnswerError):
        force_source._through(pad(), PadCurve(depth[:1], force[:1], force[:1], COST, ("note",)))


def test_a_square_in_space_is_the_round_twin_times_its_factor_at_relative_depths(monkeypatch):
    asked = []

    def solve(block, deepest):
        asked.append((block, deepest))
        return FactorCurve(np.array([0.1, 0.5]), np.zeros(2), np.zeros(2), 0.6, {0.2: 0.6}, {}, 0.0, 0.0, COST)

    twin = curve_at(load_table(), 10.0, 0.03, 7.9)
    monkeypatch.setattr(square_punch, "solve_factor", solve)
    monkeypatch.setattr(force_source, "_by_elements", lambda pad, deepest, depths: twin)
    own = Pad(10.0, 0.03, 7.9, sides_mm=(14.0, 10.0), slab_mm=(150.0, 120.0))
    curve, depth = elastic_curve(own, "3d", 2.0), np.array([0.5, 2.0])
    assert curve.force(depth) == pytest.approx(twin.force(depth) * np.exp(0.1 + 0.05 * depth))
    assert np.all(curve.relative_error(depth) > twin.relative_error(depth)) and curve.solver["unknowns"] == 9
    block, deepest = asked[0]
    assert block.half_sides == pytest.approx((0.7, 0.5)) and block.half_extents == pytest.approx((7.5, 6.0))
    assert deepest == pytest.approx(0.2)
    elastic_curve(own, "3d")
    elastic_curve(own, "3d", 99.0)
    assert [one for _, one in asked[1:]] == pytest.approx([twin.limit_mm / 10.0] * 2)


def test_depths_that_are_asked_for_are_solved_whatever_the_face_does(monkeypatch):
    asked = []

    def solve(pad, depth_mm):
        asked.append(depth_mm)
        return PadCurve(depth_mm, 2.0 * depth_mm, 0.01 * depth_mm, COST)

    monkeypatch.setattr(force_source, "solve_points", solve)
    wanted = np.array([0.05, 0.1, 0.2, 1.0, 4.0])
    for condition in ("bonded", "frictionless", "friction:0.3"):
        curve = elastic_curve(Pad(10.0, 0.03, 7.9, condition=condition), "axisymmetric", 4.0, wanted)
        assert set(wanted) <= set(asked[-1]) and asked[-1].max() == 4.0
        assert curve.force(np.array([2.0])) == pytest.approx([4.0])
    curve = elastic_curve(Pad(10.0, 0.03, 7.9, condition="frictionless"), "axisymmetric", 0.2, np.array([1e-5, 0.2]))
    # What is too shallow to be solved is by the law of first touch.
    assert asked[-1].min() >= 1e-3 and curve.force(np.array([1e-5])) == pytest.approx([2e-5])


@pytest.mark.parametrize(
    ("change", "has"),
    [
        ({}, True),
        ({"sides_mm": (14.0, 12.0)}, False),
        ({"sides_mm": None}, False),
        ({"base": "sliding"}, True),
        ({"edge_radius_mm": 0.5}, True),
        ({"law": Yeoh(1.0, 0.1)}, False),
        ({"poisson": 0.49}, False),
        ({"condition": "frictionless"}, False),
        ({"thickness_mm": 60.0}, False),
        ({"thickness_mm": 2.0}, False),
    ],
)
def test_a_square_has_its_tabulated_factor_where_base_law_and_proportion_are_in_the_table(change, has):
    assert has_square_factor(pad(**({"thickness_mm": 10.0, "sides_mm": (14.0, 14.0)} | change))) == has


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"base": "sliding", "geometry": Crowned(20.0, 2.0)}, "not_tabulated"),
        ({"edge_radius_mm": 0.5, "geometry": Crowned(20.0, 2.0)}, "not_tabulated"),
        ({"poisson": 0.49}, "not_tabulated"),
        ({"condition": "frictionless"}, "not_tabulated"),
    ],
)
def test_what_no_table_has_is_refused_by_the_table(change, code):
    with raises_code(code):
        elastic_curve(pad(**change), "table")
