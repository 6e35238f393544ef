"""The sharp-edge limit of forces computed with small rims: one robust regression over many rims and depths.

With a fillet of radius rho at the punch edge, s = F / (E a d) is found to be below its sharp-edge value by

    ln s0 - ln s = psi (q0 + q1 w + q2 w^2) + r psi^2,   psi = rho^1.25 y^-0.6,   w = y / (1 + y)

with rho and the depth y in units of the smaller of punch radius and thickness: the exponents were read
off ladders of eight rims at a / h = 0.4 and 1, the coefficients are fitted each time together with the
limit, which is a Chebyshev series in x = d / h and, for a table, ln(a / h). The corner of a deep punch
has more than one folded state, which scatters single values by some tenths of a per cent; the regression
weighs outliers down and averages the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

LARGEST_PSI = 0.16
# Power of the rim with which its effect vanishes; from one rim to one of half the size 2^-1.25 = 0.42 of it is left.
RIM_POWER = 1.25
FIRST_TOUCH_ERROR = 2e-4
VALUE_ERROR = 1e-3
# Share of its own correction by which a value with a large rim may be off.
CORRECTION_ERROR = 0.05
# Share of the best rim's correction by which the limit may be off: from rims 0.1 to 0.025 alone it is 0.25.
LIMIT_ERROR = 0.3


def carried_on(values: Array, step: Array, share: float) -> Array:
    """Values carried on to a sharp edge by a share of the step that halving the rim made.

    Where the effect of a rim vanishes with its power p, 1 / (2^p - 1) of the step is left after the smaller rim.

    Parameters
    ----------
    values : ndarray, broadcast
        Forces with the smaller rim, or with the larger one, when the share is by one larger.
    step : ndarray, broadcast
        Logarithm of the values with the smaller rim over those with the larger one.
    share : float
        What is added of the step.
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
            close = near & (np.abs(self.samples.depth - x) <= max(0.3 * x, 0.03))
            if not close.any():
                close = near
            scatter = np.sqrt(np.mean(self.residual[close] ** 2) / close.sum())
            correction = _correction(self.samples.take(close), self.ratio_range) @ self.correction
            out[i] = VALUE_ERROR + 2.0 * scatter + LIMIT_ERROR * np.abs(correction).min()
        return out


def _coordinates(
    depth: Array, ratio: Array, depth_range: tuple[float, float], ratio_range: tuple[float, float] | None
) -> tuple[Array, Array]:
    low, high = depth_range
    u = 2.0 * (np.asarray(depth, dtype=float) - low) / (high - low) - 1.0
    if ratio_range is None:
        return u, np.zeros_like(u)
    start, stop = np.log(ratio_range)
    return u, 2.0 * (np.log(ratio) - start) / (stop - start) - 1.0


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
    """Fit the sharp-edge limit to values with rims and to the exact stiffness at first touch.

    Parameters
    ----------
    samples : Samples
        Values with rims; those with psi above 0.16 are left out.
    first_ratio, first : ndarray, shape (k,)
        a / h and s at first touch, where a sharp edge is solved directly.
    depth_range, ratio_range : (float, float)
        Ranges of the series; ``ratio_range`` None for a single a / h.
    terms : (int, int)
        Terms in depth and in ln(a / h).

    Returns
    -------
    Limit
    """
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
    weight = 1.0 / sigma
    for _ in range(15):
        system = np.concatenate([matrix * weight[:, None], damping])
        load = np.concatenate([target * weight, np.zeros(matrix.shape[1])])
        solution, *_ = np.linalg.lstsq(system, load, rcond=None)
        misfit = target - matrix @ solution
        weight = np.sqrt(np.minimum(1.0, 1.5 * sigma / np.maximum(np.abs(misfit), 1e-15))) / sigma
    count = terms[0] * terms[1]
    coefficients, misfit = solution[:count].reshape(terms), misfit[: len(samples.depth)]
    return Limit(coefficients, solution[count:], depth_range, ratio_range, samples, misfit)
