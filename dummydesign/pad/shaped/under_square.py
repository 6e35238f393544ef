"""A pad of any shape under the 14 x 14 mm punch, in space: what the tables of fields of caps are made of."""

from __future__ import annotations

import numpy as np

from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH_SIDE_MM
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.spatial import Grid, Load, shaped_problem
from dummydesign.pad.solve.continuation import follow

Array = np.ndarray

HALF_SIDE_MM = 0.5 * PUNCH_SIDE_MM
HALF_SLAB_MM = (0.5 * PAD_LENGTH_MM, 0.5 * PAD_WIDTH_MM)
# Cells over half the punch's side of the table's solves.
COARSE = 6


def press_field(shape: PadShape, thickness_mm: float, depths: Array, cells: int) -> tuple[Array, Array, str | None]:
    """Press a pad in space with the 14 x 14 mm punch, what touches sticks.

    Parameters
    ----------
    shape : PadShape
        A field of caps, or any other shape.
    thickness_mm : float
        At the highest point. [mm]
    depths : ndarray, shape (n,)
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
    h = thickness_mm
    load = Load(
        shape, h, (HALF_SIDE_MM / h,) * 2, tuple(half / h for half in HALF_SLAB_MM), False, (0.0, 0.0), "bonded",
        "bonded", 0.5, float(depths[0]),
    )  # fmt: skip
    grid = Grid(cells, slope=1.0, height_growth=2.0) if cells <= COARSE else Grid(cells, slope=0.8, height_growth=1.7)
    path = follow(shaped_problem(load, Yeoh(1.0), grid), depths, 0.25 * depths[0], 0.05 * load.scale, depths[0] / 256.0)
    return path.depth, load.multiplicity * path.force / 3.0 * h**2, path.stop
