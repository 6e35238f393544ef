"""Among pads that the search does not tell apart, the one that is expected to be worth most once it is poured.

The best pad in the middle of what is known may stand at the end of a range: half of its castings then read low. Pads
within the search's resolution of it, one step of the mixing ratio or a difference in worth that finite elements make,
are therefore compared by their mean worth over the same draws of resin, weighing, thickness and tissue.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.pour_yield import Tolerances
from dummydesign.design.expected.tissue_doubt import Castings, castings_for_tissues, doubt_words, tissue_share
from dummydesign.design.scoring.law_parameters import rough_parametric
from dummydesign.design.scoring.presses import make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.standing import standing
from dummydesign.design.search.best_of_kinds import Chosen, beside_of
from dummydesign.design.search.shapes import mixable
from dummydesign.design.search.slabs import Candidate, make_slabs, with_parameters

if TYPE_CHECKING:
    from dummydesign.design.search.space import SearchSpace

POURS, SEED = 100, 31
SURE = 2.0
"""Standard errors by which another pad has to be expected to be worth more."""


@dataclass(frozen=True)
class Expected:
    """One pad: its worth in the middle, mean and 5 % quantile over its castings, and how many are acceptable.

    ``tissue_share`` is the share of the variance of its worth that is the tissue's; None where no tissue is drawn.
    """

    kind: str
    thickness_mm: float
    ratio: float
    worth: float
    expected_worth: float
    low_worth: float
    acceptable_fraction: float
    tissue_share: float | None

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
    drawn = [
        castings_for_tissues(chosen.cast, candidate, space, tolerances, POURS, SEED, low_share)
        for chosen, candidate in pads
    ]
    best, as_known = _best_of(drawn)
    told = [_expected(*pads[at], drawn[at], low_share) for at in (best, 0)]
    over = doubt_words(space.targets)
    of = "castings and tissues" if drawn[0].tissue_drawn else "castings"
    chosen, candidate = pads[best]
    if best == 0:
        text = f"{told[0].words} is also the best by what is expected over {over}"
        return chosen, Expectation(text, False, *told)
    by = "resin and casting, as the tissue's own doubt does not tell them apart" if as_known else over
    text = (
        f"{told[0].words}, is taken by what is expected over {by} (worth {told[0].expected_worth:.2f}, "
        f"{100 * told[0].acceptable_fraction:.0f} % of {of} acceptable); the best in the middle is {told[1].words} "
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


def _best_of(drawn: Sequence[Castings]) -> tuple[int, bool]:
    """Which pad is surely expected to be worth more than the first, and whether for the tissue as it is known alone.

    Where the doubt about the tissue hides a difference, that for the tissue in the middle of what is known decides
    among the pads that are expected to be worth no less over all of it.
    """
    gains = [one.worth - drawn[0].worth for one in drawn]
    best = max(range(len(drawn)), key=lambda at: float(gains[at].mean()))
    if float(gains[best].mean()) > SURE * _error_of_mean(gains[best]):
        return best, False
    able = [at for at, gain in enumerate(gains) if gain.mean() >= 0.0]
    best = max(able, key=lambda at: float(drawn[at].worth_as_known.mean()))
    gain = (drawn[best].worth_as_known - drawn[0].worth_as_known)[None]
    return (best, True) if float(gain.mean()) > SURE * _error_of_mean(gain) else (0, False)


def _error_of_mean(values: NDArray) -> float:
    """Standard error of the mean of values (tissues, pours), drawn along each axis.

    Tissues drawn evenly over a posterior come in strata: what is left is how neighbours differ.
    """
    tissues, pours = values.shape
    of_pours = values.mean(axis=0).var() / pours
    of_tissues = 0.5 * np.mean(np.diff(values.mean(axis=1)) ** 2) / tissues if tissues > 1 else 0.0
    return float(np.sqrt(of_pours + of_tissues))


def _expected(chosen: Chosen, candidate: Candidate, castings: Castings, low_share: float) -> Expected:
    worth = castings.worth
    return Expected(
        chosen.shape.name, candidate.thickness_mm, candidate.ratio, candidate.worth(low_share), float(worth.mean()),
        float(np.quantile(worth, 0.05)), float(castings.acceptable.mean()), tissue_share(worth),
    )  # fmt: skip
