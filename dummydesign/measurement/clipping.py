"""The end of a load cell's range: a force that stands within its noise where it ought to change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import true_runs
from dummydesign.measurement.importing.baseline import digit_step
from dummydesign.measurement.importing.sign_convention import middle_of_three
from dummydesign.measurement.plateau import noise_of

LEAST = 8
"""Samples of a clipped stretch."""
BAND, LEVEL, FLAT, ROUND, GRAIN = 6.0, 0.7, 2.0, 0.7, 1e-4
"""Over the noise: width of the stretch, what its running means may fall by, most change along it, most by which its
middle stands above its ends. Least noise, over the largest force."""
RISE, FALL = 25.0, 10.0
"""Changes over the noise that the stretch would show: of the rise before it if the punch goes on at half its speed (a
smooth top of the same width would show 10), and of the relaxation behind it."""
SMOOTH_TOP = 19.5
"""Fall of a parabola behind a stretch about its top, as far again, over the height of its middle above its ends."""


STIFFENING, HELD = 5.0, 0.02
"""Relative change of a force over that of the depth, and the change up to which a depth is held."""


@dataclass(frozen=True)
class Clip:
    """A clipped stretch: samples ``first`` to ``stop``, their times and the force at which they stand."""

    first: int
    stop: int
    start_s: float
    end_s: float
    level_N: float


def longest_run(mask: NDArray) -> tuple[int, int]:
    """First sample of the longest run in which a mask is true, and the one behind it; (0, 0) without one."""
    return max(true_runs(mask), key=lambda run: run[1] - run[0], default=(0, 0))


def find_clip(time: NDArray, x: NDArray, force: NDArray, step_N: float | None = None) -> Clip | None:
    """Find where the force stands at its largest although the punch goes on, or the relaxation begins later only.

    Parameters
    ----------
    time, x, force : ndarray, shape (n,)
        One press, compression positive. [s, mm, N]
    step_N : float, optional
        Step of its digits, where a subtracted line hides it. [N]
    """
    smooth = middle_of_three(force)
    peak = float(smooth.max())
    noise = max(noise_of(force), 0.5 * (digit_step(force) if step_N is None else step_N), GRAIN * peak)
    first, stop = longest_run(smooth >= peak - BAND * noise)
    if stop - first < LEAST or first < LEAST or peak <= 0:
        return None
    first, stop = _level_part(force, first, stop, noise)
    inside = slice(first, stop)
    if stop - first < LEAST:
        return None
    tilt = float(np.polyfit(time[inside] - time[first], force[inside], 1)[0]) * float(time[stop - 1] - time[first])
    third = (stop - first) // 3
    middle, ends = force[first + third : stop - third], np.r_[force[first : first + third], force[stop - third : stop]]
    rounded = float(middle.mean() - ends.mean())
    if abs(tilt) > FLAT * noise or rounded > ROUND * noise:
        return None
    rounded += 2.0 * noise * float(np.sqrt(1.0 / len(middle) + 1.0 / len(ends)))
    fall = max(FALL * noise, SMOOTH_TOP * rounded)
    if not (_goes_on(time, x, force, first, stop, noise) or _relaxes_later(time, x, force, first, stop, fall)):
        return None
    return Clip(first, stop, float(time[first]), float(time[stop - 1]), float(np.median(force[inside])))


def _level_part(force: NDArray, first: int, stop: int, noise: float) -> tuple[int, int]:
    """The part of a stretch in which running means stay level: without the last of the rise and of the fall."""
    window = max((stop - first) // 10, 5)
    means = np.convolve(force[first:stop], np.full(window, 1.0 / window), "valid")
    level = np.flatnonzero(means >= np.quantile(means, 0.9) - LEVEL * noise)
    return first + int(level[0]), first + int(level[-1]) + window


def _goes_on(time: NDArray, x: NDArray, force: NDArray, first: int, stop: int, noise: float) -> bool:
    """Whether the punch goes on into the pad at half its speed or more while the force stands."""
    before = max(first - max((stop - first) // 4, LEAST), 0)
    way, rise = float(x[first] - x[before]), float(force[first] - force[before])
    if way <= 0.0 or rise <= 0.0:
        return False
    reached = np.maximum.accumulate(x[first:stop])
    speed = way / max(float(time[first] - time[before]), 1e-12)
    fast = reached - x[first] >= 0.5 * speed * (time[first:stop] - time[first])
    moved = float(reached[fast][-1] - x[first])
    return bool(rise / way * moved > RISE * noise)


def _relaxes_later(time: NDArray, x: NDArray, force: NDArray, first: int, stop: int, fall: float) -> bool:
    """Whether the force falls behind the stretch, at the same depth, as it ought to within it."""
    lasts = float(time[stop - 1] - time[first])
    after = min(int(np.searchsorted(time, time[stop - 1] + lasts)), len(time) - 1)
    share = float(np.ptp(x[(first + stop) // 2 : after + 1])) / float(x.max())
    behind = force[max(after - 2, stop) : after + 1]
    inside = float(np.median(force[first:stop]))
    # where the punch still rings, the force follows it
    least = fall + STIFFENING * share * inside
    return bool(share < HELD and len(behind) and inside - float(np.median(behind)) > least)
