"""Joint refit of the base with each promising effect, and their ranking."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.loop.fitting.fit import BASE, Fit, fit, settle
from dummydesign.loop.fitting.noise import Sizes
from dummydesign.loop.fitting.screening import Screened, extended, screen
from dummydesign.loop.model.effect import Effect

LEAST_Z, ALWAYS = 2.0, 4
"""Score below which an effect is not fitted, and how many are fitted all the same."""
KEEP = 10
"""Effects that are fitted after the screening."""
USUAL_POSITION_MM = 0.02
"""Contact scatter of a usual robot."""
SETTLE = 7
"""Effects for which contact scatter and law error are estimated anew."""


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


def first_fit(found: Fit, one: Screened) -> Fit:
    """Fit an effect beside what ``found`` holds, from where it scored best, sizes as they are."""
    problem, null = extended(found, one.effect)
    at = found.problem.fixed
    # to first order a large effect is overestimated
    first = float(np.clip(one.coordinate, -8.0, 8.0))
    tried = []
    for logs in one.effect.base_starts(null[:BASE]):
        vector = null.copy()
        vector[:BASE] = logs
        vector[at : at + len(one.start)] = one.start
        vector[at] = first if abs(first) > 0.05 else 0.3 * float(one.start[0])
        tried.append(fit(problem, vector, found.sizes, 16))
    return min(tried, key=lambda trial: trial.chi2)


def modest(found: Fit) -> Fit:
    """The same model refitted with law error and contact scatter of usual size.

    Where an effect is missing, both have grown to imitate it; screened at that size, and fitted from there,
    the effect would not be seen.
    """
    usual = [prior[0] for prior in found.problem.law.error_priors]
    position = min(found.sizes.noise.position_mm, USUAL_POSITION_MM)
    noise = replace(found.sizes.noise, position_mm=position)
    return fit(found.problem, found.vector, Sizes(noise, *(min(a, b) for a, b in zip(found.sizes.law, usual))), 6)


def rank(
    found: Fit,
    effects: tuple[Effect, ...],
    progress: Callable[[str], None] | None = None,
    keep: int = KEEP,
    least_z: float = LEAST_Z,
    refitted: int = SETTLE,
    always: bool = True,
) -> tuple[list[Screened], list[Candidate]]:
    """Screen all effects and refit the best; both lists best first.

    The refit re-estimates contact scatter and law error for every effect that its first fit leaves in the
    race, because what an effect explains the law error need not.

    Parameters
    ----------
    found : Fit
        The model that each effect joins.
    effects : tuple of Effect
        Those that may join it.
    progress : callable, optional
        Called with the name of each effect that is fitted.
    keep, least_z : int, float
        Effects fitted, and the score from which on.
    refitted : int
        How many of them with contact scatter and law error estimated anew.
    always : bool
        Whether a few are fitted whatever their score.
    """
    usual = modest(found)
    screened = screen(usual, effects)
    tried = []
    chosen = screened[:keep] + [one for one in screened[keep:] if always and one.effect.always_fitted]
    for place, one in enumerate(chosen):
        if abs(one.z) < least_z and not (always and (place < ALWAYS or one.effect.always_fitted)):
            continue
        if progress is not None:
            progress(one.effect.name)
        tried.append((one, first_fit(usual, one)))
    tried.sort(key=lambda pair: pair[1].chi2)
    candidates = []
    largest = usual.chi2 - tried[0][1].chi2 if tried else 0.0
    for one, trial in tried[:refitted]:
        if usual.chi2 - trial.chi2 < max(1.0, 0.01 * largest) and candidates:
            continue
        settled = settle(trial.problem, trial.vector, trial.sizes, 2, 8)
        candidates.append(Candidate(one.effect, settled, found.score - settled.score, one))
    return screened, sorted(candidates, key=lambda c: -c.gain)
