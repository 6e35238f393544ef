"""A punch as it is typed, with its sizes: the circle of its area, its sides, the profile of one with a shape."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dummydesign.core.errors import InputError
from dummydesign.pad.tables.punch import FORMS, equal_area_radius_mm, punch_sides_mm

PROFILE, BALL = "profile:", "ball:"


@dataclass(frozen=True)
class AskedPunch:
    """One punch.

    Attributes
    ----------
    text : str
        As typed.
    radius_mm : float
        Of the circle of its area; of a profile its largest. [mm]
    sides_mm : (float, float) or None
        Of a square or rectangle. [mm]
    profile_mm : (radii, heights) or None
        Of a punch with a shape. [mm]
    """

    text: str
    radius_mm: float
    sides_mm: tuple[float, float] | None
    profile_mm: tuple[tuple[float, ...], tuple[float, ...]] | None = None

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


def read_punch(text: str) -> AskedPunch:
    """Read ``square:14``, ``rectangle:20x10``, ``round:16``, ``ball:20`` or ``profile:FILE.csv``.

    Raises
    ------
    InputError
        For another form; plates press cylinders only.
    """
    if text == "plate":
        raise InputError(f"punch 'plate' presses pucks; a pad is pressed by {FORMS}, ball:DIAMETER or profile:FILE.csv")
    if text.startswith(PROFILE):
        from dummydesign.geometry.punch_profile import read_profile

        profile = read_profile(text[len(PROFILE) :])
        return AskedPunch(text, float(profile[0][-1]), None, profile)
    if text.startswith(BALL):
        from dummydesign.geometry.punch_profile import ball_profile

        try:
            diameter = float(text[len(BALL) :])
        except ValueError:
            diameter = math.nan
        if not (math.isfinite(diameter) and diameter > 0.0):
            raise InputError(f"punch '{text}' is not ball:DIAMETER in mm")
        profile = ball_profile(diameter)
        return AskedPunch(text, float(profile[0][-1]), None, profile)
    return AskedPunch(text, equal_area_radius_mm(text), punch_sides_mm(text))
