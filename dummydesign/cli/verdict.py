"""The verdict as the first line on a terminal: a light in colour, and the same in a word."""

from __future__ import annotations

from typing import Any

CODES = {"green": "32", "amber": "33", "red": "31"}


def verdict_lines(verdict: dict[str, Any] | None, coloured: bool | None = None) -> list[str]:
    """The verdict and an empty line; nothing where there is none.

    Parameters
    ----------
    verdict : dict or None
        As in the JSON of the commands.
    coloured : bool, optional
        By default where standard output is a terminal and ``NO_COLOR`` is not set.
    """
    if verdict is None:
        return []
    if coloured is None:
        coloured = _wants_colour()
    word, _, rest = verdict["text"].partition(":")
    head = f"{verdict['light'].upper()}  {word.upper()}"
    if coloured:
        head = f"\033[1;{CODES[verdict['light']]}m\u25cf {head}\033[0m"
    return [f"{head}:{rest}", ""]


def _wants_colour() -> bool:
    import os
    import sys

    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")
