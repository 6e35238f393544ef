"""``campaign new --moulds``: the plan and the moulds of all its pads in one call, or neither."""

from __future__ import annotations

import json

import pytest

from dummydesign import cli
from dummydesign.mold import client
from tests.mold.test_batch import CHILD

PLAN = [
    "campaign",
    "new",
    "thumb",
    "--pads",
    "5,8",
    "--velocity",
    "10",
    "--repeats",
    "1",
    "--ages",
    "9",
    "--no-power",
    "--pad",
    "60x50",
]
RESIN = ["--resin", "polyurethane-nagoya", "--ratio", "15.2"]


@pytest.fixture
def no_cad(monkeypatch, tmp_path):
    monkeypatch.setattr(client, "WORKER", ("-c", CHILD))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_call_makes_the_plan_and_a_job_with_the_moulds_of_its_pads(no_cad, capsys):
    assert cli.run([*PLAN, *RESIN, "--moulds", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {"campaign", "sheet", "moulds_job"} <= set(answer["files"])
    assert answer["moulds"]["thickness_mm"] == [5.0, 8.0] and answer["moulds"]["ratio"] == 15.2
    spec = json.loads((no_cad / "thumb-moulds" / "t8" / "spec.json").read_text())["spec"]
    assert spec["pad"]["length_mm"] == 60.0 and spec["pad"]["width_mm"] == 50.0 and spec["pour"]["ratio"] == 15.2
    assert any(row[0] == "polyol" for row in answer["bill_of_materials"])
    assert {path.name for path in (no_cad / "thumb").iterdir()} == {"campaign.toml", "sheet.html", "manifest.json"}


@pytest.mark.parametrize(
    "more, said",
    [
        (["--young", "25"], "--resin"),
        ([*RESIN, "--preset", "opn"], "did you mean 'open'"),
        ([*RESIN, "--pads", "5,50"], "thickness_mm = 50"),
        ([*RESIN, "--pad", "400x300"], "does not fit"),
    ],
)
def test_moulds_that_cannot_be_made_are_one_line_and_no_plan(no_cad, capsys, more, said):
    assert cli.run([*PLAN, *more, "--moulds"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and said in message
    assert list(no_cad.iterdir()) == []


@pytest.mark.slow
def test_a_mould_that_fails_leaves_the_plan_and_says_what_is_missing(no_cad, capsys):
    assert cli.run([*PLAN, *RESIN, "--pads", "5,7", "--moulds"]) == 1
    assert "its moulds are missing" in capsys.readouterr().err
    assert [path.name for path in no_cad.iterdir()] == ["thumb"]
