"""The fit: recovery from an independent integrator's traces, coverage of intervals, and what is said."""

import numpy as np
import pytest

from benchmarks.accuracy.fit_coverage import DAMPER, GAMMA, GAMMA1, TRUTH, coverage, press
from dummydesign.inference.least_squares import covariance, solve
from dummydesign.inference.noise import Noise, whitener
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.fit import fit_traces, subject_from_fit
from dummydesign.tissue.fitting.problem import TissueProblem
from dummydesign.tissue.fitting.reduction import between, reduce_trace, speed_groups
from dummydesign.tissue.model.maxwell_law import law_named
from tests.support.refusal import raises_code

SIX = [(v, f) for v in (10.0, 250.0) for f in (5.0, 10.0, 15.0)]


def noisy(trace, seed, white_N=0.03):
    noise = np.random.default_rng(seed).normal(size=len(trace.time_s)) * white_N
    return Trace(trace.name, trace.time_s, trace.displacement_mm, trace.force_N + noise)


def values(fit):
    return np.array([entry["value"] for entry in fit.result["parameters"].values()])


@pytest.fixture(scope="module")
def clean():
    return [press(v, np.cbrt(f / GAMMA1)) for v, f in SIX]


def test_parameters_come_back_from_another_integrators_traces(clean):
    fit = fit_traces(clean, 5)
    assert values(fit) == pytest.approx(TRUTH, rel=2e-3)
    assert fit.result["rmse_N"] < 5e-3
    assert list(fit.result["parameters"]) == law_named("ode").parameter_names(5)
    assert fit.result["starts"]["same_optimum"] >= 2


@pytest.mark.slow
def test_intervals_hold_the_truth_and_shrink_with_the_noise(clean):
    widths = []
    for white in (0.02, 0.2):
        fit = fit_traces([noisy(trace, k, white) for k, trace in enumerate(clean)], 5)
        for truth, entry in zip(TRUTH, fit.result["parameters"].values()):
            sd = (entry["high"] - entry["low"]) / 3.92
            assert abs(entry["value"] - truth) < 4 * sd + 1e-3 * truth
            assert entry["low"] < entry["value"] < entry["high"]
        entry = fit.result["parameters"]["gamma3_N_per_mm3"]
        widths.append(entry["high"] - entry["low"])
    assert 5 < widths[1] / widths[0] < 20


@pytest.mark.slow
def test_ninety_five_percent_intervals_hold_the_truth_in_white_and_in_slow_noise():
    for slow, draws in ((0.0, 24), (0.05, 40)):
        held = coverage(draws, 20261121, slow, life_s=0.3)
        # 0.95 less three standard deviations, the five intervals of a draw counted as one
        assert held.mean() > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / draws)


def test_the_motion_between_samples_hardly_biases_the_fast_arm(clean):
    """Without noise, in the standard deviations that 0.03 N of white noise leaves; chords biased c3 by 0.63."""
    problem = TissueProblem("ode", [[reduce_trace(trace) for trace in clean]], None)
    factor = whitener(problem.bins.covariance(Noise(0.03, 1e-4, 0.5, 0.0), np.zeros_like(problem.bins.start)))
    model, (low, high) = problem.model(2, factor), problem.box(2)
    found = solve(model, [np.log(TRUTH)], low, high).parameters
    spread = np.sqrt(np.diag(covariance(model(found)[1])))
    assert np.max(np.abs(found - np.log(TRUTH)) / spread) < 0.25


def test_the_motion_between_samples_is_exact_in_braking_and_does_not_overshoot_an_abrupt_stop():
    time = np.linspace(0.0, 0.008, 9)
    fine = np.linspace(0.0, 0.008, 81)
    assert between(fine, time, 2.0 * time - 125.0 * time**2) == pytest.approx(2.0 * fine - 125.0 * fine**2, abs=1e-12)
    stopped = np.minimum(time, 0.004)
    assert np.max(between(fine, time, stopped)) <= 0.004 + 1e-15
    assert np.all(np.diff(between(fine, time, stopped)) >= -1e-15)
    assert between(time, time, stopped) == pytest.approx(stopped, abs=1e-15)


@pytest.mark.slow
def test_coverage_over_many_draws_is_near_ninety_five_percent():
    """The whole study: python -m benchmarks.accuracy.fit_coverage"""
    for slow, life in ((0.0, 1.0), (0.02, 1.0), (0.05, 0.1)):
        held = coverage(300, 5, slow, life_s=life)
        assert np.all(held > 0.90) and held.mean() > 0.92


@pytest.mark.slow
@pytest.mark.parametrize("arms", [1, 2, 3])
def test_aicc_finds_the_number_of_elements(arms):
    gamma = np.array([0.03, 0.11, 0.3])[-arms:]
    damper = np.array([1.2, 0.08, 0.006])[-arms:]
    truth = np.r_[GAMMA1, gamma, damper]
    traces = [noisy(press(v, np.cbrt(f / GAMMA1), truth=truth), k) for k, (v, f) in enumerate(SIX)]
    fit = fit_traces(traces, "auto", intervals=False)
    assert fit.result["elements"] == 1 + 2 * arms
    table = fit.result["comparison"]
    assert set(table) == {"3", "5", "7"}
    if arms > 1:
        assert table["3"]["heldout_rmse_N"] > 3 * table[str(fit.result["elements"])]["heldout_rmse_N"]


@pytest.mark.slow
def test_dampers_that_differ_by_speed_are_found_by_the_fit_per_speed():
    slow, fast = np.r_[GAMMA1, GAMMA, 3 * DAMPER], TRUTH
    traces = [press(v, np.cbrt(f / GAMMA1), truth=slow if v < 50 else fast) for v, f in SIX]
    fit = fit_traces([noisy(t, k) for k, t in enumerate(traces)], 5, mode="per-speed")
    c3 = fit.result["parameters"]["c3_N_s_per_mm"]
    assert c3["10"]["value"] == pytest.approx(3 * DAMPER[1], rel=0.02)
    assert c3["250"]["value"] == pytest.approx(DAMPER[1], rel=0.02)
    assert fit.result["by_speed"]["250"]["c3_N_s_per_mm"] == c3["250"]
    assert set(fit.result["by_speed"]["10"]) == set(law_named("ode").parameter_names(5))
    joint = fit_traces(traces, 5, intervals=False)
    assert joint.result["rmse_N"] > 10 * fit.result["rmse_N"] / 3
    assert any(w["code"] == "lack_of_fit" for w in joint.result["warnings"])


@pytest.mark.slow
def test_the_fit_per_condition_lists_conditions_and_their_mean(clean):
    fit = fit_traces(clean, 5, mode="per-condition", intervals=False)
    rows = fit.result["by_condition"]
    assert [(r["velocity_mm_s"], round(r["steady_force_N"])) for r in rows] == [(v, round(f)) for v, f in SIX]
    for row in rows:
        assert row["parameters"]["gamma1_N_per_mm3"]["value"] == pytest.approx(GAMMA1, rel=5e-3)
    mean = fit.result["parameters"]["c2_N_s_per_mm"]
    assert mean["value"] == pytest.approx(np.mean([r["parameters"]["c2_N_s_per_mm"]["value"] for r in rows]))
    assert mean["low"] is None and "mean over conditions" in mean["reason"]


@pytest.mark.slow
@pytest.mark.parametrize("law", ["consistent", "published"])
def test_the_printed_laws_are_fitted_back_from_their_own_curves(law):
    traces = []
    for v, f in SIX:
        motion = ramp_and_hold(v, np.cbrt(f / GAMMA1), 10.0, np.inf)
        time_s = np.arange(0.0, motion.time_s[-1], 1e-3)
        time_s = np.union1d(time_s, [motion.time_s[60]])
        x = np.interp(time_s, motion.time_s, motion.displacement_mm)
        curve = law_named(law).force(Motion(time_s, x), GAMMA1, GAMMA, DAMPER)
        traces.append(Trace(f"{v}_{f}.csv", time_s, x, curve))
    fit = fit_traces(traces, 5, law)
    assert values(fit) == pytest.approx(TRUTH, rel=0.02)
    assert any(w["code"] == "ideal_ramp" for w in fit.result["warnings"])


@pytest.mark.slow
def test_the_declared_sensor_filter_is_part_of_the_model(clean):
    filtered = [
        Trace(t.name, t.time_s, t.displacement_mm, Lowpass(35.0).apply(t.time_s, t.force_N)) for t in clean[1::2]
    ]
    fit = fit_traces(filtered, 5, lowpass=Lowpass(35.0), intervals=False)
    assert values(fit) == pytest.approx(TRUTH, rel=5e-3)
    blind = fit_traces(filtered, 5, intervals=False)
    assert abs(values(blind)[4] / TRUTH[4] - 1) > 0.03
    assert blind.result["max_residual_N"] > 10 * fit.result["max_residual_N"]


@pytest.mark.slow
def test_the_motion_is_followed_as_measured_with_wander_steps_and_uneven_sampling():
    traces = []
    for k, (v, f) in enumerate(SIX):
        motion = ramp_and_hold(v, np.cbrt(f / GAMMA1), 10.0, 8_000.0, 300, 200, 200)
        stop = motion.time_s[-1] - 10.0
        time_s = np.r_[np.arange(-0.05, stop + 0.4, 1e-3), np.arange(stop + 0.4, stop + 10.0, 0.02)]
        x = np.where(time_s < 0, v * time_s, np.interp(time_s, motion.time_s, motion.displacement_mm))
        x = x + 0.01 * np.sin(2 * np.pi * 0.3 * time_s + k) * np.clip(time_s / stop, 0, 1)
        curve = law_named("ode").force(Motion(time_s, x), GAMMA1, GAMMA, DAMPER)
        traces.append(noisy(Trace(f"{v}_{f}.csv", time_s, np.round(x / 0.005) * 0.005, curve), k))
    fit = fit_traces(traces, 5)
    for truth, entry in zip(TRUTH, fit.result["parameters"].values()):
        assert entry["value"] == pytest.approx(truth, rel=0.01)


@pytest.mark.slow
def test_what_comes_after_the_hold_does_not_matter(clean):
    whole = clean[1]
    back = np.arange(2, 101) * 4e-3
    longer = Trace(
        whole.name,
        np.r_[whole.time_s, whole.time_s[-1] + back],
        np.r_[whole.displacement_mm, whole.displacement_mm[-1] - 10 * back],
        np.r_[whole.force_N, np.full(99, -0.4)],
    )
    assert values(fit_traces([longer], 5, intervals=False)) == pytest.approx(
        values(fit_traces([whole], 5, intervals=False)), rel=2e-3
    )


@pytest.mark.slow
def test_a_linear_slab_shows_falling_gamma1_and_falling_c_without_any_rate_dependence():
    """So the fall of c with speed in fits per condition is no proof of a rate-dependent viscosity."""
    from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force

    arms = (PronyTerm(0.07, 0.5), PronyTerm(1.5, 0.3))
    traces = []
    for v, f in SIX:
        motion = ramp_and_hold(v, f / 1.2, 10.0)
        time_s = np.arange(0.0, motion.time_s[-1], 1e-3)
        x = np.interp(time_s, motion.time_s, motion.displacement_mm)
        traces.append(Trace(f"{v}_{f}.csv", time_s, x, relaxed_force(time_s, 1.2 * x, arms)))
    rows = fit_traces(traces, 5, mode="per-condition", intervals=False).result["by_condition"]
    gamma1 = [row["parameters"]["gamma1_N_per_mm3"]["value"] for row in rows[:3]]
    assert gamma1[0] > 2 * gamma1[1] > 2 * gamma1[2]
    c3 = [row["parameters"]["c3_N_s_per_mm"]["value"] for row in rows]
    assert all(c3[k] > 3 * c3[3 + k] for k in range(3))
    joint = fit_traces(traces, 5, intervals=False)
    assert joint.result["max_residual_N"] > 1.0


@pytest.mark.slow
def test_an_arm_too_fast_for_the_data_is_called_not_identifiable_not_given_a_number():
    truth = np.r_[GAMMA1, 0.03, 200.0, 1.2, 0.02]
    traces = [noisy(press(10.0, np.cbrt(f / GAMMA1), truth=truth), k) for k, f in enumerate((5.0, 10.0, 15.0))]
    fit = fit_traces(traces, 5)
    gamma3, c3 = (fit.result["parameters"][name] for name in ("gamma3_N_per_mm3", "c3_N_s_per_mm"))
    assert gamma3["high"] is None and "not identifiable" in gamma3["reason"]
    assert c3["value"] == pytest.approx(0.02, rel=0.1), "its damper is seen all the same"
    assert any(w["code"] == "not_identifiable" for w in fit.result["warnings"])


@pytest.mark.slow
def test_more_arms_than_the_data_have_are_not_given_certain_numbers():
    truth = np.r_[GAMMA1, 0.11, 0.08]
    traces = [noisy(press(v, np.cbrt(f / GAMMA1), truth=truth), k) for k, (v, f) in enumerate(SIX[::2])]
    fit = fit_traces(traces, 7)
    doubtful = [p for p in fit.result["parameters"].values() if p["at_bound"] or p["low"] is None or p["high"] is None]
    assert len(doubtful) >= 2
    assert {w["code"] for w in fit.result["warnings"]} & {"at_bound", "not_identifiable"}
    assert fit_traces(traces, "auto", intervals=False).result["elements"] == 3


@pytest.mark.slow
def test_eighteen_traces_are_fitted_together_down_to_their_noise(clean):
    traces = [
        Trace(f"{k}_{t.name}", *(getattr(noisy(t, k), n) for n in ("time_s", "displacement_mm", "force_N")))
        for k in range(3)
        for t in clean
    ]
    fit = fit_traces(traces)
    assert fit.result["elements"] == 5 and len(fit.result["by_trace"]) == 18
    assert fit.result["noise_floor_N"] == pytest.approx(0.03, rel=0.05)
    assert fit.result["rmse_N"] == pytest.approx(0.03, rel=0.05)


@pytest.mark.slow
def test_a_subject_made_from_a_fit_carries_law_intervals_and_source(clean):
    subject = subject_from_fit("anna", fit_traces([noisy(t, k) for k, t in enumerate(clean)], 5, mode="per-speed"))
    c2 = subject.numbers["c2_N_s_per_mm"]["250"]
    assert c2.kind == "fitted" and "law ode, per-speed" in c2.source and c2.low < c2.value < c2.high
    assert subject.parameters.velocities_mm_s == (10.0, 250.0)


def test_a_shallow_press_that_brakes_from_the_surface_keeps_its_speed():
    motion = ramp_and_hold(250.0, 0.5, 2.0, 10_000.0)
    time_s = np.arange(-0.1, 2.0, 1e-3)
    pressed = np.interp(time_s, motion.time_s, motion.displacement_mm)
    # straight at 250 mm/s down to the braking distance of 3.1 mm before the end, 2.6 mm above the surface
    touch = np.sqrt(2 * 10_000.0 * 0.5)
    begin = (250.0 - touch) / 10_000.0
    braked = 0.5 - 0.5 * 10_000.0 * (0.01 - time_s) ** 2
    x = np.where(time_s >= 0, pressed, np.where(time_s > -begin, braked, -2.625 + 250.0 * (time_s + begin)))
    trace = Trace("a.csv", time_s, x, np.maximum(x, 0) ** 3 + 1e-3)
    assert speed_groups([reduce_trace(trace)])[0][0] == pytest.approx(250.0, rel=0.05)


@pytest.mark.parametrize(
    "change, code",
    [
        ({"law": "cubic"}, "unknown_name"),
        ({"mode": "all"}, "unknown_name"),
        ({"elements": 4}, "unknown_name"),
    ],
)
def test_unknown_choices_are_refused(clean, change, code):
    with raises_code(code):
        fit_traces(clean[:1], **change)


def test_traces_without_a_press_or_a_hold_are_refused_by_name(clean):
    whole = clean[0]
    with raises_code("missing", "trace"):
        fit_traces([])
    still = Trace("still.csv", whole.time_s, -1.0 + 0 * whole.displacement_mm, whole.force_N)
    with raises_code("nothing_found", "displacement_mm"):
        fit_traces([still])
    short = whole.time_s < whole.time_s[0] + 0.06 + np.cbrt(5 / GAMMA1) / 10
    cut = Trace("cut.csv", whole.time_s[short], whole.displacement_mm[short], whole.force_N[short])
    with raises_code("not_enough_data", "hold_s"):
        fit_traces([cut])


@pytest.mark.parametrize("seed", [41, 42])
def test_gamma1_of_a_press_that_overshoots_is_right_and_inside_its_interval(seed):
    from benchmarks.accuracy import overshoot

    press = overshoot.drawn(np.random.default_rng(seed), True, (0.03, 0.1))
    trace = Trace("rings.csv", press.time_s, press.displacement_mm, press.force_N)
    found = fit_traces([trace], 5).result
    gamma1 = found["parameters"]["gamma1_N_per_mm3"]
    assert gamma1["value"] == pytest.approx(overshoot.GAMMA1, rel=0.01)
    assert gamma1["low"] < 1.003 * overshoot.GAMMA1 and gamma1["high"] > 0.997 * overshoot.GAMMA1
    assert "lack_of_fit" not in {one["code"] for one in found["warnings"]}


def test_a_press_without_a_hold_is_refused():
    time = np.arange(-0.5, 20.0, 5e-3)
    x = np.maximum(5.0 - 0.5 * np.abs(time - 10.0), -0.2)
    with raises_code("not_enough_data", "hold_s"):
        fit_traces([Trace("triangle.csv", time, x, 0.06 * np.maximum(x, 0.0) ** 3)])
