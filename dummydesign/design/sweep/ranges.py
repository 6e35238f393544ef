"""Ranges and lists as they are typed: MIN:MAX, START:STOP:STEP (STOP included), or A,B,C."""

from __future__ import annotations

import math
from collections.abc import Iterable

from dummydesign.core.checks import UNITS, Purpose, read_number
from dummydesign.core.errors import InputError

MOST_VALUES = 1_000_000


def parse_limits(text: str | None, quantity: str) -> tuple[float, float] | None:
    """Read ``MIN:MAX`` (or one value for both); None stays None.

    Raises
    ------
    InputError
        When it is not of this form or MIN is above MAX.
    """
    if text is None:
        return None
    values = [_number(part, text, quantity, "MIN:MAX") for part in text.split(":")]
    if len(values) == 1:
        values *= 2
    if len(values) != 2 or values[0] > values[1]:
        raise InputError(f"{quantity} = '{text}' is not MIN:MAX with MIN at most MAX")
    return values[0], values[1]


def parse_values(text: str, quantity: str) -> list[float]:
    """Read ``START:STOP:STEP`` with STOP included, or a list ``A,B,C``; a quantity "in mm" takes ``5mm`` as well.

    Values of a range are START + n STEP, so that 3:30:0.5 ends at exactly 30.

    Raises
    ------
    InputError
        When it is not of this form, STEP does not lead to STOP, or there are more than 1,000,000 values.
    """
    form = "START:STOP:STEP or a list A,B,C"
    if ":" not in text:
        return [_number(part, text, quantity, form) for part in text.split(",")]
    parts = [_number(part, text, quantity, form) for part in text.split(":")]
    if len(parts) != 3 or not parts[2] > 0 or parts[1] < parts[0]:
        raise InputError(f"{quantity} = '{text}' is not {form} with START at most STOP and STEP above 0")
    start, stop, step = parts
    count = math.floor((stop - start) / step * (1 + 1e-12) + 1e-9) + 1
    if count > MOST_VALUES:
        raise InputError(f"{quantity} = '{text}' has {count} values; at most {MOST_VALUES} are allowed")
    digits = 12 - math.floor(math.log10(max(abs(start), abs(stop), step)))
    return [round(start + index * step, digits) for index in range(count)]


def _number(part: str, text: str, quantity: str, form: str) -> float:
    unit = quantity.rpartition(" in ")[2]
    try:
        value = read_number(part, Purpose(quantity, unit, (0.0, math.inf))) if unit in UNITS else float(part)
    except (InputError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{quantity} = '{text}' is not {form}: '{part}' is not a number")
    return value


def read_values(values: float | str | Iterable[float], quantity: str) -> tuple[float, ...]:
    """Read numbers however they are given: one, several, or text as on the command line.

    Raises
    ------
    InputError
        When there is none, or what is given is not numbers.
    """
    if isinstance(values, str):
        return tuple(parse_values(values, quantity))
    try:
        found = tuple(float(value) for value in (values if isinstance(values, Iterable) else (values,)))
    except (TypeError, ValueError):
        raise InputError(f"{quantity} = {values!r} is not a number, a list of numbers or text like 3:30:0.5") from None
    if not found:
        raise InputError(f"{quantity} has no value; give at least one")
    return found


def read_names(names: str | Iterable[str]) -> tuple[str, ...]:
    """Read names given as a list or with commas between."""
    return tuple(names.split(",")) if isinstance(names, str) else tuple(names)
