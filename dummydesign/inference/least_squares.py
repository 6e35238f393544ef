"""Trust-region least squares from several starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Model = Callable[[NDArray], tuple[NDArray, NDArray]]
"""Maps parameters (p,) to whitened residuals (n,) and their Jacobian (n, p)."""

Residual = Callable[[NDArray], NDArray]
"""Maps parameters (p,) to whitened residuals (n,)."""


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
    """Minimise the sum of squares inside a box by the trust-region method of scipy, from every start.

    Parameters
    ----------
    model : callable
        Residuals and Jacobian.
    starts : sequence of ndarray (p,)
        At least one; those on or outside the box are moved inside.
    low, high : ndarray (p,)
        The box.
    tolerance : float
        Relative tolerance on cost, step and gradient.
    most : int
        Evaluations of the residuals from each start.
    """
    results = []
    for start in starts:
        memory = _Memory(model)
        results.append(_descend(memory.residual, memory.jacobian, start, low, high, tolerance, most, "jac"))
    return _best(results)


def solve_by_differences(
    residual: Residual, starts: Sequence[NDArray], low: NDArray, high: NDArray, tolerance: float = 1e-8,
    most: int = 400, scale: NDArray | str = "jac",
) -> Solution:  # fmt: skip
    """As :func:`solve`, with the Jacobian by forward differences.

    Parameters
    ----------
    residual : callable
        Residuals.
    starts, low, high, tolerance, most
        As for :func:`solve`.
    scale : ndarray, shape (p,), or "jac"
        Usual size of a step in each parameter; by default that of the Jacobian.
    """
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
    near = sum(2.0 * one.cost <= least + max(1e-3, 1e-6 * least) for one in results)
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
