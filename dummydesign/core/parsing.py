"""Numbers, ranges and lists as they are typed, with units; checks of single numbers; columns in inches; options by the
names of the arguments of a Python call."""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any

from dummydesign.core.errors import InputError, out_of_range, quantity_name


def positive(quantity: str, value: float) -> None:
    """Refuse a number that is not finite and above zero."""
    if not (isinstance(value, int | float) or hasattr(value, "dtype")) or not math.isfinite(value) or value <= 0.0:
        raise InputError(
            f"{quantity} = {value} must be a finite number above 0", "out_of_range", quantity_name(quantity), value
        )


def one_of(quantity: str, name: str, known: Sequence[str]) -> None:
    """Refuse a name that is not among those that are known."""
    if name not in known:
        raise InputError(
            f"{quantity} = '{name}' is not one of {', '.join(known)}",
            "unknown_name",
            quantity_name(quantity),
            name,
            known,
        )


UNITS: dict[str, dict[str, float]] = {
    "mm": {"um": 1e-3, "µm": 1e-3, "mm": 1.0, "cm": 10.0, "in": 25.4, "m": 1000.0},
    "mm/s": {"mm/s": 1.0, "cm/s": 10.0, "in/s": 25.4, "m/s": 1000.0},
    "mm/s2": {"mm/s2": 1.0, "m/s2": 1000.0},
    "N": {"mN": 1e-3, "N": 1.0, "lbf": 4.4482216152605, "kN": 1000.0},
    "N/mm": {"N/m": 1e-3, "N/cm": 0.1, "N/mm": 1.0, "kN/m": 1.0},
    "kPa": {"Pa": 1e-3, "kPa": 1.0, "psi": 6.894757293168, "MPa": 1000.0},
    "s": {"ms": 1e-3, "s": 1.0, "min": 60.0},
    "g": {"mg": 1e-3, "g": 1.0, "kg": 1000.0},
    "Hz": {"Hz": 1.0, "kHz": 1000.0},
    "kg": {"g": 1e-3, "kg": 1.0, "t": 1000.0},
    "": {"%": 0.01},
    "1": {},
}
"""Units that are understood for each unit a number is wanted in, with their size in it; ``1`` is a number without."""
SEVERAL = re.compile(r"[,;]|\d\s+[\d.]")
"""What a single number has not."""
AS_TYPED = "; the decimal sign is a dot, commas separate numbers: 2.5,10"
NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*$", re.ASCII)


@dataclass(frozen=True)
class QuantitySpec:
    """What a number is for."""

    quantity: str
    unit: str
    usual: tuple[float, float]


FORCE = QuantitySpec("force in N", "N", (0.05, 1000.0))
VELOCITY = QuantitySpec("velocity in mm/s", "mm/s", (1.0, 5000.0))
HOLD = QuantitySpec("hold in s", "s", (0.05, 3600.0))
REST = QuantitySpec("rest in s", "s", (0.0, math.inf))
DECELERATION = QuantitySpec("deceleration in mm/s2", "mm/s2", (100.0, 1e7))
YOUNG = QuantitySpec("Young's modulus in kPa", "kPa", (0.5, 5000.0))
YOUNG_KPA = 0.01, 1e6
"""Smallest and largest modulus that is allowed. [kPa]"""
THICKNESS = QuantitySpec("thickness in mm", "mm", (0.3, 300.0))
DEPTH = QuantitySpec("depth in mm", "mm", (0.0, math.inf))
PAD_THICKNESS = QuantitySpec("thickness in mm", "mm", (0.0, math.inf))
LENGTH = QuantitySpec("length in mm", "mm", (0.0, math.inf))
WIDTH = QuantitySpec("width in mm", "mm", (0.0, math.inf))
RATE = QuantitySpec("rate in Hz", "Hz", (0.0, 1e6))
RATES_HZ = (1.0, 100_000.0)
DELAY = QuantitySpec("delay in s", "s", (-1e6, 1e6))
DELAYS_S = (-1.0, 1.0)
EDGE = QuantitySpec("edge radius in mm", "mm", (0.0, 50.0))


def spec_of(purpose: QuantitySpec | str) -> QuantitySpec:
    """The purpose itself, or that of a quantity of any size by its name: one "in mm" has that unit, another none."""
    if not isinstance(purpose, str):
        return purpose
    unit = purpose.rpartition(" in ")[2]
    return QuantitySpec(purpose, unit if unit in UNITS else "1", (0.0, math.inf))


def read_number(value: float | str, purpose: QuantitySpec | str) -> float:
    """Read a number: bare in the unit of its purpose, or text with a unit; see :func:`spec_of`.

    Examples
    --------
    >>> read_number("0.25m/s", VELOCITY), read_number("25kPa", YOUNG), read_number(10, VELOCITY)
    (250.0, 25.0, 10.0)
    """
    purpose = spec_of(purpose)
    known = UNITS[purpose.unit]
    match = NUMBER.match(value) if isinstance(value, str) else None
    try:
        number = float(value if match is None else match[1])
        unit = "" if match is None else match[2]
        # neither what only Python takes for a number (nan, 1_000) nor a unit where there is none
        if (unit and not known) or (isinstance(value, str) and (match is None or SEVERAL.search(value))):
            raise ValueError
    except (TypeError, ValueError):
        shown = (value.strip() or repr(value)) if isinstance(value, str) else repr(value)
        hint = f", or one with a unit such as 1{purpose.unit} or 1{list(known)[-1]}" if known else ""
        raise InputError(
            f"{purpose.quantity} = {shown} is not a number{AS_TYPED * bool(SEVERAL.search(shown))}{hint}",
            "not_a_number",
            quantity_name(purpose.quantity),
            value,
        ) from None
    if unit:
        if unit not in known:
            raise InputError(
                f"{purpose.quantity} = '{value}': unit '{unit}' is not one of {', '.join(known)}",
                "unknown_unit",
                quantity_name(purpose.quantity),
                value,
                list(known),
            )
        scaled = number * known[unit]
        return float(f"{scaled:.12g}") if math.isfinite(scaled) else scaled
    _likely(number, purpose)
    return number


def read_count(value: int | str, quantity: str) -> int:
    """Read a whole number."""
    try:
        return int(str(value))
    except ValueError:
        raise InputError(
            f"{quantity} = {value} is not a whole number", "not_a_number", quantity_name(quantity), value
        ) from None


def _likely(number: float, purpose: QuantitySpec) -> None:
    """Refuse a bare number that another unit explains."""
    low, high = purpose.usual
    if not (math.isfinite(number) and number > 0.0) or low <= number <= high:
        return
    for unit, size in sorted(UNITS[purpose.unit].items(), key=lambda item: abs(math.log(item[1]))):
        meant = number * size
        if abs(math.log10(size)) >= 3.0 and low <= meant <= high:
            raise InputError(
                f"{purpose.quantity} = {number:g} looks like {unit}: give {meant:g}, or {number:g}{purpose.unit} if "
                "that is what you mean",
                "implausible_unit",
                quantity_name(purpose.quantity),
                number,
            )


def read_numbers(values: float | str | Iterable[float | str], purpose: QuantitySpec | str) -> tuple[float, ...]:
    """Read numbers however they are given, each as :func:`read_number` does: one, several, or text.

    Text is a list ``A,B,C``, or ``START:STOP:STEP`` with STOP included. Values of a range are START + n STEP, so that
    3:30:0.5 ends at exactly 30.

    Examples
    --------
    >>> read_numbers("5,0.1", "ratio"), read_numbers("3:4:0.5", THICKNESS)
    ((5.0, 0.1), (3.0, 3.5, 4.0))
    """
    purpose = spec_of(purpose)
    if isinstance(values, str) and ":" in values:
        return _range(values, purpose)
    numbers = tuple(read_number(part, purpose) for part in parts_of(values))
    if not numbers:
        raise InputError(
            f"{purpose.quantity} has no value; give at least one", "missing", quantity_name(purpose.quantity)
        )
    return numbers


def _range(text: str, purpose: QuantitySpec) -> tuple[float, ...]:
    """Values of ``START:STOP:STEP``."""
    # a step, the third, may be smaller than any value
    anything, quantity = replace(purpose, usual=(0.0, math.inf)), purpose.quantity
    parts = [read_number(part, anything if at == 2 else purpose) for at, part in enumerate(text.split(":"))]
    if len(parts) != 3 or not all(map(math.isfinite, parts)) or not parts[2] > 0 or parts[1] < parts[0]:
        form = "START:STOP:STEP or a list A,B,C"
        raise InputError(
            f"{quantity} = '{text}' is not {form} with START at most STOP and STEP above 0",
            "malformed",
            quantity_name(quantity),
            text,
        )
    start, stop, step = parts
    count = math.floor((stop - start) / step * (1 + 1e-12) + 1e-9) + 1
    if count > MOST_VALUES:
        raise InputError(
            f"{quantity} = '{text}' has {count} values; at most {MOST_VALUES} are allowed",
            "too_large",
            quantity_name(quantity),
            count,
            MOST_VALUES,
        )
    digits = 12 - math.floor(math.log10(max(abs(start), abs(stop), step)))
    return tuple(round(start + index * step, digits) for index in range(count))


def parts_of(values: float | str | Iterable[float | str]) -> list[float | str]:
    """Split several numbers: text at its commas, a list into its members; one number is alone."""
    if isinstance(values, str):
        return list(values.split(","))
    try:
        return list(values) if isinstance(values, Iterable) else [values]
    except TypeError:  # an array without dimensions
        return [float(values)]  # type: ignore[arg-type]


def read_allowed(value: float | str, purpose: QuantitySpec, low: float, high: float) -> float:
    """Read a number as :func:`read_number` does and refuse it outside a range."""
    number = read_number(value, purpose)
    if not low <= number <= high:
        raise out_of_range(purpose.quantity, f"{number:g}", *(f"{end:.10g}" for end in (low, high)))
    return number


def read_size(value: str | tuple[float, float], quantity: str) -> tuple[float, float]:
    """Read ``LxW`` in mm, or two numbers."""
    parts = value.removeprefix("slab:").split("x") if isinstance(value, str) else list(value)
    try:
        length, width = (read_number(part, f"{quantity} in mm") for part in parts)
    except (InputError, ValueError):
        raise InputError(
            f"{quantity} = '{value}' is not LENGTHxWIDTH in mm, such as 150x120",
            "malformed",
            quantity_name(quantity),
            value,
        ) from None
    return length, width


MOST_VALUES = 1_000_000


def parse_limits(text: str | tuple[float, float], quantity: str) -> tuple[float, float]:
    """Read ``MIN:MAX`` (or one value for both), or two numbers."""
    if not isinstance(text, str):
        return float(text[0]), float(text[1])
    values = [read_number(part, quantity) for part in text.split(":")]
    if len(values) == 1:
        values *= 2
    if len(values) != 2 or not all(map(math.isfinite, values)) or values[0] > values[1]:
        raise InputError(
            f"{quantity} = '{text}' is not MIN:MAX with MIN at most MAX", "malformed", quantity_name(quantity), text
        )
    return values[0], values[1]


def read_names(names: str | Iterable[str]) -> tuple[str, ...]:
    """Read names given as a list or with commas between."""
    return tuple(names.split(",")) if isinstance(names, str) else tuple(names)


SYSTEMS = ("mm", "in")
"""Units of tables and sheets: millimetre and newton, or inch and pound-force."""
TWINS = {
    "_mm_s": ("_in_s", UNITS["mm/s"]["in/s"]),
    "_mm": ("_in", UNITS["mm"]["in"]),
    "_N": ("_lbf", UNITS["N"]["lbf"]),
}
"""Ending of a name, that of its twin, and the size of the twin's unit in the name's."""


def twin_of(name: str, units: str = "in") -> tuple[str, float]:
    """Name of a column in a system of units, and the size of its unit in that of the package.

    Examples
    --------
    >>> twin_of("displacement_mm"), twin_of("time_s"), twin_of("force_N", "mm")
    (('displacement_in', 25.4), ('time_s', 1.0), ('force_N', 1.0))
    """
    for ending, (other, size) in TWINS.items() if units == "in" else ():
        if name.endswith(ending):
            return name.removesuffix(ending) + other, size
    return name, 1.0


def columns_in(names: tuple[str, ...], header: list[str]) -> tuple[list[int | None], list[float]]:
    """Place of each name in a header (None where it is absent), itself before its twin in inches, and its size."""
    places: list[int | None] = []
    sizes = []
    for name in names:
        twin, size = (name, 1.0) if name in header else twin_of(name)
        places.append(header.index(twin) if twin in header else None)
        sizes.append(size)
    return places, sizes


ENDINGS = {
    "mm": "mm",
    "mm_s": "mm/s",
    "mm_s2": "mm/s2",
    "N": "N",
    "kPa": "kPa",
    "s": "s",
    "g": "g",
    "Hz": "Hz",
    "deg": "",
}
"""Units by the endings of names; an angle has none that can be typed."""
ENDING = re.compile(f"_({'|'.join(ENDINGS)})$")
BETWEEN = {"thickness_mm": ":", "ratio": ":", "pad_mm": "x", "sites": "x"}
"""What parts the two numbers of a range or size; other numbers are a list."""


def flag_of(name: str) -> str:
    """The option of an argument: its name without the unit.

    Examples
    --------
    >>> flag_of("velocity_mm_s"), flag_of("edge_radius_mm"), flag_of("punch")
    ('--velocity', '--edge-radius', '--punch')
    """
    return "--" + ENDING.sub("", name).replace("_", "-")


def quantity_of(name: str) -> str:
    """The quantity that an argument is, with its unit.

    Examples
    --------
    >>> quantity_of("modulus_error_kPa"), quantity_of("level_deg"), quantity_of("base_ratio")
    ('modulus error in kPa', 'level', 'base ratio')
    """
    ending = ENDING.search(name)
    unit = "" if ending is None else ENDINGS[ending[1]]
    return ENDING.sub("", name).replace("_", " ") + (unit and f" in {unit}")


def command_words(call: Callable[..., Any], values: Mapping[str, Any], names: Iterable[str]) -> str:
    """Return the options that differ from their defaults as they are typed, each after a blank."""
    known, words = signature(call).parameters, ""
    for name in names:
        value = tuple(values[name]) if isinstance(values[name], list) else values[name]
        if value is None or value == known[name].default:
            continue
        if isinstance(value, tuple):
            value = BETWEEN.get(name, ",").join(f"{number:g}" for number in value)
        words += f" {flag_of(name)} " + (f"{value:g}" if isinstance(value, float) else shlex.quote(str(value)))
    return words
