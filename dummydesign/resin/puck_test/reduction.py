"""Reduction of a puck's press with holds to bins, and the nodes at which a model is evaluated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.inference.noise_floor import white_noise
from dummydesign.inference.reduction import cut, distinct, hold_edges, mean_around
from dummydesign.measurement.landmarks import Hold

Array = np.ndarray

RAMP_BINS = 25


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


def reduce_press(
    time_s: Array, displacement_mm: Array, force_N: Array, holds: tuple[Hold, ...], window_mm: tuple[float, float]
) -> PuckPress:
    """Cut a press into bins: evenly in displacement over each ramp, growing by a third over each hold.

    Forces are counted from their mean before the displacement reaches zero. Bins outside the window and what
    follows the last hold are left out.

    Parameters
    ----------
    time_s, displacement_mm, force_N : ndarray, shape (n,)
        The recording; displacement is 0 at contact and grows in compression. [s, mm, N]
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
    edges = _edges(time, x, touch, step, holds)
    parts = np.linspace(0.0, 1.0, 5)[:-1]
    nodes = np.r_[(edges[:-1, None] + np.diff(edges)[:, None] * parts).ravel(), edges[-1]]
    held = np.any([(nodes > h.start_s + 3 * step) & (nodes < h.end_s) for h in holds], axis=0)
    motion = np.where(held, mean_around(nodes, time, x), np.interp(nodes, time, x))
    binning = cut(time, edges)
    displacement = binning.mean(x)
    keep = (displacement >= window_mm[0]) & (displacement <= window_mm[1])
    return PuckPress(
        holds, nodes, motion, binning.average(time, nodes)[keep], binning.start_s[keep], binning.end_s[keep],
        binning.samples[keep], binning.mean(force)[keep], displacement[keep], _white(time, force, holds),
    )  # fmt: skip


def _edges(time: Array, x: Array, touch: int, step: float, holds: tuple[Hold, ...]) -> Array:
    """Bin edges [s]: what is before contact, then each ramp evenly in displacement and each hold growing."""
    edges = [np.array([time[0]])]
    begin = time[max(touch - 1, 0)]
    for hold in holds:
        ramp = (time >= begin) & (time <= hold.start_s)
        rising = np.maximum.accumulate(x[ramp])
        if ramp.sum() > 1:
            levels = np.linspace(max(rising[0], 0.0), rising[-1], RAMP_BINS + 1)
            # where the motion stands for a sample the earlier time is taken
            edges.append(np.interp(levels, rising + 1e-12 * np.arange(len(rising)), time[ramp]))
        first = max(2.0 * step, 1e-4 * hold.duration_s)
        edges.append(hold.start_s + np.r_[0.0, hold_edges(first, hold.duration_s, 3)])
        begin = hold.end_s
    return distinct(np.concatenate(edges), 1e-9)


def _white(time: Array, force: Array, holds: tuple[Hold, ...]) -> float:
    """White noise of a sample in the later nine tenths of the holds. [N]"""
    late = [(time >= hold.start_s + 0.1 * hold.duration_s) & (time <= hold.end_s) for hold in holds]
    return white_noise(np.concatenate([np.diff(force[rows], 2) for rows in late]), robust=True)
