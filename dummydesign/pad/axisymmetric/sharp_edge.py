"""Force of a slab under a sharp-edged punch: the limit of small rims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.geometry.interface import BASES
from dummydesign.pad.axisymmetric.case import (
    Case,
    end_note,
    extend_path,
    first_stiffness,
    relative_depths,
    rimmed_problem,
    unsolved,
)
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.force_law import ANY_RATIO, PadCurve
from dummydesign.pad.material.hyperelastic import Array, Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath, cost, follow
from dummydesign.pad.tables.slab import ResponseTable, load_edge_correction, load_table, series_place, sharp_edge_doubt

LARGEST_PSI = 0.16
# Power of the rim with which its effect vanishes; from one rim to one of half the size 2^-1.25 = 0.42 of it is left.
RIM_POWER = 1.25
FIRST_TOUCH_ERROR = 2e-4
VALUE_ERROR = 1e-3
# Share of its own correction by which a value with a large rim may be off.
CORRECTION_ERROR = 0.05
# Share of the best rim's correction by which the limit may be off: from rims 0.1 to 0.025 alone it is 0.25.
LIMIT_ERROR = 0.3


def extrapolate_to_sharp(values: Array, step: Array, share: float) -> Array:
    """Values extrapolated to a sharp edge by a share of the step that halving the rim made.

    Where the effect of a rim vanishes with its power p, 1 / (2^p - 1) of the step is left after the smaller rim.
    """
    return values * np.exp(share * step)


@dataclass(frozen=True)
class Samples:
    """Values of s with rims: relative depth x, a / h, rim and s itself; arrays of one length."""

    depth: Array
    ratio: Array
    rim: Array
    stiffness: Array

    @property
    def scaled_depth(self) -> Array:
        """Depth over the smaller of punch radius and thickness."""
        return self.depth / np.minimum(self.ratio, 1.0)

    @property
    def psi(self) -> Array:
        """Size of the rim's effect, rho^1.25 y^-0.6."""
        return self.rim**RIM_POWER * self.scaled_depth**-0.6

    def take(self, chosen: Array) -> Samples:
        """Keep some of the values."""
        return Samples(*(values[chosen] for values in (self.depth, self.ratio, self.rim, self.stiffness)))


@dataclass(frozen=True)
class Limit:
    """ln s0 as a Chebyshev series on depth and ln(a/h) ranges, with what is needed to state its error."""

    coefficients: Array
    correction: Array
    depth_range: tuple[float, float]
    ratio_range: tuple[float, float] | None
    samples: Samples
    residual: Array

    def log_stiffness(self, depth: Array, ratio: Array) -> Array:
        """ln s0 at relative depths and a / h (broadcast)."""
        u, v = _coordinates(depth, ratio, self.depth_range, self.ratio_range)
        u, v = np.broadcast_arrays(u, v)
        return np.polynomial.chebyshev.chebval2d(u, v, self.coefficients)

    def error(self, depth: Array, ratio: float) -> Array:
        """Relative error at depths of one a / h: mesh, uncertain correction of the best rim, scatter near by."""
        depth = np.atleast_1d(np.asarray(depth, dtype=float))
        near = np.abs(np.log(self.samples.ratio / ratio)) < 0.12
        out = np.empty(len(depth))
        for i, x in enumerate(depth):
            close = near & _near(self.samples.depth, x)
            if not close.any():
                close = near
            scatter = _scatter(self.residual, close)
            correction = _correction(self.samples.take(close), self.ratio_range) @ self.correction
            out[i] = VALUE_ERROR + 2.0 * scatter + LIMIT_ERROR * np.abs(correction).min()
        return out


def _coordinates(
    depth: Array, ratio: Array, depth_range: tuple[float, float], ratio_range: tuple[float, float] | None
) -> tuple[Array, Array]:
    u, v = series_place(depth, ratio, depth_range, ratio_range or ANY_RATIO)
    return u, v if ratio_range else np.zeros_like(u)


def _correction(samples: Samples, ratio_range: tuple[float, float] | None) -> Array:
    """Columns of ln s0 - ln s."""
    y, psi = samples.scaled_depth, samples.psi
    w = y / (1.0 + y)
    _, v = _coordinates(samples.depth, samples.ratio, (0.0, 1.0), ratio_range)
    terms = np.polynomial.chebyshev.chebvander(v, 3 if ratio_range else 0)
    columns = [psi[:, None] * w[:, None] ** k * terms for k in range(3)]
    columns.append(psi[:, None] ** 2 * terms[:, :2])
    return np.concatenate(columns, axis=1)


def fit_limit(
    samples: Samples,
    first_ratio: Array,
    first: Array,
    depth_range: tuple[float, float],
    ratio_range: tuple[float, float] | None,
    terms: tuple[int, int],
) -> Limit:
    """Fit the sharp-edge limit to values with rims and to the exact stiffness at first touch."""
    samples = samples.take(samples.psi <= LARGEST_PSI)
    depth = np.concatenate([samples.depth, np.zeros(len(first))])
    ratio = np.concatenate([samples.ratio, first_ratio])
    u, v = _coordinates(depth, ratio, depth_range, ratio_range)
    series = np.polynomial.chebyshev.chebvander2d(u, v, [terms[0] - 1, terms[1] - 1])
    correction = _correction(samples, ratio_range)
    rows = np.zeros((len(depth), correction.shape[1]))
    rows[: len(correction)] = -correction
    matrix = np.concatenate([series, rows], axis=1)
    target = np.log(np.concatenate([samples.stiffness, first]))
    sigma = np.concatenate([VALUE_ERROR + CORRECTION_ERROR * samples.psi, np.full(len(first), FIRST_TOUCH_ERROR)])
    # Weak preference for low orders keeps the series smooth where few rims reach.
    order = np.add.outer(np.arange(terms[0]), np.arange(terms[1])).ravel()
    damping = np.diag(np.concatenate([0.02 * 1.6**order, np.full(correction.shape[1], 0.3)]))
    solution, misfit = _robust_fit(matrix, target, sigma, damping)
    count = terms[0] * terms[1]
    coefficients, misfit = solution[:count].reshape(terms), misfit[: len(samples.depth)]
    return Limit(coefficients, solution[count:], depth_range, ratio_range, samples, misfit)


def _robust_fit(matrix: Array, target: Array, sigma: Array, damping: Array) -> tuple[Array, Array]:
    """Damped least squares, in which values far off weigh less; the solution and what it leaves of the target."""
    weight = 1.0 / sigma
    for _ in range(15):
        system = np.concatenate([matrix * weight[:, None], damping])
        load = np.concatenate([target * weight, np.zeros(matrix.shape[1])])
        solution, *_ = np.linalg.lstsq(system, load, rcond=None)
        misfit = target - matrix @ solution
        weight = np.sqrt(np.minimum(1.0, 1.5 * sigma / np.maximum(np.abs(misfit), 1e-15))) / sigma
    return solution, misfit


@dataclass(frozen=True)
class Departure:
    """Departure of ln s0 of one slab from the response table: at first touch, and a series that vanishes there."""

    table: ResponseTable
    first: float
    coefficients: Array
    samples: Samples
    residual: Array

    def log_stiffness(self, depth: Array, ratio: Array) -> Array:
        """ln s0 at relative depths of one a / h."""
        further = _further(depth, float(self.samples.depth.max())) @ self.coefficients
        return self.table.log(depth, ratio) + self.first + further

    def error(self, depth: Array, ratio: float) -> Array:
        """Relative error: the table's own, its correction included, scatter of the rims, a share of the departure."""
        scatter = [_scatter(self.residual, _near(self.samples.depth, x)) for x in depth]
        further = _further(depth, float(self.samples.depth.max())) @ self.coefficients
        return self.table.solved_error(depth, 1.0, ratio) + 2.0 * np.array(scatter) + DEPARTURE_ERROR * np.abs(further)


def _further(depth: Array, reached: float) -> Array:
    """Columns of a departure beyond that at first touch."""
    share = depth / reached
    return share[:, None] * np.polynomial.chebyshev.chebvander(2.0 * share - 1.0, DEPARTURE_TERMS - 1)


def fit_departure(samples: Samples, first: float, table: ResponseTable) -> Departure:
    """Fit the departure from a table, whose correction carries few rims of one slab to the sharp edge."""
    samples = samples.take(samples.psi <= LARGEST_PSI)
    ratio = samples.ratio[:1]
    at_first = float(np.log(first) - table.log(0.0, ratio)[0])
    correction = _correction(samples, table.ratio_range) @ load_edge_correction(table.base)
    target = np.log(samples.stiffness) + correction - table.log(samples.depth, ratio) - at_first
    sigma = VALUE_ERROR + CORRECTION_ERROR * samples.psi
    damping = np.diag(1.6 ** np.arange(DEPARTURE_TERMS) / USUAL_DEPARTURE)
    matrix = _further(samples.depth, float(samples.depth.max()))
    coefficients, misfit = _robust_fit(matrix, target, sigma, damping)
    return Departure(table, at_first, coefficients, samples, misfit)


def _near(depth: Array, x: float) -> Array:
    """Which values are near a depth."""
    return np.abs(depth - x) <= max(0.3 * x, 0.03)


def _scatter(residual: Array, close: Array) -> float:
    """Error of the mean of the residuals that are close by; of all of them where none is."""
    chosen = residual[close] if close.any() else residual
    return float(np.sqrt(np.mean(chosen**2) / len(chosen)))


# Rims of the ladder over the smaller of punch radius and thickness, and the depth in that unit that every curve is
# solved to: over less the series has too few values with rims.
RIMS = tuple(0.1 * 0.5**k for k in range(6))
LEAST_DEPTH = 0.25
# Tangents that failed steps may cost before a rim's path ends: pads of 3.5 to 30 mm get as far as without a bound.
MOST_WASTED = 45
# A curve is solved on this many depths besides the wanted ones, and fitted by a series of this many terms.
GRID_POINTS = 12
SERIES_TERMS = 8
# A slab that its response table covers is solved with the largest rims alone: the table's correction carries them to
# the sharp edge, and a series of so many terms has what the slab departs from the table by beyond first touch, usually
# by no more than half a per cent. Outer over punch radius lies where this was tried (docs/pad.md).
RIMS_BY_TABLE, DEPARTURE_TERMS, USUAL_DEPARTURE = RIMS[:3], 3, 5e-3
# Share of a departure beyond first touch that may be the correction's error: at a / h of 1 it was all of 0.4 %.
DEPARTURE_ERROR = 0.5
EXTENTS_BY_TABLE = (6.0, 25.0)
# Where a table ends earlier, six rims are solved at whatever depth, so that a force depends little on the other depths.
REACH_OF_TABLE = 0.58
# Cells at the edge that are added where the path of the largest fillet ends early: their corner cell inverts later.
CLOSER = (1, 2)


def solve_path(case: Case, depths: Array, rim: float, resolution: Resolution) -> ForcePath:
    """Follow the slab under a punch with one fillet."""
    problem = rimmed_problem(case, rim, resolution)
    # Under a small rim the first touch is steep: steps down to a tenth of it.
    smallest = min(0.005 * case.scale, 0.1 * rim)
    return follow(problem, depths, rim, 0.05 * case.scale, smallest, most_wasted=MOST_WASTED)


def solve_rims(
    case: Case, depths: Array, rims: Sequence[float], resolution: Resolution
) -> tuple[Samples, list[ForcePath]]:
    """Solve every fillet at the depths that are large against it."""
    values, paths = [np.zeros((3, 0))], []
    for rim in rims:
        wanted = depths[depths >= 0.8 * np.sqrt(rim) * case.scale]
        if not len(wanted):
            continue
        path = solve_path(case, wanted, rim * case.scale, resolution)
        for more in CLOSER if rim == max(rims) else ():
            if path.stop is None:
                break
            closer = replace(resolution, cells=resolution.cells + more)
            other = solve_path(case, wanted, rim * case.scale, closer)
            # The reach of a curve is that of its largest fillet: where its corner cell inverts, smaller cells go on,
            # made equal where both are known.
            count = len(path.force)
            known = 0 < count < len(other.force)
            tail = other.force[count:] * path.force[-1] / other.force[count - 1] if known else np.array([])
            path = extend_path(path, other, tail)
        paths.append(path)
        stiffness = path.force / (3.0 * case.law.shear_MPa * case.radius * path.depth)
        values.append(np.stack([path.depth, np.full(len(path.depth), rim), stiffness]))
    depth, rim_of, value = np.concatenate(values, axis=1)
    return Samples(depth, np.full(len(depth), case.radius), rim_of, value), paths


def solve_curve(pad: Pad, depth_mm: Sequence[float] | Array, independent: bool = False) -> PadCurve:
    """Static force of a slab under a round, flat, sharp-edged punch at the wanted depths.

    Where the response table covers the slab, three rims and the table's correction give the limit of small rims. With
    ``independent``, and everywhere else, six rims give it and nothing of the table enters.
    """
    case, depths = Case.of(pad), relative_depths(depth_mm, pad.thickness_mm)
    table = None if independent else _table_of(case, depths)
    made = cached(
        "slab" if table is None else "slab-by-table",
        {"case": case, "depths": depths},
        lambda: _relative_curve(case, depths, table),
    )
    unit = pad.young_MPa * 1.5 / (1.0 + pad.poisson)  # E' = 3 mu of the law with this shear modulus
    depth = depths[: len(made["stiffness"])] * pad.thickness_mm
    force = unit * pad.radius_mm * depth * made["stiffness"]
    return PadCurve(depth, force, force * made["error"], made["solver"], made["notes"], force * made["own"])


def _table_of(case: Case, depths: Array) -> ResponseTable | None:
    """The response table that covers a slab to any depth, if one does."""
    low, high = EXTENTS_BY_TABLE
    plain = case.condition == "bonded" and case.poisson == 0.5 and case.law == Yeoh(case.law.shear_MPa)
    if not plain or case.base not in BASES or not low <= case.extent / case.radius <= high:
        return None
    table = load_table(case.base)
    inside = table.ratio_range[0] <= case.radius <= table.ratio_range[1]
    reach = table.depth_limit(case.radius)
    return table if inside and reach >= REACH_OF_TABLE and depths[-1] <= reach else None


def _relative_curve(case: Case, depths: Array, table: ResponseTable | None) -> dict[str, Any]:
    """s = F / (E a d) and its relative error at the first of the relative ``depths``, those that were reached."""
    deepest = max(depths[-1], LEAST_DEPTH * case.scale)
    even = deepest * np.linspace(0.0, 1.0, GRID_POINTS + 1)[1:]
    far = np.abs(even[:, None] - depths).min(axis=1) > 0.02 * deepest
    grid = np.union1d(depths, even[far])
    samples, paths = solve_rims(case, grid, RIMS if table is None else RIMS_BY_TABLE, Resolution())
    stops = [path.stop for path in paths if path.stop]
    reached = float(samples.depth.max()) if len(samples.depth) else 0.0
    if len(np.unique(samples.depth)) < 4:
        if table is not None:
            return _relative_curve(case, depths, None)
        raise unsolved("; ".join(stops[:1]) or "no depth")
    radius, first = np.array([case.radius]), first_stiffness(case)
    limit: Limit | Departure
    if table is None:
        limit = fit_limit(samples, radius, np.array([first]), (0.0, reached), None, (SERIES_TERMS, 1))
    else:
        limit = fit_departure(samples, first, table)
    notes = end_note(reached, depths[-1], stops[0]) if reached < depths[-1] * (1.0 - 1e-9) else ()
    kept = depths[depths <= reached * (1.0 + 1e-9)]
    own = limit.error(kept, case.radius)
    error = np.maximum(own, sharp_edge_doubt(kept, radius[0])) if case.condition == "bonded" else own
    stiffness = np.exp(limit.log_stiffness(kept, radius[0]))
    return {"stiffness": stiffness, "error": error, "own": own, "solver": cost(paths), "notes": notes}
