"""``dummydesign status``: where a project stands, and what to do next."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.text import labelled, screen
from dummydesign.core.errors import InputError

HELP = "Show the state of a project: what was measured, designed, made and learned, and what to do next."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the folder."""
    parser.add_argument("folder", nargs="?", metavar="DIR", help="default: the project of the current folder")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Look at the folder."""
    from dummydesign.project.folder import find_project, read_project
    from dummydesign.project.status import status_of

    project = find_project() if options.folder is None else read_project(options.folder)
    if project is None:
        message = "no project.toml here or above: name a project folder ('dummydesign init DIR' makes one)"
        raise InputError(message, "file_not_found", "project")
    return {"inputs": {"folder": options.folder}, **status_of(project).to_dict()}


def render(result: dict[str, Any]) -> str:
    """One line a thing found, then what comes next."""
    lines = _listing(result)
    steps = labelled("NEXT", f"{result['next']['text']}\n{result['next']['command']}")
    return screen(lines[:2], lines[2:], [""], steps, more="  ... and {} more: --details")


def render_details(result: dict[str, Any]) -> str:
    """The same with every thing found."""
    return "\n".join([*_listing(result), "", f"next: {result['next']['text']}", f"  {result['next']['command']}"])


def _listing(result: dict[str, Any]) -> list[str]:
    from dummydesign.project.status import ProjectFile

    given = ", ".join(f"{name} {value}" for name, value in result["given"].items()) or "nothing given"
    lines = [f"project '{result['name']}' ({given})", ""]
    for room, items in result["found"].items():
        lines.append(f"{room}/".ljust(15) + ("-" if not items else ""))
        lines += [f"  {one['folder'].partition('/')[2]:<32} {ProjectFile(**one).line}".rstrip() for one in items]
    return [*lines, *(f"cannot be read: {problem}" for problem in result["problems"])]
