"""Moulds of shaped pads as the command makes them: all files, or the reason before any solid is made."""

from __future__ import annotations

from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.mold.client import make_mold
from tests.support.mould_checks import no_check_fails, shape_spec

REFUSED = [
    (["--shape", "crown:10,2"], "did you mean 'crowned'"),
    (["--shape", "crowned:10"], "needs height"),
    (["--shape", "crowned:5,6"], "no cap that widens"),
    (["--shape", "crowned:20,7"], "at least 1.5 mm"),
    (["--shape", "puck:3"], "takes no parameters"),
    (["--shape", "layered:4,0.05"], "allowed is 0.199 to 21"),
    (["--shape", "layered:4,0.4", "--preset", "lidded"], "--preset open"),
    (["--base-ratio", "14.5"], "layered pad"),
    (["--shape", "boned:20,4", "--preset", "lidded"], "--preset open"),
    (["--shape", "layered:4,0.4", "--base-ratio", "3"], "14.0 to 20.0"),
]


@pytest.mark.parametrize("arguments, named", REFUSED)
def test_refused_before_cad_with_the_reason(arguments, named, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("dummydesign.mold.client.make_mold", lambda *a: pytest.fail("CAD was asked"))
    size = ["--thickness", "8", "--length", "60", "--width", "60"]
    assert cli.run(["mold", *size, *arguments]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and named in message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "text, thickness, preset",
    [
        ("crowned:10,2", 5.0, "open"),
        ("crowned:3,8,9", 15.0, "lidded"),
        ("crowned:3,8,9,1", 15.0, "open"),
        ("layered:8,0.4", 20.0, "open"),
        ("boned:20,6", 15.0, "open"),
        ("boned:20,6,0,1", 15.0, "open"),
        ("crowned:1,12,10", 25.0, "open"),
        ("boned:1,10,14,1", 20.0, "open"),
        ("crowned:10,2,6,0,2,2,20,18", 5.0, "open"),
    ],
)
def test_every_shape_is_made_with_all_its_files(text, thickness, preset, tmp_path):
    result = make_mold(shape_spec(text, thickness, preset=preset), tmp_path)
    assert no_check_fails(result.checks)
    assert all(Path(name).is_file() for name in result.files.values())
    assert Path(result.files["pad"]).name == f"pad_{text.split(':')[0]}_t{thickness:g}.step"
