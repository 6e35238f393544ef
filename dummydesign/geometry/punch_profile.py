"""Profiles of punches that are round and not flat: read from a file, or that of a ball."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError

Profile = tuple[tuple[float, ...], tuple[float, ...]]
"""Radii, from 0 and rising, and heights over the lowest point. [mm, mm]"""

BALL_SHARE, BALL_POINTS = 0.98, 120
"""A ball is followed to this share of its radius, by so many points."""


def read_profile(path: str | Path) -> Profile:
    """Read a punch profile: columns r_mm and z_mm, the height over its lowest point.

    Raises
    ------
    InputError
        For a file that cannot be read, rows without numbers, or fewer than three.
    """
    name = Path(path).name
    try:
        rows = list(csv.DictReader(Path(path).read_text(encoding="utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError) as problem:
        reason = getattr(problem, "strerror", "not UTF-8")
        raise InputError(f"punch profile '{path}' cannot be read: {reason}") from None
    values = []
    for line, row in enumerate(rows, start=2):
        try:
            values.append((float(row["r_mm"]), float(row["z_mm"])))
        except (KeyError, TypeError, ValueError):
            raise InputError(f"{name}:{line}: needs numbers in the columns r_mm and z_mm") from None
    if len(values) < 3:
        raise InputError(f"{name}: {len(values)} rows; a punch profile needs at least 3 of r_mm, z_mm")
    radii, heights = zip(*values)
    return radii, heights


def ball_profile(diameter_mm: float) -> Profile:
    """Radii and heights of a ball's lower half, closer together towards its side. [mm]"""
    radius = 0.5 * diameter_mm
    r = BALL_SHARE * radius * np.sin(np.linspace(0.0, 0.5 * np.pi, BALL_POINTS))
    return tuple(r.tolist()), tuple((radius - np.sqrt(radius**2 - r**2)).tolist())
