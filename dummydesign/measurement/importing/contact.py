"""Tare, contact and zero of one press, with their errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.baseline import (
    DRIFT_N_S,
    LEAST_LEAD_IN,
    MATTERS,
    SLOPE_N_MM,
    Baseline,
    BaselineNoise,
    find_baseline,
    noise_before,
    with_bias,
)
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.sign_convention import Span, approach_start

RISE, SEEN = (0.03, 0.15), 80.0
"""The rise is looked at up to 80 times the noise: further up a law bends more; between these shares of the peak."""
COARSE = 0.3
"""Share of the peak up to which the place of contact is looked for at first, over the whole approach."""
MISFIT = 0.02
"""Relative error that the law of the rise may have."""
POWERS = np.arange(0.8, 3.21, 0.15)
BENDS = np.linspace(-0.6, 0.1, 6)
"""Relative change of a power of the depth over the part looked at: what relaxes or stiffens on the way."""
PARKED_LONG = 30
"""Samples before the approach that tell the noise by themselves."""
_WAYS, _CELLS, _PARTS = 60, 80, 20


@dataclass(frozen=True)
class ContactEstimate:
    """Where the punch touches (95 % interval), what the force reads before, the speed, and a delay that was taken off
    the force."""

    position_mm: float
    low_mm: float
    high_mm: float
    baseline: Baseline
    velocity_mm_s: float
    peak_N: float
    delay_s: float = 0.0


def find_contact(time: NDArray, x: NDArray, load: NDArray, span: Span, tare_N: float | None = None) -> ContactEstimate:
    """Find contact and tare of one press.

    The force before and shortly after contact is b + d t + s x + a u^n (1 + c u), u = max(x - x0, 0), along the
    measured motion: b is the tare, d its drift, s its slope with travel, x0 the contact; n is between 0.8 and 3.2 (a
    flat punch 1, a ball 1.5, tissue 3), c lets the force bend by -60 to 10 % on the way. The noise has a white part,
    a part that wanders, and the step of the digits. The interval of x0 is that of its posterior over all others.
    """
    start, peak = span.start, float(load[span.start : span.stop].max())
    go = approach_start(time, x, start, start + int(np.argmax(load[start : span.stop])))
    at = max(span.onset, go)
    for share, powers, bends in ((COARSE, POWERS[::3], BENDS[::2]), (0.0, POWERS[::2], BENDS[::2])):
        # a slope with travel is no noise: where the punch is parked for long enough, only that is taken
        noise = noise_before(time, load, span, go if go - start >= PARKED_LONG else at)
        bins, low, high = _looked_at(time, x, load, span, (go, at), noise, share)
        ways = np.linspace(low, high, _WAYS + 1)
        weight = _posterior(bins, noise, ways, tare_N, powers, bends)
        at = go + int(np.argmax(x[go : span.stop] >= np.sum(weight * ways) / weight.sum()))
    wide, step = ways[weight > 1e-3 * weight.max()], ways[1] - ways[0]
    ways = np.linspace(max(float(wide.min()) - step, low), min(float(wide.max()) + step, high), _WAYS + 1)
    weight = _posterior(bins, noise, ways, tare_N, POWERS, BENDS)
    position, share = float(np.sum(weight * ways) / weight.sum()), np.cumsum(weight) / weight.sum()
    margin = 0.25 * float(np.median(np.abs(np.diff(x[max(at - 3, 0) : at + 4]))))
    left, right = float(np.interp(0.025, share, ways)) - margin, float(np.interp(0.975, share, ways)) + margin
    free = min(left, position) - 0.25 * (position - left)
    baseline = find_baseline(time, x, load, span, (at, position, free), noise)
    speed = _speed(time, x, start, at, at + int(np.argmax(x[at : span.stop] >= high)))
    return ContactEstimate(position, left, right, baseline, speed, peak)


def _looked_at(
    time: NDArray, x: NDArray, load: NDArray, span: Span, contact: tuple[int, int], noise: BaselineNoise, share: float
) -> tuple[_Bins, float, float]:
    """The part of the rise that is looked at, and the range of places in which contact may lie."""
    go, at = contact
    start = span.start
    base = float(np.median(load[max(start, at - 10) : at + 1]))
    rise = float(load[start : span.stop].max()) - base
    height = max(share * rise, float(np.clip(SEEN * noise.sample_N, RISE[0] * rise, RISE[1] * rise)))
    top = max(at + int(np.argmax(load[at : span.stop] >= base + height)), at + 1, start + 2)
    reach = max(float(x[top] - x[at]), 1e-6)
    out = np.nonzero(x[start : at + 1] <= x[at] - 4.0 * reach)[0]
    near = max(start + int(out[-1]) if out.size else go, go)
    low = max(float(x[start : at + 1].min()), -np.inf if share else float(x[at]) - 2.0 * reach)
    return _bins(time, x, load, start, near, top), low, float(x[top]) - 0.1 * reach


def _speed(time: NDArray, x: NDArray, start: int, onset: int, top: int) -> float:
    """Speed through contact: over the part looked at, or just before it where the punch brakes already."""
    before = start + int(np.argmax(x[start : onset + 1] >= x[onset] - 0.3 * float(x[top] - x[onset])))
    ends = [(onset, top), (min(before, onset - 1), onset)] if onset > start else [(onset, top)]
    return max(float((x[b] - x[a]) / max(time[b] - time[a], 1e-9)) for a, b in ends)


@dataclass(frozen=True, eq=False)
class _Bins:
    """Means over parts of the lead-in (``early`` of them), then over even steps of position."""

    time_s: NDArray
    x: NDArray
    load: NDArray
    count: NDArray
    early: int


def _bins(time: NDArray, x: NDArray, load: NDArray, start: int, near: int, top: int) -> _Bins:
    parts = [part for part in np.array_split(np.arange(start, near), _PARTS) if len(part)]
    way = x[near : top + 1]
    cell = np.minimum(((way - way.min()) / max(float(np.ptp(way)), 1e-12) * _CELLS).astype(int), _CELLS - 1)
    number = np.bincount(cell, minlength=_CELLS)
    used = number > 0

    def means(values: NDArray) -> NDArray:
        late = np.bincount(cell, values[near : top + 1], _CELLS)[used] / number[used]
        return np.array([float(values[part].mean()) for part in parts] + late.tolist())

    count = np.array([len(part) for part in parts] + number[used].tolist(), float)
    return _Bins(means(time), means(x), means(load), count, len(parts))


def _posterior(
    bins: _Bins, noise: BaselineNoise, ways: NDArray, tare_N: float | None, powers: NDArray, bends: NDArray
) -> NDArray:
    """Relative probability of each place of contact over all laws of the rise, zeros, drifts and slopes."""
    late = np.arange(len(bins.x)) >= bins.early
    rise = np.maximum(bins.load - bins.load[: max(bins.early, 1)].mean(), 0.0)
    # bins within one step of the digits share its error, bins that follow quickly on one another share the wander
    together = np.sum(np.abs(bins.load[:, None] - bins.load) <= 0.5 * noise.step_N, axis=1)
    white = noise.sample_N**2 / bins.count
    lasting = np.minimum(noise.wander_s / np.maximum(np.gradient(bins.time_s), 1e-9), len(bins.x))
    weight = 1.0 / (white + noise.wander_N**2 * lasting + noise.rounding_N**2 * together + (MISFIT * rise) ** 2)
    # level, drift, slope, and what the level wanders between lead-in and approach; each with its prior
    columns = np.stack([np.ones_like(bins.x), bins.time_s - bins.time_s[-1], bins.x - bins.x[-1], late.astype(float)])
    wander = 1.0 / (noise.wander_N**2 + noise.rounding_N**2)
    prior = np.array([0.0 if tare_N is None else 1e30, DRIFT_N_S**-2, SLOPE_N_MM**-2, wander])
    load = bins.load - (tare_N or 0.0)
    normal = (columns * weight) @ columns.T + np.diag(prior)
    size = np.sqrt(np.diag(normal))
    root = np.linalg.solve(np.linalg.cholesky(normal / np.outer(size, size)), (columns * weight) / size[:, None])
    target = load * weight - root.T @ (root @ load)
    ramp = np.maximum(bins.x - ways[:, None], 0.0)
    ramp = ramp / np.maximum(ramp.max(axis=1, keepdims=True), 1e-12)
    logs, total = np.log(np.maximum(ramp, 1e-30)), float(load @ target)
    shapes = np.exp(powers[:, None, None] * logs)[:, None] * (1.0 + bends[:, None, None] * ramp)
    size = np.maximum(shapes**2 @ weight - np.sum((shapes @ root.T) ** 2, axis=-1), 1e-300)
    misfit = total - np.maximum(shapes @ target, 0.0) ** 2 / size
    scale = max(1.0, float(misfit.min()) / max(len(bins.x) - 7, 1))
    return np.exp(-0.5 * (misfit - misfit.min()) / scale).sum(axis=(0, 1))


FILTER_DELAY_S = 6.4e-3
"""Delay of a second-order low-pass of 35 Hz, sqrt(2) / (2 pi 35 Hz), which the file's force may have gone through."""
SURE_MM, SURE_SHARE = 0.25, 0.07
"""Half-width of the contact's interval that is good enough: in mm, or as a share of the depth."""
SMALL_MM, BENEFIT = 0.05, 0.5
"""The file's own zero stands unless it lies beyond the interval by half its half-width (1 in 300) and 0.05 mm."""
LATE_MM, LATE_SHARE = 0.1, 0.03
"""Distance of the contact from the file's own zero that deserves a word although a filter explains it."""
UNSURE_MM, UNSURE_SHARE = 0.02, 0.01
"""Half-width of the contact's interval above which a zero that rests on it is called uncertain."""
FORCE_DIGITS = 4
"""Digits of the tare in N: a tenth of a millinewton is far below any noise. Of the contact they are micrometres."""
OTHER_SITE = 0.5
"""Share of the deepest press so far beyond which a later contact is another place, not the dent that was left."""


def interval(contact: ContactEstimate) -> tuple[float, float]:
    """Interval of the contact when the force may be late by a filter that is not declared, and is not seen. [mm]"""
    unseen = 0.0 if contact.delay_s else FILTER_DELAY_S
    return contact.low_mm - max(contact.velocity_mm_s, 0.0) * unseen, contact.high_mm


def find_contacts(
    contacts: Sequence[ContactEstimate],
    depths: Sequence[float],
    first_mm: float,
    sign: float,
    log: ImportLog,
    given_mm: float | None = None,
    given_by: str = "given by --contact",
) -> list[float]:
    """Choose the zero of position of each press: the reading that is given, the file's own, or contact. [mm]"""
    if log.settings.contact == "none" or given_mm is not None:
        log.decide("contact", "the file's own zero" if given_mm is None else f"{given_mm:.10g} mm", given_by)
        return [0.0 if given_mm is None else sign * given_mm] * len(contacts)
    first = _reference(contacts)
    reference, depth = contacts[first], depths[first]
    if own_zero_agrees(reference) and first_mm <= SMALL_MM:
        zero, text = 0.0, _text(reference, sign)
        log.decide("contact", "the file's own zero", f"the force begins at {text}, which agrees with it")
        _doubt_own_zero(reference, depth, sign, log)
    else:
        zero = _zero_by_force(_together(contacts, first), depth, sign, log)
    later = enumerate(contacts[1:], 1)
    return [zero, *(_zero_of_press(at, one, zero, max(depths[: at + 1]), sign, log) for at, one in later)]


def own_zero_agrees(contact: ContactEstimate) -> bool:
    """Whether zero lies within the interval of the contact, given the benefit of the doubt."""
    low, high = interval(contact)
    more = BENEFIT * 0.5 * (contact.high_mm - contact.low_mm) + SMALL_MM
    return low - more <= 0.0 <= high + more


def contact_off(contact: ContactEstimate, depth_mm: float) -> str:
    """Return the words of a contact that is not at zero; empty where it may be, or is so nearly."""
    if own_zero_agrees(contact) or abs(contact.position_mm) <= max(LATE_MM, LATE_SHARE * depth_mm):
        return ""
    return f"the force begins at {_text(contact, 1.0)}, not at zero displacement"


def _doubt_own_zero(contact: ContactEstimate, depth: float, sign: float, log: ImportLog) -> None:
    """Warn where the file's own zero is kept, but the force does not agree with it closely."""
    off = contact.position_mm
    if abs(off) <= max(LATE_MM, LATE_SHARE * depth):
        return
    low, high = interval(contact)
    if not contact.low_mm <= 0.0 <= contact.high_mm:
        late = f"at {contact.velocity_mm_s:.3g} mm/s would agree with it behind a force filter"
        why = late if low <= 0.0 < contact.low_mm else "only just agrees with it"
        log.warn(
            "contact_may_be_late",
            f"the file's own zero is kept, but the force begins at {_text(contact, sign)}, "
            f"which {why}; else the surface lies {abs(off):.2g} mm {'deeper' if off > 0 else 'higher'}: press "
            "slowly once, or say --contact",
        )
    elif 0.5 * (high - low) > max(SURE_MM, SURE_SHARE * depth):
        log.warn(
            "contact_not_checked",
            f"by the force contact lies between {_between(contact, sign)}, which is too "
            "wide to check the file's own zero by: press slowly once, or say --contact",
        )


def _between(contact: ContactEstimate, sign: float) -> str:
    low, high = sorted(sign * end for end in interval(contact))
    return f"{low:.2f} and {high:.2f} mm (a filter of the force counted in)"


def _zero_by_force(contact: ContactEstimate, depth: float, sign: float, log: ImportLog) -> float:
    """The contact that the force tells, where it tells it closely enough."""
    low, high = interval(contact)
    zero_mm, wide, text = round(contact.position_mm, 3), 0.5 * (high - low), _text(contact, sign)
    if wide > max(SURE_MM, SURE_SHARE * depth):
        raise log.question(
            f"contact lies between {_between(contact, sign)}, too wide to take its middle",
            f"--contact N with the reading at contact, as a slow press shows it, or --contact {sign * zero_mm:.3f}",
            allowed=sorted((sign * low, sign * high)),
        )
    log.decide("contact", f"{sign * zero_mm:.3f} mm", f"the force begins there ({text}), not at the file's own zero")
    if wide > max(UNSURE_MM, UNSURE_SHARE * depth):
        log.warn(
            "contact_uncertain",
            f"the zero rests on the force alone, which begins at {text}: it may be "
            f"{wide:.2g} mm off; a slower press or a sensor of less noise tells it more closely, or "
            "say --contact N",
        )
    return zero_mm


def _text(contact: ContactEstimate, sign: float) -> str:
    low, high = sorted(sign * end for end in (contact.low_mm, contact.high_mm))
    return f"{sign * contact.position_mm:.3f} mm (95 %: {low:.3f} to {high:.3f})"


def _reference(contacts: Sequence[ContactEstimate]) -> int:
    """The press that tells the contact: the first meets a fresh surface; a later one where only that was slow."""
    slowest = min(range(len(contacts)), key=lambda number: contacts[number].velocity_mm_s)
    low, high = interval(contacts[slowest])
    first_low, first_high = interval(contacts[0])
    slower = contacts[slowest].velocity_mm_s < 0.5 * contacts[0].velocity_mm_s
    return slowest if slower and low <= first_high and high >= first_low and high - low < first_high - first_low else 0


def _together(contacts: Sequence[ContactEstimate], first: int) -> ContactEstimate:
    """The contact by all presses that agree with the first within their errors, weighted by these."""
    reference = contacts[first]
    half_width = 0.5 * (reference.high_mm - reference.low_mm)
    agree = [
        (one.position_mm, half)
        for one in contacts
        for half in [0.5 * (one.high_mm - one.low_mm)]
        if abs(one.position_mm - reference.position_mm) <= math.hypot(half, half_width)
        and one.velocity_mm_s <= 2.0 * reference.velocity_mm_s
    ]
    weights = [half**-2 for _, half in agree]
    position = sum(weight * mm for weight, (mm, _) in zip(weights, agree)) / sum(weights)
    half = sum(weights) ** -0.5
    return replace(reference, position_mm=position, low_mm=position - half, high_mm=position + half)


def _zero_of_press(
    number: int, contact: ContactEstimate, zero: float, depth: float, sign: float, log: ImportLog
) -> float:
    """The zero of a later press: the common one, unless this press was plainly made somewhere else."""
    low, high = interval(contact)
    off = contact.position_mm - zero
    if low - SMALL_MM <= zero <= high + SMALL_MM:
        return zero
    if off < 0 or off > OTHER_SITE * depth:
        log.warn(
            "another_place",
            f"press {number + 1} begins at {sign * contact.position_mm:.3f} mm, {abs(off):.2g} "
            f"mm {'above' if off < 0 else 'below'} the first contact: taken as another place with a zero of its "
            "own; if it is the same place, say --contact",
        )
        return contact.position_mm
    log.warn(
        "surface_not_back",
        f"press {number + 1} begins {off:.2g} mm deeper than the first contact, which stays "
        "zero: the surface had not come back; rest longer between presses, or tell the loop the rest",
    )
    return zero


def find_tares(
    contacts: Sequence[ContactEstimate], rest_N: float, sign: float, log: ImportLog, given_N: float | None = None
) -> list[Baseline]:
    """Choose what is subtracted from the force of each press: the reading that is given, or that at no load.

    ``level_N`` of what is returned counts as the file does, compression positive. Numbers are shown as the file counts,
    with the digits that are taken: typed, they give the same traces.
    """
    first = contacts[0].baseline
    if log.settings.tare == "none" or given_N is not None:
        log.decide("tare", "none" if given_N is None else f"{given_N:.10g} N", "given by --tare")
        level_N = 0.0 if given_N is None else sign * given_N
        return [_stated(_constant(one.baseline, level_N), one.baseline.mean_N) for one in contacts]
    if first.samples < LEAST_LEAD_IN:
        if abs(rest_N) > max(4.0 * max(first.noise_N, 1e-12), 0.004 * contacts[0].peak_N):
            shown = sign * rest_N
            doubt = f"the force is {shown:.3g} N at the first sample and there is no lead-in before contact"
            raise log.question(
                f"{doubt}: an offset, or already pressed",
                f"--tare {force_text(shown)} where it is an offset (first: of each file), --tare none where it presses",
            )
        log.decide("tare", "none", "there is no lead-in, and the force begins at zero within its noise")
        return [_stated(_constant(one.baseline, 0.0), -rest_N) for one in contacts]
    lines = [_line(one, rest_N, log) for one in contacts]
    level = lines[0].level_N
    text = (
        f"{first.samples} samples before contact, {force_text(sign * level)} N with an error of "
        f"{lines[0].error_N:.2g} N"
    )
    if any(one.effect_N for one in lines):
        log.decide("tare", f"a line, {sign * level:.4g} N at contact", _words_of_line(lines[0], text))
        return [_stated(one, one.level_N - rest_N) for one in lines]
    # nothing of a tared file is changed
    tared = abs(level) <= 1.5 * first.error_N or abs(level) < 0.1 * first.noise_N
    tare = 0.0 if tared else round(level, FORCE_DIGITS)
    tares = [tare]
    for one in lines[1:]:
        if one.samples >= LEAST_LEAD_IN and abs(one.level_N - tare) > 3.0 * (one.error_N + first.error_N):
            tare = round(one.level_N, FORCE_DIGITS)
        tares.append(tare)
    wanders = max(tares) > min(tares)
    one_value = "none" if tared else f"{force_text(sign * tares[0])} N"
    why = f"the mean of {text}" + (" is zero within its noise" if tared else "")
    log.decide("tare", "each press by its own lead-in" if wanders else one_value, why)
    if wanders:
        text = ", ".join(force_text(sign * tare) for tare in tares)
        log.warn(
            "zero_wanders",
            f"the force at no load changes from press to press ({text} N); each press is tared by "
            "its own lead-in: let the sensor warm up, or zero it before each press",
        )
    return [_stated(_constant(one, tare), tare - rest_N) for one, tare in zip(lines, tares)]


def _stated(line: Baseline, taken_N: float) -> Baseline:
    """The same with the change that a constant leaves out in the error of the steady force."""
    left_out_N = 0.0 if line.effect_N else taken_N - line.held_N
    return replace(line, held_error_N=with_bias(line.held_error_N, left_out_N))


def force_text(force_N: float) -> str:
    """A reading at no load with the digits that are taken. [N]"""
    return f"{round(force_N, FORCE_DIGITS) + 0.0:.{FORCE_DIGITS}f}"


def _constant(baseline: Baseline, level_N: float) -> Baseline:
    return replace(baseline, level_N=level_N, drift_N_s=0.0, slope_N_mm=0.0, effect_N=0.0)


def _line(contact: ContactEstimate, rest_N: float, log: ImportLog) -> Baseline:
    """The reading at no load with its drift and slope where they matter, without them where they do not."""
    line, kind = contact.baseline, log.settings.tare
    changes = line.effect_N + abs(line.level_N - line.mean_N)
    if changes <= max(MATTERS * contact.peak_N, 2.0 * line.effect_error_N):
        return _constant(line, rest_N + line.mean_N)
    if line.drift_alone_N_s and kind not in ("drift", "slope"):
        raise log.question(
            f"before contact the force changes by {line.before_N:+.3g} N while the punch moves; either as a drift "
            f"with time ({line.drift_alone_N_s:+.3g} N/s) or as a slope with travel "
            f"({line.slope_alone_N_mm:+.3g} N/mm)",
            "--tare drift or --tare slope, whichever it is (the punch moved in the air shows it)",
        )
    line = line.only(kind)
    if not line.comes_back:
        log.warn(
            "force_drifts",
            f"{_words_of_line(line, 'the force before contact')}; by the end of the hold it is "
            f"{line.effect_N:.2g} N with an error of {line.effect_error_N:.2g} N if it goes on like this: let the "
            "sensor warm up, record after the punch is back, or keep the force by --tare N",
        )
    return replace(line, level_N=rest_N + line.level_N)


def _words_of_line(line: Baseline, text: str) -> str:
    parts = [f"{line.drift_N_s:+.3g} N/s"] if line.drift_N_s else []
    parts += [f"{line.slope_N_mm:+.3g} N per mm of travel"] if line.slope_N_mm else []
    return f"{text} changes by {' and '.join(parts)}; a straight line is subtracted"
