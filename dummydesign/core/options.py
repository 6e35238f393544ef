"""Options of a command by the names of the arguments of its Python call."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterable, Mapping
from inspect import signature
from typing import Any

UNITS = {
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
ENDING = re.compile(f"_({'|'.join(UNITS)})$")
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
    unit = "" if ending is None else UNITS[ending[1]]
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
