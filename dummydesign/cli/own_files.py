"""What both libraries can do with a file of the user: remove it, rename it, say where it lies."""

from __future__ import annotations

import argparse
from typing import Any

ACTIONS = ("remove", "rename", "path")


def add_own_actions(actions: Any, what: str) -> None:
    """Declare the actions on a file of your own."""
    remove = actions.add_parser("remove", help=f"delete a {what} of your own", allow_abbrev=False)
    remove.add_argument("name", metavar="NAME", help="as the list has it")
    rename = actions.add_parser("rename", help=f"give a {what} of your own another name", allow_abbrev=False)
    rename.add_argument("name", metavar="OLD", help="its name now")
    rename.add_argument("new", metavar="NEW", help="its name from now on")
    path = actions.add_parser("path", help=f"file of a {what}", allow_abbrev=False)
    path.add_argument("name", metavar="NAME", help="as the list has it")


def run_own(options: argparse.Namespace, kind: str, what: str) -> dict[str, Any]:
    """Do the action and return plain values.

    Parameters
    ----------
    options : argparse.Namespace
        With ``action`` (path, remove or rename) and its names.
    kind, what : str
        Folder, such as ``materials/resins``, and how the thing is called, such as ``resin``.
    """
    from dummydesign.core.datafiles import find
    from dummydesign.core.own_files import remove_own, rename_own

    inputs: dict[str, Any] = {"action": options.action, "name": options.name}
    if options.action == "path":
        entry = find(kind, what, options.name)
        return {"inputs": inputs, "name": entry.name, "origin": entry.origin, "path": str(entry.path)}
    if options.action == "remove":
        gone = [str(path) for path in remove_own(kind, what, options.name)]
        return {"inputs": inputs, "name": options.name, "removed": gone}
    path, warnings = rename_own(kind, what, options.name, options.new)
    return {"inputs": {**inputs, "new": options.new}, "name": options.new, "path": str(path), "warnings": warnings}


def render_own(result: dict[str, Any]) -> str | None:
    """One line an action; None for any other result."""
    action = result["inputs"].get("action")
    if action not in ACTIONS:
        return None
    if action == "remove":
        lines = [f"removed {path}" for path in result["removed"]]
    else:
        lines = [result["path"]]
    return "\n".join(lines + [f"warning: {one['message']}" for one in result.get("warnings", [])])
