"""Joint refit of the base with each promising effect, and their ranking."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.loop.effects.base import Effect
from dummydesign.loop.fit import Fit, fit, settle
from dummydesign.loop.screen import Screened, extended, screen, starts_of

KEEP = 12
"""Effects that are refitted after the screening."""


@dataclass(frozen=True)
class Candidate:
    """An effect fitted jointly with the base.

    Attributes
    ----------
    effect : Effect
    fit : Fit
    gain : float
        Drop of minus twice the log likelihood against the model without it.
    screened : Screened
    """

    effect: Effect
    fit: Fit
    gain: float
    screened: Screened


def refit(found: Fit, one: Screened) -> Candidate:
    """Fit an effect beside what ``found`` holds, from several starts, sizes re-estimated for it.

    Effects can hide in an inflated law error, so the prior sizes also start from their medians.
    """
    problem, null = extended(found, one.effect)
    at = found.problem.fixed
    best: Fit | None = None
    first = float(np.clip(one.coordinate, -30.0, 30.0))
    for start in starts_of(one.effect):
        vector = null.copy()
        vector[at : at + len(start)] = start
        size = first if abs(first) > 0.05 else 0.3 * float(start[0])
        vector[at] = size
        trial = fit(problem, vector, found.sizes, 6)
        if best is None or trial.chi2 < best.chi2:
            best = trial
    settled = settle(problem, best.vector, best.sizes, 2, 8)
    return Candidate(one.effect, settled, found.score - settled.score, one)


def rank(
    found: Fit, effects: tuple[Effect, ...], progress: Callable[[str], None] | None = None, keep: int = KEEP
) -> tuple[list[Screened], list[Candidate]]:
    """Screen all effects and refit the best; both lists best first."""
    screened = screen(found, effects)
    candidates = []
    for one in screened[:keep]:
        if progress is not None:
            progress(one.effect.name)
        candidates.append(refit(found, one))
    return screened, sorted(candidates, key=lambda c: -c.gain)
