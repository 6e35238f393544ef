"""One table of options: the fields of a dataclass, with how each is typed, explained and read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from argparse import _ActionsContainer

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
    """Return default and option of each field."""
    return {one.name: (one.default, one.metadata["option"]) for one in fields(table)}


def add_options(parser: _ActionsContainer, table: type, names: Iterable[str]) -> None:
    """Declare some options of a table, in this order."""
    known = options_of(table)
    for name in names:
        default, spec = known[name]
        given: dict[str, Any] = {"metavar": spec.metavar, "default": default}
        if default is MISSING:
            given = {"metavar": spec.metavar, "required": True}
        elif isinstance(default, bool):
            given = {"dest": name, "action": "store_false" if default else "store_true"}
        parser.add_argument(f"--{spec.flag}", help=spec.help if isinstance(spec.help, str) else spec.help(), **given)


def read_options(table: type[T], given: Mapping[str, Any]) -> T:
    """Read the arguments of a Python call, texts or values, into a table."""
    values = {name: (spec, given[spec.argument or name]) for name, (_, spec) in options_of(table).items()}
    return table(**{name: value if spec.read is None or value is None else spec.read(value)
                    for name, (spec, value) in values.items()})  # fmt: skip


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
        words += f" --{spec.flag} {value:g}" if isinstance(value, float) else f" --{spec.flag} {value}"
    return words
