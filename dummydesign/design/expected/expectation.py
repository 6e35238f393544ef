"""Among pads that the search does not tell apart, the one whose castings are expected to score most.

The best pad at central estimates may lie at the end of a range: half of its castings are then out of reach or too low.
Pads near in worth, and those one step of the mixing ratio away, are therefore compared over the castings of the answer:
the better light first, then the mean score over castings and tissues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import Castings, PadCastings, Tolerances
from dummydesign.design.expected.tissue_doubt import (
    TissueScores,
    castings_for_tissues,
    doubt_words,
    tissue_share,
    usable,
)
from dummydesign.design.scoring.acceptability import ACCEPTABLE, BORDERLINE, acceptability_rank, ranges_of, strict_aim
from dummydesign.design.scoring.deviations import classes, deviations
from dummydesign.design.scoring.law_parameters import rough_parametric
from dummydesign.design.scoring.presses import make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.search.best_of_kinds import Chosen, beside_of
from dummydesign.design.search.shapes import mixable
from dummydesign.design.search.slabs import Candidate, make_slabs, with_parameters

if TYPE_CHECKING:
    from dummydesign.design.search.space import SearchSpace

SURE = 2.0
"""Standard errors by which another pad has to be expected to score more."""


@dataclass(frozen=True)
class Expected:
    """One pad: its score at central estimates, mean and 5 % quantile over its castings, and how many are usable.

    ``acceptable_fraction`` is the share of the answer's castings that may be used, as they are or with a correction.
    ``tissue_share`` is the share of the variance of its score that is the tissue's; None where no tissue is drawn.
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
    """The choice by castings beside that at central estimates; ``differs`` when they are two pads.

    ``undecided`` says between which two kinds the relaxation of the resin decides; None where it does not.
    """

    text: str
    differs: bool
    taken: Expected
    middle: Expected
    undecided: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


def by_expectation(
    close: Sequence[Chosen], space: SearchSpace, castings: Castings, tolerances: Tolerances, low_share: float
) -> tuple[Chosen, Expectation]:
    """Take the pad of the best light, and of these the one with the largest expected score.

    Parameters
    ----------
    close : sequence of Chosen
        The best pad of the search, then the best of other kinds that are near in worth.
    space : SearchSpace
    castings : Castings
        Of the answer.
    tolerances : Tolerances
        Of weighing and thickness.
    low_share : float
        Share of small forces in the score.

    Returns
    -------
    Chosen
        The pad that is taken; the first of ``close`` where none is surely expected to score more.
    Expectation
    """
    pads = [(chosen, candidate) for chosen in close for candidate in _near(chosen, space, low_share)]
    cast = [PadCastings(castings, chosen.cast, candidate, space, tolerances) for chosen, candidate in pads]
    green = [_green(one) for one in cast]
    least = pads[0][1].rank
    if least == ACCEPTABLE and _tied(pads[0][1], space):
        least = BORDERLINE
    able = [at for at in range(len(pads)) if pads[at][1].rank >= least and green[at] >= max(green)]
    order = able if 0 in able else [0, *able]
    scores = {at: castings_for_tissues(cast[at], low_share) for at in order}
    best, as_known = _best_of([scores[at] for at in order])
    if 0 not in able and best == 0:
        # another pad has the better light: the best expected of those
        best = max(range(1, len(order)), key=lambda at: float(scores[order[at]].merit.mean()))
    taken = order[best]
    two = [_expected(*pads[at], cast[at], scores[at], low_share) for at in (taken, 0)]
    undecided = _undecided(taken, order, pads, cast, scores)
    chosen, candidate = pads[taken]
    if taken == 0:
        text = f"{two[0].words} is also the best over {doubt_words(space.targets)}"
        return chosen, Expectation(text, False, *two, undecided)
    over = "resin and casting" if as_known else doubt_words(space.targets)
    shares = f"{100 * two[0].acceptable_fraction:.0f} % against {100 * two[1].acceptable_fraction:.0f} %"
    text = (
        f"{two[0].words} beats {two[1].words} over {over}: score {two[0].expected_worth:.3f} against "
        f"{two[1].expected_worth:.3f}, {shares} of castings usable"
    )
    if candidate is not chosen.found.best:
        candidate = with_parameters([candidate], space)[0]
        beside = tuple(
            beside_of(chosen, candidate, space) if item.kind == chosen.shape.name else item for item in chosen.beside
        )
        chosen = replace(chosen, found=replace(chosen.found, best=candidate), beside=beside)
    return chosen, Expectation(text, True, *two, undecided)


def _tied(best: Candidate, space: SearchSpace) -> bool:
    """Whether a pad keeps a limit by less than the limits' tie: then the score decides over pads just beyond it."""
    one = best.evaluation
    return bool(acceptability_rank(one, space.targets, tighter=True)[best.index] < ACCEPTABLE)


def _green(cast: PadCastings) -> bool:
    """Whether enough castings stand for the subjects; within the limits' tie counts as kept."""
    targets = cast.space.targets
    limits = targets.limits
    near = replace(limits, stands_shortfall=limits.stands_shortfall * (1.0 + limits.tie),
                   stands_over=limits.stands_over * (1.0 + limits.tie))  # fmt: skip
    found = deviations(ranges_of(targets), cast.readings(), strict_aim(targets))
    kinds = classes(found, near, strict_aim(targets))
    return bool((kinds == 0).mean() >= limits.share)


def _undecided(
    taken: int, order: Sequence[int], pads: Sequence[tuple[Chosen, Candidate]], cast: Sequence[PadCastings],
    scores: dict[int, TissueScores],
) -> str | None:
    """Two kinds between which the relaxation decides: one is better where it is weak, the other where it is strong."""
    kind = pads[taken][0].shape.name
    for at in order:
        if pads[at][0].shape.name == kind:
            continue
        gain = (scores[taken].merit - scores[at].merit).mean(axis=0)
        strength = cast[taken].pours().first(len(gain)).beta.sum(axis=-1)
        if not strength.std() > 0.0:
            continue
        rank = np.argsort(np.argsort(strength))
        thirds = [gain[rank < len(gain) // 3], gain[rank >= len(gain) - len(gain) // 3]]
        sizes = [one.mean() / (one.std(ddof=1) / np.sqrt(len(one))) for one in thirds]
        if min(sizes) < -SURE and max(sizes) > SURE:
            other = pads[at][0].shape.name
            return f"cannot choose between the {kind} and the {other} pad until the resin's relaxation is measured"
    return None


def _near(chosen: Chosen, space: SearchSpace, low_share: float) -> list[Candidate]:
    """The best pad, and those of one step of the ratio either way that rank no lower."""
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
    ranks = acceptability_rank(found, space.targets)
    parametric = rough_parametric(slabs, space.targets, space.sampling)
    total = found.total(parametric)
    others = [
        Candidate(best.thickness_mm, float(ratio[at]), at, found, None, float(parametric[at]), float(total[at]),
                  int(ranks[at]))
        for at in range(len(steps))
        if found.feasible[at] and ranks[at] >= min(best.rank, BORDERLINE)
    ]  # fmt: skip
    return [best, *others]


def _best_of(drawn: Sequence[TissueScores]) -> tuple[int, bool]:
    """Which pad is surely expected to be worth more than the first, and whether for the tissue as it is known alone.

    Where the doubt about the tissue hides a difference, that for the tissue in the middle of what is known decides
    among the pads that are expected to be worth no less over all of it.
    """
    gains = [one.merit - drawn[0].merit for one in drawn]
    best = max(range(len(drawn)), key=lambda at: float(gains[at].mean()))
    if float(gains[best].mean()) > SURE * _error_of_mean(gains[best]):
        return best, False
    able = [at for at, gain in enumerate(gains) if gain.mean() >= 0.0]
    best = max(able, key=lambda at: float(drawn[at].merit_as_known.mean()))
    gain = (drawn[best].merit_as_known - drawn[0].merit_as_known)[None]
    return (best, True) if float(gain.mean()) > SURE * _error_of_mean(gain) else (0, False)


def _error_of_mean(values: NDArray) -> float:
    """Standard error of the mean of values (tissues, pours), drawn along each axis.

    Tissues drawn evenly over a posterior come in strata: what is left is how neighbours differ.
    """
    tissues, pours = values.shape
    of_pours = values.mean(axis=0).var() / pours
    of_tissues = 0.5 * np.mean(np.diff(values.mean(axis=1)) ** 2) / tissues if tissues > 1 else 0.0
    return float(np.sqrt(of_pours + of_tissues))


def _expected(
    chosen: Chosen, candidate: Candidate, cast: PadCastings, scores: TissueScores, low_share: float
) -> Expected:
    merit = scores.merit
    return Expected(
        chosen.shape.name, candidate.thickness_mm, candidate.ratio, candidate.merit(low_share), float(merit.mean()),
        float(np.quantile(merit, 0.05)), float(usable(cast.every, cast.space.targets).mean()), tissue_share(merit),
    )  # fmt: skip
