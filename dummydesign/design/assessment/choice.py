"""Why this pad: which term of the score decided, what the next best gives up, and the score with all uncertainties."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.assessment.castings import PadCastings
from dummydesign.design.expected.tissue_doubt import castings_for_tissues, tissue_share
from dummydesign.design.search.best_of_kinds import Beside

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate

WORDS = {
    "aim": "its closeness to the aim",
    "steady_state_range": "its steady forces",
    "force_variation_range": "its force over time",
    "parametric": "its fitted parameters",
    "low_aim": "its match below {low:g} N",
}
TELLS = 0.005


@dataclass(frozen=True)
class Choice:
    """Why a pad was taken.

    Attributes
    ----------
    text : str
    next_best : str or None
        The best pad of another kind; None where there is no other.
    terms : dict
        What each term of the score adds to the difference of the two pads.
    decided_by : str or None
        The term that adds most, or ``verdict`` where the next best is not representative.
    expected_total, total_low : float
        Mean and 5 % quantile of the total over castings and tissues.
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


def explain(cast: PadCastings, kind: str, beside: tuple[Beside, ...]) -> Choice:
    """Compare the recommended pad with the best of another kind.

    Parameters
    ----------
    cast : PadCastings
        Castings of the recommended pad.
    kind : str
        Of its shape.
    beside : tuple of Beside
        The best pad of each kind.
    """
    best, targets = cast.candidate, cast.space.targets
    totals = castings_for_tissues(cast, 0.0).total
    expected, low, share = float(totals.mean()), float(np.quantile(totals, 0.05)), tissue_share(totals)
    doubt = f"score with all uncertainties: {expected:.2f} (5 % below {low:.2f})"
    others = [item for item in beside if item.kind != kind and item.candidate is not None]
    if not others:
        return Choice(f"no other kind of shape was compared; {doubt}", None, {}, None, expected, low, share)
    other = max(others, key=lambda item: item.candidate.worth())
    name = f"the {other.kind} pad ({other.candidate.thickness_mm:g} mm, ratio {other.candidate.ratio:g})"
    gains = terms(best, other.candidate)
    words = {term: text.format(low=targets.protocol.forces_N[0]) for term, text in WORDS.items()}
    most = max(gains, key=lambda term: gains[term])
    lost = [words[term] for term, gain in gains.items() if gain < -TELLS]
    if other.candidate.rank < best.rank:
        decided, text = "verdict", f"{name} comes next and is not representative"
    else:
        decided = most
        text = f"chosen over {name} mainly for {words[most]} (+{gains[most]:.2f} of {sum(gains.values()):+.2f})"
        text += f"; weaker in {' and '.join(lost)}" if lost else ""
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
