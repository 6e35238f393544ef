"""From candidates to a verdict: effect, none or unexplained; thresholds, families, rivals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.screening import Screened
from dummydesign.loop.judging.lack_of_fit import LackOfFit
from dummydesign.loop.judging.residual_checks import Check
from dummydesign.loop.judging.residual_dependence import Dependence

GAIN_FLOOR = 30.0
SECOND_FLOOR, SECOND_SHARE = 50.0, 0.05
"""A second effect must gain this much, and this share of the first one's gain: the first one's law of growth is
never quite the true one, and what it leaves must not be called an effect."""
RIVAL_GAP = 10.0
FAMILY_COSINE = 0.9
LACK_LIMIT = 1.5
LACK_P = 0.01
PROBE_LIMIT = 60.0
EXPLAINED = 5.0 / 6.0
DRAWS = 4000


def gain_threshold(screened: list[Screened], ratio: float | None, floor: float = GAIN_FLOOR) -> float:
    """Gain that an effect must beat: 99.9 % of the largest of all scores under noise, and not below ``floor``.

    The scores of all candidates are drawn with the correlations of their signatures. Noise models are never
    quite right, so the limit also grows with the lack of fit that the best candidate leaves.
    """
    if not screened:
        return floor
    signatures = np.stack([one.signature for one in screened], axis=1)
    correlation = signatures.T @ signatures
    root = np.linalg.cholesky(correlation + 1e-9 * np.eye(len(correlation)))
    draws = root @ np.random.default_rng(0).normal(size=(len(correlation), DRAWS))
    limit = float(np.quantile((draws**2).max(axis=0), 0.999))
    return max(limit, floor) * max(1.0, ratio or 1.0)


def family_of(one: Screened, others: list[Screened]) -> list[str]:
    """Names of effects whose signature is nearly parallel: they cannot be told apart by this campaign."""
    return [
        other.effect.name
        for other in others
        if other.effect.name != one.effect.name and abs(float(one.signature @ other.signature)) > FAMILY_COSINE
    ]


def rivals(candidates: list[Candidate], first: Candidate, ratio: float | None) -> list[Candidate]:
    """Candidates that explain the data as well as ``first``, or nearly, likeliest first."""
    gap = RIVAL_GAP * max(1.0, ratio or 1.0)
    return [c for c in candidates if c is not first and first.gain - c.gain < gap]


@dataclass(frozen=True)
class Remainder:
    """Why a model is held to be incomplete; empty reasons when it is not."""

    reasons: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the reasons."""
        return {"reasons": list(self.reasons)}


def remainder(
    base: LackOfFit, best: LackOfFit, won: float, where: list[Dependence], checks: list[Check]
) -> Remainder:
    """Judge what is left after the best model.

    Parameters
    ----------
    base, best : LackOfFit
        Of the base model and of the model with the accepted effects (the same when there are none).
    won : float
        Evidence of the accepted effects together.
    where, checks : list
        Of the best model.
    """
    reasons = [f"{check.name}: {check.text}" for check in checks if check.exceeded]
    if best.ratio is not None and best.ratio > LACK_LIMIT and best.p < LACK_P:
        explained = 1.0 - (best.ratio - 1.0) / max(base.ratio - 1.0, 1e-9)
        if explained < EXPLAINED:
            reasons.append(f"lack of fit {best.ratio:.2f} times the pure error of repeats (p = {best.p:.4f})")
    # a law of growth that is a little off is allowed for
    scale = max(1.0, best.ratio or 1.0)
    for one in where:
        if one.excess > PROBE_LIMIT * scale and one.excess > (1.0 - EXPLAINED) * won:
            reasons.append(f"residual follows {one.factor} ({one.excess:.0f} in chi2 beyond noise)")
            break
    return Remainder(tuple(reasons))
