"""Least squares in a box; intervals by profile likelihood, and choice between nested models.

By a trust region from several starts, or by Marquardt's steps from one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Model = Callable[[NDArray], tuple[NDArray, NDArray]]
"""Maps parameters (p,) to whitened residuals (n,) and their Jacobian (n, p)."""

Residual = Callable[[NDArray], NDArray]  # maps parameters (p,) to whitened residuals (n,)

LONGEST_STEP = 1.5  # largest change of a parameter, a logarithm, in one step of :func:`solve_marquardt`


@dataclass(frozen=True, eq=False)
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


def solve(model: Model, starts: Sequence[NDArray], low: NDArray, high: NDArray, tolerance: float = 1e-9) -> Solution:
    """Minimise the sum of squares inside a box by the trust-region method of scipy, from every start."""
    return _best([_descend(*_apart(model), start, low, high, tolerance) for start in starts])


def solve_by_differences(
    residual: Residual,
    starts: Sequence[NDArray],
    low: NDArray,
    high: NDArray,
    tolerance: float = 1e-8,
    most: int = 400,
    scale: NDArray | str = "jac",
) -> Solution:
    """As :func:`solve`, with the Jacobian by forward differences."""
    return _best([_descend(residual, "2-point", start, low, high, tolerance, most, scale) for start in starts])


def _descend(
    residual: Residual,
    jacobian: Residual | str,
    start: NDArray,
    low: NDArray,
    high: NDArray,
    tolerance: float,
    most: int = 400,
    scale: NDArray | str = "jac",
) -> Any:
    from scipy.optimize import least_squares

    margin = 1e-9 * np.minimum(high - low, 1.0)
    return least_squares(
        residual,
        np.clip(start, low + margin, high - margin),
        jacobian,
        bounds=(low, high),
        method="trf",
        x_scale=scale,
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=most,
    )


def _best(results: list[Any]) -> Solution:
    best = min(results, key=lambda one: one.cost)
    least = 2.0 * float(best.cost)
    near = sum(bool(2.0 * one.cost <= least + max(1e-3, 1e-6 * least)) for one in results)
    return Solution(best.x, least, len(results), near, best.fun, best.jac)


def _apart(model: Model) -> tuple[Residual, Residual]:
    """Residual and Jacobian of a model, for which scipy asks one after the other: its last evaluation is kept."""
    kept: dict[bytes, tuple[NDArray, NDArray]] = {}

    def evaluated(at: NDArray) -> tuple[NDArray, NDArray]:
        if at.tobytes() not in kept:
            kept.clear()
            kept[at.tobytes()] = model(at)
        return kept[at.tobytes()]

    return lambda at: evaluated(at)[0], lambda at: evaluated(at)[1]


def solve_marquardt(
    residual: Residual,
    jacobian: Callable[[NDArray], NDArray],
    start: NDArray,
    low: NDArray,
    high: NDArray,
    fixed: Sequence[int] = (),
    iterations: int = 12,
    enough: float = 0.02,
    trusted: float = np.inf,
) -> NDArray:
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
        downhill = -(columns.T @ value)
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


CHI_SQUARE_95 = 3.8415  # 95 % point of chi-square with one degree of freedom

FARTHEST = 12.0  # how far from the optimum an end of an interval is searched, in the parameter unit (ln: factor 1.6e5)


@dataclass(frozen=True)
class ProfileInterval:
    """A profile interval; an end that is not found is None and ``reason`` says why."""

    low: float | None
    high: float | None
    at_bound: bool
    reason: str


def profile_interval(model: Model, best: Solution, index: int, low: NDArray, high: NDArray) -> ProfileInterval:
    """95 % interval of one parameter: where the best cost with it held is 3.84 above the minimum.

    An end that is not reached inside the box, or within :data:`FARTHEST`, is None: the data do not
    determine the parameter on that side. ``at_bound`` says that the optimum itself lies on the box.

    References
    ----------
    Venzon and Moolgavkar, J. R. Stat. Soc. C 37 (1988) 87.

    Examples
    --------
    An exponential with noise of 0.05, its time constant 1.5:

    >>> import numpy as np
    >>> x = np.linspace(0.0, 4.0, 30)
    >>> def model(q):
    ...     curve = q[0] * np.exp(-x / q[1])
    ...     slope = np.column_stack([curve / q[0], curve * x / q[1] ** 2])
    ...     return (curve - 2.0 * np.exp(-x / 1.5)) / 0.05, slope / 0.05
    >>> low, high = np.full(2, 0.1), np.full(2, 10.0)
    >>> best = solve(model, [np.ones(2)], low, high)
    >>> found = profile_interval(model, best, 1, low, high)
    >>> f"{best.parameters[1]:.2f} ({found.low:.2f} to {found.high:.2f})"
    '1.50 (1.44 to 1.57)'
    """
    centre = best.parameters
    at_bound = bool(min(centre[index] - low[index], high[index] - centre[index]) < 1e-4)
    spread = covariance(model(centre)[1])
    first = float(np.clip(0.5 if spread is None else np.sqrt(CHI_SQUARE_95 * spread[index, index]), 1e-6, 2.0))
    ends, reasons = [], []
    for side in (-1.0, 1.0):
        limit = min(centre[index] - low[index] if side < 0 else high[index] - centre[index], FARTHEST)
        end = _profile_end(model, best, index, low, high, side, first, limit)
        ends.append(None if end is None else centre[index] + side * end)
        if end is None:
            reasons.append("below" if side < 0 else "above")
    reason = f"not identifiable: the data set no bound {' or '.join(reasons)}" if reasons else ""
    return ProfileInterval(ends[0], ends[1], at_bound, reason)


def _profile_end(
    model: Model, best: Solution, index: int, low: NDArray, high: NDArray, side: float, first: float, limit: float
) -> float | None:
    """Distance at which the profiled cost has risen by the threshold; None when it never does."""
    centre, root = best.parameters, np.sqrt(CHI_SQUARE_95)
    # always from the optimum and from the nearest point below the threshold: a far point may lie in another basin
    optimum = warm = np.delete(centre, index)
    before, height_before, distance = 0.0, 0.0, min(first, limit)
    top = None
    for _ in range(25):
        starts = [optimum] if before == 0.0 else [warm, optimum]
        reached, cost = _held(model, centre, index, side * distance, starts, low, high)
        height = np.sqrt(max(cost - best.chi_square, 0.0))
        if abs(height - root) < 0.01 * root:
            return distance
        if height < root:
            before, height_before, warm = distance, height, reached
            if top is None:
                if distance >= limit:
                    return None
                rate = height / distance
                ahead = distance * 2.5 if rate <= 0 else min(1.05 * root / rate, 2.5 * distance)
                distance = min(ahead, limit)
                continue
        else:
            top = (distance, height)
        share = (root - height_before) / max(top[1] - height_before, 1e-12)
        distance = before + (top[0] - before) * float(np.clip(share, 0.05, 0.95))
        if top[0] - before < 1e-7:
            return distance
    return distance


def within(costs: Sequence[float], unit: float = 1.0, lowest: float | None = None) -> list[int]:
    """Places on a profile whose cost is at most 3.84 units above its lowest: the 95 % interval on a grid."""
    least = min(costs) if lowest is None else lowest
    return [index for index, cost in enumerate(costs) if cost - least <= CHI_SQUARE_95 * unit]


def _held(
    model: Model, centre: NDArray, index: int, shift: float, starts: list[NDArray], low: NDArray, high: NDArray
) -> tuple[NDArray, float]:
    """Minimise over all but one parameter, which is held at ``shift`` from the optimum."""
    free = np.delete(np.arange(len(low)), index)

    def reduced(values: NDArray) -> tuple[NDArray, NDArray]:
        point = centre.copy()
        point[index] += shift
        point[free] = values
        residual, jacobian = model(point)
        return residual, jacobian[:, free]

    if not len(free):
        return starts[0], float((reduced(starts[0])[0] ** 2).sum())
    solution = solve(reduced, starts, low[free], high[free], 1e-6)
    return solution.parameters, solution.chi_square


PARSIMONY = 6.0
"""Gain in AICc that a richer model must bring: the time of a spurious relaxing arm is free to hunt for noise, which
earns it more than the two units a parameter is charged with."""

Size = TypeVar("Size", int, float)


def aicc(minus_two_log_likelihood: float, unknown: int, observed: int) -> float:
    """Corrected Akaike criterion of ``unknown`` parameters, those of the noise included, on ``observed`` numbers.

    References
    ----------
    Hurvich and Tsai, Biometrika 76 (1989) 297.
    """
    spare = max(observed - unknown - 1, 1)
    return minus_two_log_likelihood + 2 * unknown + 2 * unknown * (unknown + 1) / spare


def simplest(criterion: Mapping[Size, float]) -> Size:
    """Smallest size whose criterion is within :data:`PARSIMONY` of the lowest."""
    lowest = min(criterion.values())
    return min(size for size, value in criterion.items() if value <= lowest + PARSIMONY)
