"""Bad input ends in one line and exit status 2; an interrupt leaves no half calibration, and an old one as it was."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.measurement.campaign_file import read_campaign
from tests.loop.test_calibrated_shapes import calibration

EXAMPLE = Path(__file__).parents[2] / "examples" / "campaign"


@pytest.fixture
def example(tmp_path):
    shutil.copytree(EXAMPLE, tmp_path / "campaign")
    return tmp_path / "campaign"


def refused(words, capsys):
    assert cli.run([str(word) for word in words]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    return shown.err


def changed(folder, old, new):
    path = folder / "campaign.toml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[[trial]]\n", '[[trial]]\npunch = "round:12"\n', "one [punch]"),
        ("[[trial]]\n", "[[trial]]\nside_mm = 20.0\n", "one [punch]"),
        ("[[trial]]\n", '[[trial]]\ncontact = "frictionless"\n', "one [punch]"),
        ("[punch]\n", "[[punch]]\n", "make a campaign of each"),
        ('shape = "square"', 'shape = "hammer"', "hammer"),
        ('base = "bonded"', 'base = "velcro"', "velcro"),
        ("young_kPa_nominal = 25.0", "young_kPa_nominal = 0.025", "kPa"),
        ("schema = 1", "schema = 2", "schema"),
    ],
)
def test_a_campaign_that_cannot_be_used_is_one_line(old, new, said, example, tmp_path, capsys):
    changed(example, old, new)
    for words in (["loop", example, "--out", tmp_path / "out"],):
        assert said in refused(words, capsys)
    assert not (tmp_path / "out").exists()


def test_a_calibration_of_another_version_says_so_wherever_it_is_used(example, tmp_path, capsys):
    path = write_calibration(calibration(), tmp_path / "calibration.json")
    data = json.loads(path.read_text())
    path.write_text(json.dumps({**data, "schema": "dummydesign.calibration/2"}))
    for words in (
        ["replay", example, "--calibration", path],
        ["loop", example, "--prior", path, "--out", tmp_path / "out"],
        ["suggest", "--tissue", "forefinger", "--calibration", path, "--no-cad", "--out", tmp_path / "out"],
    ):
        assert "another version" in refused(words, capsys)
    assert not (tmp_path / "out").exists()


def test_a_prior_of_another_resin_is_refused_before_anything_is_fitted(example, tmp_path, capsys):
    path = write_calibration(calibration(pad={"resin": "ecoflex-0030"}), tmp_path / "prior.json")
    changed(example, "young_kPa_nominal", 'resin = "polyurethane-nagoya"\nyoung_kPa_nominal')
    assert "resin = ecoflex-0030" in refused(["loop", example, "--prior", path, "--out", tmp_path / "out"], capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "where",
    [
        "dummydesign.loop.run.close_loop",
        pytest.param("dummydesign.report.loop.write_loop_report", marks=pytest.mark.slow),
    ],
)
def test_an_interrupt_leaves_nothing_new_and_the_old_answer_as_it_was(where, example, tmp_path, monkeypatch, capsys):
    """Stopped in the fit, or with the calibration written and the report not."""
    from dummydesign.loop import run
    from dummydesign.measurement.campaign_file import read_campaign

    real = run.close_loop
    found = []

    def once(*words, **options):
        found[:] = found or [real(*words, **options)]
        return found[0]

    campaign = read_campaign(example)
    few = __import__("dataclasses").replace(campaign, trials=campaign.trials[:8])
    monkeypatch.setattr(
        "dummydesign.loop.run.close_loop",
        lambda *_, **options: once(few, **{key: value for key, value in options.items() if key != "prior"}),
    )
    assert cli.run(["loop", str(example), "--out", str(tmp_path / "out")]) == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}

    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(where, stop)
    capsys.readouterr()
    for more in (["--out", str(tmp_path / "out"), "--replace"], ["--out", str(tmp_path / "new")]):
        assert cli.run(["loop", str(example), *more]) == 130
        assert capsys.readouterr().err == "error: stopped by the user\n"
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["campaign", "out"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of another kind")
def test_control_c_in_the_middle_of_a_run_leaves_no_folder(example, tmp_path):
    words = [sys.executable, "-m", "dummydesign", "loop", str(example), "--out", str(tmp_path / "out")]
    # A test run in the background of a shell ignores SIGINT, and so would the command.
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True, env=dict(os.environ), preexec_fn=heard)
    started = time.monotonic()
    while not list(tmp_path.glob(".out.part-*")) and time.monotonic() - started < 60.0:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60.0)
    # Python ends by the signal itself when it came in code that is compiled at run time; a shell shows 130 for both
    assert process.returncode in (130, -signal.SIGINT) and said.strip().endswith("stopped by the user")
    assert [path.name for path in tmp_path.iterdir()] == ["campaign"]


def test_one_odd_press_is_left_out_and_named_and_more_than_a_tenth_are_a_fault(campaigns, tmp_path):
    """A spike deeper than the pad is thick, in one of 36 presses and in four."""
    folder = tmp_path / "spiked"
    shutil.copytree(campaigns("none", 401), folder)
    names = sorted(path.name for path in folder.glob("*.csv"))

    def spike(name):
        head, *rows = (folder / name).read_text().splitlines()
        time, _, force = rows[len(rows) // 2].split(",")
        rows[len(rows) // 2] = f"{time},25.0,{force}"
        (folder / name).write_text("\n".join([head, *rows]) + "\n")

    spike(names[7])
    read = read_campaign(folder)
    (warning,) = [one for one in read.warnings if one["code"] == "press_left_out"]
    assert names[7] in warning["message"] and len(read.trials) == len(names) - 1
    assert names[7] not in {trial.file for trial in read.trials}
    for name in names[9:12]:
        spike(name)
    with pytest.raises(InputError) as caught:
        read_campaign(folder)
    assert caught.value.code == "inconsistent" and caught.value.quantity == "trial.thickness_mm"
