"""Time as a quantity of one or several columns, of a rate, or of two time bases; rows in its order; held positions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing import vocabulary as known
from dummydesign.measurement.importing.columns import Column, Values
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.sensor import digit_step

AGREES = 0.05
"""Share of a recording by which two statements of its length may differ."""
LEAST_STAMPS = 20
"""Different times that a recording of coarse time must have."""
COARSE, EVEN = 0.2, 1.5
"""Share of equal times from which on a time is coarse, and steps by which times are off an even grid at most."""
BURST, ALONE = 0.1, 0.9
"""Share of the mean step of time below which a row is of the packet of the row before, and share of the longer steps
that stand alone, as between packets: where a recording becomes slower they follow each other."""
PRESSED = 0.1
"""Share of the largest force at which a recording that begins is one that goes on."""
LATE = 3.0
"""Steps by which one quantity may begin after the other without a warning."""
Ranges = tuple[tuple[int, int], ...]


def timelike(column: Column) -> bool:
    """Whether a column may be the time or a part of it."""
    unit = column.unit is not None and column.unit.kind == "time"
    return column.numeric and (column.kind == "stamp" or unit or column.roles == {"time"})


def seconds_per_count(column: Column) -> float:
    """Seconds in one of a column's unit; a clock is read in seconds, 0 where no unit is known."""
    return 1.0 if column.kind == "stamp" else column.unit.factor if column.unit else 0.0


@dataclass(frozen=True, eq=False)
class ComposedTime:
    """Whole seconds and their fraction in another column: both columns, and the time from the first second. [s]"""

    parts: tuple[Column, Column]
    seconds: NDArray


def compose_time(columns: Sequence[Column], values: Values) -> ComposedTime | None:
    """Find a column of whole seconds (a clock, minutes) beside one of a smaller unit that begins again with each."""
    parts = [one for one in columns if one.index in values and timelike(one)]
    for whole in parts:
        factor = seconds_per_count(whole)
        seconds = values[whole.index] * factor
        if factor < 1.0 or np.any(seconds != np.rint(seconds / factor) * factor):
            continue
        rises = np.diff(seconds) > 0
        for fine in parts:
            if fine is whole or fine.kind == "stamp" or fine.unit is None or fine.unit.factor >= factor:
                continue
            part = values[fine.index] * fine.unit.factor
            falls = np.diff(part) < 0
            total = seconds - seconds[0] + part
            goes_on = np.mean(np.diff(total) >= 0) > 0.9 and np.ptp(total) > 0
            hits = int(rises[falls].sum())
            begins_again = hits > 0 and falls.sum() - hits <= 0.1 * hits + 2
            if 0.0 <= part.min() and part.max() < factor and goes_on and (begins_again or not rises.any()):
                return ComposedTime((whole, fine), total)
    return None


def time_by_rate(
    columns: Sequence[Column], values: Values, count: int, rate: float, why: str, log: ImportLog
) -> NDArray:
    """Return the time of evenly spaced samples, by a column that counts them or by the row. [s]"""
    for one in columns:
        if not one.counts or one.index not in values:
            continue
        steps = np.diff(values[one.index])
        if np.all(steps == np.rint(steps)) and np.all(steps >= 0) and np.median(steps) == 1.0:
            log.decide("time", f"'{one.label}' at {rate:g} Hz", f"counts the samples; {why}")
            return (values[one.index] - values[one.index][0]) / rate
    log.decide("time", f"{rate:g} Hz", f"one row a sample; {why}")
    return np.arange(count) / rate


def lengths_by_time(columns: Sequence[Column], values: Values) -> Iterator[tuple[Column, float]]:
    """Columns that may be the time and rise, and how long the recording is by each. [s]"""
    for one in columns:
        if one.index in values and timelike(one) and np.all(np.diff(values[one.index]) >= 0):
            yield one, float(np.ptp(values[one.index])) * seconds_per_count(one)


def check_rate(rate: float, columns: Sequence[Column], values: Values, log: ImportLog) -> None:
    """Refuse a rate of the user's that the file's own time contradicts."""
    for column, length in lengths_by_time(columns, values):
        count = len(values[column.index]) - 1
        if length > 0 and abs(length - count / rate) > AGREES * length:
            message = f"--rate {rate:g}, but '{column.label}' says {count / length:.4g} Hz; leave --rate out"
            raise log.fault(message, "inconsistent", "rate", rate)


def find_bases(chosen: Mapping[str, Column], times: Sequence[Column]) -> dict[str, Column]:
    """Find the time of displacement and of force where each has its own; empty where they share one.

    It is named after the quantity, or stands nearest before it (behind it where the table begins with a quantity).
    """
    if len(times) < 2:
        return {}
    before = min(one.index for one in times) < min(column.index for column in chosen.values())
    bases: dict[str, Column] = {}
    for role, column in chosen.items():
        named = [one for one in times if role in known.meanings_of(known.split_name(one.title)[0])]
        near = [one for one in times if (one.index < column.index) == before]
        bases[role] = (named or (near[::-1] if before else near) or list(times))[0]
    return bases if bases["displacement"] is not bases["force"] else {}


def align(
    force_s: NDArray, displacement_s: NDArray, x: NDArray, force: NDArray, log: ImportLog
) -> tuple[NDArray, NDArray]:
    """Bring the displacement to the times of the force: which rows both cover, and the displacement there.

    Each may have a time of its own, rows of its own, or begin or end before the other. Two clocks whose times do not
    meet only begin elsewhere: then the rows are taken as they stand.
    """
    rows, own = np.isfinite(force_s + force), np.isfinite(displacement_s + x)
    one_time = displacement_s is force_s
    empty = "cells of displacement or force are empty, too many to read it; export each row with both"
    if min(own.sum(), rows.sum()) < LEAST_STAMPS:
        raise log.fault(empty, "missing", "cell")
    for time in (displacement_s[own],) if one_time else (force_s[rows], displacement_s[own]):
        for at in np.flatnonzero(np.diff(time) <= 0)[:1] + 1:
            back = f"displacement and force have their own times, and one of them does not rise ({time[at]:.6g} s "
            message = empty if one_time else f"{back}after {time[at - 1]:.6g} s); {ONE_TIME}"
            raise log.fault(message, "missing" if one_time else "malformed", "cell" if one_time else "time_s")
    both = rows & own
    first, last = displacement_s[own][[0, -1]]
    begin, end = force_s[rows][[0, -1]]
    lag, step = float(first - begin), float(np.median(np.diff(force_s[rows])))
    shared = rows & (force_s >= first) & (force_s <= last)
    # as they stand, where no reading of the force is lost by it
    same = both.sum() >= max(shared.sum(), 1) and np.max(np.abs((displacement_s - force_s)[both])) <= 1e-3 * step
    if same or first > end or last < begin:
        why = "the same" if same else "they never meet: each row is taken as one moment"
        shared, moved = both, x
    elif shared.sum() < 0.5 * rows.sum():
        message = f"displacement and force have their own times, {lag:+.4g} s apart: less than half of the recording "
        raise log.fault(f"{message}is covered by both; {ONE_TIME}", "inconsistent", "time_s", lag)
    else:
        why, moved = "displacement interpolated to the force", np.interp(force_s, displacement_s[own], x[own])
        if not one_time:
            log.warn(
                "two_time_bases",
                f"displacement and force have their own times, which begin {lag:+.4g} s apart; the "
                "displacement was interpolated to the times of the force: check that both share a zero",
            )
    log.decide("two times", f"begin {lag:+.6g} s apart", why)
    if one_time and abs(lag) > LATE * max(step, float(np.median(np.diff(displacement_s[own])))):
        later, other = ("displacement", "force") if lag > 0 else ("force", "displacement")
        words = f"{later} begins {abs(lag):.4g} s after {other}; the rows before were left out"
        log.warn("begins_later", f"{words}: check that it begins before contact")
    return shared, moved


ONE_TIME = "name the one time that is right for both by --columns time=NAME"


def shift(
    time: NDArray, x: NDArray, force: NDArray, recordings: Ranges, delay_s: float
) -> tuple[NDArray, NDArray, NDArray, Ranges]:
    """Take the displacement by which a later force was caused; samples without one at the ends are left out."""
    parts = [(time[a:b], x[a:b], force[a:b]) for a, b in recordings]
    kept = [(t - delay_s >= t[0]) & (t - delay_s <= t[-1]) for t, *_ in parts]
    moved = [(t[k], np.interp(t[k] - delay_s, t, way), f[k]) for k, (t, way, f) in zip(kept, parts)]
    edges = np.cumsum([0, *(k.sum() for k in kept)]).tolist()
    time, x, force = (np.concatenate(column) for column in zip(*moved))
    return time, x, force, tuple(pairwise(edges))


def unwrap(time: NDArray, scale: float, log: ImportLog) -> NDArray:
    """Undo the runs over of a clock: every fall is one period, to within the steps beside. [s]

    Parameters
    ----------
    time : ndarray, shape (n,)
        As it is written. [s]
    scale : float
        Seconds in one count. [s]
    """
    steps = np.diff(time)
    back, longest = steps < 0, float(steps.max(initial=0.0))
    counters = (2.0**bits * size for size in (scale, 1e-3, 1e-6) for bits in (16, 32))
    for period in (3600.0, 43200.0, *counters) if back.any() else ():
        over = steps[back] + period
        if period > 50.0 * longest and np.all((over >= 0.0) & (over <= 1.5 * longest)):
            log.decide("clock", f"runs over {back.sum()} times", f"it falls by {period:.9g} s, less one step")
            return time + period * np.r_[0, np.cumsum(back)]
    return time


def join_steps(time: NDArray, x: NDArray, force: NDArray, recordings: Ranges, log: ImportLog) -> tuple[NDArray, Ranges]:
    """Join parts of one test whose time begins again with each step of its method: pressed, and without a jump.

    Parameters
    ----------
    time, x, force : ndarray, shape (n,)
        As they are written. [s, mm, N]
    recordings : ranges
        Samples between which the time begins again.
    """
    starts = np.array([first for first, _ in recordings[1:]], int)
    away = np.abs(force - np.median(force[:5]))
    if not np.any(away[starts] > PRESSED * away.max()):
        return time, recordings
    goes_on = np.ones(len(starts), bool)
    for values in (x, force):
        jumps = np.abs(np.diff(values))
        goes_on &= jumps[starts - 1] <= 1.5 * np.delete(jumps, starts - 1).max() + 1e-9
    time = time.copy()
    for start in starts[goes_on].tolist():
        usual = float(np.median(np.diff(time[start : start + 10])))
        time[start:] += time[start - 1] - time[start] + (time[start] if 0 < time[start] < 2.0 * usual else usual)
    edges = [0, *starts[~goes_on].tolist(), len(time)]
    log.decide("steps", f"{goes_on.sum() + 1} joined", "the time begins again while pressed, and nothing jumps there")
    return time, tuple(pairwise(edges))


def rows_in_order(
    time: NDArray, repeats: Callable[[int], bool], breaks: Sequence[int], lines: NDArray, log: ImportLog
) -> tuple[NDArray, NDArray, Ranges]:
    """Bring rows to the order of time: which rows in which order, their time, and the recordings in them.

    Parameters
    ----------
    time : ndarray, shape (n,)
        As it is written. [s]
    repeats : callable
        Whether a line of the file is word for word the one before.
    breaks : sequence of int
        Rows before which text stands in the file.
    lines : ndarray of int, shape (n,)
        Line of each row in the file.
    """
    order = np.arange(len(time))
    steps = np.diff(time)
    if np.all(steps > 0) and not _longest_within_packet(steps):
        return order, time, ((0, len(time)),)
    equal = np.flatnonzero(steps == 0) + 1
    twice = np.array([row for row in equal.tolist() if repeats(int(lines[row]))], int)
    # rows of a coarse time are alike where nothing moves; where all that are equal are alike, they are one row
    if len(twice) and (len(twice) == len(equal) or len(equal) < COARSE * len(time)):
        log.decide(
            "repeated rows", f"{len(twice)} rows", f"word for word the row before; the first is line {lines[twice[0]]}"
        )
        order = np.delete(order, twice)
    kept = time[order]
    interrupted = set(np.searchsorted(order, list(breaks)).tolist())
    starts = [0]
    for row in (np.flatnonzero(np.diff(kept) < 0) + 1).tolist():
        begin, reached = float(kept[starts[-1]]), float(kept[row - 1])
        back = reached - float(kept[row])
        if reached > begin and (row in interrupted or back > 0.9 * (reached - begin)) and row - starts[-1] >= 10:
            starts.append(row)
    ranges = tuple(pairwise([*starts, len(kept)]))
    if len(starts) > 1:
        log.decide("recordings", str(len(starts)), f"the time begins again at line {int(lines[order[starts[1]]])}")
    for first, stop in ranges:
        part = slice(first, stop)
        order[part] = order[part][_sorted(kept[part], lines[order[part]], log)]
        kept[part] = _spread(time[order[part]], lines[order[part]], log)
    return order, kept, ranges


def _sorted(time: NDArray, lines: NDArray, log: ImportLog) -> NDArray:
    """Order of rows by time, where it fits: moved rows leave no hole where they were and come between no others."""
    back = np.flatnonzero(time < np.maximum.accumulate(time))
    order = np.argsort(time, kind="stable")
    if not len(back):
        return order
    steps = np.diff(time[order])
    moved = order != np.arange(len(time))
    touched = moved[1:] | moved[:-1]
    usual = float(np.median(steps))
    most = max(1.5 * usual, 1.2 * float(steps[~touched].max(initial=0.0)))
    if np.any(steps[touched] > most) or np.any(steps[touched] < 0.3 * usual):
        at = int(back[0])
        raise log.fault(
            f"time = {time[at]:.6g} s goes back (the row before has {time[at - 1]:.6g} s; {len(back)} such "
            f"row{'s' * (len(back) > 1)}) and fits nowhere else: remove or correct these rows",
            "malformed",
            "time_s",
            float(time[at]),
            line=int(lines[at]),
        )
    why = f"their times fit between those of other rows; the first is line {int(lines[back[0]])}"
    log.decide("rows sorted by time", f"{len(back)} rows", why)
    return order


def _spread(time: NDArray, lines: NDArray, log: ImportLog) -> NDArray:
    """Part equal times: on an even grid where the samples are even, else between the times that are different."""
    count, rows, steps = len(time), np.arange(len(time)), np.diff(time)
    new = np.flatnonzero(steps > _longest_within_packet(steps)) + 1
    equal = count - 1 - len(new)
    if not equal:
        return time
    share, first = equal / count, int(lines[int(np.argmin(np.r_[True, np.diff(time) > 0]))])
    where = f"{equal} rows have the time of the row before; the first is line {first}"
    if len(new) < 3:
        raise _too_coarse(time, lines, log)
    # a time may be that of the first of its rows, as a clock that is cut off, or of the last, as a packet's arrival
    off, at, slope, begin = min(
        (_line(at, time) for at in (new, np.r_[new[1:] - 1, count - 1])), key=lambda one: float(one[0])
    )
    if share > COARSE and off <= EVEN * slope:
        # the rate is taken as it is shown: typed as --rate it gives the same times
        rate = float(f"{1 / slope:.6g}")
        log.decide("equal times", f"spread evenly at {rate:g} Hz", f"even to {off:.2g} s; {where}")
        return begin + (rows - at[0]) / rate
    stamps = time[at]
    if len(new) < LEAST_STAMPS:
        raise _too_coarse(time, lines, log)
    spread = np.interp(rows, at, stamps)
    spread[: at[0]] = stamps[0] + slope * (rows[: at[0]] - at[0])
    spread[at[-1] :] = stamps[-1] + slope * (rows[at[-1] :] - at[-1])
    size = float(np.max(np.diff(stamps)))
    log.decide("equal times", f"{equal} rows spread", f"between the times before and after; {where}")
    if share > COARSE:
        log.warn(
            "coarse_time",
            f"each time is written {1 / (1 - share):.1f} times on average and the samples are not "
            f"even: spread between the times, they may be {size:.2g} s off; give --rate HZ where the samples are "
            "even, or export the time with more digits",
        )
    return spread


def _longest_within_packet(steps: NDArray) -> float:
    """Step of time up to which rows are of one packet that was stamped on arrival; 0 without packets. [s]"""
    longest = BURST * float(steps.mean())
    short = steps < longest
    between = np.flatnonzero(~short[:-1])
    packets = short.mean() > 0.5 and len(between) > 2 and short[between + 1].mean() > ALONE
    return longest if packets else 0.0


def _line(at: NDArray, time: NDArray) -> tuple[float, NDArray, float, float]:
    """How far the times of some rows are off an even grid [s], those rows, the grid's step and its first time."""
    slope, begin = np.polyfit(at - at[0], time[at] - time[at[0]], 1)
    off = time[at] - time[at[0]] - slope * (at - at[0])
    return float(np.ptp(off)), at, float(slope), float(time[at[0]] + begin)


def _too_coarse(time: NDArray, lines: NDArray, log: ImportLog) -> Exception:
    stamps = np.unique(time)
    digit = float(np.min(np.diff(stamps))) if len(stamps) > 1 else 0.0
    return log.fault(
        f"the time has only {len(stamps)} different values in {len(time)} rows, {digit:.3g} s apart: coarser than the "
        "sampling; export it with more digits, or say --rate HZ where the samples are even",
        "malformed",
        "time_s",
        float(time[0]),
        line=int(lines[0]),
    )


MIDDLE, SLOWER = 0.45, 2.5
"""Share of the travel about its middle that is on the way, and samples from one change to the next there from which a
position goes in steps."""
COARSE_STEP, WARNED = 0.003, 0.01
"""Step over the travel from which it matters, and from which there is a warning."""
FEWEST, AT_REST = 6, 0.05
"""Changes on the way between which a position is read, and share of the largest below which one is noise at rest."""
STANDS = 3.0
"""Multiple of the usual time between two changes beyond which the punch stands."""
EVERY = 0.9
"""Share of the samples on the ways in and out from which every one of them changes."""
EVEN_STEPS, MOST = 0.02, 30.0
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
    stepped = size >= COARSE_STEP * reach and (few or usual >= SLOWER * float(np.median(np.diff(time))))
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
    rounded = bool(np.all(np.abs(digits - np.round(digits)) < EVEN_STEPS * digits)) and digits.max() < MOST
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
