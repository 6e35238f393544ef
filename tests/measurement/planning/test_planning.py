"""Plans are balanced and repeatable, their files are checked, and campaigns come out of files one has."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from collections import Counter
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.selection.doubts import ODD_SPEED, labels_of
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.measurement.campaign_plan import FRESH_REST_S, PlanSettings, file_name, make_plan
from dummydesign.measurement.campaign_presses import check_campaign
from dummydesign.measurement.motion import contact_velocity, ramp_and_hold
from dummydesign.tissue.comparison import PressTest, missing_of
from tests.support.pressed_plan import press_campaign
from tests.support.refusal import raises_code

SMALL = ["--pads", "5,15", "--velocity", "10,250", "--force", "3,8", "--repeats", "2", "--ages", "7,9"]


def asked(capsys, *words, status=0):
    found = run(["campaign", *words, "--json"])
    shown = capsys.readouterr()
    assert found == status, shown.err
    return json.loads(shown.out) if status != 2 else shown.err


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plan") / "mine"
    assert run(["campaign", "new", str(folder), *SMALL, "--young", "25", "--lowpass", "35", "--no-power"]) == 0
    press_campaign(folder, 3, 27.0, coarse=True)
    return folder


@pytest.fixture
def mine(pressed, tmp_path):
    shutil.copytree(pressed, tmp_path / "mine")
    return tmp_path / "mine"


def test_every_condition_is_pressed_as_often_as_asked_and_every_day_is_balanced():
    plan = make_plan(PlanSettings())
    assert len(plan) == 36 and [row.sequence for row in plan] == list(range(1, 37))
    cells = Counter((row.thickness_mm, row.velocity_mm_s, row.target) for row in plan)
    assert set(cells.values()) == {2} and len(cells) == 18
    assert len({row.file for row in plan}) == 36
    for age in (9.0, 14.0, 29.0):
        day = [row for row in plan if row.age_days == age]
        assert len(day) == 12 and set(Counter(row.thickness_mm for row in day).values()) == {4}
        # a pad is not changed in between, and rests before its first press
        changes = sum(a.thickness_mm != b.thickness_mm for a, b in pairwise(day))
        assert changes == 2 and sum(row.rest_s == FRESH_REST_S for row in day) == 3
    for row in plan:
        twin = [r for r in plan if r.target == row.target and r.velocity_mm_s == row.velocity_mm_s]
        days = [r.age_days for r in twin if r.thickness_mm == row.thickness_mm]
        assert len(set(days)) == 2
    back = [row for row in plan if row.unload]
    assert len(back) == 12
    assert set(Counter(row.thickness_mm for row in back).values()) == {4}


def test_the_order_is_drawn_and_its_seed_gives_it_again():
    orders = {tuple(row.file for row in make_plan(PlanSettings(seed=seed))) for seed in range(20)}
    assert len(orders) == 20
    assert make_plan(PlanSettings(seed=4)) == make_plan(PlanSettings(seed=4))
    first = Counter(make_plan(PlanSettings(seed=seed))[0].thickness_mm for seed in range(300))
    assert all(60 < count < 140 for count in first.values())


def test_names_say_what_was_pressed():
    assert file_name(5.0, 10.0, 5.0, 1) == "t05_v010_f05_1.csv"
    assert file_name(4.5, 0.25, 2.5, 12, by_depth=True) == "t04.5_v000.25_d02.5_12.csv"


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"pads_mm": (0.1,)}, "out_of_range"),
        ({"velocities_mm_s": ()}, "missing"),
        ({"targets": (3.0, 3.0)}, "duplicate"),
        ({"repeats": 0}, "out_of_range"),
        ({"seed": -1}, "out_of_range"),
        ({"pads_mm": (5.0,), "velocities_mm_s": (10.0,), "targets": (3.0,), "repeats": 1}, "out_of_range"),
        ({"targets": (4.0,), "by_depth": True}, "out_of_range"),
    ],
)
def test_what_cannot_be_pressed_is_refused(change, code):
    with raises_code(code):
        make_plan(PlanSettings(**change))


def test_the_default_forces_are_those_that_a_verdict_needs():
    test = PressTest()
    plan = make_plan(PlanSettings())
    made = [SimpleNamespace(steady_force_N=row.target, velocity_mm_s=row.velocity_mm_s) for row in plan]
    assert missing_of(made, test, (10.0, 250.0)) == ""
    assert test.span_N == (min(PlanSettings().targets), max(PlanSettings().targets))


@pytest.mark.slow
def test_a_plan_without_a_ratio_says_that_it_leads_to_no_recipe(tmp_path, capsys):
    codes = [
        [one["code"] for one in asked(capsys, "new", str(tmp_path / name), *SMALL, "--no-power", *words)["warnings"]]
        for name, words in (
            ("a", ["--young", "25"]),
            ("b", ["--resin", "polyurethane-nagoya", "--ratio", "15"]),
            ("c", ["--young", "25", "--ratio", "15"]),
        )
    ]
    assert [codes_of.count("no_ratio") for codes_of in codes] == [1, 0, 0]


def test_a_new_campaign_is_written_with_its_sheet_and_nothing_is_pressed_yet(tmp_path, capsys):
    folder = tmp_path / "c"
    found = asked(capsys, "new", str(folder), *SMALL, "--young", "25", "--no-power")
    assert {path.name for path in folder.iterdir()} == {"campaign.toml", "sheet.html", "manifest.json"}
    page = (folder / "sheet.html").read_text()
    assert all(trial["file"] in page for trial in found["trials"]) and "unloading" in page
    status = check_campaign(folder)
    assert len(status.missing) == 16 and not status.pressed and not status.wrong and not status.ready
    assert len(asked(capsys, "check", str(folder))["missing"]) == 16


@pytest.mark.slow
def test_what_is_pressed_as_planned_is_ready_and_the_loop_reads_it(mine, capsys):
    status = check_campaign(mine)
    assert status.ready and len(status.pressed) == 16 and not status.warnings
    campaign = read_campaign(mine)
    assert len(campaign.trials) == 16 and [one["code"] for one in campaign.warnings] == ["no_ratio"]
    assert {trial.temperature_C is None for trial in campaign.trials} == {False}
    assert asked(capsys, "check", str(mine))["ready"] is True


@pytest.mark.parametrize(
    ("offset", "code"), [pytest.param(-0.044, None, marks=pytest.mark.slow), (0.5, "force_before_contact")]
)
def test_an_offset_is_a_problem_beyond_the_noise_only(mine, capsys, offset, code):
    name = check_campaign(mine).pressed[0]
    time, x, force = np.loadtxt(mine / name, delimiter=",", skiprows=1).T
    rows = np.column_stack([time, x, force + offset])
    np.savetxt(mine / name, rows, "%.4f", ",", header="time_s,displacement_mm,force_N", comments="")
    found = asked(capsys, "check", str(mine), status=0 if code is None else 1)
    assert found["ready"] == (code is None)
    assert [(one["code"], one["file"]) for one in found["wrong"]] == ([] if code is None else [(code, name)])
    if code:
        assert found["error"]["message"].startswith("1 problem in ")


@pytest.mark.slow
def test_the_loop_finds_the_modulus_of_a_planned_and_pressed_campaign_and_no_effect(mine, tmp_path, capsys):
    assert run(["loop", str(mine), "--out", str(tmp_path / "out"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    young = found["after"]["parameters"]["young_kPa"]
    assert found["verdict"] == "none" and young["low"] < 27.0 < young["high"]


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_presses_are_planned_at_speeds_that_are_reached_and_are_taken_at_those_and_at_the_asked(seed, tmp_path, capsys):
    draw = np.random.default_rng([58, seed])
    folder, thick, young = tmp_path / "c", draw.uniform(5.0, 15.0), draw.uniform(25.0, 80.0)
    forces = ",".join(f"{force:.2f}" for force in draw.uniform(1.0, 6.0, 2))
    speed, braking = draw.uniform(220.0, 400.0), 30_000.0
    words = ["--pads", f"{thick:.2f}", "--young", f"{young:.1f}", "--force", forces, "--velocity", f"10,{speed:.0f}"]
    found = asked(capsys, "new", str(folder), *words, "--ages", "7,9", "--no-power")
    slower = [row for row in found["trials"] if row["velocity_mm_s"] < row["asked_velocity_mm_s"]]
    said = [one["message"] for one in found["warnings"] if one["code"] == "speed_not_reached"]
    assert len(slower) >= 2 and len(said) == 1
    text, page = ((folder / name).read_text() for name in ("campaign.toml", "sheet.html"))
    assert said[0] in text and said[0] in page
    for row in found["trials"]:
        depth = row["expected_depth_mm"]
        motion = ramp_and_hold(row["asked_velocity_mm_s"], depth, row["hold_s"], braking)
        step, way = np.diff(motion.time_s), np.diff(motion.displacement_mm)
        fastest = (way[step > 1e-6] / step[step > 1e-6]).max()
        # the mean of a step, over which the punch brakes by a 24th of its speed
        assert row["velocity_mm_s"] == pytest.approx(fastest, rel=0.025)
        assert float(contact_velocity(np.inf, depth, braking)) >= row["velocity_mm_s"]
        time = np.r_[np.arange(0.0, 1.0, 1e-3), np.arange(1.0, row["hold_s"], 0.02)]
        x = np.interp(time, motion.time_s, motion.displacement_mm)
        force = row["target_force_N"] * x / depth + 0.01 * draw.standard_normal(len(x))
        rows = np.column_stack([time, x, force])
        np.savetxt(folder / row["file"], rows, "%.6f", ",", header="time_s,displacement_mm,force_N", comments="")
    for planned in (text, re.sub(r"velocity_mm_s = (?!10\.0)\S+", f"velocity_mm_s = {speed:.0f}.0", text)):
        (folder / "campaign.toml").write_text(planned.replace("unload = true", "unload = false"))
        assert check_campaign(folder).wrong == ()
        presses = make_presses(read_campaign(folder))
        # repeats of a condition are one cell
        assert np.bincount(presses.cell).tolist() == [2] * 4
        fit = fit_base(presses, law_of(read_campaign(folder)), 1e-3 * young)
        assert np.abs(labels_of(presses, fit).ln_speed).max() < 0.5 * ODD_SPEED
    (folder / "campaign.toml").write_text(text.replace("velocity_mm_s = 10.0", "velocity_mm_s = 20.0"))
    wrong = {one["file"] for one in check_campaign(folder).wrong if "mm/s" in one["message"]}
    assert wrong == {row["file"] for row in found["trials"] if row["velocity_mm_s"] == 10.0}


def test_what_is_wrong_is_named_with_its_file(mine, capsys):
    rows = np.loadtxt(mine / "t05_v010_f03_1.csv", delimiter=",", skiprows=1)

    def put(name, changed, head="time_s,displacement_mm,force_N"):
        np.savetxt(mine / name, changed, "%.5f", ",", header=head, comments="")

    put("t05_v010_f03_1.csv", rows * [1, 1, 2.0])
    put("t05_v010_f03_2.csv", rows * [1, 1, 1], "Zeit,Weg,Kraft")
    put("t15_v010_f03_1.csv", np.loadtxt(mine / "t15_v010_f03_2.csv", delimiter=",", skiprows=1))
    (mine / "t15_v250_f08_1.csv").unlink()
    (mine / "left-over.csv").write_text("x")
    found = asked(capsys, "check", str(mine), status=1)
    wrong = {one["file"]: one["message"] for one in found["wrong"]}
    assert "planned 3" in wrong["t05_v010_f03_1.csv"]
    assert "import it first" in wrong["t05_v010_f03_2.csv"]
    assert any("same recording" in one["message"] for one in found["wrong"])
    assert found["missing"] == ["t15_v250_f08_1.csv"] and found["ready"] is False
    assert any(one["code"] == "not_listed" for one in found["warnings"])


def test_a_campaign_comes_from_the_names_of_its_files(mine, tmp_path, capsys):
    files = sorted(map(str, mine.glob("t*.csv")))
    before = {file: Path(file).read_bytes() for file in files}
    found = asked(capsys, "from-files", str(tmp_path / "made"), *files, "--young", "25")
    campaign = read_campaign(tmp_path / "made")
    declared = {t.file: (t.thickness_mm, t.velocity_mm_s, t.target_force_N, t.repeat) for t in campaign.trials}
    assert declared["t05_v010_f03_2.csv"] == (5.0, 10.0, 3.0, 2) and len(declared) == 16
    assert any(one["code"] == "no_sequence" for one in found["warnings"])
    assert {file: Path(file).read_bytes() for file in files} == before


def test_presses_alike_are_counted_and_the_decision_says_which_one_it_is(mine, tmp_path, capsys):
    paths = [shutil.copy(mine / "t05_v010_f03_1.csv", tmp_path / f"press {letter}.csv") for letter in "ab"]
    found = asked(capsys, "from-files", str(tmp_path / "made"), *map(str, paths), "--young", "25", "--thickness", "5")
    assert [trial["repeat"] for trial in found["trials"]] == [1, 2]
    assert [one["value"].rpartition("repeat ")[2] for one in found["decisions"]] == ["1", "2"]


def test_a_table_wins_over_names_and_gives_what_they_do_not_say(mine, tmp_path, capsys):
    paths = []
    for number, name in enumerate(("t05_v010_f03_1.csv", "t15_v250_f08_1.csv"), start=1):
        shutil.copy(mine / name, tmp_path / f"press{number}.csv")
        paths.append(str(tmp_path / f"press{number}.csv"))
    told = asked(capsys, "from-files", str(tmp_path / "made"), *paths, "--young", "25", status=2)
    assert "--table" in told and "--thickness" in told and not (tmp_path / "made").exists()
    table = tmp_path / "trials.csv"
    table.write_text("file,thickness_mm,sequence,temperature_C\npress1.csv,5,2,23.5\npress2.csv,15,1,24\n")
    asked(capsys, "from-files", str(tmp_path / "made"), *paths, "--young", "25", "--table", str(table))
    first, second = read_campaign(tmp_path / "made").trials
    assert (first.file, first.sequence, first.thickness_mm) == ("press2.csv", 1, 15.0)
    assert second.temperature_C == 23.5 and second.velocity_mm_s == pytest.approx(10.0, rel=0.05)
    for text, said in (
        ("name\nx\n", "needs a column 'file'"),
        ("file,thicknes_mm\n", "did you mean 'thickness_mm'"),
        ("file,thickness_mm\npress3.csv,5\n", "unknown file 'press3.csv'"),
        ("file,thickness_mm\npress1.csv,five\n", "thickness_mm = 'five'"),
        ("file,thickness_mm\npress1.csv,5,6\n", "3 cells"),
    ):
        table.write_text(text)
        words = [*paths, "--young", "25", "--table", str(table)]
        assert said in asked(capsys, "from-files", str(tmp_path / "b"), *words, status=2)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["new", "c"], "--young KPA, or --resin"),
        (["new", "c", "--young", "25", "--pads", "five"], "= five "),
        (["new", "c", "--young", "25", "--punch", "star:3"], "punch 'star:3'"),
        (["new", "c", "--young", "25", "--pad", "cylinder:50", "--punch", "round:9"], "a puck by plate"),
        (["new", "c", "--young", "25", "--force", "3", "--depth", "1"], "the one or to the other"),
        (["new", "c", "--young", "25", "--pad", "150x13"], "at least 14 mm"),
        (["new", "c", "--young", "25", "--pad", "10x60", "--punch", "ball:20"], "smaller than the punch ball:20"),
        (["new", "c", "--resin", "nylon", "--ratio", "15"], "unknown resin 'nylon'"),
        (["check", "."], "campaign new"),
    ],
)
def test_bad_requests_are_one_line_and_status_2(words, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["campaign", *words]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1 and not list(tmp_path.iterdir())


def test_a_crowned_pad_without_a_tabulated_force_keeps_its_name(tmp_path, capsys):
    crown = "crowned:radius=20,height=3,foot=11"
    found = asked(
        capsys,
        "new",
        str(tmp_path / "c"),
        "--pads",
        "15",
        "--shape",
        crown,
        "--young",
        "25",
        "--repeats",
        "1",
        "--force",
        "3",
    )
    (message,) = [one["message"] for one in found["warnings"] if one["code"] == "no_power"]
    assert "crowned" in message and "slab" not in message and found["power"] is None


@pytest.mark.parametrize(
    ("option", "text", "quantity"),
    [("--velocity", "10,0.25", "velocity_mm_s"), ("--force", "5000", "force_N"), ("--pads", "0.01", "thickness_mm")],
)
def test_a_plan_refuses_numbers_that_only_make_sense_in_another_unit(option, text, quantity, tmp_path, capsys):
    words = ["campaign", "new", str(tmp_path / "c"), "--young", "35", "--no-power", option, text, "--json"]
    assert run(words) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"]) == ("implausible_unit", quantity) and not (tmp_path / "c").exists()


def test_a_plan_takes_numbers_with_their_unit(tmp_path, capsys):
    words = ["campaign", "new", str(tmp_path / "c"), "--young", "35", "--no-power", "--repeats", "1"]
    assert run([*words, "--pads", "1cm", "--velocity", "0.25m/s,0.5mm/s", "--force", "4500mN", "--json"]) == 0
    capsys.readouterr()
    trials = tomllib.loads((tmp_path / "c/campaign.toml").read_text())["trial"]
    assert {one["velocity_mm_s"] for one in trials} == {250.0, 0.5}
    assert {(one["thickness_mm"], one["target_force_N"]) for one in trials} == {(10.0, 4.5)}
