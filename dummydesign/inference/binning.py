"""Bins of a measured trace: means of the samples, and the operator that bins a modelled curve in the same way.

Which bins and nodes suit a press is the user's choice; what a bin is, is written here once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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

    def average(self, time_s: NDArray, nodes_s: NDArray, smooth_from_s: float = np.inf) -> NDArray:
        """Operator (bins, nodes) from a curve's values at nodes to its means over the samples of each bin."""
        time = time_s[self.inside]
        after = np.clip(np.searchsorted(nodes_s, time), 1, len(nodes_s) - 1)
        part = np.clip((time - nodes_s[after - 1]) / (nodes_s[after] - nodes_s[after - 1]), 0.0, 1.0)
        average = np.zeros((len(self.samples), len(nodes_s)))
        first = int(np.searchsorted(nodes_s, smooth_from_s))
        smooth = (time > nodes_s[min(first, len(nodes_s) - 1)]) & (len(nodes_s) - first >= 4)
        np.add.at(average, (self.bin_index[~smooth], after[~smooth] - 1), 1.0 - part[~smooth])
        np.add.at(average, (self.bin_index[~smooth], after[~smooth]), part[~smooth])
        start = np.clip(after[smooth] - 2, first, len(nodes_s) - 4)
        at = nodes_s[start[:, None] + np.arange(4)]
        for corner in range(4):
            others = np.delete(at, corner, axis=1)
            weight = np.prod((time[smooth, None] - others) / (at[:, [corner]] - others), axis=1)
            np.add.at(average, (self.bin_index[smooth], start + corner), weight)
        return average / self.samples[:, None]


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
