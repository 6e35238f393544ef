"""The numbers of a table: fast where every line is alike, line by line where one is not, and then with its number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes
from dummydesign.measurement.importing.text.cells import is_comment
from dummydesign.measurement.importing.text.clock import elapsed_seconds, is_date
from dummydesign.measurement.importing.text.layout import Layout
from dummydesign.measurement.importing.text.numbers import is_missing, parse, seconds_of_stamp

MOST_INTERRUPTIONS = 500


@dataclass(frozen=True)
class Body:
    """Numbers of the wanted columns.

    Attributes
    ----------
    values : ndarray, shape (rows, columns)
        As written, in the units of the file; stamps in seconds since midnight of the first day.
    lines : ndarray of int, shape (rows,)
        Line of the file that each row stands in.
    breaks : tuple of int
        Rows before which the table was interrupted by a line of text.
    """

    values: NDArray
    lines: NDArray
    breaks: tuple[int, ...]


def read_body(layout: Layout, columns: Sequence[int], notes: Notes) -> Body:
    """Read the numbers of some columns.

    Parameters
    ----------
    layout : Layout
        Where the table stands.
    columns : sequence of int
        Indices of the columns to read.
    notes : Notes
        Receives what was left out.

    Returns
    -------
    Body

    Raises
    ------
    InputError
        With file and line, for a cell that is no number or is missing, and for a row of another length.
    """
    body = _fast(layout, columns)
    return body if body is not None else _slow(layout, columns, notes)


def _fast(layout: Layout, columns: Sequence[int]) -> Body | None:
    """All lines in one go; None unless every one of them has the same form."""
    lines, separator = layout.lines[layout.first : layout.last], layout.separator
    if layout.thousands or any(layout.kinds[column] != "number" for column in columns):
        return None
    if layout.decimal == "," and separator == ",":
        return None
    if separator == " ":
        if {len(line.split()) for line in lines} != {len(layout.kinds)}:
            return None
    elif {line.count(separator) for line in lines} != {lines[0].count(separator)}:
        return None
    if layout.decimal == ",":
        whole = "\n".join(lines)
        if "." in whole:
            return None  # a dot is a thousands sign here
        lines = whole.replace(",", ".").split("\n")
    try:
        values = np.loadtxt(
            lines,
            delimiter=None if separator == " " else separator,
            comments=None,
            quotechar='"',
            usecols=list(columns),
            ndmin=2,
        )
    except (ValueError, IndexError):
        return None
    if len(values) != len(lines) or not np.isfinite(values).all():
        return None
    start = layout.line(layout.first)
    return Body(values, np.arange(start, start + len(values)), ())


def _slow(layout: Layout, columns: Sequence[int], notes: Notes) -> Body:
    """Line by line, with the faults named; lines of text between the numbers part the table."""
    width, date_at, dates = len(layout.kinds), _date_column(layout), list[str]()
    rows: list[list[Any]] = []
    numbers: list[int] = []
    breaks: list[int] = []
    between: list[int] = []
    for index in range(layout.first, layout.last):
        line = layout.lines[index]
        if not line.strip() or is_comment(line):
            continue
        cells = layout.cells(line)
        if len(cells) != width:
            while len(cells) > width and not cells[-1]:
                cells = cells[:-1]
        wanted = [cells[column] if column < len(cells) else "" for column in columns]
        read = [_read(cell, layout.kinds[column], layout.decimal) for cell, column in zip(wanted, columns)]
        good = [number is not None for number in read]
        if not any(good):
            # A line of text, of units or a header again: what follows may be another test.
            if any(cells):
                between.append(index)
                if rows and (not breaks or breaks[-1] != len(rows)):
                    breaks.append(len(rows))
            continue
        if len(cells) != width or not all(good):
            raise _fault(layout, index, cells, columns, wanted, good)
        rows.append(read)
        dates.append("" if date_at is None or not is_date(cells[date_at]) else cells[date_at])
        numbers.append(layout.line(index))
    if len(between) > MOST_INTERRUPTIONS:
        raise InputError(
            f"{layout.file}:{layout.line(between[0])}: {len(between)} lines between the rows are not numbers, such as "
            f"'{layout.lines[between[0]].strip()[:40]}'; export the table without text between its rows"
        )
    if between:
        notes.decide(
            "lines between",
            f"{len(between)} lines",
            f"text between the rows, left out; the first is line {layout.line(between[0])}: "
            f"'{layout.lines[between[0]].strip()[:40]}'",
        )
    # the same date in every row is that of the test, not of the row
    dates = dates if len(set(dates)) > 1 else [""] * len(rows)
    for place, column in enumerate(columns):
        if rows and layout.kinds[column] == "stamp":
            stamps = [(one[place][0], one[place][1] or date) for one, date in zip(rows, dates)]
            for kept, seconds in zip(rows, elapsed_seconds(layout.file, stamps, notes)):
                kept[place] = seconds
    values = np.array(rows, float).reshape(-1, len(columns))
    if not np.isfinite(values).all():
        row = int(np.nonzero(~np.isfinite(values).all(axis=1))[0][0])
        raise InputError(f"{layout.file}:{numbers[row]}: a number is too large to be read")
    return Body(values, np.array(numbers, int), tuple(at for at in breaks if at < len(rows)))


def _date_column(layout: Layout) -> int | None:
    """Column of dates beside a column of clock times."""
    first = zip(layout.cells(layout.lines[layout.first]), layout.kinds)
    return next((at for at, (cell, kind) in enumerate(first) if kind == "text" and is_date(cell)), None)


def _read(cell: str, kind: str, decimal: str) -> float | tuple[float, str] | None:
    """A number, or the clock and the date of a stamp; None where the cell is neither."""
    if kind != "stamp":
        return parse(cell, decimal)
    try:
        return seconds_of_stamp(cell)
    except ValueError:
        return None


def _fault(
    layout: Layout,
    index: int,
    cells: Sequence[str],
    columns: Sequence[int],
    wanted: Sequence[str],
    good: Sequence[bool],
) -> InputError:
    where = f"{layout.file}:{layout.line(index)}"
    if len(cells) != len(layout.kinds):
        return InputError(
            f"{where}: has {len(cells)} cells, the table has {len(layout.kinds)}; mend or leave out this line of "
            "the file"
        )
    at = list(good).index(False)
    name = layout.names[columns[at]] or f"column {columns[at] + 1}"
    if is_missing(wanted[at]):
        what = f"'{wanted[at]}' is no finite number" if wanted[at] else "is missing"
        return InputError(
            f"{where}: {name}: {what}: the recording dropped out here; cut the file there or export it again"
        )
    sign = "dot" if layout.decimal == "." else "comma"
    return InputError(f"{where}: {name} = '{wanted[at][:40]}' is not a number with a decimal {sign}")
