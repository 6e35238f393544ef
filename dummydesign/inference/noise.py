"""Bins of traces and their noise: covariance, sizes by restricted maximum likelihood, noise floor."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised

REACH = 7.4  # factor by which a size may change before the search looks around again
BOXES = 12  # boxes of the search: together they span any bounds in use


@dataclass(frozen=True)
class Noise(Serialised):
    """Sizes: white and slow standard deviation [N], time of the slow one [s], zero [mm], misfit over peak."""

    white_N: float
    slow_N: float
    slow_time_s: float
    position_mm: float
    misfit_fraction: float = 0.0


class Bins:
    """Bins of several traces as padded stacks, for batched linear algebra.

    Each trace has ``start_s``, ``end_s`` and ``samples`` of its bins. Arrays have shape (traces, longest); ``used``
    masks the padding.
    """

    def __init__(self, traces: Sequence[Any]) -> None:
        longest = max(len(trace.samples) for trace in traces)
        self.used = np.zeros((len(traces), longest), dtype=bool)
        self.start, self.end, self.samples = (np.zeros_like(self.used, dtype=float) for _ in range(3))
        for row, trace in enumerate(traces):
            count = len(trace.samples)
            self.used[row, :count] = True
            self.start[row, :count], self.end[row, :count] = trace.start_s, trace.end_s
            self.samples[row, :count] = trace.samples
        self._both = self.used[:, :, None] & self.used[:, None, :]
        gap = np.maximum(self.start[:, None, :] - self.end[:, :, None], 0.0)
        self._gap = np.maximum(gap, np.swapaxes(gap, 1, 2))
        self._rows = np.arange(longest)

    def without(self, out: NDArray) -> Bins:
        """The same bins with some unused: those of some traces (mask over traces), or of a mask over bins."""
        rest = copy(self)
        rest.used = self.used & ~(out[:, None] if out.ndim == 1 else out)
        rest._both = rest.used[:, :, None] & rest.used[:, None, :]
        return rest

    def stacked(self, values: NDArray) -> NDArray:
        """Put joined bins (total, ...) into the padded stack (traces, longest, ...)."""
        out = np.zeros((*self.used.shape, *values.shape[1:]))
        out[self.used] = values
        return out

    def slow(self, slow_time_s: float) -> NDArray:
        """Covariance of an Ornstein-Uhlenbeck process of variance one averaged exactly over the bins.

        Shape (traces, longest, longest); what is in the padding has no meaning.
        """
        length = np.where(self.used, np.maximum(self.end - self.start, 1e-9), 1.0) / slow_time_s
        loss = -np.expm1(-length) / length
        slow = loss[:, :, None] * loss[:, None, :] * np.exp(-self._gap / slow_time_s)
        # the small-length limit of 2 (L - 1 + exp(-L)) / L^2 is 1 - L / 3
        own = np.where(length > 1e-4, 2.0 * (1.0 - loss) / length, 1.0 - length / 3.0)
        slow[:, self._rows, self._rows] = own
        return slow

    def size_slopes(self, noise: Noise, slope: NDArray, level: NDArray, pull: NDArray) -> dict[str, float]:
        """Derivatives to the sizes of a number that changes by ``pull`` with the covariance (as that is shaped)."""
        pull = np.where(self._both, pull, 0.0)
        own = np.diagonal(pull, axis1=1, axis2=2)
        time_s = noise.slow_time_s
        length = np.where(self.used, np.maximum(self.end - self.start, 1e-9), 1.0) / time_s
        loss, slow = -np.expm1(-length) / length, self.slow(time_s)
        relative = 1.0 - np.exp(-length) / loss
        change = slow * (relative[:, :, None] + relative[:, None, :] + self._gap / time_s)
        long = 2.0 * (1.0 - loss - relative * loss) / length
        change[:, self._rows, self._rows] = np.where(length > 1e-4, long, length / 3.0)
        return {
            "white_N": 2.0 * noise.white_N * float((own / np.maximum(self.samples, 1.0)).sum()),
            "slow_N": 2.0 * noise.slow_N * float((pull * slow).sum()),
            "slow_time_s": noise.slow_N**2 / time_s * float((pull * change).sum()),
            "position_mm": 2.0 * noise.position_mm * float(((pull @ slope[:, :, None])[..., 0] * slope).sum()),
            "misfit_fraction": 2.0 * noise.misfit_fraction * float((own * level**2).sum()),
        }

    def covariance(self, noise: Noise, slope: NDArray, level: NDArray | None = None) -> NDArray:
        """Covariance of the bins, shape (traces, longest, longest), identity in the padding. [N2]"""
        total = noise.slow_N**2 * self.slow(noise.slow_time_s)
        if noise.position_mm > 0:
            total += noise.position_mm**2 * slope[:, :, None] * slope[:, None, :]
        total = np.where(self._both, total, 0.0)
        white = noise.white_N**2 / np.maximum(self.samples, 1.0)
        if level is not None:
            white = white + (noise.misfit_fraction * level) ** 2
        total[:, self._rows, self._rows] += np.where(self.used, white, 1.0)
        return total


def whitener(covariance: NDArray) -> NDArray:
    """Inverse Cholesky factors (..., n, n) of covariances: whitened = factor @ values."""
    from scipy.linalg.lapack import dtrtri

    lower = np.linalg.cholesky(covariance)
    return np.reshape([dtrtri(one, lower=True)[0] for one in lower.reshape(-1, *lower.shape[-2:])], lower.shape)


def minus_two_log_likelihood(bins: Bins, factor: NDArray, residual: NDArray) -> float:
    """Minus twice the Gaussian log likelihood of stacked residuals (traces, longest) under a whitening."""
    white = (factor @ residual[..., None])[..., 0]
    volume = -2.0 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
    return float((white**2).sum() + volume + int(bins.used.sum()) * np.log(2.0 * np.pi))


def restricted_likelihood(
    covariance: NDArray, residual: NDArray, columns: NDArray, shared: bool = True, refitted: bool = False
) -> float:
    """Minus twice the restricted log likelihood of residuals, up to a constant.

    r' V^-1 r + ln det V + ln det(X' V^-1 X), summed over the traces.
    """
    return _restricted(covariance, residual, columns, shared, refitted)[0]


def restricted_slope(covariance: NDArray, residual: NDArray, columns: NDArray) -> tuple[float, NDArray]:
    """The same for shared columns without a refit, and its derivative to each element of the covariance."""
    from scipy.linalg.lapack import dpotri

    cost, lower, white, information = _restricted(covariance, residual, columns)
    turned = _triangular(lower, white, transposed=True)
    own, root = turned[..., 0], np.linalg.inv(np.linalg.cholesky(information[0]))
    sides = turned[..., 1:] @ root.T
    inverse = np.tril([dpotri(one, lower=1)[0] for one in lower])
    inverse += np.swapaxes(np.tril(inverse, -1), 1, 2)
    return cost, inverse - own[:, :, None] * own[:, None, :] - sides @ np.swapaxes(sides, 1, 2)


def _triangular(lower: NDArray, values: NDArray, transposed: bool = False) -> NDArray:
    from scipy.linalg import solve_triangular

    pairs = zip(lower, values)
    return np.stack([solve_triangular(a, b, transposed, lower=True, check_finite=False) for a, b in pairs])


def _restricted(
    covariance: NDArray, residual: NDArray, columns: NDArray, shared: bool = True, refitted: bool = False
) -> tuple[float, NDArray, NDArray, NDArray]:
    """Cost, Cholesky factors, whitened residual and columns, and X' V^-1 X."""
    lower = np.linalg.cholesky(covariance)
    white = _triangular(lower, np.concatenate([residual[..., None], columns], axis=-1))
    groups = white.reshape(1, -1, white.shape[-1]) if shared else white
    rest, turned = groups[..., 0], groups[..., 1:]
    information = np.swapaxes(turned, 1, 2) @ turned
    diagonal = np.arange(information.shape[-1])
    trace = np.trace(information, axis1=1, axis2=2) / max(len(diagonal), 1)
    information[:, diagonal, diagonal] += 1e-9 * trace[:, None] + 1e-300
    cost = (rest**2).sum() + 2.0 * np.log(np.diagonal(lower, axis1=1, axis2=2)).sum()
    if refitted:
        inner = np.swapaxes(turned, 1, 2) @ rest[..., None]
        cost -= (inner * np.linalg.solve(information, inner)).sum()
    return float(cost + np.linalg.slogdet(information)[1].sum()), lower, white, information


def likeliest(
    cost: Callable[[NDArray], Any], start: NDArray, low: NDArray, high: NDArray, gradient: bool = False
) -> tuple[NDArray, float]:
    """Positive sizes of least cost within bounds, by L-BFGS-B in their logarithms.

    With ``gradient`` the cost comes with its derivatives to the logarithms.

    The search goes by boxes of a factor :data:`REACH` to either side of where it stands until it ends inside one:
    a likelihood is flat where a size is too small to be seen, and the first step of a quasi-Newton method, or a
    simplex pressed flat against a bound, would end there.

    References
    ----------
    Byrd, Lu, Nocedal and Zhu, SIAM J. Sci. Comput. 16 (1995) 1190 (L-BFGS-B).
    """
    from scipy.optimize import minimize

    bottom, top = np.log(low), np.log(high)
    at = np.clip(np.log(np.maximum(start, low)), bottom, top)
    options = {"eps": 1e-4, "ftol": 1e-6}
    value = np.inf
    for _ in range(BOXES):
        least, most = np.maximum(bottom, at - np.log(REACH)), np.minimum(top, at + np.log(REACH))
        optimum = minimize(
            lambda logs: cost(np.exp(logs)),
            at,
            method="L-BFGS-B",
            jac=gradient or None,
            bounds=list(zip(least, most)),
            options=options,
        )
        at, value = optimum.x, float(optimum.fun)
        stopped = ((at <= least + 1e-9) & (least > bottom)) | ((at >= most - 1e-9) & (most < top))
        if not stopped.any():
            break
    # exp(log(bound)) may lie an ulp beyond it
    return np.clip(np.exp(at), low, high), value


ROBUST = 1.4826  # standard deviation of a normal variable over the median of its absolute value


def white_noise(second_differences_N: NDArray, robust: bool = False) -> float:
    """Standard deviation of white noise from second differences F(k+1) - 2 F(k) + F(k-1), 0 without any. [N]

    Second differences of independent errors have six times their variance. ``robust`` takes the median of
    their absolute values, which a few jumps do not move; without it rounding to the resolution counts as noise.
    """
    if not second_differences_N.size:
        return 0.0
    if robust:
        return float(ROBUST * np.median(np.abs(second_differences_N)) / np.sqrt(6.0))
    return float(np.sqrt(np.mean(second_differences_N**2) / 6.0))


def noise_floor(holds: Iterable[tuple[NDArray, NDArray]]) -> float:
    """Rms of what a smooth curve in the logarithm of time cannot follow of holds. [N]"""
    squares, count = 0.0, 0
    for time, force_N in holds:
        late = time > 0.05 * time[-1]
        if late.sum() < 20:
            continue
        at = np.log(time[late])
        at = 2.0 * (at - at[0]) / (at[-1] - at[0]) - 1.0
        smooth = np.polynomial.chebyshev.Chebyshev.fit(at, force_N[late], 6)
        squares += float(((force_N[late] - smooth(at)) ** 2).sum())
        count += int(late.sum()) - 7
    return float(np.sqrt(squares / count)) if count > 0 else 0.0


Range = tuple[float, float]
NOWHERE = np.inf, -np.inf
HOLD_GROWTH = 1.33  # ratio of neighbouring times since the stop at which bins of a hold end


@dataclass(frozen=True, eq=False)
class Binning:
    """Bins that hold samples, and which sample is in which."""

    start_s: NDArray
    end_s: NDArray
    samples: NDArray
    interval: NDArray
    inside: NDArray
    bin_index: NDArray

    def mean(self, values: NDArray) -> NDArray:
        """Mean of the samples (n,) of each bin, shape (bins,)."""
        return np.bincount(self.bin_index, values[self.inside]) / self.samples

    def average(self, time_s: NDArray, nodes_s: NDArray, smooth_s: Range = NOWHERE) -> NDArray:
        """Operator (bins, nodes) from a curve's values at nodes to its means over the samples of each bin."""
        index, weight = interpolation(time_s[self.inside], nodes_s, smooth_s)
        average = np.zeros((len(self.samples), len(nodes_s)))
        np.add.at(average, (self.bin_index[:, None], index), weight)
        return average / self.samples[:, None]


def interpolation(time_s: NDArray, nodes_s: NDArray, smooth_s: Range) -> tuple[NDArray, NDArray]:
    """Four nodes and their weights for each time, shape (n, 4): linear, cubic within ``smooth_s``."""
    after = np.clip(np.searchsorted(nodes_s, time_s), 1, len(nodes_s) - 1)
    part = np.clip((time_s - nodes_s[after - 1]) / (nodes_s[after] - nodes_s[after - 1]), 0.0, 1.0)
    index = np.stack([after - 1, after, after, after], axis=1)
    weight = np.stack([1.0 - part, part, 0.0 * part, 0.0 * part], axis=1)
    first, last = np.searchsorted(nodes_s, smooth_s[0]), np.searchsorted(nodes_s, smooth_s[1], side="right") - 1
    # a last node beside the one before would carry its jitter over the whole interval before
    if last >= 2 and nodes_s[last] - nodes_s[last - 1] < 0.5 * (nodes_s[last - 1] - nodes_s[last - 2]):
        last -= 1
    if last - first >= 3:
        inside = (time_s > nodes_s[first]) & (time_s < nodes_s[last])
        index[inside] = np.clip(after[inside] - 2, first, last - 3)[:, None] + np.arange(4)
        at = nodes_s[index[inside]]
        for corner in range(4):
            others = np.delete(at, corner, axis=1)
            weight[inside, corner] = np.prod((time_s[inside, None] - others) / (at[:, [corner]] - others), axis=1)
    return index, weight


def cut(time_s: NDArray, edges_s: NDArray, left_out: NDArray | None = None) -> Binning:
    """Sort samples into the intervals between edges; the last interval is closed, empty ones are dropped.

    Examples
    --------
    >>> import numpy as np
    >>> bins = cut(np.arange(6.0), np.array([0.0, 2.0, 5.0]))
    >>> bins.samples.tolist(), bins.mean(np.arange(6.0)).tolist()
    ([2, 4], [0.5, 3.5])
    """
    which = np.clip(np.searchsorted(edges_s, time_s, side="right") - 1, 0, len(edges_s) - 2)
    # ends of a hold are sums of times: a sample on one may lie an ulp behind it
    use = (time_s >= edges_s[0]) & (time_s <= edges_s[-1] + 1e-9)
    if left_out is not None:
        use &= ~left_out[which]
    inside = np.nonzero(use)[0]
    interval, bin_index, samples = np.unique(which[inside], return_inverse=True, return_counts=True)
    return Binning(edges_s[interval], edges_s[interval + 1], samples, interval, inside, bin_index)


def hold_edges(first_s: float, duration_s: float, fewest: int = 2) -> NDArray:
    """Ends of the bins of a hold, from ``first_s`` growing by about a third to the end of it. [s]"""
    count = max(int(np.ceil(np.log(duration_s / first_s) / np.log(HOLD_GROWTH))), fewest)
    return np.geomspace(first_s, duration_s, count)


def repeatable_hold_edges(first_s: float, duration_s: float) -> NDArray:
    """Beginnings of the bins of a hold at the same times since the stop however long it lasts. [s]

    Bins grow by a third, but none is shorter than ``first_s``: repeats can be compared bin by bin.
    """
    edges = [0.0, first_s]
    while edges[-1] < duration_s:
        edges.append(edges[-1] + max(first_s, edges[-1] * (HOLD_GROWTH - 1.0)))
    return np.array(edges[:-1])


def mean_around(nodes_s: NDArray, time_s: NDArray, values: NDArray) -> NDArray:
    """Means of a piecewise-linear curve between the points half-way from node to node, shape (nodes,)."""
    integral = np.r_[0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time_s))]
    half = np.r_[nodes_s[0], 0.5 * (nodes_s[1:] + nodes_s[:-1]), nodes_s[-1]]
    return np.diff(np.interp(half, time_s, integral)) / np.maximum(np.diff(half), 1e-12)


def distinct(times_s: NDArray, least_gap_s: float) -> NDArray:
    """Increasing times that are more than ``least_gap_s`` from the one before. [s]"""
    ordered = np.unique(times_s)
    return ordered[np.r_[True, np.diff(ordered) > least_gap_s]]
