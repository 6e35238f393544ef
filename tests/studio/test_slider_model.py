"""The pad under the sliders is the pad of the command line: same punch, same calibration, same verdict."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dummydesign.core.errors import DummydesignError, accepts
from dummydesign.core.user_library import find
from dummydesign.design.plot_data import force_grids
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.suggest import design
from dummydesign.geometry.punch import read_punch
from dummydesign.geometry.shape_registry import read_shape, shape_kind
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.studio import figures
from dummydesign.studio.slider_model import evaluator_of
from dummydesign.studio.state import State
from tests.support.made_calibration import calibration, effect
from tests.support.refusal import raises_code

CROWN, RESIN = "crowned:20,2,9", "polyurethane-nagoya"


def looked(root, shape, thickness_mm, ratio, **asked):
    evaluator = evaluator_of(root, State("forefinger", **asked))
    pad = evaluator.evaluate(read_shape(shape), thickness_mm, ratio)
    return evaluator.problem, pad, evaluator.with_castings(read_shape(shape), thickness_mm, ratio)


def suggested(shape, thickness_mm, ratio, **more):
    return design(
        read_problem(
            Request(
                "forefinger", thickness_mm=(thickness_mm,) * 2, ratio=(ratio,) * 2, shape=shape, verify=False, **more
            )
        )
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("punch", "shape", "thickness_mm"), [("round:20", "slab", 9.0), ("round:20", CROWN, 9.0), ("square:14", CROWN, 9.0)]
)
def test_the_verdict_and_the_curve_are_those_of_suggest_under_the_same_punch(tmp_path, punch, shape, thickness_mm):
    _, pad, verdict = looked(tmp_path, shape, thickness_mm, 15.0, punch=punch)
    found = suggested(shape, thickness_mm, 15.0, punch=punch)
    grids = force_grids(found.targets.protocol)
    depth, wanted = (one.steady_depth_mm(grids.pad) for one in (pad.candidate, found.best))
    assert np.allclose(depth, wanted, rtol=1e-9, equal_nan=True)
    assert verdict == found.verdict


def test_a_wider_punch_sinks_in_less(tmp_path):
    force = np.array([5.0, 10.0])
    narrow, wide = (looked(tmp_path, "slab", 9.0, 15.0, punch=punch)[1] for punch in ("square:14", "round:20"))
    assert (wide.candidate.steady_depth_mm(force) < 0.95 * narrow.candidate.steady_depth_mm(force)).all()


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["slab", CROWN])
def test_a_calibration_is_in_the_pad_of_every_shape_as_suggest_has_it(tmp_path, shape):
    learned = calibration(effect("strain_stiffening", coefficient=2.0))
    path = write_calibration(learned, tmp_path / "calibration.json")
    _, pad, verdict = looked(tmp_path, shape, 9.0, 15.0, calibration="calibration.json")
    found = suggested(shape, 9.0, 15.0, calibration=str(path))
    grids = force_grids(found.targets.protocol)
    depth = pad.candidate.steady_depth_mm(grids.pad)
    assert np.allclose(depth, found.best.steady_depth_mm(grids.pad), rtol=1e-9, equal_nan=True)
    assert verdict.text == found.verdict.text
    stiff = calibration()
    write_calibration(stiff, tmp_path / "plain.json")
    plain = looked(tmp_path, shape, 9.0, 15.0, calibration="plain.json")[1].candidate.steady_depth_mm(grids.pad)
    deep = np.isfinite(depth) & np.isfinite(plain) & (plain > 2.0)
    assert deep.any() and (depth[deep] < 0.99 * plain[deep]).all()


def drawn_pads(number, seed):
    """Pads of every kind that the tables hold, of any thickness and ratio of their sliders, for several tissues."""
    draw = np.random.default_rng(seed)
    tissues, kinds, resins = ["forefinger", "palm", "thenar"], ["slab", "crowned", "boned", "layered"], [RESIN]
    while number:
        tissue, kind, resin = (str(draw.choice(one)) for one in (tissues, kinds, resins))
        thickness_mm, ratio = round(draw.uniform(3.5, 25.0), 1), round(draw.uniform(14.0, 17.0), 2)
        evaluator = evaluator_of(Path("none"), State(tissue, resin=resin))
        _, columns = shape_kind(kind).candidates(np.array([thickness_mm]), evaluator.problem.punch.radius_mm)
        rows = np.column_stack(list(columns.values())) if columns else np.zeros((1, 0))
        row = rows[draw.integers(len(rows))] if len(rows) else None
        shape = None if row is None else shape_kind(kind).of(dict(zip(columns, map(float, row))))
        if shape is not None and accepts(evaluator.evaluate, shape, thickness_mm, ratio):
            number -= 1
            yield evaluator, shape, thickness_mm, ratio


def light_shares_factor(judge, *pad):
    """What a judge says of a pad; why there is no answer where it refuses."""
    try:
        verdict = judge(*pad)
    except DummydesignError as refused:
        return refused.code
    return verdict.light, verdict.castings, verdict.correction, verdict.text


@pytest.mark.parametrize(("number", "seed"), [(2, 1), pytest.param(100, 2, marks=pytest.mark.slow)])
def test_light_shares_and_factor_of_drawn_pads_are_those_of_the_command_for_the_same_pad(number, seed):
    lights = []
    for evaluator, shape, thickness_mm, ratio in drawn_pads(number, seed):
        asked = evaluator.problem.request
        held = {"shape": str(shape), "thickness_mm": (thickness_mm,) * 2, "ratio": (ratio,) * 2}
        page = light_shares_factor(evaluator.with_castings, shape, thickness_mm, ratio)
        command = light_shares_factor(lambda request: design(read_problem(request)).verdict, replace(asked, **held))
        assert page == command, (asked.tissue, shape, thickness_mm, ratio)
        lights.append(page[0] if isinstance(page, tuple) else page)
    assert len(set(lights)) > 1, lights


def test_a_pad_is_judged_at_the_ratio_of_the_slider_and_not_at_a_better_one(tmp_path):
    """The best ratio of this pad is usable; these are not, or reach no force."""
    evaluator = evaluator_of(tmp_path, State("palm"))
    shape = read_shape("crowned:2.4,3.5,7.8")
    with raises_code("no_feasible_design", "pad"):
        evaluator.with_castings(shape, 11.0, 14.0)
    verdict = evaluator.with_castings(shape, 11.0, 17.0)
    assert verdict.light == "red" and "100 % of an average batch" not in verdict.text


def test_what_no_table_has_under_a_punch_is_refused_by_name_before_anything_is_solved(tmp_path):
    with raises_code("not_tabulated", "punch"):
        looked(tmp_path, "slab", 9.0, 15.0, punch="ball:20")
    with raises_code("not_tabulated", "punch"):
        looked(tmp_path, "slab", 30.0, 15.0, punch="round:20")


def test_a_punch_from_a_file_of_the_project_is_read_from_its_folder(tmp_path):
    (tmp_path / "tip.csv").write_text("r_mm,z_mm\n0,0\n3,0.5\n6,2\n8,5\n", encoding="utf-8")
    with raises_code("not_tabulated", "punch"):
        looked(tmp_path, "slab", 9.0, 15.0, punch="profile:tip.csv")
    with raises_code("file_not_found", "punch_profile"):
        looked(tmp_path, "slab", 9.0, 15.0, punch="profile:other.csv")
    (tmp_path / "led-out.csv").symlink_to("/etc/passwd")
    for outside in ("/etc/passwd", "../tip.csv", "led-out.csv"):
        with raises_code("not_allowed", "path"):
            looked(tmp_path, "slab", 9.0, 15.0, punch=f"profile:{outside}")


@pytest.mark.parametrize(("punch", "half"), [("square:14", 7.0), ("round:20", 10.0), ("rectangle:20x10", 5.0)])
def test_the_cross_section_shows_the_punch_that_presses(punch, half):
    drawn = figures.section(read_shape(CROWN), 9.0, read_punch(punch))
    outline = next(one for one in drawn.series if one.label == f"punch, {punch}")
    assert np.isclose(np.abs(outline.x).max(), half) and outline.y.min() > 9.0


def test_a_ball_over_the_pad_is_round():
    drawn = figures.section(read_shape("slab"), 9.0, read_punch("ball:20"))
    outline = next(one for one in drawn.series if one.label == "punch, ball:20")
    low = outline.y - outline.y.min()
    near = np.abs(outline.x) < 5.0
    assert np.allclose(low[near], 10.0 - np.sqrt(100.0 - outline.x[near] ** 2), atol=0.02)


def test_a_resin_of_the_user_that_changed_is_read_anew(tmp_path, monkeypatch):
    """A library name, whose file lies in the user's folder: 25 kPa, then 40."""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    folder = tmp_path / "home" / "materials" / "resins"
    folder.mkdir(parents=True)
    text = find("materials/resins", "resin", "polyurethane-nagoya").path.read_text(encoding="utf-8")
    own = folder / "mine.toml"
    own.write_text(text.replace('name = "polyurethane-nagoya"', 'name = "mine"'), encoding="utf-8")
    state = State("forefinger", resin="mine")
    before = evaluator_of(tmp_path, state).problem.resin.young_MPa(15.0)
    stiffer = "[modulus.young_ref_kPa]\nvalue = 40.0"
    own.write_text(own.read_text(encoding="utf-8").replace("[modulus.young_ref_kPa]\nvalue = 25.0", stiffer), "utf-8")
    after = evaluator_of(tmp_path, state).problem.resin.young_MPa(15.0)
    assert after / before == pytest.approx(1.6, rel=1e-6)
