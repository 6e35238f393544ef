"""``dummydesign suggest``: recipe, pad and mould for a tissue."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_effect_option, add_options, add_replace_option
from dummydesign.core.errors import NoAnswerError

ABOUT_STEPS = 8
HELP = "Recommend resin ratio, pad thickness, weights to pour and a mould for a tissue."
OWN_TEST = (
    "punch",
    "edge_radius_mm",
    "condition",
    "force_N",
    "velocity_mm_s",
    "hold_s",
    "deceleration_mm_s2",
    "pad_mm",
    "base",
    "sites",
    "preset",
)
"""How people and pad are pressed, and what the mould must fit."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be asked."""
    from dummydesign.design.request import Request

    add = parser.add_argument
    add_options(parser, Request, ("tissue", "aim", "resin", "thickness_mm", "ratio", "calibration"))
    add_effect_option(parser)
    add_options(parser, Request, ("shape", "mould"))
    add_options(parser, Request, ("cad", "verify"))
    test = parser.add_argument_group("your own test", "numbers may carry their unit: 0.25m/s, 10mm/s")
    add_options(test, Request, OWN_TEST)
    add("--out", metavar="DIR", help="folder of the files (default suggest-TISSUE)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Find the design, make its mould, write the report and return the answer."""
    from dummydesign.api.designs import answer_request
    from dummydesign.cli.progress import steps_shown
    from dummydesign.design.request import Request

    if options.calibration == "none":
        options.calibration = None
    request = Request.read(**vars(options))
    with steps_shown(ABOUT_STEPS) as steps:
        answer = answer_request(request, options.out, options.replace, steps)
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


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from pathlib import Path

    return f"suggest-{Path(options.tissue).stem}"
