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
    (tmp_path / "anna-manifest.json").write_text(json.dumps({"command": "fit", "date": "2025", "finished": True}))
    found = history_of(tmp_path)
    assert [(one.folder, one.command) for one in found] == [("b/c", "loop"), ("a", "suggest"), ("anna", "fit")]
    assert history_of(tmp_path / "half") == ()


@pytest.mark.slow
def test_an_answer_is_listed_with_its_verdict(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run(["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify", "--out", "palm", "-q"])
    capsys.readouterr()
    assert run(["history", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["answers"]
    assert row["folder"] == "palm" and row["summary"]["verdict"] and row["summary"]["shape"] == "slab"
    assert run(["history"]) == 0
    assert "palm" in capsys.readouterr().out
    assert run(["history", "nowhere"]) == 2
    assert capsys.readouterr().err.startswith("error: ")
