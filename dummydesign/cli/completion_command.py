"""``dummydesign completion``: the script by which a shell completes commands, options and names."""

from __future__ import annotations

import argparse
from typing import Any

HELP = "Print the script that completes commands, options and names in bash, zsh or fish."
SHELLS = ("bash", "zsh", "fish")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the shell."""
    parser.add_argument("shell", choices=SHELLS, metavar="|".join(SHELLS), help="which shell reads the script")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Return the script, or the next words when the script asks for them."""
    import os

    from dummydesign.cli.completion import BETWEEN, WORDS, next_words, script_of

    asked = os.environ.get(WORDS)
    found = {"script": script_of(options.shell)} if asked is None else {"words": next_words(asked.split(BETWEEN))}
    return {"inputs": {"shell": options.shell}, "warnings": [], "sources": [], **found}


def render(result: dict[str, Any]) -> str:
    """The script as it is, or a word a line."""
    return "\n".join(result["words"]) if "words" in result else result["script"]
