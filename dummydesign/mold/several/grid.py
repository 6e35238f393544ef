"""Cavities side by side in one mould: rows and columns, and how many fit the machines; no CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Grid:
    """Cavities in rows and columns; the last row may be short. [mm]"""

    count: int
    columns: int
    pitch_x_mm: float
    pitch_y_mm: float

    @property
    def rows(self) -> int:
        """Rows, the short one with them."""
        return -(-self.count // self.columns)

    @property
    def reach_mm(self) -> tuple[float, float]:
        """Distance between the middles of the outermost cavities, along and across."""
        return (self.columns - 1) * self.pitch_x_mm, (self.rows - 1) * self.pitch_y_mm

    @property
    def places_mm(self) -> tuple[tuple[float, float], ...]:
        """Middles of the cavities about the mould's middle, the front row first."""
        across, along = self.reach_mm
        return tuple(
            (i % self.columns * self.pitch_x_mm - across / 2, i // self.columns * self.pitch_y_mm - along / 2)
            for i in range(self.count)
        )


def best_grid(
    count: int, length_mm: float, width_mm: float, wall_mm: float, border_mm: float, room_mm: tuple[float, float]
) -> Grid:
    """The arrangement that fits a printer's bed, of those the one with the smallest block.

    Parameters
    ----------
    count : int
        Cavities.
    length_mm, width_mm : float
        Opening of one cavity. [mm]
    wall_mm : float
        Wall between two of them. [mm]
    border_mm : float
        Block and flange beyond the outermost openings, on one side. [mm]
    room_mm : (float, float)
        Usable bed, either way round. [mm]

    Returns
    -------
    Grid
    """

    def rank(grid: Grid) -> tuple[bool, float, int]:
        sides = sorted(reach + side + 2 * border_mm for reach, side in zip(grid.reach_mm, (length_mm, width_mm)))
        return any(side > room for side, room in zip(sides, sorted(room_mm))), math.prod(sides), grid.columns

    grids = (Grid(count, columns, length_mm + wall_mm, width_mm + wall_mm) for columns in range(1, count + 1))
    return min((grid for grid in grids if grid.rows * grid.columns - count < grid.columns), key=rank)
