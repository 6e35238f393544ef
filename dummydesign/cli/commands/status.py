"""``dummydesign status``: where a project stands, and what to do next."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.text import labelled, screen
from dummydesign.core.errors import InputError
from dummydesign.core.levels import level_name

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
    given = ", ".join(f"{name} {value}" for name, value in result["given"].items()) or "nothing given"
    lines = [f"project '{result['name']}' ({given})", ""]
    for room, items in result["found"].items():
        lines.append(f"{room}/".ljust(15) + ("-" if not items else ""))
        lines += [f"  {one['folder'].partition('/')[2]:<32} {status_line(one)}".rstrip() for one in items]
    return [*lines, *(f"cannot be read: {problem}" for problem in result["problems"])]


def status_line(one: dict[str, Any]) -> str:
    """What is known of one thing found, in a few words."""
    summary = one["summary"] or {}
    if "pressed" in summary:
        left = f", {summary['wrong']} problem{'s' * (summary['wrong'] > 1)}" if summary["wrong"] else ""
        return f"{summary['pressed']} of {summary['pressed'] + summary['missing']} presses are there{left}"
    if "thickness_mm" in summary and "ratio" in summary:
        verdict = f": {level_name(summary['verdict'])}" if summary.get("verdict") else ""
        return f"{summary['thickness_mm']:g} mm {summary['shape']}, ratio {summary['ratio']:g}{verdict}"
    if "traces" in summary:
        return f"{summary['traces']} presses"
    if "effects" in summary:
        return f"{summary['verdict']}: {', '.join(summary['effects']) or 'no effect'}"
    return str(one["command"] or "as measured" if one["folder"].startswith("measured/") else one["command"])
