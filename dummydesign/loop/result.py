"""What the loop found, and the JSON of ``loop``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.screening import Screened
from dummydesign.loop.judging.acceptance import Found
from dummydesign.loop.judging.assessed import Stage, effect_intervals
from dummydesign.loop.judging.lack_of_fit import lack_of_fit
from dummydesign.loop.judging.residual_checks import Check
from dummydesign.loop.judging.residual_dependence import Dependence
from dummydesign.loop.judging.verdict import Remainder, gain_threshold
from dummydesign.loop.learned.learn import Learnt
from dummydesign.loop.next_measurement import NextMeasurement
from dummydesign.loop.prior import Joined
from dummydesign.measurement.campaign import Campaign


@dataclass(frozen=True)
class LoopResult:
    """All that the loop found.

    Attributes
    ----------
    campaign, presses
    base, after : Stage
        Without and with the accepted effects; the same when there are none.
    verdict : str
        ``effect``, ``none`` or ``unexplained``.
    effects : tuple of Found
    screened : tuple of Screened
        Scores of all effects at the base.
    ranking : tuple of Candidate
        Joint fits at the base, best first.
    remainder : Remainder
    where, where_after : tuple of Dependence
        What the residual of the base and of the corrected model depends on.
    checks : tuple of Check
        Of the corrected model.
    next : NextMeasurement or None
    untested : dict
        Effects that this campaign cannot test, with the reason.
    warnings : tuple of dict
    learnt : Learnt or None
        What the remainder of the named effects was learned to be; it is in ``after``.
    joined : Joined or None
        How the prior met the data, if one was given.
    """

    campaign: Campaign
    presses: Presses
    base: Stage
    after: Stage
    verdict: str
    effects: tuple[Found, ...]
    screened: tuple[Screened, ...]
    ranking: tuple[Candidate, ...]
    remainder: Remainder
    where: tuple[Dependence, ...]
    where_after: tuple[Dependence, ...]
    checks: tuple[Check, ...]
    next: NextMeasurement | None
    untested: dict[str, str]
    warnings: tuple[dict[str, str], ...]
    learnt: Learnt | None = None
    joined: Joined | None = None


def result_dict(result: LoopResult) -> dict[str, Any]:
    """Return the result in the form of the ``loop`` contract."""
    trials = result.presses.trials
    rows = zip(
        trials, result.base.errors.by_trial_N, result.after.errors.by_trial_N, result.after.errors.heldout_by_trial_N
    )
    return {
        "base": result.base.to_dict(),
        "verdict": result.verdict,
        "effects": [_effect(found, result) for found in result.effects],
        "after": result.after.to_dict(),
        "residual": {
            "where": [one.to_dict() for one in result.where],
            "where_after": [one.to_dict() for one in result.where_after],
            "unexplained_because": list(result.remainder.reasons),
            "heldout_over_noise_floor": result.remainder.over_floor,
            "expected_over_noise_floor": result.remainder.expected,
            "checks": [check.to_dict() for check in result.checks],
            "by_trial": [
                {
                    "file": trial.file, "thickness_mm": trial.thickness_mm, "velocity_mm_s": trial.velocity_mm_s,
                    "base_rmse_N": float(base), "rmse_N": float(after),
                    "heldout_rmse_N": float(left) if np.isfinite(left) else None,
                }
                for trial, base, after, left in rows
            ],
        },
        "threshold": _threshold(result),
        "ranking": [{"name": c.effect.name, "evidence": c.gain} for c in result.ranking],
        "screening": [{"name": one.effect.name, "z": one.z} for one in result.screened],
        "learned": None if result.learnt is None else result.learnt.to_dict(),
        "untested": result.untested,
        "prior": None if result.joined is None else result.joined.to_dict(),
        "next_measurement": None if result.next is None else result.next.to_dict(),
        "warnings": list(result.warnings),
        "sources": sorted({found.candidate.effect.reference for found in result.effects}),
    }  # fmt: skip


def _threshold(result: LoopResult) -> float:
    """Evidence that a first effect needs in this campaign."""
    ratio = lack_of_fit(result.ranking[0].fit).ratio if result.ranking else None
    return gain_threshold(list(result.screened), ratio)


def _effect(found: Found, result: LoopResult) -> dict[str, Any]:
    effect = found.candidate.effect
    return {
        "name": effect.name,
        "class": type(effect).__name__,
        "stage": effect.hook,
        "parameters": effect_intervals(result.after, effect),
        "heldout_rmse_N": found.heldout_N,
        "evidence": found.candidate.gain,
        "evidence_meaning": "drop of minus twice the log likelihood against the model without it",
        "threshold": found.threshold,
        "confounded_with": list(found.confounded_with),
        "family": list(found.family),
    }
