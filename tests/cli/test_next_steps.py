"""Steps that an answer prints can be typed as they are printed, and ask the same again."""

import dataclasses
import shlex
import subprocess
import sys

import pytest

from dummydesign.cli import run
from dummydesign.cli.commands import loop
from dummydesign.cli.entry import parser_of
from dummydesign.cli.text import WIDTH, labelled, step_lines
from dummydesign.design.next_steps import _search_again
from dummydesign.design.request import Request

DEFAULTS = {one.name: one.default for one in dataclasses.fields(Request)}
ASKED = {
    "tissue": "my people/Käse hand.toml",
    "preset": "my printers/large one.toml",
    "deceleration_mm_s2": 20000.0,
}


def suggested(asked):
    """What was asked of suggest, as its answer holds it."""
    return {**DEFAULTS, "condition": "bonded", **asked}


def test_the_next_search_keeps_what_was_asked_and_can_be_typed():
    command = "\n".join(line[8:] for line in step_lines(["read the puck", _search_again(suggested(ASKED), "my-batch")]))
    command = command[command.index("dummydesign suggest") :]
    assert max(len(line) for line in command.splitlines()) <= WIDTH - 8 and "\\\n" in command
    shown = [sys.executable, "-c", "import sys; print(*sys.argv[1:], sep='\\n')"]
    script = command.replace("dummydesign", shlex.join(shown), 1)
    words = subprocess.run(["sh", "-c", script], capture_output=True, text=True, check=True).stdout.splitlines()
    typed = vars(parser_of("suggest").parse_args(words[1:]))
    for name, value in {**ASKED, "resin": "my-batch"}.items():
        word = typed[name]
        assert word == value if isinstance(value, str) else float(word) == value, name


def test_a_mould_that_was_made_is_kept_and_nothing_of_its_pad_is_asked_again():
    asked = suggested({"tissue": "palm", "thickness_mm": (5.0, 5.0), "out": "my pads/palm", "cad": True})
    command = _search_again(asked, "my-batch")
    typed = vars(parser_of("suggest").parse_args(shlex.split(command)[2:]))
    assert typed["mould"] == "my pads/palm" and typed["thickness_mm"] is None and typed["resin"] == "my-batch"
    assert _search_again(suggested({"tissue": "palm"}), "b") == "dummydesign suggest --tissue palm --resin b"


@pytest.mark.slow
def test_a_campaign_in_a_folder_with_blanks_is_named_so_that_it_can_be_typed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["campaign", "new", "neue Fläche", "--young", "35", "--pads", "10"]) == 0
    words = shlex.split(" ".join(capsys.readouterr().out.split("NEXT")[1].split("FILES")[0].split()))
    assert words[words.index("dummydesign") :] == ["dummydesign", "campaign", "check", "neue Fläche"]


@pytest.mark.parametrize("ranking", [[], [{"name": "sensor_lag", "evidence": 12.0}]])
def test_details_of_a_loop_without_evidence_have_no_empty_list(ranking):
    number = {"train_rmse_N": 0.1, "heldout_rmse_N": 0.1, "noise_floor_N": 0.1, "lack_of_fit_p": 0.5}
    side = {"error": number, "parameters": {}}
    residual = {"heldout_over_noise_floor": None, "expected_over_noise_floor": None, "unexplained_because": []}
    result = {
        "answer": [],
        "verdict": "none",
        "residual": residual,
        "effects": [],
        "as_designed": None,
        "base": side,
        "after": side,
        "ranking": ranking,
        "next_measurement": None,
        "warnings": [],
        "files": {},
    }
    lines = loop.render_details(result).splitlines()
    assert not lines[-1].endswith(":")
    assert ("sensor_lag" in lines[-1]) == bool(ranking)


def test_a_text_is_cut_between_words():
    text = " ".join(["eleven"] * 60)
    *_, last = labelled("WARNING", text, 2)
    assert last.endswith("eleven ...") and len(last) <= WIDTH


@pytest.mark.parametrize("before", range(50, 100))
def test_a_command_in_a_text_is_never_parted(before):
    text = " ".join(["ab"] * (before // 3)) + "x" * (before % 3) + " dummydesign tissues add NAME and more"
    assert any("dummydesign tissues add" in line for line in labelled("NEXT", text))
    assert " ".join(" ".join(labelled("NEXT", text)).split()) == f"NEXT {text}"
