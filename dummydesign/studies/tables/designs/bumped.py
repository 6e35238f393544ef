"""Which bumped pads their response table is made from, and how one of them is solved: in space, under a square.

A lattice of caps is not round. To keep the table small the caps have the proportions that the mould allows at
most: feet that nearly meet (pitch 2.1 times the foot radius) and a height of 0.26 of the diameter. What is left to
choose are thickness, pitch and grade: a design point is (ln h/a, ln pitch/a, grade over height).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.pad.shaped.under_square import COARSE, press_field
from dummydesign.studies.tables.designs.base import RADIUS_MM, Array, Design


@dataclass(frozen=True)
class BumpedDesign(Design):
    """Ranges and depths of bumped pads; ``cells`` are those over half the punch's side."""

    kind: ClassVar[str] = "bumped"
    meaning: ClassVar[str] = (
        "ln(F / (16/9 E sqrt(R) d^1.5)) over ln h/a, ln pitch/a, grade/height and d/h; R of the caps"
    )
    punch: ClassVar[str] = "square, flat, what touches sticks, bead of 0.1, in space"
    usual: ClassVar[tuple[int, int, int]] = (30, 8, 1)

    def shape(self, point: Array) -> tuple[Bumped, float]:
        """Shape and thickness [mm] of a point."""
        pitch = float(RADIUS_MM * np.exp(point[1]))
        return Bumped.proportioned(pitch, float(point[2])), float(RADIUS_MM * np.exp(point[0]))

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad under the 14 x 14 mm punch; ``finer`` takes smaller cells.

        Returns
        -------
        dict
            ``point``; ``force``: F / (E a^2), a of the circle of the punch's area; ``stop``.
        """
        shape, h = self.shape(point)
        _, area, stop = press_field(shape, h, self.depths, round(1.4 * self.cells) if finer else self.cells)
        return self._answer(point, [area / RADIUS_MM**2], [stop])


DESIGN = BumpedDesign(
    np.array([np.log(0.48), np.log(0.5), 0.04]), np.array([np.log(2.2), np.log(0.92), 0.66]),
    np.array([0.04, 0.08, 0.13, 0.2, 0.28, 0.37, 0.47]), COARSE,
)  # fmt: skip
