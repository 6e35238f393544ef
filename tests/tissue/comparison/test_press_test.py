"""compare in a test of one's own: which presses count, where holds end, what is left open, and what is refused."""

import json

import numpy as np
import pytest

from dummydesign.api.traces import compare
from dummydesign.cli.entry import run
from dummydesign.design.measured_pad import verdict_of_traces
from dummydesign.measurement.motion import Motion, contact_velocity, ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.tissue import load_tissue
from dummydesign.tissue.comparison import PressTest, compare_traces, missing_of, presses_of
from dummydesign.tissue.model.laws import ODE
from tests.support.refusal import raises_code


@pytest.fixture(scope="module")
def palm():
    return load_tissue("palm")


def held_depths(subjects, forces_N, velocity_mm_s, hold_s, of=ODE.held_depths):
    return of(subjects, forces_N, velocity_mm_s, hold_s, 30_000.0)


def end_of_hold_range(*press):
    depth = held_depths(*press, of=ODE.end_of_hold_depths)
    return depth.min(axis=0), depth.max(axis=0)


def subject_presses(palm, forces_N, velocities_mm_s, hold_s=10.0, subject=2, scale=1.0):
    """Traces of a subject whose force at the end of the hold is each of the forces."""
    own, traces = (palm.parameter_sets[subject],), []
    for v in velocities_mm_s:
        for f in forces_N:
            depth = float(held_depths(own, np.array([f]), v, hold_s)[0, 0])
            motion = ramp_and_hold(v, depth, hold_s)
            time = np.union1d(np.arange(0.0, motion.time_s[-1], 2e-3), motion.time_s[:90])
            x = np.interp(time, motion.time_s, motion.displacement_mm)
            traces.append(Trace(f"v{v:g}_f{f:g}.csv", time, x, scale * own[0].force(Motion(time, x), v)))
    return traces


def test_after_a_short_hold_a_subject_is_less_deep_than_at_rest_and_the_range_says_so(palm):
    forces = np.array([2.0, 5.0, 10.0])
    rest = palm.steady_depth_range(forces)
    stiff, soft = end_of_hold_range(palm.parameter_sets, forces, 10.0, 0.5)
    assert (stiff < 0.99 * rest[0]).all() and (soft < 0.99 * rest[1]).all()
    every = held_depths(palm.parameter_sets, forces, 10.0, 0.5)
    np.testing.assert_allclose([stiff, soft], [every.min(axis=0), every.max(axis=0)], rtol=1e-3)
    np.testing.assert_array_equal(end_of_hold_range(palm.parameter_sets, forces, 10.0, 10.0), rest)


@pytest.mark.slow
def test_a_subject_pressed_with_a_short_hold_lies_inside_the_steady_range_of_that_hold(palm):
    found = compare_traces(subject_presses(palm, (5.0, 10.0, 15.0), (10.0,), hold_s=0.5), palm)
    assert found.result["steady_state_range"]["above_5N_fraction"] == 1.0
    at_rest = palm.steady_depth_range(found.grid_N)
    kept = np.isfinite(found.steady) & (found.grid_N >= 5.0)
    assert (found.steady[kept] < at_rest[1][kept]).all() and (found.range_mm[0] < at_rest[0]).all()


def test_a_test_of_one_force_and_speed_judges_that_press_alone(palm):
    traces = subject_presses(palm, (2.0, 4.0, 10.0), (10.0, 100.0))
    test = PressTest((2.0, 4.0), (100.0,))
    kept, reduced, said = presses_of(traces, test)
    assert [trace.name for trace in kept] == ["v100_f2.csv", "v100_f4.csv"] and len(reduced) == 2
    assert said[0][0] == "press_outside_test" and "4 of 6" in said[0][1]
    found = compare_traces(traces, palm, test=test)
    judged = verdict_of_traces(found, palm)
    assert judged.peaks == 2 and "not pressed" not in judged.text
    assert found.result["steady_state_range"]["span_N"] == [2.0, 4.0] and found.grid_N[-1] == 4.0
    assert found.result["steady_state_range"]["above_5N_fraction"] == 1.0


def test_a_press_that_brakes_from_contact_on_is_of_the_tests_speed_that_it_cannot_reach(palm):
    depth = 0.4
    assert contact_velocity(250.0, depth, 30_000.0) < 160.0
    for sent in (158.0, 75.0):
        motion = ramp_and_hold(sent, depth, 2.0)
        trace = Trace("press.csv", motion.time_s, motion.displacement_mm, 5.0 * motion.displacement_mm / depth)
        for known, test in (((10.0, 250.0), PressTest()), ((), PressTest(velocities_mm_s=(250.0,)))):
            if sent < 100 and test.velocities_mm_s:
                with raises_code("nothing_found"):
                    presses_of([trace], test, known)
                continue
            reduced = presses_of([trace], test, known)[1]
            assert reduced[0].velocity_mm_s == pytest.approx(250.0 if sent > 100 else sent, rel=0.05)
            said = missing_of(reduced, test, known)
            assert ("250" in said) == (sent < 100)


@pytest.mark.slow
def test_a_pad_half_as_strong_reads_low_in_a_test_at_small_forces(palm):
    traces = subject_presses(palm, (1.0, 2.0), (10.0, 100.0), subject=0, scale=0.5)
    found = compare_traces(traces, palm, test=PressTest((0.5, 1.0), (10.0, 100.0)))
    judged = verdict_of_traces(found, palm)
    # half of the softest subject at every depth: all of 0.5 to 1 N is below, while the peaks go with the force
    assert judged.level == "not_representative" and judged.reads != "inside" and judged.steady_below_fraction == 1.0
    assert judged.shortfall.quantity == "steady" and judged.shortfall.central == pytest.approx(2.0, rel=0.05)


@pytest.mark.slow
def test_presses_of_the_test_that_were_not_made_leave_the_verdict_open(palm):
    traces = subject_presses(palm, (5.0, 10.0), (10.0,))
    found = compare_traces(traces, palm, test=PressTest((5.0, 10.0), (10.0, 100.0)))
    judged = verdict_of_traces(found, palm)
    assert judged.level == "not_settled" and judged.reads in ("inside", "high")
    assert "not pressed to 5 N at 100 mm/s, to 10 N at 100 mm/s" in judged.text
    one_speed = verdict_of_traces(compare_traces(traces, palm, test=PressTest((5.0, 10.0), (10.0,))), palm)
    assert "not pressed" not in one_speed.text


@pytest.mark.slow
def test_a_longer_hold_is_cut_at_the_tests_and_a_shorter_one_is_said(palm):
    traces = subject_presses(palm, (5.0, 10.0), (10.0,))
    found = compare_traces(traces, palm, test=PressTest(hold_s=1.0))
    for trace, band, _ in found.presses:
        assert trace.ramp.hold_end_s - trace.ramp.stop_time_s == pytest.approx(1.0, abs=0.01)
        assert band.time_s[-1] - band.stop_s.min() == pytest.approx(1.0, abs=0.02)
    # the force at 1 s is above that at 10 s, and the range is made for it
    assert found.points[0, 1] > 1.02 * 5.0
    assert found.result["steady_state_range"]["inside_fraction"] == 1.0
    longer = compare_traces(traces, palm, test=PressTest(hold_s=60.0))
    assert "it was held 10 s of 60 s" in verdict_of_traces(longer, palm).text


@pytest.mark.slow
def test_braking_that_is_said_is_used_in_place_of_what_the_motion_shows(palm):
    traces = subject_presses(palm, (10.0,), (250.0,))
    found, gentle = (compare_traces(traces, palm, test=PressTest(deceleration_mm_s2=a)) for a in (30_000.0, 5_000.0))
    assert gentle.presses[0].range.stop_s.min() > 1.2 * found.presses[0].range.stop_s.min()


@pytest.mark.slow
def test_a_speed_with_three_digits_keeps_its_name_and_its_range(palm):
    traces = subject_presses(palm, (10.0,), (125.0,))
    row = compare_traces(traces, palm, test=PressTest(None, (125.0,))).result["force_variation_range"][0]
    assert row["velocity_mm_s"] == 125.0


@pytest.mark.slow
def test_how_the_punch_held_the_face_is_said_and_changes_no_number(palm):
    traces = subject_presses(palm, (5.0,), (10.0,))
    glued, slid = (compare(traces, "palm", condition=condition).to_dict() for condition in (None, "friction:0.3"))
    assert glued["inputs"]["condition"] == "bonded" and "test" not in glued
    assert slid["test"]["condition"] == "friction:0.3" and slid["verdict"] == glued["verdict"]
    with raises_code("unknown_name", "condition"):
        compare(traces, "palm", condition="oiled")


def test_a_test_that_no_press_belongs_to_is_refused_with_what_was_pressed(palm):
    with raises_code("nothing_found", "press"):
        compare_traces(subject_presses(palm, (5.0,), (10.0,)), palm, test=PressTest((50.0,)))


def test_traces_in_memory_whose_time_stands_still_are_refused_and_a_generator_of_them_is_read():
    motion = ramp_and_hold(10.0, 1.5, hold_s=1.0)
    force = 2.0 * motion.displacement_mm**3
    time = motion.time_s.copy()
    time[5] = time[4]
    with raises_code("malformed", "time_s"):
        compare((Trace("still", time, motion.displacement_mm, force) for _ in range(1)), "palm")


@pytest.mark.slow
def test_the_command_takes_the_test_and_says_it(palm, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = []
    for trace in subject_presses(palm, (2.0, 4.0), (100.0,), hold_s=1.0):
        rows = np.column_stack([trace.time_s, trace.displacement_mm, trace.force_N])
        np.savetxt(trace.name, rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="")
        names.append(trace.name)
    words = ["compare", *names, "--tissue", "palm", "--out", "answer"]
    own = ["--force", "2,4", "--velocity", "0.1m/s", "--hold", "1", "--deceleration", "20000", "--punch", "round:12"]
    assert run([*words, *own, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["inputs"]["velocity_mm_s"] == [100.0] and result["inputs"]["punch"] == "round:12"
    assert result["test"]["hold_s"] == 1.0
    codes = [warning["code"] for warning in result["warnings"]]
    assert {"tissue_punch", "force_not_in_band", "speed_not_in_band"} <= set(codes)
    page = (tmp_path / "answer" / "report.html").read_text()
    assert "punch round:12" in page and "2 to 4 N" in page
    assert run([*words, *own]) == 0
    assert "2 to 4 N" in capsys.readouterr().out
    for wrong, said in (
        (["--force", "0"], "force in N = 0"),
        (["--hold", "0.001"], "hold in s = 0.001"),
        (["--punch", "plate"], "puck"),
        (["--edge-radius", "9"], "edge"),
        (["--deceleration", "-1"], "deceleration in mm/s2 = -1"),
        (["--force", "40"], "no press belongs to the test"),
    ):
        assert run([*words, *wrong]) == 2, wrong
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1 and said in lines[0], (wrong, lines)


def test_a_speed_that_is_not_sampled_has_a_word_where_the_answer_depends_on_it(palm):
    """Both brake from contact on; the subjects' peak depends by 4 and by 0.1 % on the speed that is not sampled."""
    for speed, braking, depth_mm, codes in ((150.0, 2_000.0, 4.0, ["speed_not_seen"]), (180.0, 8_000.0, 2.0, [])):
        motion = ramp_and_hold(speed, depth_mm, 10.0, braking)
        time = np.arange(-0.05, motion.time_s[-1], 4e-3)
        x = np.interp(time, motion.time_s, motion.displacement_mm)
        seen = np.maximum(time, 0.0) + 1e-9 * np.arange(len(time))
        trace = Trace("fast.csv", time, x, palm.parameter_sets[2].force(Motion(seen, x), speed))
        for test, expected in ((PressTest(), codes), (PressTest(velocities_mm_s=(speed,)), [])):
            warnings = compare_traces([trace], palm, test=test).result["warnings"]
            assert [one["code"] for one in warnings if one["code"] == "speed_not_seen"] == expected
