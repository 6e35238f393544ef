"""``dummydesign compare-designs``: several answers of ``suggest`` side by side."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.shared_options import add_replace_option

HELP = "Compare the designs of several 'suggest' folders: verdict, score, presses, weights."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folders", nargs="+", metavar="DIR", help="folders of 'dummydesign suggest', two or more")
    parser.add_argument("--out", metavar="DIR", help="folder of the report (default compare-designs)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read the designs and write the report."""
    from dummydesign.api import compare_designs

    out = default_out(options) if options.out is None else options.out
    return compare_designs(options.folders, out=out, replace=options.replace).to_dict()


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    return "compare-designs"


def render(result: dict[str, Any]) -> str:
    """The answer on one screen."""
    from dummydesign.cli.texts.designs import render

    return render(result)


def render_details(result: dict[str, Any]) -> str:
    """All designs and presses."""
    from dummydesign.cli.texts.designs import details

    return details(result)
