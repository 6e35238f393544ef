"""Measured curves in tissue files: ``[[subject.press]]`` tables, read with errors that name them, and written."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.datafiles import toml_line
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import KINDS
from dummydesign.tissue.model.held_press import SHARES, HeldPress
from dummydesign.tissue.model.measured_curves import MeasuredPerson
from dummydesign.tissue.model.tissue import Subject

SUBJECT = ("name", "kind", "source", "press")
PRESS = ("velocity_mm_s", "depth_mm", "rise_force_N", "hold_time_s", "hold_force_N")


def read_people(raw: list[dict[str, Any]], path: Path) -> tuple[Subject, ...]:
    """Subjects of the tables of a file.

    Parameters
    ----------
    raw : list of dict
        Its ``[[subject]]`` tables.
    path : Path
        Named in messages.

    Raises
    ------
    InputError
        With the file, the subject and the press.
    """
    from dummydesign.tissue.model.curve_numbers import subjects_of

    people = []
    for number, item in enumerate(raw, start=1):
        name = item.get("name")
        where = f"{path.name}: subject {number if not isinstance(name, str) else repr(name)}"
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"{where} has no name")
        for key in item:
            if key not in SUBJECT:
                raise InputError(f"{where}: {unknown_name('key', key, SUBJECT)}")
        kind, source, presses = (item.get(key) for key in SUBJECT[1:])
        if kind not in KINDS:
            raise InputError(f"{where} has kind '{kind}'; known kinds are {', '.join(KINDS)}")
        if not isinstance(source, str) or not source.strip():
            raise InputError(f"{where} has an empty source; say where the curves are from")
        if not isinstance(presses, list) or not presses:
            raise InputError(f"{where} needs at least one [[subject.press]]")
        own = [_press(press, f"{where}, press {at}") for at, press in enumerate(presses, start=1)]
        people.append((name, MeasuredPerson(own), str(kind), source))
    try:
        return subjects_of(people)
    except InputError as problem:
        raise InputError(f"{path.name}: {problem}") from None


def _press(table: Any, where: str) -> HeldPress:
    if not isinstance(table, dict):
        raise InputError(f"{where} is no table")
    for key in table:
        if key not in PRESS:
            raise InputError(f"{where}: {unknown_name('key', key, PRESS)}")
    speed, depth = (_above_zero(table, key, where) for key in PRESS[:2])
    rise, time, hold = (_row(table, key, where) for key in PRESS[2:])
    if len(rise) != len(SHARES):
        raise InputError(f"{where}: rise_force_N has {len(rise)} numbers; {len(SHARES)} are needed")
    if len(time) != len(hold) or len(time) < 2 or time[0] != 0.0 or np.any(np.diff(time) <= 0.0):
        raise InputError(f"{where}: hold_time_s must rise from 0 and have as many numbers as hold_force_N, at least 2")
    if not hold[-1] > 0.0:
        raise InputError(f"{where}: hold_force_N ends at {hold[-1]:g}; the force at the end of a hold is above 0")
    return HeldPress(speed, depth, rise, time, hold)


def _above_zero(table: dict[str, Any], key: str, where: str) -> float:
    value = table.get(key)
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not (math.isfinite(value) and value > 0):
        raise InputError(f"{where}: {key} = {value!r} must be a number above 0")
    return float(value)


def _row(table: dict[str, Any], key: str, where: str) -> NDArray:
    values = table.get(key)
    good = isinstance(values, list) and all(
        isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in values
    )
    if not good:
        raise InputError(f"{where}: {key} must be a list of finite numbers")
    return np.array(values, float)


def press_lines(subject: Subject) -> list[str]:
    """Lines of a subject's kind, source and presses, after its name."""
    first = next(iter(subject.numbers.values()))
    source = first.source.partition("; the interval is ")[0]
    lines = [f"kind = {toml_line(first.kind)}", f"source = {toml_line(source)}"]
    assert isinstance(subject.parameters, MeasuredPerson)
    for press in subject.parameters.presses:
        lines += ["", "[[subject.press]]"]
        lines += [f"velocity_mm_s = {press.velocity_mm_s:g}", f"depth_mm = {press.depth_mm:.6g}"]
        rows = zip(PRESS[2:], (press.rise_N, press.time_s, press.hold_N))
        for key, values in rows:
            lines.append(f"{key} = [{', '.join(f'{value:.6g}' for value in values)}]")
    return lines
