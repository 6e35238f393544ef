"""A smooth response surface over a few shape numbers: a regression on a kernel at each of several depths.

At every level of depth a quantity y is a quadratic polynomial of the scaled inputs plus a sum of Matern kernels
(nu = 5/2) at the solved points [1]; between levels a natural cubic spline in sqrt(depth) joins the values.
Evaluated with matrix products alone.

References
----------
.. [1] C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006, ch. 2, 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

Array = np.ndarray
PORTION = 512
ROOT = 5.0**0.5


def quadratic(q: Array) -> Array:
    """Columns 1, q_i, q_i q_j of points (n, k)."""
    k = q.shape[1]
    columns = [np.ones(len(q)), *q.T, *(q[:, i] * q[:, j] for i in range(k) for j in range(i, k))]
    return np.stack(columns, axis=1)


def matern(first: Array, second: Array, lengths: Array) -> Array:
    """Matern kernel (nu = 5/2) between two sets of points of scaled inputs."""
    square = _squares(first * (ROOT / lengths), second * (ROOT / lengths))
    np.maximum(square, 0.0, out=square)
    distance = np.sqrt(square)
    square /= 3.0
    square += distance
    square += 1.0
    np.negative(distance, out=distance)
    np.exp(distance, out=distance)
    square *= distance
    return square


def _squares(a: Array, b: Array) -> Array:
    """Squared distances between points (n, k) and (m, k); a little below 0 by rounding where they agree."""
    one, other = np.ones((len(a), 1)), np.ones((len(b), 1))
    ahead = np.hstack([-2.0 * a, (a**2).sum(1)[:, None], one])
    return ahead @ np.hstack([b, other, (b**2).sum(1)[:, None]]).T


def _parts(count: int) -> list[slice]:
    """Rows in portions whose kernels stay in the processor's cache."""
    return [slice(start, start + PORTION) for start in range(0, count, PORTION)]


def fade(x: Array, start: Array | float, end: Array | float) -> tuple[Array, Array]:
    """Share from 0 at ``start`` to 1 at ``end``, and its derivative."""
    t = np.clip((x - start) / (end - start), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / (end - start)


@dataclass(frozen=True)
class Response:
    """A response surface over k inputs and depth."""

    low: Array
    high: Array
    lengths: Array
    centres: Array
    levels: Array
    trend: Array
    weights: Array
    reach: Array
    anchored: bool

    def scaled(self, inputs: Array) -> Array:
        """Inputs (n, k) on the scale from -1 to 1."""
        return 2.0 * (inputs - self.low) / (self.high - self.low) - 1.0

    def at_levels(self, inputs: Array) -> Array:
        """y of inputs (n, k) at all levels, shape (n, m)."""
        q, centres = self.scaled(inputs), self.scaled(self.centres)
        y = quadratic(q) @ self.trend.T
        for part in _parts(len(q)):
            y[part] += matern(q[part], centres, self.lengths) @ self.weights.T
        return y

    def limit(self, inputs: Array) -> Array:
        """d / h to which inputs (n, k) may be trusted: mean of the reach near by, weights inverse distance^4."""
        q, centres = self.scaled(inputs) / self.lengths, self.scaled(self.centres) / self.lengths
        limits = np.empty(len(q))
        for part in _parts(len(q)):
            weight = _squares(q[part], centres)
            np.maximum(weight, 0.0, out=weight)
            weight += 1e-6
            weight *= weight
            np.reciprocal(weight, out=weight)
            limits[part] = weight @ self.reach / weight.sum(1)
        return limits

    @cached_property
    def _knots(self) -> Array:
        return np.sqrt(np.concatenate([[0.0], self.levels]) if self.anchored else self.levels)

    @cached_property
    def _bend(self) -> Array:
        """Matrix from values at the knots to second derivatives of the natural cubic spline."""
        t = self._knots
        step = np.diff(t)
        left, right = np.eye(len(t)), np.zeros((len(t), len(t)))
        for i in range(1, len(t) - 1):
            left[i, i - 1 : i + 2] = step[i - 1], 2.0 * (step[i - 1] + step[i]), step[i]
            right[i, i - 1 : i + 2] = 6.0 / step[i - 1], -6.0 / step[i - 1] - 6.0 / step[i], 6.0 / step[i]
        return np.linalg.solve(left, right)

    def along(self, rows: Array, row: Array, depth: Array) -> tuple[Array, Array]:
        """Spline in sqrt(depth) through rows of values at the levels."""
        values = np.concatenate([np.zeros((len(rows), 1)), rows], axis=1) if self.anchored else rows
        bend = values @ self._bend.T
        t = self._knots
        at = np.clip(np.sqrt(np.maximum(depth, 0.0)), t[0], t[-1])
        i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
        h = t[i + 1] - t[i]
        b = (at - t[i]) / h
        a = 1.0 - b
        y0, y1, m0, m1 = values[row, i], values[row, i + 1], bend[row, i], bend[row, i + 1]
        value = a * y0 + b * y1 + ((a**3 - a) * m0 + (b**3 - b) * m1) * h**2 / 6.0
        slope = (y1 - y0) / h + ((1.0 - 3.0 * a**2) * m0 + (3.0 * b**2 - 1.0) * m1) * h / 6.0
        # Held before the first knot and beyond the last.
        asked = np.sqrt(depth)
        return value, np.where((asked < t[0]) | (asked > t[-1]), 0.0, slope)
