"""What sensors do to a recording: the low-pass of a force, digits, single spikes, the end of a load cell's range."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.interpolation import true_runs
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.core.serialise import Serialised
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


def digit_step(force: NDArray) -> float:
    """Step of the last digit of a force that repeats its values; 0 where it is finer than can be seen. [N]"""
    grain = 1e-7 * max(float(np.ptp(force)), 1e-12)
    steps = np.diff(np.unique(np.round(force / grain)))
    return float(steps.min()) * grain if 0 < len(steps) < 0.5 * len(force) and steps.min() > 2 else 0.0


def middle_of_three(values: NDArray) -> NDArray:
    """Median of each value and its two neighbours: single spikes disappear, edges stay."""
    if len(values) < 3:
        return values.copy()
    a, b, c = values[:-2], values[1:-1], values[2:]
    return np.r_[values[:1], np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c)), values[-1:]]


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
