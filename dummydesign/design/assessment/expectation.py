"""Among pads that the search does not tell apart, the one that is expected to be worth most once it is poured.

The best pad in the middle of what is known may stand at the end of a range: half of its castings then read low. Pads
within the search's resolution of it, one step of the mixing ratio or a difference in worth that finite elements make,
are therefore compared by their mean worth over the same draws of resin, weighing and thickness.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.pour_yield import Tolerances
from dummydesign.design.assessment.readings import castings_of
from dummydesign.design.scoring.law_parameters import rough_parametric
from dummydesign.design.scoring.presses import ForceLaw, make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.standing import NOT_ACCEPTABLE, standing
from dummydesign.design.search.best_of_kinds import Chosen, beside_of
from dummydesign.design.search.shapes import mixable
from dummydesign.design.search.slabs import Candidate, make_slabs, with_parameters

if TYPE_CHECKING:
    from dummydesign.design.search.space import SearchSpace

POURS, SEED = 300, 31
SURE = 2.0
"""Standard errors by which another pad has to be expected to be worth more."""


@dataclass(frozen=True)
class Expected:
    """One pad: its worth in the middle, mean and 5 % quantile over its castings, and how many are acceptable."""

    kind: str
    thickness_mm: float
    ratio: float
    worth: float
    expected_worth: float
    low_worth: float
    acceptable_fraction: float

    @property
    def words(self) -> str:
        """The pad: kind, thickness and ratio."""
        return f"the {self.kind} pad of {self.thickness_mm:g} mm, ratio {self.ratio:g}"


@dataclass(frozen=True)
class Expectation:
    """The choice by expectation beside that by the middle; ``differs`` when they are two pads."""

    text: str
    differs: bool
    taken: Expected
    middle: Expected

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


def by_expectation(
    close: Sequence[Chosen], space: SearchSpace, tolerances: Tolerances, low_share: float
) -> tuple[Chosen, Expectation]:
    """Take the pad with the largest expected worth of those that the search does not tell apart.

    Parameters
    ----------
    close : sequence of Chosen
        The best pad in the middle, then the best of other kinds whose worth is within the resolution of its.
    space : SearchSpace
    tolerances : Tolerances
        Of weighing and thickness.
    low_share : float
        Share of small forces in the merit.

    Returns
    -------
    Chosen
        The pad that is taken; the first of ``close`` where none is surely expected to be worth more.
    Expectation
    """
    pads = [(chosen, candidate) for chosen in close for candidate in _near(chosen, space, low_share)]
    drawn = [_worths(chosen.cast, candidate, space, tolerances, low_share) for chosen, candidate in pads]
    best = max(range(len(pads)), key=lambda at: float(drawn[at][0].mean()))
    gain = drawn[best][0] - drawn[0][0]
    if float(gain.mean()) <= SURE * float(gain.std()) / np.sqrt(len(gain)):
        best = 0
    told = [_expected(*pads[at], *drawn[at], low_share) for at in (best, 0)]
    chosen, candidate = pads[best]
    if best == 0:
        text = f"{told[0].words} is also the best by what is expected over resin and casting"
        return chosen, Expectation(text, False, *told)
    text = (
        f"{told[0].words}, is taken by what is expected over resin and casting (worth {told[0].expected_worth:.2f}, "
        f"{100 * told[0].acceptable_fraction:.0f} % of castings acceptable); the best in the middle is {told[1].words} "
        f"({told[1].expected_worth:.2f}, {100 * told[1].acceptable_fraction:.0f} %)"
    )
    if candidate is not chosen.found.best:
        candidate = with_parameters([candidate], space)[0]
        beside = tuple(
            beside_of(chosen, candidate, space) if item.kind == chosen.shape.name else item for item in chosen.beside
        )
        chosen = replace(chosen, found=replace(chosen.found, best=candidate), beside=beside)
    return chosen, Expectation(text, True, *told)


def _near(chosen: Chosen, space: SearchSpace, low_share: float) -> list[Candidate]:
    """The best pad, and those of one step of the ratio either way that stand no worse."""
    best = chosen.found.best
    here = int(np.argmin(np.abs(space.ratio - best.ratio)))
    steps = [
        at
        for at in (here - 1, here + 1)
        if 0 <= at < len(space.ratio) and mixable(chosen.shape, float(space.ratio[at]), space.resin)
    ]
    if not steps:
        return [best]
    ratio = space.ratio[steps]
    curves = make_curves(chosen.cast, np.array([best.thickness_mm]), space.radius_mm)
    slabs = make_slabs(curves, np.zeros(len(steps), int), space.resin, ratio)
    found = evaluate(slabs, space.targets, space.sampling, exact=True)
    stands = standing(found, space.targets)
    parametric = rough_parametric(slabs, space.targets, space.sampling)
    total = found.total(parametric)
    others = [
        Candidate(best.thickness_mm, float(ratio[at]), at, found, None, float(parametric[at]), float(total[at]),
                  int(stands[at]))
        for at in range(len(steps))
        if found.feasible[at]
    ]  # fmt: skip
    return [best, *(one for one in others if one.standing >= best.standing)]


def _worths(
    law: ForceLaw, candidate: Candidate, space: SearchSpace, tolerances: Tolerances, low_share: float
) -> tuple[NDArray, NDArray]:
    """Worth of castings of a pad, and whether each is acceptable, shapes (n,)."""
    found, total = castings_of(law, candidate, space, tolerances, POURS, SEED)
    stands = standing(found, space.targets)
    merit = (1.0 - low_share) * total + low_share * found.low_aim
    return np.array(space.targets.weights.worth)[stands] * merit, stands > NOT_ACCEPTABLE


def _expected(chosen: Chosen, candidate: Candidate, worth: NDArray, able: NDArray, low_share: float) -> Expected:
    return Expected(
        chosen.shape.name, candidate.thickness_mm, candidate.ratio, candidate.worth(low_share), float(worth.mean()),
        float(np.quantile(worth, 0.05)), float(able.mean()),
    )  # fmt: skip
