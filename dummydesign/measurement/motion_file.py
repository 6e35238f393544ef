"""Read a measured or planned motion: a trace whose force column may be missing."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.absent import absent_roles, absent_words
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.trace import import_first

_COLUMNS = ("time_s", "displacement_mm")
_ROLES = ("time", "displacement")


def read_motion(path: str | Path) -> Motion:
    """Read the columns time_s and displacement_mm of a CSV file; other columns are ignored.

    Raises
    ------
    InputError
        With file and line for a missing column, a cell that is no finite number or time that does not increase.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as problem:
        raise InputError(f"motion file '{path}' cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"motion file '{path}' is not UTF-8 text{import_first(path)}") from None
    rows = csv.DictReader(text.splitlines())
    missing = [name for name in _COLUMNS if name not in (rows.fieldnames or [])]
    header = [str(cell).strip() for cell in rows.fieldnames or []]
    absent = absent_roles(header, _ROLES) if missing and len(header) > 1 else ()
    if absent:
        raise InputError(f"{path.name}:1: {absent_words(absent, header, _ROLES)}")
    if missing:
        advice = f"the header must name {', '.join(_COLUMNS)}{import_first(path) if rows.fieldnames else ''}"
        raise InputError(f"{path.name}:1: column '{missing[0]}' is missing; {advice}")
    values: list[tuple[float, float]] = []
    for row in rows:
        pair = []
        for name in _COLUMNS:
            try:
                number = float(row[name])
            except (TypeError, ValueError):
                raise InputError(f"{path.name}:{rows.line_num}: {name} = {row[name]!r} is not a number") from None
            if not np.isfinite(number):
                raise InputError(f"{path.name}:{rows.line_num}: {name} = {number} is not finite")
            pair.append(number)
        if values and pair[0] <= values[-1][0]:
            raise InputError(f"{path.name}:{rows.line_num}: time_s = {pair[0]} does not increase")
        values.append((pair[0], pair[1]))
    if len(values) < 2:
        raise InputError(f"{path.name}: {len(values)} rows; a motion needs at least 2")
    time, displacement = np.array(values).T
    return Motion(time, displacement)
