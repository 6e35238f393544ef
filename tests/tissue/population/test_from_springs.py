"""Tissues of a spring constant: kept and read again, one or a filled template, and refused in one line."""

import json

import pytest

from dummydesign.cli.entry import run
from dummydesign.tissue import load_tissue


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


ADD = ["tissues", "add-spring", "arm", "--source", "my copy, table 1"]


def test_a_spring_constant_with_its_spread_makes_three_people_that_are_read_again(capsys):
    assert run([*ADD, "--stiffness", "30kN/m", "--spread", "6", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["law"] == "spring" and made["warnings"][0]["code"] == "spring_tissue"
    read = load_tissue("arm")
    assert [one.parameters.gamma1_N_per_mm3 for one in read.subjects] == [24.0, 30.0, 36.0]
    assert read.bands["k_N_per_mm"].kind == "digitised" and "table 1" in read.bands["k_N_per_mm"].source
    assert read.elements == 1 and read.velocities_mm_s == ()
    assert run(["tissues", "list"]) == 0 and "24 to 36" in capsys.readouterr().out
    assert run(["tissues", "show", "arm"]) == 0 and "30 N/mm" in capsys.readouterr().out
    assert run([*ADD, "--stiffness", "30"]) == 2 and "replace" in capsys.readouterr().err


@pytest.mark.slow
def test_a_slab_is_designed_for_a_spring_constant_and_no_law_is_fitted_to_it(capsys):
    assert run([*ADD, "--stiffness", "10", "--spread", "30%"]) == 0
    capsys.readouterr()
    words = ["--shape", "slab", "--no-cad", "--no-verify", "--out", "answer", "--json"]
    assert run(["suggest", "--tissue", "arm", *words]) in (0, 1)
    found = json.loads(capsys.readouterr().out)
    best = found["recommendation"]
    # a slab is nearly straight: its whole steady curve lies among the people
    assert best["scores"]["steady_state_range"] == 1.0 and best["parameters"] is None
    assert 5.0 / 13.0 < best["conditions"][0]["depth_mm"] < 5.0 / 7.0
    assert found["tissue_exponent"] == 1.0
    assert "spring_tissue" in [warning["code"] for warning in found["warnings"]]


def test_without_a_spread_there_is_one_subject_and_no_range(capsys):
    assert run([*ADD, "--stiffness", "30"]) == 0
    assert len(load_tissue("arm").subjects) == 1


def test_a_template_holds_no_number_and_what_is_filled_becomes_tissues(home, capsys):
    assert run(["tissues", "template", "regions.csv"]) == 0
    text = (home / "regions.csv").read_text()
    assert all(line.endswith(",,,") for line in text.splitlines()[1:])
    assert run(["tissues", "template", "regions.csv"]) == 2 and "exists" in capsys.readouterr().err
    assert run(["tissues", "add-regions", "regions.csv"]) == 2 and "no row has" in capsys.readouterr().err
    filled = text.replace("hand,,,", "hand,40,8,my copy").replace("neck,,,", "neck,20,,my copy")
    (home / "regions.csv").write_text(filled)
    assert run(["tissues", "add-regions", "regions.csv", "--json"]) == 0
    assert [row["name"] for row in json.loads(capsys.readouterr().out)["added"]] == ["neck", "hand"]
    assert load_tissue("hand").bands["k_N_per_mm"].high == 48.0


def test_one_wrong_row_keeps_every_row_out(home, capsys):
    (home / "regions.csv").write_text(
        "region,stiffness_N_per_mm,spread_N_per_mm,source\nhand,40,8,my copy\nneck,20,30,my copy\n"
    )
    assert run(["tissues", "add-regions", "regions.csv"]) == 2
    assert "regions.csv:3: spread in N/mm = 30" in capsys.readouterr().err
    assert run(["tissues", "show", "hand"]) == 2


@pytest.mark.parametrize(
    "words, said",
    [
        (["--stiffness", "30000"], "looks like N/m: give 30"),
        (["--stiffness", "-3"], "stiffness in N/mm = -3"),
        (["--stiffness", "soft"], "stiffness in N/mm = soft is not a number"),
        (["--stiffness", "30", "--spread", "30"], "spread in N/mm = 30"),
        (["--stiffness", "30", "--spread", "x%"], "not a number of percent"),
        (["--stiffness", "30", "--kind", "read"], "unknown kind"),
    ],
)
def test_what_is_no_spring_constant_is_refused_in_one_line(capsys, words, said):
    assert run([*ADD, *words]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and said in lines[0]


def test_a_spring_constant_without_a_source_is_refused(capsys):
    assert run(["tissues", "add-spring", "arm", "--stiffness", "30", "--source", " "]) == 2
    assert "has no source" in capsys.readouterr().err
