"""Reading of trace files, checked line by line; what a press of a hand or a pad can be, in which units."""

from __future__ import annotations

import csv
import io
import math
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import reading
from dummydesign.core.parsing import columns_in
from dummydesign.core.user_library import data_folder, fill_table, read_toml
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.plateau import time_at

COLUMNS = ("time_s", "displacement_mm", "force_N")
MOTION_COLUMNS = ("time_s", "displacement_mm")
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


@dataclass(frozen=True, eq=False)
class Trace:
    """One measured (or simulated) press; arrays of shape (n,), compression positive.

    ``commanded_speed_mm_s`` is the commanded speed, where known: a shallow press brakes from the surface on, and
    its motion does not show it.
    """

    name: str
    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    commanded_speed_mm_s: float | None = None


def read_trace(path: str | Path, velocity_mm_s: float | None = None) -> Trace:
    """Read one trace CSV with the columns time_s, displacement_mm and force_N (others are ignored).

    ``displacement_in`` and ``force_lbf`` are read where displacement_mm or force_N is absent.

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
    header, values = read_numbers(path, COLUMNS, "trace")
    if len(values) < MIN_SAMPLES:
        raise InputError(
            f"{path.name}: {len(values)} samples; at least {MIN_SAMPLES} are needed",
            "not_enough_data",
            "trace",
            len(values),
        )
    time, displacement, force = values.T
    if fault := magnitude_fault(time, displacement, force, velocity_mm_s, SECONDS in header):
        raise InputError(f"{path.name}: {fault.message}{import_first(path)}", fault.code, fault.column)
    trace = Trace(path.name, time, displacement, force)
    check_one_press(trace, import_first(path))
    return trace


def import_first(path: str | Path) -> str:
    """The end of a message about a file that is not in the form of traces: the command that brings it there."""
    return f"; import it first: dummydesign import {shlex.quote(str(path))}"


def read_numbers(path: Path, names: Sequence[str], quantity: str) -> tuple[list[str], NDArray]:
    """Read columns of a CSV file, the first of which rises: its header, and the numbers of each row that is not blank.

    A column in inches or pounds-force is read in mm or N.

    Parameters
    ----------
    path : Path
    names : sequence of str
        Columns that are needed, such as ``time_s``.
    quantity : str
        What the file is, for errors: ``trace`` or ``motion_file``.
    """
    with reading(f"{quantity.removesuffix('_file')} file", path, quantity, import_first(path)):
        text = path.read_text(encoding="utf-8-sig")
    rows = csv.reader(io.StringIO(text))
    header = [cell.strip() for cell in next(rows, [])]
    columns, sizes = columns_in(tuple(names), header)
    if missing := next((name for name, column in zip(names, columns) if column is None), ""):
        from dummydesign.measurement.importing.vocabulary import absent_roles, absent_words

        roles = [name.partition("_")[0] for name in names]
        absent = absent_roles(header, roles) if len(header) > 1 else ()
        if absent:
            raise InputError(
                f"{path.name}:1: {absent_words(absent, header, roles)}", "missing", names[roles.index(absent[0])]
            )
        advice = _header_advice(missing, header, names) + (import_first(path) if any(header) else "")
        raise InputError(f"{path.name}:1: column '{missing}' is missing{advice}", "missing", missing)
    places = [column for column in columns if column is not None]
    body = text.partition("\n")[2].rstrip("\n")
    plain = numbers_at_once(body.split("\n"), ",", places) if body and '"' not in text else None
    values: list[list[float]] = []
    lines: list[int] = [] if plain is None else list(range(2, len(plain) + 2))
    for row in rows if plain is None else ():
        if not any(cell.strip() for cell in row):
            continue
        where = f"{path.name}:{rows.line_num}"
        if quantity == "trace" and len(row) <= max(places):
            raise InputError(
                f"{where}: has {len(row)} cells, the header has {len(header)}",
                "malformed",
                "trace",
                len(row),
                len(header),
            )
        cells = (row[at] if at < len(row) else None for at in places)
        values.append([size * _number(cell, name, where) for name, cell, size in zip(names, cells, sizes)])
        lines.append(rows.line_num)
    read = np.array(values).reshape(-1, len(names)) if plain is None else plain * np.array(sizes)
    time = read[:, 0]
    for at in np.flatnonzero(np.diff(time) <= 0)[:1] + 1:
        words = f"time_s = {time[at]:g} does not increase (line before: {time[at - 1]:g})"
        raise InputError(f"{path.name}:{lines[at]}: {words}", "malformed", "time_s", float(time[at]))
    return header, read


def numbers_at_once(lines: Sequence[str], delimiter: str | None, places: Sequence[int]) -> NDArray | None:
    """Numbers of some cells of each line; None where one holds anything else: then lines are looked at one by one.

    Parameters
    ----------
    lines : sequence of str
        Rows of a table.
    delimiter : str or None
        None for spaces.
    places : sequence of int
        Cells that are read, from 0.

    Returns
    -------
    ndarray, shape (lines, places), or None
    """
    try:
        numbers = np.loadtxt(lines, delimiter=delimiter, usecols=places, comments=None, quotechar='"', ndmin=2)
    except (ValueError, IndexError):
        return None
    return numbers if len(numbers) == len(lines) and np.isfinite(numbers).all() else None


def _header_advice(missing: str, header: list[str], names: Sequence[str]) -> str:
    """What may stand in the header instead of the missing column."""
    if len(header) == 1 and (";" in header[0] or "\t" in header[0]):
        return "; the columns must be separated by commas"
    if alike := [column for column in header if column.lower().startswith(missing.split("_")[0])]:
        return f"; found '{alike[0]}': convert it to the unit in the name '{missing}'"
    return f"; the header must be {','.join(names)} (found {','.join(header) or 'nothing'})"


def _number(cell: str | None, name: str, where: str) -> float:
    """Read a cell as a finite number; None where the row ends before it."""
    try:
        number = float(cell or "")
    except ValueError:
        raise InputError(
            f"{where}: {name} = '{(cell or '').strip()}' is not a number (dot decimals)",
            "not_a_number",
            name,
            cell and cell.strip(),
        ) from None
    if not math.isfinite(number):
        raise InputError(f"{where}: {name} = {number} is not finite", "out_of_range", name, number)
    return number


def check_one_press(trace: Trace, advice: str = "") -> None:
    """Refuse several presses in one trace, which would be read as one long hold; ``advice`` ends the message."""
    from dummydesign.measurement.importing.sign_convention import find_presses, joined_cycles

    force = trace.force_N - np.median(trace.force_N[:3])
    try:
        presses = find_presses(trace.name, trace.displacement_mm, force, True)
    except InputError:
        return  # too little force to tell; whoever uses the trace reports it
    if (count := len(joined_cycles(presses, trace.time_s, trace.displacement_mm, 0.0))) > 1:
        raise InputError(f"{trace.name}: holds {count} presses; a trace is one{advice}", "malformed", "trace", count, 1)


class MagnitudeFault(NamedTuple):
    """What shows another unit or sign: code and column of the error, and the message, which begins with the column."""

    code: str
    column: str
    message: str


def magnitude_fault(
    time: NDArray, displacement: NDArray, force: NDArray, velocity_mm_s: float | None = None, seconds: bool = False
) -> MagnitudeFault | None:
    """Find what can only be another unit or sign, and which one it looks like; None where all is plausible.

    Parameters
    ----------
    time, displacement, force : ndarray, shape (n,)
        The trace, as if it were in the project's units. [s, mm, N]
    velocity_mm_s : float, optional
        Speed that was declared. [mm/s]
    seconds : bool
        Whether it was declared that time is in seconds.
    """
    sticks = pulls_more(displacement, force)
    strongest_at = int(np.argmax(force)) if sticks else int(np.argmax(np.abs(force)))
    strongest, pressed = float(np.abs(force[strongest_at])), float(displacement[strongest_at])
    deepest = float(displacement.max()) if pressed > 0 else float(np.max(np.abs(displacement)))
    step = float(np.median(np.diff(time)))
    slow = not seconds and _milliseconds(time, displacement, velocity_mm_s)
    way, there = _deepest_loaded(displacement, np.maximum(force, 0.0) if sticks else force)
    x, f, positive = "displacement_mm", "force_N", "compression must be positive"
    for wrong, code, column, words in (
        (not np.any(displacement), "nothing_found", x, "is zero throughout"),
        (strongest == 0, "nothing_found", f, "is zero throughout"),
        *_beyond(time, displacement, force, deepest, strongest, seconds),
        (slow, "implausible_unit", "time_s", f"has steps of {step:g}; it looks like milliseconds ({MILLISECONDS})"),
        (force[strongest_at] < 0, "out_of_range", f, f"is negative at its largest; {positive}"),
        (way > 0 > there, "out_of_range", f, f"is negative where it is deepest; {positive}"),
        (way < 0, "out_of_range", x, f"is negative under the largest load; {positive}"),
        (pressed <= 0, "out_of_range", x, f"is not positive at the largest force; {positive}"),
    ):
        if wrong:
            return MagnitudeFault(code, column, f"{column}{'' if words.startswith(':') else ' '}{words}")
    return None


def _beyond(
    time: NDArray, displacement: NDArray, force: NDArray, deepest: float, strongest: float, seconds: bool
) -> Iterator[tuple[bool, str, str, str]]:
    """Depth, force, speed, braking and sampling that cannot be, with the units that would make all of them usual."""
    if deepest <= 0.0 or strongest <= 0.0 or not float(displacement.max()) > 0.0:
        return
    found = {**press_quantities(time, displacement, np.abs(force)), "depth_mm": deepest, "force_N": strongest}
    if fault := impossible({key: found[key] for key in found if not (seconds and ROLE.get(key) == "time")}):
        role = ROLE[fault[0]]
        column = next(name for name in COLUMNS if name.startswith(role))
        fitting = " or ".join(units_that_fit(role, time, displacement, np.abs(force)))
        yield True, "implausible_unit", column, f": {fault[1]}{'; it may be in ' * bool(fitting)}{fitting}"


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
    larger tension elsewhere. That is data; a force of the wrong sign is tension where it is deepest."""
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


def read_motion(path: str | Path) -> Motion:
    """Read the columns time_s and displacement_mm (or displacement_in) of a CSV file; others are ignored."""
    path = Path(path)
    values = read_numbers(path, MOTION_COLUMNS, "motion_file")[1]
    if len(values) < 2:
        raise InputError(
            f"{path.name}: {len(values)} rows; a motion needs at least 2", "not_enough_data", "motion_file", len(values)
        )
    return Motion(*values.T)


def read_motion_force(path: str | Path) -> NDArray | None:
    """Read the force at the samples of a motion file, shape (n,); None where it has no such column. [N]"""
    try:
        return read_numbers(Path(path), (*MOTION_COLUMNS, "force_N"), "motion_file")[1][:, -1]
    except InputError as problem:
        if problem.code == "missing":
            return None
        raise


UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "displacement": {"mm": 1.0, "um": 1e-3, "cm": 10.0, "m": 1e3, "in": 25.4},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "gf": 9.80665e-3, "kgf": 9.80665, "lbf": 4.4482216},
}
"""Units that are proposed, in s, mm and N; 1 cN is 1.02 gf and is not proposed beside it."""
ROLE = {
    "force_N": "force",
    "depth_mm": "displacement",
    "speed_mm_s": "time",
    "stop_mm_s2": "time",
    "step_s": "time",
}
"""The column whose unit is doubted by each quantity."""
RISE, END = (0.2, 0.9), (0.88, 0.98)
"""Shares of the depth between which the speed of a press, and that at its end, are taken."""


@dataclass(frozen=True)
class Range:
    """Bounds of one quantity: of what is read, and of what is usual."""

    words: str
    unit: str
    low: float
    high: float
    usual_low: float
    usual_high: float

    def fault(self, value: float) -> str:
        """Return in words why a value cannot be; empty where it can."""
        if self.low <= value <= self.high:
            return ""
        limit = f"above {self.high:g}" if value > self.high else f"below {self.low:g}"
        return f"{self.words} would be {value:.4g} {self.unit}, {limit} {self.unit}"

    def usual(self, value: float) -> bool:
        """Whether a value is a usual one."""
        return self.usual_low <= value <= self.usual_high


@cache
def ranges() -> Mapping[str, Range]:
    """Return the bounds by quantity, from ``materials/plausible-press.toml``."""
    data, _ = read_toml(data_folder() / "materials" / "plausible-press.toml")
    return {key: fill_table(Range, row) for key, row in data.items()}


def press_quantities(time: NDArray, x: NDArray, force: NDArray) -> dict[str, float]:
    """Return force, depth, speed, braking, sampling and stiffness of a press whose zero is near contact.

    The braking is the least with which the speed between 88 and 98 % of the depth ends there: v^2 / (2 s), where the
    way s is the rest of the depth, or that of one sample.

    Parameters
    ----------
    time, x, force : ndarray, shape (n,)
        Zero near contact, compression positive. [s, mm, N]
    """
    depth, largest = float(x.max()), float(force.max())
    ends = [[time_at(time, x, share * depth) for share in part] for part in (RISE, END)]
    speed, last = ((high - low) * depth / max(b - a, 1e-12) for (low, high), (a, b) in zip((RISE, END), ends))
    top = max(int(np.argmax(x >= END[1] * depth)), 1)
    way = max((1.0 - END[1]) * depth, last * float(time[top] - time[top - 1]), 1e-12)
    return {
        "force_N": largest,
        "depth_mm": depth,
        "speed_mm_s": speed,
        "stop_mm_s2": last**2 / (2.0 * way),
        "step_s": float(np.median(np.diff(time))),
        "stiffness_N_mm": largest / max(depth, 1e-12),
    }


def impossible(quantities: Mapping[str, float]) -> tuple[str, str] | None:
    """Return the first quantity that cannot be, and why in words; None where all can."""
    for key, value in quantities.items():
        if fault := ranges()[key].fault(value):
            return key, fault
    return None


def units_that_fit(role: str, time: NDArray, x: NDArray, force: NDArray, factor: float = 1.0) -> list[str]:
    """Return the units of one column with which all quantities of the press are usual.

    Parameters
    ----------
    role : str
        ``time``, ``displacement`` or ``force``.
    time, x, force : ndarray, shape (n,)
        The press as it was read. [s, mm, N]
    factor : float
        How many s, mm or N one count of the column was taken for.
    """
    fitting = []
    for unit, size in UNITS[role].items():
        scale = {one: size / factor if one == role else 1.0 for one in UNITS}
        found = press_quantities(scale["time"] * time, scale["displacement"] * x, scale["force"] * force)
        if abs(size / factor - 1.0) > 1e-6 and all(ranges()[key].usual(value) for key, value in found.items()):
            fitting.append(unit)
    return fitting
