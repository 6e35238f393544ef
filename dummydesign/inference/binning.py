"""Bins of a measured trace: means of the samples, and the operator that bins a modelled curve in the same way.

Which bins and nodes suit a press is the user's choice; what a bin is, is written here once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
