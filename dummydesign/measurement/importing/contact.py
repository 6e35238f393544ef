"""Tare, contact and zero of one press, with their errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.signs import Span, noise_of

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
class ContactEstimate:
    """Where the punch touches, and what the force reads before."""

    position_mm: float
    low_mm: float
    high_mm: float
    tare_N: float
    tare_error_N: float
    noise_N: float
    lead_in: int
    drift_N: float
    velocity_mm_s: float
    peak_N: float


def find_contact(time: NDArray, x: NDArray, load: NDArray, span: Span, tare_N: float | None = None) -> ContactEstimate:
    """Find contact and tare of one press.

    The force before and shortly after contact is fitted by b + a u^n (1 + c u), u = max(x - x0, 0), along the
    measured position: b is the tare and x0 the contact; n is left free between 0.8 and 3.2 (a flat punch 1, a ball
    1.5, tissue 3), and c so that the force may bend by -60 to 10 % on the way. The interval of x0 is the profile of
    the misfit over a, b, c and n; x0 is the mean over that profile.
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
    if not out.size:  # the first sample of the approach: after it the punch only comes nearer
        out = np.nonzero(x[start : onset + 1] <= float(x[start : onset + 1].min()) + 0.02 * reach)[0]
    near = start + int(out[-1])
    centres, means, counts = _bins(x, load, start, near, top)
    scatter = float(np.std(load[start:near])) if near - start >= LEAST_LEAD_IN else 0.0
    noise = max(scatter, noise_of(load[start : top + 1]), 1e-9 * peak)
    high = float(x[onset])
    low = max(float(x[start : onset + 1].min()), high - 2.0 * reach)
    variance = noise**2 / counts + (0.3 * noise) ** 2 + (MISFIT * np.maximum(means, 0.0)) ** 2
    dof = max(len(means) - 5, 1)
    ways = np.linspace(low, high, _WAYS + 1)
    step = max((high - low) / _WAYS, 1e-6)
    misfit = _profile(centres, means, variance, ways, tare_N)
    wide = ways[misfit <= misfit.min() + 8.0 * max(1.0, float(misfit.min()) / dof)]
    ways = np.linspace(float(wide.min()) - step, min(float(wide.max()) + step, high), _WAYS + 1)
    misfit = _profile(centres, means, variance, ways, tare_N)
    best = int(np.argmin(misfit))
    scale = max(1.0, float(misfit[best]) / dof)
    inside = ways[misfit <= misfit[best] + 4.0 * scale]
    weight = np.exp(-0.5 * (misfit - misfit[best]) / scale)
    position = float(np.sum(weight * ways) / weight.sum())
    spacing = float(np.median(np.abs(np.diff(x[max(onset - 3, 0) : onset + 4]))))
    margin = 0.5 * spacing + LAW * (float(x[top]) - position)
    left, right = float(inside.min()) - margin, float(inside.max()) + margin
    free = np.nonzero(x[start:onset] < min(left, position) - 0.25 * (position - left))[0]
    lead = load[start : start + (int(free[-1]) + 1 if free.size else 0)]
    tare, error, deviation, drift = _tare(lead, noise)
    speed = _speed(time, x, start, onset, top)
    return ContactEstimate(position, left, right, tare, error, deviation, len(lead), drift, speed, peak)


def _speed(time: NDArray, x: NDArray, start: int, onset: int, top: int) -> float:
    """Speed through contact: over the part looked at, or just before it where the punch brakes already."""
    before = start + int(np.argmax(x[start : onset + 1] >= x[onset] - 0.3 * float(x[top] - x[onset])))
    ends = [(onset, top), (min(before, onset - 1), onset)] if onset > start else [(onset, top)]
    return max(float((x[b] - x[a]) / max(time[b] - time[a], 1e-9)) for a, b in ends)


def _bins(x: NDArray, load: NDArray, start: int, near: int, top: int) -> tuple[NDArray, NDArray, NDArray]:
    """Mean position and force: up to twenty bins before ``near``, then even steps of position to ``top``."""
    parts = [part for part in np.array_split(np.arange(start, near), 20) if len(part)]
    way, force = x[near : top + 1], load[near : top + 1]
    share = (way - way.min()) / max(float(way.max() - way.min()), 1e-12)
    cell = np.minimum((share * _CELLS).astype(int), _CELLS - 1)
    number = np.bincount(cell, minlength=_CELLS)
    used = number > 0
    centres = (np.bincount(cell, way, _CELLS)[used] / number[used]).tolist()
    means = (np.bincount(cell, force, _CELLS)[used] / number[used]).tolist()
    return (
        np.array([float(x[part].mean()) for part in parts] + centres),
        np.array([float(load[part].mean()) for part in parts] + means),
        np.array([len(part) for part in parts] + number[used].tolist(), float),
    )


def _profile(centres: NDArray, means: NDArray, variance: NDArray, ways: NDArray, tare_N: float | None) -> NDArray:
    """Least misfit over a, b, c and n for each place of contact."""
    weight = 1.0 / variance
    ramp = np.maximum(centres - ways[:, None], 0.0)
    ramp = ramp / np.maximum(ramp.max(axis=1, keepdims=True), 1e-12)
    logs = np.log(np.maximum(ramp, 1e-30))
    total, force, square = weight.sum(), (weight * means).sum(), (weight * means**2).sum()
    best = np.full(len(ways), np.inf)
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
            best = np.where(misfit < best, misfit, best)
    return best


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
    drift = drift if abs(drift) > 4.0 * max(inner, noise / 5.0) else 0.0
    return float(np.mean(lead)), error, float(np.std(lead)), drift


FILTER_DELAY_S = 6.4e-3
"""Delay of a second-order low-pass of 35 Hz, sqrt(2) / (2 pi 35 Hz), which the file's force may have gone through."""
SURE_MM, SURE_SHARE = 0.25, 0.07
"""Half-width of the contact's interval that is good enough: in mm, or as a share of the depth."""
SMALL_MM, BENEFIT = 0.05, 0.5
"""The file's own zero stands unless it lies beyond the interval by half its half-width (1 in 300) and 0.05 mm."""
LATE_MM, LATE_SHARE = 0.1, 0.03
"""Distance of the contact from the file's own zero that deserves a word although a filter explains it."""
UNSURE_MM, UNSURE_SHARE = 0.06, 0.015
"""Half-width of the contact's interval above which a zero that rests on it is called uncertain."""
OTHER_SITE = 0.5
"""Share of the deepest press so far beyond which a later contact is another place, not the dent that was left."""


def interval(contact: ContactEstimate) -> tuple[float, float]:
    """Interval of the contact when the force may be late by a filter that is not declared. [mm]"""
    return contact.low_mm - max(contact.velocity_mm_s, 0.0) * FILTER_DELAY_S, contact.high_mm


def find_contacts(
    contacts: Sequence[ContactEstimate], depths: Sequence[float], first_mm: float, sign: float, log: ImportLog,
    given_mm: float | None = None,
) -> list[float]:  # fmt: skip
    """Choose the zero of position of each press: the reading that is given, the file's own, or contact. [mm]"""
    if log.settings.contact == "none" or given_mm is not None:
        zero = 0.0 if given_mm is None else sign * given_mm
        log.decide("contact", "the file's own zero" if given_mm is None else f"{zero:.6g} mm", "given by --contact")
        return [zero] * len(contacts)
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
        log.warn("contact_may_be_late", f"the file's own zero is kept, but the force begins at {_text(contact, sign)}, "
                 f"which {why}; else the surface lies {abs(off):.2g} mm {'deeper' if off > 0 else 'higher'}: press "
                 "slowly once, or say --contact")  # fmt: skip
    elif 0.5 * (high - low) > max(SURE_MM, SURE_SHARE * depth):
        log.warn("contact_not_checked", f"by the force contact lies between {_between(contact, sign)}, which is too "
                 "wide to check the file's own zero by: press slowly once, or say --contact")  # fmt: skip


def _between(contact: ContactEstimate, sign: float) -> str:
    low, high = sorted(sign * end for end in interval(contact))
    return f"{low:.2f} and {high:.2f} mm (a filter of the force counted in)"


def _zero_by_force(contact: ContactEstimate, depth: float, sign: float, log: ImportLog) -> float:
    """The contact that the force tells, where it tells it closely enough."""
    low, high = interval(contact)
    zero_mm, wide, text = contact.position_mm, 0.5 * (high - low), _text(contact, sign)
    if wide > max(SURE_MM, SURE_SHARE * depth):
        raise log.question(
            f"contact lies between {_between(contact, sign)}, too wide to take its middle",
            f"--contact N with the reading at contact, as a slow press shows it, or --contact {sign * zero_mm:.3f}",
        )
    log.decide("contact", f"{sign * zero_mm:.3f} mm", f"the force begins there ({text}), not at the file's own zero")
    if wide > max(UNSURE_MM, UNSURE_SHARE * depth):
        log.warn("contact_uncertain", f"the zero rests on the force alone, which begins at {text}: it may be "
                 f"{wide:.2g} mm off; a slower press or a sensor of less noise tells it more closely, or "
                 "say --contact N")  # fmt: skip
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
        (one.position_mm, half) for one in contacts
        for half in [0.5 * (one.high_mm - one.low_mm)]
        if abs(one.position_mm - reference.position_mm) <= math.hypot(half, half_width)
        and one.velocity_mm_s < 2.0 * reference.velocity_mm_s
    ]  # fmt: skip
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
        log.warn("another_place", f"press {number + 1} begins at {sign * contact.position_mm:.3f} mm, {abs(off):.2g} "
                 f"mm {'above' if off < 0 else 'below'} the first contact: taken as another place with a zero of its "
                 "own; if it is the same place, say --contact")  # fmt: skip
        return contact.position_mm
    log.warn("surface_not_back", f"press {number + 1} begins {off:.2g} mm deeper than the first contact, which stays "
             "zero: the surface had not come back; rest longer between presses, or tell the loop the rest")  # fmt: skip
    return zero


def find_tares(
    contacts: Sequence[ContactEstimate], rest_N: float, sign: float, log: ImportLog, given_N: float | None = None
) -> list[float]:
    """Choose what is subtracted from the force of each press: the reading that is given, or that at no load. [N]"""
    if log.settings.tare == "none" or given_N is not None:
        tare = 0.0 if given_N is None else sign * given_N
        why = "given by --tare" + ("" if given_N is None else " (compression positive)")
        log.decide("tare", "none" if given_N is None else f"{tare:.6g} N", why)
        return [tare] * len(contacts)
    first, tare = contacts[0], 0.0
    level = rest_N + first.tare_N
    text = f"mean of {first.lead_in} samples before contact, {level:.4g} N with an error of {first.tare_error_N:.2g} N"
    if first.lead_in < LEAST_LEAD_IN:
        if abs(rest_N) > max(4.0 * max(first.noise_N, 1e-12), 0.004 * first.peak_N):
            shown = sign * rest_N
            doubt = f"the force is {shown:.3g} N at the first sample and there is no lead-in before contact"
            option = f"--tare {shown:.4g} where it is an offset (first: of each file), --tare none where it presses"
            raise log.question(f"{doubt}: an offset, or already pressed", option)
        log.decide("tare", "none", "there is no lead-in, and the force begins at zero within its noise")
    elif abs(level) <= 1.5 * first.tare_error_N or abs(level) < 0.1 * first.noise_N:
        # nothing of a tared file is changed
        log.decide("tare", "none", f"the {text} is zero within its noise")
    else:
        tare = level
        log.decide("tare", f"{level:.4g} N", f"the {text}")
    tares, error = [tare], first.tare_error_N if first.lead_in >= LEAST_LEAD_IN else 0.0
    for contact in contacts[1:]:
        level = rest_N + contact.tare_N
        if contact.lead_in >= LEAST_LEAD_IN and abs(level - tare) > 3.0 * (contact.tare_error_N + error):
            tare = level
        tares.append(tare)
    if max(tares) > min(tares):
        text = ", ".join(f"{tare:.4g}" for tare in tares)
        log.warn("zero_wanders", f"the force at no load changes from press to press ({text} N); each press is tared by "
                 "its own lead-in: let the sensor warm up, or zero it before each press")  # fmt: skip
    return tares
