"""One table of options: declared on a parser, read from texts and values, and typed again."""

from __future__ import annotations

import argparse
from dataclasses import MISSING, dataclass
from functools import partial

import pytest

from dummydesign.cli.common_options import add_options
from dummydesign.core.parsing import (
    HOLD,
    VELOCITY,
    command_words,
    option,
    parse_limits,
    read_number,
    read_numbers,
    read_options,
)
from dummydesign.design.request import Request
from tests.support.refusal import raises_code


@dataclass(frozen=True)
class Press:
    """A table of four options."""

    name: str = option(MISSING, "name", "NAME", "what it is called")
    hold_s: float = option(10.0, "hold", "S", "hold", read=partial(read_number, purpose=HOLD))
    speeds_mm_s: tuple[float, ...] = option(
        (10.0, 250.0),
        "speed",
        "V,V",
        lambda: "speeds",
        argument="velocity_mm_s",
        read=partial(read_numbers, purpose=VELOCITY),
    )
    limits: tuple[float, float] | None = option(
        None, "limits", "MIN:MAX", "limits", between=":", read=partial(parse_limits, quantity="limits")
    )
    quick: bool = option(True, "slow", "", "take time")


def parsed(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_options(parser, Press, ("quick", "name", "hold_s", "speeds_mm_s", "limits"))
    return parser.parse_args(words)


def test_options_are_declared_by_their_flags_with_the_defaults_of_the_table():
    assert vars(parsed("--name", "a")) == {
        "quick": True,
        "name": "a",
        "hold_s": 10.0,
        "velocity_mm_s": (10.0, 250.0),
        "limits": None,
    }
    assert parsed("--name", "a", "--slow").quick is False
    with pytest.raises((SystemExit, argparse.ArgumentError)):
        parsed("--hold", "3")


def test_texts_and_values_are_read_alike_and_faults_name_the_quantity():
    given = {"name": "a", "hold_s": "0.5min", "velocity_mm_s": "0.1m/s,20", "limits": "3:4", "quick": True}
    found = read_options(Press, given)
    assert found == Press("a", 30.0, (100.0, 20.0), (3.0, 4.0))
    assert read_options(Press, given | {"hold_s": 30, "velocity_mm_s": [100, 20], "limits": (3, 4)}) == found
    with raises_code("not_a_number", "hold_s"):
        read_options(Press, given | {"hold_s": "long"})


def test_what_differs_from_the_defaults_is_typed_again():
    values = {"name": "a", "hold_s": 3.0, "speeds_mm_s": [10.0, 20.0], "limits": (3.0, 4.5)}
    assert command_words(Press, values, ("speeds_mm_s", "limits", "hold_s")) == " --speed 10,20 --limits 3:4.5 --hold 3"
    usual = {**values, "speeds_mm_s": [10.0, 250.0], "limits": None}
    assert command_words(Press, usual, ("speeds_mm_s", "limits")) == ""


def test_a_request_of_suggest_is_typed_as_it_was_read():
    words = "--force 2,6 --pad 100x80 --thickness 4:9 --sites 2x1 --hold 3"
    parser = argparse.ArgumentParser()
    add_options(parser, Request, ("force_N", "pad_mm", "thickness_mm", "sites", "hold_s"))
    typed = vars(parser.parse_args(words.split()))
    asked = Request("palm", force_N=(2.0, 6.0), pad_mm=(100.0, 80.0), thickness_mm=(4.0, 9.0), sites=(2, 1), hold_s=3.0)
    assert typed["pad"] == "100x80"
    assert command_words(Request, asked.to_dict(), ("force_N", "pad_mm", "thickness_mm", "sites", "hold_s")) == (
        f" {words}"
    )
