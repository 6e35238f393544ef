"""An arm that rings: its trace is followed closely for some periods, and averaged over the ringing afterwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.sensor import Lowpass
from dummydesign.person.smoothing import SmoothCurve, smooth_curve

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
        return period_s(self.stiffness_N_per_mm, self.mass_kg)

    @property
    def damping_N_s_per_mm(self) -> float:
        """Force over speed. [N s/mm]"""
        return 2.0 * self.damping_ratio * float(np.sqrt(1e-3 * self.mass_kg * self.stiffness_N_per_mm))


def period_s(stiffness_N_per_mm: float, mass_kg: float) -> float:
    """Period of a mass on a spring. [s]"""
    return float(2.0 * np.pi * np.sqrt(1e-3 * mass_kg / max(stiffness_N_per_mm, 1e-9)))


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
    ring = period_s(arm.stiffness_N_per_mm + pad, arm.mass_kg)
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
    n, m = first.factor.shape, second.factor.shape
    factor = np.zeros((n[0] + m[0], n[1] + m[1]))
    factor[: n[0], : n[1]], factor[n[0] :, n[1] :] = first.factor, second.factor
    coarse = np.r_[first.coarse, False, np.zeros(len(second.coarse), bool)]
    return SmoothCurve(np.r_[first.value, second.value], factor, first.noise, coarse)
