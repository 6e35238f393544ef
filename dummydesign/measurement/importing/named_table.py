"""Tables whose columns have names that are given: points and curves of people, as any program writes them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import reading
from dummydesign.measurement.importing.cells import decimal_evidence, is_number, measure
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.decoding import decode
from dummydesign.measurement.importing.vocabulary import Unit, meanings_of, split_name, words_of

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
                known = sum(_key(cell, columns) is not None for cell in row[1])
                if known > best[0]:
                    best = known, number, separator, row[1]
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
    found = [parts[0] if (parts := measure(row[key])) else row[key] for _, row in rows for key in numeric]
    seen = decimal_evidence(cell for cell in found if is_number(cell))
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
    return float(split_name(key)[1] is not None or key.endswith(("_mm_s", "_N_per_mm")))


def _key(cell: str, columns: Sequence[str]) -> tuple[str, float | None] | None:
    """The column that a cell of a header names, and how much of its unit a number is."""
    if cell in columns:
        return cell, None
    name, unit = split_name(cell)
    words, meanings = set(words_of(name)), meanings_of(name)
    if "subject" in columns and words & _SUBJECTS and unit is None:
        return "subject", None
    if "velocity_mm_s" in columns and words & {"velocity", "speed"} and unit and unit.text.lower() in _SPEEDS:
        return "velocity_mm_s", _SPEEDS[unit.text.lower()]
    for key, meaning in _MEANS.items():
        own: Unit | None = split_name(key)[1]
        if key in columns and meanings == {meaning} and unit and own and unit.kind == own.kind:
            return key, unit.factor / own.factor
    return None
