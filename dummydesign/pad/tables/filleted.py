"""Slabs under a punch with a filleted edge, without finite elements: a response table for any one fillet.

Stored are solves at nodes of ln(a / h), of the fillet over the punch's radius, and of d / h. For one fillet they are
joined along the fillet (the sharp edge, from its own table, is one end) and fitted by a Chebyshev series in
sqrt(d / h) and ln(a / h): the contact rolls on to the fillet by about the root of the depth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import out_of_range
from dummydesign.core.interpolation import monotone_cubic
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS
from dummydesign.pad.tables.slab import ResponseTable, check_base, load_table

Array = np.ndarray

# Fillets over the punch's radius that are solved; a deep press under smaller ones is as uncertain as a sharp edge.
FILLETS = np.array([0.025, 0.05, 0.1, 0.2, 0.3])
TERMS = (14, 8)
# A fillet's effect vanishes with this power of it: the coordinate along it (``edge_extrapolation``).
POWER = 1.25
# Beyond this d / h few sharp solves are left, and the series of a fillet below the first node is up to 1.8 % off the
# node's own: error at the end of the table, growing from there.
FEW_FROM, FEW = 0.5, 0.02
# Relative size of the preference for low orders, which keeps the series smooth where solves ended early.
DAMPING = 1e-4


@dataclass(frozen=True)
class FilletedTable(ResponseTable):
    """Response table of one fillet; a series in sqrt(d / h), with the error of its own solves."""

    fillet: float = 0.0

    def _coordinates(self, x: Array, ratio: Array) -> tuple[Array, Array]:
        _, v = super()._coordinates(x, ratio)
        return 2.0 * np.sqrt(np.maximum(x, 0.0) / self.depth_range[1]) - 1.0, v

    def log_stiffness(self, x: ArrayLike, ratio: ArrayLike) -> tuple[Array, Array]:
        """Return ln s and its derivative with respect to x at relative depth x and a / h (broadcast)."""
        x, ratio = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(ratio, dtype=float))
        u, v = self._coordinates(x, ratio)
        series = np.polynomial.chebyshev
        slope = series.chebval2d(u, v, series.chebder(self.coefficients, axis=0))
        # du/dx; without bound at first touch, where only x du/dx = 0 counts.
        along = 1.0 / np.sqrt(np.maximum(x, 1e-12) * self.depth_range[1])
        return series.chebval2d(u, v, self.coefficients), slope * along

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        return self.solved_error(depth_mm, thickness_mm, radius_mm)


def between_fillets(data: dict[str, Any], fillet: float) -> FilletedTable:
    """The response table of one fillet from the solves of several."""
    ratios, depth = np.array(data["ratio"], dtype=float), np.array(data["depth"], dtype=float)
    value, error = (np.array(data[name], dtype=float) for name in ("value", "error"))
    sharp = load_table(data["base"])
    at = np.concatenate([[0.0], np.array(data["fillet"], dtype=float)]) ** POWER
    rows, errors = [], []
    for ratio, own, doubt in zip(ratios, value, error):
        ideal = np.where(depth <= sharp.depth_limit(ratio) * (1.0 + 1e-9), sharp.log_stiffness(depth, ratio)[0], np.nan)
        rows.append(_joined(at, np.vstack([ideal, own]), fillet**POWER))
        errors.append(_joined(at, np.vstack([sharp.relative_error(depth, 1.0, ratio), doubt]), fillet**POWER))
    values = np.array(rows)
    reach = np.array([_last_known(depth, row) for row in values])
    provenance = data.get("provenance", {})
    table = FilletedTable(
        data["base"],
        np.zeros(TERMS),
        (float(ratios[0]), float(ratios[-1])),
        (0.0, float(depth[-1])),
        ratios,
        reach,
        ratios,
        depth,
        np.zeros(values.shape),
        provenance,
        fillet,
    )
    coefficients, misfit = _series(table, values, depth)
    # What the series leaves is part of the error; beyond a solve's end the last one holds.
    total = np.nan_to_num(np.array(errors)) + np.nan_to_num(np.abs(misfit))
    if fillet < FILLETS[0]:
        total = total + np.interp(depth, [FEW_FROM, depth[-1]], [0.0, FEW])
    stated = np.maximum.accumulate(total, axis=1) + float(provenance.get("median_error", 0.0))
    return replace(table, coefficients=coefficients, error=stated)


def _joined(at: Array, rows: Array, position: float) -> Array:
    """Values (fillets, depths) at one place between the fillets; NaN where a neighbour is not known."""
    right = int(np.clip(np.searchsorted(at, position), 1, len(at) - 1))
    out = np.full(rows.shape[1], np.nan)
    known = np.isfinite(rows)
    for pattern in np.unique(known[:, known[right - 1] & known[right]], axis=1).T:
        same = (known == pattern[:, None]).all(axis=0)
        out[same] = monotone_cubic(at[pattern], rows[np.ix_(pattern, same)])(position)
    return out


def _last_known(depth: Array, row: Array) -> float:
    """Depth up to which there is a value at every depth; 0 without any."""
    count = int(np.argmin(np.append(np.isfinite(row), False)))
    return float(depth[count - 1]) if count else 0.0


def _series(table: FilletedTable, rows: Array, depth: Array) -> tuple[Array, Array]:
    """Coefficients by least squares, and what they leave of each value."""
    known = np.isfinite(rows)
    k, i = np.nonzero(known)
    u, v = table._coordinates(depth[i], table.limit_ratio[k])
    terms = (TERMS[0], min(TERMS[1], len(table.limit_ratio)))
    matrix = np.polynomial.chebyshev.chebvander2d(u, v, [terms[0] - 1, terms[1] - 1])
    order = np.add.outer(np.arange(terms[0]), np.arange(terms[1])).ravel()
    system = np.vstack([matrix, np.diag(DAMPING * 1.3**order)])
    load = np.concatenate([rows[known], np.zeros(len(order))])
    solution, *_ = np.linalg.lstsq(system, load, rcond=None)
    misfit = np.full(rows.shape, np.nan)
    misfit[known] = rows[known] - matrix @ solution
    return solution.reshape(terms), misfit


@lru_cache(maxsize=32)
def load_filleted(base: str, fillet: float) -> FilletedTable:
    """Response table of slabs under a round punch with a filleted edge."""
    check_base(base)
    if not 0.0 < fillet <= LARGEST_EDGE_RADIUS * (1.0 + 1e-9):
        raise out_of_range("edge radius over punch radius", f"{fillet:.4g}", 0.0, LARGEST_EDGE_RADIUS)
    command = "python -m studies.tables.filleted"
    name, parse = f"filleted-{base}.json", partial(between_fillets, fillet=fillet)
    return json_table.read(name, "table of filleted punches", command, parse)


def slab_table(base: str, edge_radius_mm: float, radius_mm: float) -> ResponseTable:
    """Response table of slabs under a round punch: with a sharp edge, or with the fillet it has."""
    return load_filleted(base, edge_radius_mm / radius_mm) if edge_radius_mm else load_table(base=base)
