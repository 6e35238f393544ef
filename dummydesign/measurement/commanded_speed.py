"""Speed that the robot was sent with and its braking, read from the way that a press has left to its stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2, Motion
from dummydesign.measurement.plateau import noise_of

READ_MM, TIMING = 5e-4, 0.02
"""Least error of a reading, and of a time over the step of the samples."""
ENOUGH, USED, SCATTERED = 80, 30, 10
"""Samples from contact to the stop that are enough, others are averaged; those that a braking is fitted to; those of a
ramp that tell how their times scatter."""
CHORD, LONG, SAME, ABOVE = 0.1, 0.34, 0.03, 0.03
"""Shares of the way left over which a speed is taken, and over which one that stays within 3 % is constant. The fastest
one may be 3 % more."""
BRAKINGS, ROBOTS_BRAKE, NODES = (1.0, 2e5), 300.0, 30
"""Brakings that are tried, and the least of a robot; a softer one is a slow motion that eases to its stop. [mm/s2]"""
REDUCED_MM_S = 250.0
"""Fastest speed of a robot beside people, ISO 10218-1: a speed without a bound may be this one."""
TRIED, STEP, SURE = (-0.16, 0.53), 0.02, 0.08
"""ln of the speeds that are tried over the fastest chord, and between them; error of a speed that needs no word."""
FITS, SEEN, EQUAL, LIKELY = 4.0, 20.0, 1.0, 6.0
"""Chi-square: for each degree of freedom, up to which a constant braking fits; by which it is likelier than the default
one; within which the lowest speed is taken, and all are likely."""


@dataclass(frozen=True)
class CommandedSpeed:
    """Speed that the robot was sent with, its interval of 95 %, and the braking to the stop. [mm/s, mm/s2]

    ``high_mm_s`` is infinite where the samples show no constant speed: the robot may brake from contact on. ``ends``
    are the slowest and the fastest likely speed, each with its braking.
    """

    value_mm_s: float
    low_mm_s: float
    high_mm_s: float
    braking_mm_s2: float
    ends: tuple[tuple[float, float], tuple[float, float]]

    @property
    def sure(self) -> bool:
        """Whether the interval is within :data:`SURE` of the value."""
        return max(self.high_mm_s / self.value_mm_s, self.value_mm_s / self.low_mm_s) <= 1.0 + SURE

    @property
    def words(self) -> str:
        """The interval in words."""
        upper = f"to {self.high_mm_s:.3g} mm/s" if np.isfinite(self.high_mm_s) else "mm/s or more"
        return f"{self.low_mm_s:.3g} {upper}"


@dataclass(frozen=True, eq=False)
class _WayLeft:
    """Times, way left to the depth, and errors of both. [s, mm]"""

    time_s: NDArray
    left_mm: NDArray
    error_mm: float
    error_s: float

    def misfit(self, speed: NDArray, braking: NDArray) -> NDArray:
        """Chi-square of the times of the stop that each sample foretells; speeds (n, 1, 1), brakings (n, m, 1)."""
        now = np.minimum(speed, np.sqrt(2.0 * braking * self.left_mm))
        stop = self.time_s + now / braking + np.maximum(self.left_mm / speed - 0.5 * speed / braking, 0.0)
        weight = 1.0 / ((self.error_mm / now) ** 2 + self.error_s**2)
        mean = (weight * stop).sum(axis=-1, keepdims=True) / weight.sum(axis=-1, keepdims=True)
        return np.asarray((weight * (stop - mean) ** 2).sum(axis=-1))

    def brakings(self, speeds: NDArray) -> tuple[NDArray, NDArray]:
        """Least chi-square at each speed and the braking that has it; both (n,)."""
        low, high = BRAKINGS
        wide = np.log(high / low) / (NODES - 1)
        braking = np.broadcast_to(np.geomspace(low, high, NODES), (len(speeds), NODES))
        for _ in range(4):
            misfit = self.misfit(speeds[:, None, None], braking[:, :, None])
            best = braking[np.arange(len(speeds)), misfit.argmin(axis=1)]
            braking = np.clip(best[:, None] * np.exp(np.linspace(-wide, wide, 13)), low, high)
            wide /= 6.0
        return misfit.min(axis=1), best

    @property
    def free(self) -> int:
        """Degrees of freedom of a fit of speed and braking."""
        return len(self.time_s) - 3

    def own_braking(self, speeds: NDArray, misfit: NDArray, braking: NDArray, nearest: int, overshot: bool) -> float:
        """The braking at one of the speeds, or the default one where that is not much less likely."""
        sharp = float(self.misfit(speeds[:, None, None], np.full((1, 1, 1), DECELERATION_MM_S2)).min())
        off = float(misfit[nearest])
        default = overshot or sharp - off <= SEEN * max(off / self.free, 1.0)
        return DECELERATION_MM_S2 if default else float(braking[nearest])


@dataclass(frozen=True)
class _Chord:
    """Fastest chord of the way left: speed, what it is at least, and the end of the first one that is about as fast.

    ``constant_mm_s`` is the fastest mean over a third of the way left; ``steady`` where a constant speed is seen.
    ``high_mm_s`` is what a constant one has at most. [mm/s, s]
    """

    speed_mm_s: float
    low_mm_s: float
    high_mm_s: float
    constant_mm_s: float
    steady: bool
    end_s: float


def commanded_speed(
    path: Motion, contact_time_s: float, stop_time_s: float, depth_mm: float, overshot: bool
) -> CommandedSpeed:
    """Find the speed that the robot was sent with, the approach included, and its braking.

    A constant speed is seen where the mean over a third of the way left is that of the fastest chord. Elsewhere speeds
    are taken with which a constant speed and a constant braking foretell one stop from all samples after that chord.
    """
    time, x, error, one = _means(path, contact_time_s, stop_time_s, depth_mm)
    late = TIMING * float(np.median(np.diff(time[-USED:])))
    chord = _fastest_chord(time, x, depth_mm, error, late)
    # means would blunt a sudden stop
    left = depth_mm - path.displacement_mm
    near = (path.time_s >= chord.end_s) & (path.time_s <= stop_time_s) & (left > max(4.0 * one, 0.01 * depth_mm))
    use = np.flatnonzero(near)
    use = use[:: max(len(use) // USED, 1)]
    way = _WayLeft(path.time_s[use], left[use], one, late)
    if chord.steady:
        constant = _constant_speed(chord, way, overshot)
        # a braking over more than the other two thirds leaves no third for a constant speed
        if 0.5 * constant.value_mm_s**2 / constant.braking_mm_s2 <= (1.0 - LONG) * (depth_mm - float(x.min())):
            return constant
    return _braking_speed(chord, way, depth_mm, overshot)


def _fastest_chord(time: NDArray, x: NDArray, depth_mm: float, error_mm: float, late_s: float) -> _Chord:
    """Find the chord whose speed less its error is largest."""
    left = depth_mm - x
    climb, reach = np.maximum.accumulate(x), np.maximum(CHORD * left, 30.0 * error_mm)

    def speed_over(way: NDArray, least: int) -> tuple[NDArray, NDArray, NDArray]:
        to = np.minimum(np.maximum(np.searchsorted(climb, x + way), np.arange(len(x)) + least), len(x) - 1)
        lasts = np.where((time[to] > time) & (left > 0.25 * depth_mm), time[to] - time, np.inf)
        return (x[to] - x) / lasts, to, late_s / lasts

    speed, ahead, timing = speed_over(reach, 1)
    errors = 3.0 * error_mm / reach + timing
    at = int(np.argmax(speed * (1.0 - errors)))
    value, off = float(speed[at]), float(errors[at])
    low, constant = value * (1.0 - off), float(speed_over(np.maximum(LONG * left, reach), 4)[0].max())
    begin = int(ahead[np.argmax(speed >= low - SAME * value)])
    steady = constant >= low - SAME * value and off < SAME
    return _Chord(value, low, value * (1.0 + ABOVE + 0.5 * off), constant, steady, float(time[begin]))


def _constant_speed(chord: _Chord, way: _WayLeft, overshot: bool) -> CommandedSpeed:
    """The constant speed that is seen, and the braking after it."""
    value = chord.constant_mm_s
    low, high = min(chord.low_mm_s, value * (1.0 - SAME)), max(value * (1.0 + SAME), chord.high_mm_s)
    own = DECELERATION_MM_S2
    if way.free > 0:
        # a little too fast a speed would make the braking much too soft
        speeds = value * np.exp(np.linspace(-SAME, SAME, NODES + 1))
        misfit, braking = way.brakings(speeds)
        own = way.own_braking(speeds, misfit, braking, int(misfit.argmin()), overshot)
    return CommandedSpeed(value, low, high, own, ((low, own), (high, own)))


def _braking_speed(chord: _Chord, way: _WayLeft, depth_mm: float, overshot: bool) -> CommandedSpeed:
    """The lowest of the speeds that are likely with one constant braking; where none is, it may brake from contact."""
    from scipy.special import fdtri

    value, low, high = chord.speed_mm_s, chord.low_mm_s, np.inf
    speeds, own = value * np.exp(np.arange(*TRIED, STEP)), DECELERATION_MM_S2
    fastest = max(float(speeds[-1]), REDUCED_MM_S)
    ends = (low, 0.5 * low**2 / depth_mm), (fastest, own)
    if way.free < 1:
        return CommandedSpeed(value, low, high, own, ends)
    misfit, braking = way.brakings(speeds)
    best = float(misfit.min())
    value = max(low, chord.constant_mm_s)
    if best <= FITS * way.free:
        likely = np.flatnonzero(misfit <= best + LIKELY + float(fdtri(1, way.free, 0.95)) * best / way.free)
        first, last = int(likely[0]), int(likely[-1])
        low = min(low, float(speeds[first]) * (1.0 - STEP))
        bounded = last < len(speeds) - 1
        high = max(chord.high_mm_s, float(speeds[last]) * (1.0 + STEP)) if bounded else np.inf
        value = max(float(speeds[np.argmax(misfit <= best + EQUAL)]), low)
        ends = (
            (float(speeds[first]), float(braking[first])),
            (float(speeds[last]) if bounded else fastest, float(braking[last])),
        )
    own = way.own_braking(speeds, misfit, braking, int(np.abs(speeds - value).argmin()), overshot)
    high = value * (1.0 + SURE) if own < ROBOTS_BRAKE and np.isinf(high) else high
    return CommandedSpeed(value, low, high, own, ends)


def _means(
    path: Motion, contact_time_s: float, stop_time_s: float, depth_mm: float
) -> tuple[NDArray, NDArray, float, float]:
    """Means of samples up to the stop, where there are many: times, path, errors of it and of a sample. [s, mm]"""
    time, x = path.time_s, path.displacement_mm
    end = min(int(np.searchsorted(time, stop_time_s, side="right")) + 1, len(x))
    many = max((end - int(np.searchsorted(time, contact_time_s))) // ENOUGH, 1)
    digits = float(np.diff(np.unique(np.round(x, 6))).min(initial=1.0)) / np.sqrt(12.0)
    time, x = (part[end % many : end].reshape(-1, many).mean(axis=1) for part in (time, x))
    # what the times scatter is seen in the ramp alone: a line between neighbours misses by the same while it brakes
    ramp_time, ramp_x = (part[(x > 0.05 * depth_mm) & (x < 0.98 * depth_mm)] for part in (time, x))
    error = (float(np.hypot(READ_MM, noise_of(path.displacement_mm))) + digits) / np.sqrt(many)
    if len(ramp_x) >= SCATTERED:
        share = (ramp_time[1:-1] - ramp_time[:-2]) / (ramp_time[2:] - ramp_time[:-2])
        off = ramp_x[1:-1] - ramp_x[:-2] - share * (ramp_x[2:] - ramp_x[:-2])
        error = max(error, float(np.median(np.abs(np.diff(off)))) / 0.6745 / np.sqrt(5.0))
    return time, x, error, error * float(np.sqrt(many))
