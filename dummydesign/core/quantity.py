"""A number from outside with its interval, kind and source; no number enters without them."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError

KINDS = ("measured", "fitted", "digitised", "inferred", "assumed")
_FIELDS = {"value", "low", "high", "kind", "source"}


@dataclass(frozen=True)
class Quantity:
    """A value with the interval it lies in, what kind of number it is and where it was read.

    ``low`` and ``high`` bound a 95 % interval for measured, fitted and inferred numbers and a
    plausible range for assumed ones. The unit is part of the name under which the number is kept.
    """

    value: float
    low: float
    high: float
    kind: str
    source: str

    def to_dict(self) -> dict[str, Any]:
        """Return the five fields as a plain dictionary."""
        return asdict(self)


def line_of(text: str, *keys: str) -> int:
    """Find the line (from 1) at which the last of ``keys`` stands, each searched after the one before."""
    lines = text.splitlines()
    row = 0
    for key in keys:
        for index in range(row, len(lines)):
            if key in lines[index]:
                row = index
                break
    return row + 1


def read_quantity(
    table: dict[str, Any], key: str, path: Path, text: str = "", kinds: tuple[str, ...] = KINDS
) -> Quantity:
    """Read ``table[key]`` as a :class:`Quantity`, refusing what has no interval, kind or source.

    Parameters
    ----------
    table : dict
        The table of a TOML file that holds the entry.
    key : str
        Name of the entry, with the unit as suffix.
    path : Path
        The file, named in messages.
    text : str
        Its text, from which the line in a message is taken; without it messages have no line.
    kinds : tuple of str
        Kinds of number that are allowed.

    Raises
    ------
    InputError
        With file and line when the entry is missing, has unknown keys, or low <= value <= high fails.
    """
    where = f"{path.name}:{line_of(text, key)}: " if text else f"{path.name}: "
    if key not in table:
        raise InputError(f"{path.name}: '{key}' is missing; it needs value, low, high, kind and source")
    entry = table[key]
    if not isinstance(entry, dict):
        raise InputError(f"{where}'{key}' = {entry!r} is a bare number; give value, low, high, kind and source")
    unknown = sorted(set(entry) - _FIELDS)
    missing = sorted(_FIELDS - set(entry))
    if unknown:
        raise InputError(f"{where}'{key}' has unknown key '{unknown[0]}'; known are {', '.join(sorted(_FIELDS))}")
    if missing:
        raise InputError(f"{where}'{key}' lacks {', '.join(missing)}")
    if entry["kind"] not in kinds:
        raise InputError(f"{where}'{key}' has kind '{entry['kind']}'; known kinds are {', '.join(kinds)}")
    if not str(entry["source"]).strip():
        raise InputError(f"{where}'{key}' has an empty source; say where the number was read")
    try:
        value, low, high = (float(entry[name]) for name in ("value", "low", "high"))
    except (TypeError, ValueError):
        raise InputError(f"{where}'{key}' needs numbers for value, low and high") from None
    if not all(math.isfinite(number) for number in (value, low, high)) or not low <= value <= high:
        raise InputError(f"{where}'{key}' needs finite low <= value <= high, given {low}, {value}, {high}")
    return Quantity(value, low, high, str(entry["kind"]), str(entry["source"]))
