"""Why this pad: which term of the score decided, what the next best gives up, and what is known of neither."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.pour_yield import SEED as DRAWN
from dummydesign.design.assessment.pour_yield import Pours, Tolerances, draw_pours
from dummydesign.design.assessment.readings import poured_slabs
from dummydesign.design.expected.tissue_doubt import castings_for_tissues, doubt_words, tissue_share
from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.standing import ACCEPTABLE_AND_STEADY, standing
from dummydesign.design.search.best_of_kinds import Beside

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.search.space import SearchSpace

WORDS = {
    "aim": "closeness to the aim",
    "steady_state_range": "the steady range",
    "force_variation_range": "the range of force over time",
    "parametric": "the fitted parameters",
    "low_aim": "closeness to the aim below {low:g} N",
}
DRAWS, POURS, TELLS, SEED, NEAR = 60, 150, 0.005, 29, 10
LEAST_SPREAD = 0.1
"""Spread of ln E below which no puck is asked for."""
LEAST_FIT = 0.01
"""Share of the castings of the best two ratios below which a measured modulus would not help."""


@dataclass(frozen=True)
class Choice:
    """Why a pad was taken.

    Attributes
    ----------
    text : str
    next_best : str or None
        The best pad of another kind; None where there is no other.
    terms : dict
        What each term of the score adds to the difference of the two pads, before standing counts.
    decided_by : str or None
        The term that adds most, or ``standing`` where the next best has the better score.
    expected_total, total_low : float
        Mean and 5 % quantile of the total over what the castings of the pad may turn out as, with gamma1 for the
        parameters; what is not known of the tissue is in it where it can be drawn.
    tissue_share : float or None
        Share of the variance of that total that is the tissue's; None where no tissue is drawn.
    """

    text: str
    next_best: str | None
    terms: dict[str, float]
    decided_by: str | None
    expected_total: float
    total_low: float
    tissue_share: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


@dataclass(frozen=True)
class MeasureFirst:
    """What to do first when the resin's modulus is the largest unknown, and two pads to pour meanwhile.

    ``ratios`` are theirs, ``each_fraction`` and ``either_fraction`` the shares of what is not known for which each,
    or at least one, is fit.
    """

    text: str
    ratios: tuple[float, float]
    each_fraction: tuple[float, float]
    either_fraction: float

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


def explain(best: Candidate, kind: str, beside: tuple[Beside, ...], law: ForceLaw, space: SearchSpace,
            tolerances: Tolerances) -> Choice:  # fmt: skip
    """Compare the recommended pad with the best of another kind, or with its nearest alternative's kind.

    Parameters
    ----------
    best : Candidate
    kind : str
        Of its shape.
    beside : tuple of Beside
        The best pad of each kind.
    law : ForceLaw
        Of the recommended pad as cast.
    space : SearchSpace
    tolerances : Tolerances
        Of weighing and thickness.
    """
    totals = expected_totals(law, best, space, tolerances)
    expected, low = float(totals.mean()), float(np.quantile(totals, 0.05))
    over, share = doubt_words(space.targets), tissue_share(totals)
    doubt = f"over what is not known of {over} its total is {expected:.2f} (one in twenty below {low:.2f}"
    doubt += ")" if share is None else f"; {100 * share:.0f} % of that variance is the tissue's)"
    others = [item for item in beside if item.kind != kind and item.candidate is not None]
    if not others:
        return Choice(f"no other kind was compared; {doubt}", None, {}, None, expected, low, share)
    other = max(others, key=lambda item: item.candidate.worth())
    name = f"the {other.kind} pad ({other.candidate.thickness_mm:g} mm, ratio {other.candidate.ratio:g})"
    gains = terms(best, other.candidate)
    lowest = space.targets.protocol.forces_N[0]
    words = {term: text.format(low=lowest) for term, text in WORDS.items()}
    behind = other.candidate.standing < best.standing
    most = max(gains, key=lambda term: gains[term])
    lost = [words[term] for term, gain in gains.items() if gain < -TELLS]
    better = best.merit() >= other.candidate.merit()
    if behind and not better:
        decided, why = "standing", _standing_words(best.standing, other.candidate.standing)
        text = f"taken before {name}, which scores higher but {why}"
    else:
        decided = most
        text = f"decided by {words[most]} (+{gains[most]:.2f} of +{sum(gains.values()):.2f}) over the next best, {name}"
        if behind:
            text += f", which also {_standing_words(best.standing, other.candidate.standing)}"
    text += f"; it gives up {' and '.join(lost)}" if lost else "; it gives up nothing"
    return Choice(f"{text}; {doubt}", name, gains, decided, expected, low, share)


def terms(best: Candidate, other: Candidate) -> dict[str, float]:
    """What each term of the score adds to the merit of one design over another; they sum to the difference."""

    weights = best.evaluation.weights
    share = weights.low_aim

    def parts(one: Candidate) -> dict[str, float]:
        shares = {
            name: (1.0 - share) * weight * float(getattr(one.evaluation, name)[one.index])
            for name, weight in weights.parts.items()
            if name != "parametric"
        }
        # What the total says of the parameters, also where they were fitted to one and not to the other.
        if "parametric" in weights.parts:
            shares["parametric"] = (1.0 - share) * one.total - sum(shares.values())
        return {**shares, "low_aim": share * float(one.evaluation.low_aim[one.index])}

    mine, its = parts(best), parts(other)
    return {name: mine[name] - its[name] for name in mine}


def _standing_words(best: int, other: int) -> str:
    if other == 0:
        return "reads low or is out of reach"
    return "leaves the steady range" if other < best else "stands the same"


def expected_totals(law: ForceLaw, candidate: Candidate, space: SearchSpace, tolerances: Tolerances) -> NDArray:
    """Totals of castings of a design for the tissues that the data allow, shape (tissues, n).

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    candidate : Candidate
    space : SearchSpace
    tolerances : Tolerances
    """
    return castings_for_tissues(law, candidate, space, tolerances, DRAWS, DRAWN, 0.0).total


def measure_first(
    best: Candidate, law: ForceLaw, space: SearchSpace, tolerances: Tolerances
) -> MeasureFirst | None:
    """Say that a puck comes first, and find the two ratios to pour meanwhile; None where the resin is known well.

    Nothing is said either where no ratio near by makes a fit casting, whatever the modulus.

    A casting is fit where nothing of it is below every subject's and its steady depths lie among theirs, as a design
    has to be (:mod:`dummydesign.design.scoring.standing`). The modulus is the largest unknown where what is not known
    of the resin spreads it further than weighing does, and by more than a tenth.

    Parameters
    ----------
    best : Candidate
    law : ForceLaw
        Of the pad as cast.
    space : SearchSpace
    tolerances : Tolerances
        Of weighing and thickness.
    """
    resin = space.resin
    poured = draw_pours(resin, best.thickness_mm, best.ratio, tolerances, POURS)
    spread = [float(np.log(pours.young_MPa).var()) for pours in poured]
    if spread[0] < 2.0 * spread[1] or spread[0] < LEAST_SPREAD**2:
        return None
    every, making = (float(_fit(law, pours, space).mean()) for pours in poured)
    drawn = resin.draw(POURS, np.random.default_rng(SEED))
    here = int(np.argmin(np.abs(space.ratio - best.ratio)))
    ratios = space.ratio[max(here - NEAR, 0) : here + NEAR + 1]
    if len(ratios) < 2:
        return None
    at = np.repeat(ratios, POURS)
    beta = np.concatenate([drawn.beta(np.full(POURS, ratio)) for ratio in ratios])
    young = np.concatenate([drawn.young_MPa(np.full(POURS, ratio)) for ratio in ratios])
    pours = Pours(np.full(len(at), best.thickness_mm), np.maximum(young, 1e-9), beta)
    fit = _fit(law, pours, space).reshape(len(ratios), POURS)
    each = fit.mean(axis=1)
    either = (fit[:, None] | fit[None]).mean(axis=-1)
    np.fill_diagonal(either, -1.0)
    first, second = sorted(np.unravel_index(int(np.argmax(either)), either.shape))
    pair = float(ratios[first]), float(ratios[second])
    if either[first, second] < LEAST_FIT:
        # a measured modulus would not help: it is the pad that does not fit
        return None
    text = (
        f"measure a puck first: the resin's modulus is the largest unknown ({100 * every:.0f} % of castings are fit, "
        f"{100 * making:.0f} % if it were known); to pour meanwhile: this pad at ratio {pair[0]:g} and at ratio "
        f"{pair[1]:g}, of which one is fit in {100 * either[first, second]:.0f} %"
    )
    return MeasureFirst(text, pair, (float(each[first]), float(each[second])), float(either[first, second]))


def _fit(law: ForceLaw, pours: Pours, space: SearchSpace) -> NDArray:
    """Which pours stand as a design has to, shape (n,)."""
    found = evaluate(poured_slabs(law, pours, space), space.targets, space.sampling.coarse)
    return standing(found, space.targets) == ACCEPTABLE_AND_STEADY
