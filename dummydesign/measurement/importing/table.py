"""One file to its columns in s, mm and N."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing import cells as cell_text
from dummydesign.measurement.importing.columns import Column, choose, describe_columns, find_candidates, find_factors
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.decoding import decode, is_workbook, workbook_texts
from dummydesign.measurement.importing.layout import Layout, find_layout
from dummydesign.measurement.importing.vocabulary import ROLES

MOST_INTERRUPTIONS = 500
MIN_SAMPLES = 10
Ranges = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Columns:
    """The three columns as the file counts them, in s, mm and N.

    ``recordings`` are half-open ranges of samples: the time begins again in each. ``layout`` and ``chosen`` are kept
    for a profile.
    """

    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    recordings: Ranges
    layout: Layout
    chosen: dict[str, Column]


def read_texts(path: Path, log: ImportLog) -> dict[str, str]:
    """Read a file to text; a workbook whose sheets are tests of their own to one text a sheet, by its title."""
    data = _read_bytes(path)
    if is_workbook(data):
        return workbook_texts(data, log)
    if (sheets := log.settings.sheets) is not None:
        raise log.fault("--sheets is for .xlsx workbooks; leave it out", "not_applicable", "sheets", sheets)
    return {"": decode(data, log)}


def columns_of(text: str, log: ImportLog) -> Columns:
    """Read time, displacement and force of a text."""
    layout = find_layout(text, log)
    columns = describe_columns(layout)
    candidates = find_candidates(columns, log)
    named = {column.index for role in ROLES for column in candidates[role]}
    # where a role has no candidate, it is chosen by what all columns of numbers do
    indices = [one.index for one in columns if one.index in named or (one.numeric and not all(candidates.values()))]
    body = read_body(layout, indices, log)
    if len(body.values) < MIN_SAMPLES:
        message = f"{len(body.values)} rows of numbers; a press needs at least {MIN_SAMPLES}"
        raise log.fault(message, "not_enough_data", "table", len(body.values))
    values = dict(zip(indices, body.values.T))
    chosen = choose(columns, candidates, values, log)
    raw = {role: values[chosen[role].index] for role in ROLES}
    scale = find_factors(chosen, raw, log)
    first = float(raw["time"][0])
    time = (raw["time"] - first) * scale["time"] if abs(first) > 1e6 else raw["time"] * scale["time"]
    keep, recordings = _recordings(time, body, log)
    x, force = (raw[role][keep] * scale[role] for role in ("displacement", "force"))
    return Columns(time[keep], x, force, recordings, layout, {role: chosen[role] for role in ROLES})


def _read_bytes(path: Path) -> bytes:
    """The file's content; refused when it changes while it is read."""
    try:
        before = path.stat()
        data = path.read_bytes()
        after = path.stat()
    except OSError as problem:
        message = f"{path.name}: cannot be read: {problem.strerror or problem}"
        raise InputError(message, "file_unreadable", "file") from None
    if (before.st_size, before.st_mtime_ns) != (after.st_size, after.st_mtime_ns) or len(data) != after.st_size:
        message = f"{path.name}: is being written just now; wait for the test to end"
        raise InputError(message, "changed_meanwhile", "file")
    return data


@dataclass(frozen=True)
class Body:
    """Numbers of the wanted columns, the file line of each row, and the rows before which text stands."""

    values: NDArray
    lines: NDArray
    breaks: tuple[int, ...]


def read_body(layout: Layout, columns: Sequence[int], log: ImportLog) -> Body:
    """Read the numbers of some columns."""
    values = _read_at_once(layout, columns)
    lines = np.arange(layout.last - layout.first) + layout.line(layout.first)
    return _read_by_line(layout, columns, log) if values is None else Body(values, lines, ())


def _read_at_once(layout: Layout, columns: Sequence[int]) -> NDArray | None:
    """All lines in one go; None unless every one of them has the same form."""
    lines, separator = layout.lines[layout.first : layout.last], layout.separator
    if layout.thousands or layout.decimal == separator or any(layout.kinds[column] != "number" for column in columns):
        return None
    widths = {len(line.split()) if separator == " " else line.count(separator) for line in lines}
    if len(widths) != 1 or (separator == " " and widths != {len(layout.kinds)}):
        return None
    if layout.decimal == ",":
        whole = "\n".join(lines)
        if "." in whole:
            return None  # a dot is a thousands sign here
        lines = whole.replace(",", ".").split("\n")
    delimiter = None if separator == " " else separator
    try:
        values = np.loadtxt(lines, delimiter=delimiter, comments=None, quotechar='"', usecols=list(columns), ndmin=2)
    except (ValueError, IndexError):
        return None
    return values if len(values) == len(lines) and np.isfinite(values).all() else None


def _read_by_line(layout: Layout, columns: Sequence[int], log: ImportLog) -> Body:
    """Line by line, with the faults named; lines of text between the numbers interrupt the table."""
    width, date_at, dates = len(layout.kinds), _date_column(layout), list[str]()
    rows: list[list[Any]] = []
    numbers: list[int] = []
    breaks: list[int] = []
    between: list[int] = []
    for index in range(layout.first, layout.last):
        line = layout.lines[index]
        if not line.strip() or cell_text.is_comment(line):
            continue
        cells = layout.cells(line)
        while len(cells) > width and not cells[-1]:
            cells = cells[:-1]
        wanted = [cells[column] if column < len(cells) else "" for column in columns]
        row = [_read_cell(cell, layout.kinds[column], layout.decimal) for cell, column in zip(wanted, columns)]
        if all(number is None for number in row):
            # A line of text, of units or a header again: what follows may be another test.
            if any(cells):
                between.append(index)
                breaks.append(len(rows))
            continue
        if len(cells) != width:
            message = f"has {len(cells)} cells, the table has {width}; fix or remove this line of the file"
            raise log.fault(message, "malformed", "table", len(cells), width, line=layout.line(index))
        if None in row:
            at = row.index(None)
            raise _cell_fault(layout, index, columns[at], wanted[at], log)
        rows.append(row)
        dates.append("" if date_at is None or not cell_text.is_date(cells[date_at]) else cells[date_at])
        numbers.append(layout.line(index))
    if between:
        first, line = layout.line(between[0]), layout.lines[between[0]].strip()[:40]
        if len(between) > MOST_INTERRUPTIONS:
            message = f"{len(between)} lines between the rows are not numbers, such as '{line}'; export without them"
            raise log.fault(message, "malformed", "table", len(between), line=first)
        why = f"text between the rows, left out; the first is line {first}: '{line}'"
        log.decide("lines between", f"{len(between)} lines", why)
    # the same date in every row is that of the test, not of the row
    dates = dates if len(set(dates)) > 1 else [""] * len(rows)
    for at, column in enumerate(columns):
        if rows and layout.kinds[column] == "stamp":
            stamps = [(row[at][0], row[at][1] or date) for row, date in zip(rows, dates)]
            for row, seconds in zip(rows, cell_text.elapsed_seconds(stamps, log)):
                row[at] = seconds
    values = np.array(rows, float).reshape(-1, len(columns))
    finite = np.isfinite(values).all(axis=1)
    if not finite.all():
        raise log.fault("a number is too large", "out_of_range", "cell", line=numbers[int(np.argmin(finite))])
    return Body(values, np.array(numbers, int), tuple(dict.fromkeys(at for at in breaks if 0 < at < len(rows))))


def _date_column(layout: Layout) -> int | None:
    """Column of dates beside a column of clock times."""
    first = zip(layout.cells(layout.lines[layout.first]), layout.kinds)
    return next((at for at, (cell, kind) in enumerate(first) if kind == "text" and cell_text.is_date(cell)), None)


def _read_cell(cell: str, kind: str, decimal: str) -> float | tuple[float, str] | None:
    """A number, or the clock and the date of a stamp; None where the cell is neither."""
    if kind != "stamp":
        return cell_text.parse(cell, decimal)
    try:
        return cell_text.seconds_of_stamp(cell)
    except ValueError:
        return None


def _cell_fault(layout: Layout, index: int, column: int, cell: str, log: ImportLog) -> InputError:
    name, line = layout.names[column] or f"column {column + 1}", layout.line(index)
    if cell_text.is_missing(cell):
        what = f"'{cell}' is no finite number" if cell else "is missing"
        message = f"{name}: {what}: the recording dropped out here; cut the file there or export it again"
        return log.fault(message, "missing", "cell", cell, line=line)
    sign = "dot" if layout.decimal == "." else "comma"
    message = f"{name} = '{cell[:40]}' is not a number with a decimal {sign}"
    return log.fault(message, "not_a_number", "cell", cell[:40], line=line)


def _recordings(time: NDArray, body: Body, log: ImportLog) -> tuple[NDArray, Ranges]:
    """Find rows to keep and the recordings in them."""
    keep = np.ones(len(time), bool)
    same = np.flatnonzero((np.diff(time) == 0) & np.all(body.values[1:] == body.values[:-1], axis=1)) + 1
    if 0 < same.size <= 0.02 * len(time):
        keep[same] = False
        why = f"word for word the row before; the first is line {body.lines[same[0]]}"
        log.decide("repeated rows", f"{same.size} rows", why)
    kept, lines = time[keep], body.lines[keep]
    rank = np.cumsum(keep) - 1
    interrupted = {int(rank[at]) for at in body.breaks}
    starts = [0]
    for row in (np.flatnonzero(np.diff(kept) <= 0) + 1).tolist():
        begin, reached = float(kept[starts[-1]]), float(kept[row - 1])
        back = reached - float(kept[row])
        if not (back > 0 and (row in interrupted or back > 0.9 * (reached - begin)) and row - starts[-1] >= 10):
            raise _time_fault(kept, row, int(lines[row]), log)
        starts.append(row)
    if len(starts) > 1:
        log.decide("recordings", str(len(starts)), f"the time begins again at line {int(lines[starts[1]])}")
    return keep, tuple(zip(starts, [*starts[1:], len(kept)]))


def _time_fault(time: NDArray, row: int, line: int, log: ImportLog) -> InputError:
    steps = np.diff(time)
    share = float(np.mean(steps == 0))
    words = f"does not rise (the row before has {time[row - 1]:.6g} s); sort the rows, or leave this one out"
    if share > 0.05:
        size = min(steps[steps > 0].tolist(), default=0.0)
        words = (f"is written {1 / max(1 - share, 1e-9):.1f} times on average: its last digit ({size:.3g} s) is "
                 "coarser than the sampling; export the time with more digits")  # fmt: skip
    return log.fault(f"time = {time[row]:.6g} s {words}", "malformed", "time_s", float(time[row]), line=line)
