"""The option by which a command takes effects of your own."""

from __future__ import annotations

import argparse


def add_effect_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--effect``, which may be given several times."""
    parser.add_argument(
        "--effect", metavar="FILE.py", action="append", default=[],
        help="an effect of your own, one class in a file that is run; may be given several times",
    )  # fmt: skip
