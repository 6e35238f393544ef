"""The command lines of the pages: what is chosen there, as one would type it in the project folder."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence


def shown(words: Sequence[str]) -> str:
    """A command line as it is typed; names with other letters than these are quoted."""
    return " ".join(["dummydesign", *(shlex.quote(word) for word in words)])


def options(given: Mapping[str, object]) -> list[str]:
    """Options that are not empty: numbers short, True as a bare flag.

    Parameters
    ----------
    given : mapping
        By name without dashes.
    """
    words: list[str] = []
    for name, value in given.items():
        if value is None or value is False or (isinstance(value, str) and not value.strip()):
            continue
        words.append(f"--{name}")
        if value is not True:
            words.append(f"{value:g}" if isinstance(value, float) else str(value).strip())
    return words


def suggest(given: Mapping[str, object], out: str) -> list[str]:
    """Design a pad, without its mould.

    Parameters
    ----------
    given : mapping
        tissue, aim, resin, shape, thickness, ratio, calibration.
    out : str
        Name of the folder under ``designs/``.
    """
    return ["suggest", *options(given), "--no-cad", "--out", f"designs/{out}"]
