"""Options that several commands have, and actions on files of the user."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any


def add_options(parser: argparse._ActionsContainer, table: type, names: Iterable[str]) -> None:
    """Declare some options of a table, in this order."""
    from dataclasses import MISSING

    from dummydesign.core.parsing import options_of

    known = options_of(table)
    for name in names:
        default, spec = known[name]
        given: dict[str, Any] = {"metavar": spec.metavar, "default": default}
        if default is MISSING:
            given = {"metavar": spec.metavar, "required": True}
        elif isinstance(default, bool):
            given = {"action": "store_false" if default else "store_true"}
        words = spec.help if isinstance(spec.help, str) else spec.help()
        parser.add_argument(f"--{spec.flag}", dest=spec.argument or name, help=words, **given)


def number(quantity: str) -> Callable[[str], float]:
    """How argparse reads a number of a quantity, "mass in g" with its unit: by :func:`read_number`."""
    return partial(_read, "read_number", quantity)


def count(quantity: str) -> Callable[[str], int]:
    """How argparse reads a whole number."""
    return partial(_read, "read_count", quantity)


def _read(reader: str, quantity: str, text: str) -> Any:
    from dummydesign.core import parsing

    return getattr(parsing, reader)(text, quantity)


def name_of(action: argparse.Action) -> str:
    """Name of an option as it is typed, with underscores; of an argument its own."""
    flags = [flag for flag in action.option_strings if flag.startswith("--")]
    return flags[-1][2:].replace("-", "_") if flags else action.dest


def call(function: Callable[..., Any], options: argparse.Namespace, **more: Any) -> Any:
    """Call a function of the Python interface with the options that have the names of its arguments."""
    from inspect import signature

    names = signature(function).parameters
    return function(**({name: value for name, value in vars(options).items() if name in names} | more))


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
