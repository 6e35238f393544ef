"""Fit the square-over-circle factor to solved values: a Chebyshev series at corner cell and fillet 0, with error."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from dummydesign.pad.spatial.square_punch import CORRECTION_ERROR, MESH_ERROR, RIMMED_ERROR
from studies.tables.slab import RATIO_RANGE

Array = np.ndarray

DEPTH_END = 1.4
TERMS = (5, 7)
# Fillets above this are solved and kept, not fitted: the largest is up to 0.75 % off the line through the others.
LARGEST_RIM = 0.2
# Share of the fillets' correction that is doubted. On 20 mm at d/h 0.5 a line through the two smallest fillets at that
# a / h alone ends 1.5 % below the series, which corrects the smallest by 1.7 %.
RIM_DOUBT = 1.0


@dataclass(frozen=True)
class Values:
    """Solved factors: combined depth, a / h, corner cell, fillet (0: sharp edge), factor; arrays of one length."""

    depth: Array
    ratio: Array
    corner: Array
    rim: Array
    factor: Array

    @staticmethod
    def joined(parts: list[Values]) -> Values:
        """All parts one after the other."""
        return Values(*(np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Values)))

    @staticmethod
    def read(lists: dict[str, list[float]]) -> Values:
        """From the lists of a file; without ``rim`` all edges are sharp."""
        lists = {"rim": [0.0] * len(lists["factor"]), **lists}
        return Values(*(np.array(lists[item.name], dtype=float) for item in fields(Values)))

    def where(self, chosen: Array) -> Values:
        """Those that are chosen."""
        return Values(*(getattr(self, item.name)[chosen] for item in fields(self)))

    def lists(self) -> dict[str, list[float]]:
        """For a file."""
        return {item.name: [short(v, 7) for v in getattr(self, item.name)] for item in fields(self)}


def columns(values: Values) -> tuple[Array, Array]:
    """Columns of the series and of the corrections for corner cell and fillet."""
    u = 2.0 * values.depth / DEPTH_END - 1.0
    low, high = np.log(RATIO_RANGE)
    v = 2.0 * (np.log(values.ratio) - low) / (high - low) - 1.0
    series = np.polynomial.chebyshev.chebvander2d(u, v, [TERMS[0] - 1, TERMS[1] - 1])
    turn, gentle = np.polynomial.chebyshev.chebvander(v, 3), np.polynomial.chebyshev.chebvander(v, 2)
    corner = np.where(values.rim > 0.0, 0.0, values.corner)[:, None]
    rim, depth = values.rim[:, None], values.depth[:, None]
    return series, np.concatenate([corner * turn, corner * depth * turn, rim * gentle, rim * depth * gentle], axis=1)


def fit(values: Values) -> tuple[Array, Array, Array]:
    """Fit ln factor = series(depth, ln a/h) + corrections; coefficients, those of the corrections, misfit."""
    series, correction = columns(values)
    matrix = np.concatenate([series, correction], axis=1)
    expected = np.where(values.rim > 0.0, RIMMED_ERROR + 5e-3 * values.rim, MESH_ERROR + 2e-3 * values.corner)
    # Weak preference for low orders: the corner and the depth reached are linked, deep values are coarse.
    order = np.add.outer(np.arange(TERMS[0]) * 2, np.arange(TERMS[1])).ravel()
    damping = np.diag(np.concatenate([2.0 * 1.8**order, np.full(correction.shape[1], 20.0)]))
    system = np.concatenate([matrix / expected[:, None], damping])
    load = np.concatenate([np.log(values.factor) / expected, np.zeros(matrix.shape[1])])
    solution, *_ = np.linalg.lstsq(system, load, rcond=None)
    count = TERMS[0] * TERMS[1]
    return solution[:count].reshape(TERMS), solution[count:], np.log(values.factor) - matrix @ solution


def content(base: str, values: Values, extent_over_side: tuple[float, float]) -> dict[str, Any]:
    """Fit all values; return what goes into the file.

    Parameters
    ----------
    base : str
        ``bonded`` or ``sliding``.
    values : Values
        Solved factors with corner cell and edge fillet of each.
    extent_over_side : (float, float)
        Length and width of the solved block over the side of the punch, noted in the file.

    Returns
    -------
    dict
    """
    every, values = values, values.where(values.rim <= LARGEST_RIM)
    coefficients, correction, misfit = fit(values)
    ratios = np.unique(values.ratio[values.depth > 0.0])
    reach = np.minimum([values.depth[values.ratio == r].max() for r in ratios], DEPTH_END)
    depths = np.linspace(0.0, DEPTH_END, 15)
    error = [_error_row(r, depths, values, correction, misfit) for r in ratios]
    sharp = values.rim == 0.0
    return {
        "base": base,
        "meaning": "ln(force of a square over force of the circle of equal area) = Chebyshev series in "
        "(d/h) sqrt(1 + (h/a)^2) and ln(a/h); a radius of equal area, glued punch",
        "coefficients": [[short(c, 7) for c in row] for row in coefficients],
        "ratio_range": list(RATIO_RANGE),
        "depth_range": [0.0, DEPTH_END],
        "limit_ratio": [short(r) for r in ratios],
        "limit_depth": [short(r) for r in reach],
        "error_ratio": [short(r) for r in ratios],
        "error_depth": [short(d) for d in depths],
        "error": [[short(e, 3) for e in row] for row in error],
        "provenance": {
            "law": "neo-Hookean, incompressible",
            "punch": "square over round, flat, glued; sharp edge, and beyond its reach an edge with a bead; "
            "both on the same cells",
            "extent_over_side": extent_over_side,
            "corner_cells": sorted(set(values.corner[sharp].tolist())),
            "beads": sorted(set(values.rim[~sharp].tolist())),
            "values": len(misfit),
            "rms_residual": short(np.sqrt(np.mean(misfit[sharp] ** 2)), 3),
            "rms_residual_beads": short(np.sqrt(np.mean(misfit[~sharp] ** 2)), 3) if not sharp.all() else 0.0,
        },
        "values": every.lists(),
    }


def _error_row(at: float, depths: Array, values: Values, correction: Array, misfit: Array) -> list[float]:
    """Stated error at one a / h: mesh, twice the scatter near by, and a share of the finest value's correction.

    Sharp edges count as far as they reach, fillets from there on.
    """
    near = np.abs(np.log(values.ratio / at)) < 0.5
    sharp = values.rim == 0.0
    here = (values.ratio == at) & (values.depth > 0.0)
    row = []
    for depth in np.minimum(depths, values.depth[here].max()):
        deep = here & (values.depth >= depth - 1e-9)
        kind = sharp if (deep & sharp).any() else ~sharp
        # A fillet's cells are as large as itself.
        finest = float(values.corner[deep & kind].min())
        rim, doubt = (0.0, CORRECTION_ERROR) if (deep & sharp).any() else (finest, RIM_DOUBT)
        point = Values(*(np.array([x]) for x in (depth, at, finest, rim, 1.0)))
        scatter = np.sqrt(np.mean(misfit[near & kind] ** 2))
        row.append(MESH_ERROR + 2.0 * scatter + doubt * abs(float(columns(point)[1][0] @ correction)))
    return row


def short(number: float, digits: int = 6) -> float:
    """Round to significant digits."""
    return float(f"{number:.{digits}g}")
