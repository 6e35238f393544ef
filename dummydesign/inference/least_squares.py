"""Least squares in a box: by a trust region from several starts, and by Marquardt's steps from one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Model = Callable[[NDArray], tuple[NDArray, NDArray]]
"""Maps parameters (p,) to whitened residuals (n,) and their Jacobian (n, p)."""

Residual = Callable[[NDArray], NDArray]  # maps parameters (p,) to whitened residuals (n,)

LONGEST_STEP = 1.5  # largest change of a parameter, a logarithm, in one step of :func:`solve_marquardt`


@dataclass(frozen=True)
class Solution:
    """The best of several starts.

    ``parameters`` (p,), ``chi_square`` and ``agreeing``: how many of ``starts`` ended within 1e-3 of it;
    ``residual`` (n,) and ``jacobian`` (n, p) there.
    """

    parameters: NDArray
    chi_square: float
    starts: int
    agreeing: int
    residual: NDArray | None = None
    jacobian: NDArray | None = None


def solve(
    model: Model, starts: Sequence[NDArray], low: NDArray, high: NDArray, tolerance: float = 1e-9, most: int = 400
) -> Solution:
    """Minimise the sum of squares inside a box by the trust-region method of scipy, from every start."""
    results = []
    for start in starts:
        memory = _Memory(model)
        results.append(_descend(memory.residual, memory.jacobian, start, low, high, tolerance, most, "jac"))
    return _best(results)


def solve_by_differences(
    residual: Residual, starts: Sequence[NDArray], low: NDArray, high: NDArray, tolerance: float = 1e-8,
    most: int = 400, scale: NDArray | str = "jac",
) -> Solution:  # fmt: skip
    """As :func:`solve`, with the Jacobian by forward differences."""
    return _best([_descend(residual, "2-point", start, low, high, tolerance, most, scale) for start in starts])


def _descend(
    residual: Residual, jacobian: Callable[[NDArray], NDArray] | str, start: NDArray, low: NDArray, high: NDArray,
    tolerance: float, most: int, scale: NDArray | str,
) -> Any:  # fmt: skip
    from scipy.optimize import least_squares

    margin = 1e-9 * np.minimum(high - low, 1.0)
    return least_squares(
        residual, np.clip(start, low + margin, high - margin), jacobian, bounds=(low, high), method="trf",
        x_scale=scale, ftol=tolerance, xtol=tolerance, gtol=tolerance, max_nfev=most,
    )  # fmt: skip


def _best(results: list[Any]) -> Solution:
    found = min(results, key=lambda one: one.cost)
    least = 2.0 * float(found.cost)
    near = sum(bool(2.0 * one.cost <= least + max(1e-3, 1e-6 * least)) for one in results)
    return Solution(found.x, least, len(results), near, found.fun, found.jac)


class _Memory:
    """Keeps the last evaluation, because scipy asks for residual and Jacobian apart."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._at: NDArray | None = None
        self._kept: tuple[NDArray, NDArray] | None = None

    def _evaluate(self, at: NDArray) -> tuple[NDArray, NDArray]:
        if self._kept is None or self._at is None or not np.array_equal(at, self._at):
            self._at, self._kept = at.copy(), self._model(at)
        return self._kept

    def residual(self, at: NDArray) -> NDArray:
        return self._evaluate(at)[0]

    def jacobian(self, at: NDArray) -> NDArray:
        return self._evaluate(at)[1]


def solve_marquardt(
    residual: Residual, jacobian: Callable[[NDArray], NDArray], start: NDArray, low: NDArray, high: NDArray,
    fixed: Sequence[int] = (), iterations: int = 12, enough: float = 0.02, trusted: float = np.inf,
) -> NDArray:  # fmt: skip
    """Minimise the sum of squares in a box from one start, for models whose Jacobian costs many simulations.

    Levenberg-Marquardt with the parameters on a bound held there while the gradient points outward: the Jacobian
    is made once a step that is taken, the search ends at an absolute gain, and what lies on a bound lies on it
    exactly. (:func:`solve` scales steps by the distance to the box and only nears a bound.)

    References
    ----------
    Marquardt, J. Soc. Ind. Appl. Math. 11 (1963) 431.
    """
    at = np.clip(start, low, high)
    value = residual(at)
    cost, damping, columns = float(value @ value), 1e-4, None
    for _ in range(iterations):
        fresh = columns is None
        if columns is None:
            columns = jacobian(at)
            normal = columns.T @ columns
        downhill = -columns.T @ value
        held = ((at <= low + 1e-9) & (downhill < 0)) | ((at >= high - 1e-9) & (downhill > 0))
        held[list(fixed)] = True
        free = np.nonzero(~held)[0]
        before, promised = cost, 0.0
        for _attempt in range(6 if fresh else 1):
            matrix = normal[np.ix_(free, free)]
            matrix = matrix + np.diag(damping * np.diag(matrix) + 1e-10)
            step = np.zeros_like(at)
            step[free] = np.clip(np.linalg.solve(matrix, downhill[free]), -LONGEST_STEP, LONGEST_STEP)
            trial = np.clip(at + step, low, high)
            tried = residual(trial)
            new = float(tried @ tried)
            if np.isfinite(new) and new < cost:
                change = trial - at
                promised = float(2.0 * downhill @ change - change @ normal @ change)
                at, value, cost, damping = trial, tried, new, max(damping * 0.1, 1e-7)
                break
            damping *= 8.0
        gained = before - cost
        if gained < enough and fresh:
            break
        if gained < enough or gained < trusted * promised or gained <= 0.0:
            columns = None
    return at


def covariance(jacobian: NDArray) -> NDArray | None:
    """Inverse of J^T J for whitened residuals, or None when it is singular."""
    information = jacobian.T @ jacobian
    scale = np.sqrt(np.diag(information))
    if np.any(scale == 0):
        return None
    scaled = information / np.outer(scale, scale)
    if np.linalg.cond(scaled) > 1e14:
        return None
    return np.linalg.inv(scaled) / np.outer(scale, scale)
