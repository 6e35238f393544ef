"""Shipped tables: JSON files in ``materials/tables``, read in one way and refused with one error."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from dummydesign.core.datafiles import data_folder
from dummydesign.core.errors import NoAnswerError

Table = TypeVar("Table")


def table_path(name: str) -> Path:
    """Where a shipped table lies."""
    return data_folder() / "materials" / "tables" / name


def read(name: str, what: str, rebuild: str, parse: Callable[[dict[str, Any]], Table]) -> Table:
    """Read a shipped table.

    Parameters
    ----------
    name : str
        Of the file.
    what : str
        What the file holds, for the message.
    rebuild : str
        Command that makes it anew.
    parse : callable
        Makes the table from the content; a ``ValueError`` of its own says in words what is wrong.

    Raises
    ------
    NoAnswerError
        ``table_unavailable`` when the file is missing or damaged, with the command that rebuilds it.
    """
    try:
        return parse(json.loads(table_path(name).read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError) as problem:
        reason = str(problem) if type(problem) is ValueError else type(problem).__name__
        message = f"{what} {name} cannot be read ({reason}); rebuild it with: {rebuild}"
        raise NoAnswerError("table_unavailable", message) from None
