"""What-if tables against closed forms; ranges with their end; refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.parsing import parse_limits, read_numbers
from dummydesign.design.sweep.rows import write_rows
from dummydesign.design.sweep.run import whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.geometry.punch import equal_area_radius_mm
from tests.support.refusal import raises_code

SQUARE = (("square:14", 14.0 / math.sqrt(math.pi)),)


def test_the_exponent_is_that_of_the_force_law(layer_law):
    rows = whatif(Study((5.0, 15.0, 20.0), (15.0, 16.0), SQUARE), layer_law)["rows"]
    checked = 0
    for row in rows:
        for force, depth in row["depth_mm_at_N"].items():
            if depth is None:
                continue
            growth = 1.5 * (depth / row["thickness_mm"]) ** 2
            assert row["exponent_at_N"][force] == pytest.approx(1 + 2 * growth / (1 + growth), rel=2e-3)
            stiffness = row["exponent_at_N"][force] * float(force) / depth
            assert row["stiffness_N_per_mm_at_N"][force] == pytest.approx(stiffness)
            given = layer_law.force(depth, row["thickness_mm"], 1e-3 * row["young_kPa"], SQUARE[0][1])
            assert given == pytest.approx(float(force), rel=1e-3)
            checked += 1
    assert checked > 15


def test_a_thicker_pad_is_softer_at_equal_force(layer_law):
    rows = whatif(Study(tuple(np.arange(3.0, 30.5, 1.0)), (16.0,), SQUARE), layer_law)["rows"]
    depth = [row["depth_mm_at_N"]["5"] for row in rows]
    assert np.all(np.diff(depth) > 0)


def test_a_row_that_stops_early_says_why(layer_law):
    row = whatif(Study((15.0,), (14.2,), SQUARE), layer_law)["rows"][0]
    assert row["depth_mm_at_N"]["15"] is None and row["exponent_at_N"]["15"] is None
    assert row["limit"] == "5 N needs more than 9.00 mm (0.60 of the thickness)"
    fine = whatif(Study((5.0,), (16.0,), SQUARE), layer_law)["rows"][0]
    assert fine["limit"] is None


def test_peaks_grow_with_speed_and_with_softness(layer_law):
    rows = whatif(Study((6.0,), (15.5, 17.0), SQUARE, (1.0, 10.0, 250.0)), layer_law)["rows"]
    for row in rows:
        peaks = list(row["peak_over_steady"].values())
        assert 1.0 <= peaks[0] < peaks[1] < peaks[2]
    assert rows[0]["peak_over_steady"]["250"] > rows[1]["peak_over_steady"]["250"]


def test_all_combinations_are_there_once_whatever_the_chunks(layer_law, monkeypatch):
    study = Study((5.0, 10.0, 20.0), (15.0, 16.0, 17.0, 18.0), (*SQUARE, ("round:10", 5.0)))
    whole = whatif(study, layer_law)["rows"]
    monkeypatch.setattr("dummydesign.design.sweep.run.CHUNK", 5)
    assert whatif(study, layer_law)["rows"] == whole
    places = {(row["thickness_mm"], row["ratio"], row["punch"]) for row in whole}
    assert len(places) == len(whole) == study.size == 24


def test_a_tissue_adds_scores(layer_law):
    row = whatif(Study((5.0,), (15.2,), SQUARE, tissue="forefinger"), layer_law)["rows"][0]
    assert set(row["score"]) >= {"total", "steady_state_range", "force_variation_range", "aim", "parametric"}
    assert 0.0 <= row["score"]["total"] <= 1.0


def test_scores_are_of_the_studys_own_forces_and_speeds_as_suggest_gives_them(layer_law):
    from dummydesign.design.problem import read_problem
    from dummydesign.design.request import Request
    from dummydesign.design.search.slabs import search

    pads = {"thickness_mm": (5.0, 5.5), "ratio": (15.0, 16.0)}
    asked = Request("forefinger", force_N=(2.0, 4.0, 8.0), velocity_mm_s=(50.0,), **pads)
    inputs = read_problem(asked, layer_law)
    found = search(layer_law, inputs)[2]
    ratios = tuple(float(value) for value in found.ratio)
    own = Study((5.0, 5.5), ratios, SQUARE, (50.0,), (2.0, 4.0, 8.0), tissue="forefinger")
    scores = [row["score"]["total"] for row in whatif(own, layer_law)["rows"]]
    np.testing.assert_allclose(scores, found.total.ravel(), rtol=1e-9)
    paper = replace(own, forces_N=(1.0, 5.0, 10.0, 15.0), velocities_mm_s=(10.0, 250.0))
    plain = search(layer_law, read_problem(Request("forefinger", **pads), layer_law))[2]
    scores = [row["score"]["total"] for row in whatif(paper, layer_law)["rows"]]
    np.testing.assert_allclose(scores, plain.total.ravel(), rtol=1e-9)


@pytest.mark.slow
def test_hold_and_braking_of_the_study_are_those_of_its_scores_as_suggest_gives_them(layer_law):
    from dummydesign.design.problem import read_problem
    from dummydesign.design.request import Request
    from dummydesign.design.search.slabs import search

    pads = {"thickness_mm": (5.0, 5.5), "ratio": (15.0, 16.0)}
    test = {"hold_s": 0.5, "deceleration_mm_s2": 5000.0}
    found = search(layer_law, read_problem(Request("forefinger", **test, **pads), layer_law))[2]
    own = Study((5.0, 5.5), tuple(float(value) for value in found.ratio), SQUARE, tissue="forefinger", **test)
    rows = whatif(own, layer_law)["rows"]
    np.testing.assert_allclose([row["score"]["total"] for row in rows], found.total.ravel(), rtol=1e-9)
    usual = whatif(replace(own, hold_s=10.0, deceleration_mm_s2=30_000.0), layer_law)["rows"]
    assert [row["depth_mm_at_N"] for row in rows] == [row["depth_mm_at_N"] for row in usual]


@pytest.mark.parametrize("hold_s", [0.3, 2.0, 30.0])
def test_peak_over_the_force_at_the_end_of_a_hold_is_that_of_the_arms_left_by_then(layer_law, hold_s):
    """After a step in time short against every arm: (1 + sum beta) / (1 + sum beta exp(-hold / tau))."""
    from dummydesign.resin import load_resin

    study = Study((8.0,), (15.0,), SQUARE, velocities_mm_s=(5000.0,), hold_s=hold_s, deceleration_mm_s2=1e9)
    row = whatif(study, layer_law)["rows"][0]
    terms = load_resin(study.resin).prony(15.0)
    left = 1.0 + sum(term.beta * np.exp(-hold_s / term.tau_s) for term in terms)
    step = (1.0 + sum(term.beta for term in terms)) / left
    assert row["peak_over_steady"]["5000"] == pytest.approx(step, rel=0.01)


def test_a_hold_that_no_test_has_is_refused(layer_law):
    with raises_code("out_of_range", "hold_s"):
        whatif(Study((8.0,), (15.0,), SQUARE, hold_s=0.001), layer_law)


def test_a_thousand_designs_take_less_than_a_second_of_work(layer_law):
    study = Study(tuple(np.linspace(3.0, 30.0, 40)), tuple(np.linspace(14.0, 20.0, 25)), SQUARE)
    assert study.size == 1000
    assert whatif(study, layer_law)["seconds"] < 1.0


def test_csv_has_one_line_a_row_and_a_column_a_value(layer_law, tmp_path):
    study = Study((5.0, 15.0), (15.0,), SQUARE)
    rows = whatif(study, layer_law)["rows"]
    lines = write_rows(tmp_path, study, {}, rows).read_text(encoding="utf-8").splitlines()
    assert len(lines) == 3
    head = lines[0].split(",")
    assert {"depth_mm_at_5_N", "exponent_at_15_N", "peak_over_steady_at_250_mm_s", "limit"} <= set(head)
    assert float(lines[1].split(",")[head.index("depth_mm_at_5_N")]) == pytest.approx(
        rows[0]["depth_mm_at_N"]["5"], rel=1e-5
    )


def test_ranges_include_their_stop():
    assert read_numbers("3:30:0.5", "x")[-1] == 30.0 and len(read_numbers("3:30:0.5", "x")) == 55
    assert read_numbers("14:15:0.1", "x") == (
        14.0,
        14.1,
        14.2,
        14.3,
        14.4,
        14.5,
        14.6,
        14.7,
        14.8,
        14.9,
        15.0,
    )
    assert read_numbers("1:2:0.3", "x") == (1.0, 1.3, 1.6, 1.9)
    assert read_numbers("5,15", "x") == (5.0, 15.0) and read_numbers("5:5:1", "x") == (5.0,)
    assert parse_limits("5:20", "x") == (5.0, 20.0) and parse_limits("7", "x") == (7.0, 7.0)


@pytest.mark.parametrize("text", ["", "a", "3:30", "3:30:0", "3:30:-1", "30:3:1", "1:2:3:4", "nan", "1,,2", "1:inf:1"])
def test_what_is_not_a_range_is_refused(text):
    with pytest.raises(InputError, match="thickness"):
        read_numbers(text, "thickness")


def test_too_many_designs_are_refused_before_any_work(layer_law):
    with raises_code("too_large", "ratio"):
        read_numbers("0:1:1e-7", "ratio")
    study = Study(tuple(np.linspace(3, 30, 2000)), tuple(np.linspace(14, 20, 600)), SQUARE)
    with raises_code("too_large", "designs"):
        whatif(study, layer_law)


@pytest.mark.parametrize(
    ("study", "code"),
    [
        (Study((2.0,), (15.0,), SQUARE), "out_of_range"),
        (Study((5.0,), (25.0,), SQUARE), "out_of_range"),
        (Study((5.0,), (15.0,), SQUARE, forces_N=(-1.0,)), "out_of_range"),
        (Study((5.0,), (15.0,), SQUARE, resin="nothing"), "unknown_name"),
        (Study((5.0,), (15.0,), SQUARE, tissue="plam"), "unknown_name"),
    ],
)
def test_bad_studies_are_refused(layer_law, study, code):
    with raises_code(code):
        whatif(study, layer_law)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"conditions": ("frictionless",)}, "not_tabulated"),
        ({"conditions": ("glued",), "fidelity": "axisymmetric"}, "unknown_name"),
        ({"bases": ("loose",)}, "unknown_name"),
        ({"punches": (("round:40", 20.0),)}, "out_of_range"),
        ({"thickness_mm": (5.0, 5.0)}, "duplicate"),
    ],
)
def test_supports_and_punches_the_model_does_not_know_are_refused(changes, code):
    study = replace(Study((5.0,), (15.0,), SQUARE), **changes)
    with raises_code(code):
        whatif(study)


def test_a_sliding_base_is_softer_and_every_support_has_its_rows():
    rows = whatif(Study((5.0, 15.0), (15.5,), SQUARE, bases=("bonded", "sliding")))["rows"]
    assert [(row["base"], row["thickness_mm"]) for row in rows] == [
        ("bonded", 5.0),
        ("bonded", 15.0),
        ("sliding", 5.0),
        ("sliding", 15.0),
    ]
    for bonded, sliding in zip(rows[:2], rows[2:]):
        assert sliding["depth_mm_at_N"]["1"] > 1.2 * bonded["depth_mm_at_N"]["1"]


def test_a_slab_that_cannot_be_solved_has_a_row_that_says_so(monkeypatch):
    def fail(pad, fidelity):
        raise NoAnswerError("no_convergence", f"slab of {pad.thickness_mm:g} mm: no depth")

    monkeypatch.setattr("dummydesign.pad.fe_force_law.solve_slab", fail)
    rows = whatif(Study((5.0,), (15.0, 16.0), SQUARE, fidelity="axisymmetric", tissue="palm"))["rows"]
    assert [row["limit"] for row in rows] == ["slab of 5 mm: no depth"] * 2
    assert set(rows[0]["depth_mm_at_N"].values()) == {None} and rows[0]["score"]["total"] == 0.0


def test_punches_are_reduced_to_the_circle_of_their_area():
    assert equal_area_radius_mm("round:10") == 5.0
    assert math.pi * equal_area_radius_mm("square:14") ** 2 == pytest.approx(196.0)
    assert math.pi * equal_area_radius_mm("rectangle:20x10") ** 2 == pytest.approx(200.0)
    for text in ("square", "square:0", "round:-3", "rectangle:20", "hexagon:3", "square:a"):
        with raises_code("malformed", "punch"):
            equal_area_radius_mm(text)
