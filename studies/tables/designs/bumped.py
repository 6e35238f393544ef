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
from dummydesign.pad.spatial.shaped_pad import COARSE, FINER, press_field
from dummydesign.pad.tables.bumped import (
    FIRST,
    HEIGHT_OVER_PITCH,
    LATER,
    PAD_BEGINS,
    FieldResponse,
    field_inputs,
    overlap,
)
from dummydesign.pad.tables.response_surface import Response
from studies.tables.crowns.levels import fit_by_level
from studies.tables.designs.base import RADIUS_MM, Array, Design

# Load steps over the caps' height until that many of it, and over the thickness, there and beyond.
STEP_OF_CAPS, AMONG_CAPS, STEP_OF_PAD = 0.1, 1.6, (0.02, 0.025)
# Points of all kinds; more have a thickness over the punch's radius below that of this logarithm.
MIXED, THIN, MANY = 44, -0.35, 500
# Levels of depth of the pieces, over the caps' height and over the thickness.
# First levels are depths that every pad was solved at: below, only the start by Hertz is known.
OF_TOUCHED = np.array([0.1, 0.15, 0.2, 0.25, 0.3, 0.36, 0.42, 0.48])
OF_CAPS = np.array(
    [0.3, 0.36, 0.42, 0.48, 0.55, 0.62, 0.7, 0.78, 0.84, 0.9, 0.95, 1.0, 1.05, 1.1, 1.16, 1.22, 1.3]
    + [1.4, 1.5, 1.65, 1.8, 2.1, 2.5, 3.0, 3.6]
)
OF_PAD = np.array([0.15, 0.175, 0.2, 0.225, 0.25, 0.28, 0.32, 0.37, 0.42, 0.47, 0.52, 0.58])
# A level of the pad takes curves from this share of where its piece begins.
EARLIER = 0.9
# Known scatter of ln F.
NOISE = 0.003


@dataclass(frozen=True)
class BumpedDesign(Design):
    """Ranges and depths of bumped pads; ``cells`` are those over half a pitch."""

    kind: ClassVar[str] = "bumped"
    meaning: ClassVar[str] = (
        "ln(F / (16/9 E sqrt(R) d^1.5)) less ln of what punch and field overlap by (dummydesign.pad.tables.bumped), "
        "over ln h/a, ln pitch/a, grade/height and d/c or d/h; R and c of the caps"
    )
    punch: ClassVar[str] = "square, flat, what touches sticks, bead of 0.1, in space"
    cells_are: ClassVar[str] = "cells_over_half_a_pitch"
    usual: ClassVar[tuple[int, int, int]] = (60, 20, 2)
    seed: ClassVar[int] = 2311

    def shape(self, point: Array) -> tuple[Bumped, float]:
        """Shape and thickness [mm] of a point."""
        pitch = float(RADIUS_MM * np.exp(point[1]))
        return Bumped.proportioned(pitch, float(point[2])), float(RADIUS_MM * np.exp(point[0]))

    def points(self, count: int) -> Array:
        """Castable points of the Sobol sequence, shape (count, k); beyond the first 44 those of thin pads alone."""
        points = self.low + (self.high - self.low) * self._sobol()
        mixed = [point for point in points[:MANY] if self.castable(point)][: min(count, MIXED)]
        thin = [point for point in points[MANY:] if point[0] < THIN and self.castable(point)]
        return np.array((mixed + thin)[:count])

    def solve(self, point: Array, finer: bool = False) -> dict[str, Any]:
        """Solve one pad under the 14 x 14 mm punch; ``finer`` takes smaller cells.

        Returns
        -------
        dict
            ``point``; ``depth``: d / h; ``force``: F / (E a^2), a of the circle of the punch's area; ``stop``.
        """
        shape, h = self.shape(point)
        depth, area, stop = press_field(shape, h, self.solved(shape, h), FINER if finer else self.cells)
        return {**self._answer(point, [area / RADIUS_MM**2], [stop]), "depth": [float(f"{x:.7g}") for x in depth]}

    def solved(self, shape: Bumped, thickness_mm: float) -> Array:
        """Depths d / h that are solved: those of the stated errors, and steps that resolve caps first, then the pad.

        Parameters
        ----------
        shape : Bumped
        thickness_mm : float
            At the highest point. [mm]
        """
        height = shape.height_mm / thickness_mm
        among = min(STEP_OF_CAPS * height, STEP_OF_PAD[0])
        early = np.arange(among, AMONG_CAPS * height + 0.5 * among, among)
        late = np.arange(early[-1] + STEP_OF_PAD[1], self.depths[-1], STEP_OF_PAD[1])
        steps = np.concatenate([early, late])
        far = np.abs(steps[:, None] - self.depths).min(axis=1) > 0.3 * among
        return np.unique(np.concatenate([steps[far & (steps < self.depths[-1])], self.depths]))

    def surface(self, answers: list[dict[str, Any]]) -> FieldResponse:
        """In pieces, counted against what punch and field overlap by."""
        points = np.array([answer["point"] for answer in answers])
        touched, caps, pad = (np.full((len(points), len(of)), np.nan) for of in (OF_TOUCHED, OF_CAPS, OF_PAD))
        for k, (answer, point) in enumerate(zip(answers, points)):
            x, thick = np.array(answer["depth"]), float(np.exp(point[0]))
            cap = float(HEIGHT_OVER_PITCH * np.exp(point[1])) / thick
            y = self.reduced(point[None], np.array([answer["force"][0]]), x)[0]
            same = np.broadcast_to(point, (len(x), 3))
            first, later = (y - np.log(ratio) for ratio, _ in overlap(same, x * thick, FIRST, LATER))
            _read(touched[k], x / cap, first, OF_TOUCHED)
            _read(caps[k], x / cap, later, OF_CAPS)
            _read(pad[k], x, later, OF_PAD, EARLIER * max(PAD_BEGINS[0][0] * cap, PAD_BEGINS[0][1]))
        reach = self.reach(self.at_depths(answers, self.depths)[0], self.depths)

        def fitted(values: Array, levels: Array, anchored: bool) -> Response:
            return fit_by_level(field_inputs(points), values, np.full(values.shape, NOISE), levels, anchored, reach)

        pieces = (touched, OF_TOUCHED, True), (caps, OF_CAPS, False), (pad, OF_PAD, False)
        return FieldResponse(*(fitted(*piece) for piece in pieces))


def _read(row: Array, depth: Array, y: Array, levels: Array, least: float = 0.0) -> None:
    """Fill the levels that a curve holds beyond ``least``, by a spline in the square root of the depth."""
    from scipy.interpolate import CubicSpline

    use = (levels >= max(least, 0.97 * depth[0])) & (levels <= depth[-1] * (1.0 + 1e-9))
    row[use] = CubicSpline(np.sqrt(depth), y)(np.sqrt(levels[use]))


DESIGN = BumpedDesign(
    np.array([np.log(0.48), np.log(0.5), 0.04]),
    np.array([np.log(2.2), np.log(0.92), 0.66]),
    np.array([0.02, 0.04, 0.08, 0.13, 0.2, 0.28, 0.37, 0.47, 0.58]),
    COARSE,
)
