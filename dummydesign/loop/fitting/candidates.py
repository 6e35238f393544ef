"""Joint refit of the base with each promising effect, and their ranking."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dummydesign.core.progress import Progress, quiet
from dummydesign.loop.fitting.budget import budget_spent
from dummydesign.loop.fitting.fit import CampaignFit, fit, fit_with_noise, with_sizes
from dummydesign.loop.fitting.noise import NoiseSizes
from dummydesign.loop.fitting.screening import Screened, screen
from dummydesign.loop.model.effect import Effect

ROUGH = 0.5  # gain in chi-square at which a first fit ends: what is compared are tens
USUAL_POSITION_MM, USUAL_GAIN = 0.02, 0.002  # scatter of presses by a usual robot
SETTLED, NEAR, SHARE = 3, 40.0, 0.3
"""Effects that are fitted again with contact scatter and law error of their own: how many at least, and all whose
first fit is so near the best, if they have this share of its evidence."""

HOPE, HOPELESS, FEWEST = (2.0, 20.0), 0.1, 3
"""How many times its squared score an effect of one parameter, or of several, gains at most; one that would still have
less than this share of the best gain so far cannot win and is not fitted, when so many were."""


@dataclass(frozen=True)
class EffectCandidate:
    """An effect fitted jointly with the base."""

    effect: Effect
    fit: CampaignFit
    gain: float
    screened: Screened


def first_fit(campaign_fit: CampaignFit, one: Screened) -> CampaignFit:
    """Fit an effect beside what ``campaign_fit`` holds, from where it scored best, sizes as they are.

    The score is that with contact scatter and law error of its own, the fit moved there to first order.
    """
    problem, at = campaign_fit.problem.plus(one.effect), campaign_fit.problem.fixed
    count = problem.base_count
    # to first order a large effect is overestimated
    first = float(np.clip(one.coordinate, -8.0, 8.0))
    tried = []
    for logs in one.effect.base_starts(campaign_fit.vector[:count].copy()):
        vector = np.r_[logs, campaign_fit.vector[count:at], one.start, campaign_fit.vector[at:]]
        vector[at] = first if abs(first) > 0.05 else 0.3 * float(one.start[0])
        tried.append(fit(problem, vector, campaign_fit.sizes, 16, ROUGH))
    return with_sizes(min(tried, key=lambda trial: trial.chi2))


def modest(campaign_fit: CampaignFit) -> CampaignFit:
    """The same model refitted with law error and scatter of presses of usual size.

    Where an effect is missing, both have grown to imitate it; screened at that size, and fitted from there,
    the effect would not be seen.
    """
    usual = [prior[0] for prior in campaign_fit.problem.law.error_priors]
    own = campaign_fit.sizes
    noise = replace(own.noise, position_mm=min(own.noise.position_mm, USUAL_POSITION_MM))
    sizes = NoiseSizes(
        noise, *(min(a, b) for a, b in zip(own.law, usual)), gain=min(own.gain, USUAL_GAIN), most=own.most
    )
    return fit(campaign_fit.problem, campaign_fit.vector, sizes, 6)


def first_fits(
    campaign_fit: CampaignFit,
    effects: tuple[Effect, ...],
    keep: int,
    least_z: float,
    progress: Progress = quiet,
    least_gain: float = 0.0,
) -> tuple[list[Screened], list[EffectCandidate]]:
    """Screen all effects and fit the best once beside those of the model; scores best first, fits in that order."""
    usual = modest(campaign_fit)
    screened = screen(usual, effects)
    chosen = [one for rank, one in enumerate(screened) if rank < keep or one.effect.always_fitted]
    tried: list[EffectCandidate] = []
    for one in chosen:
        if tried and budget_spent():
            break
        most = HOPE[len(one.effect.parameters) > 1] * one.z**2
        won = max((other.gain for other in tried), default=0.0)
        hopeless = most < least_gain or (len(tried) >= FEWEST and most < HOPELESS * won)
        if abs(one.z) < least_z or (hopeless and not one.effect.always_fitted):
            continue
        progress(one.effect.name)
        first = first_fit(usual, one)
        tried.append(EffectCandidate(one.effect, first, campaign_fit.score - first.score, one))
    return screened, tried


def to_the_end(campaign_fit: CampaignFit, tried: list[EffectCandidate]) -> list[EffectCandidate]:
    """Fit the best of some first fits with sizes of their own; best first. The others keep their first fit.

    Contact scatter and law error are estimated anew for every effect, because what an effect explains the law error
    need not.
    """
    tried = sorted(tried, key=lambda c: -c.gain)
    out = []
    for rank, one in enumerate(tried):
        near = one.gain > tried[0].gain - NEAR or (rank < SETTLED and one.gain > SHARE * tried[0].gain)
        out.append(finished(campaign_fit, one) if near and (rank == 0 or not budget_spent()) else one)
    return sorted(out, key=lambda c: -c.gain)


def finished(campaign_fit: CampaignFit, one: EffectCandidate) -> EffectCandidate:
    """A candidate refitted with contact scatter and law error of its own."""
    trial = fit_with_noise(one.fit.problem, one.fit.vector, one.fit.sizes, 2, 8)
    return replace(one, fit=trial, gain=campaign_fit.score - trial.score)
