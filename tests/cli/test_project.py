"""``init`` and ``status``, and commands run inside a project folder."""

import json
from pathlib import Path

import pytest

from dummydesign.cli.entry import run


@pytest.fixture
def inside(tmp_path, monkeypatch, capsys):
    assert run(["init", str(tmp_path / "thumb"), "--tissue", "forefinger", "--shape", "crowned"]) == 0
    monkeypatch.chdir(tmp_path / "thumb" / "designs")
    capsys.readouterr()
    return tmp_path / "thumb"


@pytest.mark.slow
def test_commands_inside_take_tissue_and_place_from_the_project(inside, capsys):
    assert run(["suggest", "--no-cad", "--no-verify", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["inputs"]["tissue"] == "forefinger" and found["inputs"]["shape"] == "crowned"
    folder = inside / "designs" / "suggest-forefinger"
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["summary"]["thickness_mm"] == found["recommendation"]["thickness_mm"]
    assert manifest["command_line"].startswith("dummydesign suggest --tissue forefinger --shape crowned --no-cad")
    assert run(["status", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["found"]["designs"][0]["folder"] == "designs/suggest-forefinger"
    assert told["next"]["command"].startswith("dummydesign mold --thickness")
    assert run(["status"]) == 0 and "make the mould" in capsys.readouterr().out


def test_a_flag_and_an_out_that_are_typed_win(inside, capsys):
    words = ["whatif", "--tissue", "palm", "--thickness", "5", "--velocity", "10", "--out", "mine", "--json"]
    assert run(words) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["inputs"]["tissue"] == "palm" and Path("mine", "report.html").is_file()


@pytest.mark.parametrize("words", [["status"], ["suggest"], ["mold", "--thickness", "5"], ["compare", "a.csv"]])
def test_a_damaged_project_is_one_line_and_exit_2(inside, capsys, words):
    (inside / "project.toml").write_text("schema = 1\ntissue = ", encoding="utf-8")
    assert run(words) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "project.toml: not valid TOML" in said.err


def test_a_damaged_project_stops_neither_help_nor_lists(inside, capsys):
    (inside / "project.toml").write_text("schema = 1\ntissue = ", encoding="utf-8")
    assert run(["tissues", "list"]) == 0
    with pytest.raises(SystemExit) as ended:
        run(["suggest", "--help"])
    assert ended.value.code == 0


def test_status_outside_of_a_project_and_init_of_unknown_names_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["status"]) == 2 and "dummydesign init" in capsys.readouterr().err
    assert run(["init", "a", "--tissue", "palms"]) == 2 and "did you mean 'palm'" in capsys.readouterr().err
    assert not (tmp_path / "a").exists()
    assert run(["init", "a"]) == 0 and run(["init", "a"]) == 2


def test_without_a_project_nothing_is_added(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["suggest"]) == 2 and "--tissue" in capsys.readouterr().err
