"""A smooth curve through noisy samples, with its error; a declared low-pass of the sensor is undone. The trace of an
arm that rings is followed closely for some periods, and averaged over the ringing afterwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.sensor import Lowpass

CELLS = 5
"""Bins an interval between nodes is cut into before samples are averaged: few enough to be quick, and so many that an
arm that rings is not averaged out."""
LEAST_NOISE = 1e-5
"""Smallest noise that is assumed, over the largest value: numbers in files are rounded."""
SURE, SMALL = 4.0, 1.5e-3
"""Standard errors, and share of the range, by which a mean of samples must miss the curve to ask for more nodes."""
MOST_UNSURE = 0.03
"""Largest standard deviation, over the range, that undoing a filter may make of the noise."""
SCANNED = np.logspace(-10.0, 4.0, 57)
"""Weights of the roughness that are tried."""


@dataclass(frozen=True, eq=False)
class SmoothCurve:
    """A curve at nodes: values (n,), a factor (n, k) of their covariance, the noise of one sample, and which of the
    n - 1 intervals are too coarse for what the samples show."""

    value: NDArray
    factor: NDArray
    noise: float
    coarse: NDArray


def smooth_curve(
    time_s: NDArray,
    values: NDArray,
    nodes_s: NDArray,
    lowpass: Lowpass | None = None,
    from_zero: bool = True,
    bends: NDArray | None = None,
    noise: float | None = None,
) -> SmoothCurve:
    """Fit a curve, linear between nodes, to samples: least squares with a penalty on second differences.

    The weight of the penalty makes the expected error smallest (Mallows' C_p with the noise of the samples). The
    covariance is the Bayesian one of the same penalty.

    Parameters
    ----------
    time_s, values : ndarray, shape (m,)
        Samples inside the nodes.
    nodes_s : ndarray, shape (n,)
        Rising.
    lowpass : Lowpass, optional
        Filter that the values went through; the curve is what went into it.
    from_zero : bool
        Whether the curve is 0 at the first node.
    bends : ndarray, shape (k, n), optional
        What is penalised, instead of the second differences.
    noise : float, optional
        Of one sample, instead of that which second differences show.

    References
    ----------
    Wahba, Spline Models for Observational Data, SIAM 1990, chapters 4 and 5.
    """
    from scipy.linalg import eigh

    least = LEAST_NOISE * float(np.max(np.abs(values), initial=1e-12))
    noise = max(float(noise_of(values)) if noise is None else noise, least)
    at, mean, count = _averaged(time_s, values, nodes_s)
    design, first = interpolation(at, nodes_s), int(from_zero)
    if lowpass is not None:
        design = design @ lowpass.apply(nodes_s, np.eye(len(nodes_s))).T
    weighted, wanted = design[:, first:] * np.sqrt(count)[:, None], mean * np.sqrt(count)
    normal = weighted.T @ weighted
    rough = (np.diff(np.eye(len(nodes_s)), 2, axis=0) if bends is None else bends)[:, first:]
    penalty = rough.T @ rough
    penalty *= np.trace(normal) / np.trace(penalty)
    ridge = 1e-14 * np.trace(normal) * np.eye(len(normal))
    share, basis = eigh(normal, normal + penalty + ridge)
    share = np.clip(share, 0.0, 1.0)
    loading = basis.T @ (weighted.T @ wanted)
    total = float(wanted @ wanted)
    # residual sum of squares and degrees of freedom of each weight in closed form
    damped = np.maximum(share + SCANNED[:, None] * (1.0 - share), 1e-13)
    left = total - 2.0 * (loading**2 / damped).sum(axis=1) + (share * loading**2 / damped**2).sum(axis=1)
    left, freedom = np.maximum(left, 0.0), (share / damped).sum(axis=1)
    sample, spare = noise, len(wanted) - freedom
    if lowpass is not None:
        # what no weight can fit is an error of the curve's form, not a reason to follow every sample
        floor = float(np.min(np.where(spare > 0.2 * len(wanted), left / np.maximum(spare, 1.0), np.inf)))
        noise = float(np.sqrt(max(noise**2, floor if np.isfinite(floor) else 0.0)))
    risk = left / noise**2 + 2.0 * freedom
    if lowpass is not None:
        unsure = noise * np.sqrt((1.0 / damped @ (basis**2).T).max(axis=1))
        risk = np.where(unsure > MOST_UNSURE * float(np.ptp(mean)), np.inf, risk)
    best = int(np.argmin(risk)) if np.isfinite(risk).any() else -1
    value = basis @ (loading / damped[best])
    missed = np.abs(wanted - weighted @ value)
    amiss = (missed > SURE * sample) & (missed > SMALL * np.sqrt(count) * float(np.ptp(mean)))
    coarse = np.zeros(len(nodes_s) - 1, bool)
    coarse[np.clip(np.searchsorted(nodes_s, at[amiss], side="right") - 1, 0, len(coarse) - 1)] = True
    factor = noise * root_of_inverse(normal + SCANNED[best] * (penalty + ridge))
    if from_zero:
        value, factor = np.r_[0.0, value], np.vstack([np.zeros(factor.shape[1]), factor])
    return SmoothCurve(value, factor, noise, coarse)


def root_of_inverse(precision: NDArray) -> NDArray:
    """Return the upper triangular root (n, n) of the inverse of a symmetric matrix.

    It is unique: draws made with it do not depend on the signs that a machine's linear algebra gives to eigenvectors.
    """
    from scipy.linalg import cholesky, solve_triangular

    scale = 1.0 / np.sqrt(np.diag(precision))
    even = precision * scale[:, None] * scale
    lower = cholesky(even + 1e-13 * np.eye(len(even)), lower=True)
    return scale[:, None] * solve_triangular(lower, np.eye(len(even)), lower=True).T


def _averaged(time_s: NDArray, values: NDArray, nodes_s: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Mean time and value, and number, of the samples in each bin between two nodes."""
    position = np.interp(time_s, nodes_s, np.arange(len(nodes_s)) * float(CELLS))
    cell = np.minimum(position.astype(int), CELLS * (len(nodes_s) - 1) - 1)
    number = np.bincount(cell)
    used = number > 0
    at = np.bincount(cell, time_s)[used] / number[used]
    return at, np.bincount(cell, values)[used] / number[used], number[used].astype(float)


def interpolation(at: NDArray, nodes: NDArray) -> NDArray:
    """Matrix (len(at), n) of linear interpolation between nodes."""
    left = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[left]) / (nodes[left + 1] - nodes[left]), 0.0, 1.0)
    matrix = np.zeros((len(at), len(nodes)))
    rows = np.arange(len(at))
    matrix[rows, left], matrix[rows, left + 1] = 1.0 - share, share
    return matrix


PERIODS = 20.0
"""Periods of the arm after the stop that are followed closely."""
NODES_A_PERIOD = 16.0
"""Straight lines a period: they miss a sine by 1 % of its amplitude, at frequencies far above its own."""
LEAST_MEAN = 10.0
"""Periods that must be left for means."""
BEYOND = 0.5
"""Periods by which the close curve is fitted farther than it is used: its end is straight, and a ringing is not."""
GROWTH = 1.08
BEFORE = 3.0
"""Periods before the stop from which on the nodes are as close as the ringing needs."""
WINDOW = 4.0
"""Periods in the window of a mean: a raised cosine, which passes less than 1 % of the ringing."""
SEEN, SEEN_SHARE = 3.0, 1e-3
"""Multiple of its error, and share of the depth, from which on a ringing counts as seen (standard deviation)."""
GAP_S = 1e-7
"""Between the last node that follows the ringing and the first mean."""
ORDER, WHITE = 6, 924.0
"""Differences that show the noise beside a ringing arm, and their variance for white noise of 1."""


@dataclass(frozen=True)
class RobotArm:
    """An arm of finite stiffness: K [N/mm], M [kg], damping ratio of the arm alone."""

    stiffness_N_per_mm: float
    mass_kg: float
    damping_ratio: float = 0.0

    @property
    def period_s(self) -> float:
        """Of the arm alone. [s]"""
        return float(2.0 * np.pi * np.sqrt(1e-3 * self.mass_kg / max(self.stiffness_N_per_mm, 1e-9)))

    @property
    def damping_N_s_per_mm(self) -> float:
        """Force over speed. [N s/mm]"""
        return 2.0 * self.damping_ratio * float(np.sqrt(1e-3 * self.mass_kg * self.stiffness_N_per_mm))


def still_rings(curve: SmoothCurve, nodes_s: NDArray, until_s: float, period: float) -> bool:
    """Whether the arm is seen to ring in the last two periods before a time."""
    late = (nodes_s <= until_s) & (nodes_s > until_s - 2.0 * period)
    if late.sum() < NODES_A_PERIOD or nodes_s[late][0] < 0.5 * until_s:
        return False
    value, time = curve.value[late], nodes_s[late]
    left = value - np.polyval(np.polyfit(time, value, 1), time)
    error = np.sqrt((curve.factor[late] ** 2).sum(axis=1).mean())
    return bool(left.std() > max(SEEN * float(error), SEEN_SHARE * float(curve.value.max())))


def quiet_noise(values: NDArray) -> float:
    """Return the noise of one sample by sixth differences, in which the ringing of an arm hardly shows."""
    if len(values) < 5 * ORDER:
        return float("nan")
    return float(np.median(np.abs(np.diff(values, ORDER))) / 0.6745 / np.sqrt(WHITE))


def real_bends(nodes_s: NDArray) -> NDArray:
    """Return rows whose squares sum to the integral of x''^2 over time; second differences where nodes are even."""
    steps = np.diff(nodes_s) / np.diff(nodes_s).min()
    left, right = steps[:-1], steps[1:]
    size = np.sqrt(0.5 * (left + right)) * 2.0 / (left + right)
    rows, at = np.zeros((len(nodes_s) - 2, len(nodes_s))), np.arange(len(nodes_s) - 2)
    for after, weight in enumerate((size / left, -size * (1.0 / left + 1.0 / right), size / right)):
        rows[at, at + after] = weight
    return rows


def smoothed_ringing(
    since_s: NDArray,
    x: NDArray,
    force: NDArray,
    nodes_s: NDArray,
    stop_s: float,
    arm: RobotArm,
    lowpass: Lowpass | None,
) -> tuple[SmoothCurve, SmoothCurve, NDArray, float]:
    """Smooth path and force; the nodes and the time from which on they are means over the ringing.

    The roughness is that over time: a single weight then serves close and wide nodes. Means are taken of both columns
    alike, so that the slow part of the command K x + F stays what it was.
    """
    end = float(nodes_s[-1])
    pad = 1.5 * float(force.max()) / float(x.max())
    ring = RobotArm(arm.stiffness_N_per_mm + pad, arm.mass_kg).period_s
    until = stop_s + PERIODS * arm.period_s
    split = end - until > LEAST_MEAN * arm.period_s and end - until > 0.05 * (end - stop_s)
    if not split:
        until = end
    beyond = until + BEYOND * ring if split else until
    close = _close_nodes(nodes_s, stop_s, beyond, ring / NODES_A_PERIOD, BEFORE * ring)
    inside = since_s <= beyond
    rough = real_bends(close)
    noises = [float(np.nanmin([quiet_noise(one), noise_of(one)])) for one in (x, force)]
    first = [
        smooth_curve(since_s[inside], one[inside], close, passed, bends=rough, noise=noise)
        for one, passed, noise in zip((x, force), (None, lowpass), noises)
    ]
    if not split:
        return first[0], first[1], close, np.inf
    kept = int(np.searchsorted(close, until)) + 1
    close, until = close[:kept], float(close[kept - 1])
    first = [SmoothCurve(one.value[:kept], one.factor[:kept], one.noise, one.coarse[: kept - 1]) for one in first]
    wide = np.r_[until + GAP_S, growing_nodes(until + GAP_S, end, ring, 4)]
    second = []
    for one, noise in zip((x, force), noises):
        at, mean = slow_mean(since_s, one, WINDOW * ring)
        late = at >= until + GAP_S
        second.append(smooth_curve(at[late], mean[late], wide, from_zero=False, noise=noise))
    path, load = (_joined(one, other) for one, other in zip(first, second))
    return path, load, np.r_[close, wide], until


def _close_nodes(nodes_s: NDArray, stop_s: float, until_s: float, ring_step: float, before_s: float) -> NDArray:
    """Nodes of the rise as they are, closer just before the stop, then as even as the ringing needs. [s]"""
    rise = float(nodes_s[1] - nodes_s[0])
    near = stop_s - min(before_s, 0.5 * stop_s)
    still = min(stop_s + max(0.25 * stop_s, 0.008), until_s)
    times, step = [0.0], rise
    while times[-1] < until_s * (1.0 - 1e-9):
        now = times[-1]
        allowed = rise if now < near else min(rise, ring_step) if now < still else ring_step
        step = min(GROWTH * step, allowed)
        times.append(now + step)
    nodes = np.array(times)
    if len(nodes) > 2 and nodes[-1] - until_s > 0.5 * (nodes[-1] - nodes[-2]):
        nodes = nodes[:-1]
    nodes[-1] = until_s
    return nodes


def growing_nodes(begin_s: float, end_s: float, step_s: float, fewest: int, first: int = 0) -> NDArray:
    """Times after a beginning, about a step apart at first and each interval 8 % longer than the one before. [s]"""
    count = max(int(np.ceil(np.log1p((end_s - begin_s) / step_s * (GROWTH - 1.0)) / np.log(GROWTH))), fewest)
    grown = np.cumsum(GROWTH ** np.arange(first, first + count))
    return begin_s + (end_s - begin_s) * grown / grown[-1]


def slow_mean(time_s: NDArray, values: NDArray, window_s: float) -> tuple[NDArray, NDArray]:
    """Return even times, and at each a straight line through the samples about it, weighted by a raised cosine."""
    step = float(np.median(np.diff(time_s)))
    at = time_s[0] + step * np.arange(round((time_s[-1] - time_s[0]) / step) + 1)
    even = np.interp(at, time_s, values)
    half = max(round(0.5 * window_s / step), 1)
    away = np.arange(-half, half + 1) / (half + 1.0)
    weight = 0.5 * (1.0 + np.cos(np.pi * away))

    def moment(power: int, rows: NDArray) -> NDArray:
        # reversed, as a convolution turns its second part round
        return np.convolve(rows, (weight * away**power)[::-1])[half : half + len(rows)]

    ones = np.ones(len(at))
    m0, m1, m2 = (moment(power, ones) for power in range(3))
    s0, s1 = (moment(power, even) for power in range(2))
    return at, (m2 * s0 - m1 * s1) / np.maximum(m0 * m2 - m1**2, 1e-12)


def _joined(first: SmoothCurve, second: SmoothCurve) -> SmoothCurve:
    """One curve of two that know nothing of each other."""
    from scipy.linalg import block_diag

    coarse = np.r_[first.coarse, False, np.zeros(len(second.coarse), bool)]
    return SmoothCurve(np.r_[first.value, second.value], block_diag(first.factor, second.factor), first.noise, coarse)
