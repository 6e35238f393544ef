"""The response tables of slabs under a sharp punch and under a fillet: force, compressibility, and error at the edge.

Of fillets are stored solves at nodes of ln(a / h), of the fillet over the punch's radius, and of d / h. For one fillet
they are joined along the fillet (the sharp edge, from its own table, is one end) and fitted by a Chebyshev series in
sqrt(d / h) and ln(a / h): the contact rolls on to the fillet by about the root of the depth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.interpolation import between, between_rows, locate_on_grid, monotone_cubic
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS
from dummydesign.geometry.interface import BASES
from dummydesign.pad.force_law import Array, ForceLaw

NAME = "slab-compressibility.json"
COMMAND = "python -m studies.tables.compressibility"


@dataclass(frozen=True, eq=False)
class CompressibilityTable:
    """c at nodes of a/h (R,) and d/h (D,); shape (R, D)."""

    ratio: NDArray
    depth: NDArray
    values: NDArray

    def coefficient(self, share: NDArray, ratio: NDArray) -> NDArray:
        """c at relative depths (T, N) and a/h (T, 1): linear in d/h and in ln a/h of ln c, constant outside."""
        low, part = locate_on_grid(np.log(self.ratio), np.log(ratio))
        logs = np.log(self.values)
        rows = (1.0 - part) * logs[low[:, 0]] + part * logs[low[:, 0] + 1]
        left, step = locate_on_grid(self.depth, share)
        first = np.take_along_axis(rows, left, axis=1)
        second = np.take_along_axis(rows, left + 1, axis=1)
        return np.exp(first + step * (second - first))


@lru_cache(maxsize=1)
def load_compressibility() -> CompressibilityTable:
    """Read the shipped table."""
    return json_table.read(NAME, "table", COMMAND, partial(fill_table, CompressibilityTable))


_RATIO = np.array([0.395, 0.527, 0.79, 1.58])
_DEPTH = np.array([0.1, 0.2, 0.3, 0.425])
_DIFFERENCE = 0.01 * np.array([[0.0, 0.3, 1.1, 1.5], [0.0, 0.3, 0.5, 1.3], [0.0, 0.3, 0.3, 0.7], [0.0, 0.3, 0.4, 0.8]])


def sharp_edge_doubt(depth: Array, ratio: Array) -> Array:
    """Relative difference to independent codes under a sharp, glued punch."""
    x, at = np.broadcast_arrays(np.asarray(depth, dtype=float), np.log(np.asarray(ratio, dtype=float)))
    slope = (_DIFFERENCE[:, -1] - _DIFFERENCE[:, -2]) / (_DEPTH[-1] - _DEPTH[-2])
    beyond = np.maximum(x - _DEPTH[-1], 0.0)
    table = np.array([np.interp(x, _DEPTH, row) + steep * beyond for row, steep in zip(_DIFFERENCE, slope)])
    return between_rows(table, np.log(_RATIO), at)


def square_doubt(depth: Array, ratio: Array) -> Array:
    """Further relative difference under a square punch: 1.4 % on a 5 mm pad at d/h 0.45; none known on thicker ones.

    It grows from nothing at d/h 0.3, and from nothing at a / h 0.79. Parameters as of :func:`sharp_edge_doubt`.
    """
    deep = np.maximum(np.asarray(depth, dtype=float) - 0.3, 0.0) / 0.15
    thin = np.clip(np.log(np.asarray(ratio, dtype=float) / _RATIO[-2]) / np.log(_RATIO[-1] / _RATIO[-2]), 0.0, 1.0)
    return 0.014 * deep * thin


def check_ratio(ratio: ArrayLike, allowed: tuple[float, float], advice: str = "") -> None:
    """Refuse punches whose radius over the thickness of the pad is outside a table's range."""
    ratio, (low, high) = np.asarray(ratio), allowed
    bad = ~((ratio >= low * (1.0 - 1e-9)) & (ratio <= high * (1.0 + 1e-9)))
    if np.any(bad):
        raise out_of_range("punch radius over pad thickness", f"{float(ratio[bad].flat[0]):.4g}", low, high, advice)


def check_base(base: str) -> None:
    """Refuse a base that slabs are not tabulated on."""
    if base not in BASES:
        message = f"base = '{base}' has no table; known are {', '.join(BASES)}; use --fidelity axisymmetric"
        raise InputError(message, "not_tabulated", "base", base, BASES)


@dataclass(frozen=True)
class SeriesTable:
    """ln of a quantity as a Chebyshev series over depth and ln(a / h), with the depth it reaches and its error.

    The reach is over ``limit_ratio``, the error over ``error_ratio`` and ``error_depth``.
    """

    base: str
    coefficients: Array
    ratio_range: tuple[float, float]
    depth_range: tuple[float, float]
    limit_ratio: Array
    limit_depth: Array
    error_ratio: Array
    error_depth: Array
    error: Array
    provenance: dict[str, Any]

    def _coordinates(self, x: Array, ratio: Array) -> tuple[Array, Array]:
        return series_place(x, ratio, self.depth_range, self.ratio_range)

    def log(self, x: ArrayLike, ratio: ArrayLike) -> Array:
        """ln of the quantity at depth x and a / h (broadcast)."""
        x, ratio = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(ratio, dtype=float))
        return np.polynomial.chebyshev.chebval2d(*self._coordinates(x, ratio), self.coefficients)

    def depth_limit(self, ratio: ArrayLike) -> Array:
        """Largest valid depth at a / h."""
        return np.interp(np.log(ratio), np.log(self.limit_ratio), self.limit_depth)

    def error_at(self, x: Array, ratio: Array) -> Array:
        """Relative error of elements and interpolation at depth x and a / h of one shape."""
        return between(x, np.log(ratio), self.error_depth, np.log(self.error_ratio), self.error)


def series_place(
    x: Array, ratio: Array, depth_range: tuple[float, float], ratio_range: tuple[float, float]
) -> tuple[Array, Array]:
    """Depth and ln(a / h) on the scale from -1 to 1 of a series."""
    (start, stop), (low, high) = depth_range, np.log(ratio_range)
    return 2.0 * (x - start) / (stop - start) - 1.0, 2.0 * (np.log(ratio) - low) / (high - low) - 1.0


@dataclass(frozen=True)
class ResponseTable(SeriesTable, ForceLaw):
    """Force law of slabs on one kind of base, glued to a round flat punch: ln of F / (E a d) over d / h."""

    def _ratio(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        ratio = np.asarray(radius_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        check_ratio(ratio, self.ratio_range, "use --fidelity axisymmetric outside the table")
        return ratio

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Static force, NaN beyond the table. [N]"""
        ratio = self._ratio(thickness_mm, radius_mm)
        depth, radius = np.asarray(depth_mm, dtype=float), np.asarray(radius_mm, dtype=float)
        x = depth / np.asarray(thickness_mm, dtype=float)
        unit = np.asarray(young_MPa, dtype=float) * radius * np.exp(self.log(np.clip(x, *self.depth_range), ratio))
        return unit * np.maximum(depth, 0.0) * np.where(x > self.depth_limit(ratio) * (1.0 + 1e-9), np.nan, 1.0)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Largest valid depth. [mm]"""
        return self.depth_limit(self._ratio(thickness_mm, radius_mm)) * np.asarray(thickness_mm, dtype=float)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force: elements plus interpolation, or what independent solutions differ by; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        ratio = self._ratio(thickness_mm, radius_mm)
        x = np.asarray(depth_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        return np.maximum(self.solved_error(depth_mm, thickness_mm, radius_mm), sharp_edge_doubt(x, ratio))

    def solved_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Relative error of elements and interpolation alone: what a solve made now may differ by from the table."""
        x = np.asarray(depth_mm, float) / np.asarray(thickness_mm, float)
        return self.error_at(*np.broadcast_arrays(x, self._ratio(thickness_mm, radius_mm)))


@lru_cache(maxsize=4)
def load_table(base: str = "bonded") -> ResponseTable:
    """Read a shipped table.

    Examples
    --------
    Force of a 12 mm slab of 25 kPa, 1 and 2 mm under a round punch of 28 mm:

    >>> load_table("bonded").force([1.0, 2.0], 12.0, 0.025, 14.0).round(2).tolist()
    [4.95, 10.74]
    """
    check_base(base)
    return _read(base, partial(fill_table, ResponseTable))


@lru_cache(maxsize=2)
def load_edge_correction(base: str) -> Array:
    """Read the factors by which a shipped table's values with a rim were carried to the sharp edge."""
    return _read(base, lambda data: np.array(data["correction"], dtype=float))


def _read(base: str, parse: Callable[[dict[str, Any]], Any]) -> Any:
    command = "python -m studies.tables.slab"
    return json_table.read(f"slab-{base}.json", "response table", command, parse)


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

    def _coordinates(self, x: Array, ratio: Array) -> tuple[Array, Array]:
        _, v = super()._coordinates(x, ratio)
        return 2.0 * np.sqrt(np.maximum(x, 0.0) / self.depth_range[1]) - 1.0, v

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
        ideal = np.where(depth <= sharp.depth_limit(ratio) * (1.0 + 1e-9), sharp.log(depth, ratio), np.nan)
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
