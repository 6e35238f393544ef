"""Tare and contact of one press, from its lead-in and the first part of its rise, with the error of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.press.signs import noise_of
from dummydesign.measurement.importing.press.split import Span

RISE, SEEN = (0.03, 0.15), 80.0
"""The rise is looked at up to 80 times the noise: further up a law bends more; between these shares of the peak."""
LEAST_SEEN = 30.0
"""Multiple of the noise that is looked at in a press of little force, up to half of its peak."""
MISFIT = 0.02
"""Relative error that the law of the rise may have."""
LAW = 0.02
"""Share of the way from contact to the end of the part looked at by which a wrong law may shift the contact."""
POWERS = np.arange(0.8, 3.21, 0.15)
BENDS = np.linspace(-0.6, 0.1, 6)
"""Relative change of a power of the depth over the part looked at: what relaxes or stiffens on the way."""
LEAST_LEAD_IN = 5
_WAYS, _CELLS = 60, 80


@dataclass(frozen=True)
class Contact:
    """Where the punch touches, and what the force reads before.

    Attributes
    ----------
    position_mm : float
        Position at which the force begins, extrapolated back from where it is seen.
    low_mm, high_mm : float
        95 % interval.
    power : float
        Exponent of the rise.
    tare_N, tare_error_N : float
        Mean force before contact and its 95 % error; the error is infinite where there is no lead-in.
    noise_N : float
        Standard deviation of the force before contact.
    lead_in : int
        Samples before contact.
    drift_N : float
        Change of the force over the lead-in, 0 where it is within its noise.
    velocity_mm_s : float
        Speed through contact.
    peak_N : float
        Largest force of the press.
    """

    position_mm: float
    low_mm: float
    high_mm: float
    power: float
    tare_N: float
    tare_error_N: float
    noise_N: float
    lead_in: int
    drift_N: float
    velocity_mm_s: float
    peak_N: float


def find_contact(time: NDArray, x: NDArray, load: NDArray, span: Span, tare_N: float | None = None) -> Contact:
    """Find contact and tare of one press.

    The force before and shortly after contact is fitted by b + a u^n (1 + c u), u = max(x - x0, 0), along the
    measured position: b is the tare and x0 the contact; n is left free between 0.8 and 3.2 (a flat punch 1, a ball
    1.5, tissue 3), and c so that the force may bend by -60 to 10 % on the way. The interval of x0 is the profile of
    the misfit over a, b, c and n; x0 is the mean over that profile.

    Parameters
    ----------
    time, x, load : ndarray, shape (n,)
        The whole recording, compression positive, force less its reading at rest. [s, mm, N]
    span : Span
        The press.
    tare_N : float, optional
        The tare (less the reading at rest) where it is known. [N]
    """
    onset, start = span.onset, span.start
    peak = float(load[span.start : span.stop].max())
    grain = noise_of(load[start : onset + 1])
    level = float(np.clip(SEEN * grain, RISE[0] * peak, RISE[1] * peak))
    level = max(level, min(max(4.0 * float(load[onset]), LEAST_SEEN * grain), 0.5 * peak))
    top = onset + int(np.argmax(load[onset : span.stop] >= level))
    top = max(top, onset + 1, start + 2)
    reach = max(float(x[top] - x[onset]), 1e-6)
    out = np.nonzero(x[start : onset + 1] <= x[onset] - 4.0 * reach)[0]
    near = start + int(out[-1]) if out.size else _approach(x, start, onset, reach)
    centres, means, counts = _bins(x, load, start, near, top)
    noise = max(_noise(load[start : max(near, start)]), noise_of(load[start : top + 1]), 1e-9 * peak)
    low, high = float(x[start : onset + 1].min()), float(x[onset])
    low = max(low, high - 2.0 * reach)
    variance = noise**2 / counts + (0.3 * noise) ** 2 + (MISFIT * np.maximum(means, 0.0)) ** 2
    ways = np.linspace(low, high, _WAYS + 1)
    step = max((high - low) / _WAYS, 1e-6)
    likely = _profile(centres, means, variance, ways, tare_N)[0]
    best = int(np.argmin(likely))
    scale = max(1.0, float(likely[best]) / max(len(means) - 5, 1))
    wide = ways[likely <= likely[best] + 8.0 * scale]
    ways = np.linspace(float(wide.min()) - step, min(float(wide.max()) + step, high), _WAYS + 1)
    profile, powers = _profile(centres, means, variance, ways, tare_N)
    at = int(np.argmin(profile))
    scale = max(1.0, float(profile[at]) / max(len(means) - 5, 1))
    inside = ways[profile <= profile[at] + 4.0 * scale]
    weight = np.exp(-0.5 * (profile - profile[at]) / scale)
    position = float(np.sum(weight * ways) / weight.sum())
    spacing = _spacing(x, onset)
    margin = 0.5 * spacing + LAW * (float(x[top]) - position)
    left, right = float(inside.min()) - margin, float(inside.max()) + margin
    free = np.nonzero(x[start:onset] < min(left, position) - 0.25 * (position - left))[0]
    lead = load[start : start + (int(free[-1]) + 1 if free.size else 0)]
    tare, error, deviation, drift = _tare(lead, noise)
    speed = _speed(time, x, start, onset, top)
    return Contact(position, left, right, float(powers[at]), tare, error, deviation, len(lead), drift, speed, peak)


def _speed(time: NDArray, x: NDArray, start: int, onset: int, top: int) -> float:
    """Speed through contact: over the part looked at, or just before it where the punch brakes already."""
    way = float(x[top] - x[onset])
    before = start + int(np.argmax(x[start : onset + 1] >= x[onset] - 0.3 * way))
    ends = [(onset, top), (min(before, onset - 1), onset)] if onset > start else [(onset, top)]
    return max(float((x[b] - x[a]) / max(time[b] - time[a], 1e-9)) for a, b in ends)


def _approach(x: NDArray, start: int, onset: int, reach: float) -> int:
    """First sample of the approach: after it the punch only comes nearer."""
    lowest = float(x[start : onset + 1].min())
    return start + int(np.nonzero(x[start : onset + 1] <= lowest + 0.02 * reach)[0][-1])


def _bins(x: NDArray, load: NDArray, start: int, near: int, top: int) -> tuple[NDArray, NDArray, NDArray]:
    """Mean position and force: up to twenty bins before ``near``, then even steps of position to ``top``."""
    centres, means, counts = [], [], []
    for part in np.array_split(np.arange(start, near), 20) if near > start else []:
        if len(part):
            centres.append(float(x[part].mean()))
            means.append(float(load[part].mean()))
            counts.append(len(part))
    place = x[near : top + 1]
    span = max(float(place.max() - place.min()), 1e-12)
    cell = np.minimum(((place - place.min()) / span * _CELLS).astype(int), _CELLS - 1)
    number = np.bincount(cell, minlength=_CELLS)
    used = number > 0
    centres += (np.bincount(cell, place, _CELLS)[used] / number[used]).tolist()
    means += (np.bincount(cell, load[near : top + 1], _CELLS)[used] / number[used]).tolist()
    counts += number[used].tolist()
    return np.array(centres), np.array(means), np.array(counts, float)


def _profile(
    centres: NDArray, means: NDArray, variance: NDArray, ways: NDArray, tare_N: float | None
) -> tuple[NDArray, NDArray]:
    """Least misfit over a, b, c and n for each place of contact, and the n that gives it."""
    weight = 1.0 / variance
    ramp = np.maximum(centres - ways[:, None], 0.0)
    ramp = ramp / np.maximum(ramp.max(axis=1, keepdims=True), 1e-12)
    logs = np.log(np.maximum(ramp, 1e-30))
    total, force, square = weight.sum(), (weight * means).sum(), (weight * means**2).sum()
    best = np.full(len(ways), np.inf)
    powers = np.full(len(ways), POWERS[0])
    for power in POWERS:
        plain = np.exp(power * logs)
        for bend in BENDS:
            shape = plain * (1.0 + bend * ramp)
            first, second, cross = shape @ weight, shape**2 @ weight, shape @ (weight * means)
            if tare_N is None:
                bottom = np.maximum(total * second - first**2, 1e-300)
                slope = np.maximum((total * cross - first * force) / bottom, 0.0)
                base = (force - slope * first) / total
            else:
                slope, base = np.maximum((cross - tare_N * first) / np.maximum(second, 1e-300), 0.0), tare_N
            misfit = square + slope**2 * second + base**2 * total - 2.0 * slope * cross - 2.0 * base * force
            misfit = misfit + 2.0 * slope * base * first
            better = misfit < best
            best, powers = np.where(better, misfit, best), np.where(better, power, powers)
    return best, powers


def _noise(lead: NDArray) -> float:
    return float(np.std(lead)) if len(lead) >= LEAST_LEAD_IN else 0.0


def _spacing(x: NDArray, onset: int) -> float:
    return float(np.median(np.abs(np.diff(x[max(onset - 3, 0) : onset + 4]))))


def _tare(lead: NDArray, noise: float) -> tuple[float, float, float, float]:
    """Mean force before contact, its error, the noise, and a drift that stands out of it.

    The error is twice the scatter of the means of ten parts, not less by the root of ten: noise that wanders for
    longer than the lead-in lasts does not average out.
    """
    if len(lead) < LEAST_LEAD_IN:
        return 0.0, float("inf"), noise, 0.0
    parts = [float(part.mean()) for part in np.array_split(lead, 10 if len(lead) >= 30 else 3)]
    error = float(max(2.0 * np.std(parts), 2.0 * noise / np.sqrt(len(lead))))
    third = max(len(parts) // 3, 1)
    drift = float(np.mean(parts[-third:]) - np.mean(parts[:third]))
    inner = float(np.std(np.array(parts) - np.linspace(parts[0], parts[-1], len(parts))))
    return (
        float(np.mean(lead)),
        error,
        float(np.std(lead)),
        drift if abs(drift) > 4.0 * max(inner, noise / 5.0) else 0.0,
    )
