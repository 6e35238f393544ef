"""What every command and every action of one has: --json, -v and -q, what its choices mean, and two examples."""

from __future__ import annotations

import argparse

from dummydesign.cli.choices import choices_text
from dummydesign.cli.examples import examples_of

FLAGS = (
    (("--json",), "print one JSON object and nothing else"),
    (("--details",), "print all of the answer, not one screen of it"),
    (("-v", "--verbose"), "a line for each step with the time since the start, and what it took at the end"),
    (("-q", "--quiet"), "no progress, only the answer"),
)


def epilog_of(command: str, parser: argparse.ArgumentParser) -> str:
    """The end of a command's help: what its choices mean, and its examples."""
    parts = (choices_text(command, parser), examples_of(command))
    return "\n\n".join(part for part in parts if part)


def finish(parser: argparse.ArgumentParser, command: str) -> None:
    """Add it to a command and, below it, to its actions.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        With the options of the command.
    command : str
        Its name; of an action with the action's, ``tissues show``.
    """
    for words, told in FLAGS:
        # an action must not take back what stands before it
        parser.add_argument(*words, action="store_true", default=argparse.SUPPRESS, help=told)
    vars(parser)["command"] = command
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                below.description = next(one.help for one in action._choices_actions if one.dest == name)
                finish(below, f"{command} {name}")
