"""The end of a command's help: what its choices mean, two examples; options of every command."""

from __future__ import annotations

import argparse
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any


@cache
def help_texts() -> dict[str, dict[str, Any]]:
    """Read ``choices`` by option (or command and option), and ``examples`` by command, of ``help.toml``."""
    return tomllib.loads((Path(__file__).parent / "help.toml").read_text(encoding="utf-8"))


def meanings_of(command: str, action: argparse.Action) -> dict[str, str]:
    """What the words mean that an option lists in its help; empty for options without such words."""
    name = action.dest
    choices = {option: words for options, words in help_texts()["choices"].items() for option in options.split(", ")}
    known = choices.get(f"{command.partition(' ')[0]} {name}", choices.get(name, {}))
    if name == "shape":
        from dummydesign.geometry.shape_registry import shape_meanings

        known = shape_meanings() | known
    said = action.help or ""
    return {word: text for word, text in known.items() if re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", said)}


FLAGS = (
    (("--json",), "print one JSON object and nothing else"),
    (("--details",), "print all of the answer, not one screen of it"),
    (("-v", "--verbose"), "a line for each step with the time since the start, and what it took at the end"),
    (("-q", "--quiet"), "no progress, only the answer"),
)


def epilog_of(command: str, parser: argparse.ArgumentParser) -> str:
    """The end of a command's help: what its choices mean, and its examples."""
    rows = []
    for action in parser._actions:
        found = meanings_of(command, action)
        if found:
            rows.append(f"  {action.option_strings[-1]}")
            rows += [f"    {word:<17} {text}" for word, text in found.items()]
    examples = [f"  {what}:\n    dummydesign {words}" for what, words in help_texts()["examples"].get(command, ())]
    parts = (("what the choices mean:", rows), ("examples:", examples))
    return "\n\n".join("\n".join([title, *lines]) for title, lines in parts if lines)


def finish(parser: argparse.ArgumentParser, command: str) -> None:
    """Add it to a command and, below it, to its actions."""
    for flags, meaning in FLAGS:
        # an action must not take back what stands before it
        parser.add_argument(*flags, action="store_true", default=argparse.SUPPRESS, help=meaning)
    vars(parser)["command"] = command
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                below.description = next(one.help for one in action._choices_actions if one.dest == name)
                finish(below, f"{command} {name}")
