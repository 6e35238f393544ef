"""Tables of preset and product files as arguments of the specification's classes; what is unknown is refused."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity, line_of


def known_keys(table: dict[str, Any], known: set[str], path: Path, text: str) -> None:
    """Refuse a key that nothing reads.

    Parameters
    ----------
    table : dict
        As read.
    known : set of str
        Keys that may stand in it.
    path, text : Path, str
        The file and its text, for the message.

    Raises
    ------
    InputError
        With its line and the keys that are known.
    """
    for key in table:
        if key not in known:
            raise InputError(
                f"{path.name}:{line_of(text, key)}: unknown key '{key}'; known are {', '.join(sorted(known))}"
            )


def number(value: Any, key: str, path: Path, text: str, *where: str) -> float:
    """A finite number.

    Parameters
    ----------
    value : object
        As read.
    key : str
        Its name.
    path, text : Path, str
        The file and its text, for the message.
    *where : str
        Table the key stands in.

    Returns
    -------
    float

    Raises
    ------
    InputError
        With file, line and value.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{path.name}:{line_of(text, *where, key)}: '{key}' = {value!r} is not a finite number")
    return float(value)


def read_table(kind: type, table: Any, path: Path, text: str, name: str, **given: Any) -> dict[str, Any]:
    """Read the numbers of one table into the arguments of a dataclass; those with a default may be left out.

    Parameters
    ----------
    kind : type
        The dataclass.
    table : dict
        The table as read.
    path : Path
        Its file, named in messages.
    text : str
        The file's text, for the line.
    name : str
        Of the table.
    **given
        Fields that are not read.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        For unknown or missing keys and what is not a number.
    """
    if not isinstance(table, dict):
        raise InputError(f"{path.name}:{line_of(text, name)}: '{name}' must be a table")
    wanted = [item for item in fields(kind) if item.name not in given]
    known_keys(table, {item.name for item in wanted}, path, text)
    missing = [item.name for item in wanted if item.default is MISSING and item.name not in table]
    if missing:
        raise InputError(f"{path.name}: table [{name}] lacks {', '.join(missing)}")
    read = {key: number(table[key], key, path, text, f"[{name}]") for key in table}
    return {**given, **read}


def named_source(name: str, quantity: Quantity) -> str:
    """One line: what, how much, how sure, from where."""
    return f"{name} = {quantity.value:g} ({quantity.low:g} to {quantity.high:g}, {quantity.kind}): {quantity.source}"
