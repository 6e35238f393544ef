"""Observations of people as rows of one kind of table: curves, steady points, spring constants."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError

CURVE_COLUMNS = ("subject", "velocity_mm_s", "time_s", "depth_mm", "force_N")
FEWEST, HELD_S = 10, 0.5
CONTRADICTION = 1.5
"""Forces of one person at one depth and speed that differ by more than this factor contradict each other."""
SAME_SPEED = 1.05
POINT_COLUMNS = ("subject", "depth_mm", "force_N")
READING_ERROR = 0.02
"""Error of a point over the largest value on its axis, when the file gives none."""
DEPTHS_MM = (0.05, 50)
"""Depths of points that are believed to be in millimetres."""


@dataclass(frozen=True)
class Row:
    """A row of a table that holds something, its cells by column."""

    file: str
    line: int
    cells: dict[str, str]

    def fault(self, words: str, code: str, key: str, value: object = None, allowed: object = None) -> InputError:
        """Make the error of a cell; ``words`` follow file and line."""
        return InputError(f"{self.file}:{self.line}: {words}", code, key, value, allowed)

    def text(self, key: str) -> str:
        """Return a cell as text, empty where the table has no such column."""
        return self.cells.get(key, "")

    def subject(self) -> str:
        """Return the person's name."""
        if not self.text("subject"):
            raise self.fault("has no subject", "missing", "subject")
        return self.text("subject")

    def number(self, key: str, above_zero: bool = True, optional: bool = False) -> float:
        """Return a cell as a finite number; NaN for an empty one that is optional."""
        text = self.text(key)
        if optional and not text:
            return math.nan
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.fault(f"{key} = '{text}' is not a number", "not_a_number", key, text)
        if above_zero and not value > 0.0:
            raise self.fault(f"{key} = {value:g} must be above 0", "out_of_range", key, value)
        return value


def read_rows(path: Path, what: str, columns: Sequence[str], optional: Sequence[str] = ()) -> list[Row]:
    """Read the rows that hold something, of a table with these columns.

    A column is found by its name as given, or by what its name and unit say (``Depth (cm)`` for ``depth_mm``); numbers
    are brought to the unit of the name. Encoding, separator and decimal sign are those of the file.
    """
    from dummydesign.measurement.importing.cells import measure, parse
    from dummydesign.measurement.importing.table import read_named_table

    table = read_named_table(path, what, columns, optional)
    rows = []
    for line, cells in table.rows:
        for key, factor in table.factors.items():
            parts = measure(cells[key])
            number = parse(parts[0] if parts else cells[key], table.decimal)
            if number is not None:
                cells[key] = f"{number * factor * (parts[1].factor if parts else 1.0):.12g}"
        rows.append(Row(path.name, line, cells))
    if not rows:
        raise InputError(f"{path.name}: holds no {what}", "nothing_found", what)
    return rows


FORCES_N, STIFFEST_N_PER_MM, SOFTEST_N_PER_MM3 = (0.02, 500.0), 200.0, 1e-3
"""Largest forces that are pressed on a hand, and stiffness and gamma1 beyond any hand."""
HANDS_N_PER_MM3 = (0.02, 10.0)
"""gamma1 of hands, from the softest thenar to the stiffest finger of the library; a likely unit leads there."""
_UNITS = ("mN", "gf", "kgf", "lbf", "kN")


def force_unit_fault(depth_mm: NDArray, force_N: NDArray) -> str:
    """Say which unit forces may be in that no hand carries at its depths; empty where they may be in N."""
    from dummydesign.measurement.importing.vocabulary import find_unit

    at = int(np.argmax(force_N))
    force, depth = float(force_N[at]), float(max(depth_mm[at], 1e-9))

    def possible(newtons: float) -> bool:
        soft = newtons >= SOFTEST_N_PER_MM3 * depth**3
        return FORCES_N[0] <= newtons <= FORCES_N[1] and newtons <= STIFFEST_N_PER_MM * depth and soft

    if possible(force):
        return ""
    softest, stiffest = (gamma1 * depth**3 for gamma1 in HANDS_N_PER_MM3)
    newtons = {name: force * unit.factor for name in _UNITS if (unit := find_unit(name))}
    likely = {name: one for name, one in newtons.items() if possible(one) and softest <= one <= stiffest}
    words = f"{force:.4g} N at {depth:.3g} mm is the force of no hand"
    if not likely:
        return words
    each = ", ".join(f"{one:.3g} N if it is in {name}" for name, one in likely.items())
    return f"{words} ({each}): write the unit into the column's name, such as force_{next(iter(likely))}"


@dataclass(frozen=True, eq=False)
class ObservedCurve:
    """One press of one person: the line it begins at, and arrays of shape (n,)."""

    subject: str
    velocity_mm_s: float
    line: int
    time_s: NDArray
    depth_mm: NDArray
    force_N: NDArray

    def rising_force_N(self, depth_mm: float) -> float:
        """Force when the depth is first reached. [N]"""
        last = int(np.argmax(self.depth_mm >= depth_mm))
        rows = slice(max(last - 1, 0), last + 1)
        return float(np.interp(depth_mm, self.depth_mm[rows], self.force_N[rows]))


def read_curves(path: Path) -> list[ObservedCurve]:
    """Read a table of curves."""
    groups: list[tuple[Row, list[list[float]]]] = []
    before: tuple[str, float, str] | None = None
    for row in read_rows(path, "curves", CURVE_COLUMNS, optional=("time_s",)):
        here = row.subject(), row.number("velocity_mm_s"), row.text("press")
        values = [row.number("time_s", above_zero=False, optional=True)]
        values += [row.number(key, above_zero=False) for key in ("depth_mm", "force_N")]
        if here != before or values[0] <= groups[-1][1][-1][0]:
            groups.append((row, []))
        groups[-1][1].append(values)
        before = here
    return [_curve(*group) for group in groups]


def _curve(first: Row, rows: list[list[float]]) -> ObservedCurve:
    subject, speed = first.subject(), first.number("velocity_mm_s")
    time, depth, force = np.array(rows).T
    curve = f"subject {subject} at {speed:g} mm/s:"
    if len(rows) < FEWEST:
        words = f"{curve} the curve has {len(rows)} rows; at least {FEWEST} are needed"
        raise first.fault(words, "not_enough_data", "curves", len(rows))
    if np.isnan(time).all():
        if np.any(np.diff(depth) <= 0.0):
            raise first.fault(f"{curve} without time_s the depth must rise from row to row", "malformed", "depth_mm")
        time = (depth - depth[0]) / speed
    elif np.isnan(time).any():
        raise first.fault(f"{curve} time_s is given in some rows and not in others", "inconsistent", "time_s")
    if not (depth.max() > 0.05 and force.max() > 0.0):
        words = f"{curve} nothing is pressed (depth to {depth.max():g} mm, force to {force.max():g} N)"
        raise first.fault(words, "nothing_found", "press")
    return ObservedCurve(subject, speed, first.line, time, depth, force)


def check_curves(curves: list[ObservedCurve], file: str) -> None:
    """Refuse curves of one person that contradict each other."""
    for first, second in itertools.combinations(curves, 2):
        slow, fast = sorted((first, second), key=lambda curve: curve.velocity_mm_s)
        depth = 0.8 * float(min(first.depth_mm.max(), second.depth_mm.max()))
        forces = [slow.rising_force_N(depth), fast.rising_force_N(depth)]
        ratio = forces[0] / max(forces[1], 1e-12)
        same = fast.velocity_mm_s <= SAME_SPEED * slow.velocity_mm_s
        if ratio > CONTRADICTION or (same and ratio < 1.0 / CONTRADICTION):
            why = "the same speed" if same else "the slower press carries more"
            raise InputError(
                f"{file}: curves of {first.subject} contradict each other at {depth:.2g} mm: {forces[0]:.3g} N at "
                f"{slow.velocity_mm_s:g} mm/s (line {slow.line}) and {forces[1]:.3g} N at {fast.velocity_mm_s:g} mm/s "
                f"(line {fast.line}), {why}; name them as two subjects or leave one out",
                "inconsistent",
                "force_N",
                forces,
            )


@dataclass(frozen=True)
class SteadyPoints:
    """gamma1 of one subject from its points: ln gamma1 with its deviation, and the source."""

    name: str
    log_gamma1: float
    deviation: float
    source: str
    scatter: float


def read_points(path: Path) -> list[SteadyPoints]:
    """Read points and reduce them to one gamma1 per subject."""
    by_subject: dict[str, list[list[float]]] = {}
    for row in read_rows(path, "points", POINT_COLUMNS):
        point = [row.number(key) for key in POINT_COLUMNS[1:]]
        if not DEPTHS_MM[0] <= point[0] <= DEPTHS_MM[1]:
            words = f"depth_mm = {point[0]:g} is outside 0.05 to 50; if it is in metres, name the column depth_m"
            raise row.fault(words, "out_of_range", "depth_mm", point[0], DEPTHS_MM)
        point += [row.number(key, optional=True) for key in ("depth_error_mm", "force_error_N")]
        by_subject.setdefault(row.subject(), []).append(point)
    deepest = max((point for own in by_subject.values() for point in own), key=lambda point: point[1])
    if fault := force_unit_fault(np.array(deepest[:1]), np.array(deepest[1:2])):
        raise InputError(f"{path.name}: {fault}", "implausible_unit", "force_N", deepest[1], FORCES_N)
    largest = np.max([point[:2] for own in by_subject.values() for point in own], axis=0)
    return [_steady(name, np.array(own), largest, path.name) for name, own in by_subject.items()]


def _steady(name: str, points: NDArray, largest: NDArray, file: str) -> SteadyPoints:
    """Weighted mean of ln F - 3 ln x; scatter beyond the errors widens the deviation."""
    depth, force, depth_error, force_error = points.T
    given = not np.isnan(points[:, 2:]).any()
    depth_error = np.where(np.isnan(depth_error), READING_ERROR * largest[0], depth_error)
    force_error = np.where(np.isnan(force_error), READING_ERROR * largest[1], force_error)
    logs = np.log(force) - 3.0 * np.log(depth)
    weight = 1.0 / ((force_error / force) ** 2 + (3.0 * depth_error / depth) ** 2)
    mean = float((weight * logs).sum() / weight.sum())
    scatter = float(np.sqrt((weight * (logs - mean) ** 2).sum() / max(len(logs) - 1, 1)))
    deviation = float(weight.sum() ** -0.5) * max(scatter, 1.0)
    errors = "own errors" if given else f"axes to {largest[0]:g} mm and {largest[1]:g} N, reading error 2 % of them"
    source = f"{file}: {len(logs)} point{'s' if len(logs) > 1 else ''} of {name}, {errors}"
    return SteadyPoints(name, mean, deviation, source, scatter)
