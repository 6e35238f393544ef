"""``dummydesign suggest``: recipe, pad and mould for a tissue."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_options, call_in_steps, named_by
from dummydesign.core.errors import NoAnswerError

ABOUT_STEPS = 8
CALL = "designs.suggest"
HELP = "Recommend resin ratio, pad thickness, weights to pour and a mould for a tissue."
default_out = named_by("suggest", "tissue")
OWN_TEST = (
    "punch edge_radius_mm condition force_N velocity_mm_s hold_s deceleration_mm_s2 pad base sites preset".split()
)
"""How people and pad are pressed, and what the mould must fit."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be asked."""
    add_options(parser, CALL, OWN_TEST)
    test = parser.add_argument_group("your own test", "numbers may carry their unit: 0.25m/s, 10mm/s")
    add_options(test, CALL)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Find the design, make its mould, write the report and return the answer."""
    named = None if options.calibration == "none" else options.calibration
    answer = call_in_steps(ABOUT_STEPS, CALL, options, calibration=named)
    result = answer.to_dict()
    if not answer.outcome.verdict.acceptable:
        text = "no acceptable pad: the verdict on the best one found is red"
        if options.cad:
            text += f"; no mould was made of it, which '{answer.outcome.mould_command}' makes"
        raise NoAnswerError("no_acceptable_pad", text, result, "verdict")
    return result


def render(result: dict[str, Any]) -> str:
    """The answer on one screen."""
    from dummydesign.cli.suggest_text import render

    return render(result)


def render_details(result: dict[str, Any]) -> str:
    """All of the answer."""
    from dummydesign.cli.suggest_text import details

    return details(result)
