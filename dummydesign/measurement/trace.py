"""Reading of trace files: time, displacement and force of one press, checked line by line."""

from __future__ import annotations

import csv
import io
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.absent import absent_roles, absent_words

COLUMNS = ("time_s", "displacement_mm", "force_N")
SECONDS = "time_is_in_seconds"
"""A further column whose presence says that time was looked at: a slow press is then no longer doubted."""
MIN_SAMPLES = 10
COARSE_S, SLOW_MM_S, LONG_S = 0.5, 0.05, 1000.0
"""Steps of time, speed and length of a press from which on it is doubted that its time is in seconds."""
MILLISECONDS = "'dummydesign import' reads it with --units time=ms, or with --units time=s if it is in seconds"
AGREES = 10.0
"""A measured speed agrees with a declared one within this factor."""
DEEP, COMPRESSED = 0.9, 0.02
"""Share of the largest displacement that counts as deepest, and of the largest force that counts as compression."""
LOADED, FEW = 0.3, 0.05
"""Share of the largest force that counts as load, and of the samples under load that tell where it is deepest."""


@dataclass(frozen=True)
class Trace:
    """One measured (or simulated) press; arrays of shape (n,), compression positive.

    ``told_mm_s`` is the speed the robot was told, where that is known: a shallow press brakes from the surface on, and
    its motion does not show it.
    """

    name: str
    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    told_mm_s: float | None = None


def read_trace(path: str | Path, velocity_mm_s: float | None = None) -> Trace:
    """Read one trace CSV with the columns time_s, displacement_mm and force_N (others are ignored).

    Parameters
    ----------
    path : path
        UTF-8 text, dot decimals, comma separated, strictly increasing time, any sampling.
    velocity_mm_s : float, optional
        Speed that was declared; it settles whether a slow press is in seconds. [mm/s]

    Raises
    ------
    InputError
        With file and line for a missing column, a cell that is no number, time that does not increase,
        too few samples, or magnitudes that show another unit (m, um, mN, kN, ms) or sign.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"trace file '{path}' does not exist") from None
    except IsADirectoryError:
        raise InputError(f"'{path}' is a folder; give the traces in it, such as {path}/*.csv") from None
    except UnicodeDecodeError:
        raise InputError(f"{path.name}: is not UTF-8 text{import_first(path)}") from None
    except OSError as problem:
        raise InputError(f"{path.name}: cannot be read: {problem.strerror}") from None
    values, lines, seconds = _read_columns(path, text)
    time, displacement, force = values.T
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{path.name}: {len(time)} samples; at least {MIN_SAMPLES} are needed")
    back = np.nonzero(np.diff(time) <= 0)[0]
    if back.size:
        at = int(back[0])
        raise InputError(
            f"{path.name}:{lines[at + 1]}: time_s = {time[at + 1]:g} does not increase (line before: {time[at]:g})"
        )
    fault = magnitude_fault(time, displacement, force, velocity_mm_s, seconds)
    if fault:
        raise InputError(f"{path.name}: {fault}{import_first(path)}")
    _check_one_press(path, displacement, force)
    return Trace(path.name, time, displacement, force)


def import_first(path: str | Path) -> str:
    """The end of a message about a file that is not in the form of traces: the command that brings it there."""
    return f"; import it first: dummydesign import {shlex.quote(str(path))}"


def _read_columns(path: Path, text: str) -> tuple[NDArray, list[int], bool]:
    """Return the three columns as an array (n, 3), the file line of each row, and whether time is said to be in s."""
    name = path.name
    rows = csv.reader(io.StringIO(text))
    header = [cell.strip() for cell in next(rows, [])]
    missing = [column for column in COLUMNS if column not in header]
    absent = absent_roles(header) if len(header) > 1 else ()
    if absent:
        raise InputError(f"{name}:1: {absent_words(absent, header)}")
    if missing:
        advice = _header_advice(missing[0], header) + (import_first(path) if any(header) else "")
        raise InputError(f"{name}:1: column '{missing[0]}' is missing{advice}")
    places = [header.index(column) for column in COLUMNS]
    values, lines = [], []
    for row in rows:
        if not row or all(not cell.strip() for cell in row):
            continue
        line = rows.line_num
        if len(row) <= max(places):
            raise InputError(f"{name}:{line}: has {len(row)} cells, the header has {len(header)}")
        try:
            numbers = [float(row[place]) for place in places]
        except ValueError:
            bad = next((c, row[p]) for c, p in zip(COLUMNS, places) if not _is_number(row[p]))
            raise InputError(f"{name}:{line}: {bad[0]} = '{bad[1].strip()}' is not a number (dot decimals)") from None
        if not all(np.isfinite(numbers)):
            at = int(np.argmin(np.isfinite(numbers)))
            raise InputError(f"{name}:{line}: {COLUMNS[at]} = {numbers[at]} is not finite")
        values.append(numbers)
        lines.append(line)
    return np.array(values, dtype=float).reshape(-1, 3), lines, SECONDS in header


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _header_advice(missing: str, header: list[str]) -> str:
    """Say what may stand in the header instead of the missing column."""
    if len(header) == 1 and (";" in header[0] or "\t" in header[0]):
        return "; the columns must be separated by commas"
    stem = missing.split("_")[0]
    alike = [column for column in header if column.lower().startswith(stem)]
    if alike:
        return f"; found '{alike[0]}': convert it to the unit in the name '{missing}'"
    return f"; the header must be {','.join(COLUMNS)} (found {','.join(header) or 'nothing'})"


def _check_one_press(path: Path, displacement: NDArray, force: NDArray) -> None:
    """Refuse several presses in one file: they would be read as one long hold."""
    from dummydesign.measurement.importing.press.split import find_presses

    try:
        count = len(find_presses(path.name, displacement, force - np.median(force[:3]), True))
    except InputError:
        return  # too little force to tell; whoever uses the trace says so
    if count > 1:
        raise InputError(f"{path.name}: holds {count} presses; a trace is one{import_first(path)}")


def magnitude_fault(
    time: NDArray, displacement: NDArray, force: NDArray, velocity_mm_s: float | None = None, seconds: bool = False
) -> str:
    """What can only be another unit or sign, and which one it looks like; empty where all is plausible.

    Parameters
    ----------
    time, displacement, force : ndarray, shape (n,)
        The trace, as if it were in the project's units. [s, mm, N]
    velocity_mm_s : float, optional
        Speed that was declared. [mm/s]
    seconds : bool
        Whether it was said that time is in seconds.

    Returns
    -------
    str
        A sentence for the message of an error.
    """
    sticks = pulls_more(displacement, force)
    strongest_at = int(np.argmax(force)) if sticks else int(np.argmax(np.abs(force)))
    strongest, pressed = float(np.abs(force[strongest_at])), float(displacement[strongest_at])
    deepest = float(displacement.max()) if pressed > 0 else float(np.max(np.abs(displacement)))
    step = float(np.median(np.diff(time)))
    x, f = f"largest displacement_mm = {deepest:g}", f"largest force_N = {strongest:g}"
    slow = not seconds and _milliseconds(time, displacement, velocity_mm_s)
    way, there = _deepest_loaded(displacement, np.maximum(force, 0.0) if sticks else force)
    guesses = [
        (not np.any(displacement), "displacement_mm is zero throughout"),
        (strongest == 0, "force_N is zero throughout"),
        (deepest < 0.05, f"{x} looks like metres; multiply by 1000"),
        (deepest > 300, f"{x} looks like micrometres; divide by 1000"),
        (strongest > 2000, f"{f} looks like millinewtons; divide by 1000"),
        (strongest < 0.03, f"{f} looks like kilonewtons; multiply by 1000"),
        (slow, f"time_s has steps of {step:g}; it looks like milliseconds ({MILLISECONDS})"),
        (force[strongest_at] < 0, "force_N is negative at its largest; compression must be positive"),
        (way > 0 > there, "force_N is negative where it is deepest; compression must be positive"),
        (way < 0, "displacement_mm is negative under the largest load; compression must be positive"),
        (pressed <= 0, "displacement_mm is not positive at the largest force; compression must be positive"),
    ]
    return next((message for wrong, message in guesses if wrong), "")


def _deepest_loaded(displacement: NDArray, force: NDArray) -> tuple[float, float]:
    """Displacement and force where the punch is furthest from zero under load; 0 when only single samples are there,
    as of noise on the way to a weak press."""
    loaded = np.abs(force) > LOADED * np.max(np.abs(force))
    if not loaded.any():
        return 0.0, 0.0
    far = loaded & (np.abs(displacement) >= DEEP * np.max(np.abs(displacement[loaded])))
    if far.sum() < FEW * loaded.sum():
        return 0.0, 0.0
    return float(np.median(displacement[far])), float(np.median(force[far]))


def pulls_more(displacement: NDArray, force: NDArray) -> bool:
    """Whether a sticky pad pulls harder at the lift-off than it was pressed: compression where it is deepest, and a
    larger tension elsewhere. That is data; a force of the wrong sign is tension where it is deepest.

    Parameters
    ----------
    displacement, force : ndarray, shape (n,)
        [mm, N]
    """
    largest = float(displacement.max())
    if largest <= 0.0:
        return False
    pressed = float(np.median(force[displacement >= DEEP * largest]))
    return -float(force.min()) > float(force.max()) and pressed > COMPRESSED * float(np.abs(force).max())


def _milliseconds(time: NDArray, displacement: NDArray, velocity_mm_s: float | None) -> bool:
    """Whether time counts milliseconds: coarse steps in the rise, and a second sign.

    That is the declared speed, if there is one: it agrees when the time is divided by 1000. Else a rise or a hold that
    is too slow for seconds. Coarse steps alone are usual: a quasi-static press has a sample every second or two, a
    long hold lasts for an hour.
    """
    deepest = int(np.argmax(displacement >= 0.95 * displacement.max()))
    start = int(np.argmax(displacement >= 0.05 * displacement.max()))
    rise = slice(start, deepest + 1) if deepest > start + 1 else slice(None)
    step = float(np.median(np.diff(time[rise])))
    speed = abs(float(displacement[deepest] - displacement[start])) / max(float(time[deepest] - time[start]), 1e-12)
    if velocity_mm_s is not None:
        return step >= COARSE_S and 1.0 / AGREES < 1000.0 * speed / velocity_mm_s < AGREES
    return step >= COARSE_S and (speed < SLOW_MM_S or float(time[-1] - time[0]) > LONG_S)
