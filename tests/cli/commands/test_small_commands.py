"""Commands of a few lines: what they ask of the rest, and what they say."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from dummydesign._version import __version__
from dummydesign.api import campaigns, health
from dummydesign.cli.commands import campaign, doctor, history, init, resins, status, studio, suggest
from dummydesign.core.errors import InputError
from dummydesign.project import folder as projects
from dummydesign.project.status import ProjectFile
from tests.support.refusal import raises_code

PAD = {"thickness_mm": 5.0, "shape": "slab", "ratio": 15.0}


def parsed(command, *words):
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    return parser.parse_args(words)


def check(name, state, advice=""):
    return {"name": name, "status": state, "value": "1.0", "advice": advice}


@pytest.mark.parametrize(
    ("rows", "ready", "words"),
    [
        ([check("a", "fine")], True, "READY"),
        ([check("a", "fine"), check("b", "missing", "pip install b")], True, "What is missing is optional."),
        ([check("a", "failed", "mend it")], False, "FAILED"),
    ],
)
def test_doctor_names_what_is_missing_with_its_remedy(monkeypatch, rows, ready, words):
    checks = [SimpleNamespace(**row) for row in rows]
    found = SimpleNamespace(checks=checks, to_dict=lambda: {"checks": rows, "ready": ready})
    asked = []
    monkeypatch.setattr(health, "check_machine", lambda cad: asked.append(cad) or found)
    options = parsed(doctor, "--no-cad")
    if ready:
        result = doctor.run(options)
    else:
        with raises_code("machine_unfit", "machine") as caught:
            doctor.run(options)
        assert "cannot be used yet: a" in str(caught.value)
        result = caught.value.result
    assert asked == [False] and result["inputs"] == {"no_cad": True}
    text = doctor.render(result)
    assert words in text and all(row["advice"] in text for row in rows)


@pytest.mark.parametrize(
    ("summary", "words"),
    [
        (None, "-"),
        ({}, "-"),
        ({**PAD, "verdict": "not_settled"}, "Measure first; slab; 5 mm, ratio 15"),
        (
            {**PAD, "verdict": "not_settled", "usable_fraction": 0.62, "correction_factor": 1.07},
            "Measure first; 62 % usable; x 1.07; slab; 5 mm, ratio 15",
        ),
        ({"thickness_mm": 10.0}, "-"),
        ({"verdict": "explained", "effects": ["adhesion", "inertia"]}, "explained; adhesion, inertia"),
        ({"effects": []}, "no effect"),
    ],
)
def test_history_says_in_a_few_words_what_an_answer_came_to(summary, words):
    row = {"date": "2026-01-02T03:04:05+00:00", "command": "suggest", "folder": "designs/a", "summary": summary}
    result = {"inputs": {"folder": "."}, "answers": [row]}
    line = history.render(result).splitlines()[-1]
    assert line.split(None, 4)[-1] == words
    assert "2026-01-02 03:04" in line and history.render_details(result) == history.render(result)


@pytest.mark.parametrize(("folder", "words"), [(".", "this folder"), ("old", "folder 'old'")])
def test_a_folder_without_answers_says_how_to_make_one(folder, words):
    result = {"inputs": {"folder": folder}, "answers": []}
    assert f"No answers in {words}." in history.render(result)
    assert history.render_details(result) == history.render(result)


def test_history_reads_the_folder_that_is_named(tmp_path):
    assert history.run(parsed(history, str(tmp_path)))["answers"] == []
    assert parsed(history).folder == "."


def test_init_makes_a_project_with_the_names_that_are_known_and_refuses_others(tmp_path):
    made = tmp_path / "lab"
    words = ("--tissue", "palm", "--aim", "safe-side", "--resin", "polyurethane-nagoya")
    result = init.run(parsed(init, str(made), *words))
    project = projects.read_project(made)
    assert (project.name, project.tissue) == ("lab", "palm")
    assert result["files"]["project"] == str(project.root / "project.toml")
    assert f"project 'lab' in {project.root}" in init.render(result)
    for words in (["--tissue", "plam"], ["--resin", "poly"], ["--tissue", "palm", "--aim", "subject:nobody"]):
        with pytest.raises(InputError):
            init.run(parsed(init, str(tmp_path / "other"), *words))
        assert not (tmp_path / "other").exists()


@pytest.mark.parametrize(
    ("summary", "words"),
    [
        ({"pressed": 3, "missing": 1, "wrong": 0}, "3 of 4 presses are there"),
        ({"pressed": 3, "missing": 1, "wrong": 1}, "3 of 4 presses are there, 1 problem"),
        ({"pressed": 3, "missing": 0, "wrong": 2}, "3 of 3 presses are there, 2 problems"),
        (PAD, "5 mm slab, ratio 15"),
        ({**PAD, "verdict": "not_settled"}, "5 mm slab, ratio 15: Measure first"),
        ({"traces": 4}, "4 presses"),
        ({"effects": [], "verdict": "explained"}, "explained: no effect"),
        (None, "suggest"),
    ],
)
def test_status_says_what_is_known_of_each_thing(summary, words):
    assert ProjectFile("designs/a", "suggest", "", summary).line == words


def test_status_needs_a_project(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with raises_code("file_not_found", "project"):
        status.run(parsed(status))
    projects.make_project(tmp_path / "lab", None)
    result = status.run(parsed(status, str(tmp_path / "lab")))
    assert result["name"] == "lab" and "project 'lab'" in status.render(result)
    assert status.render_details(result).splitlines()[-2].startswith("next: ")


@pytest.mark.parametrize(("words", "folder"), [([], None), (["x"], "x")])
def test_studio_opens_the_project_of_this_folder_or_the_one_that_is_named(tmp_path, monkeypatch, words, folder):
    from dummydesign.studio import app

    monkeypatch.setattr(app, "run_studio", lambda *given: {"folder": given[0], "given": given[:3]})
    projects.make_project(tmp_path / "lab", None)
    for place, wanted in ((tmp_path, "."), (tmp_path / "lab", str(tmp_path / "lab"))):
        monkeypatch.chdir(place)
        result = studio.run(parsed(studio, *words, "--port", "8500", "--no-browser"))
        assert result["given"] == (folder or wanted, 8500, False)
    assert studio.render({"folder": "lab"}) == "studio of lab ended"
    # a damaged project is opened too: the page says what is damaged
    (tmp_path / "lab" / "project.toml").write_text("name = ", encoding="utf-8")
    assert studio.run(parsed(studio))["given"] == (".", None, True)


@dataclass
class Wrong:
    wrong: tuple = ({"file": "a"}, {"file": "b"})

    def to_dict(self):
        return {"wrong": list(self.wrong)}


@pytest.mark.parametrize(("count", "words"), [(0, ""), (1, "1 problem in"), (2, "2 problems in")])
def test_a_campaign_with_problems_is_no_answer(monkeypatch, count, words):
    options = parsed(campaign, "check", "thumb")
    monkeypatch.setattr(campaigns, "check_campaign", lambda folder: Wrong(Wrong.wrong[:count]))
    if not count:
        assert campaign.run(options) == {"wrong": []}
        return
    with raises_code("campaign_wrong", "campaign") as caught:
        campaign.run(options)
    assert words in str(caught.value) and len(caught.value.result["wrong"]) == count


def test_a_broken_resin_of_the_user_hides_no_other(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    (tmp_path / "materials" / "resins").mkdir(parents=True)
    (tmp_path / "materials" / "resins" / "broken.toml").write_text("title = ", encoding="utf-8")
    result = resins.run(parsed(resins, "list"))
    assert [one["code"] for one in result["warnings"]] == ["unreadable_resin"]
    names = [one["name"] for one in result["resins"]]
    assert "polyurethane-nagoya" in names and "broken" not in names
    for one in result["resins"]:
        low, high = one["young_kPa_range"]
        assert low <= high and one["ratio_range"][0] <= one["ratio_range"][1] and len(one["hardness"]) == 2


def press(**more):
    given = {"steady_force_N": 10.0, "velocity_mm_s": 250.0, "depth_mm": 2.5, "depth_over_thickness": 0.25}
    given |= {"gel_compression": 0.3, "peak_force_N": 21.0, "inside_fraction": 0.9, "reads": "inside"}
    return {**given, "target_peak_low_N": 18.0, "target_peak_high_N": 22.0, "out_of_reach": "too deep", **more}


def test_details_of_a_press_have_its_range_or_why_it_is_out_of_reach():
    assert suggest._press(press()) == [10.0, 250.0, 2.5, 0.25, 0.3, 21.0, "18.0 to 22.0", 0.9, "inside"]
    assert suggest._press(press(depth_mm=None)) == [10.0, 250.0, "too deep"]


def test_parameters_are_listed_with_their_units_and_dampers_by_speed():
    parameters = {"gamma1_N_per_mm3": 0.0512, "c2_N_s_per_mm": {"10": 1.25, "250": 0.5}}
    best = {"parameters_law": "ode", "parameters": parameters}
    lines = suggest._parameters(best)
    assert lines[2].split() == ["gamma1", "0.0512", "N/mm3"]
    assert lines[3].endswith("1.25 at 10 mm/s, 0.5 at 250 mm/s N s/mm")
    assert suggest._parameters({"parameters": None}) == []


def test_forces_of_the_shapes_are_those_of_the_test_and_a_fifth_of_the_lowest():
    assert suggest._forces({"inputs": {"force_N": [15.0, 5.0, 10.0]}}) == (5.0, 15.0, ("1", "5", "15"))


@pytest.mark.parametrize(
    ("acceptable", "shape", "named"), [(False, "boned:1", True), (True, "boned:1", False), (False, "slab", False)]
)
def test_a_pad_with_a_better_score_that_is_not_acceptable_is_named(acceptable, shape, named):
    rows = [
        {"shape": shape, "kind": "boned", "total": 0.8, "acceptable": acceptable},
        {"shape": "slab", "kind": "slab", "total": 0.6, "acceptable": True},
        {"shape": None, "kind": "layered", "total": 0.0, "acceptable": False},
    ]
    lines = suggest._passed_over({"shapes": rows, "recommendation": {"shape": "slab"}})
    assert bool(lines) is named and all("--shape boned" in line for line in lines)


def test_the_version_is_that_of_the_package_and_of_its_changelog():
    import re
    from pathlib import Path

    import dummydesign

    assert dummydesign.__version__ is __version__ and re.fullmatch(r"\d+\.\d+\.\d+", __version__)
    changes = (Path(__file__).parents[3] / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"[{__version__}]" in changes and sys.modules["dummydesign._version"].__version__ == __version__
