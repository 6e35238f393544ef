"""Two layers: a design point is (ln h/a, upper layer over h, ln of the ratio of moduli)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dummydesign.geometry.shapes.layered import Layered
from studies.tables.designs.base import FLAT_DEPTHS, RADIUS_MM, THICK, Array, Design

STIFF = np.log(0.08), np.log(12.5)


@dataclass(frozen=True)
class LayeredDesign(Design):
    """Ranges and depths of layered pads."""

    kind: ClassVar[str] = "layered"
    meaning: ClassVar[str] = "ln(F / F of the slab of the upper resin) over ln h/a, top/h, ln modulus ratio and d/h"

    def shape(self, point: Array) -> tuple[Layered, float]:
        """Shape and thickness [mm] of a point."""
        h = float(RADIUS_MM * np.exp(point[0]))
        return Layered(float(point[1] * h), float(np.exp(point[2]))), h


DESIGN = LayeredDesign(np.array([THICK[0], 0.14, STIFF[0]]), np.array([THICK[1], 0.86, STIFF[1]]), FLAT_DEPTHS, 12)
