"""The child that makes solids: it answers with a file, also where it fails."""

from __future__ import annotations

import io
import json
import sys

import pytest

from dummydesign.mold import child_main


@pytest.fixture
def able(monkeypatch):
    monkeypatch.setattr(child_main, "cad_problem", lambda: None)


def test_without_a_kernel_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(child_main, "cad_problem", lambda: "CadQuery is not installed")
    found = child_main.run({"spec": {}})
    assert found == {"error": {"code": "cad_unavailable", "message": "CadQuery is not installed"}}


@pytest.mark.parametrize(("fault", "words"), [("two\n lines", "ValueError: two lines"), ("", "ValueError: no message")])
def test_a_fault_is_one_line_with_its_kind(able, monkeypatch, fault, words):
    def fail(asked):
        raise ValueError(fault)

    monkeypatch.setattr(child_main, "_made", fail)
    assert child_main.run({"spec": {}}) == {"error": {"code": "cad_failed", "message": words}}


def test_question_and_answer_are_files(able, monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    seen, limits, left = {}, [], []
    monkeypatch.setattr(child_main, "_made", lambda asked: seen.update(asked) or {"volume_mm3": 3.5})
    monkeypatch.setattr(child_main, "limit_processor_time", limits.append)
    monkeypatch.setattr(child_main.gc, "disable", lambda: left.append("gc"))
    question, answer = tmp_path / "question.json", tmp_path / "answer.json"
    monkeypatch.setattr(sys, "argv", ["child_main", str(question), str(answer)])
    for asked in ({"spec": {"a": 1}, "processor_s": 60}, {"spec": {"a": 1}}):
        question.write_text(json.dumps(asked), encoding="utf-8")
        child_main.main()
        assert json.loads(answer.read_text(encoding="utf-8")) == {"volume_mm3": 3.5} and seen["spec"] == {"a": 1}
    assert limits == [60] and left == ["gc", "gc"]


def test_an_answer_that_is_no_number_is_no_answer(able, monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    monkeypatch.setattr(child_main, "_made", lambda asked: {"volume_mm3": float("nan")})
    monkeypatch.setattr(child_main.gc, "disable", lambda: None)
    (tmp_path / "q.json").write_text("{}", encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["child_main", str(tmp_path / "q.json"), str(tmp_path / "a.json")])
    with pytest.raises(ValueError, match="JSON"):
        child_main.main()


def test_memory_is_in_megabytes():
    """A Python with NumPy takes more than ten, and less than this machine has."""
    assert 10.0 < child_main.peak_memory_MB() < 100_000.0
