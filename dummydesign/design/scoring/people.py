"""What the subjects of a tissue say of people in each press: share below the pad's peak, and bounds above a share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.people_share import (
    CONFIDENCE,
    LARGE_FACTOR,
    Population,
    is_share,
    share_of_aim,
    tolerance_factor,
)
from dummydesign.tissue.model.posterior import DRAWN, FARTHEST
from dummydesign.tissue.model.subject import Subject, flatten, nest

if TYPE_CHECKING:
    from collections.abc import Callable

    from dummydesign.design.scoring.targets import Condition, Targets
    from dummydesign.tissue.model.tissue import Tissue

SHARED = ("inferred", "assumed")
"""Kinds of numbers whose error is common to all subjects; the others err on their own."""
ENOUGH = (15, 40)
"""Numbers of subjects whose factor is named beside a large one."""
ONE, SPRING = "one subject does not show how people differ", "a spring constant says nothing of the peaks of people"


@dataclass(frozen=True)
class PeopleReadings:
    """People's peaks and energies in the c presses of a test, and their stiffness 1 / depth at its g steady forces.

    ``stated`` are the peaks as if the subjects were known exactly. Shapes (c,), (c,), (g,) and (c,).
    """

    peak_N: Population
    energy_mJ: Population
    stiffness_per_mm: Population
    stated: Population


@dataclass(frozen=True)
class ShareBelow(Serialised):
    """Expected share of people whose peak is at most the pad's, and the 90 % interval of the true share.

    ``below_expected_if_exact`` is the expected share if the subjects were known exactly. None where out of reach.
    """

    steady_force_N: float
    velocity_mm_s: float
    below_expected: float | None
    below_90: tuple[float, float] | None
    below_expected_if_exact: float | None


@dataclass(frozen=True)
class PeopleShares(Serialised):
    """The share of people below the pad's peak in each press; none, with the reason, where subjects do not say it."""

    subjects: int
    conditions: tuple[ShareBelow, ...]
    inferred: bool = False
    reason: str | None = None


def reason_of(tissue: Tissue) -> str | None:
    """Why the subjects of a tissue say nothing of people; None where they do."""
    law = law_named(tissue.law)
    if not (law.fitted or law.measured):
        return SPRING
    return ONE if len(tissue.subjects) < 2 else None


def people_of(targets: Targets) -> PeopleReadings | None:
    """Describe people by the subjects of a tissue in the presses of a test.

    An inferred tissue has groups of subjects that its data allow. Of others the spread between the subjects is never
    taken as smaller than the errors of their own numbers; errors of inferred numbers, the same for all, are added.
    """
    if reason_of(targets.tissue) is not None:
        return None
    grid, stated = targets.protocol.steady_grid_N, Population.of(_peaks(targets))
    views: tuple[Callable[[Targets], NDArray], ...] = (
        _peaks,
        lambda one: one.subject_energies_mJ(),
        lambda one: 1.0 / one.subject_depths_mm(grid),
    )
    if targets.tissue.posterior(1):
        groups = targets.drawn or targets.of_tissues(targets.tissue.posterior(DRAWN), "average")
        peak, energy, stiffness = (Population.of_groups([view(one) for one in groups]) for view in views)
        return PeopleReadings(peak, energy, stiffness, stated)
    moved = moved_tissues(targets.tissue)
    others = targets.of_tissues([one for _, one in moved], "average")
    kinds = [kind for kind, _ in moved]
    peak, energy, stiffness = (with_errors(view(targets), [view(one) for one in others], kinds) for view in views)
    return PeopleReadings(peak, energy, stiffness, stated)


def with_errors(readings: NDArray, moved: Sequence[NDArray], kinds: Sequence[str]) -> Population:
    """Population of subjects (n, ...) with the errors of their numbers, from the readings with one number moved."""
    own, shared = np.zeros(readings.shape[1:]), np.zeros(readings.shape[1:])
    for kind, other in zip(kinds, moved):
        square = np.mean(np.log(other / readings) ** 2, axis=0)
        own, shared = (own, shared + square) if kind in SHARED else (own + square, shared)
    return Population.of(readings, np.sqrt(own), np.sqrt(shared))


def moved_tissues(tissue: Tissue) -> list[tuple[str, Tissue]]:
    """The tissue with one number of every subject moved by its standard deviation, and the kind of that number."""
    if tissue.measured:
        return []
    rows = [flatten(subject.numbers) for subject in tissue.subjects]
    tissues = []
    for key in rows[0]:
        if all(key in row and row[key].low == row[key].high for row in rows):
            continue
        subjects = tuple(
            Subject.of(subject.name, subject.parameters.law, nest({**row, key: _one_deviation_up(row[key])}))
            for subject, row in zip(tissue.subjects, rows)
        )
        kinds = {row[key].kind for row in rows}
        tissues.append((SHARED[0] if kinds & set(SHARED) else "fitted", replace(tissue, subjects=subjects)))
    return tissues


def _one_deviation_up(number: Quantity) -> Quantity:
    width = math.log(number.high / max(number.low, 1e-9 * number.high)) / (2.0 * HALF_WIDTH)
    return replace(number, value=number.value * math.exp(min(width, FARTHEST)))


def _peaks(targets: Targets) -> NDArray:
    """Peak of each subject in each press, shape (subjects, c). [N]"""
    return np.stack([one.range.curves_N.max(axis=-1) for one in targets.conditions], axis=-1)


def shares_below(targets: Targets, peak_N: NDArray) -> PeopleShares:
    """Return the share of people below the peaks (c,) of a pad in the presses of a test; NaN is out of reach."""
    people, tissue = targets.people, targets.tissue
    if people is None:
        return PeopleShares(len(tissue.subjects), (), is_inferred(tissue), reason_of(tissue))
    rows = _rows(targets.conditions, people.peak_N, people.stated, np.asarray(peak_N, float))
    return PeopleShares(len(tissue.subjects), rows, is_inferred(tissue))


def _rows(
    conditions: Sequence[Condition], people: Population, stated: Population, peak_N: NDArray
) -> tuple[ShareBelow, ...]:
    expected, exact = people.expected_below(peak_N), stated.expected_below(peak_N)
    low, high = people.interval_below(peak_N)
    rows = []
    for at, one in enumerate(conditions):
        test = one.steady_force_N, one.velocity_mm_s
        span = float(low[at]), float(high[at])
        reached = np.isfinite(peak_N[at])
        rows.append(
            ShareBelow(*test, float(expected[at]), span, float(exact[at]))
            if reached
            else ShareBelow(*test, None, None, None)
        )
    return tuple(rows)


def is_inferred(tissue: Tissue) -> bool:
    """Whether a number of a subject is inferred."""
    return "inferred" in tissue.kinds


def bounds_of(targets: Targets) -> tuple[NDArray, NDArray, NDArray, str] | None:
    """Return the bound of an aim at a share of people; None for another aim.

    Returns
    -------
    peak_N, energy_mJ : ndarray, shape (c,)
        Above the share of people with 95 % confidence, in each press.
    depth_mm : ndarray, shape (g,)
        Below which that share is not, at the steady forces of the test.
    words : str
        What the bound is.
    """
    share = share_of_aim(targets.aim)
    if share is None:
        return None
    people = targets.people
    if people is None:
        reason = reason_of(targets.tissue)
        raise InputError(
            f"aim = '{targets.aim}': {reason}; use average, safe-side or a tissue of several people",
            "not_enough_data",
            "subjects",
            len(targets.tissue.subjects),
        )
    one, two, three = (each.bound(share) for each in (people.peak_N, people.energy_mJ, people.stiffness_per_mm))
    return one, two, 1.0 / three, f"the bound of {100 * share:g} % of people"


def people_warnings(targets: Targets) -> list[tuple[str, str]]:
    """Say how large the bound of a share of people is, and why; nothing for another aim."""
    if not is_share(targets.aim):
        return []
    bounds, people, share = targets.bounds, targets.people, share_of_aim(targets.aim)
    assert bounds is not None and people is not None and share is not None
    count = len(targets.tissue.subjects)
    highest = np.array([one.range.peak_high_N for one in targets.conditions])
    exact = float(np.max(people.stated.bound(share) / highest))
    factor = tolerance_factor(count, share)
    others = ", ".join(f"{tolerance_factor(n, share):.2f} with {n}" for n in ENOUGH if n > count)
    ratio = float(np.max(bounds[0] / highest))
    text = (
        f"peaks above {100 * share:g} % of people ({100 * CONFIDENCE:g} % confidence) are up to {ratio:.2f} times the "
        f"highest subject's: {factor:.2f} standard deviations above the mean of {count} subjects"
    )
    if factor > LARGE_FACTOR and others:
        text += f", a large number ({others})"
    if ratio > 1.02 * exact:
        text += f"; {exact:.2f} times if these subjects were measured ('dummydesign tissues add')"
    return [("people_bound", text)]
