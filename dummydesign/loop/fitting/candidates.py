"""Joint refit of the base with each promising effect, and their ranking."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.loop.fitting.fit import Fit, fit, settle, with_sizes
from dummydesign.loop.fitting.noise import Sizes
from dummydesign.loop.fitting.problem import BASE
from dummydesign.loop.fitting.screening import Screened, extended, screen
from dummydesign.loop.model.effect import Effect

KEEP, LEAST_Z = 7, 2.0
"""Effects that are fitted after the screening, and the score from which on."""
ROUGH = 0.5
"""Gain in chi-square at which a first fit ends: what is compared are tens."""
USUAL_POSITION_MM = 0.02
"""Contact scatter of a usual robot."""
SETTLED, NEAR, SHARE = 3, 40.0, 0.3
"""Effects that are fitted again with contact scatter and law error of their own: how many at least, and all whose
first fit is so near the best, if they have this share of its evidence."""

HOPE, HOPELESS, FEWEST = (2.0, 20.0), 0.1, 3
"""How many times its squared score an effect of one parameter, or of several, gains at most; one that would still have
less than this share of the best gain so far cannot win and is not fitted, when so many were."""


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
    """Fit an effect beside what ``found`` holds, from where it scored best, sizes as they are.

    The score is that with contact scatter and law error of its own, the fit moved there to first order.
    """
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
        tried.append(fit(problem, vector, found.sizes, 16, ROUGH))
    return with_sizes(min(tried, key=lambda trial: trial.chi2))


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
    found: Fit, effects: tuple[Effect, ...], progress: Callable[[str], None] | None = None
) -> tuple[list[Screened], list[Candidate]]:
    """Screen all effects and refit the best beside what ``found`` holds; both lists best first.

    Contact scatter and law error are estimated anew for every effect, because what an effect explains the law error
    need not.

    Parameters
    ----------
    found : Fit
        The model that each effect joins.
    effects : tuple of Effect
        Those that may join it.
    progress : callable, optional
        Called with the name of each effect that is fitted.
    """
    screened, tried = first_fits(found, effects, KEEP, LEAST_Z, progress)
    return screened, to_the_end(found, tried)


def first_fits(
    found: Fit,
    effects: tuple[Effect, ...],
    keep: int,
    least_z: float,
    progress: Callable[[str], None] | None = None,
    least_gain: float = 0.0,
) -> tuple[list[Screened], list[Candidate]]:
    """Screen all effects and fit the best once; scores best first, fits in that order.

    Parameters
    ----------
    found : Fit
        The model that each effect joins.
    effects : tuple of Effect
        Those that may join it.
    keep, least_z : int, float
        Effects fitted, and the score from which on.
    progress : callable, optional
        Called with the name of each effect that is fitted.
    least_gain : float
        What an effect must be able to gain.
    """
    usual = modest(found)
    screened = screen(usual, effects)
    chosen = [one for place, one in enumerate(screened) if place < keep or one.effect.always_fitted]
    tried: list[Candidate] = []
    for one in chosen:
        most = HOPE[len(one.effect.parameters) > 1] * one.z**2
        won = max((other.gain for other in tried), default=0.0)
        hopeless = most < least_gain or (len(tried) >= FEWEST and most < HOPELESS * won)
        if abs(one.z) < least_z or (hopeless and not one.effect.always_fitted):
            continue
        if progress is not None:
            progress(one.effect.name)
        first = first_fit(usual, one)
        tried.append(Candidate(one.effect, first, found.score - first.score, one))
    return screened, tried


def to_the_end(found: Fit, tried: list[Candidate]) -> list[Candidate]:
    """Fit the best of some first fits with sizes of their own; best first. The others keep their first fit."""
    tried = sorted(tried, key=lambda c: -c.gain)
    out = []
    for place, one in enumerate(tried):
        near = one.gain > tried[0].gain - NEAR or (place < SETTLED and one.gain > SHARE * tried[0].gain)
        out.append(finished(found, one) if near else one)
    return sorted(out, key=lambda c: -c.gain)


def finished(found: Fit, one: Candidate) -> Candidate:
    """A candidate refitted with contact scatter and law error of its own."""
    trial = settle(one.fit.problem, one.fit.vector, one.fit.sizes, 2, 8)
    return replace(one, fit=trial, gain=found.score - trial.score)
