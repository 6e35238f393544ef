"""Fit a response surface to solves of many pads."""

from __future__ import annotations

import numpy as np

from dummydesign.pad.tables.crowned import Response, matern, quadratic

Array = np.ndarray


def fit(
    inputs: Array,
    values: Array,
    levels: Array,
    low: Array,
    high: Array,
    anchored: bool,
    reach: Array,
    noise: float = 3e-3,
) -> Response:
    """Fit a response surface: lengths, scale and scatter, alike for all levels, of the largest marginal likelihood."""
    from scipy.optimize import minimize

    q = 2.0 * (inputs - low) / (high - low) - 1.0
    known = np.isfinite(values)

    def parts(lengths: Array, level: int, scale: float, scatter: float) -> tuple[Array, Array, Array]:
        use = known[:, level]
        kernel = matern(q[use], q[use], lengths) * scale**2 + (noise**2 + scatter**2) * np.eye(use.sum())
        basis = quadratic(q[use])
        factor = np.linalg.cholesky(kernel)
        half, target = np.linalg.solve(factor, basis), np.linalg.solve(factor, values[use, level])
        trend, *_ = np.linalg.lstsq(half, target, rcond=None)
        return factor, trend, target - half @ trend

    chosen = np.unique(np.linspace(0, len(levels) - 1, 6).astype(int))

    def cost(log: Array) -> float:
        lengths, total = np.exp(log[:-2]), 0.0
        for level in chosen:
            factor, _, rest = parts(lengths, level, *np.exp(log[-2:]))
            total += 0.5 * rest @ rest + np.log(np.diag(factor)).sum()
        return total + 0.5 * np.sum((log[:-2] - 0.5) ** 2)

    start = np.concatenate([np.full(inputs.shape[1], np.log(2.0)), np.log([0.1, noise])])
    optimum = minimize(cost, start, method="Nelder-Mead", options={"maxiter": 300, "xatol": 0.03, "fatol": 0.5}).x
    lengths, (scale, scatter) = np.exp(optimum[:-2]), np.exp(optimum[-2:])
    trends, weights = [], np.zeros((len(levels), len(q)))
    for level in range(len(levels)):
        factor, trend, rest = parts(lengths, level, scale, scatter)
        trends.append(trend)
        weights[level, known[:, level]] = scale**2 * np.linalg.solve(factor.T, rest)
    return Response(low, high, lengths, inputs, levels, np.array(trends), weights, reach, anchored)
