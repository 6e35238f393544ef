"""Plate friction of pucks: a table of one size, and of any proportions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.user_library import fill_table

Array = np.ndarray

DIAMETER_MM, HEIGHT_MM = 50.0, 30.0
DEEPEST = 0.8  # compression over height to which the closed form is used
USUAL, OTHERS = "puck-50x30.json", "puck-shapes.json"
COMMAND = "python -m studies.tables.puck"


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

    def check_shape(self, diameter_mm: float, height_mm: float) -> None:
        """Refuse a puck of another shape (InputError); :func:`table_for` has its table."""
        shape = 0.5 * diameter_mm / height_mm
        if abs(shape / self.radius_over_height - 1.0) > 0.005:
            raise out_of_range("puck radius over height", shape, self.radius_over_height, self.radius_over_height)

    def factor(self, alpha: float, grip_value: float, compression: Array) -> Array:
        """B of one law and friction: force over that between frictionless plates."""
        i, t = _locate(self.alpha, alpha)
        j, s = _locate(self.grip, grip_value)
        corner = self.log_factor[i : i + 2, j : j + 2]
        rows = (1 - t) * ((1 - s) * corner[0, 0] + s * corner[0, 1]) + t * ((1 - s) * corner[1, 0] + s * corner[1, 1])
        return np.exp(np.interp(compression, self.compression, rows))


def _locate(grid: Array, value: float) -> tuple[int, float]:
    value = float(np.clip(value, grid[0], grid[-1]))
    i = int(np.clip(np.searchsorted(grid, value, side="right") - 1, 0, len(grid) - 2))
    return i, float((value - grid[i]) / (grid[i + 1] - grid[i]))


def uniaxial(alpha: float, compression: Array) -> Array:
    """Nominal stress over E of a one-term Ogden solid: 2 / (3 alpha) (l^(-alpha/2 - 1) - l^(alpha - 1))."""
    log = np.log1p(-compression)
    return 2.0 / (3.0 * alpha) * (np.expm1((-0.5 * alpha - 1.0) * log) - np.expm1((alpha - 1.0) * log))


@lru_cache(maxsize=1)
def load_puck_table() -> PuckTable:
    """Read the stored table of the 50 x 30 mm shape."""
    return json_table.read(USUAL, "friction table", COMMAND, partial(fill_table, PuckTable))


@lru_cache(maxsize=1)
def load_shapes() -> tuple[PuckTable, ...]:
    """Read the tables of all solved proportions, by rising radius over height; see :func:`load_puck_table`."""
    command = f"{COMMAND} --shapes"
    others = json_table.read(
        OTHERS, "friction tables", command, lambda data: [fill_table(PuckTable, one) for one in data["shapes"]]
    )
    return tuple(sorted([load_puck_table(), *others], key=lambda table: table.radius_over_height))


NEAREST = 4


def shape_range() -> tuple[float, float]:
    """Smallest and largest diameter over height for which there is a table."""
    tables = load_shapes()
    return 2.0 * tables[0].radius_over_height, 2.0 * tables[-1].radius_over_height


def table_for(diameter_mm: float, height_mm: float) -> PuckTable:
    """Friction table of one puck."""
    tables = load_shapes()
    low, high = shape_range()
    shape = 0.5 * diameter_mm / height_mm
    if not low / 2.0 * (1 - 1e-6) <= shape <= high / 2.0 * (1 + 1e-6):
        raise InputError(
            f"diameter over height = {2 * shape:.4g} is outside the allowed range {low:.3g} to {high:.3g} for which "
            "plate friction is solved; cast a puck inside it, such as the 50 x 30 mm of the pour sheet",
            "out_of_range",
            "diameter_over_height",
            2 * shape,
            (low, high),
        )
    return interpolate(tables, shape)


def interpolate(tables: tuple[PuckTable, ...], radius_over_height: float) -> PuckTable:
    """Table of one proportion from those of others, which rise in radius over height and enclose it."""
    known = np.log([table.radius_over_height for table in tables])
    position = float(np.log(radius_over_height))
    same = np.nonzero(np.abs(known - position) < 1e-4)[0]
    if same.size:
        return tables[same[0]]
    left = int(np.clip(np.searchsorted(known, position) - 1, 0, len(known) - 2))
    order = sorted(range(len(tables)), key=lambda k: abs(known[k] - position))
    reach = min(len(tables[k].compression) for k in (left, left + 1))
    first = tables[left]
    log_factor = np.zeros((*first.log_factor.shape[:2], reach))
    for column in range(reach):
        used = sorted([k for k in order if len(tables[k].compression) > column][:NEAREST])
        at = known[used]
        for k in used:
            others = at[at != known[k]]
            weight = np.prod((position - others) / (known[k] - others))
            log_factor[..., column] += weight * tables[k].log_factor[..., column]
    return PuckTable(radius_over_height, first.alpha, first.grip, first.compression[:reach], log_factor)
