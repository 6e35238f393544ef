"""Options that several commands have, and actions on files of the user."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from typing import Any


def option_of(argument: str) -> str:
    """Return the option that gives an argument of the Python interface: its name without the unit."""
    return re.sub(r"_(mm|mm_s|mm_s2|N|s|g|kg|kPa|deg|Hz)$", "", argument)


def call(function: Callable[..., Any], options: argparse.Namespace, **more: Any) -> Any:
    """Call a function of the Python interface with the options of its arguments, see :func:`option_of`."""
    from inspect import signature

    names = {option_of(name): name for name in signature(function).parameters}
    return function(**({names[key]: value for key, value in vars(options).items() if key in names} | more))


def call_in_steps(about: int, function: Callable[..., Any], options: argparse.Namespace, **more: Any) -> Any:
    """Call a function as :func:`call` does and show its steps, usually ``about`` so many."""
    from dummydesign.cli.progress import steps_shown

    with steps_shown(about) as steps:
        return call(function, options, progress=steps, **more)


def add_effect_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--effect``, which may be given several times."""
    words = "file with one effect class of your own; its code is run; may be repeated"
    parser.add_argument("--effect", dest="effects", metavar="FILE.py", action="append", default=[], help=words)


def add_replace_option(parser: argparse.ArgumentParser) -> None:
    """Declare ``--replace``."""
    words = "overwrite an earlier answer in --out (default: keep it and number the new folder)"
    parser.add_argument("--replace", action="store_true", help=words)


ACTIONS = ("remove", "rename", "path")


def add_own_actions(actions: Any, what: str) -> None:
    """Declare the actions on a file of your own."""
    remove = actions.add_parser("remove", help=f"delete a {what} of your own")
    remove.add_argument("name", metavar="NAME", help="as the list has it")
    rename = actions.add_parser("rename", help=f"give a {what} of your own another name")
    rename.add_argument("name", metavar="OLD", help="its name now")
    rename.add_argument("new", metavar="NEW", help="its name from now on")
    path = actions.add_parser("path", help=f"file of a {what}")
    path.add_argument("name", metavar="NAME", help="as the list has it")


def run_own(options: argparse.Namespace, kind: str, what: str) -> dict[str, Any]:
    """Do the action and return plain values."""
    from dummydesign.core.user_library import find, remove_own, rename_own

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
    lines = [f"removed {path}" for path in result["removed"]] if action == "remove" else [result["path"]]
    return "\n".join(lines + [f"warning: {one['message']}" for one in result.get("warnings", [])])
