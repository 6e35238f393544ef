"""Castings of a pad scored for the tissues that the data allow, and how much of the doubt is the tissue's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import PadCastings
from dummydesign.design.scoring.acceptability import ranges_of, readings_of, strict_aim
from dummydesign.design.scoring.deviations import CLASSES, USABLE, classes, deviations
from dummydesign.design.scoring.law_parameters import gamma1_score
from dummydesign.design.scoring.score import Evaluation, evaluate, evaluated_gamma1, scored_for

if TYPE_CHECKING:
    from dummydesign.design.scoring.targets import Targets

POURS = 120
"""Castings, the first of an answer's, that are scored for every tissue."""


@dataclass(frozen=True)
class TissueScores:
    """Castings of one pad, scored for each tissue that is drawn, or for the one that is known where none is.

    Attributes
    ----------
    total, merit : ndarray, shape (tissues, pours)
        The score's total, and that with its share of small forces.
    usable : ndarray of bool, shape (tissues, pours)
        Whether the casting may be used, as it is or with a correction.
    merit_as_known : ndarray, shape (pours,)
        The merit for the tissue at central estimates.
    """

    total: NDArray
    merit: NDArray
    usable: NDArray
    merit_as_known: NDArray

    @property
    def tissue_drawn(self) -> bool:
        """Whether what is not known of the tissue is in the numbers."""
        return len(self.total) > 1


def castings_for_tissues(cast: PadCastings, low_share: float, pours: int = POURS, worst: int = 1) -> TissueScores:
    """Score castings of a pad for every tissue that is drawn; parameters are those of gamma1.

    Parameters
    ----------
    cast : PadCastings
    low_share : float
        Share of small forces in the merit.
    pours : int
        How many of the castings, the first ones.
    worst : int
        The last class that counts as usable, a place in :data:`~dummydesign.design.scoring.deviations.CLASSES`.
    """
    total, low_aim, kinds = _by_tissue(cast, pours)
    merit = (1.0 - low_share) * total + low_share * low_aim
    kept = slice(1, None) if len(total) > 1 else slice(None)
    return TissueScores(total[kept], merit[kept], (kinds <= worst)[kept], merit[0])


def _by_tissue(cast: PadCastings, pours: int) -> tuple[NDArray, NDArray, NDArray]:
    """Total, closeness below the lowest force and class of the first castings: the tissue as stated, then each drawn.

    Shapes (1 + tissues, castings). They are kept with the castings: several parts of an answer rest on them.
    """
    if pours not in cast.over_tissues:
        space = cast.space
        pressed = evaluate(cast.slabs(cast.pours().first(pours)), space.targets, space.sampling.coarse)
        gamma1 = evaluated_gamma1(pressed, space.targets.power)
        rows = []
        for targets in (space.targets, *space.targets.drawn):
            found = pressed if targets is space.targets else scored_for(pressed, targets)
            rows.append((found.total(gamma1_score(gamma1, targets)), found.low_aim, kinds_of(found, targets)))
        cast.over_tissues[pours] = tuple(np.array(values) for values in zip(*rows))
    return cast.over_tissues[pours]


def kinds_of(found: Evaluation, targets: Targets) -> NDArray:
    """Class of each pad for a tissue, shape (n,), as places in ``CLASSES`` of the deviations."""
    strict = strict_aim(targets)
    return classes(deviations(ranges_of(targets), readings_of(found), strict), targets.limits, strict)


def usable(found: Evaluation, targets: Targets) -> NDArray:
    """Whether pads may be used for a tissue, as they are or with a correction, shape (n,)."""
    return np.asarray(kinds_of(found, targets) <= CLASSES.index(USABLE))


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
