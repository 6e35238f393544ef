"""The option that lets a new answer take the place of another one."""

from __future__ import annotations

import argparse


def add_replace_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--replace``."""
    parser.add_argument(
        "--replace",
        action="store_true",
        help="take the place of another answer in --out (default: it stays, and the new one gets the next number)",
    )
