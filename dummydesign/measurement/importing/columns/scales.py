"""From the numbers in a file to seconds, millimetres and newtons: stated units, clock times, counted days."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.columns.roles import Column
from dummydesign.measurement.importing.core.decisions import Notes, Settings, question
from dummydesign.measurement.importing.core.units import BASE, KIND_OF_ROLE, Unit, known_units, scaled_unit
from dummydesign.measurement.importing.core.vocabulary import ROLES

_SINCE_1970 = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_YEARS = (9.4e8, 2.3e9)
"""Seconds since 1970 of the years 2000 and 2042."""
_EXCEL_DAYS = (36500.0, 52000.0)
"""Days since 1900 of the same years."""


def factors(
    file: str, chosen: Mapping[str, Column], values: Mapping[str, NDArray], settings: Settings, notes: Notes
) -> dict[str, float]:
    """Find how many s, mm and N one count of each column is.

    Parameters
    ----------
    file : str
        Name for messages.
    chosen : mapping of str to Column
        Column of each role.
    values : mapping of str to ndarray, shape (rows,)
        Its numbers as written.
    settings : Settings
        Units that the user named.
    notes : Notes
        Receives the decisions.

    Raises
    ------
    InputError
        When ``--units`` names no unit of its kind.
    QuestionError
        When no unit is stated: a unit is never guessed.
    """
    found: dict[str, Unit] = {}
    for role in ROLES:
        unit = _unit(file, role, chosen[role], values[role], settings, notes)
        if unit is not None:
            found[role] = unit
    missing = [role for role in ROLES if role not in found]
    if missing:
        parts, option = [], []
        for role in missing:
            unit = chosen[role].unit
            stated = f"is in '{unit.text}', which is no {KIND_OF_ROLE[role]}" if unit else "states no unit"
            low, high = float(values[role].min()), float(values[role].max())
            parts.append(f"{role} ('{chosen[role].label}', {low:.4g} to {high:.4g}) {stated}")
            option.append(f"{role}={BASE[KIND_OF_ROLE[role]]}")
        raise question(file, "; ".join(parts), f"--units {','.join(option)}, or the units that these are in")
    return {role: unit.factor for role, unit in found.items()}


def _unit(file: str, role: str, column: Column, values: NDArray, settings: Settings, notes: Notes) -> Unit | None:
    kind = KIND_OF_ROLE[role]
    if role in settings.units:
        unit = scaled_unit(settings.units[role], kind)
        if unit is None:
            raise InputError(
                f"--units {role}={settings.units[role]} is no {kind}; known are {known_units(kind)}, or a count such "
                f"as 0.5{BASE[kind]}"
            )
        notes.decide(f"{role} unit", unit.text, "given by --units")
        stated = column.unit
        if stated is not None and stated.kind == kind and stated.factor != unit.factor:
            notes.warn(
                "unit_overridden",
                f"{file}: the header says that {role} is in {stated.text}; it is taken in {unit.text}, as --units or "
                "the profile says: leave that out if the header is right",
            )
        return unit
    if column.kind == "stamp":
        notes.decide("time unit", "s", "clock times, counted from the first")
        return Unit("time", 1.0, "s")
    if column.unit is not None and column.unit.kind == kind:
        if column.unit.text != BASE[kind]:
            notes.decide(f"{role} unit", column.unit.text, f"stated in the header; 1 {column.unit.text} is "
                         f"{column.unit.factor:.6g} {BASE[kind]}")  # fmt: skip
        else:
            notes.decide(f"{role} unit", column.unit.text, "stated in the header")
        return column.unit
    return _absolute(values, notes) if role == "time" else None


def _absolute(values: NDArray, notes: Notes) -> Unit | None:
    """Times that count from 1970 or 1900 show their unit by their size alone."""
    first, last = float(values[0]), float(values[-1])
    for name, factor in _SINCE_1970.items():
        if _YEARS[0] < first * factor < _YEARS[1] and 0 <= (last - first) * factor < 86400.0:
            notes.decide("time unit", name, f"counts {name} since 1970 ({first:.14g})")
            return Unit("time", factor, name)
    steps = np.diff(values)
    if _EXCEL_DAYS[0] < first < _EXCEL_DAYS[1] and 0 <= last - first < 1.0 and float(np.median(steps)) < 1e-3:
        notes.decide("time unit", "days", f"counts days since 1900 ({first:.10g}), as spreadsheets do")
        return Unit("time", 86400.0, "d")
    return None
