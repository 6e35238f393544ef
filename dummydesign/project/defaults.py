"""What a project gives to the commands run inside it: options that were not typed, and where the files go."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from dummydesign.project.folder import Project

GIVEN: dict[tuple[str, ...], tuple[str, ...]] = {
    ("suggest",): ("tissue", "resin", "aim", "shape", "thickness", "ratio", "calibration", "punch"),
    ("predict",): ("punch",),
    ("whatif",): ("tissue", "resin", "aim", "punch"),
    ("compare",): ("tissue", "punch"),
    ("mold",): ("resin",),
    ("campaign", "new"): ("punch",),
    ("campaign", "from-files"): ("punch",),
}
"""Options that each command takes from the project; ``resin`` and ``young`` of ``predict`` stay with the user."""
OUT = {
    "suggest": "designs", "whatif": "designs", "import": "measured", "compare": "designs",
    "compare-designs": "designs", "mold": "moulds", "loop": "calibrations",
}  # fmt: skip
"""Folder of the project into which each command writes when no ``--out`` is typed."""
WITH_TISSUE = ("aim",)
"""Defaults that hold for the project's own tissue alone, as the name of a subject does."""
WITH_RESIN = ("ratio", "calibration")
"""Defaults that hold for the project's own resin alone."""
PATHS = {"tissue": ".toml", "resin": ".toml", "calibration": ".json"}
"""Options that may be files: with this ending they are meant from the project folder on."""


def words_for(project: Project, arguments: Sequence[str], start: str | Path = ".") -> list[str]:
    """Options that a project adds to a command line.

    Parameters
    ----------
    project : Project
    arguments : sequence of str
        As typed after ``dummydesign``; an option that stands there is not added.
    start : path
        Folder that the command is run in; files of the project are named from there.

    Returns
    -------
    list of str
        Such as ``["--tissue", "palm"]``; to be put right after the command.
    """
    typed = {word.partition("=")[0] for word in arguments}
    given, words = project.given(), []
    apart = (WITH_TISSUE if "--tissue" in typed else ()) + (WITH_RESIN if "--resin" in typed else ())
    for name in GIVEN.get(command_of(arguments), ()):
        if name in given and f"--{name}" not in typed and name not in apart:
            words += [f"--{name}", _from_here(project, name, given[name], start)]
    return words


def command_of(arguments: Sequence[str]) -> tuple[str, ...]:
    """The command, with its action where the table knows one, such as ``("campaign", "new")``."""
    two = tuple(arguments[:2])
    return two if two in GIVEN else two[:1]


def _from_here(project: Project, name: str, value: str, start: str | Path) -> str:
    ending = PATHS.get(name)
    if ending is None or not value.lower().endswith(ending) or os.path.isabs(value):
        return value
    return os.path.relpath(project.root / value, Path(start).resolve())


def place_for(project: Project, command: str, name: str, start: str | Path = ".") -> str:
    """Where a command writes in a project: ``designs/NAME``, seen from the folder it is run in.

    Parameters
    ----------
    project : Project
    command : str
        Its name, one of :data:`OUT`.
    name : str
        The folder's name that the command takes by itself.
    start : path
        Folder that the command is run in.
    """
    return os.path.relpath(project.root / OUT[command] / name, Path(start).resolve())
