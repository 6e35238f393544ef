"""A table of options: each field of a frozen dataclass says how it is typed, read and typed again."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Option:
    """How a field is typed and read; ``argument`` is its name in the Python call, ``between`` parts several numbers."""

    flag: str
    metavar: str
    help: str | Callable[[], str]
    read: Callable[[Any], Any] | None = None
    argument: str = ""
    between: str = ","


def option(default: Any, flag: str, metavar: str, help: str | Callable[[], str], **more: Any) -> Any:
    """Declare a field of a table; MISSING is the default of an option that must be given."""
    return field(default=default, metadata={"option": Option(flag, metavar, help, **more)})


def options_of(table: type) -> dict[str, tuple[Any, Option]]:
    """Return default and option of each field that has one."""
    return {one.name: (one.default, one.metadata["option"]) for one in fields(table) if "option" in one.metadata}


def read_options(table: type[T], given: Mapping[str, Any]) -> T:
    """Read what was given, texts or values by the names of the arguments, into a table; what is not given is default.

    A field without an option is taken as it is.
    """
    options, values = options_of(table), dict[str, Any]()
    for one in fields(table):  # type: ignore[arg-type]
        spec = options[one.name][1] if one.name in options else None
        name = (spec and spec.argument) or one.name
        if name in given:
            read = None if spec is None or given[name] is None else spec.read
            values[one.name] = given[name] if read is None else read(given[name])
    return table(**values)


def command_words(table: type, values: Mapping[str, Any], names: Iterable[str]) -> str:
    """Return the options that differ from their defaults as they are typed, each after a blank."""
    known, words = options_of(table), ""
    for name in names:
        default, spec = known[name]
        value = tuple(values[name]) if isinstance(values[name], list) else values[name]
        if value is None or value == default:
            continue
        if isinstance(value, tuple):
            value = spec.between.join(f"{number:g}" for number in value)
        words += f" --{spec.flag} " + (f"{value:g}" if isinstance(value, float) else shlex.quote(str(value)))
    return words
