"""What the force reads where nothing is touched: noise, wander, step of the digits, drift, slope with travel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.sign_convention import Span, approach_start
from dummydesign.measurement.motion import LATE
from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.sensor import digit_step

LEAST_LEAD_IN = 5
WANDER, LONG_WANDER = 0.15, 0.5
"""Shares of the noise by which means of it wander: least of all between parts, and over the whole lead-in."""
DRIFT_N_S, SLOPE_N_MM = 0.1, 0.05
"""Standard deviations of drift and slope with travel before the lead-in shows them: wide on purpose."""
MOSTLY = 0.3
"""Share of the variance from which on the noise mostly wanders: then samples that follow quickly share its error."""
CLEAR = 2.5
"""Errors that a drift or a slope must exceed to be one; off a line is what exceeds twice as many."""
SHOWN = 1.0 / 3.0
"""Share of what drift and slope may do before they are looked at to which the lead-in must narrow it to show them."""
MATTERS = 0.002
"""Share of the largest force by which drift and slope must change it within the press to be subtracted."""


def with_bias(error_N: float, bias_N: float) -> float:
    """Error (95 %) of a normal value that is off by a bias, too: one-sided where that is large. [N]"""
    return max(error_N, abs(bias_N) + 1.645 / 1.960 * error_N)


@dataclass(frozen=True)
class BaselineNoise:
    """Standard deviations of a sample and of what wanders between means, how long that lasts at least, and the step of
    the digits."""

    sample_N: float
    wander_N: float
    wander_s: float
    step_N: float

    @property
    def rounding_N(self) -> float:
        """Error of a mean by the digits: none where noise spreads the samples over several steps."""
        if self.step_N <= 0.0:
            return 0.0
        return float(self.step_N / np.sqrt(12.0) * np.exp(-2.0 * (np.pi * self.sample_N / self.step_N) ** 2))


def noise_before(time: NDArray, load: NDArray, span: Span, stop: int) -> BaselineNoise:
    """Noise about a straight line in time of the samples up to ``stop``; of the whole press where there are too few."""
    press, free = load[span.start : span.stop], load[span.start : stop]
    step, grain = digit_step(press), 1e-6 * max(float(np.ptp(press)), 1e-12)
    if len(free) < 2 * LEAST_LEAD_IN:
        white = max(noise_of(press), grain)
        return BaselineNoise(white, WANDER * white, 0.0, step)
    clock = time[span.start : stop] - time[span.start]
    rest = free - np.polyval(np.polyfit(clock, free, 1), clock)
    sample = max(float(np.std(rest)), grain)
    parts = np.array_split(rest, 10 if len(free) >= 30 else 3)
    # the line takes two of the means
    means = float(np.sum(np.square([part.mean() for part in parts]))) / max(len(parts) - 2, 1)
    own, least = means - noise_of(free) ** 2 / len(parts[0]), (WANDER * sample) ** 2
    lasts = float(clock[-1]) / len(parts) if own > MOSTLY * sample**2 else 0.0
    return BaselineNoise(sample, float(np.sqrt(max(own, least))), lasts, step)


@dataclass(frozen=True)
class Baseline:
    """Reading at no load: ``level_N`` at contact (``at_s``, ``at_mm``), and how it changes with time and travel.

    ``mean_N`` is the mean before contact, ``step_N`` that of the digits, which a line that is subtracted hides,
    ``before_N`` the change there, ``effect_N`` (and its
    error) that from contact to the end of the hold.
    ``drift_alone_N_s`` and ``slope_alone_N_mm`` are set where a change is clear, but not of which kind.
    ``held_error_N`` is how far (95 %) level, drift and slope that are not seen may move the force by the end of the
    hold, where it reads ``held_N`` by the best line; ``shown`` whether samples say so, and not what sensors do at most.
    ``left_N`` is what the force reads at most after the punch came back, where that is no straight drift.
    """

    level_N: float
    mean_N: float
    error_N: float
    noise_N: float
    step_N: float
    samples: int
    at_s: float
    at_mm: float
    drift_N_s: float = 0.0
    slope_N_mm: float = 0.0
    before_N: float = 0.0
    effect_N: float = 0.0
    effect_error_N: float = 0.0
    drift_alone_N_s: float = 0.0
    slope_alone_N_mm: float = 0.0
    comes_back: bool = False
    held_N: float = 0.0
    held_error_N: float = float("inf")
    shown: bool = False
    left_N: float = 0.0

    def at(self, time: NDArray, x: NDArray) -> NDArray:
        """Reading at no load along a motion. [N]"""
        return self.level_N + self.drift_N_s * (time - self.at_s) + self.slope_N_mm * (x - self.at_mm)

    def only(self, kind: str) -> Baseline:
        """The same where the change is known to be a ``drift`` or a ``slope``."""
        drift, slope = (self.drift_alone_N_s, 0.0) if kind == "drift" else (0.0, self.slope_alone_N_mm)
        return replace(self, drift_N_s=drift, slope_N_mm=slope) if self.drift_alone_N_s else self


def find_baseline(
    time: NDArray, x: NDArray, load: NDArray, span: Span, contact: tuple[int, float, float], noise: BaselineNoise
) -> Baseline:
    """Find the reading at no load from the samples before contact, and from those after the punch came back.

    ``contact`` is its sample, its place, and the place up to which nothing is touched.
    """
    at, place_mm, free_mm = contact
    start, stop = span.start, span.stop
    deepest = start + int(np.argmax(x[start:stop]))  # an average is largest on the way back
    out = np.nonzero(x[start:at] < free_mm)[0]
    parked = approach_start(time, x, start, deepest) + 1 - start
    count = min(max(int(out[-1]) + 1 if out.size else 0, parked if parked >= LEAST_LEAD_IN else 0), at - start)
    lead = load[start : start + count]
    if count < LEAST_LEAD_IN:
        return Baseline(0.0, 0.0, float("inf"), noise.sample_N, noise.step_N, count, float(time[at]), place_mm)
    parts = np.array_split(np.arange(start, start + count), 10 if count >= 30 else 3)
    means = [float(load[part].mean()) for part in parts]
    # noise that wanders for longer than the lead-in lasts does not average out: the error is less by no root of ten
    error = float(max(2.0 * np.std(means), 2.0 * noise.sample_N / np.sqrt(count), noise.rounding_N))
    mean = float(np.mean(lead))
    plain = Baseline(mean, mean, error, float(np.std(lead)), noise.step_N, count, float(time[at]), place_mm)
    stand = min(parked, count) if parked >= LEAST_LEAD_IN else count
    if count - stand >= 2 * LEAST_LEAD_IN:  # the approach tells the slope, the time before it the drift
        standing = np.array_split(np.arange(start, start + stand), 10 if stand >= 30 else 3)
        parts = standing + np.array_split(np.arange(start + stand, start + count), 5)
    leading = len(parts)
    half_mm = place_mm - 0.5 * (place_mm - float(x[start:at].min()))
    back = deepest + 1 + np.nonzero(x[deepest + 1 : stop] < min(free_mm, half_mm))[0]
    if len(back) >= 2 * LEAST_LEAD_IN:
        parts += np.array_split(back, 5)
    return _with_changes(plain, parts, leading, time, x, load, (deepest, stop), noise)


def _with_changes(
    plain: Baseline,
    parts: list[NDArray],
    leading: int,
    time: NDArray,
    x: NDArray,
    load: NDArray,
    press: tuple[int, int],
    noise: BaselineNoise,
) -> Baseline:
    """Add drift and slope where they stand out of their errors; ``leading`` parts lie before contact."""
    clock, way, mean = (np.array([float(v[part].mean()) for part in parts]) for v in (time, x, load))
    clock, way = clock - plain.at_s, way - plain.at_mm
    variance = noise.wander_N**2 + noise.rounding_N**2 + noise.sample_N**2 / np.array([len(part) for part in parts])
    # noise may wander as slowly as a drift
    slow = LONG_WANDER * noise.sample_N + noise.rounding_N
    floors = np.array([0.0, slow / max(float(np.ptp(clock)), 1e-9), slow / max(float(np.ptp(way)), 1e-9)])
    columns = np.stack([np.ones_like(clock), clock, way])

    def fit(*kept: int, of: int = len(parts), force: NDArray = mean) -> tuple[NDArray, NDArray, NDArray]:
        """Level, drift and slope with their errors (those that are left out are 0), and the covariance of these."""
        rows, at = columns[list(kept), :of], list(kept)
        prior = np.array([0.0, DRIFT_N_S**-2, SLOPE_N_MM**-2])[at]
        covariance = np.linalg.inv((rows / variance[:of]) @ rows.T + np.diag(prior))
        value, error = np.zeros(3), np.zeros(3)
        value[at] = covariance @ (rows @ (force / variance)[:of])
        error[at] = np.hypot(np.sqrt(np.diag(covariance)), floors[at])
        return value, error, covariance

    deepest, stop = press
    held = deepest + np.nonzero(x[deepest:stop] >= plain.at_mm + 0.9 * (x[deepest] - plain.at_mm))[0][-1]
    lasts, depth = float(time[held]) - plain.at_s, float(x[deepest]) - plain.at_mm
    whole, error, covariance = fit(0, 1, 2)
    off = np.abs(mean - whole @ columns) > 2.0 * CLEAR * np.hypot(np.sqrt(variance), slow)
    returns = leading < len(parts)
    if returns and off.any():  # a load cell that creeps, or an average: no drift
        own = _with_changes(plain, parts[:leading], leading, time, x, load, press, noise)
        left = float(np.abs(load[parts[leading]].mean() - own.at(time, x)[parts[leading]].mean()))
        return replace(own, left_N=left, held_error_N=2.0 * left)
    end = np.array([1.0, lasts, depth])
    unseen = np.minimum(floors, [0.0, DRIFT_N_S, SLOPE_N_MM]) * end
    # the force of the hold is rounded as that before contact is, and its mean is of fewer samples
    read = noise.rounding_N**2 + noise.wander_N**2 + noise.sample_N**2 / max(LATE * (held - deepest), 1.0)
    spread = float(np.sqrt(end @ covariance @ end + unseen @ unseen + read))
    shown = spread < SHOWN * float(np.hypot(DRIFT_N_S * lasts, SLOPE_N_MM * depth))
    plain = replace(plain, held_N=float(end @ whole), held_error_N=2.0 * spread, shown=shown)
    if returns:
        lead, _, known = fit(0, 1, 2, of=leading)
        ahead = np.sqrt(np.einsum("ip,ij,jp->p", columns, known, columns) + variance)
        beyond = np.abs(mean - lead @ columns)
        if (beyond > 2.0 * CLEAR * np.hypot(ahead, slow)).any():  # it did not drift so before: creep
            plain = replace(plain, left_N=float(beyond[leading]), held_error_N=float(beyond[leading]))
    clear = [kind for kind in (1, 2) if abs(whole[kind]) > CLEAR * error[kind]]
    alone = [fit(0, kind) for kind in (1, 2)]
    steady = [abs(one[0][kind]) > CLEAR * one[1][kind] for kind, one in zip((1, 2), alone)]
    if not clear and not any(steady):
        return plain
    value, error, _ = fit(0, *clear) if clear else alone[steady.index(True)]
    if not clear and all(steady):  # of which kind it is remains open: a drift, until the user settles it
        plain = replace(plain, drift_alone_N_s=float(alone[0][0][1]), slope_alone_N_mm=float(alone[1][0][2]))
    # its rate may fall to a third in the time that was recorded, and what the line leaves out may still be there
    bend = 0.5 * value[1] / (lasts - clock[0]) * np.append(clock, lasts) ** 2
    off_N = abs(end @ (whole - value)) + abs(bend[-1] - end @ fit(0, 1, 2, force=bend[:-1])[0])
    return replace(
        plain,
        level_N=float(value[0]),
        error_N=2.0 * float(error[0]),
        drift_N_s=float(value[1]),
        slope_N_mm=float(value[2]),
        before_N=float(value[1] * -clock[0] + value[2] * -way[0]),
        effect_N=float(abs(value[1]) * lasts + abs(value[2]) * depth),
        effect_error_N=float(np.hypot(error[1] * lasts, error[2] * depth)),
        comes_back=returns,
        held_error_N=with_bias(plain.held_error_N, float(off_N)),
    )
