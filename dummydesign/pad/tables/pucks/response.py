"""How much plate friction stiffens a puck: a table over friction, strain stiffening and compression.

``dummydesign.studies.tables.puck`` solves a cylinder of 50 x 30 mm (any of that shape) of one-term Ogden
solids between plates from frictionless to bonded and stores ln B, with B the force over that of the same
cylinder between frictionless plates, for which a closed form exists. B hardly depends on the law, so linear
interpolation of ln B is good to the accuracy of the solves. ``--shapes`` does the same for the other
proportions between which ``puck_proportions`` interpolates.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from dummydesign.core import json_table
from dummydesign.core.errors import out_of_range

Array = np.ndarray

DIAMETER_MM, HEIGHT_MM = 50.0, 30.0
SHAPE_STEP = 1.3
USUAL, OTHERS = "puck-50x30.json", "puck-shapes.json"
COMMAND = "python -m dummydesign.studies.tables.puck"


def grip(friction: float | Array) -> Array:
    """Friction from 0 (frictionless) to 1 (bonded): mu / (mu + 0.2), along which B varies evenly."""
    friction = np.asarray(friction, dtype=float)
    return np.where(np.isinf(friction), 1.0, friction / (np.where(np.isinf(friction), 0.0, friction) + 0.2))


def friction_of(grip_value: float) -> float:
    """Coefficient of friction of a grip; infinite when bonded."""
    return float("inf") if grip_value >= 1.0 else 0.2 * grip_value / (1.0 - grip_value)


@dataclass(frozen=True)
class PuckTable:
    """ln B on a grid of alpha, grip and compression over height."""

    radius_over_height: float
    alpha: Array
    grip: Array
    compression: Array
    log_factor: Array

    def factor(self, alpha: float, grip_value: float, compression: Array) -> Array:
        """B of one law and friction: force over that between frictionless plates.

        Parameters
        ----------
        alpha : float
            Exponent of the one-term Ogden law.
        grip_value : float
            Friction coordinate, mu / (mu + 0.2): 0 frictionless, 1 bonded.
        compression : ndarray, shape (n,)
            Over the height of the puck; values beyond the table are taken at its ends.

        Returns
        -------
        ndarray, shape (n,)
        """
        i, t = _place(self.alpha, alpha)
        j, s = _place(self.grip, grip_value)
        corner = self.log_factor[i : i + 2, j : j + 2]
        rows = (1 - t) * ((1 - s) * corner[0, 0] + s * corner[0, 1]) + t * ((1 - s) * corner[1, 0] + s * corner[1, 1])
        return np.exp(np.interp(compression, self.compression, rows))

    def check_shape(self, diameter_mm: float, height_mm: float) -> None:
        """Refuse a puck of another shape (InputError); :func:`build` makes a table for it."""
        shape = 0.5 * diameter_mm / height_mm
        if abs(shape / self.radius_over_height - 1.0) > 0.005:
            raise out_of_range("puck radius over height", shape, self.radius_over_height, self.radius_over_height)


def _place(grid: Array, value: float) -> tuple[int, float]:
    value = float(np.clip(value, grid[0], grid[-1]))
    i = int(np.clip(np.searchsorted(grid, value, side="right") - 1, 0, len(grid) - 2))
    return i, float((value - grid[i]) / (grid[i + 1] - grid[i]))


def uniaxial(alpha: float, compression: Array) -> Array:
    """Nominal stress over E of a one-term Ogden solid: 2 / (3 alpha) (l^(-alpha/2 - 1) - l^(alpha - 1))."""
    stretch = 1.0 - compression
    return 2.0 / (3.0 * alpha) * (stretch ** (-0.5 * alpha - 1.0) - stretch ** (alpha - 1.0))


@lru_cache(maxsize=1)
def load_puck_table() -> PuckTable:
    """Read the stored table of the 50 x 30 mm shape.

    Raises
    ------
    NoAnswerError
        When the file is missing or damaged.
    """
    return json_table.read(USUAL, "friction table", COMMAND, _parse)


@lru_cache(maxsize=1)
def load_shapes() -> tuple[PuckTable, ...]:
    """Read the tables of all solved proportions, by rising radius over height; see :func:`load_puck_table`."""
    command = f"{COMMAND} --shapes"
    others = json_table.read(
        OTHERS, "friction tables", command, lambda data: [_parse(one) for one in data["shapes"]]
    )
    return tuple(sorted([load_puck_table(), *others], key=lambda table: table.radius_over_height))


def _parse(data: dict[str, Any]) -> PuckTable:
    grid = [np.array(data[name], dtype=float) for name in ("alpha", "grip", "compression", "log_factor")]
    if grid[3].shape != tuple(len(axis) for axis in grid[:3]) or not np.isfinite(grid[3]).all():
        raise ValueError("values do not fill the grid")
    return PuckTable(float(data["radius_over_height"]), *grid)
