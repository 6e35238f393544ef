"""One state for all pages: the address, then the design that it names, then the project's own choice."""

from __future__ import annotations

import json
from urllib.parse import parse_qsl

import numpy as np
import pytest

from dummydesign.design.pad_evaluator import NotTabulated
from dummydesign.geometry.shape_registry import read_shape, shape_kinds
from dummydesign.project import status
from dummydesign.project.folder import change_project, make_project
from dummydesign.studio import project_index
from dummydesign.studio.pages.search import question_of
from dummydesign.studio.slider_model import evaluator_of, first_pad, first_shape, lengths_of
from dummydesign.studio.state import State, read_state


def design(project, name, thickness_mm, tissue="forefinger", date="2026-01-01", **inputs):
    """A folder as ``suggest`` leaves it, as far as the studio reads it."""
    folder = project.root / "designs" / name
    folder.mkdir(parents=True)
    manifest = {
        "command": "suggest",
        "finished": True,
        "date": date,
        "inputs": {"tissue": tissue, "aim": "average", "punch": "square:14", "calibration": None, **inputs},
        "summary": {
            "shape": "crowned:radius=20,height=2,foot=9",
            "thickness_mm": thickness_mm,
            "ratio": 15.5,
            "resin": "polyurethane-nagoya",
            "verdict": "not_settled",
            "text": "Not settled.",
        },
    }
    (folder / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")


@pytest.fixture
def project(tmp_path):
    return make_project(tmp_path / "thumb", tissue="forefinger")


def test_a_state_comes_back_from_its_own_address(project):
    state = read_state(project, {}).changed(
        tissue="palm", aim="safe-side", shape="crowned:radius=21.2,height=2,foot=9.4", thickness_mm=4.55, ratio=15.35
    )
    assert read_state(project, dict(parse_qsl(state.query()))) == state


def test_without_an_address_the_newest_design_of_the_chosen_tissue_is_shown(project):
    design(project, "a", 7.0, date="2026-01-01")
    design(project, "b", 8.0, date="2026-01-02")
    design(project, "c", 9.0, tissue="palm", date="2026-01-03")
    state = read_state(project, {})
    assert (state.tissue, state.thickness_mm, state.design) == ("forefinger", 8.0, "designs/b")
    assert read_state(project, {"tissue": "palm"}).design == "designs/c"
    assert read_state(project, {"design": "designs/a"}).thickness_mm == 7.0


@pytest.mark.parametrize("path", ["/etc/passwd", "../tip.csv", "./.studio/address"])
def test_an_address_names_no_punch_outside_the_project(project, path):
    assert read_state(project, {"punch": f"profile:{path}"}).punch == "square:14"
    assert read_state(project, {"punch": "profile:tip.csv"}).punch == "profile:tip.csv"


def test_a_design_brings_its_calibration_and_a_changed_pad_is_no_longer_that_design(project):
    (project.root / "calibrations" / "x").mkdir(parents=True)
    (project.root / "calibrations" / "x" / "calibration.json").write_text("{}", encoding="utf-8")
    design(project, "a", 7.0, calibration="calibrations/x/calibration.json")
    state = read_state(project, {"design": "designs/a"})
    assert state.calibration == "calibrations/x/calibration.json" and not state.missing
    assert state.changed(campaign="campaigns/y").design == "designs/a"
    for change in ({"thickness_mm": 7.1}, {"tissue": "palm"}, {"calibration": ""}, {"ratio": 16.0}):
        assert state.changed(**change).design == ""
    assert read_state(project, {"design": "designs/a", "thickness_mm": "7.5"}).design == ""


@pytest.mark.parametrize(
    ("query", "what"),
    [
        ({"tissue": "tissue/gone.toml"}, "tissue/gone.toml"),
        ({"resin": "gone"}, "gone"),
        ({"calibration": "calibrations/gone/calibration.json"}, "calibrations/gone"),
        ({"campaign": "campaigns/gone"}, "campaigns/gone"),
        ({"design": "designs/gone"}, "designs/gone"),
        ({"aim": "subject:nobody"}, "subject:nobody"),
    ],
)
def test_what_is_missing_stays_chosen_and_is_said(project, query, what):
    state = read_state(project, query)
    assert len(state.missing) == 1 and what in state.missing[0]
    name, value = next(iter(query.items()))
    assert name == "design" or getattr(state, name) == value


@pytest.mark.parametrize("path", ["../secret", "/etc", "designs/../../x", ".studio/jobs"])
def test_a_path_of_an_address_that_leaves_the_project_is_passed_over(project, path):
    for name in ("design", "calibration", "campaign"):
        assert path not in read_state(project, {name: path}).query()
    assert read_state(project, {"tissue": f"{path}.toml"}).tissue == "forefinger"


def test_numbers_of_an_address_that_are_none_are_passed_over(project):
    for text in ("nan", "-5", "inf", "1e9", "x", "0"):
        state = read_state(project, {"thickness_mm": text, "ratio": text})
        assert np.isfinite(state.thickness_mm) and 0.0 < state.thickness_mm < 100.0
        assert 0.0 < state.ratio < 100.0


def test_what_project_toml_says_by_now_wins_over_an_older_design(project):
    design(project, "a", 7.0)
    asked = change_project(project, punch="round:12")
    state = read_state(asked, {})
    assert (state.punch, state.design) == ("round:12", "")
    design(project, "b", 8.0, date="2026-01-02", punch="round:12")
    assert read_state(asked, {}).design == "designs/b"


def test_no_calibration_is_a_choice_that_an_address_keeps(project):
    asked = change_project(project, calibration="calibrations/x/calibration.json")
    state = read_state(asked, {})
    assert state.calibration == "calibrations/x/calibration.json"
    without = state.changed(calibration="")
    assert read_state(asked, dict(parse_qsl(without.query(), keep_blank_values=True))).calibration == ""


def test_a_design_that_is_gone_is_no_longer_the_source_of_the_pad(project):
    design(project, "a", 7.0)
    state = read_state(project, {"design": "designs/a"})
    (project.root / "designs" / "a").rename(project.root / "designs" / "b")
    later = read_state(project, dict(parse_qsl(state.query())))
    assert (later.design, later.thickness_mm, len(later.missing)) == ("", 7.0, 1)
    assert project_index.design_of_pad(project.root, later).folder == "designs/b"


def test_the_design_for_what_is_asked_says_whether_a_pad_may_be_cast(project):
    design(project, "mine", 7.0, date="2026-01-01")
    design(project, "for-another-tissue", 7.0, tissue="palm", date="2026-01-02")
    state = read_state(project, {"design": "designs/mine"}).changed(design="")
    assert project_index.design_of_pad(project.root, state).folder == "designs/mine"
    palm = state.changed(tissue="palm")
    assert project_index.design_of_pad(project.root, palm).folder == "designs/for-another-tissue"
    thigh = state.changed(aim="safe-side")
    assert not project_index.design_of_pad(project.root, thigh).answers(thigh)


def test_a_search_without_a_punch_is_for_the_one_it_used_not_for_the_one_of_today(project):
    words = ["suggest", "--tissue", "palm", "--aim", "average", "--resin", "polyurethane-nagoya"]
    assert question_of(words, {"inputs": {"punch": "round:12"}})["punch"] == "round:12"
    assert question_of(words, {})["punch"] == State("palm").punch


def test_a_search_belongs_to_the_question_it_was_asked(project):
    words = [
        "suggest",
        "--tissue",
        "palm",
        "--aim",
        "average",
        "--resin",
        "polyurethane-nagoya",
        "--shape",
        "auto",
        "--no-cad",
        "--out",
        "designs/suggest-palm",
    ]
    assert question_of(words, {}) == State("palm").question
    assert question_of([*words, "--calibration", "calibrations/a/calibration.json"], {}) != State("palm").question


@pytest.mark.parametrize("kind", sorted(set(shape_kinds()) - {"slab"}))
@pytest.mark.parametrize("thickness_mm", [3.0, 4.5, 9.0, 20.0, 30.0])
def test_every_kind_begins_with_lengths_that_can_be_made(kind, thickness_mm):
    shape = first_shape(kind, thickness_mm, 7.9, lambda shape: True)
    shape.check(thickness_mm)
    for one in lengths_of(kind, thickness_mm, 7.9):
        assert one.low < one.high and one.step > 0.0


@pytest.mark.parametrize("thickness_mm", [3.0, 4.5, 9.0, 20.0])
@pytest.mark.parametrize("kind", ["crowned", "layered", "boned"])
def test_the_start_of_a_kind_is_pressed_by_the_tables_as_far_as_they_reach(tmp_path, kind, thickness_mm):
    state = State("forefinger", thickness_mm=thickness_mm)
    evaluator, shape = evaluator_of(tmp_path, state), first_pad(tmp_path, state, kind)
    shape.check(thickness_mm)
    if thickness_mm / 7.9 < 0.5:  # where the tables end
        with pytest.raises(NotTabulated):
            evaluator.evaluate(shape, thickness_mm, 15.0)
        return
    pad = evaluator.evaluate(shape, thickness_mm, 15.0)
    assert np.isfinite(pad.candidate.steady_depth_mm(np.array([0.5]))).all()


def test_lengths_that_a_table_ties_together_follow_each_other():
    boned = read_shape("boned:10.7,2.2,6.5").with_length("height", 1.5)
    assert boned.radius_mm == pytest.approx((6.5**2 + 1.5**2) / 3.0, abs=0.005) and boned.foot_mm == 6.5
    crowned = read_shape("crowned:20,2,9").with_length("height", 2.5)
    assert (crowned.radius_mm, crowned.height_mm, crowned.foot_mm) == (20.0, 2.5, 9.0)


@pytest.mark.parametrize("name", ["tissue", "resin"])
@pytest.mark.parametrize("path", ["/dev/zero", "/etc/passwd", "../../etc/passwd", "/dev/zero.toml"])
def test_an_address_names_no_file_outside_of_the_project(project, name, path):
    state = read_state(project, {name: path})
    assert getattr(state, name) == getattr(read_state(project, {}), name) and state.missing == ()


def test_a_state_is_read_without_reading_the_presses_of_campaigns(project, monkeypatch):
    """A page and its timers ask for the designs: five pressed campaigns took 5 s each time."""
    (project.root / "campaigns" / "a").mkdir(parents=True)
    (project.root / "campaigns" / "a" / "campaign.toml").write_text("", encoding="utf-8")

    def read(path):
        raise AssertionError(f"{path} was read")

    monkeypatch.setattr(status, "check_campaign", read)
    design(project, "b", 7.0)
    state = read_state(project, {})
    assert (state.design, state.campaign) == ("designs/b", "campaigns/a")
    with pytest.raises(AssertionError):
        status.status_of(project)
