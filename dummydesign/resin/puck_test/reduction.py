"""Bins of a puck's press with holds, and their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.inference import noise as inference
from dummydesign.inference.binning import cut, distinct, hold_edges, mean_around
from dummydesign.inference.noise import white_noise
from dummydesign.measurement.landmarks import Hold

Array = np.ndarray

RAMP_BINS = 25


@dataclass(frozen=True)
class PuckPress:
    """One press in bins."""

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


LEAST_MISFIT = 0.02
"""Misfit of the one-term law that is always reckoned with: the middle of 19 mixtures, ``docs/ecoflex.md``."""
ALIKE = 0.15
"""Compression, over height, within which the law misfits alike."""
RIPPLE, RIPPLE_LENGTH = 0.0025, 0.02
"""Ripple of the solved force over compression, half of its mesh error, and the compression it goes with: the
bulging side comes to lie on the plate cell by cell."""
JITTER = 1e-4
"""Relative error of taking the motion as straight between nodes."""


@dataclass(frozen=True)
class PuckNoise:
    """Standard deviations: white per sample and slow [N], life of the slow part [s], misfit over force."""

    white_N: float
    slow_N: float
    slow_time_s: float
    misfit: float


def covariance(press: PuckPress, height_mm: float, noise: PuckNoise) -> Array:
    """Covariance of the bins' residuals of ln force, shape (bins, bins)."""
    c = press.compression_mm / height_mm
    apart = c[:, None] - c
    total = noise.misfit**2 * np.exp(-0.5 * (apart / ALIKE) ** 2)
    total += RIPPLE**2 * np.exp(-0.5 * (apart / RIPPLE_LENGTH) ** 2)
    slow = inference.Bins([press]).slow(noise.slow_time_s)[0]
    total += noise.slow_N**2 * slow / np.outer(press.force_N, press.force_N)
    total[np.diag_indices_from(total)] += noise.white_N**2 / press.samples / press.force_N**2 + JITTER**2
    return total


def whitener(press: PuckPress, height_mm: float, noise: PuckNoise) -> Array:
    """Inverse Cholesky factor: whitened = factor @ residual."""
    return inference.whitener(covariance(press, height_mm, noise))


def estimate(press: PuckPress, height_mm: float, residual: Array, jacobian: Array) -> PuckNoise:
    """Sizes of slow noise and misfit from residuals of ln force and their sensitivity to what was fitted."""
    level = float(press.force_N.max())
    longest = max(hold.duration_s for hold in press.holds)
    start = np.array([1e-3 * level, 0.1 * longest, 1.2 * LEAST_MISFIT])
    low = np.array([1e-5 * level, 1e-2 * longest, LEAST_MISFIT])
    high = np.array([0.02 * level, longest, 0.3])

    def noise_of(sizes: Array) -> PuckNoise:
        return PuckNoise(press.white_N, *sizes.tolist())

    def cost(sizes: Array) -> float:
        own = covariance(press, height_mm, noise_of(sizes))
        return inference.restricted_likelihood(own[None], residual[None], jacobian[None])

    return noise_of(inference.likeliest(cost, start, low, high)[0])
