"""Points read off a figure, or a few measured depths: reading, and reduction to one gamma1 per subject."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.tissue.population.cells import read_cells

READING_ERROR = 0.02
"""Error of a point over the largest value on its axis, when the file gives none."""


@dataclass(frozen=True)
class Steady:
    """gamma1 of one subject from its points: ln gamma1 with its deviation, and the source."""

    name: str
    log_gamma1: float
    deviation: float
    source: str
    scatter: float


def read_points(path: Path) -> list[Steady]:
    """Read points and reduce them to one gamma1 per subject.

    Raises
    ------
    InputError
        With file and line.
    """
    header, rows = read_cells(path, "points")
    for column in ("subject", "depth_mm", "force_N"):
        if column not in header:
            raise InputError(
                f"{path.name}:1: column '{column}' is missing; the header must be subject,depth_mm,force_N"
            )
    if not rows:
        raise InputError(f"{path.name}: holds no point")
    by_subject: dict[str, list[list[float]]] = {}
    for line, row in rows:
        subject = (row["subject"] or "").strip()
        if not subject:
            raise InputError(f"{path.name}:{line}: has no subject")
        by_subject.setdefault(subject, []).append(
            [_number(row, key, path, line) for key in ("depth_mm", "force_N", "depth_error_mm", "force_error_N")]
        )
    largest = np.max([point[:2] for own in by_subject.values() for point in own], axis=0)
    return [_steady(name, np.array(own), largest, path.name) for name, own in by_subject.items()]


def _number(row: dict[str, str], key: str, path: Path, line: int) -> float:
    """A cell as a number above 0; a missing error column is NaN."""
    text = (row.get(key) or "").strip()
    if not text and key.endswith(("error_mm", "error_N")):
        return math.nan
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{path.name}:{line}: {key} = '{text}' is not a number") from None
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"{path.name}:{line}: {key} = {value:g} must be above 0")
    if key == "depth_mm" and not 0.05 <= value <= 50:
        raise InputError(f"{path.name}:{line}: depth_mm = {value:g} is outside 0.05 to 50; is it in millimetres?")
    return value


def _steady(name: str, points: NDArray, largest: NDArray, file: str) -> Steady:
    """Weighted mean of ln F - 3 ln x; scatter beyond the errors widens the deviation."""
    depth, force, depth_error, force_error = points.T
    given = not np.isnan(points[:, 2:]).any()
    depth_error = np.where(np.isnan(depth_error), READING_ERROR * largest[0], depth_error)
    force_error = np.where(np.isnan(force_error), READING_ERROR * largest[1], force_error)
    logs = np.log(force) - 3.0 * np.log(depth)
    weight = 1.0 / ((force_error / force) ** 2 + (3.0 * depth_error / depth) ** 2)
    mean = float((weight * logs).sum() / weight.sum())
    scatter = 0.0
    if len(logs) > 1:
        scatter = float(np.sqrt((weight * (logs - mean) ** 2).sum() / (len(logs) - 1)))
    deviation = float(weight.sum() ** -0.5) * max(scatter, 1.0)
    errors = "own errors" if given else f"axes to {largest[0]:g} mm and {largest[1]:g} N, reading error 2 % of them"
    source = f"{file}: {len(logs)} point{'s' if len(logs) > 1 else ''} of {name}, {errors}"
    return Steady(name, mean, deviation, source, scatter)
