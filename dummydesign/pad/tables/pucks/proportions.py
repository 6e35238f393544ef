"""Friction tables of pucks of any proportion, interpolated between solved ones.

ln B is taken by the polynomial through the four nearest solved proportions in ln(radius / height), compression
by compression; where a flat puck's table ends early, through those that reach. A solved proportion gives its
own table. ``benchmarks/puck_shapes.py`` measures the error half-way between, ``docs/resin.md`` has the figures.
"""

from __future__ import annotations

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.pad.tables.pucks.response import PuckTable, load_shapes

NEAREST = 4


def shape_range() -> tuple[float, float]:
    """Smallest and largest diameter over height for which there is a table."""
    tables = load_shapes()
    return 2.0 * tables[0].radius_over_height, 2.0 * tables[-1].radius_over_height


def table_for(diameter_mm: float, height_mm: float) -> PuckTable:
    """Friction table of one puck.

    Parameters
    ----------
    diameter_mm, height_mm : float
        Undeformed puck, above 0. [mm]

    Raises
    ------
    InputError
        When diameter over height is outside :func:`shape_range`.
    """
    tables = load_shapes()
    low, high = shape_range()
    shape = 0.5 * diameter_mm / height_mm
    if not low / 2.0 * (1 - 1e-6) <= shape <= high / 2.0 * (1 + 1e-6):
        raise InputError(
            f"diameter over height = {2 * shape:.4g} is outside the allowed range {low:.3g} to {high:.3g} for which "
            "plate friction is solved; cast a puck inside it, such as the 50 x 30 mm of the pour sheet"
        )
    return interpolate(tables, shape)


def interpolate(tables: tuple[PuckTable, ...], radius_over_height: float) -> PuckTable:
    """Table of one proportion from those of others, which rise in radius over height and enclose it."""
    known = np.log([table.radius_over_height for table in tables])
    place = float(np.log(radius_over_height))
    same = np.nonzero(np.abs(known - place) < 1e-4)[0]
    if same.size:
        return tables[same[0]]
    left = int(np.clip(np.searchsorted(known, place) - 1, 0, len(known) - 2))
    order = sorted(range(len(tables)), key=lambda k: abs(known[k] - place))
    reach = min(len(tables[k].compression) for k in (left, left + 1))
    first = tables[left]
    log_factor = np.zeros((*first.log_factor.shape[:2], reach))
    for column in range(reach):
        used = sorted([k for k in order if len(tables[k].compression) > column][:NEAREST])
        at = known[used]
        for k in used:
            others = at[at != known[k]]
            weight = np.prod((place - others) / (known[k] - others))
            log_factor[..., column] += weight * tables[k].log_factor[..., column]
    return PuckTable(radius_over_height, first.alpha, first.grip, first.compression[:reach], log_factor)
