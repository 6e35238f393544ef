"""``dummydesign suggest``: recipe, pad and mould for a tissue."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_effect_option, add_replace_option, call_in_steps
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
    "machine",
    "silicone",
)
"""How people and pad are pressed, and what the mould must fit."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be asked."""
    from dummydesign.design.options import SuggestOptions, add_options

    add = parser.add_argument
    add_options(parser, SuggestOptions, ("tissue", "aim", "resin", "thickness_mm", "ratio", "calibration"))
    add_effect_option(parser)
    add_options(parser, SuggestOptions, ("shape", "mould"))
    add("--cad", action="store_const", const=True, help="make the mould even if the pad is red")
    add("--no-cad", dest="cad", action="store_const", const=False, help="skip the mould; write recipe and report only")
    add_options(parser, SuggestOptions, ("verify",))
    test = parser.add_argument_group("your own test", "numbers may carry their unit: 0.25m/s, 10mm/s")
    add_options(test, SuggestOptions, OWN_TEST)
    add_options(parser, SuggestOptions, ("weighing_g", "thickness_tolerance_mm", "castings"))
    add("--robot-mass", metavar="KG", help="safety view: mass of the free body that hits tissue and pad")
    add("--robot-velocity", metavar="MM_S", help="its speed, with --robot-mass (default 250 mm/s)")
    add("--limits", metavar="FILE", help="safety view: your limits of force and pressure, with their source (TOML)")
    drives = "also predict the presses on people: position, steady, force, mass:KG, spring:K,M or spring:K,M,ZETA"
    add("--drive", metavar="NAME", help=drives)
    add("--out", metavar="DIR", help="folder of the files (default suggest-TISSUE)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Find the design, make its mould, write the report and return the answer."""
    from dummydesign.api.designs import suggest

    if options.calibration == "none":
        options.calibration = None
    answer = call_in_steps(ABOUT_STEPS, suggest, options)
    result = answer.to_dict()
    if not answer.outcome.verdict.acceptable:
        text = f"no acceptable pad: the best one found is {result['verdict']['level'].replace('_', ' ')}"
        text += "" if options.cad is not None else "; no mould was made of it (--cad makes it anyway)"
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
