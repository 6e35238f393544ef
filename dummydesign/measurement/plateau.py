"""The plateau of a press: where the punch stands after it has braked, overshot and rung out.

A stop is an approach, a braking with overshoot and ringing, a plateau (level, or creeping under a controlled force) and
a release. The plateau lasts from the first time that the punch slows to the last time before it leaves, seen backward
in time by the same rule. Its level is that of its later half.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STEP_MM = 0.005
"""Resolution of the position that must not disturb a speed. [mm]"""
SLOWED = 0.1
"""Fraction of the speed of the ramp below which the punch counts as stopped."""
BEGUN = 0.1
"""Share of the largest displacement before which a press begins; a rest beyond it is a stage of the press."""
STAGE = 0.85
"""Share of the depth before which a rest is a stage of the press where the punch goes on at half of its speed."""
LEAVE_MM, LEAVE_SHARE = 0.06, 0.01
"""Wander that does not end a plateau: in mm, and over its depth."""
NEAR_MM, NEAR_SHARE = 0.05, 0.03
"""How far from its level samples of a plateau may be to count for its depth."""
SURE = 6.0
"""Multiple of the noise of the path from which an excursion is seen."""
SEEN_SHARE, STILL_SHARE = 0.002, 0.001
"""Shares of the depth from which an overshoot is seen, and at which a ringing is over."""
RELEASED = 0.5
"""Share of the largest depth below which a recording that ends there shows a release."""
SHORT, TURNS, ABRUPT = 1.5, 0.6, 0.4
"""A plateau lasts longer than this many windows of the speed; a shorter share of the time above 60 % of the depth may
be a turn; a turn goes on from half of the speed to a tenth of it for longer than this."""
NOISELESS = 60.0
"""Noises in the window of the speed there, so that noise does not pass for slowness."""
SAG = 0.01
"""Share of the speed of the ramp below which a fall is a sag of the plateau and no release."""
ENOUGH = 2000
"""Samples that a first level is read from, evenly spread."""
FEWEST_TURNS = 3
"""Crossings of the level in the later half from which the mean of whole periods is taken."""


@dataclass(frozen=True)
class Plateau:
    """Where a press stood.

    Attributes
    ----------
    depth_mm : float
        Median of the samples near the level of the later half; the largest displacement where nothing is held.
    slowed_s, end_s : float
        First time that the punch slows, and the time at which it begins to leave. [s]
    held : bool
        False where the punch only turns, or is recorded to its stop: there is no plateau.
    overshoot_mm : float
        How far it went beyond the depth before it came back; 0 where that is not seen.
    settled_s : float
        Time from which on the ringing is no longer seen; ``slowed_s`` without an overshoot. [s]
    period_s : float
        Of the ringing; four times the time from the depth to the farthest point where it does not ring. [s]
    """

    depth_mm: float
    slowed_s: float
    end_s: float
    held: bool
    overshoot_mm: float = 0.0
    settled_s: float = 0.0
    period_s: float = 0.0


def find_plateau(time: NDArray, x: NDArray, start: int, noise: float) -> Plateau:
    """Find the plateau of one press that begins after sample ``start``; compression positive. [s, mm]"""
    top = float(x.max())
    first, window = slowing(time, x, top, start, noise)
    last, released, back = _leaving(time, x, top, noise)
    if last <= first or not _stands(time, x, top, start, (first, last), (window, back if released else 0.0), noise):
        return Plateau(top, float(time[first]), float(time[first]), False, 0.0, float(time[first]))
    half = min(int(np.searchsorted(time, 0.5 * (time[first] + time[last]))), max(last - 1, first))
    level = _level(time[half : last + 1], x[half : last + 1], noise, top)
    inside = slice(first, last + 1)
    close = np.abs(x[inside] - level) <= max(NEAR_MM, NEAR_SHARE * top)
    swing = float(np.max(np.abs(x[half : last + 1] - level)))
    rings = swing > max(NEAR_MM, NEAR_SHARE * top)
    depth = level if rings or not close.any() else _median(time[inside], x[inside], close)
    end = _end(time, x, depth, (first, last), swing if rings else 0.0, back if released else None)
    last = max(int(np.searchsorted(time, end, side="right")) - 1, first)  # leaving is no ringing
    return _with_ringing(time, x, depth, (first, last), end, noise)


def slowing(
    time: NDArray,
    x: NDArray,
    depth: float,
    start: int,
    noise_mm: float = 0.0,
    share: float = SLOWED,
    multiple: float = 10.0,
) -> tuple[int, float]:
    """Sample after 60 % of the depth from which the punch goes on at a tenth of its speed; the window of that. [s]

    A rest below :data:`STAGE` of the depth, after which it presses on at speed, is a stage and no stop.
    """
    late = int(np.argmax(x >= 0.6 * depth))
    speed = max(x[late] - x[start], 1e-12) / max(time[late] - time[start], 1e-9)
    least = max(10.0 * STEP_MM, min(multiple * noise_mm, 0.2 * depth))
    window = max(least / speed, 3.0 * float(np.median(np.diff(time[start : late + 4]))))
    until = int(np.searchsorted(time, time[-1] - window, side="right"))
    ahead = np.interp(time[late:until] + window, time, x) - x[late:until]
    beyond = x >= STAGE * depth
    # outliers of the position are beyond for a shorter time than the way there takes, and no place to press on to
    stays = np.sum(np.diff(time)[beyond[1:] & beyond[:-1]]) > (1.0 - STAGE) * depth / speed
    below = ahead[: max(int(np.argmax(beyond)) - late, 0) if stays else 0]
    begin = int(np.flatnonzero(below > 0.5 * speed * window)[-1:].sum())
    slow = np.flatnonzero(ahead[begin:] <= share * speed * window)
    sample = late + begin + int(slow[0]) if len(slow) else len(time) - 1
    return sample, window


def ramp_start(time: NDArray, x: NDArray, noise_mm: float) -> tuple[int, float, float]:
    """Last sample before the punch presses, when it begins to [s], and where [mm].

    That is where it passes 0 at speed, or where it leaves a rest, at whatever displacement. At rest it goes on at less
    than a tenth of its speed between a tenth and 60 % of the largest displacement.
    """
    top = float(x.max())
    low, late = (int(np.argmax(x >= share * top)) for share in (BEGUN, 0.6))
    before = max(low - 1, 0)
    if late == before:  # pressed from the first sample on
        return 0, float(time[0]), max(float(x[0]), 0.0)
    speed = (x[late] - x[before]) / max(float(time[late] - time[before]), 1e-9)
    window = max(10.0 * STEP_MM, min(10.0 * noise_mm, 0.2 * top)) / speed
    earlier = np.maximum(np.arange(low) - 1, 0)
    back = np.minimum(time[:low] - window, time[earlier])
    went = x[:low] - np.interp(back, time, x)
    still = np.flatnonzero(went <= SLOWED * speed * (time[:low] - back))
    below = np.flatnonzero(x[: low + 1] <= 0.0)
    start = max(int(still[-1]) if still.size else 0, int(below[-1]) if below.size else 0)
    level = max(float(np.median(x[(time >= time[start] - window) & (time <= time[start])])), 0.0)
    after = min(start + 2, len(x) - 1)
    slope = max(
        (x[start + 1] - x[start]) / (time[start + 1] - time[start]),
        (x[after] - x[start + 1]) / max(float(time[after] - time[start + 1]), 1e-12),
        1e-12,
    )
    contact = float(time[start + 1] - (x[start + 1] - level) / slope)
    return start, min(max(contact, float(time[start])), float(time[start + 1])), level


def noise_of(values: NDArray) -> float:
    """Noise of one sample by second differences, which a smooth path or force does not have. [mm, N]"""
    if len(values) < 5:
        return 0.0
    second = np.abs(values[2:] - 2.0 * values[1:-1] + values[:-2])
    return float(np.median(second) / 0.6745 / np.sqrt(6.0))


def time_at(time: NDArray, x: NDArray, level: float) -> float:
    """Time at which a path first reaches a level, on the line between its samples. [s]"""
    at = max(int(np.argmax(x >= level)), 1)
    share = (level - x[at - 1]) / max(float(x[at] - x[at - 1]), 1e-12)
    return float(time[at - 1] + np.clip(share, 0.0, 1.0) * (time[at] - time[at - 1]))


def _leaving(time: NDArray, x: NDArray, top: float, noise: float) -> tuple[int, bool, float]:
    """Last sample before the punch leaves, whether it leaves, and the window of the speed; time runs backward. [s]"""
    if x[-1] > RELEASED * top:
        return len(x) - 1, False, 0.0
    back_time, back = -time[::-1], x[::-1]
    sample, window = slowing(back_time, back, top, ramp_start(back_time, back, noise)[0], noise)
    return len(x) - 1 - sample, True, window


def _stands(
    time: NDArray, x: NDArray, top: float, start: int, ends: tuple[int, int], windows: tuple[float, float], noise: float
) -> bool:
    """Whether the punch stands between two samples, and does not only turn there.

    A sharp turn is slow for about one window. A round one, such as half a sine, passes gradually from half of its
    speed to a tenth; a stop does so at once.
    """
    first, last = ends
    lasts = float(time[last] - time[first])
    if lasts <= SHORT * sum(windows):
        return False
    deep = np.flatnonzero(x >= 0.6 * top)
    if windows[1] == 0.0 or lasts > TURNS * float(time[deep[-1]] - time[deep[0]]):
        return True
    middle = 0.5 * float(time[first] + time[last])
    half_speed, tenth = (
        float(time[slowing(time, x, top, start, noise, share, NOISELESS)[0]]) for share in (0.5, SLOWED)
    )
    return middle - tenth > ABRUPT * (middle - half_speed)


def _median(time: NDArray, x: NDArray, use: NDArray | slice = slice(None)) -> float:
    """Median over time; over the samples where they are even. [mm]"""
    kept = x[use]
    gaps = np.diff(time)
    if len(time) < 3 or float(gaps.max()) < 2.0 * float(gaps.mean()):
        return float(np.median(kept))
    order = np.argsort(kept, kind="stable")
    share = np.cumsum(np.gradient(time)[use][order])
    return float(kept[order][int(np.searchsorted(share, 0.5 * share[-1]))])


def crossings(time: NDArray, offset: NDArray, least: float) -> NDArray:
    """Times at which an offset changes its sign, after it went beyond ``least`` on both sides; the first rises. [s]"""
    far = np.flatnonzero(np.abs(offset) > least)
    change = np.flatnonzero(np.diff(np.sign(offset[far])) != 0)
    return np.asarray(0.5 * (time[far[change]] + time[far[change + 1]]))


def _level(time: NDArray, x: NDArray, noise: float, top: float) -> float:
    """Level of the later half of a plateau: the median, or the mean over whole periods where it still rings. [mm]"""
    every = max(len(x) // ENOUGH, 1)
    level = _median(time[::every], x[::every])
    turns = crossings(time, x - level, max(SURE * noise, SEEN_SHARE * top))
    if len(turns) < FEWEST_TURNS:
        return level
    begin, end = turns[0], turns[-1 if len(turns) % 2 else -2]
    inside = (time > begin) & (time < end)
    at = np.r_[begin, time[inside], end]
    values = np.interp(at, time, x)
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(at)) / (end - begin))


def _end(time: NDArray, x: NDArray, depth: float, ends: tuple[int, int], swing: float, back: float | None) -> float:
    """Time at which the punch begins to leave for good, on the line of its release. [s]"""
    first, slow = ends
    wander = max(LEAVE_MM, LEAVE_SHARE * depth) + swing
    last = int(np.flatnonzero(x >= depth - wander)[-1])
    if last == len(time) - 1:
        return float(time[-1])
    deep = depth - max(3.0 * wander, 0.15 * depth)
    fallen = np.flatnonzero(x[last:] <= deep)
    after = last + int(fallen[0]) if fallen.size else len(time) - 1
    speed = float(x[last] - x[after]) / float(time[after] - time[last])
    ramp = depth / max(float(time[first] - time[0]), 1e-9)
    if back is None and not fallen.size and speed < SAG * ramp:
        return float(time[-1])
    end = max(float(time[last]) - wander / max(speed, 1e-9), float(time[first]))
    if back is not None and float(time[slow]) > end + 2.0 * back:
        return float(time[slow])
    return end


def _with_ringing(
    time: NDArray, x: NDArray, depth: float, ends: tuple[int, int], end_s: float, noise: float
) -> Plateau:
    """The plateau with its overshoot, if it has one: farther than the noise, and back again."""
    first, last = ends
    arrival = first - int(np.argmax(x[first::-1] < depth))
    own, offset = time[arrival : last + 1], x[arrival : last + 1] - depth
    farthest = int(np.argmax(offset))
    over = float(offset[farthest])
    least = max(SURE * noise, SEEN_SHARE * depth, min(1.2 * STEP_MM, 0.01 * depth))
    slowed = float(time[first])
    if over <= least or float(offset[farthest:].min()) > 0.3 * over:
        return Plateau(depth, slowed, end_s, True, 0.0, slowed)
    turns = crossings(own, offset, least)
    period = 2.0 * float(np.median(np.diff(turns[:9]))) if len(turns) > 2 else 4.0 * float(own[farthest] - own[0])
    rests = max(SURE * noise, STILL_SHARE * depth, min(0.6 * STEP_MM, 0.01 * depth))
    settled = float(own[int(np.flatnonzero(np.abs(offset) > rests)[-1])])
    return Plateau(depth, slowed, end_s, True, over, settled, max(period, 1e-9))
