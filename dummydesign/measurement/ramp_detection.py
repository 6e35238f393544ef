"""Landmarks of measured presses: contact, stop, holds; speed, depth and forces of a press."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, errors_within
from dummydesign.core.interpolation import true_runs
from dummydesign.measurement.commanded_speed import CommandedSpeed, commanded_speed
from dummydesign.measurement.motion import DECELERATION_MM_S2, LATE, Motion, contact_velocity
from dummydesign.measurement.plateau import SLOWED, find_plateau, noise_of, ramp_start, slowing, time_at
from dummydesign.measurement.trace import Trace


@dataclass(frozen=True)
class Ramp:
    """What a motion did: contact, stop, the depth it held and until when.

    ``velocity_mm_s`` is the mean speed from contact to stop, the v of an ideal ramp with the same t_p. A punch that
    overshot went ``overshoot_mm`` beyond the depth and rang with ``period_s`` until ``settled_s``; without that the
    first and the last are 0. A press without a hold ends at its stop. ``path`` is the motion that was read.
    """

    contact_time_s: float
    stop_time_s: float
    hold_end_s: float
    depth_mm: float
    velocity_mm_s: float
    overshoot_mm: float
    settled_s: float
    period_s: float
    path: Motion = field(repr=False, compare=False)

    @cached_property
    def speed(self) -> CommandedSpeed:
        """Speed that the robot was sent with, and its braking."""
        return commanded_speed(self.path, self.contact_time_s, self.stop_time_s, self.depth_mm, self.overshoot_mm > 0.0)

    @property
    def rise_time_s(self) -> float:
        """Time from contact to stop, t_p of the ideal ramp. [s]"""
        return self.stop_time_s - self.contact_time_s


DEEP = 0.9
"""Share of the largest displacement from which a punch is deep."""
HOLD_FRACTION = 0.1
"""A hold lasts at least this fraction of the time that the ramps alone take."""

BRAKES = 0.25
"""Time of a constant braking from a tenth of the speed on, over that from half of it to a tenth: 0.1 / 0.4."""


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


Stop = Literal["reached", "slowed"]


def ramp_of(trace: Trace, stop: Stop = "slowed") -> Ramp:
    """Find the ramp and hold of a trace; a fault names it."""
    with errors_within(trace.name):
        return find_ramp(trace.time_s, trace.displacement_mm, stop)


def find_ramp(time_s: ArrayLike, displacement_mm: ArrayLike, stop: Stop = "reached") -> Ramp:
    """Find contact, stop, held depth and end of hold in one measured ramp and hold.

    Contact is where the punch passes 0, or where it leaves a rest, which may lie at any displacement near 0.

    Depth and end are those of the plateau (:func:`~dummydesign.measurement.plateau.find_plateau`), whatever the
    punch overshot and rang before. Without a plateau the hold ends at the stop. Two rules for the stop:

    - ``reached``: where the motion, extrapolated at the speed it has over the last hundredths of a millimetre,
      reaches that depth. Exact for a clean ramp. A punch that creeps to its depth stops where it slows.
    - ``slowed``: where the speed, over a window that steps of 5 um do not disturb, falls to a tenth of that
      between contact and 60 % of the depth. It does not move when the robot creeps by hundredths of a millimetre
      afterwards. A motion that ends while it presses has its stop there; one that overshoots, where it passes the
      depth.
    """
    time, x = np.asarray(time_s, float), np.asarray(displacement_mm, float)
    largest = float(x.max())
    if largest <= 0:
        text = f"the motion contains no compression: largest displacement_mm = {largest:g}; compression is positive"
        raise InputError(text, "nothing_found", "displacement_mm", largest)
    if x[0] > 0.1 * largest:
        text = f"the motion starts pressed at displacement_mm = {x[0]:g}; it must begin at or before contact"
        raise InputError(text, "not_enough_data", "displacement_mm", float(x[0]))
    noise = noise_of(x)
    start, contact, level = ramp_start(time, x, noise)
    begun = contact, level
    if last := last_ramp(x):
        time, x, start = time[last:], x[last:], 0
        begun = float(time[0]), float(x[0])
    plateau = find_plateau(time, x, start, noise)
    depth = plateau.depth_mm
    if stop == "reached":
        stopped = _reached(time, x, depth, min(0.02, 0.01 * depth))
        half, window = slowing(time, x, depth, start, noise, 0.5)
        late = plateau.slowed_s + BRAKES * max(plateau.slowed_s - float(time[half]), 0.0) + window
        stopped = min(stopped, plateau.slowed_s) if plateau.overshoot_mm or stopped > late else stopped
    else:
        stopped = float(time[slowing(time, x, depth, start, noise)[0]])
        if plateau.overshoot_mm:
            stopped = min(stopped, time_at(time, x, depth))
    end = max(plateau.end_s, stopped) if plateau.held else stopped
    settled = min(max(plateau.settled_s, stopped), end)
    return Ramp(
        contact,
        stopped,
        end,
        depth,
        (depth - begun[1]) / max(stopped - begun[0], 1e-9),
        plateau.overshoot_mm,
        settled,
        plateau.period_s,
        Motion(time, x),
    )


def last_ramp(x: NDArray) -> int:
    """Sample at which the last of several ramps begins, at half of the depth; 0 where there are no cycles before."""
    largest = x.max()
    deep = int(np.flatnonzero(x >= DEEP * largest)[-1])
    half = int(np.flatnonzero(x[:deep] < 0.5 * largest)[-1:].sum())
    return half if x[: half + 1].max() >= 0.6 * largest else 0


def _reached(time: NDArray, x: NDArray, depth: float, reach: float) -> float:
    """Stop time from the crossing of depth - reach and the speed between depth - 4 reach and there."""
    late, early = (time_at(time, x, depth - way) for way in (reach, 4.0 * reach))
    return min(late + (late - early) / 3.0, float(time[-1]))


def planned_velocity(ramp: Ramp, planned_mm_s: float) -> float:
    """The planned speed where the motion can be one of it, else the nearest that it can be of. [mm/s]

    A press that brakes from contact on says at which speed it touched, and nothing of how much faster it was sent. A
    plan to that speed is kept also by a robot that brakes harder than is planned with, and touches faster.
    """
    speed = ramp.speed
    touch = float(contact_velocity(speed.low_mm_s, ramp.depth_mm, speed.braking_mm_s2))
    brakes = touch < speed.low_mm_s or np.isinf(speed.high_mm_s)
    least = contact_velocity(touch, ramp.depth_mm, DECELERATION_MM_S2 if brakes else np.inf)
    return float(np.clip(planned_mm_s, least, speed.high_mm_s))


STEADY_PERIODS = 2.0
"""Periods of a ringing that is not over from which the steady force is read."""


def steady_force(time: NDArray, x: NDArray, force: NDArray, ramp: Ramp) -> tuple[float, float]:
    """Return the mean force of the last twentieth of the hold, and what ringing leaves of error (95 %). [N]

    Where the punch still rings there, the force is read at the held depth: on a parabola in the displacement, and a
    line in time, through the last two periods. What these miss changes its sign about four times a period.
    """
    begin = ramp.hold_end_s - LATE * (ramp.hold_end_s - ramp.stop_time_s)
    end = int(np.searchsorted(time, ramp.hold_end_s, side="right"))
    late = slice(min(int(np.searchsorted(time, begin)), end - 1), end)
    if ramp.settled_s > begin and ramp.overshoot_mm:
        middle = float(time[late].mean())
        since = max(min(begin, ramp.hold_end_s - STEADY_PERIODS * ramp.period_s), ramp.stop_time_s)
        use = slice(int(np.searchsorted(time, since)), end)
        off = x[use] - ramp.depth_mm
        rows = np.stack([np.ones(len(off)), time[use] - middle, off, off**2], axis=-1)
        if len(rows) >= 3 * rows.shape[1]:
            inverse = np.linalg.pinv(rows)
            values = inverse @ force[use]
            missed = np.sum((force[use] - rows @ values) ** 2) * ramp.period_s / (4.0 * np.ptp(time[use]))
            return float(values[0]), 2.0 * float(np.sqrt(missed) * np.linalg.norm(inverse[0]))
    return float(force[late].mean()), 0.0


FIRST_RINGS, NODES_A_RING, MOST_NODES = 2.0, (32.0, 16.0), 800
"""Periods after the stop with more nodes, nodes in a period there and later, and how many there are at most: straight
lines between 16 points miss a sine by 2 % of its amplitude."""
WIDER, WIDEST = 1.3, 0.12
"""Ratio of neighbouring steps after the ringing, and their largest share of the time since the stop: curves through
points whose distances jump swing out."""


def ringing_times(ramp: Ramp) -> NDArray:
    """Return times at which a model follows a punch that rings after its stop; empty without an overshoot. [s]

    They go on in growing steps until those of a hold are as wide.
    """
    if not ramp.overshoot_mm or ramp.settled_s <= ramp.stop_time_s:
        return np.zeros(0)
    fine, wide = (ramp.period_s / nodes for nodes in NODES_A_RING)
    turn = min(ramp.stop_time_s + FIRST_RINGS * ramp.period_s, ramp.settled_s)
    times = np.r_[np.arange(ramp.stop_time_s, turn, fine), np.arange(turn, ramp.settled_s, wide), ramp.settled_s]
    times = times[:MOST_NODES]
    beyond, step = [float(times[-1])], WIDER * wide
    while step < WIDEST * (beyond[-1] - ramp.stop_time_s) and beyond[-1] + step < ramp.hold_end_s:
        beyond.append(beyond[-1] + step)
        step *= WIDER
    return np.r_[times, beyond[1:]]


def find_holds(time_s: NDArray, displacement_mm: NDArray) -> tuple[Hold, ...]:
    """Find the stretches in which the plates stand still under load, up to the end of the deepest.

    The speed of the ramps is the median over a hundred even steps of displacement, so that it does not depend
    on how long was held. Still is a tenth of it over the time in which the ramp goes 2 %. A curve that only
    loads, or loads and unloads, has no hold.
    """
    time, x = np.asarray(time_s, float), np.asarray(displacement_mm, float)
    top = np.maximum.accumulate(x)
    deepest = float(top[-1])
    passed = np.searchsorted(top, np.linspace(0.02, 0.98, 97) * deepest)
    crossing = np.diff(time[np.minimum(passed, len(time) - 1)])
    # fast ramps cross several levels between two samples
    one = max(float(np.median(crossing)), float(np.sum(crossing[crossing <= 3 * np.median(crossing)])) / len(crossing))
    half = max(one, 2.0 * float(np.median(np.diff(time))))
    speed = 0.01 * deepest / max(one, 1e-12)
    moved = np.abs(np.interp(time + half, time, x) - np.interp(time - half, time, x))
    still = true_runs((moved <= SLOWED * speed * 2.0 * half) & (x > 0.03 * deepest))
    least = max(HOLD_FRACTION * 100.0 * one, 4.0 * half)
    reach = max(0.002 * deepest, 0.01)
    holds: list[Hold] = []
    for first, after in still:
        level = float(np.median(x[first:after]))
        begin, end = _stretch(x, first, after - 1, level, reach)
        if time[end] - time[begin] < least or end - begin < 10:
            continue
        if holds and level < holds[-1].displacement_mm - reach:
            break
        if holds and time[begin] <= holds[-1].end_s + 2 * half and abs(level - holds[-1].displacement_mm) <= reach:
            holds[-1] = Hold(holds[-1].start_s, float(time[end]), holds[-1].displacement_mm)
        else:
            holds.append(Hold(float(time[begin]), float(time[end]), level))
    return tuple(holds)


def _stretch(x: NDArray, first: int, last: int, level: float, reach: float) -> tuple[int, int]:
    """First and last sample within ``reach`` of a place, around the samples that stand still."""
    deep = x >= level - reach
    begin = first + int(np.argmax(deep[first : last + 1]))
    before, beyond = np.flatnonzero(~deep[:begin]), np.flatnonzero(np.abs(x[last + 1 :] - level) > reach)
    return int(before[-1]) + 1 if before.size else 0, last + int(beyond[0]) if beyond.size else len(x) - 1


SHORTEST_HOLD_S = 0.3
SHALLOWEST_MM = 0.02


@dataclass(frozen=True)
class Summary:
    """Numbers of one press; ``steady_force_N`` (None without a hold) and ``rings_N`` are of :func:`steady_force`."""

    velocity_mm_s: float
    hold_s: float
    depth_mm: float
    peak_force_N: float
    steady_force_N: float | None
    rings_N: float
    stop_time_s: float
    hold_end_s: float

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers of the press, without its times."""
        kept = ("velocity_mm_s", "hold_s", "depth_mm", "peak_force_N", "steady_force_N")
        return {key: getattr(self, key) for key in kept}


def summarise(file: str, time: NDArray, x: NDArray, force: NDArray) -> Summary:
    """Summarise one press, zero at contact and compression positive."""
    if x.max() < SHALLOWEST_MM:
        raise InputError(
            f"{file}: presses {x.max():.3g} mm deep only, counted from contact; is the displacement that of the punch? "
            "(--columns displacement=NAME, --contact N)",
            "nothing_found",
            "depth_mm",
            float(x.max()),
        )
    with errors_within(file, "; record from before contact, or say --contact N"):
        ramp = find_ramp(time, x, "slowed")
    hold = max(ramp.hold_end_s - ramp.stop_time_s, 0.0)
    steady, rings_N = steady_force(time, x, force, ramp) if hold >= SHORTEST_HOLD_S else (None, 0.0)
    held = 0.0 if steady is None else hold
    speed, peak_N = ramp.speed.value_mm_s, float(force.max())
    return Summary(speed, held, ramp.depth_mm, peak_N, steady, rings_N, ramp.stop_time_s, ramp.hold_end_s)
