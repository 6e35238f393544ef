"""A bone: a design point is (ln h/a, height over h, ln foot/a); the dome is spherical."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dummydesign.geometry.shapes.boned import Boned
from studies.tables.designs.base import FLAT_DEPTHS, FOOT, RADIUS_MM, THICK, Array, Design


@dataclass(frozen=True)
class BonedDesign(Design):
    """Ranges and depths of boned pads."""

    kind: ClassVar[str] = "boned"
    meaning: ClassVar[str] = "ln(F / F of the slab) over ln h/a, bone height/h, ln foot/a and d/h; spherical dome"

    def shape(self, point: Array) -> tuple[Boned, float]:
        """Shape and thickness [mm] of a point."""
        h = float(RADIUS_MM * np.exp(point[0]))
        height, foot = float(point[1] * h), float(RADIUS_MM * np.exp(point[2]))
        return Boned((foot**2 + height**2) / (2.0 * height), height, foot), h


DESIGN = BonedDesign(np.array([THICK[0], 0.14, FOOT[0]]), np.array([THICK[1], 0.76, FOOT[1]]), FLAT_DEPTHS, 12)
