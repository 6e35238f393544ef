"""A tissue from one table of curves: the same as from its traces; what contradicts itself is refused in one line."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue.adding.from_traces import add_curves
from dummydesign.tissue.adding.observations import check_curves, read_curves
from dummydesign.tissue.model.maxwell_law import law_named
from tests.support.refusal import raises_code

GAMMA1 = {"anna": 0.05, "bert": 0.12}


def table(path, scale=1.0, people=GAMMA1, hold_s=5.0, times=True):
    """Presses of two people at two speeds, by the law itself."""
    rows = ["subject,velocity_mm_s,time_s,depth_mm,force_N"]
    for who, gamma1 in people.items():
        for speed in (10.0, 250.0):
            for depth in (3.0, 5.0):
                motion = ramp_and_hold(speed, depth, hold_s, ramp_points=40, brake_points=12, hold_points=60)
                dampers = [1.2, 0.08] if speed < 100 else [0.2, 0.01]
                force = law_named("ode").force(motion, gamma1, [0.6 * gamma1, gamma1], dampers)
                force = force * (scale if depth == 5.0 and speed == 10.0 else 1.0)
                cells = zip(motion.time_s, motion.displacement_mm, force)
                rows += [f"{who},{speed:g},{f'{t:.6f}' if times else ''},{x:.5f},{f:.5f}" for t, x, f in cells]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def test_curves_are_told_apart_by_subject_speed_and_time_that_goes_back(tmp_path):
    curves = read_curves(table(tmp_path / "c.csv"))
    assert [(c.subject, c.velocity_mm_s) for c in curves[:4]] == [("anna", 10.0)] * 2 + [("anna", 250.0)] * 2
    held = curves[0].time_s[curves[0].depth_mm >= 0.99 * curves[0].depth_mm.max()]
    assert len(curves) == 8 and np.ptp(held) == pytest.approx(5.0, rel=0.02)
    for curve in curves:
        check_curves([curve], "c.csv")


@pytest.mark.slow
def test_the_tissue_has_the_law_that_made_the_curves(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    found = add_curves("mine", str(table(tmp_path / "c.csv")), "ode", "5")
    values = {one["name"]: one["gamma1_N_per_mm3"]["value"] for one in found["subjects"]}
    assert values == pytest.approx(GAMMA1, rel=0.01)
    assert (tmp_path / "home" / "materials" / "tissues" / "mine.toml").is_file()


def test_curves_that_contradict_each_other_are_refused_in_one_line(tmp_path):
    path = table(tmp_path / "c.csv", scale=4.0)
    with raises_code("inconsistent", "force_N") as told:
        add_curves("mine", str(path), "ode", "5")
    assert "\n" not in str(told.value) and "line 2" in str(told.value)


def test_forces_in_millinewtons_are_refused_without_naming_a_file_that_nobody_has(tmp_path):
    path = table(tmp_path / "c.csv", people={"anna": 50.0})
    with raises_code("implausible_unit", "force_N") as told:
        add_curves("mine", str(path), "ode", "5")
    assert "import" not in str(told.value) and "curve_1_line_" in str(told.value)


def test_a_person_without_a_hold_has_no_steady_force(tmp_path):
    with raises_code("not_enough_data", "hold_s"):
        add_curves("mine", str(table(tmp_path / "c.csv", hold_s=0.1)), "ode", "5")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("subject,depth_mm,force_N\na,1,1\n", "missing"),
        ("subject,velocity_mm_s,time_s,depth_mm,force_N\n", "nothing_found"),
        ("subject,velocity_mm_s,time_s,depth_mm,force_N\na,0,0,1,1\n", "out_of_range"),
        ("subject,velocity_mm_s,time_s,depth_mm,force_N\na,10,0,x,1\n", "not_a_number"),
        ("subject,velocity_mm_s,time_s,depth_mm,force_N\na,10,0,1,1\n", "not_enough_data"),
    ],
)
def test_what_is_no_table_of_curves_is_refused_with_its_line(tmp_path, text, code):
    path = tmp_path / "c.csv"
    path.write_text(text, encoding="utf-8")
    with raises_code(code):
        read_curves(path)


def test_without_times_the_depth_rises_at_the_speed(tmp_path):
    path = tmp_path / "c.csv"
    rows = "\n".join(f"a,10,,{x:.2f},{x**3:.3f}" for x in np.linspace(0.1, 3.0, 20))
    path.write_text(f"subject,velocity_mm_s,time_s,depth_mm,force_N\n{rows}\n", encoding="utf-8")
    assert read_curves(path)[0].time_s[-1] == pytest.approx(0.29)
