"""A punch as it is typed: its circle of equal area, its sides, its profile."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import reading
from dummydesign.core.parsing import LENGTH, read_number

FLAT = {"square": 1, "rectangle": 2, "round": 1}
"""Sizes that each kind of flat punch has."""
FORMS = "square:SIDE, rectangle:AxB or round:DIAMETER, sizes in mm or with a unit"


def equal_area_radius_mm(text: str) -> float:
    """Radius of the circle with the area of a punch such as ``square:14``, ``rectangle:20x10``, ``round:16``."""
    name, sizes = _read(text)
    return 0.5 * sizes[0] if name == "round" else math.sqrt(sizes[0] * sizes[-1] / math.pi)


def punch_sides_mm(text: str) -> tuple[float, float] | None:
    """Sides of a square or rectangular punch; None for a round one."""
    name, sizes = _read(text)
    return None if name == "round" else (sizes[0], sizes[-1])


def _read(text: str, counts: Mapping[str, int] = FLAT, forms: str = FORMS) -> tuple[str, list[float]]:
    name, _, size = text.partition(":")
    try:
        sizes = [read_number(part, LENGTH) for part in size.split("x")]
    except InputError as problem:
        raise InputError(f"punch '{text}' is not {forms}: {problem}", "malformed", "punch", text) from None
    if counts.get(name) != len(sizes) or not all(math.isfinite(value) and value > 0 for value in sizes):
        raise InputError(f"punch '{text}' is not {forms}", "malformed", "punch", text)
    return name, sizes


Profile = tuple[tuple[float, ...], tuple[float, ...]]
"""Radii, from 0 and rising, and heights over the lowest point. [mm, mm]"""

BALL_SHARE, BALL_POINTS = 0.98, 120
"""A ball is followed to this share of its radius, by so many points."""


def read_profile(path: str | Path) -> Profile:
    """Read a punch profile: columns r_mm and z_mm, the height over its lowest point."""
    name = Path(path).name
    with reading("punch profile", path, "punch_profile"):
        rows = list(csv.DictReader(Path(path).read_text(encoding="utf-8-sig").splitlines()))
    values = []
    for line, row in enumerate(rows, start=2):
        try:
            values.append((float(row["r_mm"]), float(row["z_mm"])))
        except (KeyError, TypeError, ValueError):
            message = f"{name}:{line}: needs numbers in the columns r_mm and z_mm"
            raise InputError(message, "malformed", "punch_profile") from None
    if len(values) < 3:
        message = f"{name}: {len(values)} rows; a punch profile needs at least 3 of r_mm, z_mm"
        raise InputError(message, "not_enough_data", "punch_profile", len(values), (3, None))
    radii, heights = zip(*values)
    return radii, heights


def ball_profile(diameter_mm: float) -> Profile:
    """Radii and heights of a ball's lower half, closer together towards its side. [mm]"""
    radius = 0.5 * diameter_mm
    r = BALL_SHARE * radius * np.sin(np.linspace(0.0, 0.5 * np.pi, BALL_POINTS))
    return tuple(r.tolist()), tuple((radius - np.sqrt(radius**2 - r**2)).tolist())


PROFILE, BALL = "profile:", "ball:"


@dataclass(frozen=True)
class Punch:
    """One punch."""

    text: str
    radius_mm: float
    sides_mm: tuple[float, float] | None
    profile_mm: Profile | None = None

    @property
    def half_width_mm(self) -> float:
        """Half of its shorter side, or its radius. [mm]"""
        return 0.5 * min(self.sides_mm) if self.sides_mm else self.radius_mm

    @property
    def length_mm(self) -> float:
        """Its longer side, or its diameter. [mm]"""
        return max(self.sides_mm) if self.sides_mm else 2.0 * self.radius_mm

    @property
    def area_mm2(self) -> float:
        """Of its face. [mm2]"""
        return math.pi * self.radius_mm**2

    @property
    def square(self) -> bool:
        """Whether it is a square."""
        return self.sides_mm is not None and self.sides_mm[0] == self.sides_mm[1]


def read_punch(text: str) -> Punch:
    """Read ``square:14``, ``rectangle:20x10``, ``round:16``, ``ball:20`` or ``profile:FILE.csv``."""
    if text == "plate":
        message = f"punch 'plate' presses pucks; a pad is pressed by {FORMS}, ball:DIAMETER or profile:FILE.csv"
        raise InputError(message, "not_applicable", "punch", text)
    if not text.startswith((PROFILE, BALL)):
        return Punch(text, equal_area_radius_mm(text), punch_sides_mm(text))
    kind, _, size = text.partition(":")
    if kind == "ball":
        _, (diameter,) = _read(text, {kind: 1}, "ball:DIAMETER in mm or with a unit")
    profile = ball_profile(diameter) if kind == "ball" else read_profile(size)
    return Punch(text, float(profile[0][-1]), None, profile)
