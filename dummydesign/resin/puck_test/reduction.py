"""Ramps and holds of a puck's compression, and its reduction to bins in which a model is evaluated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

STILL = 0.1
"""Share of the speed of the ramps below which the plate counts as still."""
HOLD_SHARE = 0.1
"""A hold lasts at least this share of the time that the ramps alone take."""
RAMP_BINS, HOLD_GROWTH = 25, 1.33


@dataclass(frozen=True)
class Hold:
    """A stretch at one compression: from stop to leaving [s], and where [mm]."""

    start_s: float
    end_s: float
    displacement_mm: float

    @property
    def duration_s(self) -> float:
        """How long it lasts. [s]"""
        return self.end_s - self.start_s


@dataclass(frozen=True)
class PuckPress:
    """One press in bins.

    Attributes
    ----------
    holds : tuple of Hold
    time_s, displacement_mm : ndarray, shape (nodes,)
        Measured motion where a model is evaluated.
    average : ndarray, shape (bins, nodes)
        Takes a curve that is linear between the nodes to its means over the samples of each bin.
    start_s, end_s, samples, force_N, compression_mm : ndarray, shape (bins,)
        Edges, number of samples, mean force (zero before contact) and mean displacement of each bin.
    white_N : float
        White noise of a sample. [N]
    """

    holds: tuple[Hold, ...]
    time_s: Array
    displacement_mm: Array
    average: Array
    start_s: Array
    end_s: Array
    samples: Array
    force_N: Array
    compression_mm: Array
    white_N: float


def find_holds(time_s: Array, displacement_mm: Array) -> tuple[Hold, ...]:
    """Find the stretches in which the plates stand still under load, up to the end of the deepest.

    The speed of the ramps is the median over a hundred even steps of displacement, so that it does not depend
    on how long was held. Still is a tenth of it over the time in which the ramp goes 2 %. A curve that only
    loads, or loads and unloads, has no hold.

    Parameters
    ----------
    time_s, displacement_mm : ndarray, shape (n,)
    """
    time, x = np.asarray(time_s, float), np.asarray(displacement_mm, float)
    top = np.maximum.accumulate(x)
    deepest = float(top[-1])
    levels = np.linspace(0.02, 0.98, 97) * deepest
    passed = np.searchsorted(top, levels)
    crossing = np.diff(time[np.minimum(passed, len(time) - 1)])
    # fast ramps cross several levels between two samples
    one = max(float(np.median(crossing)), float(np.sum(crossing[crossing <= 3 * np.median(crossing)])) / len(crossing))
    half = max(one, 2.0 * float(np.median(np.diff(time))))
    speed = 0.01 * deepest / max(one, 1e-12)
    ahead, behind = np.interp(time + half, time, x), np.interp(time - half, time, x)
    still = (np.abs(ahead - behind) <= STILL * speed * 2.0 * half) & (x > 0.03 * deepest)
    edges = np.diff(np.r_[False, still, False].astype(int))
    runs = list(zip(np.nonzero(edges == 1)[0], np.nonzero(edges == -1)[0] - 1))
    least = max(HOLD_SHARE * 100.0 * one, 4.0 * half)
    found: list[Hold] = []
    reach = max(0.002 * deepest, 0.01)
    for first, last in runs:
        place = float(np.median(x[first : last + 1]))
        begin, end = first, last
        while begin < last and x[begin] < place - reach:
            begin += 1
        while begin > 0 and x[begin - 1] >= place - reach:
            begin -= 1
        while end < len(x) - 1 and abs(x[end + 1] - place) <= reach:
            end += 1
        if time[end] - time[begin] < least or end - begin < 10:
            continue
        if found and place < found[-1].displacement_mm - reach:
            break
        if found and time[begin] <= found[-1].end_s + 2 * half and abs(place - found[-1].displacement_mm) <= reach:
            found[-1] = Hold(found[-1].start_s, float(time[end]), found[-1].displacement_mm)
        else:
            found.append(Hold(float(time[begin]), float(time[end]), place))
    return tuple(found)


def reduce_press(
    time_s: Array, displacement_mm: Array, force_N: Array, holds: tuple[Hold, ...], window_mm: tuple[float, float]
) -> PuckPress:
    """Cut a press into bins: evenly in displacement over each ramp, growing by a third over each hold.

    Forces are counted from their mean before the displacement reaches zero. Bins outside the window and what
    follows the last hold are left out.

    Parameters
    ----------
    time_s, displacement_mm, force_N : ndarray, shape (n,)
    holds : tuple of Hold
        At least one.
    window_mm : (float, float)
        Displacements that are used. [mm]
    """
    last = int(np.searchsorted(time_s, holds[-1].end_s, side="right"))
    time, x, force = time_s[:last], displacement_mm[:last], force_N[:last]
    touch = int(np.argmax(x > 0.0))
    force = force - (float(np.mean(force[:touch])) if touch else float(force[0]))
    step = float(np.median(np.diff(time)))
    edges = [np.array([time[0]])]
    begin = time[max(touch - 1, 0)]
    for hold in holds:
        ramp = (time >= begin) & (time <= hold.start_s)
        rising = np.maximum.accumulate(x[ramp])
        if ramp.sum() > 1:
            levels = np.linspace(max(rising[0], 0.0), rising[-1], RAMP_BINS + 1)
            edges.append(np.interp(levels, rising + 1e-12 * np.arange(len(rising)), time[ramp]))
        first = max(2.0 * step, 1e-4 * hold.duration_s)
        count = max(int(np.ceil(np.log(hold.duration_s / first) / np.log(HOLD_GROWTH))), 3)
        edges.append(hold.start_s + np.r_[0.0, np.geomspace(first, hold.duration_s, count)])
        begin = hold.end_s
    edge = np.unique(np.concatenate(edges))
    edge = edge[np.r_[True, np.diff(edge) > 1e-9]]
    place = np.clip(np.searchsorted(edge, time, side="right") - 1, 0, len(edge) - 2)
    parts = np.linspace(0.0, 1.0, 5)[:-1]
    nodes = np.r_[(edge[:-1, None] + np.diff(edge)[:, None] * parts).ravel(), edge[-1]]
    seen = np.interp(nodes, time, x)
    integral = np.r_[0.0, np.cumsum(0.5 * (x[1:] + x[:-1]) * np.diff(time))]
    middle = np.r_[nodes[0], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1]]
    mean = np.diff(np.interp(middle, time, integral)) / np.diff(middle)
    inside = np.any([(nodes > h.start_s + 3 * step) & (nodes < h.end_s) for h in holds], axis=0)
    motion = np.where(inside, mean, seen)
    used, row, samples = np.unique(place, return_inverse=True, return_counts=True)
    displacement = np.bincount(row, x) / samples
    keep = (displacement >= window_mm[0]) & (displacement <= window_mm[1])
    after = np.clip(np.searchsorted(nodes, time), 1, len(nodes) - 1)
    share = np.clip((time - nodes[after - 1]) / (nodes[after] - nodes[after - 1]), 0.0, 1.0)
    average = np.zeros((len(used), len(nodes)))
    np.add.at(average, (row, after - 1), 1.0 - share)
    np.add.at(average, (row, after), share)
    average /= samples[:, None]
    return PuckPress(
        holds, nodes, motion, average[keep], edge[used][keep], edge[used + 1][keep], samples[keep],
        (np.bincount(row, force) / samples)[keep], displacement[keep], _white(time, force, holds),
    )  # fmt: skip


def _white(time: Array, force: Array, holds: tuple[Hold, ...]) -> float:
    """White noise of a sample from second differences in the later nine tenths of the holds. [N]"""
    parts = []
    for hold in holds:
        rows = (time >= hold.start_s + 0.1 * hold.duration_s) & (time <= hold.end_s)
        parts.append(np.diff(force[rows], 2))
    bends = np.abs(np.concatenate(parts))
    if not bends.size:
        return 0.0
    # 1.4826 turns the median of absolute values into a standard deviation, sqrt(6) undoes the differences
    return 1.4826 * float(np.median(bends)) / np.sqrt(6.0)
