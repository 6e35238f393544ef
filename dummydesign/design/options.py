"""The options of ``suggest``: command, Python call and inputs of the answer are made from this table."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from dummydesign.core import parsing
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import parse_limits, read_count, read_number, read_numbers, read_size
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH

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
    return table(
        **{
            name: value if spec.read is None or value is None else spec.read(value)
            for name, (spec, value) in values.items()
        }
    )


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


LARGEST_ERROR = 2.0
"""Largest error of weighing [g] and of the thickness [mm]."""


def _read_error(given: float | str, purpose: parsing.QuantitySpec) -> float:
    number = read_number(given, purpose)
    if not 0.0 <= number <= LARGEST_ERROR:
        raise out_of_range(purpose.quantity, number, 0, LARGEST_ERROR)
    return number


def read_sites(text: str | tuple[int, int]) -> tuple[int, int]:
    """Read ``NxM``, crowns along the length times across the width."""
    from dummydesign.geometry.shapes.crowned import MOST_SITES

    parts = text.lower().split("x") if isinstance(text, str) else [str(value) for value in text]
    if len(parts) != 2 or not all(part.strip().isdigit() and 1 <= int(part) <= MOST_SITES for part in parts):
        shown = text if isinstance(text, str) else "x".join(parts)
        message = f"sites = {shown} is not NxM with 1 to {MOST_SITES} crowns each way, such as 4x3"
        raise InputError(message, "malformed", "sites", shown)
    return int(parts[0]), int(parts[1])


def base_words(base: str) -> str:
    """Return in words how a pad lies on its base."""
    return {"bonded": "glued to a rigid base", "sliding": "sliding on a rigid base"}.get(base, f"resting, {base}")


def _shape_help() -> str:
    from dummydesign.geometry.shape_registry import shape_help

    return shape_help("auto", default="auto") + "; lengths not given are searched"


@dataclass(frozen=True)
class SuggestOptions:
    """What ``suggest`` is asked, in the order of the answer's inputs: default, option, metavar, help, reader."""

    tissue: str = option(MISSING, "tissue", "NAME|FILE", "see 'dummydesign tissues list'")
    aim: str = option("average", "aim", "AIM", "average (default), safe-side, subject:NAME or people:PERCENT")
    resin: str = option("polyurethane-nagoya", "resin", "NAME|FILE", "see 'dummydesign resins list'")
    thickness_mm: tuple[float, float] | None = option(
        None,
        "thickness",
        "MIN:MAX",
        "search range in mm, in 3 to 30",
        read=partial(parse_limits, quantity="thickness in mm"),
        between=":",
    )
    ratio: tuple[float, float] | None = option(
        None,
        "ratio",
        "MIN:MAX",
        "search range of the mixing ratio, within the resin's range",
        read=partial(parse_limits, quantity="ratio"),
        between=":",
    )
    shape: str = option("auto", "shape", "NAME[:P,..]", _shape_help)
    mould: str | None = option(
        None,
        "mould",
        "DIR|FILE",
        "keep shape and thickness of a mould that was made; choose the ratio for the resin at hand",
        read=str,
    )
    verify: bool = option(True, "no-verify", "", "do not check the design by finite elements")
    hold_s: float = option(
        10.0, "hold", "S", "hold after the stop (default 10 s)", read=partial(read_number, purpose=parsing.HOLD)
    )
    deceleration_mm_s2: float = option(
        30_000.0,
        "deceleration",
        "MM_S2",
        "braking (default 30000 mm/s2)",
        read=partial(read_number, purpose=parsing.DECELERATION),
    )
    weighing_g: float = option(
        0.1,
        "balance",
        "G",
        "weighing error, plus or minus (default 0.1 g)",
        read=partial(_read_error, purpose=parsing.BALANCE),
        argument="balance_g",
    )
    thickness_tolerance_mm: float = option(
        0.2,
        "thickness-tolerance",
        "MM",
        "error of the cast thickness, plus or minus (default 0.2 mm)",
        read=partial(_read_error, purpose=parsing.TOLERANCE),
    )
    calibration: str | None = option(
        None, "calibration", "FILE", "file written by 'dummydesign loop'; none: ignore the project's", read=str
    )
    punch: str = option(
        PUNCH, "punch", "KIND:SIZE", "square:14 (default), rectangle:AxB, round:D, ball:D, profile:FILE.csv"
    )
    force_N: tuple[float, ...] = option(
        (5.0, 10.0, 15.0),
        "force",
        "F1,F2,...",
        "steady forces (default 5,10,15 N)",
        read=partial(read_numbers, purpose=parsing.FORCE),
    )
    velocity_mm_s: tuple[float, ...] = option(
        (10.0, 250.0),
        "velocity",
        "V1,V2,...",
        "speeds (default 10,250 mm/s)",
        read=partial(read_numbers, purpose=parsing.VELOCITY),
    )
    pad_mm: tuple[float, float] = option(
        (PAD_LENGTH_MM, PAD_WIDTH_MM),
        "pad",
        "LxW",
        "length and width of the pad (default 150x120 mm)",
        read=partial(read_size, quantity="pad"),
        argument="pad",
        between="x",
    )
    base: str = option("bonded", "base", "NAME", "bonded (default), sliding or friction:MU")
    edge_radius_mm: float = option(
        0.0,
        "edge-radius",
        "MM",
        "fillet of the punch's edge (default 0, sharp)",
        read=partial(read_number, purpose=parsing.EDGE),
    )
    condition: str | None = option(
        None, "condition", "NAME", "bonded (default; under a ball or a profile frictionless), frictionless, friction:MU"
    )
    preset: str = option("open", "preset", "NAME|FILE", "mould preset: open (default), lidded, printed or a TOML file")
    machine: str | None = option(None, "machine", "NAME|FILE", "printer, vacuum chamber and oven the mould must fit")
    silicone: str | None = option(None, "silicone", "NAME|FILE", "silicone of the mould")
    sites: tuple[int, int] | None = option(
        None,
        "sites",
        "NxM",
        "crowns along and across one pad, such as 4x3, far enough apart to be independent",
        read=read_sites,
        between="x",
    )
    castings: int = option(
        1200,
        "castings",
        "N",
        "number of simulated castings (default and minimum 1200)",
        read=partial(read_count, quantity="castings"),
    )
