"""The objective rating of ISO/TS 18571: how alike two curves over even times are, by corridor, phase, size, slope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import Serialised

# Of ISO/TS 18571:2014. Half-widths of the corridors over the largest reference, and the power between them.
INNER, OUTER, CORRIDOR_POWER = 0.05, 0.5, 2
# Largest shift over the length of the curves.
MOST_SHIFT = 0.2
# Half-width of the warping window over the length, and the relative error of size that rates 0.
WINDOW, MOST_SIZE_ERROR = 0.1, 0.5
# Relative error of the slope that rates 0; samples over which slopes are averaged.
MOST_SLOPE_ERROR, AVERAGED = 2.0, 9
# Weights of corridor, phase, size and slope.
WEIGHTS = (0.4, 0.2, 0.2, 0.2)
LEAST_SAMPLES = 20


@dataclass(frozen=True)
class Rating(Serialised):
    """Ratings from 0 to 1 (equal curves): corridor Z, phase EP, magnitude EM, slope ES, and their weighted mean R."""

    R: float
    Z: float
    EP: float
    EM: float
    ES: float


def rate(reference: ArrayLike, compared: ArrayLike) -> Rating:
    """Rate a curve against a reference on the same, even times.

    Parameters
    ----------
    reference, compared : array_like
        Values at the same even times, shape (n,), n at least 20, in any one unit.

    Returns
    -------
    Rating

    Raises
    ------
    InputError
        For curves of different or too small length, values that are not finite, and a reference that never changes.

    References
    ----------
    ISO/TS 18571, Road vehicles: objective rating metric for non-ambiguous signals. Z: 1 within 0.05 of the largest
    absolute reference, 0 beyond 0.5, quadratic between. EP: linear in the shift of the largest correlation, 0 at a
    fifth of the length. EM and ES compare the curves as shifted: EM after dynamic time warping within a tenth of the
    length, ES by slopes averaged over nine samples.
    """
    wanted, own = (np.asarray(curve, float) for curve in (reference, compared))
    _check(wanted, own)
    shift = best_shift(wanted, own)
    phase = max(1.0 - abs(shift) / (MOST_SHIFT * len(wanted)), 0.0)
    parts = corridor(wanted, own), float(phase), *_as_shifted(wanted, own, shift)
    return Rating(float(np.dot(WEIGHTS, parts)), *parts)


def _check(reference: NDArray, compared: NDArray) -> None:
    if reference.ndim != 1 or reference.shape != compared.shape or len(reference) < LEAST_SAMPLES:
        raise InputError(
            f"curves to rate have {reference.shape} and {compared.shape} values; give two of one length, at least "
            f"{LEAST_SAMPLES}",
            "inconsistent",
            "curve",
            len(compared),
            len(reference),
        )
    if not (np.isfinite(reference).all() and np.isfinite(compared).all()):
        raise InputError("a curve to rate has values that are not finite; leave them out", "malformed", "curve")
    if np.ptp(reference) == 0.0:
        raise InputError(
            f"the reference is {reference[0]:g} throughout; a curve that never changes cannot be rated against",
            "inconsistent",
            "curve",
            float(reference[0]),
        )


def corridor(reference: NDArray, compared: NDArray) -> float:
    """Mean rating of the distance from the reference at each time."""
    away = np.abs(compared - reference) / np.abs(reference).max()
    return float(np.mean(np.clip((OUTER - away) / (OUTER - INNER), 0.0, 1.0) ** CORRIDOR_POWER))


def best_shift(reference: NDArray, compared: NDArray) -> int:
    """Samples by which a curve is late (positive) or early where both correlate best; of equal ones the least."""
    most, n = int(np.floor(MOST_SHIFT * len(reference))), len(reference)
    late = np.arange(1, most + 1)
    # in this order, early before late and small before large, the first of equal ones is taken
    order = np.r_[0, np.stack([late, -late], axis=-1).ravel()]
    begins = np.maximum(order, 0), np.maximum(-order, 0)
    counts = n - np.abs(order)
    curves = [curve - curve.mean() for curve in (compared, reference)]
    sums, squares = ([_sums(curve**power, begin, counts) for curve, begin in zip(curves, begins)] for power in (1, 2))
    products = np.correlate(curves[0], curves[1], "full")[n - 1 + order]
    inner = products - sums[0] * sums[1] / counts
    own, wanted = (np.maximum(two - one**2 / counts, 0.0) for one, two in zip(sums, squares))
    # a part that is constant has no correlation
    varies = (own > 1e-12 * squares[0][0]) & (wanted > 1e-12 * squares[1][0])
    correlation = np.where(varies, inner / np.sqrt(np.where(varies, own * wanted, 1.0)), -np.inf)
    # rounding must not tell equal ones apart
    return int(order[np.argmax(correlation >= correlation.max() - 1e-12)])


def _sums(values: NDArray, begin: NDArray, count: NDArray) -> NDArray:
    """Sums of as many values from each beginning on."""
    total = np.r_[0.0, np.cumsum(values)]
    return total[begin + count] - total[begin]


def _as_shifted(reference: NDArray, compared: NDArray, shift: int) -> tuple[float, float]:
    """Ratings of size and slope over the times that both curves have once the shift is taken off."""
    n = len(reference)
    own, wanted = compared[max(shift, 0) : n + min(shift, 0)], reference[max(-shift, 0) : n - max(shift, 0)]
    first, second = warped(wanted, own)
    size = np.abs(own[second] - wanted[first]).sum() / max(np.abs(wanted[first]).sum(), np.finfo(float).tiny)
    slopes = [averaged_slope(curve) for curve in (wanted, own)]
    slope = np.abs(slopes[1] - slopes[0]).sum() / max(np.abs(slopes[0]).sum(), np.finfo(float).tiny)
    return float(max(1.0 - size / MOST_SIZE_ERROR, 0.0)), float(max(1.0 - slope / MOST_SLOPE_ERROR, 0.0))


def averaged_slope(curve: NDArray) -> NDArray:
    """Central differences per sample, each averaged over nine, or as many as there are on both sides of it."""
    slope = np.gradient(curve)
    at = np.arange(len(slope))
    half = np.minimum(np.minimum(at, len(slope) - 1 - at), AVERAGED // 2)
    return _sums(slope, at - half, 2 * half + 1) / (2 * half + 1)


def warped(reference: NDArray, compared: NDArray) -> tuple[NDArray, NDArray]:
    """Indices into both curves along the path of least summed squared distance within the window.

    Dynamic time warping with steps of one in either curve or in both, from both beginnings to both ends. Sums are
    filled in along lines of constant i + j, each at once over the window.
    """
    n = len(reference)
    wide, back = int(np.ceil(WINDOW * n)) - 1, compared[::-1]
    # by line + 2 and i + 1; what is not filled in is out of reach
    least = np.full((2 * n + 1, n + 1), np.inf)
    least[0, 0] = 0.0
    for line in range(2 * n - 1):
        first, last = max(0, line - n + 1, (line - wide + 1) // 2), min(n, line + 1, (line + wide) // 2 + 1)
        row, before = least[line + 2, first + 1 : last + 1], least[line + 1]
        np.minimum(before[first:last], before[first + 1 : last + 1], out=row)
        np.minimum(row, least[line, first:last], out=row)
        away = reference[first:last] - back[n - 1 - line + first : n - 1 - line + last]
        away *= away
        row += away
    i, j = n - 1, n - 1
    path = [(i, j)]
    while i or j:
        line = i + j
        both, one, other = least.item(line, i), least.item(line + 1, i), least.item(line + 1, i + 1)
        # where sums are equal, a step in both curves before a step in one
        if both <= one and both <= other:
            i, j = i - 1, j - 1
        elif one <= other:
            i -= 1
        else:
            j -= 1
        path.append((i, j))
    pairs = np.array(path[::-1])
    return pairs[:, 0], pairs[:, 1]
