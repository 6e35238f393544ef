"""Steps that an answer prints can be typed as they are printed, and ask the same again."""

import dataclasses
import shlex
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.cli import run
from dummydesign.cli.commands import loop
from dummydesign.cli.entry import parser_of
from dummydesign.cli.text import WIDTH, labelled, step_lines
from dummydesign.design import next_steps
from dummydesign.design.next_steps import _search_again
from dummydesign.design.request import Request
from dummydesign.design.suggestion import Suggestion
from tests.support.typed_lines import TypedLine, complaints

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


def drawn(rng, answers):
    """What was asked of a drawn search, and an answer to it."""

    def one(*values):
        return values[rng.integers(len(values))]

    cad, mould = one(True, False), one(None, "my moulds/palm")
    asked = {
        "tissue": one("palm", "forefinger"),
        "resin": one("polyurethane-nagoya", "ecoflex-00-30"),
        "shape": one("auto", "slab"),
        "punch": one("14", "round:10", "rectangle:10x20"),
        "force_N": one((5.0, 10.0), (2.0,)),
        "velocity_mm_s": one((10.0, 250.0), (50.0,)),
        "pad_mm": one((150.0, 120.0), (80.0, 60.0)),
        "condition": one("bonded", "frictionless"),
        "preset": one("open", "lidded"),
        "deceleration_mm_s2": one(None, 9000.0),
        "mould": mould,
        "cad": cad,
    }
    asked |= one({}, {"out": "my pads/palm"})
    level = one("stands_for", "usable_with_correction", "not_settled")
    return suggested(asked), answers.answer(level, measured=one(True, False), mould=mould)


def test_steps_of_drawn_searches_can_be_typed_and_name_no_file_that_nothing_writes(monkeypatch):
    """200 combinations of options: a pour sheet was written by the answer, or the step before writes it."""
    from tests.design import test_hours_of_steps as answers

    answers._known_hours.__wrapped__(monkeypatch)
    monkeypatch.setattr(next_steps, "_search_again", _search_again)
    rng = np.random.default_rng(58)
    kinds = set()
    for _ in range(200):
        inputs, answer = drawn(rng, answers)
        answer.request = SimpleNamespace(
            **{**vars(answer.request), "resin": inputs["resin"], "pad_mm": inputs["pad_mm"], "preset": inputs["preset"]}
        )
        answer.mould_command = Suggestion.mould_command.fget(answer)
        steps = next_steps.next_steps(answer, inputs)
        lines = [TypedLine("NEXT", step.command.removeprefix("dummydesign ")) for step in steps if step.command]
        assert [complaints(line, ("my-batch",)) for line in lines] == [[]] * len(lines)
        words = [step.do for step in steps]
        if "cast the pad by its pour sheet" in words:
            written = bool(inputs["cad"] and inputs.get("out"))
            before = steps[words.index("cast the pad by its pour sheet") - 1]
            assert written != (before.command or "").startswith("dummydesign mold --thickness")
            kinds.add(written)
    assert kinds == {True, False}


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
