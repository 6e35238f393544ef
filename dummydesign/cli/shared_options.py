"""Options that several commands have: effects of one's own, and taking the place of another answer."""

from __future__ import annotations

import argparse


def add_effect_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--effect``, which may be given several times."""
    parser.add_argument(
        "--effect", metavar="FILE.py", action="append", default=[],
        help="an effect of your own, one class in a file that is run; may be given several times",
    )  # fmt: skip


def add_replace_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--replace``."""
    parser.add_argument(
        "--replace",
        action="store_true",
        help="take the place of another answer in --out (default: it stays, and the new one gets the next number)",
    )
