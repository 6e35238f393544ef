"""Castings of a pad scored for the tissues that the data allow, and how much of the doubt is the tissue's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.pour_yield import Tolerances, draw_pours
from dummydesign.design.assessment.readings import poured_slabs
from dummydesign.design.scoring.law_parameters import gamma1_score
from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.scoring.score import evaluate, evaluated_gamma1, scored_for
from dummydesign.design.scoring.standing import NOT_ACCEPTABLE, standing
from dummydesign.design.scoring.targets import Targets

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.search.space import SearchSpace


@dataclass(frozen=True)
class Castings:
    """Castings of one pad, scored for each tissue that is drawn, or for the one that is known where none is.

    Attributes
    ----------
    total, worth : ndarray, shape (tissues, pours)
        The score's total, and what the pad is worth with its standing.
    acceptable : ndarray of bool, shape (tissues, pours)
    worth_as_known : ndarray, shape (pours,)
        The worth for the tissue in the middle of what is known of it.
    """

    total: NDArray
    worth: NDArray
    acceptable: NDArray
    worth_as_known: NDArray

    @property
    def tissue_drawn(self) -> bool:
        """Whether what is not known of the tissue is in the numbers."""
        return len(self.total) > 1


def castings_for_tissues(
    law: ForceLaw, candidate: Candidate, space: SearchSpace, tolerances: Tolerances, pours: int, seed: int,
    low_share: float,
) -> Castings:  # fmt: skip
    """Press castings of a pad once and score them for every tissue that is drawn; parameters are those of gamma1.

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    candidate : Candidate
    space : SearchSpace
    tolerances : Tolerances
        Of weighing and thickness.
    pours, seed : int
        How many castings are drawn, and which.
    low_share : float
        Share of small forces in the merit.
    """
    drawn, _ = draw_pours(space.resin, candidate.thickness_mm, candidate.ratio, tolerances, pours, seed)
    slabs = poured_slabs(law, drawn, space)
    pressed = evaluate(slabs, space.targets, space.sampling.coarse)
    gamma1 = evaluated_gamma1(pressed, space.targets.power)
    rows = []
    for targets in (space.targets, *space.targets.drawn):
        found = pressed if targets is space.targets else scored_for(pressed, targets)
        total = found.total(gamma1_score(gamma1, targets))
        stands = standing(found, targets)
        merit = (1.0 - low_share) * total + low_share * found.low_aim
        rows.append((total, np.array(targets.weights.worth)[stands] * merit, stands > NOT_ACCEPTABLE))
    kept = rows[1:] or rows
    return Castings(*(np.array(values) for values in zip(*kept)), rows[0][1])


def tissue_share(values: NDArray) -> float | None:
    """Share of the variance of values (tissues, pours) that is the tissue's: that of its means over the pours.

    None where no tissue was drawn. What few pours leave in the means of the tissues is taken off.

    Parameters
    ----------
    values : ndarray, shape (tissues, pours)
    """
    tissues, pours = values.shape
    whole = float(values.var())
    if tissues < 2 or whole <= 0.0:
        return None
    rows, columns = values.mean(axis=1, keepdims=True), values.mean(axis=0, keepdims=True)
    left = values - rows - columns + values.mean()
    rest = float((left**2).sum() / ((tissues - 1) * (pours - 1)))
    return float(np.clip((rows.var(ddof=1) - rest / pours) / whole, 0.0, 1.0))


def doubt_words(targets: Targets) -> str:
    """Over what an expectation is taken."""
    return "resin, casting and tissue" if targets.drawn else "resin and casting"
