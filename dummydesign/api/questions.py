"""What a call was asked, for its manifest: which files stand behind the names it was given."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike, fspath
from typing import Any

from dummydesign.core.outputs.manifest import Question

APART = ("out", "workers", "scheduler", "resume", "replace", "save_profile")
"""Inputs that an answer does not depend on."""


def question(
    command: str,
    inputs: Mapping[str, Any],
    *,
    tissue: str | None = None,
    resin: str | None = None,
    preset: str | None = None,
    files: Iterable[str | PathLike[str] | None] = (),
) -> Question:
    """Make the question of a call.

    Parameters
    ----------
    command : str
        Name of the command, as it is typed.
    inputs : mapping
        All values used, as the answer names them.
    tissue, resin, preset : str, optional
        Names of the library or paths.
    files : iterable of path
        Other files that are read; None is left out.
    """
    from dummydesign.core.datafiles import find

    read: dict[str, str | PathLike[str]] = {}
    for kind, what, name in (
        ("materials/tissues", "tissue", tissue),
        ("materials/resins", "resin", resin),
        ("molds", "mould preset", preset),
    ):
        if name is not None:
            read[f"{what} {name}"] = find(kind, what, name).path
    read |= {fspath(path): path for path in files if path is not None}
    return Question(command, {key: value for key, value in inputs.items() if key not in APART}, read)
