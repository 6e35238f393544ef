"""Pads that were pressed: those of campaigns by pad, imports, files that were dropped; each with its own test."""

from __future__ import annotations

import json

import pytest

from dummydesign.core.errors import InputError
from dummydesign.project.folder import make_project
from dummydesign.studio import project_index as pressed_pads
from dummydesign.studio.state import read_state

TRACE = "time_s,displacement_mm,force_N\n" + "".join(
    f"{0.01 * k:.2f},{min(0.02 * k, 1.0):.3f},{min(0.06 * k, 3.0):.3f}\n" for k in range(200)
)
PLAN = """schema = 1
name = "first"
[pad]
young_kPa_nominal = 25.0
shape = "slab"
[punch]
shape = "round"
diameter_mm = 12.0
[sensor]
lowpass_hz = 35.0
lowpass_order = 2
lowpass_passes = 1
""" + "".join(
    f'[[trial]]\nfile = "t{pad}_{k}.csv"\nthickness_mm = {pad}.0\nvelocity_mm_s = 10.0\n'
    for pad in (6, 15)
    for k in (1, 2, 3)
)


@pytest.fixture
def project(tmp_path):
    made = make_project(tmp_path / "thumb", tissue="forefinger")
    folder = made.root / "campaigns" / "first"
    folder.mkdir(parents=True)
    (folder / "campaign.toml").write_text(PLAN, encoding="utf-8")
    for name in ("t6_1", "t6_3", "t15_2"):
        (folder / f"{name}.csv").write_text(TRACE, encoding="utf-8")
    return made


def test_a_campaign_gives_a_pad_for_each_thickness_with_the_presses_that_are_there(project):
    state = read_state(project, {})
    found = pressed_pads.pads(project.root, state)
    assert [one.label.partition(":")[0] for one in found] == ["campaigns/first"] * 2
    assert found[0].files == ("campaigns/first/t6_1.csv", "campaigns/first/t6_3.csv")
    assert found[1].files == ("campaigns/first/t15_2.csv",)
    assert {one.punch for one in found} == {"round:12"} and {one.lowpass for one in found} == {"35:2:1"}
    assert found[0].campaign == "campaigns/first" and found[0].thickness_mm == 6.0


@pytest.mark.parametrize("sensor", ['lowpass_hz = "35"', "lowpass_order = 2"])
def test_a_campaign_whose_filter_has_another_form_keeps_its_pads(project, sensor):
    plan = PLAN.replace("lowpass_hz = 35.0\nlowpass_order = 2", sensor)
    (project.root / "campaigns" / "first" / "campaign.toml").write_text(plan, encoding="utf-8")
    assert [one.lowpass for one in pressed_pads.pads(project.root, read_state(project, {}))] == ["", ""]


def test_the_pad_that_is_chosen_is_taken_first(project):
    state = read_state(project, {"thickness_mm": "15"})
    found = pressed_pads.pads(project.root, state)
    assert pressed_pads.nearest(found, state).thickness_mm == 15.0
    assert pressed_pads.nearest(found, state.changed(thickness_mm=9.0)) is found[0]
    assert pressed_pads.nearest([], state) is None


def test_imports_and_dropped_files_are_pads_too_and_take_the_punch_that_is_chosen(project):
    root = project.root
    (root / "measured" / "import-a").mkdir(parents=True)
    (root / "measured" / "import-a" / "x.csv").write_text(TRACE, encoding="utf-8")
    pressed_pads.keep_press(root, "mine.csv", TRACE.encode())
    found = pressed_pads.pads(root, read_state(project, {"punch": "ball:9"}))
    assert [one.files for one in found[2:]] == [("measured/cast-pad/mine.csv",), ("measured/import-a/x.csv",)]
    assert {one.punch for one in found[2:]} == {"ball:9"} and not found[2].campaign


def test_a_file_that_is_no_trace_is_refused_and_not_kept(project):
    for name, content in (("words.csv", b"no numbers\n"), ("../evil.csv", TRACE.encode()), ("nothing.csv", b"")):
        with pytest.raises(InputError) as problem:
            pressed_pads.keep_press(project.root, name, content)
        assert name in str(problem.value)
    assert not list(project.root.parent.rglob("evil.csv"))
    assert not list((project.root / "measured").rglob("*.csv"))


def test_records_are_those_of_the_moulds_of_the_pad(project):
    for name, thickness in (("a", 6.0), ("b", 15.0)):
        folder = project.root / "moulds" / name
        folder.mkdir(parents=True)
        inputs = {
            "shape": "slab",
            "thickness_mm": thickness,
            "length_mm": 150.0,
            "width_mm": 120.0,
            "preset": "open",
            "resin": "polyurethane-nagoya",
            "ratio": 15.0,
        }
        told = {"command": "mold", "finished": True, "date": "", "inputs": inputs}
        (folder / "manifest.json").write_text(json.dumps(told), encoding="utf-8")
        (folder / "record.json").write_text("{}", encoding="utf-8")
    found = pressed_pads.pads(project.root, read_state(project, {}))
    assert pressed_pads.records(project.root, found[0]) == ["moulds/a/record.json"]
    assert pressed_pads.records(project.root, found[1]) == ["moulds/b/record.json"]


def test_gauge_points_are_those_of_the_mould_by_name(project):
    folder = project.root / "moulds" / "a"
    folder.mkdir(parents=True)
    points = [
        {
            "name": "tip",
            "x_mm": 0.0,
            "y_mm": 0.0,
            "nominal_mm": 4.5,
            "low_mm": 4.37,
            "high_mm": 4.64,
            "gel_mm": 4.5,
            "pressed": True,
        }
    ]
    (folder / "spec.json").write_text(json.dumps({"gauge_points": points}), encoding="utf-8")
    assert [(one.name, one.low_mm, one.high_mm) for one in pressed_pads.gauge_points(folder)] == [("tip", 4.37, 4.64)]
    assert list(pressed_pads.gauge_points(project.root)) == []
