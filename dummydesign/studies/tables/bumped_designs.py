"""Which bumped pads their response table is made from, and how one of them is solved: in space, under a square.

A lattice of caps is not round. To keep the table small the caps have the proportions that the mould allows at
most: feet that nearly meet (pitch 2.1 times the foot radius) and a height of 0.26 of the diameter. What is left to
choose are thickness, pitch and grade: a design point is (ln h/a, ln pitch/a, grade over height).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.geometry.shapes import SMALLEST_HEIGHT_MM, Bumped, Shape
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.studies.tables.shape_designs import RADIUS_MM, Design

Array = np.ndarray

FOOT_OVER_PITCH = 1.0 / 2.1
HEIGHT_OVER_FOOT = 0.52
HALF_SIDE_MM = 7.0
HALF_SLAB_MM = (75.0, 60.0)
# Lattice places beyond this distance are never touched.
FIELD_MM = 9.5
# Cells over half the punch's side of the table's solves.
COARSE = 6


def bumped(pitch_mm: float, grade_share: float) -> Bumped:
    """A field of caps of the table's proportions, as far as caps are high enough and may be touched."""
    foot = FOOT_OVER_PITCH * pitch_mm
    height = HEIGHT_OVER_FOOT * foot
    grade = grade_share * height
    reach = int(np.ceil(FIELD_MM / pitch_mm))
    if grade > 0.0:
        reach = min(reach, int(np.sqrt(max(height - SMALLEST_HEIGHT_MM, 0.0) / grade)))
    return Bumped(pitch_mm, (foot**2 + height**2) / (2.0 * height), height, grade, float(reach))


def press_field(shape: Shape, thickness_mm: float, depths: Array, cells: int) -> tuple[Array, Array, str | None]:
    """Press a pad in space with the 14 x 14 mm punch, what touches sticks.

    Parameters
    ----------
    shape : Shape
    thickness_mm : float
    depths : ndarray
        Relative depths d / h, increasing from above 0.
    cells : int
        Cells over half the punch's side.

    Returns
    -------
    depth, area : ndarray
        Relative depths that were reached and F / E there. [-, mm2]
    stop : str or None
        Why it ended early.
    """
    from dummydesign.pad.shaped.spatial import Grid, Load, shaped_problem
    from dummydesign.pad.solve.continuation import follow

    h = thickness_mm
    load = Load(
        shape, h, (HALF_SIDE_MM / h,) * 2, tuple(half / h for half in HALF_SLAB_MM), False, (0.0, 0.0), "bonded",
        "bonded", 0.5, float(depths[0]),
    )  # fmt: skip
    grid = Grid(cells, slope=1.0, height_growth=2.0) if cells <= COARSE else Grid(cells, slope=0.8, height_growth=1.7)
    path = follow(shaped_problem(load, Yeoh(1.0), grid), depths, 0.25 * depths[0], 0.05 * load.scale, depths[0] / 256.0)
    return path.depth, load.multiplicity * path.force / 3.0 * h**2, path.stop


@dataclass(frozen=True)
class BumpedDesign(Design):
    """Ranges and depths of bumped pads; ``cells`` are those over half the punch's side."""

    def shape(self, point: Array) -> tuple[Bumped, float]:
        """Shape and thickness [mm] of a point."""
        return bumped(float(RADIUS_MM * np.exp(point[1])), float(point[2])), float(RADIUS_MM * np.exp(point[0]))

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad under the 14 x 14 mm punch; ``finer`` takes smaller cells.

        Returns
        -------
        dict
            ``point``; ``force``: F / (E a^2), a of the circle of the punch's area; ``stop``.
        """
        shape, h = self.shape(point)
        _, area, stop = press_field(shape, h, self.depths, round(1.4 * self.cells) if finer else self.cells)
        force = area / RADIUS_MM**2
        return {
            "point": [float(x) for x in point],
            "force": [[float(f"{value:.7g}") for value in force]],
            "stop": [stop],
        }


BUMPED = BumpedDesign(
    "bumped", np.array([np.log(0.48), np.log(0.5), 0.04]), np.array([np.log(2.2), np.log(0.92), 0.66]),
    np.array([0.04, 0.08, 0.13, 0.2, 0.28, 0.37, 0.47]), COARSE,
)  # fmt: skip
