"""A response surface fitted level by level: one kernel, and for each level its own scatter.

Values at small depths scatter more than others (few nodes touch), and values near a bend as well; one scatter for all
levels would blur those that are known well. Lengths, scale and scatter are those of the largest marginal likelihood
[1], the quadratic trend has a wide normal prior.

References
----------
.. [1] C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006, ch. 2, 5.
"""

from __future__ import annotations

import numpy as np

from dummydesign.pad.tables.crowned import Response, matern, quadratic

Array = np.ndarray

# Standard deviation of each coefficient of the trend.
TREND = 10.0
# Levels and points that the lengths are found from.
SOME_LEVELS, SOME_POINTS = 5, 250
# Scatter and scale that each level chooses from.
SCATTERS = np.array([5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 0.016, 0.03, 0.06])
SCALES = np.array([0.5, 1.0, 2.0])


def fit_by_level(inputs: Array, values: Array, noise: Array, levels: Array, anchored: bool, reach: Array) -> Response:
    """Fit a response surface to points that do not scatter alike.

    Parameters
    ----------
    inputs : ndarray, shape (n, k)
        Solved points.
    values : ndarray, shape (n, m)
        At the levels; NaN where not known.
    noise : ndarray, shape (n, m)
        Standard deviation that is known of each value; scatter is added to it.
    levels : ndarray, shape (m,)
        Increasing depths, in a unit of the caller's choice.
    anchored : bool
        Whether y is 0 at depth 0.
    reach : ndarray, shape (n,)
        d / h to which each point was solved.
    """
    low, high = inputs.min(axis=0), inputs.max(axis=0)
    q = 2.0 * (inputs - low) / (high - low) - 1.0
    known = [np.nonzero(np.isfinite(column))[0] for column in values.T]
    lengths, scale, scatter = _lengths(q, values, noise, known)
    basis = quadratic(q)
    kernel, wide = matern(q, q, lengths), TREND**2 * basis @ basis.T
    trend, weights = np.zeros((len(levels), basis.shape[1])), np.zeros((len(levels), len(q)))
    for level, use in enumerate(known):
        choices = [(scale * part, float(s)) for part in SCALES for s in SCATTERS] if len(levels) > 1 else []
        solved = [
            _solve(kernel, wide, use, values[use, level], noise[use, level], *choice)
            for choice in choices or [(scale, scatter)]
        ]
        _, amplitude, answer = min(solved, key=lambda one: one[0])
        weights[level, use] = amplitude**2 * answer
        trend[level] = TREND**2 * basis[use].T @ answer
    return Response(low, high, lengths, inputs, levels, trend, weights, reach, anchored)


def _solve(
    kernel: Array, wide: Array, use: Array, y: Array, noise: Array, scale: float, scatter: float
) -> tuple[float, float, Array]:
    """Negative marginal likelihood, scale, and the covariance's inverse times y."""
    from scipy.linalg import cho_factor, cho_solve

    at = np.ix_(use, use)
    factor = cho_factor(kernel[at] * scale**2 + wide[at] + np.diag(noise**2 + scatter**2), lower=True)
    answer = cho_solve(factor, y)
    return float(0.5 * y @ answer + np.log(np.diag(factor[0])).sum()), scale, answer


def _lengths(q: Array, values: Array, noise: Array, known: list[Array]) -> tuple[Array, float, float]:
    """Lengths, scale and scatter, alike for all levels, by the gradient of the marginal likelihood."""
    from scipy.optimize import minimize

    k = q.shape[1]
    enough = [level for level, use in enumerate(known) if len(use) > 2 * (1 + k + k * (k + 1) // 2)]
    rng = np.random.default_rng(1)
    chosen = [enough[i] for i in np.unique(np.linspace(0, len(enough) - 1, SOME_LEVELS).astype(int))]
    some = {level: rng.permutation(known[level])[:SOME_POINTS] for level in chosen}

    def cost(log: Array) -> tuple[float, Array]:
        total, slope = 0.5 * float(np.sum((log[:k] - 0.5) ** 2)), np.zeros(k + 2)
        slope[:k] = log[:k] - 0.5
        for level, use in some.items():
            part, steep = _cost(q[use], values[use, level], noise[use, level], log)
            total, slope = total + part, slope + steep
        return total, slope

    start = np.concatenate([np.full(k, np.log(2.0)), np.log([0.3, 0.004])])
    ends = [(np.log(0.15), np.log(20.0))] * k + [(np.log(3e-3), np.log(30.0)), (np.log(3e-4), np.log(0.2))]
    optimum = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=ends, options={"maxiter": 40}).x
    return np.exp(optimum[:k]), float(np.exp(optimum[k])), float(np.exp(optimum[k + 1]))


def _cost(q: Array, y: Array, noise: Array, log: Array) -> tuple[float, Array]:
    """Negative marginal likelihood of one level and its derivatives by ln of lengths, scale and scatter."""
    from scipy.linalg import LinAlgError, cho_solve, cholesky

    k = q.shape[1]
    lengths, scale, scatter = np.exp(log[:k]), np.exp(log[k]), np.exp(log[k + 1])
    squares = [5.0 * ((q[:, None, i] - q[None, :, i]) / lengths[i]) ** 2 for i in range(k)]
    r = np.sqrt(sum(squares))
    fall = np.exp(-r)
    kernel = (1.0 + r + r * r / 3.0) * fall * scale**2
    basis = quadratic(q)
    try:
        factor = cholesky(kernel + TREND**2 * basis @ basis.T + np.diag(noise**2 + scatter**2), lower=True)
    except LinAlgError:
        return 1e9, np.zeros(k + 2)
    inverse = cho_solve((factor, True), np.eye(len(q)))
    answer = inverse @ y
    gradient = 0.5 * (inverse - np.outer(answer, answer))
    core = (1.0 + r) * fall * scale**2 / 3.0
    slopes = [(gradient * core * square).sum() for square in squares]
    slopes += [2.0 * (gradient * kernel).sum(), 2.0 * scatter**2 * np.trace(gradient)]
    return float(0.5 * y @ answer + np.log(np.diag(factor)).sum()), np.array(slopes)
