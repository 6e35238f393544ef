"""``dummydesign doctor``: what this machine lacks, and how to get it."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.text import labelled, screen

HELP = "Check this machine: versions, missing parts and how to get them, folders, one solve, one solid."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what can be left out."""
    parser.add_argument("--no-cad", action="store_true", help="do not make the solid")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Check; an unfit machine has no answer but its checks."""
    from dummydesign.api.health import check_machine
    from dummydesign.core.errors import NoAnswerError

    health = check_machine(not options.no_cad)
    result = {"inputs": {"no_cad": options.no_cad}, "sources": [], **health.to_dict()}
    failed = [check.name for check in health.checks if check.status == "failed"]
    if failed:
        raise NoAnswerError("machine_unfit", f"this machine cannot be used yet: {', '.join(failed)}", result, "machine")
    return result


def render(result: dict[str, Any]) -> str:
    """A line for each check, with the remedy below what is missing."""
    lines = []
    for one in result["checks"]:
        lines.append(f"  {one['status']:<9}{one['name']:<13}{one['value']}")
        if one["advice"]:
            lines.append(f"  {'':<22}{one['advice']}")
    text = "This machine can be used." if result["ready"] else "This machine cannot be used yet."
    if result["ready"] and any(one["status"] == "missing" for one in result["checks"]):
        text += " What is missing is optional."
    return screen([*labelled("READY" if result["ready"] else "FAILED", text), ""], lines)
