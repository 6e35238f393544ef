"""Options that several commands have, and actions on files of the user."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Collection
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

ENTRY = re.compile(r"^(\w+)(?: : (?:(--[\w-]+) )?(.*?)( \.\.\.)?)?\n((?:    .*\n)+)", re.MULTILINE)
"""A parameter in a docstring: name, option where it is not the name, what is typed, ``...``, and its help."""
FOR_SCRIPTS = ("progress", "executor", "set_up", "design")
"""Arguments that only Python can give."""
READERS = {"float": "read_number", "int": "read_count"}


Call = str | Callable[..., Any]
"""What a command calls: a function, or ``module.function`` of :mod:`dummydesign.api`, loaded when it is needed."""


def loaded(call: Call) -> Callable[..., Any]:
    """The function that is meant."""
    if not isinstance(call, str):
        return call
    module, _, name = call.partition(".")
    function: Callable[..., Any] = getattr(import_module(f"dummydesign.api.{module}"), name)
    return function


def add_options(parser: argparse._ActionsContainer, call: Call, leave: Collection[str] = ()) -> None:
    """Declare the arguments of a call that are not declared yet by its signature and docstring, but for some.

    In the docstring stands after a name what is typed: ``MM``, or with the option ``--NAME MM`` where this is not the
    name without its unit, or where the argument is needed and yet an option; ``FILE ...`` may be several. The first
    paragraph below is the help.
    """
    from inspect import Parameter, getdoc, signature

    from dummydesign.core.parsing import flag_of, quantity_of

    function, declared = loaded(call), {action.dest for action in parser._actions}
    parameters = signature(function).parameters
    for name, flag, metavar, several, about in ENTRY.findall(f"{getdoc(function)}\n"):
        if name not in parameters or name in (*declared, *FOR_SCRIPTS, *leave):
            continue
        default, needed = parameters[name].default, parameters[name].default is Parameter.empty
        given: dict[str, Any] = {
            "metavar": metavar,
            "default": None if needed else default,
            "help": _help(about, default),
        }
        if reader := READERS.get(str(parameters[name].annotation).removesuffix(" | None")):
            given["type"] = partial(_read, reader, quantity_of(name))
        if needed and not flag:
            parser.add_argument(name, nargs="+" if several else None, **given)
            continue
        if isinstance(default, bool):
            given = {"action": "store_false" if default else "store_true", "help": given["help"]}
        elif several:
            given |= {"action": "append", "default": list(default)}
        typed = flag or flag_of(f"no_{name}" if default is True else name)
        parser.add_argument(typed, dest=name, required=needed, **given)


def _help(about: str, default: Any) -> str:
    """The first paragraph of a parameter's description, without marks, its unit and its full stop."""
    text = re.sub(r"``|\.?(?: \[[^\]]*\])?$", "", " ".join(about.split()))
    if "a shape of the package" in text:
        from dummydesign.geometry.shape_registry import shape_help

        text = text.replace("a shape of the package", shape_help(default))
    # names keep their capital: CSV, Young's
    text = re.sub(r"^[A-Z](?=[a-z-]*(?![\w']))", lambda first: first[0].lower(), text)
    return text.replace("%", "%%")


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


def call(function: Call, options: argparse.Namespace, **more: Any) -> Any:
    """Call a function of the Python interface with the options that have the names of its arguments."""
    from inspect import signature

    wanted = loaded(function)
    names = signature(wanted).parameters
    return wanted(**({name: value for name, value in vars(options).items() if name in names} | more))


def call_in_steps(about: int, function: Call, options: argparse.Namespace, **more: Any) -> Any:
    """Call a function as :func:`call` does and show its steps, usually ``about`` so many."""
    from dummydesign.cli.progress import steps_shown

    with steps_shown(about) as steps:
        return call(function, options, progress=steps, **more)


def named_by(command: str, argument: str) -> Callable[[argparse.Namespace], str]:
    """How the folder of an answer is named when none is typed: by an argument that is a name or a file."""
    return lambda options: f"{command}-{Path(getattr(options, argument)).stem}"


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
