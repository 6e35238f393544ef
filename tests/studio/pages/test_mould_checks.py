"""What the mould's page says of the checks of its solids."""

from __future__ import annotations

import json

import pytest

nicegui = pytest.importorskip("nicegui")


@pytest.mark.parametrize(
    ("others", "said", "rows"),
    [
        ([], "2 of 2 checks passed", 0),
        (["skipped"], "2 of 3 checks passed, the others could not be run", 1),
        (["skipped", "fail"], "2 of 4 checks passed", 2),
    ],
)
def test_checks_that_could_not_be_run_are_said_where_there_are_some_and_nothing_failed(
    others, said, rows, tmp_path, monkeypatch
):
    from dummydesign.studio.pages import mould

    shown = []
    monkeypatch.setattr(mould, "html", lambda template, *values: shown.append((*values, 0)))
    monkeypatch.setattr(mould.widgets, "table", lambda head, rest, words, under: shown.append((under, len(rest))))
    checks = [{"id": f"check-{number}", "status": status} for number, status in enumerate(["pass", "pass", *others])]
    (tmp_path / "checks.json").write_text(json.dumps(checks), encoding="utf-8")
    mould._checks(tmp_path)
    assert shown == [(said, rows)]
