"""Make compression positive; separate the presses of one recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import true_runs
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.plateau import BEGUN, noise_of, ramp_start
from dummydesign.measurement.sensor import middle_of_three

_BOTH_WAYS = 0.4
"""Share of the larger swing of the force above which the smaller one leaves open which of them is pressing."""


@dataclass(frozen=True)
class Signs:
    """Factors that make compression positive, and the force at rest as the file counts it."""

    displacement: float
    force: float
    rest_force_N: float


def find_signs(x: NDArray, force: NDArray, tare_N: float | None, log: ImportLog) -> Signs:
    """Find which way both columns count.

    The recording begins at rest; the force that goes farthest from there is that of pressing, and the position
    goes into the pad while this force rises.
    """
    smooth, flip = middle_of_three(force), log.settings.flip
    rest = _at_rest(x, force) if tare_N is None else tare_N
    # the zero may drift while the punch is back where it began
    away = np.abs(x - x[0]) > 0.1 * float(np.ptp(x))
    reached = smooth[away] if away.any() else smooth
    up, down = max(float(reached.max() - rest), 0.0), max(float(rest - reached.min()), 0.0)
    swing = max(up, down)
    if swing <= 1e-9 * abs(rest) or swing < 8.0 * noise_of(force):
        raise log.fault(
            f"nothing is pressed: the force stays within {swing:.3g} N of {rest:.4g} N; is this the force "
            "column, and the right file? (--columns force=NAME)",
            "nothing_found",
            "force_N",
            swing,
        )
    if flip is not None:
        way, push = (-1.0 if name in flip else 1.0 for name in ("displacement", "force"))
        load = push * (smooth - rest)
        wrong = "force" if load.max() < -load.min() else "displacement" if _way(x, load, log, way) * way < 0 else ""
        if wrong:
            raise log.fault(
                f"with --flip as given, pressing lowers the {wrong}: reverse --flip {wrong}", "inconsistent", "flip"
            )
        for name in ("displacement", "force"):
            log.decide(f"{name} sign", "flipped" if name in flip else "as written", "given by --flip")
        return Signs(way, push, rest)
    if min(up, down) > _BOTH_WAYS * swing:
        doubt = f"from {rest:.3g} N the force goes {up:.3g} N up and {down:.3g} N down; either may be pressing"
        raise log.question(doubt, "--flip force where pressing is negative, --flip none where it is positive")
    sign = 1.0 if up >= down else -1.0
    # A recording that begins pressed and ends free looks like a press of the other sign on a large offset.
    if tare_N is None and abs(rest) > 0.5 * swing and abs(rest + sign * swing) < 0.25 * abs(rest):
        raise log.question(
            f"the force is {rest:.3g} N at the start and near zero later: either the file begins "
            "pressed (then record from before contact), or this is an offset",
            f"--tare {rest:.4f} where it is an offset",
        )
    way = _way(x, sign * (smooth - rest), log)
    written = {1.0: "as written", -1.0: "flipped"}
    log.decide("force sign", written[sign], f"pressing moves it by {sign * swing:+.3g} N from its reading at rest")
    log.decide("displacement sign", written[way], f"it {'rises' if way > 0 else 'falls'} while the force rises")
    return Signs(way, sign, rest)


def _at_rest(x: NDArray, force: NDArray) -> float:
    """The force at the first sample: of up to 50 samples before the punch has moved, along a line if it moves."""
    moved = np.abs(x - x[0]) > 0.01 * float(np.ptp(x))
    few = int(np.clip(np.argmax(moved) if moved.any() else 0, 1, 50))
    if few < 3 or abs(float(x[few - 1] - x[0])) < 5.0 * noise_of(x[:few]) + 1e-3 * float(np.ptp(x)):
        return float(np.median(force[:few]))
    return float(np.polyval(np.polyfit(x[:few] - x[0], force[:few], 1), 0.0))


def _way(x: NDArray, load: NDArray, log: ImportLog, given: float | None = None) -> float:
    """Sign of the position: its change while the load goes from a twentieth to half of its largest; or as given."""
    peak = int(np.argmax(load))
    half = int(np.argmax(load >= 0.5 * load[peak]))
    low = np.nonzero(load[: half + 1] <= 0.05 * load[peak])[0]
    rise = float(x[half] - x[int(low[-1]) if low.size else 0])
    deep, out = x[load >= 0.5 * load[peak]], x[load <= 0.1 * load[peak]]
    overall = float(np.median(deep) - np.median(out)) if out.size else rise
    if float(np.ptp(x)) <= 0:
        message = "the displacement never moves; name its column by --columns displacement=NAME"
        raise log.fault(message, "nothing_found", "displacement_mm")
    overall = overall if abs(overall) > 0.05 * float(np.ptp(x)) else rise
    # a position may stand while a late force rises, or one that is averaged
    rise = rise if abs(rise) >= 1e-3 * float(np.ptp(x)) else overall
    if rise * overall < 0 or abs(rise) < 1e-3 * float(np.ptp(x)):
        if given is not None:
            return given
        doubt = f"while the force rises the position moves by {rise:+.3g} mm, over the whole press by {overall:+.3g} mm"
        raise log.question(doubt, "--flip displacement where it falls while pressing, --flip none where it rises")
    return 1.0 if rise > 0 else -1.0


LOW, HIGH = 0.01, 0.03
"""Shares of the largest force below which it is zero, and above which it is a press."""
PARKED, RIPPLE = 0.005, 0.05
"""Shares: of its way within which the punch is parked, and of the largest force that a ripple there may reach."""
PAUSE = 0.5
"""Share of the time between two presses above which one step of it is a pause of the recording."""
INWARD, MARGIN = 0.1, 2
"""Share of the deepest press's way that a press goes inward, and samples before its force begins that count for it."""
BACK = 0.3
"""Share of its depth that the punch must come back before the next press is one of its own."""


@dataclass(frozen=True)
class Span:
    """One press in a recording."""

    start: int
    stop: int
    onset: int


def find_presses(file: str, x: NDArray, load: NDArray, several: bool, time: NDArray | None = None) -> list[Span]:
    """Find the presses; one from the first to the last of them unless ``several`` are meant."""
    at = np.arange(len(x), dtype=float) if time is None else time
    parked = x <= x.min() + PARKED * float(np.ptp(x))
    smooth = middle_of_three(load)
    smooth = smooth - _level(at, smooth, parked)
    peak = float(smooth.max())
    ripple = 1.4826 * float(np.median(np.abs(smooth[parked])))
    noise = max(noise_of(smooth), min(ripple, RIPPLE * peak))
    low, high = max(6.0 * noise, LOW * peak), max(12.0 * noise, HIGH * peak)
    runs = [(a, b) for a, b in true_runs(_touching(x, smooth, low)) if smooth[a:b].max() >= high]
    a, b = max(runs, key=lambda run: float(smooth[run[0] : run[1]].max()), default=(0, 1))
    depth = float(x[a:b].max() - x[max(a - MARGIN, 0)])
    # A force without way is the jolt of the punch when the robot starts or stops in the air, or a spike.
    # A drifting zero shows force on the way out as well. Only a press goes inward by a share of its depth.
    inward = [(a, b) for a, b in runs if _inward(x[max(a - MARGIN, 0) : b]) >= INWARD * depth]
    runs = inward or [(a, b) for a, b in runs if smooth[a:b].max() >= 0.3 * peak]
    if not runs:
        message = f"{file}: nothing is pressed: the force stays within {high:.3g} N of its reading at rest"
        raise InputError(message, "nothing_found", "force_N")
    joined = runs[:1]
    for run in runs[1:]:
        if several and _came_back(x, joined[-1], run):
            joined.append(run)
        else:
            joined[-1] = (joined[-1][0], run[1])
    cuts = [0, *(_cut(at, x, before[1], after[0]) for before, after in pairwise(joined)), len(x)]
    deepest = [a + int(np.argmax(smooth[a:b])) for a, b in joined]
    # nothing is touched while the punch is parked, whatever the force does there
    onsets = [max(run[0], approach_start(at, x, a, deep)) for run, a, deep in zip(joined, cuts, deepest)]
    return [Span(a, b, onset) for a, b, onset in zip(cuts, cuts[1:], onsets)]


def joined_cycles(spans: Sequence[Span], time: NDArray, x: NDArray, zero_mm: float) -> list[Span]:
    """Join each press that begins pressed to the one before: cycles of one test, of which the last is held."""
    kept = list(spans[:1])
    for span in spans[1:]:
        first = kept[-1]
        goes_on = time[span.start] > time[first.stop - 1]  # not another recording
        if goes_on and x[span.start] - zero_mm > BEGUN * (x[first.start : span.stop].max() - zero_mm):
            kept[-1] = Span(first.start, span.stop, first.onset)
        else:
            kept.append(span)
    return kept


def approach_start(time: NDArray, x: NDArray, start: int, deepest: int) -> int:
    """The last sample at which the punch is parked before it presses; ``start`` where it is on its way already."""
    way = x[start : deepest + 1] - x[start : deepest + 1].min()
    return start if deepest < start + 2 else start + ramp_start(time[start : deepest + 1], way, noise_of(way))[0]


def _level(time: NDArray, smooth: NDArray, parked: NDArray) -> NDArray:
    """Reading at no load over time: a line between the ends of the stretches in which the punch is parked."""
    knots = [(float(time[0]), 0.0)]
    for a, b in true_runs(parked):
        part = min(max((b - a) // 4, 5), 50)
        if b - a >= 2 * part:
            knots += [(float(time[i : i + part].mean()), float(np.median(smooth[i : i + part]))) for i in (a, b - part)]
    return np.interp(time, *np.array(knots[1:] or knots).T)


def _inward(x: NDArray) -> float:
    """The longest way inward, from any place to a deeper one after it."""
    return float((x - np.minimum.accumulate(x)).max(initial=0.0))


def _touching(x: NDArray, smooth: NDArray, low: float) -> NDArray:
    """Where the punch touches: the force is above zero, unless it is small and the punch is out."""
    touching = smooth > low
    peak = int(np.argmax(smooth))
    before = np.nonzero(~touching[:peak])[0]
    start = int(before[-1]) if before.size else 0
    way = float(x[peak] - x[start])
    return touching & ~((way > 0) & (x < x[start] - 0.05 * way) & (smooth < 0.2 * smooth[peak]))


def _came_back(x: NDArray, before: tuple[int, int], after: tuple[int, int]) -> bool:
    deepest = float(x[before[0] : before[1]].max())
    return deepest - float(x[before[1] : after[0]].min()) >= BACK * (deepest - float(x[before[0]]))


def _cut(time: NDArray, x: NDArray, leave: int, touch: int) -> int:
    """Where one press ends and the next begins: at a pause of the recording while the punch is farthest out.

    Without a pause it is the middle of the samples there.
    """
    gap = x[leave:touch]
    low, high = float(gap.min()), float(max(gap[0], gap[-1]))
    far = np.nonzero(gap <= low + 0.05 * (high - low))[0]
    steps = np.diff(time[leave + far])
    if steps.size and steps.max() > PAUSE * (time[leave + far[-1]] - time[leave + far[0]]):
        return leave + int(far[int(np.argmax(steps)) + 1])
    return leave + int(far[len(far) // 2]) + (1 if len(far) == 1 else 0)
