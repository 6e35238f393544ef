"""Presses of one puck on the command line: declared plates, several traces, a ramp too slow, the same puck again."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.resin import load_resin
from tests.support.puck_history import frictionless, ramps, relaxed

HEIGHT, DIAMETER, YOUNG_KPA = 30.0, 50.0, 30.0
ARMS = ((0.03, 0.9), (0.4, 0.3))


def trace(folder, name, velocity_mm_s, step_s, hold_s=4.0):
    time, x = ramps((0.25,), HEIGHT, velocity_mm_s, hold_s, step_s)
    force = relaxed(time, YOUNG_KPA * frictionless(x / HEIGHT, DIAMETER, 2.0), ARMS)
    force += 0.02 * np.random.default_rng(1).normal(size=len(time))
    np.savetxt(
        folder / name,
        np.column_stack([time, x, force]),
        delimiter=",",
        comments="",
        fmt="%.6g",
        header="time_s,displacement_mm,force_N",
    )
    return str(folder / name)


def add(files, *more, name="batch", ratio=15):
    size = ["--diameter", f"{DIAMETER:g}", "--height", f"{HEIGHT:g}"]
    return run(["resins", "add-compression", *files, *size, "--name", name, "--ratio", f"{ratio:g}", *more, "--json"])


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    return tmp_path


@pytest.mark.slow
def test_two_presses_give_arms_that_replace_the_bases_and_are_known_again(home, capsys):
    # half of the hold is beyond the base's slowest arm, 3 s: it was seen not to be there
    files = [trace(home, f"v{v}.csv", v, 0.004, 8.0) for v in (10, 50)]
    assert add(files, "--friction", "0") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["plates"] == "0" and answer["friction"]["low"] == answer["friction"]["high"] == 0.0
    young = answer["young_kPa"]
    assert young["low"] <= YOUNG_KPA <= young["high"] and young["high"] / young["low"] < 1.2
    assert answer["inputs"]["file"] == files and len(answer["relaxation"]["holds"]) == 2
    resin = load_resin("batch")
    assert [arm.beta.kind for arm in resin.arms] == ["fitted", "fitted"]
    sums = resin.draw(2000, 1).beta(15.0).sum(axis=1)
    low, high = np.percentile(sums, [2.5, 97.5])
    assert low <= 1.2 <= high and high / low < 1.1
    assert add(files[::-1], "--friction", "0") == 0
    assert json.loads(capsys.readouterr().out)["action"] == "unchanged"
    assert add(files[:1], "--friction", "lubricated") == 0
    again = json.loads(capsys.readouterr().out)
    assert again["action"] == "replaced" and "plates 0" in again["before"]
    assert len(load_resin("batch").points) == 1


@pytest.mark.slow
def test_a_ramp_too_slow_for_the_bases_fast_arm_says_how_fast_to_press(home, capsys):
    assert add([trace(home, "slow.csv", 0.5, 0.02, 10.0)], "--friction", "0") == 0
    answer = json.loads(capsys.readouterr().out)
    hidden = [one["message"] for one in answer["warnings"] if one["code"] == "relaxation_not_seen"]
    assert len(hidden) == 1 and "0.03 s" in hidden[0]
    # depth over ten times the arm's time is 25 mm/s, twenty samples in it 667 Hz
    assert "50 mm/s" in hidden[0] and "1000 Hz" in hidden[0]
    assert answer["relaxation"]["seen_s"][0] > 0.03
    kept = next(arm for arm in load_resin("batch").arms if arm.tau_s.value == 0.03)
    assert kept.beta.kind == "inferred" and kept.beta.high > 1.3 * kept.beta.low


def test_presses_that_do_not_belong_together_are_refused(home, capsys):
    held = trace(home, "held.csv", 10, 0.02)
    time = np.arange(0.0, 30.0, 0.1)
    loading = home / "loading.csv"
    rows = np.column_stack([time, 0.3 * time, 2.0 * time])
    np.savetxt(loading, rows, delimiter=",", comments="", header="time_s,displacement_mm,force_N")
    for files, code in (([held, held], "duplicate"), ([held, str(loading)], "inconsistent")):
        assert add(files) == 2
        assert json.loads(capsys.readouterr().out)["error"]["code"] == code
    assert add([held], "--friction", "greasy") == 2
    assert json.loads(capsys.readouterr().out)["error"]["quantity"] == "friction"
