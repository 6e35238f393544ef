"""Uncertainty budget of what a press would have been on one more person, and the statement on the nearest limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.assessment.budget import Budget, Reading, UncertaintyComponent, decide

if TYPE_CHECKING:
    from dummydesign.person.limits import LimitRow
    from dummydesign.person.on_person import OnPerson, PersonPress

OWN, DIFFER = "subjects and trace", "differences among people"
NO_LIMIT = "no limit was given"
BEYOND = "the press goes beyond those on people by an unknown error"
# Quantity of the subjects' own intervals by the kind of a limit.
OF_KIND = {"transient": "peak_N", "quasi-static": "steady_N"}


def middle_and_spread(ends: Sequence[float | None] | None) -> tuple[float, float] | None:
    """Geometric middle of a 95 % interval, and the standard deviation of the logarithm; None where it is not known."""
    if ends is None or ends[0] is None or ends[1] is None or not 0.0 < ends[0] <= ends[1]:
        return None
    return math.sqrt(ends[0] * ends[1]), math.log(ends[1] / ends[0]) / (2.0 * HALF_WIDTH)


def budget_of_people(answer: OnPerson) -> Budget | None:
    """Make the budget of the reading that decides; None where no interval of people is known.

    With limits it is the check that is most probably not met, else the largest peak. The spread of one more person is
    that of the 95 % interval; the part of the subjects' own intervals in it, which holds the trace as well, is the root
    mean square over the subjects, the rest are differences among people.
    """
    limited = [(press, row) for press in answer.presses for row in press.limits]
    checks = [
        (press, row, known)
        for press, row in limited
        if (known := middle_and_spread((row.person_low_95, row.person_high_95)))
    ]
    if checks:
        press, row, known = max(checks, key=lambda one: math.log(one[2][0] / one[1].limit) / max(one[2][1], 1e-9))
        return _of_check(press, row, *known)
    peaks = [(press, known) for press in answer.presses if (known := middle_and_spread(press.interval["peak_N"]))]
    if not peaks or limited:
        return None
    press, (value, spread) = max(peaks, key=lambda one: one[1][0])
    reading = Reading(
        "peak force on one more person", value, "N", None, press.press.velocity_mm_s, press.press.trace.name
    )
    return Budget(reading, _components(press, "peak_N", spread), NO_LIMIT, None, doubt=BEYOND if press.beyond else "")


def _of_check(press: PersonPress, row: LimitRow, value: float, spread: float) -> Budget:
    kind = row.name.rpartition(" ")[2]
    quantity = row.name.rpartition(" ")[0]
    reading = Reading(
        f"{kind} {quantity} on one more person",
        value,
        row.unit,
        None,
        press.press.velocity_mm_s,
        press.press.trace.name,
    )
    decision = decide(value, (None, row.limit), (0.0, spread))
    requirement = f"{kind} {quantity} at most {row.limit:.4g} {row.unit}"
    doubt = BEYOND if press.beyond else ""
    return Budget(reading, _components(press, OF_KIND[kind], spread), requirement, decision, doubt=doubt)


def _components(press: PersonPress, quantity: str, spread: float) -> tuple[UncertaintyComponent, ...]:
    """Parts whose root sum of squares is the spread of one more person."""
    own = [middle_and_spread((one["interval_95"] or {}).get(quantity)) for one in press.subjects]
    known = [one[1] for one in own if one is not None]
    if not known:
        return UncertaintyComponent(OWN, None), UncertaintyComponent(DIFFER, 100.0 * spread)
    mean = min(float(np.sqrt(np.mean(np.square(known)))), spread)
    return UncertaintyComponent(OWN, 100.0 * mean), UncertaintyComponent(DIFFER, 100.0 * math.sqrt(spread**2 - mean**2))
