"""One file to its columns in s, mm and N; tables of points and curves whose columns have names that are given."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import reading
from dummydesign.measurement.importing import cells as cell_text
from dummydesign.measurement.importing import vocabulary as known
from dummydesign.measurement.importing.columns import (
    Candidates,
    Column,
    Values,
    check_apart,
    choose_by_behaviour,
    choose_one,
    describe_columns,
    find_candidates,
    find_factors,
)
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.decoding import chosen_sheets, decode, is_workbook, workbook_texts
from dummydesign.measurement.importing.forms import specimens
from dummydesign.measurement.importing.layout import TableLayout, find_layout
from dummydesign.measurement.importing.times import (
    AGREES,
    Ranges,
    align,
    check_rate,
    compose_time,
    find_bases,
    join_steps,
    lengths_by_time,
    rows_in_order,
    shift,
    time_by_rate,
    timelike,
    unwrap,
)
from dummydesign.measurement.importing.vocabulary import ROLES
from dummydesign.measurement.trace import numbers_at_once

MOST_INTERRUPTIONS = 500
MIN_SAMPLES = 10


@dataclass(frozen=True, eq=False)
class Columns:
    """The three columns as the file counts them, in s, mm and N.

    ``recordings`` are half-open ranges of samples: the time begins again in each. ``layout`` and ``chosen`` are kept
    for a profile.
    """

    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    recordings: Ranges
    layout: TableLayout
    chosen: dict[str, Column]


def read_texts(path: Path, log: ImportLog) -> dict[str, str]:
    """Read a file to the text of each test: a sheet of a workbook or a specimen beside others, by its title."""
    data = _read_bytes(path)
    if is_workbook(data):
        texts = workbook_texts(data, log)
        return texts if len(texts) > 1 else specimens(next(iter(texts.values())), log)
    texts = specimens(decode(data, log), log)
    if (sheets := log.settings.sheets) is not None:
        if len(texts) == 1:
            message = "--sheets is for workbooks and for specimens side by side; leave it out"
            raise log.fault(message, "not_applicable", "sheets", sheets)
        texts = {title: texts[title] for title in chosen_sheets(sheets, list(texts), log.file)}
    return texts


_NAMELESS = Column(-1, "", "number", frozenset({"time"}), None)
"""Stands for a time that is made of several columns, or of none: a profile keeps no name of it."""


def columns_of(text: str, log: ImportLog) -> Columns:
    """Read time, displacement and force of a text."""
    layout = find_layout(text, log)
    columns = describe_columns(layout)
    rate = log.settings.rate or layout.rate_Hz
    candidates = find_candidates(columns, rate is not None, log)
    # where a role has no candidate, it is chosen by what all columns of numbers do
    missing = [role for role in ROLES if not candidates[role] and not (rate and role == "time")]
    wanted = {column.index for role in ROLES for column in candidates[role]}
    wanted |= {one.index for one in columns if timelike(one) or (one.numeric and (missing or one.counts))}
    indices = sorted(wanted)
    gaps = "any" if layout.sparse else "end" if len(candidates["time"]) > 1 else ""
    body = read_body(layout, indices, log, gaps)
    if len(body.values) < MIN_SAMPLES:
        message = f"{len(body.values)} rows of numbers; a press needs at least {MIN_SAMPLES}"
        raise log.fault(message, "not_enough_data", "table", len(body.values))
    values = dict(zip(indices, body.values.T))
    chosen = {role: choose_one(role, candidates[role], values, log) for role in ROLES[1:] if candidates[role]}
    chosen |= choose_by_behaviour(columns, chosen, missing, values, log)
    time, x, force, inside = _quantities(columns, candidates, chosen, values, layout.rate_Hz, log)
    breaks = np.flatnonzero(np.isin(np.flatnonzero(inside), body.breaks)).tolist()
    order, time, recordings = rows_in_order(time, layout.repeats, breaks, body.lines[inside], log)
    x, force = x[order], force[order]
    time, recordings = join_steps(time, x, force, recordings, log)
    if (delay := log.settings.delay) is not None:
        time, x, force, recordings = shift(time, x, force, recordings, delay)
        log.decide("delay", f"{delay:g} s", "given by --delay: the displacement is taken from so much earlier")
    return Columns(time, x, force, recordings, layout, {role: chosen.get(role, _NAMELESS) for role in ROLES})


def _quantities(
    columns: Sequence[Column],
    candidates: Candidates,
    chosen: dict[str, Column],
    values: Values,
    stated: float | None,
    log: ImportLog,
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Time, displacement and force in s, mm and N, and which rows of the table they are; the time's column is added."""
    settings, second, seconds = log.settings, None, None
    times, composed = candidates["time"], compose_time(columns, values)
    named = "time" in settings.columns
    count = len(values[chosen["force"].index])
    if "time" not in chosen and not named and settings.rate:
        seconds = time_by_rate(columns, values, count, settings.rate, "given by --rate", log)
        check_rate(settings.rate, columns, values, log)
    elif "time" not in chosen and not times and stated:
        seconds = time_by_rate(columns, values, count, stated, "stated above the table", log)
    elif composed and not (named and times[0] not in composed.parts):
        seconds = composed.seconds
        first, other = composed.parts
        log.decide("time column", f"{first.label} + {other.label}", "whole ones, and their fraction")
    elif "time" not in chosen:
        bases = {} if named else find_bases(chosen, times)
        if bases:
            chosen["time"], second = bases["force"], bases["displacement"]
            log.decide("time column", f"{chosen['time'].label} and {second.label}", "each quantity has its own")
        else:
            chosen["time"] = choose_one("time", times, values, log)
    check_apart(chosen, log)
    raw = {role: values[column.index] for role, column in chosen.items()}
    scale = find_factors(chosen, raw, log)
    x, force = (raw[role] * scale[role] for role in ("displacement", "force"))
    inside = np.isfinite(x) & np.isfinite(force)
    if second is None and "time" in raw and not np.isfinite(raw["time"]).all():
        raise log.fault("the time is missing in some rows; export it for each row", "missing", "cell")
    if seconds is None:
        begin = float(raw["time"][0]) if abs(raw["time"][0]) > 1e6 else 0.0
        seconds = unwrap((raw["time"] - begin) * scale["time"], scale["time"], log)
        if second is not None:
            own = second.unit.factor if second.unit and "time" not in settings.units else scale["time"]
            inside, x = align(seconds, values[second.index] * own - begin * scale["time"], x, force, log)
        else:
            _check_time(chosen["time"], seconds, columns, values, log)
    if second is None and not inside.all():
        inside, x = align(seconds, seconds, x, force, log)
    return seconds[inside], x[inside], force[inside], inside


def _check_time(column: Column, seconds: NDArray, columns: Sequence[Column], values: Values, log: ImportLog) -> None:
    """Ask where the time, by its unit, contradicts another column of time."""
    if "time" in log.settings.units or column.unit is None:
        return
    text, length = column.unit.text, float(np.ptp(seconds))
    for other, span in lengths_by_time(columns, values):
        if other is not column and span > 0 and abs(span - length) > max(AGREES * span, 1.0):
            raise log.question(
                f"the recording lasts {length:.4g} s by '{column.label}' and {span:.4g} s by '{other.label}'",
                f"--columns time={other.label} or --units time={text} where the header is right",
            )


def _read_bytes(path: Path) -> bytes:
    """The file's content; refused when it changes while it is read."""
    with reading("file", path, "file"):
        before = path.stat()
        data = path.read_bytes()
        after = path.stat()
    if (before.st_size, before.st_mtime_ns) != (after.st_size, after.st_mtime_ns) or len(data) != after.st_size:
        raise InputError(
            f"{path.name}: is being written just now; wait for the test to end", "changed_meanwhile", "file"
        )
    return data


@dataclass(frozen=True, eq=False)
class TableBody:
    """Numbers of the wanted columns, the file line of each row, and the rows before which text stands."""

    values: NDArray
    lines: NDArray
    breaks: tuple[int, ...]


def read_body(layout: TableLayout, columns: Sequence[int], log: ImportLog, gaps: str = "") -> TableBody:
    """Read the numbers of some columns; NaN above a column's begin, below its ``end``, or for ``any`` without one."""
    if (values := _read_at_once(layout, columns)) is None:
        return _read_by_line(layout, columns, log, gaps)
    return TableBody(values, np.arange(len(values)) + layout.line(layout.first), ())


def _read_at_once(layout: TableLayout, columns: Sequence[int]) -> NDArray | None:
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
    return numbers_at_once(lines, None if separator == " " else separator, columns)


def _read_by_line(layout: TableLayout, columns: Sequence[int], log: ImportLog, gaps: str) -> TableBody:
    """Line by line, with the faults named; lines of text between the numbers interrupt the table."""
    width, date_at, dates = len(layout.kinds), _date_column(layout), list[str]()
    rows: list[list[Any]] = []
    numbers: list[int] = []
    between: list[tuple[int, int]] = []
    left_out: list[int] = []
    begun = [False] * len(columns)
    for index in range(layout.first, layout.last):
        line = layout.lines[index]
        if not line.strip() or cell_text.is_comment(line):
            continue
        cells = cell_text.without_empty_end(layout.cells(line), width)
        wanted = [cells[column] if column < len(cells) else "" for column in columns]
        row = [_read_cell(cell, column, layout) for cell, column in zip(wanted, columns)]
        short = len(cells) != width and sum(number is not None for number in row) <= 1
        if short or all(number is None for number in row):
            # A line of text, of units or a header again: what follows may be another test.
            if any(cells):
                between.append((index, len(rows)))
            continue
        if any(map(cell_text.is_excluded, wanted)):
            left_out.append(layout.line(index))
            continue
        if len(cells) != width:
            message = f"has {len(cells)} cells, the table has {width}; fix or remove this line of the file"
            raise log.fault(message, "malformed", "table", len(cells), width, line=layout.line(index))
        ended = [gaps == "end" and bool(rows) and rows[-1][at] is _EMPTY for at in range(len(row))]
        for at, cell in enumerate(wanted):
            if not cell_text.is_absent(cell):
                begun[at] = True
            # a channel that was recorded for a shorter time begins or ends, and does not go on
            elif layout.kinds[columns[at]] == "number" and (not begun[at] or gaps == "any" or (gaps and len(rows) > 9)):
                row[at], ended[at] = _EMPTY, False
        if None in row or any(ended):
            at = row.index(None) if None in row else ended.index(True)
            raise _cell_fault(layout, index, columns[at], wanted[at] if None in row else "", log)
        rows.append(row)
        dates.append("" if date_at is None or not cell_text.is_date(cells[date_at]) else cells[date_at])
        numbers.append(layout.line(index))
    if between:
        first, line = layout.line(between[0][0]), layout.lines[between[0][0]].strip()[:40]
        if len(between) > MOST_INTERRUPTIONS:
            message = f"{len(between)} lines between the rows are not numbers, such as '{line}'; export without them"
            raise log.fault(message, "malformed", "table", len(between), line=first)
        why = f"text between the rows, left out; the first is line {first}: '{line}'"
        log.decide("lines between", f"{len(between)} lines", why)
        stray = [layout.line(at) for at, _ in between if cell_text.is_number(layout.lines[at].strip(" ,;|\t"))]
        _warn_left_out(stray, "stray_row", "a single number", log)
    _warn_left_out(left_out, "excluded_values", "a value marked with *", log)
    # the same date in every row is that of the test, not of the row
    dates = dates if len(set(dates)) > 1 else [""] * len(rows)
    for at, column in enumerate(columns):
        if rows and layout.kinds[column] == "stamp":
            stamps = [(row[at][0], row[at][1] or date) for row, date in zip(rows, dates)]
            for row, seconds in zip(rows, cell_text.elapsed_seconds(stamps, log)):
                row[at] = seconds
    values = np.array(rows, float).reshape(-1, len(columns))
    finite = (np.isfinite(values) | np.isnan(values)).all(axis=1)
    if not finite.all():
        raise log.fault("a number is too large", "out_of_range", "cell", line=numbers[int(np.argmin(finite))])
    breaks = dict.fromkeys(row for _, row in between if 0 < row < len(rows))
    return TableBody(values, np.array(numbers, int), tuple(breaks))


def _warn_left_out(lines: Sequence[int], code: str, what: str, log: ImportLog) -> None:
    """Warn of rows that are no part of the recording, by their lines."""
    if lines:
        shown = ", ".join(map(str, lines[:5])) + (", ..." if len(lines) > 5 else "")
        log.warn(
            code, f"rows with {what} were left out ({len(lines)}, line {shown}): check that they are none of the test's"
        )


_EMPTY = float("nan")
"""Stands for an empty cell."""


def _date_column(layout: TableLayout) -> int | None:
    """Column of dates beside a column of clock times."""
    first = zip(layout.cells(layout.lines[layout.first]), layout.kinds)
    return next((at for at, (cell, kind) in enumerate(first) if kind == "text" and cell_text.is_date(cell)), None)


def _read_cell(cell: str, column: int, layout: TableLayout) -> float | tuple[float, str] | None:
    """A number, or the clock and the date of a stamp; None where the cell is neither."""
    kind = layout.kinds[column]
    if kind == "number":
        return cell_text.parse(cell, layout.decimal)
    if kind == "measure":
        parts, unit = cell_text.measure(cell), known.find_unit(layout.units[column])
        number = cell_text.parse(parts[0], layout.decimal) if parts else None
        if number is None or parts is None or unit is None or parts[1].kind != unit.kind:
            return None
        return number * parts[1].factor / unit.factor
    return cell_text.seconds_of_stamp(cell)


def _cell_fault(layout: TableLayout, index: int, column: int, cell: str, log: ImportLog) -> InputError:
    name, line = layout.names[column] or f"column {column + 1}", layout.line(index)
    if cell_text.is_missing(cell):
        what = f"'{cell}' is no finite number" if cell else "is missing"
        message = f"{name}: {what}: the recording dropped out here; cut the file there or export it again"
        return log.fault(message, "missing", "cell", cell, line=line)
    sign = "dot" if layout.decimal == "." else "comma"
    return log.fault(
        f"{name} = '{cell[:40]}' is not a number with a decimal {sign}", "not_a_number", "cell", cell[:40], line=line
    )


_HEAD = 40
"""Lines at the start among which the header is looked for."""
_MEANS = {"depth_mm": "displacement", "force_N": "force", "time_s": "time"}
"""What the name of a column must speak for to be read as this one."""
_SPEEDS = {"mm/s": 1.0, "m/s": 1e3, "cm/s": 10.0, "mm/min": 1 / 60}
_SUBJECTS = {"subject", "person", "participant", "proband", "sujet", "volunteer", "dataset"}


@dataclass(frozen=True)
class NamedTable:
    """Rows with their line and their cells by column, the decimal sign, and what turns a number to a column's unit."""

    rows: list[tuple[int, dict[str, str]]]
    decimal: str
    factors: dict[str, float]


def read_named_table(path: Path, what: str, columns: Sequence[str], optional: Sequence[str] = ()) -> NamedTable:
    """Read the rows that hold something, of a table with these columns.

    Parameters
    ----------
    path : Path
        Text in any encoding that the import reads; separated by comma, semicolon, tab or bar.
    what : str
        What the table holds, for errors.
    columns, optional : sequence of str
        Columns by name; one in ``optional`` may be absent.
    """
    with reading(f"{what} file", path, what):
        data = path.read_bytes()
    text = decode(data, ImportLog(path.name)).removeprefix("\ufeff") if data.strip() else ""
    best: tuple[int, int, str, list[str]] = (0, 0, ",", [])
    for separator in (",", ";", "\t", "|", " "):
        with suppress(csv.Error):  # of another separator
            for number, row in enumerate(_split(text, separator)):
                named = sum(_key(cell, columns) is not None for cell in row[1])
                if named > best[0]:
                    best = named, number, separator, row[1]
                if number > _HEAD:
                    break
    _, head, separator, header = best
    keys = [_key(cell, columns) or (cell, None) for cell in header]
    for column in columns:
        if column not in [key for key, _ in keys] and column not in optional:
            shown = ", ".join(f"'{cell}'" for cell in header or text.split("\n", 1)[0].split(","))[:200]
            raise InputError(
                f"{path.name}:1: column '{column}' is missing (found {shown}); the header must be "
                f"{','.join(columns)}, or name each quantity with its unit, such as 'Depth (cm)'",
                "missing",
                column,
            )
    try:
        read = list(_split(text, separator))
    except csv.Error as problem:
        raise InputError(f"{path.name}: {problem}; is a quote open?", "malformed", what, str(path)) from None
    rows = [
        (line, {key: cell for (key, _), cell in zip(keys, [*cells, *[""] * len(keys)])})
        for line, cells in read[head + 1 :]
        if any(cells)
    ]
    numeric = {key: factor or _factor(key) for key, factor in keys if factor or _factor(key)}
    found = [parts[0] if (parts := cell_text.measure(row[key])) else row[key] for _, row in rows for key in numeric]
    seen = cell_text.decimal_evidence(cell for cell in found if cell_text.is_number(cell))
    either = next((cell for cell in found if "," in cell), "")
    if seen[","] == seen["."] == 0 and either:
        message = f"{path.name}: '{either}' may be a decimal or a thousand; write numbers with a decimal dot"
        raise InputError(message, "not_a_number", what, either)
    return NamedTable(rows, "," if seen[","] > seen["."] else ".", numeric)


def _split(text: str, separator: str) -> Iterator[tuple[int, list[str]]]:
    """Lines and stripped cells; raises :class:`csv.Error` where a quote is never closed."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
    for row in reader:
        yield reader.line_num, [cell.strip() for cell in row]


def _factor(key: str) -> float:
    """1 for the name of a column that ends with its unit, 0 for that of a text."""
    return float(known.split_name(key)[1] is not None or key.endswith(("_mm_s", "_N_per_mm")))


def _key(cell: str, columns: Sequence[str]) -> tuple[str, float | None] | None:
    """The column that a cell of a header names, and how much of its unit a number is."""
    if cell in columns:
        return cell, None
    name, unit = known.split_name(cell)
    words, meanings = set(known.words_of(name)), known.meanings_of(name)
    if "subject" in columns and words & _SUBJECTS and unit is None:
        return "subject", None
    if "velocity_mm_s" in columns and words & {"velocity", "speed"} and unit and unit.text.lower() in _SPEEDS:
        return "velocity_mm_s", _SPEEDS[unit.text.lower()]
    for key, meaning in _MEANS.items():
        own: known.Unit | None = known.split_name(key)[1]
        if key in columns and meanings == {meaning} and unit and own and unit.kind == own.kind:
            return key, unit.factor / own.factor
    return None
