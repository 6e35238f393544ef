"""Intervals by profile likelihood, and choice between nested models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import Model, Solution, covariance, solve

CHI_SQUARE_95 = 3.8415  # 95 % point of chi-square with one degree of freedom

FARTHEST = 12.0  # how far from the optimum an end of an interval is searched, in the parameter unit (ln: factor 1.6e5)


@dataclass(frozen=True)
class Interval:
    """A profile interval; an end that is not found is None and ``reason`` says why."""

    low: float | None
    high: float | None
    at_bound: bool
    reason: str


def profile_interval(model: Model, best: Solution, index: int, low: NDArray, high: NDArray) -> Interval:
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
    first = np.sqrt(CHI_SQUARE_95 * spread[index, index]) if spread is not None else 0.5
    first = float(np.clip(first, 1e-6, 2.0))
    ends, reasons = [], []
    for side in (-1.0, 1.0):
        limit = min(centre[index] - low[index] if side < 0 else high[index] - centre[index], FARTHEST)
        found = _profile_end(model, best, index, low, high, side, first, limit)
        ends.append(None if found is None else centre[index] + side * found)
        if found is None:
            reasons.append("below" if side < 0 else "above")
    reason = f"not identifiable: the data set no bound {' or '.join(reasons)}" if reasons else ""
    return Interval(ends[0], ends[1], at_bound, reason)


def _profile_end(
    model: Model,
    best: Solution,
    index: int,
    low: NDArray,
    high: NDArray,
    side: float,
    first: float,
    limit: float,
) -> float | None:
    """Distance at which the profiled cost has risen by the threshold; None when it never does."""
    free = np.delete(np.arange(len(low)), index)
    centre = best.parameters
    # always from the optimum and from the nearest point below the threshold: a far point may lie in another basin
    warm = best.parameters[free]
    root = np.sqrt(CHI_SQUARE_95)
    before, height_before, distance = 0.0, 0.0, min(first, limit)
    top = None
    for _ in range(25):
        starts = [best.parameters[free]] if before == 0.0 else [warm, best.parameters[free]]
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
    return [place for place, cost in enumerate(costs) if cost - least <= CHI_SQUARE_95 * unit]


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
    found = solve(reduced, starts, low[free], high[free], 1e-6)
    return found.parameters, found.chi_square


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


def simplest(criterion: Mapping[Size, float], gain: float = PARSIMONY) -> Size:
    """Smallest size whose criterion is within ``gain`` of the lowest."""
    lowest = min(criterion.values())
    return min(size for size, value in criterion.items() if value <= lowest + gain)
