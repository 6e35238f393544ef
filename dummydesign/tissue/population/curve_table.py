"""A table of several people's presses: one row a sample, read and checked with file and line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.tissue.population.cells import read_cells

COLUMNS = ("subject", "velocity_mm_s", "time_s", "depth_mm", "force_N")
FEWEST, HELD_S = 10, 0.5
CONTRADICTION = 1.5
"""Forces of one person at one depth and speed that differ by more than this factor contradict each other."""
SAME_SPEED = 1.05


@dataclass(frozen=True)
class Curve:
    """One press of one person: the line it begins at, and arrays of shape (n,)."""

    subject: str
    velocity_mm_s: float
    line: int
    time_s: NDArray
    depth_mm: NDArray
    force_N: NDArray

    @property
    def held_s(self) -> float:
        """Time after the depth has come within 1 % of its largest. [s]"""
        deep = np.nonzero(self.depth_mm >= 0.99 * self.depth_mm.max())[0]
        return float(self.time_s[-1] - self.time_s[deep[0]])

    def rising_force_N(self, depth_mm: float) -> float:
        """Force when the depth is first reached. [N]"""
        last = int(np.argmax(self.depth_mm >= depth_mm))
        rows = slice(max(last - 1, 0), last + 1)
        return float(np.interp(depth_mm, self.depth_mm[rows], self.force_N[rows]))


def read_curves(path: Path) -> list[Curve]:
    """Read a table of curves.

    Raises
    ------
    InputError
        With file and line.
    """
    header, rows = read_cells(path, "curves", skip_space=True)
    for column in COLUMNS:
        if column not in header and column != "time_s":
            raise InputError(f"{path.name}:1: column '{column}' is missing; the header must be {','.join(COLUMNS)}")
    groups: list[tuple[str, float, int, list[list[float]]]] = []
    before: tuple[str, float, str] | None = None
    for line, row in rows:
        subject = (row["subject"] or "").strip()
        if not subject:
            raise InputError(f"{path.name}:{line}: has no subject")
        speed = _number(row, "velocity_mm_s", path, line)
        if not speed > 0.0:
            raise InputError(f"{path.name}:{line}: velocity_mm_s = {speed:g} must be above 0")
        values = [_number(row, key, path, line) for key in ("time_s", "depth_mm", "force_N")]
        here = (subject, speed, (row.get("press") or "").strip())
        back = bool(groups) and values[0] <= groups[-1][3][-1][0]
        if here != before or back:
            groups.append((subject, speed, line, []))
        groups[-1][3].append(values)
        before = here
    if not groups:
        raise InputError(f"{path.name}: holds no curve")
    return [_curve(path, *group) for group in groups]


def _number(row: dict[str, str], key: str, path: Path, line: int) -> float:
    """A cell as a number; a missing time is NaN."""
    text = (row.get(key) or "").strip()
    if not text and key == "time_s":
        return math.nan
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path.name}:{line}: {key} = '{text}' is not a number")
    return value


def _curve(path: Path, subject: str, speed: float, line: int, rows: list[list[float]]) -> Curve:
    where = f"{path.name}:{line}: subject {subject} at {speed:g} mm/s"
    if len(rows) < FEWEST:
        raise InputError(f"{where}: the curve has {len(rows)} rows; at least {FEWEST} are needed")
    time, depth, force = np.array(rows).T
    if np.isnan(time).all():
        if np.any(np.diff(depth) <= 0.0):
            raise InputError(f"{where}: without time_s the depth must rise from row to row")
        time = (depth - depth[0]) / speed
    elif np.isnan(time).any():
        raise InputError(f"{where}: time_s is given in some rows and not in others")
    if not (depth.max() > 0.05 and force.max() > 0.0):
        raise InputError(f"{where}: nothing is pressed (depth to {depth.max():g} mm, force to {force.max():g} N)")
    return Curve(subject, speed, line, time, depth, force)


def check_curves(curves: list[Curve], file: str) -> None:
    """Refuse curves of one person that contradict each other, or of which none is held.

    Raises
    ------
    InputError
        Naming the two lines and forces.
    """
    for number, first in enumerate(curves):
        for second in curves[number + 1 :]:
            slow, fast = sorted((first, second), key=lambda curve: curve.velocity_mm_s)
            depth = 0.8 * float(min(first.depth_mm.max(), second.depth_mm.max()))
            forces = slow.rising_force_N(depth), fast.rising_force_N(depth)
            ratio = forces[0] / max(forces[1], 1e-12)
            same = fast.velocity_mm_s <= SAME_SPEED * slow.velocity_mm_s
            if ratio > CONTRADICTION or (same and ratio < 1.0 / CONTRADICTION):
                why = "the same speed" if same else "the slower press carries more"
                raise InputError(
                    f"{file}: curves of {first.subject} contradict each other at {depth:.2g} mm: {forces[0]:.3g} N at "
                    f"{slow.velocity_mm_s:g} mm/s (line {slow.line}) and {forces[1]:.3g} N at "
                    f"{fast.velocity_mm_s:g} mm/s (line {fast.line}), {why}; name them as two subjects or leave one out"
                )
    if all(curve.held_s < HELD_S for curve in curves):
        raise InputError(
            f"{file}: no curve of {curves[0].subject} is held for {HELD_S:g} s, so the steady force is not known; give "
            "the hold with its times, or depths at steady forces by 'dummydesign tissues add-points'"
        )
