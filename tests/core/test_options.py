"""Options by the names of arguments: declared from a call's signature and docstring, read, and typed again."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

import pytest

from dummydesign.cli.common_options import add_options
from dummydesign.core.parsing import command_words
from dummydesign.design.request import Request
from tests.support.refusal import raises_code


def press(
    files: Iterable[str],
    name: str,
    *,
    hold_s: float | str = 10.0,
    mass_g: float | None = None,
    repeats: int = 2,
    velocity_mm_s: str = "10,250",
    own: Iterable[str] = (),
    quick: bool = True,
    replace: bool = False,
    progress: object = None,
) -> None:
    """Press.

    Parameters
    ----------
    files : TRACE.csv ...
        CSV files.
    name : --called NAME
        What it is called, ``auto`` (default) or 20 %.
    hold_s : S
        Hold after
        the stop. [s]

        This is of Python.
    mass_g : G
        Young's mass. [g]
    repeats : N
        How often.
    velocity_mm_s : V,V,...
        Speeds. [mm/s]
    own : --also FILE ...
        May be repeated.
    quick
        Take time.
    replace
        Replace.
    progress : callable, optional
        Called.

    Returns
    -------
    None
        Nothing.
    """


def parser_of_press(*leave: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_options(parser, press, leave)
    return parser


def parsed(*words: str) -> argparse.Namespace:
    return parser_of_press().parse_args(words)


def test_options_are_the_arguments_of_the_call_with_their_defaults():
    assert vars(parsed("a.csv", "b.csv", "--called", "x")) == {
        "files": ["a.csv", "b.csv"],
        "name": "x",
        "hold_s": 10.0,
        "mass_g": None,
        "repeats": 2,
        "velocity_mm_s": "10,250",
        "own": [],
        "quick": True,
        "replace": False,
    }
    typed = parsed("a", "--called", "x", "--no-quick", "--replace", "--also", "c", "--also", "d", "--hold", "3s")
    assert (typed.quick, typed.replace, typed.own, typed.hold_s) == (False, True, ["c", "d"], "3s")


def test_annotations_say_what_is_read_as_a_number():
    typed = parsed("a", "--called", "x", "--mass", "2kg", "--repeats", "4")
    assert (typed.mass_g, typed.repeats) == (2000.0, 4)
    with raises_code("not_a_number", "mass_g"):
        parsed("a", "--called", "x", "--mass", "heavy")
    with raises_code("not_a_number", "repeats"):
        parsed("a", "--called", "x", "--repeats", "1.5")


@pytest.mark.parametrize("words", [["a"], ["--called", "x"]])
def test_what_has_no_default_is_required(words):
    with pytest.raises((SystemExit, argparse.ArgumentError)):
        parsed(*words)


def test_help_is_the_first_paragraph_without_marks_and_unit():
    helps = {action.dest: action.help for action in parser_of_press()._actions}
    assert helps["files"] == "CSV files" and helps["mass_g"] == "Young's mass"
    assert helps["name"] == "what it is called, auto (default) or 20 %%"
    assert helps["hold_s"] == "hold after the stop"


def test_options_that_are_left_are_declared_in_a_group():
    parser = parser_of_press("own", "hold_s")
    assert [action.dest for action in parser._actions][1:4] == ["files", "name", "mass_g"]
    group = parser.add_argument_group("more")
    add_options(group, press)
    assert [action.dest for action in group._group_actions] == ["hold_s", "own"]


def test_texts_and_values_are_read_alike_and_faults_name_the_quantity():
    from dummydesign.api.designs import suggest

    parser = argparse.ArgumentParser()
    add_options(parser, suggest)
    typed = vars(
        parser.parse_args("--tissue palm --hold 0.5min --velocity 0.1m/s,20 --thickness 4:9 --pad 90x80".split())
    )
    found = Request.read(**typed)
    assert (found.hold_s, found.velocity_mm_s, found.thickness_mm) == (30.0, (100.0, 20.0), (4.0, 9.0))
    values = {"hold_s": 30, "velocity_mm_s": [100, 20], "thickness_mm": (4, 9), "pad": (90, 80)}
    assert Request.read(**typed | values) == found
    with raises_code("not_a_number", "hold_s"):
        Request.read(**typed | {"hold_s": "long"})


def test_what_differs_from_the_defaults_is_typed_again():
    usual = Request("palm").to_dict()
    assert command_words(Request, usual | {"velocity_mm_s": [10.0, 250.0]}, ("velocity_mm_s", "thickness_mm")) == ""


def test_a_request_of_suggest_is_typed_as_it_was_read():
    from dummydesign.api.designs import suggest

    words = "--force 2,6 --pad 100x80 --thickness 4:9 --sites 2x1 --hold 3"
    parser = argparse.ArgumentParser()
    add_options(parser, suggest)
    asked = Request.read(**vars(parser.parse_args(["--tissue", "palm", *words.split()])))
    assert asked.pad_mm == (100.0, 80.0)
    assert command_words(Request, asked.to_dict(), ("force_N", "pad_mm", "thickness_mm", "sites", "hold_s")) == (
        f" {words}"
    )
