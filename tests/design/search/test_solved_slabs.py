"""Slab curves from finite elements: the fit between solved depths, early stops, one solve a thickness."""

import numpy as np
import pytest

from dummydesign.design.sweep.run import whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.geometry.punch import equal_area_radius_mm
from dummydesign.pad import fe_force_law as solved
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from tests.support.refusal import raises_code

RADIUS = 14.0 / np.sqrt(np.pi)


def pretend(layer_law, calls, reach=0.6, depths=solved.SLAB_SHARES):
    """Stand in for the finite-element solve by a formula of known force."""

    def solve(pad, fidelity):
        thickness, radius = pad.thickness_mm, pad.radius_mm
        calls.append(thickness)
        depth = thickness * np.array([share for share in depths if share <= reach])
        why = () if reach >= 0.6 else ("stopped early",)
        force = layer_law.force(depth, thickness, 1.0, radius)
        return solved.SolvedSlab(pad, depth, force, 0.001 + 0.0 * depth, why)

    return solve


def test_between_solved_depths_the_force_is_that_of_the_law(layer_law, monkeypatch):
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, []))
    law = solved.solve_law([4.0, 12.0], RADIUS)
    thickness = np.array([[4.0], [12.0]])
    depth = np.linspace(0.002, 0.6, 60) * thickness
    exact = layer_law.force(depth, thickness, 0.03, RADIUS)
    np.testing.assert_allclose(law.force(depth, thickness, 0.03, RADIUS), exact, rtol=1e-3)


def test_a_study_solves_each_thickness_once_whatever_the_ratios(layer_law, monkeypatch):
    calls = []
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, calls))
    punches = (("round:15.8", RADIUS),)
    study = Study((5.0, 10.0), (15.0, 15.5, 16.0), punches, fidelity="axisymmetric")
    rows, exact = whatif(study)["rows"], whatif(study, layer_law)["rows"]
    assert sorted(calls) == [5.0, 10.0]
    for row, wanted in zip(rows, exact):
        for force, depth in row["depth_mm_at_N"].items():
            known = wanted["depth_mm_at_N"][force]
            assert depth is known if known is None else depth == pytest.approx(known, rel=2e-3)


def test_the_error_of_solve_and_fit_is_carried_into_the_rows(layer_law, monkeypatch):
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, []))
    rows = whatif(Study((5.0, 10.0), (15.0, 16.0), (("round:15.8", RADIUS),), fidelity="axisymmetric"))["rows"]
    assert all(0.1 <= row["force_error_percent"] < 0.3 for row in rows)
    assert whatif(Study((5.0,), (15.0,), (("square:14", RADIUS),)))["rows"][0]["force_error_percent"] > 0.1


def test_a_curve_that_stops_early_is_used_no_further(layer_law, monkeypatch):
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, [], reach=0.35))
    law = solved.solve_law([10.0], RADIUS)
    assert law.depth_limit_mm(10.0, RADIUS) == pytest.approx(3.5)
    assert law.notes == ("slab of 10 mm: stopped early",)


def test_a_slab_that_can_hardly_be_solved_has_no_answer(layer_law, monkeypatch):
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, [], reach=0.1))
    with raises_code("no_convergence", "pad"):
        solved.solve_law([10.0], RADIUS)


def test_another_punch_is_not_answered_by_chance(layer_law, monkeypatch):
    monkeypatch.setattr(solved, "solve_slab", pretend(layer_law, []))
    with pytest.raises(ValueError, match="punch radius"):
        solved.solve_law([10.0], RADIUS).force(1.0, 10.0, 1.0, 5.0)


@pytest.mark.slow
def test_finite_elements_and_table_agree_at_moderate_depth():
    punches = (("square:14", RADIUS),)
    studies = [Study((6.0, 15.0), (15.5,), punches, fidelity=name) for name in ("table", "axisymmetric")]
    table, finite = (whatif(study)["rows"] for study in studies)
    for first, second in zip(table, finite):
        for force in ("1", "5"):
            assert first["depth_mm_at_N"][force] == pytest.approx(second["depth_mm_at_N"][force], rel=0.01)


@pytest.mark.slow
def test_stiffening_is_solved_under_a_face_that_slides(monkeypatch):
    monkeypatch.setattr(solved, "SLAB_SHARES", (0.02,))
    cases = [Pad(8.0, 1.0, 8.0, condition="frictionless", law=Yeoh(1.0, c2)) for c2 in (0.0, 2.0)]
    soft, stiff = (solved.solve_slab(case) for case in cases)
    assert 1.01 < stiff.area_mm2[0] / soft.area_mm2[0] < 1.1


@pytest.mark.parametrize(
    "case",
    [
        Pad(8.0, 1.0, RADIUS, condition="frictionless", sides_mm=(14.0, 14.0)),
        Pad(8.0, 1.0, RADIUS, sides_mm=(28.0, 7.0)),
        Pad(8.0, 1.0, RADIUS, law=Yeoh(1.0, 0.3), sides_mm=(14.0, 14.0)),
        Pad(100.0, 1.0, RADIUS, sides_mm=(14.0, 14.0)),
    ],
    ids=["a face that slides", "a rectangle", "stiffening", "outside the table of squares"],
)
def test_corners_that_an_axisymmetric_slab_cannot_have_are_refused(case):
    with raises_code("unsupported", "punch"):
        solved.solve_slab(case)


def test_a_study_that_takes_a_punch_as_a_circle_says_so():
    def reduced(thickness, punch, **more):
        punches = ((punch, equal_area_radius_mm(punch)),)
        return Study((thickness,), (15.0,), punches, fidelity="axisymmetric", **more).reduced

    assert reduced(5.0, "square:14") == []
    assert reduced(5.0, "square:14", conditions=("frictionless",)) == ["square:14"]
    assert reduced(5.0, "rectangle:28x7") == ["rectangle:28x7"]
    assert reduced(30.0, "square:2") == ["square:2"]
