"""Past answers: every finished manifest, the newest first, nothing else."""

from __future__ import annotations

import json

import pytest

from dummydesign.cli import run
from dummydesign.project.status import history_of


def answer(folder, command, date, **more):
    folder.mkdir(parents=True, exist_ok=True)
    content = {"command": command, "date": date, "finished": True, **more}
    (folder / "manifest.json").write_text(json.dumps(content), encoding="utf-8")


def test_the_newest_is_first_and_what_is_not_finished_is_left_out(tmp_path):
    answer(tmp_path / "a", "suggest", "2026-01-01T00:00:00", summary={"verdict": "usable_with_correction"})
    answer(tmp_path / "b" / "c", "loop", "2026-02-01T00:00:00", summary={"effects": ["adhesion"]})
    answer(tmp_path / "half", "suggest", "2026-03-01T00:00:00", finished=False)
    answer(tmp_path / ".hidden", "suggest", "2026-03-01T00:00:00")
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "manifest.json").write_text("{")
    answer(tmp_path / "anna-report", "fit", "2025")
    found = history_of(tmp_path)
    assert [(one.folder, one.command) for one in found] == [("b/c", "loop"), ("a", "suggest"), ("anna-report", "fit")]
    assert history_of(tmp_path / "half") == ()


@pytest.mark.slow
def test_an_answer_is_listed_with_its_verdict_share_and_correction(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run(["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify", "--out", "palm", "-q", "--json"])
    made = json.loads(capsys.readouterr().out)
    assert run(["history", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["answers"]
    assert row["folder"] == "palm" and row["summary"]["verdict"] and row["summary"]["shape"] == "slab"
    decides = made["shares"]["after_puck"]
    assert row["summary"]["usable_fraction"] == decides["usable"]
    assert row["summary"].get("correction_factor") == (None if made["verdict"]["light"] == "red" else decides["factor"])
    assert run(["history"]) == 0
    line = capsys.readouterr().out
    assert "palm" in line and f"{100 * decides['usable']:.0f} % usable" in line
    assert run(["history", "nowhere"]) == 2
    assert capsys.readouterr().err.startswith("error: ")


@pytest.mark.parametrize("edited", ["many", 1e9, None])
def test_a_share_that_is_no_number_is_left_out_with_its_summary(edited, tmp_path):
    answer(tmp_path / "a", "suggest", "2026-01-01T00:00:00", summary={"verdict": "usable", "usable_fraction": edited})
    assert history_of(tmp_path)[0].summary is None
