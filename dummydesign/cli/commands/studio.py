"""``dummydesign studio``: the project folder as a page in the browser of this machine."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import count
from dummydesign.core.errors import InputError

HELP = "Open a project folder as a page in the browser: bring in files, design, make the mould, learn, all by clicks."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    meaning = "made when needed (default: the project of the current folder, else this folder)"
    add("folder", nargs="?", metavar="DIR", help=meaning)
    add(
        "--port",
        type=count("port"),
        metavar="P",
        help="open to this computer only (default: the first free one from 8420)",
    )
    add("--no-browser", action="store_true", help="print the address only")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Serve until Ctrl-C."""
    import sys

    from dummydesign.project.folder import find_project
    from dummydesign.studio.app import run_studio

    folder = options.folder
    if folder is None:
        try:
            project = find_project()
        except InputError:
            # the page says what is damaged
            project = None
        folder = "." if project is None else str(project.root)

    def say(text: str) -> None:
        print(f"{text}\n(Ctrl-C ends it; commands that it started go on)", file=sys.stderr, flush=True)

    inputs = {"folder": folder, "port": options.port, "browser": not options.no_browser}
    return {"inputs": inputs, **run_studio(folder, options.port, not options.no_browser, say)}


def render(result: dict[str, Any]) -> str:
    """One line at the end."""
    return f"studio of {result['folder']} ended"
