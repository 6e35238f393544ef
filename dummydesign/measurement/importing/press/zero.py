"""Zero of force and position: the laboratory's own where the force agrees with it, else the contact that was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from dummydesign.measurement.importing.core.decisions import Notes, question
from dummydesign.measurement.importing.press.contact import LEAST_LEAD_IN, Contact

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


def interval(contact: Contact) -> tuple[float, float]:
    """Interval of the contact when the force may be late by a filter nobody told of. [mm]"""
    return contact.low_mm - max(contact.velocity_mm_s, 0.0) * FILTER_DELAY_S, contact.high_mm


def find_contacts(
    file: str, contacts: Sequence[Contact], depths: Sequence[float], first_mm: float, sign: float, notes: Notes
) -> list[float]:
    """Choose the zero of position of each press.

    Parameters
    ----------
    file : str
        Name for messages.
    contacts : sequence of Contact
        One a press, in order.
    depths : sequence of float
        Deepest position of each press less its contact. [mm]
    first_mm : float
        Position at the first sample. [mm]
    sign : float
        -1 where the file's own position falls while pressing; readings are printed as the file counts them.
    notes : Notes
        Receives the decisions.

    Returns
    -------
    list of float
        Position of contact of each press, compression positive. [mm]

    Raises
    ------
    QuestionError
        When the file's own zero does not fit and the contact cannot be told from the force closely enough.
    """
    first = _reference(contacts)
    reference, depth = contacts[first], depths[first]
    if own_zero_agrees(reference) and first_mm <= SMALL_MM:
        zero = 0.0
        notes.decide(
            "contact", "the file's own zero", f"the force begins at {_text(reference, sign)}, which agrees with it"
        )
        _doubt_own_zero(file, reference, depth, sign, notes)
    else:
        zero = _by_force(file, _together(contacts, first), depth, sign, notes)
    return [
        _of_press(number, contact, zero, max(depths[: number + 1]), sign, file, notes)
        for number, contact in enumerate(contacts)
    ]


def own_zero_agrees(contact: Contact) -> bool:
    """Whether zero lies within the interval of the contact, given the benefit of the doubt."""
    low, high = interval(contact)
    more = BENEFIT * 0.5 * (contact.high_mm - contact.low_mm) + SMALL_MM
    return low - more <= 0.0 <= high + more


def contact_off(contact: Contact, depth_mm: float) -> str:
    """Say that contact is not at zero; empty where it may be, or is so nearly that it does not matter."""
    if own_zero_agrees(contact) or abs(contact.position_mm) <= max(LATE_MM, LATE_SHARE * depth_mm):
        return ""
    return f"the force begins at {_text(contact, 1.0)}, not at zero displacement"


def _doubt_own_zero(file: str, contact: Contact, depth: float, sign: float, notes: Notes) -> None:
    """A word where the file's own zero stands, but not because the force agrees with it closely."""
    off, limit = contact.position_mm, max(LATE_MM, LATE_SHARE * depth)
    low, high = interval(contact)
    if abs(off) > limit and not contact.low_mm <= 0.0 <= contact.high_mm:
        why = "only just agrees with it"
        if low <= 0.0 < contact.low_mm:
            why = f"at {contact.velocity_mm_s:.3g} mm/s would agree with it behind a force filter"
        notes.warn(
            "contact_may_be_late",
            f"{file}: the file's own zero is kept, but the force begins at {_text(contact, sign)}, which {why}; "
            "else the "
            f"surface lies {abs(off):.2g} mm {'deeper' if off > 0 else 'higher'}: press slowly once, or say --contact",
        )
    elif abs(off) > limit and 0.5 * (high - low) > max(SURE_MM, SURE_SHARE * depth):
        ends = sorted((sign * low, sign * high))
        notes.warn(
            "contact_not_checked",
            f"{file}: by the force contact lies between {ends[0]:.2f} and {ends[1]:.2f} mm (a filter of the force "
            "counted in), which is too wide to check the file's own zero by: press slowly once, or say --contact",
        )


def _by_force(file: str, contact: Contact, depth: float, sign: float, notes: Notes) -> float:
    """The contact that the force tells, where it tells it closely enough."""
    low, high = interval(contact)
    found, wide, text = contact.position_mm, 0.5 * (high - low), _text(contact, sign)
    if wide > max(SURE_MM, SURE_SHARE * depth):
        ends = sorted((sign * low, sign * high))
        raise question(
            file,
            f"contact lies between {ends[0]:.2f} and {ends[1]:.2f} mm (a filter of the force counted in), too wide to "
            "take its middle",
            f"--contact N with the reading at contact, as a slow press shows it, or --contact {sign * found:.3f}",
        )
    notes.decide("contact", f"{sign * found:.3f} mm", f"the force begins there ({text}), not at the file's own zero")
    if wide > max(UNSURE_MM, UNSURE_SHARE * depth):
        notes.warn(
            "contact_uncertain",
            f"{file}: the zero rests on the force alone, which begins at {text}: it may be {wide:.2g} mm off; a slower "
            "press or a sensor of less noise tells it more closely, or say --contact N",
        )
    return found


def _text(contact: Contact, sign: float) -> str:
    ends = sorted((sign * contact.low_mm, sign * contact.high_mm))
    return f"{sign * contact.position_mm:.3f} mm (95 %: {ends[0]:.3f} to {ends[1]:.3f})"


def _reference(contacts: Sequence[Contact]) -> int:
    """The press that tells the contact: the first meets a fresh surface; a later one where only that was slow."""
    slowest = min(range(len(contacts)), key=lambda number: contacts[number].velocity_mm_s)
    low, high = interval(contacts[slowest])
    first_low, first_high = interval(contacts[0])
    slower = contacts[slowest].velocity_mm_s < 0.5 * contacts[0].velocity_mm_s
    return slowest if slower and low <= first_high and high >= first_low and high - low < first_high - first_low else 0


def _together(contacts: Sequence[Contact], first: int) -> Contact:
    """The contact by all presses that agree with the first within their errors, weighted by these."""
    halves = [0.5 * (contact.high_mm - contact.low_mm) for contact in contacts]
    reference = contacts[first]
    agree = [
        (contact.position_mm, half)
        for contact, half in zip(contacts, halves)
        if abs(contact.position_mm - reference.position_mm) <= math.hypot(half, halves[first])
        and contact.velocity_mm_s < 2.0 * reference.velocity_mm_s
    ]
    weights = [half**-2 for _, half in agree]
    position = sum(weight * place for weight, (place, _) in zip(weights, agree)) / sum(weights)
    half = sum(weights) ** -0.5
    return replace(reference, position_mm=position, low_mm=position - half, high_mm=position + half)


def _of_press(number: int, contact: Contact, zero: float, depth: float, sign: float, file: str, notes: Notes) -> float:
    """The zero of one press: the common one, unless this press was plainly made somewhere else."""
    low, high = interval(contact)
    off = contact.position_mm - zero
    if low - SMALL_MM <= zero <= high + SMALL_MM or number == 0:
        return zero
    if off < 0 or off > OTHER_SITE * depth:
        notes.warn(
            "another_place",
            f"{file}: press {number + 1} begins at {sign * contact.position_mm:.3f} mm, {abs(off):.2g} mm "
            f"{'above' if off < 0 else 'below'} the first contact: taken as another place with a zero of its own; if "
            "it is the same place, say --contact",
        )
        return contact.position_mm
    notes.warn(
        "surface_not_back",
        f"{file}: press {number + 1} begins {off:.2g} mm deeper than the first contact, which stays zero: the surface "
        "had not come back; rest longer between presses, or tell the loop the rest",
    )
    return zero


def find_tares(file: str, contacts: Sequence[Contact], rest_N: float, flipped: bool, notes: Notes) -> list[float]:
    """Choose what is subtracted from the force of each press.

    Only a lead-in shows what the force reads at no load; a press without one takes that of the press before.

    Parameters
    ----------
    file : str
        Name for messages.
    contacts : sequence of Contact
        One a press; their tares count from ``rest_N``.
    rest_N : float
        Reading at rest, compression positive. [N]
    flipped : bool
        Whether the file's own force counts the other way.
    notes : Notes
        Receives the decisions.

    Raises
    ------
    QuestionError
        When there is no lead-in and the force does not begin at zero.
    """
    first = contacts[0]
    if first.lead_in < LEAST_LEAD_IN:
        level, noise = rest_N, max(first.noise_N, 1e-12)
        if abs(level) > max(4.0 * noise, 0.004 * first.peak_N):
            shown = -level if flipped else level
            raise question(
                file,
                f"the force is {shown:.3g} N at the first sample and there is no lead-in before contact: an offset, or "
                "already pressed",
                f"--tare {shown:.4g} where it is an offset, --tare none where it presses",
            )
        notes.decide("tare", "none", "there is no lead-in, and the force begins at zero within its noise")
        tares, before = [0.0], 0.0
    else:
        before = _significant(first, rest_N, notes)
        tares = [before]
    for contact in contacts[1:]:
        own = contact.lead_in >= LEAST_LEAD_IN
        level = rest_N + contact.tare_N if own else before
        before = level if own and abs(level - before) > 3.0 * (contact.tare_error_N + _error(first)) else before
        tares.append(before)
    if max(tares) - min(tares) > 0.0:
        text = ", ".join(f"{tare:.4g}" for tare in tares)
        notes.warn(
            "zero_wanders",
            f"{file}: the force at no load changes from press to press ({text} N); each press is tared by its own "
            "lead-in: let the sensor warm up, or zero it before each press",
        )
    return tares


def _error(contact: Contact) -> float:
    return contact.tare_error_N if contact.lead_in >= LEAST_LEAD_IN else 0.0


def _significant(contact: Contact, rest_N: float, notes: Notes) -> float:
    """The lead-in's mean, or zero where its error holds zero: then nothing of a tared file is changed."""
    level = rest_N + contact.tare_N
    text = (
        f"mean of {contact.lead_in} samples before contact, {level:.4g} N with an error of {contact.tare_error_N:.2g} N"
    )
    if abs(level) <= 1.5 * contact.tare_error_N or abs(level) < 0.1 * contact.noise_N:
        notes.decide("tare", "none", f"the {text} is zero within its noise")
        return 0.0
    notes.decide("tare", f"{level:.4g} N", f"the {text}")
    return level
