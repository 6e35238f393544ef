"""`on-person` on the command line: contract, one screen, files, limits, bad input in one line."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import dummydesign
from dummydesign.cli import run
from dummydesign.cli.commands.on_person import render
from tests.support.robot_presses import by_path, command, gel_pad, sampled

LIMITS = """name = "hand"
force_N = {{ value = {0}, low = {0}, high = {0}, kind = "assumed", source = "our risk assessment" }}
pressure_N_per_cm2 = {{ value = 200.0, low = 200.0, high = 200.0, kind = "assumed", source = "our risk assessment" }}
transient_factor = {{ value = 2.0, low = 2.0, high = 2.0, kind = "assumed", source = "our risk assessment" }}
"""
RESULTS = ("PASS", "UNDECIDED", "FAIL")
FOUR = {"peak_N", "steady_N", "depth_mm", "energy_mJ"}


def write(path, trace, columns=(0, 1, 2), factor=(1.0, 1.0, 1.0)):
    rows = np.c_[trace.time_s, trace.displacement_mm, trace.force_N] * factor
    names = "time_s", "displacement_mm", "force_N"
    head = ",".join(names[k] for k in columns)
    np.savetxt(path, rows[:, columns], delimiter=",", header=head, comments="", fmt="%.7g")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for velocity in (10.0, 250.0):
        path, speed, end = command(velocity, 1.1, 9.0, max(velocity / 1.2e5, 2e-4))
        made = by_path(gel_pad(), path, speed, end, -0.6 / velocity, 20001)
        write(f"v{velocity:g}.csv", sampled(made, 1000.0, 0.01, 0.001))
    (tmp_path / "wide.toml").write_text(LIMITS.format(500.0))
    (tmp_path / "tight.toml").write_text(LIMITS.format(20.0))
    (tmp_path / "low.toml").write_text(LIMITS.format(1.0))
    return tmp_path


def answer(capsys, *words):
    assert run(["on-person", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["position", "steady", "force", "mass:2", "spring:20,3"])
def test_the_contract(here, capsys, drive):
    found = answer(capsys, "v10.csv", "v250.csv", "--tissue", "forefinger", "--drive", drive, "--limits", "wide.toml")
    assert found["schema"] == "dummydesign.on-person/1" and found["drive"] == drive
    assert [one["file"] for one in found["presses"]] == ["v10.csv", "v250.csv"]
    for one in found["presses"]:
        assert set(one["pad"]) >= FOUR and set(one["band"]) >= FOUR and set(one["interval_95"]) >= FOUR
        assert [sub["name"] for sub in one["subjects"]] == [f"rank-{k}-of-5" for k in range(1, 6)]
        for name in FOUR - ({"steady_N"} if drive.startswith("mass") else set()):
            values = [sub[name] for sub in one["subjects"]]
            assert one["band"][name] == pytest.approx([min(values), max(values)])
        assert one["factor_peak"] == pytest.approx([end / one["pad"]["peak_N"] for end in one["band"]["peak_N"]])
        for row in one["limits"]:
            assert set(row) >= {"name", "limit", "pad", "person_high_95", "result"}
            assert row["result"] in ("pass", "fail", "undecided")
            assert row["result"] != "pass" or not one["beyond_range"]
    lines = render(found).splitlines()
    assert len(lines) <= 30 and max(map(len, lines)) <= 100
    words = [line.split()[0].strip(":") for line in lines if line.strip()]
    wrong = found["presses"][0]["drive_contradicted"] is not None
    assert words[0] == ("CAUTION" if wrong else next(one for one in words if one in RESULTS))
    assert any(one in RESULTS for one in words) and "NEXT" in words


@pytest.mark.slow
def test_limits_pass_fail_or_stay_undecided_and_never_pass_an_extrapolation(here, capsys):
    words = ["v10.csv", "--tissue", "forefinger", "--drive", "steady", "--limits"]
    results = {}
    for name in ("wide", "tight", "low"):
        found = answer(capsys, *words, f"{name}.toml")["presses"][0]
        results[name] = next(row["result"] for row in found["limits"] if row["name"] == "force quasi-static")
        assert found["beyond_range"] == []
    assert results == {"wide": "pass", "tight": results["tight"], "low": "fail"}
    deep = answer(capsys, "v10.csv", "--tissue", "forefinger", "--drive", "spring:1000,3", "--limits", "wide.toml")
    assert deep["presses"][0]["beyond_range"]
    assert {row["result"] for row in deep["presses"][0]["limits"]} == {"undecided"}
    assert "beyond_range" in {one["code"] for one in deep["warnings"]}


@pytest.mark.slow
def test_files_hold_the_curves_at_the_rate_and_the_report(here, capsys):
    found = answer(capsys, "v250.csv", "--tissue", "palm", "--rate", "500", "--out", "o")
    with open(found["files"]["curves"], encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    time = np.array([float(row["time_s"]) for row in rows])
    assert np.allclose(np.diff(time), 0.002) and time[0] == 0.0
    people = np.array([[float(row[f"rank-{k}-of-5_force_N"]) for k in range(1, 6)] for row in rows])
    low, high = (np.array([float(row[key]) for row in rows]) for key in ("people_low_N", "people_high_N"))
    assert np.allclose(low, people.min(axis=1), rtol=1e-4) and np.allclose(high, people.max(axis=1), rtol=1e-4)
    page = Path(found["files"]["report"]).read_text(encoding="utf-8")
    assert "<svg" in page and "95 % of people" in page
    assert found["presses"] == json.loads(Path(found["files"]["json"]).read_text(encoding="utf-8"))


@pytest.mark.slow
def test_python_gives_the_answer_of_the_command(here, capsys):
    mine = dummydesign.on_person(["v250.csv"], "palm", drive="force").to_dict()
    theirs = answer(capsys, "v250.csv", "--tissue", "palm", "--drive", "force")
    assert mine["presses"] == theirs["presses"] and mine["files"] == {}


@pytest.mark.slow
def test_bad_input_is_one_line_and_status_2(here, capsys):
    path, speed, end = command(100.0, 1.1, 1.0, 1e-3)
    good = sampled(by_path(gel_pad(), path, speed, end, -0.006, 8001))
    write("metres.csv", good, factor=(1.0, 1e-3, 1.0))
    write("millinewtons.csv", good, factor=(1.0, 1.0, 1e3))
    write("no_force.csv", good, columns=(0, 1))
    twice = np.r_[good.displacement_mm, np.linspace(good.displacement_mm[-1], -0.6, 50), good.displacement_mm]
    load = np.r_[good.force_N, np.linspace(good.force_N[-1], 0.0, 50), good.force_N]
    np.savetxt(
        "twice.csv",
        np.c_[np.arange(len(twice)) * 1e-3, twice, load],
        delimiter=",",
        comments="",
        fmt="%.6g",
        header="time_s,displacement_mm,force_N",
    )
    short = good.time_s < 0.012
    rows = np.c_[good.time_s, good.displacement_mm, good.force_N]
    for name, kept in (("short.csv", rows[short]), ("air.csv", rows * [1, 1, 0] + [0, -3, 0])):
        np.savetxt(name, kept, delimiter=",", header="time_s,displacement_mm,force_N", comments="", fmt="%.7g")
    tissue = ["--tissue", "palm"]
    names = "metres", "millinewtons", "no_force", "twice", "short", "air", "gone"
    cases = [[f"{name}.csv", *tissue] for name in names]
    cases += [
        ["v10.csv", *tissue, *more]
        for more in (
            ["--drive", "mass:0"],
            ["--drive", "mass:-1"],
            ["--drive", "mass:5000"],
            ["--drive", "spring:0,1"],
            ["--drive", "spring:20,-1"],
            ["--drive", "spring:50000,2"],
            ["--drive", "mass"],
            ["--drive", "hand"],
            ["--rate", "0"],
            ["--rate", "fast"],
            ["--limits", "gone.toml"],
            ["--punch", "star:3"],
            ["--lowpass", "x"],
            ["--rate", "1e5", "--out", "o"],
        )
    ] + [["v10.csv", "--tissue", "nobody"]]
    for words in cases:
        assert run(["on-person", *words]) == 2, words
        printed = capsys.readouterr()
        assert printed.out == "" and printed.err.startswith("error: ") and printed.err.count("\n") == 1, words
        assert "internal error" not in printed.err, printed.err


@pytest.mark.slow
def test_a_press_beyond_people_is_named_before_any_factor(here, capsys):
    from dummydesign.report.on_person import extrapolation_text

    words = ["v10.csv", "--tissue", "forefinger", "--drive"]
    inside, deep = (answer(capsys, *words, drive)["presses"] for drive in ("steady", "spring:1000,3"))
    assert extrapolation_text(inside) == ""
    ways = deep[0]["beyond_range"]
    worst = max(ways, key=lambda one: max(one["value"] / one["pressed_to"], one["pressed_to"] / one["value"]))
    assert run(["on-person", *words, "spring:1000,3"]) == 0
    head = " ".join(capsys.readouterr().out.partition("\n\n")[0].split())
    places = [head.index(text) for text in (f"{worst['value']:.3g}", f"{worst['pressed_to']:.3g}", "times the pad")]
    assert places == sorted(places)


@pytest.mark.slow
def test_a_drive_that_does_not_fit_comes_first_with_its_size_and_the_drive_that_does(here, capsys):
    words = ["v10.csv", "--tissue", "palm", "--drive", "force"]
    signs = answer(capsys, *words)["presses"][0]["signs"]
    for more in ([], ["--limits", "wide.toml"], ["--details"]):
        assert run(["on-person", *words, *more]) == 0
        head = " ".join(capsys.readouterr().out.partition("\n\n")[0].split())
        assert head.startswith("CAUTION") and f"{signs['relaxed_N']:.2g} N" in head and "--drive position" in head


@pytest.mark.slow
def test_where_people_get_the_pad_s_force_the_answer_is_their_depth(here, capsys):
    found = answer(capsys, "v10.csv", "--tissue", "palm", "--drive", "force")["presses"][0]
    assert run(["on-person", "v10.csv", "--tissue", "palm", "--drive", "force"]) == 0
    head = " ".join(capsys.readouterr().out.partition("\n\n")[0].split())
    assert all(f"{end:.3g}" in head for end in found["band"]["depth_mm"]) and "1 to 1" not in head


def test_one_value_is_printed_once_and_a_multiple_as_a_multiple():
    from dummydesign.person.validity_range import short_number, subject_words
    from dummydesign.report.on_person import span_text

    assert span_text([8.4141, 8.4149]) == "8.41" and span_text([8.41, 8.43]) == "8.41 to 8.43"
    assert short_number(152.79, 2) == "150" and short_number(1493.0) == "1490" and short_number(0.001234) == "0.00123"
    assert subject_words("rank-5-of-5") == "subject 5 of 5" and subject_words("anna") == "anna"


@pytest.mark.slow
def test_next_names_a_template_of_limits_that_can_be_filled_in_and_used(here, capsys):
    found = answer(capsys, "v10.csv", "--tissue", "forefinger", "--out", "people")
    template = Path(found["files"]["limits_template"])
    assert template == Path("people/limits-template.toml")
    assert template.read_bytes() == (Path(__file__).parents[2] / "examples/limits.toml").read_bytes()
    assert run(["on-person", "v10.csv", "--tissue", "forefinger", "--out", "people"]) == 0
    assert str(template) in " ".join(capsys.readouterr().out.split())
    Path("limits.toml").write_bytes(template.read_bytes())
    found = answer(capsys, "v10.csv", "--tissue", "forefinger", "--limits", "limits.toml", "--out", "checked")
    rows = found["presses"][0]["limits"]
    assert {(row["name"], row["limit"]) for row in rows} >= {("force quasi-static", 100.0), ("force transient", 200.0)}
    assert "limits_template" not in found["files"]
