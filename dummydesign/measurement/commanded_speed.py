"""Speed that the robot was sent with and its braking, read from the way that a press has left to its stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2
from dummydesign.measurement.plateau import noise_of

if TYPE_CHECKING:
    from dummydesign.measurement.motion import Ramp

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
TRIED, STEP, SURE = (-0.16, 0.53), 0.02, 0.08
"""ln of the speeds that are tried over the fastest chord, and between them; error of a speed that needs no word."""
FITS, SEEN, EQUAL, LIKELY = 4.0, 20.0, 1.0, 6.0
"""Chi-square: for each degree of freedom, up to which a constant braking fits; by which it is likelier than the default
one; within which the lowest speed is taken, and all are likely."""


@dataclass(frozen=True)
class CommandedSpeed:
    """Speed that the robot was sent with, its interval of 95 %, and the braking to the stop. [mm/s, mm/s2]

    ``high_mm_s`` is infinite where the samples show no constant speed: the robot may brake from contact on.
    """

    value_mm_s: float
    low_mm_s: float
    high_mm_s: float
    braking_mm_s2: float

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


def commanded_speed(ramp: Ramp) -> CommandedSpeed:
    """Find the speed that the robot was sent with, the approach included, and its braking.

    A constant speed is seen where the mean over a third of the way left is that of the fastest chord. Elsewhere speeds
    are taken with which a constant speed and a constant braking foretell one stop from all samples after that chord.
    """
    from scipy.special import fdtri

    time, x, error, one = _means(ramp)
    left, late = ramp.depth_mm - x, TIMING * float(np.median(np.diff(time[-USED:])))
    climb, reach = np.maximum.accumulate(x), np.maximum(CHORD * left, 30.0 * error)

    def speed_over(way: NDArray, least: int) -> tuple[NDArray, NDArray, NDArray]:
        to = np.minimum(np.maximum(np.searchsorted(climb, x + way), np.arange(len(x)) + least), len(x) - 1)
        lasts = np.where((time[to] > time) & (left > 0.25 * ramp.depth_mm), time[to] - time, np.inf)
        return (x[to] - x) / lasts, to, late / lasts

    chord, ahead, timing = speed_over(reach, 1)
    errors = 3.0 * error / reach + timing
    at = int(np.argmax(chord * (1.0 - errors)))
    value, off = float(chord[at]), float(errors[at])
    constant = float(speed_over(np.maximum(LONG * left, reach), 4)[0].max())
    low, high, most = value * (1.0 - off), np.inf, value * (1.0 + ABOVE + 0.5 * off)
    begin, speeds = int(ahead[np.argmax(chord >= low - SAME * value)]), value * np.exp(np.arange(*TRIED, STEP))
    steady = constant >= low - SAME * value and off < SAME
    if steady:
        value, low, high = constant, min(low, constant * (1.0 - SAME)), max(constant * (1.0 + SAME), most)
        # a little too fast a speed would make the braking much too soft
        speeds = value * np.exp(np.linspace(-SAME, SAME, NODES + 1))
    # means would blunt a sudden stop
    after, way_left = ramp.path.time_s, ramp.depth_mm - ramp.path.displacement_mm
    near = (after >= time[begin]) & (after <= ramp.stop_time_s)
    use = np.flatnonzero(near & (way_left > max(4.0 * one, 0.01 * ramp.depth_mm)))
    use = use[:: max(len(use) // USED, 1)]
    free = len(use) - 3
    if free < 1:
        return CommandedSpeed(value, low, high, DECELERATION_MM_S2)
    way = _WayLeft(after[use], way_left[use], one, late)
    misfit, braking = way.brakings(speeds)
    best = float(misfit.min())
    if not steady and best <= FITS * free:
        likely = np.flatnonzero(misfit <= best + LIKELY + float(fdtri(1, free, 0.95)) * best / free)
        low = min(low, float(speeds[likely[0]]) * (1.0 - STEP))
        high = np.inf if likely[-1] == len(speeds) - 1 else max(most, float(speeds[likely[-1]]) * (1.0 + STEP))
        value = max(float(speeds[np.argmax(misfit <= best + EQUAL)]), low)
    elif not steady:
        value = max(low, constant)
    nearest = int(misfit.argmin() if steady else np.abs(speeds - value).argmin())
    own, off = float(braking[nearest]), float(misfit[nearest])
    sharp = float(way.misfit(speeds[:, None, None], np.full((1, 1, 1), DECELERATION_MM_S2)).min())
    if sharp - off <= SEEN * max(off / free, 1.0) or ramp.overshoot_mm:
        own = DECELERATION_MM_S2
    high = value * (1.0 + SURE) if own < ROBOTS_BRAKE and np.isinf(high) else high
    return CommandedSpeed(value, low, high, own)


def _means(ramp: Ramp) -> tuple[NDArray, NDArray, float, float]:
    """Means of samples up to the stop, where there are many: times, path, errors of it and of a sample. [s, mm]"""
    time, x = ramp.path.time_s, ramp.path.displacement_mm
    end = min(int(np.searchsorted(time, ramp.stop_time_s, side="right")) + 1, len(x))
    many = max((end - int(np.searchsorted(time, ramp.contact_time_s))) // ENOUGH, 1)
    digits = float(np.diff(np.unique(np.round(x, 6))).min(initial=1.0)) / np.sqrt(12.0)
    time, x = (part[end % many : end].reshape(-1, many).mean(axis=1) for part in (time, x))
    # what the times scatter is seen in the ramp alone: a line between neighbours misses by the same while it brakes
    ramp_time, ramp_x = (part[(x > 0.05 * ramp.depth_mm) & (x < 0.98 * ramp.depth_mm)] for part in (time, x))
    error = (float(np.hypot(READ_MM, noise_of(ramp.path.displacement_mm))) + digits) / np.sqrt(many)
    if len(ramp_x) >= SCATTERED:
        share = (ramp_time[1:-1] - ramp_time[:-2]) / (ramp_time[2:] - ramp_time[:-2])
        off = ramp_x[1:-1] - ramp_x[:-2] - share * (ramp_x[2:] - ramp_x[:-2])
        error = max(error, float(np.median(np.abs(np.diff(off)))) / 0.6745 / np.sqrt(5.0))
    return time, x, error, error * float(np.sqrt(many))
