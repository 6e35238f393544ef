"""Dynamic predictions: the finite-strain ratio, the allowance for the separable law, and their limits."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.core.user_library import data_folder
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.pad.axisymmetric.finite_strain import nodes_of_motion
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import load_quick_error, predict_motion, predict_static, sums_of_arms
from dummydesign.pad.tables.slab import load_table
from studies.tables.separability import RADIUS_MM
from tests.support.refusal import raises_code

ARMS = (PronyTerm(0.02, 0.8), PronyTerm(0.4, 0.4))


def pad(thickness=12.0, prony=ARMS, **kwargs):
    return Pad(thickness, 0.03, RADIUS_MM, prony, **kwargs)


@pytest.fixture(scope="module")
def press():
    return ramp_and_hold(80.0, 0.28 * 12.0, 2.0)


@pytest.fixture(scope="module")
def quick(press):
    return predict_motion(pad(), press)


@pytest.fixture(scope="module")
def solved(press):
    return predict_motion(pad(), press, "viscoelastic")


@pytest.mark.slow
def test_the_finite_strain_force_lies_in_the_interval_of_the_quick_one(quick, solved):
    """A pad, speed and set of arms that were not among those measured, at all times of a press and hold."""
    moving = quick.time_s > 0.2 * quick.peak_time_s
    assert np.all(solved.force_N[moving] <= quick.force_high_N[moving] * 1.001)
    assert np.all(solved.force_N[moving] >= quick.force_low_N[moving] * 0.999)


@pytest.mark.slow
def test_the_quick_force_is_too_low_at_the_peak_and_right_at_the_end_of_the_hold(quick, solved):
    assert 1.01 < solved.peak_force_N / quick.peak_force_N < 1.1
    assert solved.steady_force_N == pytest.approx(quick.steady_force_N, rel=3e-3)
    assert solved.fidelity == "viscoelastic"
    assert solved.solver["newton_iterations"] > 0


@pytest.mark.slow
def test_the_interval_of_the_solved_force_is_narrower(quick, solved):
    width = [found.force_high_N - found.force_low_N for found in (quick, solved)]
    peak = int(np.argmax(quick.force_N))
    assert width[1][peak] < 0.75 * width[0][peak]


@pytest.mark.slow
def test_without_relaxation_quick_and_finite_strain_are_the_same_to_the_last_bit():
    motion = ramp_and_hold(50.0, 1.2, 0.5)
    for prony in ((), (PronyTerm(0.1, 0.0),)):
        quick, solved = (predict_motion(pad(prony=prony), motion, fidelity) for fidelity in ("table", "viscoelastic"))
        assert np.array_equal(quick.force_N, solved.force_N)


def test_the_allowance_vanishes_with_the_arms_and_grows_with_them(press, quick):
    none = predict_motion(pad(prony=()), press)
    weak = predict_motion(pad(prony=tuple(PronyTerm(a.tau_s, 0.1 * a.beta) for a in ARMS)), press)
    peak = int(np.argmax(quick.force_N))
    above = [(found.force_high_N - found.force_N)[peak] / found.force_N[peak] for found in (none, weak, quick)]
    assert above[0] < above[1] < above[2]


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_arms_add_up_to_what_was_measured_for_whole_sets_of_arms(base):
    """The stored peaks of two sets of arms at 10, 50 and 250 mm/s are the sum over single arms by less than a tenth."""
    data = json.loads((data_folder() / "materials" / "tables" / "quick-error.json").read_text())
    rows = [row for row in data["values"] if row["base"] == base]
    found, solved = [], np.array([row["error_at_peak"] for row in rows])
    for row in rows:
        depth = row["relative_depth"] * row["thickness_mm"]
        motion = ramp_and_hold(row["velocity_mm_s"], depth)
        elastic = load_table(base).force(motion.displacement_mm, row["thickness_mm"], 0.025, RADIUS_MM)
        arms = tuple(PronyTerm(**arm) for arm in data["arms"][row["arms"]])
        place = row["radius_over_thickness"], motion.displacement_mm / row["thickness_mm"]
        above = sums_of_arms(base, *place, motion.time_s, elastic, arms)[0]
        force = relaxed_force(motion.time_s, elastic, arms)
        found.append(above[np.argmax(force)] / force.max())
        assert row["rho_at_peak"] == pytest.approx(found[-1], abs=1e-3)
    assert len(rows) >= 48
    assert np.dot(found, solved) / np.dot(found, found) == pytest.approx(1.0, abs=0.1)


def test_the_error_grows_with_depth_and_with_the_rise_and_is_held_at_the_ends():
    error = load_quick_error()
    depth = np.array([0.0, 0.1, 0.3, 0.45, 0.55])
    rho = error.at(0.6, depth, 10.0)
    assert rho[0] == 0.0
    assert np.all(np.diff(rho) > 0.0)
    slow, fast = error.at(0.6, depth, 1000.0), error.at(0.6, depth, 0.01)
    assert np.all(fast[1:] < rho[1:]) and np.all(rho[1:] < slow[1:])
    assert error.at(0.01, depth, 5.0) == pytest.approx(error.at(error.ratio[0], depth, 5.0))


def test_nodes_follow_the_motion_and_thin_the_hold():
    motion = ramp_and_hold(100.0, 4.0, 10.0, ramp_points=2000, hold_points=4000)
    time, depth = nodes_of_motion(motion.time_s, motion.displacement_mm / 10.0, ARMS)
    assert depth[0] == 0.0 and time[-1] == motion.time_s[-1]
    assert np.all(np.diff(time) > 0.0)
    assert len(time) < 120
    back = np.interp(motion.time_s, time, depth)
    after = motion.displacement_mm > 0.01
    assert np.abs(back - motion.displacement_mm / 10.0)[after].max() < 1e-3
    assert np.diff(depth).max() < 0.0201


def test_a_motion_that_starts_in_the_pad_or_far_above_it_is_followed():
    inside = nodes_of_motion(np.array([0.0, 1.0]), np.array([0.1, 0.1]), ARMS)
    assert inside[1][0] == 0.0 and inside[1][1] == 0.1 and inside[0][0] < 0.0
    above = nodes_of_motion(np.array([0.0, 1.0, 2.0, 3.0]), np.array([-0.3, -0.1, 0.1, 0.1]), ARMS)
    assert above[0][0] == 1.0 and above[1].min() == 0.0


def test_another_law_gets_its_elastic_force_from_elements():
    motion = ramp_and_hold(50.0, 1.0, 0.2)
    with raises_code("not_tabulated", "law"):
        predict_motion(pad(law=Yeoh(1.0, 0.02)), motion)


def test_static_depths_have_no_relaxation():
    with raises_code("not_applicable", "fidelity"):
        predict_static(pad(), [1.0], "viscoelastic")


def test_a_damaged_file_names_the_command_that_makes_it(monkeypatch, tmp_path):
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    load_quick_error.cache_clear()
    with raises_code("table_unavailable", "table"):
        load_quick_error()
    load_quick_error.cache_clear()


def test_times_without_contact_have_no_allowance():
    motion = Motion(np.array([0.0, 0.5, 1.0, 2.0]), np.array([-2.0, 0.0, 1.0, 1.0]))
    found = predict_motion(pad(), motion)
    assert found.force_high_N[0] == 0.0 and found.force_low_N[1] == 0.0
