"""Commands that call one function: no option without an argument, no argument without an option, equal defaults."""

from __future__ import annotations

import argparse
from inspect import Parameter, signature

import pytest

from dummydesign.api import campaigns, designs, predictions, traces
from dummydesign.cli import entry
from dummydesign.cli.commands import compare, fit, predict, replay, suggest, whatif
from dummydesign.cli.common_options import add_options
from tests.support.refusal import raises_code

PAIRS = [
    (compare, traces.compare, set()),
    (fit, traces.fit, set()),
    (predict, predictions.predict, set()),
    (replay, campaigns.replay, set()),
    (suggest, designs.suggest, set()),
    (whatif, designs.whatif, {"executor"}),
]
"""Command, call, and arguments that only Python can give; ``progress`` is the command's own."""


@pytest.mark.parametrize(("command", "function", "only"), PAIRS, ids=lambda one: getattr(one, "__name__", ""))
def test_options_and_arguments_are_the_same(command, function, only):
    parser = declared(command)
    options = {one.dest: one for one in parser._actions if one.dest != "help"}
    arguments = dict(signature(function).parameters)
    assert set(arguments) - set(options) == {"progress", *only}
    assert set(options) - set(arguments) == set()
    for name, option in options.items():
        usual = arguments[name].default
        if usual is Parameter.empty:
            assert option.required or option.nargs == "+", name
        else:
            assert plain(option.default) == plain(usual), name


def declared(command):
    """A parser with what a command takes."""
    parser = argparse.ArgumentParser()
    getattr(command, "add_arguments", lambda one: add_options(one, command.CALL))(parser)
    return parser


def plain(value):
    """A default as numbers where it is a list of them: typed ``10,250``, in Python ``(10.0, 250.0)``."""
    text = ",".join(map(str, value)) if isinstance(value, list | tuple) else value
    text = text.replace("x", ",") if isinstance(text, str) and text[:1].isdigit() else text
    try:
        return [float(one) for one in str(text).split(",")] if text not in ("", None) else []
    except ValueError:
        return text


def namespace(**given):
    return argparse.Namespace(**given)


class Answer:
    """What a call answers; the folder of the files is of no matter here."""

    def to_dict(self):
        return {"answer": 1}


def test_a_calibration_none_is_none_and_a_red_pad_is_an_answer_that_is_refused(monkeypatch):
    seen = {}

    def made(acceptable):
        verdict = argparse.Namespace(acceptable=acceptable)
        answer = argparse.Namespace(
            outcome=argparse.Namespace(verdict=verdict, mould_command="dummydesign mold 5"),
            to_dict=lambda: {"verdict": {"level": "not_representative"}},
        )

        def function(calibration, progress):
            seen.update(calibration=calibration)
            return answer

        return function

    for cad in (True, False):
        monkeypatch.setattr(designs, "suggest", made(False))
        with raises_code("no_acceptable_pad", "verdict") as caught:
            suggest.run(namespace(tissue="palm", calibration="none", cad=cad, out=None, replace=False))
        assert ("dummydesign mold 5" in str(caught.value)) is cad
    assert seen == {"calibration": None}
    monkeypatch.setattr(designs, "suggest", made(True))
    assert suggest.run(namespace(tissue="palm", calibration="c.json", cad=True, out=None, replace=False))["verdict"]
    assert seen == {"calibration": "c.json"}


def test_folders_have_the_name_of_what_they_are_about():
    assert compare.default_out(namespace(tissue="own/hand.toml")) == "compare-hand"
    assert whatif.default_out(namespace(resin="polyurethane-nagoya")) == "whatif-polyurethane-nagoya"


def test_a_fit_without_a_file_writes_none():
    """An empty --out is none: the traces are looked for, not a name that ends in .toml."""
    for out, code in ((None, "file_not_found"), ("", "file_not_found"), ("b.txt", "bad_name")):
        with raises_code(code):
            entry._called(fit, declared(fit).parse_args(["missing.csv", *([] if out is None else ["--out", out])]))


def replayed(effects, count=2, noise_floor_N=0.1):
    errors = {"base_rmse_N": 9.0, "peak_error_N": -0.5}
    trials = [{"file": f"p{at}.csv", "rmse_N": float(at), **errors} for at in range(1, count + 1)]
    return {
        "verdict": None,
        "rmse_N": 0.25,
        "base_rmse_N": 0.5,
        "noise_floor_N": noise_floor_N,
        "holds": 0.25 <= 2.0 * noise_floor_N,
        "inputs": {"campaign": "camp"},
        "effects": effects,
        "trials": trials,
        "pads": [],
        "budget": None,
        "warnings": [],
    }


def test_a_replay_lists_the_worst_press_first_and_names_its_effects():
    text = replay.render(replayed(["adhesion"]))
    assert "0.2500 N rms with adhesion; 0.5000 N with the base model" in text and "2 presses" in text
    assert text.rindex("p2.csv") < text.rindex("p1.csv")
    assert "the base model's error" in replay.render(replayed([]))
    assert text.startswith("FAILS") and replay.render(replayed([], noise_floor_N=0.2)).startswith("HOLDS")


def test_numbers_of_whatif_are_read_as_its_defaults():
    parser = declared(whatif)
    options = parser.parse_args(["--thickness", "5:15:5"])
    assert options.velocity_mm_s == (10.0, 250.0) and options.workers == 1
