"""Numbers of measured curves that can stand in a table: depths at steady forces, and peaks there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.tissue.model.held_press import DEPTH_MM, FORCE_APART
from dummydesign.tissue.model.laws.curves import CURVES, known_words
from dummydesign.tissue.model.measured_curves import MeasuredPerson
from dummydesign.tissue.model.tissue import Subject

ONE_FORCE = 1.3
"""Ratio of the highest to the lowest force in common below which one force stands for both."""


def subjects_of(people: Sequence[tuple[str, MeasuredPerson, str, str]]) -> tuple[Subject, ...]:
    """Make subjects of people with their presses.

    Parameters
    ----------
    people : sequence of (name, MeasuredPerson, kind, source)

    Raises
    ------
    InputError
        When they share no speed or no steady force.
    """
    every = [person for _, person, _, _ in people]
    speeds = sorted(set.intersection(*(set(one.velocities_mm_s) for one in every)))
    if not speeds:
        made = "; ".join(f"{name} at {', '.join(f'{v:g}' for v in one.velocities_mm_s)}" for name, one, _, _ in people)
        raise InputError(f"the people share no speed: {made} mm/s; press all at one speed")
    hold = min(one.hold_known_s() for one in every)
    forces = common_forces(every, speeds, hold)
    if not forces:
        made = "; ".join(f"{name} {known_words([one])}" for name, one, _, _ in people)
        raise InputError(f"the people share no steady force within 20 %: {made}; press all to the same steady forces")
    found = []
    for name, person, kind, source in people:
        numbers: dict[str, Quantity] = {}
        words = f"{source}; the interval is what {DEPTH_MM:g} mm of depth make of it"
        for force in forces:
            depth = float(person.depth_mm(force, hold))
            exponent = CURVES.exponent_of([person], force, force, hold)
            numbers[f"depth_at_{force:g}N_mm"] = _number(depth, DEPTH_MM, kind, words)
            for speed in speeds:
                rise, after = person.shape_N(force, speed, hold)
                peak = float(max(rise.max(), after.max()))
                width = peak * exponent * DEPTH_MM / depth
                numbers[f"peak_at_{force:g}N_{speed:g}mm_s_N"] = _number(peak, width, kind, words)
        found.append(Subject(name, person, numbers))
    return tuple(sorted(found, key=lambda one: -float(np.mean(one.parameters.depth_mm(np.array(forces), hold)))))  # type: ignore[attr-defined]


def common_forces(people: Sequence[MeasuredPerson], speeds: Sequence[float], hold_s: float) -> tuple[float, ...]:
    """Steady forces that all were pressed to at all speeds: the lowest, the middle and the highest, or one. [N]

    Parameters
    ----------
    people : sequence of MeasuredPerson
        With their presses.
    speeds : sequence of float
        That all share. [mm/s]
    hold_s : float
        At whose end forces are steady. [s]
    """
    spans = [span for one in people for speed in speeds if (span := one.known_N(speed, hold_s)) is not None]
    low, high = max(span[0] for span in spans), min(span[1] for span in spans)
    if low > high * FORCE_APART**2:
        return ()
    if high < ONE_FORCE * low:
        return (float(f"{np.sqrt(low * high):.2g}"),)
    return tuple(float(f"{force:.2g}") for force in (low, np.sqrt(low * high), high))


def _number(value: float, width: float, kind: str, source: str) -> Quantity:
    return Quantity(value, max(value - width, 0.5 * value), value + width, kind, source)
