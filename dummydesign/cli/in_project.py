"""What the project folder one stands in adds to a command line, and where its commands write."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dummydesign.project.folder import Project

HELP_WORDS = ("-h", "--help")


def project_here(arguments: Sequence[str]) -> Project | None:
    """The project that a command is run in; None for a command that takes nothing from one, and for its help."""
    from dummydesign.project.defaults import GIVEN, OUT, command_of

    asked = command_of(arguments)
    if any(word in HELP_WORDS for word in arguments) or (asked not in GIVEN and asked[0] not in OUT):
        return None
    from dummydesign.project.folder import find_project

    return find_project()


def with_defaults(project: Project | None, arguments: Sequence[str]) -> list[str]:
    """The command line with what the project adds, right after the command, so that what is typed wins."""
    if project is None:
        return list(arguments)
    from dummydesign.project.defaults import command_of, words_for

    place = len(command_of(arguments))
    return [*arguments[:place], *words_for(project, arguments), *arguments[place:]]


def settle_out(project: Project | None, command: str, module: ModuleType, options: argparse.Namespace) -> None:
    """Put the answer of a command without ``--out`` into its folder of the project.

    Parameters
    ----------
    project : Project or None
        Nothing changes without one.
    command : str
        Its name.
    module : ModuleType
        The command's, whose ``default_out`` names the folder.
    options : argparse.Namespace
        Its ``out`` is set.
    """
    from dummydesign.project.defaults import OUT, place_for

    if project is None or command not in OUT or options.out is not None:
        return
    name = module.default_out(options)
    if name is not None:
        options.out = place_for(project, command, name)
