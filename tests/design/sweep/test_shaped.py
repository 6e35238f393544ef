"""Shapes and edge radii in what-if studies: the same forces as one pad asked for alone, refusals, order, files."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.api.predictions import predict
from dummydesign.cli.entry import main
from dummydesign.design.sweep.run import whatif
from dummydesign.design.sweep.spec import Study, parse_shapes
from dummydesign.geometry.punch import equal_area_radius_mm
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.force_source import corners_of, solve_points
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.report.whatif import best_first
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

CROWN = "crowned:radius=20,height=2,foot=9.4"
STUDY = Study(
    (4.5, 6.0),
    (15.5,),
    (("square:14", equal_area_radius_mm("square:14")),),
    tissue="forefinger",
    shapes=("slab", CROWN, "layered:top=3,modulus_ratio=5"),
)


def test_every_combination_of_ranges_lists_and_places_is_a_shape():
    assert parse_shapes("slab,crowned:radius=10:14:2,height=1/2") == (
        "slab",
        *(f"crowned:radius={r},height={h}" for r in (10, 12, 14) for h in (1, 2)),
    )
    assert parse_shapes("layered:3,5") == parse_shapes("layered:top=3,modulus_ratio=5")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("crownd:radius=1", "unknown_name"),
        ("crowned:radius=1", "missing"),
        ("crowned:radius=a,height=2", "not_a_number"),
        ("crowned:radius=5:1:1,height=2", "malformed"),
        ("crowned:size=1,height=2", "unknown_key"),
        ("", "missing"),
    ],
)
def test_what_is_no_shape_is_refused_in_words(text, code):
    with raises_code(code):
        parse_shapes(text)


def test_a_shaped_row_has_the_force_of_the_pad_asked_for_alone():
    rows = whatif(STUDY)["rows"]
    assert [(row["shape"], row["thickness_mm"]) for row in rows] == [
        (shape, thickness) for shape in STUDY.shapes for thickness in STUDY.thickness_mm
    ]
    for row in rows[2:4]:
        depth = row["depth_mm_at_N"]["10"]
        alone = predict(
            young_kPa=row["young_kPa"],
            thickness_mm=row["thickness_mm"],
            shape=row["shape"],
            punch="square:14",
            depth_mm=[depth],
        ).to_dict()
        assert alone["force_N"][0] == pytest.approx(10.0, rel=2e-3)
        assert alone["local_exponent"][0] == pytest.approx(row["exponent_at_N"]["10"], rel=0.02)
    slabs = whatif(replace(STUDY, shapes=("slab",)))["rows"]
    assert rows[:2] == slabs


def test_a_pad_that_cannot_be_cast_or_is_off_the_table_says_why_and_the_others_stand():
    study = replace(STUDY, thickness_mm=(3.0, 4.5), shapes=("crowned:radius=20,height=2.9,foot=9.4", CROWN))
    rows = whatif(study)["rows"]
    assert rows[0]["limit"] and rows[0]["depth_mm_at_N"]["5"] is None and rows[0]["score"]["total"] == 0.0
    assert rows[3]["depth_mm_at_N"]["5"] > 0.0


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"edge_radii_mm": (5.0,)}, "out_of_range"),
        ({"edge_radii_mm": (1.0,)}, "not_tabulated"),
        ({"edge_radii_mm": (5.0,), "fidelity": "axisymmetric"}, "out_of_range"),
        ({"edge_radii_mm": (1.0,), "fidelity": "axisymmetric", "conditions": ("frictionless",)}, "unsupported"),
        ({"bases": ("sliding",)}, "not_tabulated"),
        ({"fidelity": "3d", "thickness_mm": (4.5,)}, "unsupported"),
        ({"shapes": ("crowned:radius=20,height=40",)}, "cannot_be_made"),
        ({"shapes": (CROWN, CROWN)}, "duplicate"),
    ],
)
def test_what_no_model_knows_is_refused_before_any_work(changes, code):
    with raises_code(code):
        replace(STUDY, **changes).check(load_resin())


def test_progress_counts_the_designs():
    told = []
    whatif(STUDY, progress=lambda *at: told.append(at))
    assert told[0] == (0, 6) and told[-1] == (6, 6)


@pytest.mark.slow
def test_the_terminal_shows_the_best_first_with_its_shape(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asked = ["whatif", "--thickness", "4.5,8", "--ratio", "15.5", "--tissue", "forefinger", "--shape", f"slab,{CROWN}"]
    assert main_status(asked) == 0
    lines = capsys.readouterr().out.splitlines()
    head = next(row for row, line in enumerate(lines) if line.startswith("  score"))
    rows = [line.split() for line in lines[head + 1 : head + 5]]
    assert rows[0][1] == "4.5" and rows[0][-1] == CROWN
    scores = [float(row[0]) for row in rows]
    assert scores == sorted(scores, reverse=True)
    assert main_status([*asked, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["shape"] for row in rows] == ["slab", "slab", CROWN, CROWN]
    assert best_first(rows)[0]["shape"] == CROWN


def main_status(words):
    import sys

    before, sys.argv = sys.argv, ["dummydesign", *words]
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0)
    finally:
        sys.argv = before
    return 0


@pytest.mark.parametrize("punch", ["round:16", "square:14"])
def test_a_fillet_by_the_table_has_the_force_of_one_pad_asked_for_alone(punch):
    from dummydesign.geometry.punch import equal_area_radius_mm, punch_sides_mm
    from dummydesign.pad.predict import predict_static

    punches = ((punch, equal_area_radius_mm(punch)),)
    study = Study((6.0,), (15.5,), punches, edge_radii_mm=(0.0, 0.5, 2.0), forces_N=(5.0,))
    rows = whatif(study)["rows"]
    depths = [row["depth_mm_at_N"]["5"] for row in rows]
    assert depths[0] < depths[1] < depths[2]
    young_MPa = 1e-3 * rows[1]["young_kPa"]
    pad = Pad(6.0, young_MPa, equal_area_radius_mm(punch), sides_mm=punch_sides_mm(punch), edge_radius_mm=0.5)
    assert predict_static(pad, [depths[1]]).force_N[0] == pytest.approx(5.0, rel=2e-3)


@pytest.mark.slow
def test_solved_rows_have_the_force_of_the_solved_pad_and_a_fillet_makes_it_softer():
    sharp = Study((6.0,), (15.5,), STUDY.punches, fidelity="axisymmetric", edge_radii_mm=(0.0, 2.0), forces_N=(5.0,))
    rows = whatif(sharp)["rows"]
    assert rows[1]["depth_mm_at_N"]["5"] > rows[0]["depth_mm_at_N"]["5"]
    crowned = replace(sharp, shapes=(CROWN,), edge_radii_mm=(0.0,), thickness_mm=(4.5,))
    by_table = whatif(replace(crowned, fidelity="table"))["rows"][0]
    assert whatif(crowned)["rows"][0]["depth_mm_at_N"]["5"] == pytest.approx(by_table["depth_mm_at_N"]["5"], rel=0.03)
    assert np.isfinite(rows[1]["force_error_percent"])
    under_fillet = whatif(replace(crowned, edge_radii_mm=(2.0,)))["rows"][0]
    young_MPa, crown = 1e-3 * under_fillet["young_kPa"], read_shape(CROWN)
    pad = Pad(4.5, young_MPa, sharp.punches[0][1], geometry=crown, edge_radius_mm=2.0)
    depth = np.array([under_fillet["depth_mm_at_N"]["5"]])
    of_square, _ = corners_of(pad)(depth)
    assert of_square * solve_points(pad, depth).force_N == pytest.approx([5.0], rel=2e-3)
    assert depth > 1.01 * by_table["depth_mm_at_N"]["5"]
