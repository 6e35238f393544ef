"""What sensors do to a recording: the low-pass of a force, the end of a load cell's range, a position in steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.interpolation import true_runs
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.core.serialise import Serialised
from dummydesign.measurement.importing.baseline import digit_step
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.sign_convention import middle_of_three
from dummydesign.measurement.plateau import noise_of


@dataclass(frozen=True)
class Lowpass(Serialised):
    """A Butterworth low-pass: cut-off [Hz] of one pass, order, and 1 pass (causal) or 2 (there and back)."""

    cutoff_hz: float
    order: int = 2
    passes: int = 1

    def __post_init__(self) -> None:
        if not (np.isfinite(self.cutoff_hz) and self.cutoff_hz > 0):
            raise out_of_range("low-pass cut-off in Hz", self.cutoff_hz, "above 0", "any finite frequency")
        if self.order not in range(1, 9):
            raise out_of_range("low-pass order", self.order, 1, 8)
        if self.passes not in (1, 2):
            raise out_of_range("low-pass passes", self.passes, 1, 2, "2 is there and back without delay")

    def apply(self, time_s: ArrayLike, force_N: ArrayLike) -> NDArray:
        """Filter a force on any, also uneven, sampling.

        The analogue filter is solved exactly for a force that is linear between its samples: each pole p
        with residue q gives y' = p y + q u. Before the first sample the force is taken as constant.
        Two passes run there and back (no delay); the cut-off is that of one pass, so that the sum is
        6 dB down there.

        References
        ----------
        S. Butterworth, Experimental Wireless 7 (1930) 536. The paper's own filter is "second-order ... 35 Hz"
        (section II-C); its kind and number of passes are not stated.
        """
        time, force = np.asarray(time_s, float), np.asarray(force_N, float)
        step = np.diff(time, axis=-1)
        if np.any(step <= 0):
            raise InputError("time_s must increase strictly", "malformed", "time_s")
        once = _one_pass(step, force, self.cutoff_hz, self.order)
        if self.passes == 1:
            return once
        return _one_pass(step[..., ::-1], once[..., ::-1], self.cutoff_hz, self.order)[..., ::-1]


def parse_lowpass(text: str | None) -> Lowpass | None:
    """Read ``HZ[:ORDER[:PASSES]]`` as given on the command line; None stays None."""
    if text is None:
        return None
    cutoff, *counts = text.split(":")
    try:
        return Lowpass(float(cutoff), *map(int, counts))
    except (TypeError, ValueError):  # more than three parts, or one that is no number
        raise InputError(
            f"low-pass '{text}' is not HZ[:ORDER[:PASSES]], such as 35 or 35:2:1", "malformed", "lowpass", text
        ) from None


def _one_pass(step: NDArray, force: NDArray, cutoff_hz: float, order: int) -> NDArray:
    """Run the filter forward once; ``step`` are the time steps."""
    cutoff = 2.0 * np.pi * cutoff_hz
    poles = cutoff * np.exp(1j * np.pi * (2 * np.arange(order) + order + 1) / (2 * order))
    filtered = np.zeros(np.broadcast_shapes(force.shape, (*step.shape[:-1], force.shape[-1])))
    slope = np.diff(force, axis=-1) / step
    for index, pole in enumerate(poles):
        if pole.imag < -1e-9 * cutoff:
            continue  # its conjugate is counted twice
        residue = cutoff**order / np.prod(pole - np.delete(poles, index))
        weight = 1.0 if abs(pole.imag) <= 1e-9 * cutoff else 2.0
        change = pole * step
        growth = np.expm1(change)
        constant = growth / pole
        ramp = (growth - change) / pole**2
        # (e^z - 1 - z) loses its digits for small z; its series does not
        small = np.abs(change) < 1e-3
        ramp = np.where(small, step**2 * (0.5 + change / 6 + change**2 / 24), ramp)
        addend = residue * (force[..., :-1] * constant + slope * ramp)
        first = -residue / pole * force[..., 0]
        state = linear_recurrence(np.exp(change), addend, first)
        filtered[..., 1:] += weight * state.real
        filtered[..., 0] += weight * first.real
    return filtered


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


MIDDLE, SLOWER = 0.45, 2.5
"""Share of the travel about its middle that is on the way, and samples from one change to the next there from which a
position goes in steps."""
COARSE, WARNED = 0.003, 0.01
"""Step over the travel from which it matters, and from which there is a warning."""
FEWEST, AT_REST = 6, 0.05
"""Changes on the way between which a position is read, and share of the largest below which one is noise at rest."""
STANDS = 3.0
"""Multiple of the usual time between two changes beyond which the punch stands."""
EVERY = 0.9
"""Share of the samples on the ways in and out from which every one of them changes."""
EVEN, MOST = 0.02, 30.0
"""How far a rounded position's steps may be off multiples of one digit, and the largest multiple."""


def read_between_changes(time: NDArray, x: NDArray, log: ImportLog) -> tuple[NDArray, float]:
    """The position at each sample: between changes on a line, where it stands as it is written; its step. [mm]

    A rounded position is half way between two values where it changes; one that is held is that of the new value. The
    steps of a rounded position are all multiples of one digit.

    Parameters
    ----------
    time, x : ndarray, shape (n,)
        [s, mm]
    """
    step, reach = np.abs(np.diff(x)), float(np.ptp(x))
    rows = np.flatnonzero(step) + 1
    moves = step[rows - 1] > AT_REST * step.max()  # after an overshoot the hold is about the middle too
    way = rows[moves & (np.abs(x[rows] - x.min() - 0.5 * reach) < MIDDLE * reach)]
    if few := len(way) < FEWEST:
        stands, jump = np.diff(np.r_[0, rows, len(x)]), int(np.argmax(step[rows - 1])) if len(rows) else 0
        usual, size = 0.0, float(step.max()) if np.min(stands[jump : jump + 2]) >= SLOWER else 0.0
    else:
        usual, size = float(np.median(np.diff(time[way]))), float(np.median(step[way - 1]))
    stepped = size >= COARSE * reach and (few or usual >= SLOWER * float(np.median(np.diff(time))))
    if not stepped:
        # at speed every sample may change, by several digits; where each one does by the same the path is even
        size = digit_step(x)
        every = not few and np.mean(np.diff(way) == 1) > EVERY
        if size <= WARNED * reach or (every and float(np.ptp(step[way - 1])) < 0.5 * size):
            return x, 0.0
    if size > WARNED * reach:
        log.warn(
            "coarse_position",
            f"the position goes in steps of {size:.2g} mm: contact and depth are known to {size:.2g} mm only, the "
            f"speed to {100.0 * size / reach:.0f} %; record it with more digits, or as often as the force",
        )
    if few or not stepped:
        return x, size
    digits = step[rows - 1] / step[rows - 1].min()
    rounded = bool(np.all(np.abs(digits - np.round(digits)) < EVEN * digits)) and digits.max() < MOST
    after, before = (0.5, 0.5) if rounded else (0.0, 1.0)
    changes = (0.5 * (time[rows] + time[rows - 1]), 0.5 * (x[rows] + x[rows - 1])) if rounded else (time[rows], x[rows])
    stands = np.diff(time[rows]) > STANDS * usual
    begun, ended = time[rows[:-1]][stands] + after * usual, time[rows[1:]][stands] - before * usual
    ends = time[rows[0]] - before * usual, time[rows[-1]] + after * usual
    places = np.r_[time[0] - usual, ends[0], changes[0], begun, ended, ends[1]]
    values = np.r_[x[0], x[0], changes[1], np.tile(x[rows[:-1]][stands], 2), x[-1]]
    order = np.argsort(places, kind="stable")
    why = f"it changes every {usual:.3g} s only, by {size:.2g} mm: " + ("few digits" if rounded else "a slower source")
    log.decide("position", "read where it changes", why)
    return np.interp(time, places[order], values[order]), size
