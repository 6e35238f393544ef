"""Names and units above a table, whether one row holds both or each has its own."""

from __future__ import annotations

from collections.abc import Sequence

from dummydesign.measurement.importing.core.units import find_unit, split_name
from dummydesign.measurement.importing.core.vocabulary import roles_of_name
from dummydesign.measurement.importing.text.cells import COMMENTS, SEPARATORS, split
from dummydesign.measurement.importing.text.numbers import is_number

HEADER_LINES = 8
"""Lines above the table that may be its header."""
_LONGEST = 80


def find_header(
    lines: Sequence[str], first: int, separator: str, kinds: Sequence[str]
) -> tuple[tuple[str, ...], tuple[str, ...], list[int]]:
    """Names and units above the table, and the indices of the lines they stand in.

    Parameters
    ----------
    lines : sequence of str
        All lines of the text.
    first : int
        Index of the first line of numbers.
    separator : str
        What parts the cells.
    kinds : sequence of str
        What each column holds: ``number``, ``stamp``, ``text``, ``empty``.

    Returns
    -------
    names, units : tuple of str
        A cell a column, empty where there is none.
    lines : list of int
        Indices of the lines they stand in.
    """
    width = len(kinds)
    rows: list[tuple[int, list[str]]] = []
    for index in range(first - 1, max(first - 1 - 3 * HEADER_LINES, -1), -1):
        cells = _header_cells(lines[index], separator, width)
        if cells is not None and len(rows) < HEADER_LINES:
            rows.append((index, cells))
    empty = ("",) * width
    unit_rows = [(sum(find_unit(cell) is not None for cell in cells), index, cells) for index, cells in rows]
    unit_rows = [row for row in unit_rows if row[0] >= 2 and row[0] >= 0.6 * sum(bool(cell) for cell in row[2])]
    units = max(unit_rows, key=lambda row: (row[0], row[1]), default=None)
    named = [
        (
            sum(bool(roles_of_name(split_name(cell)[0])) or split_name(cell)[1] is not None for cell in cells),
            index,
            cells,
        )
        for index, cells in rows
        if units is None or index != units[1]
    ]
    names = max((row for row in named if row[0]), key=lambda row: (row[0], row[1]), default=None)
    if names is None and named and not any(is_number(cell) for cell in named[0][2]):
        names = named[0]
    where = [row[1] for row in (names, units) if row is not None]
    return (
        tuple(names[2]) if names else empty,
        tuple(units[2]) if units else empty,
        where,
    )


def _header_cells(line: str, separator: str, width: int) -> list[str] | None:
    """Part a line above the table into as many cells as the table has; None where that cannot be."""
    text = line.strip()
    for mark in COMMENTS:
        text = text.removeprefix(mark) if text.startswith(mark) else text
    if not text.strip():
        return None
    ways = [split(line if text == line.strip() else text, separator)]
    if separator == " ":
        ways = [
            [part.strip() for part in text.replace("\t", "  ").split("  ") if part.strip()],
            *ways,
        ]
    ways += [split(text, other) for other in SEPARATORS if other not in (separator, " ") and other in text]
    for cells in ways:
        while len(cells) > width and not cells[-1]:
            cells = cells[:-1]
        if width - 1 <= len(cells) < width and len(cells) >= 2 and separator != " ":
            cells = [*cells, *[""] * (width - len(cells))]
        if len(cells) == width:
            return [cell.strip('"').strip()[:_LONGEST] for cell in cells]
    return None
