"""What looks wrong in a press although it could be read. Each doubt rests on two signs, and says what to do."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.press.contact import Contact
from dummydesign.measurement.importing.press.signs import middle_of_three, noise_of
from dummydesign.measurement.importing.press.summary import Summary

Warn = Callable[[str, str], None]

FALLING = 0.01
"""Share of the force by which it may still fall over the last fifth of a hold and be called steady."""
SHORT_HOLD_S = 10.0
"""Hold of the published protocol; no shorter one is called too short unless the force still falls."""
GRAMS_N_PER_MM, GRAMS_N = 100.0, 200.0
INCHES_N_PER_MM, INCHES_MM = 60.0, 0.5
"""Stiffness and size beyond any hand or pad (a 5 mm pad: 7 N/mm at 15 N): both must agree before a unit is doubted."""


def check_press(
    name: str, time: NDArray, x: NDArray, force: NDArray, contact: Contact, summary: Summary, warn: Warn
) -> None:
    """Warn of what looks wrong in one press.

    Parameters
    ----------
    name : str
        How the press is called in messages.
    time, x, force : ndarray, shape (n,)
        As written to the trace. [s, mm, N]
    contact : Contact
        What was found of lead-in and contact.
    summary : Summary
        Speed, hold and depth of the press.
    warn : callable of (code, message)
        Called for each doubt.
    """
    noise = max(contact.noise_N, noise_of(force))
    _lead_in(name, contact, summary, warn)
    _hold(name, time, force, summary, noise, warn)
    _several_holds(name, time, x, summary, warn)
    _clipped(name, time, x, force, warn)
    _gaps(name, time, x, summary, warn)
    _dropped(name, time, x, force, summary, noise, warn)
    _spikes(name, time, force, noise, warn)
    _units(name, summary, warn)


def _lead_in(name: str, contact: Contact, summary: Summary, warn: Warn) -> None:
    if abs(contact.drift_N) > max(0.01 * summary.peak_force_N, 4.0 * contact.noise_N):
        warn(
            "force_before_contact",
            f"{name}: the force changes by {contact.drift_N:+.3g} N before contact; let the sensor settle, or look for "
            "something that touches earlier",
        )


def _hold(name: str, time: NDArray, force: NDArray, summary: Summary, noise: float, warn: Warn) -> None:
    if summary.steady_force_N is None or summary.hold_s >= 0.95 * SHORT_HOLD_S:
        return
    begin = summary.hold_end_s - 0.2 * summary.hold_s
    late = (time >= begin) & (time <= summary.hold_end_s)
    if late.sum() < 6:
        return
    slope = float(np.polyfit(time[late] - begin, force[late], 1)[0])
    fall = -slope * 0.2 * summary.hold_s
    if fall > FALLING * summary.steady_force_N and fall > 4.0 * noise / np.sqrt(late.sum()):
        warn(
            "hold_too_short",
            f"{name}: after {summary.hold_s:.3g} s the force still falls, by "
            f"{100 * fall / summary.steady_force_N:.1f} % in "
            f"the last {0.2 * summary.hold_s:.2g} s: {summary.steady_force_N:.3g} N is no steady force; hold for 10 s",
        )


def _several_holds(name: str, time: NDArray, x: NDArray, summary: Summary, warn: Warn) -> None:
    """Staircases: other plateaus than the deepest, where the punch presses and stands."""
    grid = np.linspace(time[0], time[-1], 2000)
    place = np.interp(grid, time, x)
    step = grid[1] - grid[0]
    slow = np.abs(np.gradient(place, step)) < 0.05 * max(summary.velocity_mm_s, 1e-9)
    pressed = slow & (place > 0.1 * summary.depth_mm) & (np.abs(place - summary.depth_mm) > 0.05 * summary.depth_mm)
    edges = np.flatnonzero(np.diff(np.r_[0, pressed.astype(np.int8), 0]))
    plateaus = [
        float(np.median(place[a:b]))
        for a, b in zip(edges[::2], edges[1::2])
        if (b - a) * step > max(0.3, 5.0 * step, 0.3 * summary.hold_s)
    ]
    if plateaus:
        depths = ", ".join(f"{depth:.2f}" for depth in sorted({*plateaus, summary.depth_mm}))
        warn(
            "several_holds",
            f"{name}: the punch stands at several depths ({depths} mm) without coming back to zero between; fits "
            "read one ramp and one hold: press each depth by itself, or cut the file",
        )


def _clipped(name: str, time: NDArray, x: NDArray, force: NDArray, warn: Warn) -> None:
    """The load cell's end: the largest value over and over while the punch still moves, and no other value does so."""
    top = float(force.max())
    at_top = _longest(force >= top)
    first, last = at_top
    length = last - first
    if length < 5 or top <= 0:
        return
    below = force[(force > 0.5 * top) & (force < top)]
    usual = _longest_equal(below) if len(below) > 10 else 1
    moved = abs(float(x[last - 1] - x[first])) > 0.02 * float(np.ptp(x))
    if length > 4 * usual and (moved or length > 10 * usual):
        warn(
            "clipped",
            f"{name}: the force stands at exactly {top:.6g} N for {length} samples from {time[first]:.4g} s: the "
            "load cell or its amplifier is at its end; use a larger range, and do not fit this press",
        )


def _longest(mask: NDArray) -> tuple[int, int]:
    edges = np.flatnonzero(np.diff(np.r_[0, mask.astype(np.int8), 0]))
    lengths = edges[1::2] - edges[::2]
    best = int(np.argmax(lengths))
    return int(edges[2 * best]), int(edges[2 * best + 1])


def _longest_equal(values: NDArray) -> int:
    change = np.flatnonzero(np.diff(values) != 0)
    return int(np.max(np.diff(np.r_[-1, change, len(values) - 1])))


def _gaps(name: str, time: NDArray, x: NDArray, summary: Summary, warn: Warn) -> None:
    """Time without samples while the punch moves on or the press goes on."""
    step = np.diff(time)
    usual = np.maximum(np.r_[step[1:], step[-1]], np.r_[step[0], step[:-1]])
    pressed = x[1:] > 0.02 * summary.depth_mm
    hole = (step > 8.0 * usual) & (step > 5.0 * float(np.median(step))) & pressed
    moved = np.abs(np.diff(x)) > 0.1 * summary.depth_mm
    rising = time[1:] <= summary.stop_time_s
    found = np.flatnonzero(hole & (moved | rising | (step > 0.2 * max(summary.hold_s, 1e-9))))
    if found.size:
        at = int(found[0])
        warn(
            "drop_out",
            f"{name}: no samples from {time[at]:.4g} to {time[at + 1]:.4g} s ({found.size} such gaps) within the "
            "press; the force between is not known: record again",
        )


def _dropped(name: str, time: NDArray, x: NDArray, force: NDArray, summary: Summary, noise: float, warn: Warn) -> None:
    """Force at zero for a few samples while the punch is deep, or both columns frozen while it should move."""
    deep = (x > 0.5 * summary.depth_mm) & (time <= summary.hold_end_s)
    near = np.median(force[deep]) if deep.any() else 0.0
    deep &= np.cumsum(force > 0.5 * near) > 0  # a filtered force is late in a fast rise
    lost = np.flatnonzero(deep & (np.abs(force) < max(3.0 * noise, 0.02 * near)) & (near > 20.0 * max(noise, 1e-9)))
    if lost.size:
        warn(
            "drop_out",
            f"{name}: the force is zero at {time[lost[0]]:.4g} s ({lost.size} samples) while the punch presses "
            f"{x[lost[0]]:.3g} mm deep: a loose contact? record again",
        )
    same = (np.diff(x) == 0) & (np.diff(force) == 0)
    rise = (x[1:] > 0.02 * summary.depth_mm) & (x[1:] < 0.95 * summary.depth_mm) & (time[1:] < summary.stop_time_s)
    first, last = _longest(same & rise) if (same & rise).any() else (0, 0)
    if (
        last - first >= 5
        and last < len(x) - 1
        and abs(x[last + 1] - x[last]) > 3.0 * float(np.median(np.abs(np.diff(x)[rise])))
    ):
        warn(
            "drop_out",
            f"{name}: force and position repeat for {last - first} samples from {time[first]:.4g} s in the rise and "
            "then jump: the recording stood still; record again",
        )


def _spikes(name: str, time: NDArray, force: NDArray, noise: float, warn: Warn) -> None:
    """Single samples far off their neighbours, which agree with each other."""
    if len(force) < 20:
        return
    off = np.abs(force - middle_of_three(force))[1:-1]
    across = np.abs(force[2:] - force[:-2])
    limit = max(15.0 * noise, 0.03 * float(force.max()))
    found = np.flatnonzero((off > limit) & (across < 0.3 * off)) + 1
    if 0 < found.size <= max(0.01 * len(force), 3):
        worst = int(found[np.argmax(off[found - 1])])
        warn(
            "spike",
            f"{name}: {found.size} single samples stand out, by {off[worst - 1]:.3g} N at {time[worst]:.4g} s; they "
            "are kept: mend the shielding, or take them out before fitting",
        )


def _units(name: str, summary: Summary, warn: Warn) -> None:
    stiffness = summary.peak_force_N / max(summary.depth_mm, 1e-9)
    seen = f"{name}: {summary.peak_force_N:.4g} N at {summary.depth_mm:.3g} mm is stiffer than any hand or pad"
    if stiffness > GRAMS_N_PER_MM and summary.peak_force_N > GRAMS_N:
        warn("far_from_known", f"{seen}: is the force in grams? say --units force=gf if so")
    elif stiffness > INCHES_N_PER_MM and summary.depth_mm < INCHES_MM:
        warn("far_from_known", f"{seen}: is the position in inches? say --units displacement=in if so")
