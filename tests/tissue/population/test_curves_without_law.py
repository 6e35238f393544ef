"""``tissues add-curves``: the law where it follows the curves, else the curves; and what is said of few."""

import dataclasses

import numpy as np
import pytest

from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import TOLERANCE, Readings, ranges_of, readings_of
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue import load_tissue
from dummydesign.tissue.adding.from_points import add_points
from dummydesign.tissue.adding.from_traces import add_curves
from dummydesign.tissue.adding.people import Misfit
from dummydesign.tissue.model.maxwell_law import law_named
from tests.support.fung_people import PEOPLE, write_table
from tests.support.judged_pads import judged
from tests.support.power_pads import pads
from tests.support.refusal import raises_code


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))


def law_table(path, tissue, forces=(5.0, 7.0, 10.0, 15.0), speeds=(10.0, 250.0), noise_N=0.0):
    """Presses of a tissue's subjects by its law, as a table of curves."""
    rng, rows = np.random.default_rng(5), ["subject,velocity_mm_s,press,time_s,depth_mm,force_N"]
    number = 0
    for subject in tissue.subjects:
        p = subject.parameters
        for speed in speeds:
            for force in forces:
                number += 1
                depth = float(law_named(p.law).held_depths((p,), np.array([force]), speed, 10.0, 30_000.0)[0, 0])
                motion = ramp_and_hold(speed, depth, 10.0, ramp_points=120, brake_points=120, hold_points=200)
                carried = law_named(p.law).force(motion, p.gamma1_N_per_mm3, p.gamma_N_per_mm3, p.dampers_at(speed))
                carried = carried + noise_N * rng.standard_normal(len(carried))
                apart = np.r_[True, np.diff(motion.time_s) > 1e-6]
                cells = zip(motion.time_s[apart], motion.displacement_mm[apart], carried[apart])
                rows += [f"{subject.name},{speed:g},{number},{t:.8f},{x:.6f},{f:.5f}" for t, x, f in cells]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["forefinger", "palm"])
@pytest.mark.slow
def test_curves_of_people_who_follow_the_law_give_the_verdict_that_the_law_gives(tmp_path, name):
    law = load_tissue(name)
    add_curves("same", str(law_table(tmp_path / "c.csv", law)), "none", "5")
    by_law, by_curves = (make_targets(tissue, "average", Sampling()) for tissue in (law, load_tissue("same")))
    a, b = ranges_of(by_law), ranges_of(by_curves)
    for edge, near in (
        ("peak_low_N", 0.008),
        ("peak_high_N", 0.008),
        ("energy_low_mJ", 0.01),
        ("energy_high_mJ", 0.01),
        ("stiff_mm", 0.003),
        ("soft_mm", 0.003),
    ):
        np.testing.assert_allclose(getattr(b, edge), getattr(a, edge), rtol=near, err_msg=edge)
    stiffness = law.target().gamma1_N_per_mm3 * np.geomspace(0.25, 3.0, 60)
    found = [
        readings_of(evaluate(pads(3.0, stiffness, beta, thickness_mm=25.0), by_law, exact=True))
        for beta in ((0.1, 0.1), (0.4, 0.2), (0.7, 0.3), (0.7, 0.6), (1.5, 1.0))
    ]
    names = [field.name for field in dataclasses.fields(found[0])]
    readings = Readings(*(np.concatenate([getattr(one, name) for one in found]) for name in names))
    mine, its = judged(b, readings), judged(a, readings)
    differ = [k for k, (x, y) in enumerate(zip(mine, its)) if x != y]
    assert len(set(its)) >= 3 and len(differ) <= 0.03 * len(its)
    for k in differ:
        # such a pad stands within the tolerance of a force of a border of the ranges
        one = Readings(*(getattr(readings, name)[[k]] for name in names))
        share = TOLERANCE
        # wider and narrower ranges, and ranges of higher and of lower forces
        moved = [
            dataclasses.replace(
                a, peak_low_N=a.peak_low_N * (1 - lower), peak_high_N=a.peak_high_N * (1 + upper),
                energy_low_mJ=a.energy_low_mJ * (1 - lower), energy_high_mJ=a.energy_high_mJ * (1 + upper),
                stiff_mm=a.stiff_mm * (1 - upper / 3), soft_mm=a.soft_mm * (1 + lower / 3),
            ) for lower, upper in ((share, share), (-share, -share), (-share, share), (share, -share))
        ]  # fmt: skip
        assert len({judged(ranges, one)[0] for ranges in moved}) > 1


@pytest.mark.slow
def test_the_law_is_taken_where_it_follows_the_curves(tmp_path):
    law = load_tissue("palm")
    two = dataclasses.replace(law, subjects=law.subjects[:2])
    found = add_curves("mine", str(law_table(tmp_path / "c.csv", two, (5.0, 12.0), noise_N=0.02)), "auto", "5")
    assert found["law"] == "ode" and all(row["follows"] for row in found["law_misfit"])
    assert "law_does_not_follow" not in [warning["code"] for warning in found["warnings"]]


@pytest.mark.slow
def test_the_curves_are_kept_where_the_law_does_not_follow_and_that_is_said_with_both_numbers(tmp_path):
    table = write_table(tmp_path / "c.csv", PEOPLE[:1], (5.0, 15.0), repeats=2, noise_N=0.02, depth_sd_mm=0.01)
    found = add_curves("mine", str(table), "auto", "5")
    assert found["law"] == "curves"
    said = {warning["code"]: warning["message"] for warning in found["warnings"]}
    row = found["law_misfit"][0]
    assert row["repeats"] and row["misfit_percent"] > 2.0 * row["scatter_percent"]
    assert (
        f"ada by {row['misfit_percent']:.1f} % (repeats scatter by {row['scatter_percent']:.1f} %)"
        in (said["law_does_not_follow"])
    )
    assert "one_subject" in said and "measured_curves" in said


def test_a_law_follows_up_to_twice_the_scatter():
    assert Misfit("a", 3.0, 1.5, True, 2.0).follows and not Misfit("a", 3.1, 1.5, True, 2.07).follows


@pytest.mark.slow
def test_shallow_fast_presses_that_brake_all_the_way_count_at_the_speed_they_were_told(tmp_path):
    """at 1 to 3 N a forefinger stops within the braking distance: its motion shows 180 to 230 mm/s, by person"""
    finger = load_tissue("forefinger")
    table = law_table(tmp_path / "shallow.csv", finger, forces=(1.0, 2.0, 3.0))
    said = add_curves("shallow", str(table), "ode", "5")["warnings"]
    assert not {"one_speed", "speed_unlike_told"} & {one["code"] for one in said}
    found = load_tissue("shallow")
    assert found.velocities_mm_s == (10.0, 250.0)
    known = {subject.name: subject.parameters for subject in finger.subjects}
    for subject in found.subjects:
        dampers = known[subject.name].dampers_at(250.0)
        np.testing.assert_allclose(subject.parameters.dampers_at(250.0), dampers, rtol=2e-3)


def test_presses_that_moved_faster_than_the_table_says_are_named(tmp_path):
    table = law_table(tmp_path / "t.csv", load_tissue("palm"), forces=(5.0, 10.0))
    text = table.read_text(encoding="utf-8").replace(",250,", ",125,")
    table.write_text(text, encoding="utf-8")
    said = [one for one in add_curves("t", str(table), "none", "5")["warnings"] if one["code"] == "speed_unlike_told"]
    assert len(said) == 1 and said[0]["message"].count("for 125 mm/s") == 10


def test_one_speed_and_one_person_are_said(tmp_path):
    table = write_table(tmp_path / "c.csv", PEOPLE[:1], (5.0, 10.0), speeds=(10.0,))
    said = {one["code"]: one["message"] for one in add_curves("mine", str(table), "none", "5")["warnings"]}
    assert "one subject" in said["one_subject"] and "--velocity 10" in said["one_speed"]
    with raises_code("out_of_range", "force_N"):
        make_targets(load_tissue("mine"), "average", Sampling())


def test_people_without_a_force_or_a_speed_in_common_are_refused(tmp_path):
    def joined(first, second):
        path = tmp_path / "both.csv"
        path.write_text(first.read_text() + second.read_text().partition("\n")[2], encoding="utf-8")
        return str(path)

    ada = write_table(tmp_path / "a.csv", PEOPLE[:1], (2.0, 3.0), speeds=(10.0,))
    ben = write_table(tmp_path / "b.csv", PEOPLE[1:2], (9.0, 15.0), speeds=(10.0,))
    fast = write_table(tmp_path / "f.csv", PEOPLE[1:2], (2.0, 3.0), speeds=(100.0,))
    with raises_code("inconsistent", "force_N"):
        add_curves("mine", joined(ada, ben), "none", "5")
    with raises_code("inconsistent", "velocity_mm_s"):
        add_curves("mine", joined(ada, fast), "none", "5")


def test_presses_that_were_not_held_are_left_out_by_name(tmp_path):
    path = write_table(tmp_path / "c.csv", PEOPLE[:1], (5.0, 10.0), speeds=(10.0,))
    short = write_table(tmp_path / "s.csv", PEOPLE[:1], (7.0,), speeds=(10.0,), hold_s=0.2)
    rows = short.read_text().partition("\n")[2].replace("ada,10,1,", "ada,10,9,")
    path.write_text(path.read_text() + rows, encoding="utf-8")
    found = add_curves("mine", str(path), "none", "5")
    said = {one["code"]: one["message"] for one in found["warnings"]}
    assert "ada" in said["hold_too_short"] and len(load_tissue("mine").subjects[0].parameters.presses) == 2


def test_points_do_not_update_curves(tmp_path):
    add_curves("mine", str(write_table(tmp_path / "c.csv", PEOPLE[:1], (5.0, 10.0), speeds=(10.0,))), "none", "5")
    points = tmp_path / "p.csv"
    points.write_text("subject,depth_mm,force_N\nada,1,2\nada,2,9\n", encoding="utf-8")
    with raises_code("unsupported", "tissue"):
        add_points("mine", str(points))


def test_a_law_that_is_not_fitted_is_refused_before_any_work(tmp_path):
    with raises_code("unsupported", "law"):
        add_curves("mine", str(tmp_path / "missing.csv"), "spring", "5")


def test_the_same_noise_leaves_peaks_where_they_are(tmp_path):
    tables = [write_table(tmp_path / f"{noise}.csv", PEOPLE[:1], (5.0, 10.0), noise_N=noise) for noise in (0.0, 0.03)]
    bands = []
    for number, table in enumerate(tables):
        add_curves(f"n{number}", str(table), "none", "5")
        bands.append(load_tissue(f"n{number}").force_range(10.0, 250.0))
    assert bands[1].peak_high_N == pytest.approx(bands[0].peak_high_N, abs=0.05)
    assert bands[1].depth_mm[0] == pytest.approx(bands[0].depth_mm[0], rel=2e-3)


@pytest.mark.slow
def test_whatif_of_a_hold_that_nobody_was_pressed_for_is_refused_and_leaves_no_folder(tmp_path):
    import dummydesign

    add_curves("mine", str(write_table(tmp_path / "c.csv", PEOPLE[:2], (5.0, 10.0), hold_s=5.0)), "none", "5")
    asked = {"tissue": "mine", "force_N": "6,8", "velocity_mm_s": 10.0, "out": tmp_path / "study"}
    with raises_code("out_of_range", "hold_s"):
        dummydesign.whatif(8.0, 15.0, **asked)
    assert not (tmp_path / "study").exists()
    row = dummydesign.whatif(8.0, 15.0, hold_s=5.0, **asked).rows[0]
    assert 0.0 <= row["score"]["total"] <= 1.0


@pytest.mark.slow
def test_people_of_a_law_without_a_speed_in_common_are_refused_with_their_speeds(tmp_path):
    table = law_table(tmp_path / "t.csv", load_tissue("palm"), forces=(5.0, 10.0))
    lines = table.read_text(encoding="utf-8").splitlines()
    name = lines[1].split(",")[0]
    apart = [
        row.replace(",10,", ",20,", 1).replace(",250,", ",100,", 1) if row.startswith(name) else row for row in lines
    ]
    table.write_text("\n".join(apart) + "\n", encoding="utf-8")
    with raises_code("inconsistent", "velocity_mm_s"):
        add_curves("t", str(table), "ode", "5")


def test_points_of_an_unknown_tissue_say_what_makes_one(tmp_path):
    with raises_code("unknown_name", "tissue"):
        add_points("mine", str(tmp_path / "points.csv"))
