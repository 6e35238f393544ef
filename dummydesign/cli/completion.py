"""``dummydesign completion``: the words that may come next in bash, zsh and fish, from the commands' own parsers."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from dummydesign.cli.common_options import name_of
from dummydesign.cli.entry import COMMANDS, actions_of, meanings_of, parser_of

WORDS = "DUMMYDESIGN_COMPLETE"
"""Environment variable with the words typed so far, by which a shell's script asks for the next one."""
BETWEEN = "\x1f"
LIBRARY = {
    "tissue": "materials/tissues",
    "resin": "materials/resins",
    "preset": "molds",
    "machine": "molds/machines",
    "silicone": "molds/silicones",
}


def next_words(typed: Sequence[str]) -> list[str]:
    """Return what the last of the words after ``dummydesign`` may become; empty where a file or a number is due."""
    *before, now = typed
    if not before:
        return _beginning(now, COMMANDS)
    if before[0] not in COMMANDS:
        return []
    parser, command = parser_of(before[0]), before[0]
    for word in before[1:]:
        below = actions_of(parser)
        if word in below:
            parser, command = below[word], f"{command} {word}"
    asked = parser._option_string_actions.get(before[-1])
    if asked is not None and asked.nargs != 0:
        return _beginning(now, _values(command, asked))
    if now.startswith("-"):
        return _beginning(now, parser._option_string_actions)
    due = [action for action in parser._actions if not action.option_strings]
    return _beginning(now, (value for action in due for value in _values(command, action)))


def _values(command: str, action: argparse.Action) -> list[str]:
    """What an option or argument may be: its choices, named files, and the words that its help explains."""
    from dummydesign.core.user_library import entries

    if action.choices is not None:
        return [str(choice) for choice in action.choices]
    name = name_of(action)
    own_only = command.endswith((" remove", " rename"))
    if name == "name" and command.partition(" ")[2] in ("show", "path", "remove", "rename"):
        name = command.partition(" ")[0].removesuffix("s")
    named = (
        [one.name for one in entries(LIBRARY[name]).values() if one.origin == "user" or not own_only]
        if name in LIBRARY
        else []
    )
    listed = [part for part in str(action.metavar or "").split("|") if re.fullmatch(r"[a-z][a-z-]*|\d", part)]
    meant = [word.partition(":")[0] + ":" * (":" in word) for word in meanings_of(command, action) if " " not in word]
    return [*named, *(listed if len(listed) > 1 else []), *meant]


def _beginning(now: str, words: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(word for word in words if word.startswith(now)))


HELP = "Print the script that completes commands, options and names in bash, zsh or fish."
SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the shell."""
    parser.add_argument("shell", choices=SHELLS, metavar="|".join(SHELLS), help="which shell reads the script")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Return the script, or the next words when the script asks for them."""
    head = {"inputs": {"shell": options.shell}, "warnings": [], "sources": []}
    # a shell reads the script once; at each Tab that asks this program for the next words
    if (asked := os.environ.get(WORDS)) is not None:
        return head | {"words": next_words(asked.split(BETWEEN))}
    return head | {"script": (Path(__file__).parent / f"completion.{options.shell}").read_text(encoding="utf-8")}


def render(result: dict[str, Any]) -> str:
    """The script as it is, or a word a line."""
    return "\n".join(result["words"]) if "words" in result else result["script"]
