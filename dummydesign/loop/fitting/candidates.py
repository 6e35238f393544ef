"""Effects as candidates: how much of the residual each could explain, to first order; joint refit of the base with each
promising one, and their ranking."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.progress import Progress, quiet
from dummydesign.loop.fitting.fit import CampaignFit, budget_spent, fit, fit_with_noise, prior_precision, with_sizes
from dummydesign.loop.fitting.noise import NoiseSizes, Whitener
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import SMOOTH_TERMS


@dataclass(frozen=True)
class Screened:
    """One effect after screening."""

    effect: Effect
    z: float
    coordinate: float
    signature: NDArray
    start: NDArray


@dataclass(frozen=True)
class Projection:
    """Whitened residual and the space that base parameters, law error and accepted effects span.

    ``rows`` are those of priors, below the bins.
    """

    basis: NDArray
    residual: NDArray
    rows: int
    whiten: Whitener

    def column(self, change_N: NDArray) -> NDArray:
        """A change of the bins (T, B), whitened, with the rows of the priors."""
        return np.r_[self.whiten(change_N).ravel(), np.zeros(self.rows)]

    def remove(self, vector: NDArray) -> NDArray:
        """Take out of a whitened vector what the base could absorb."""
        return vector - self.basis @ (self.basis.T @ vector)


def project(fit: CampaignFit, law_free: bool = False) -> Projection:
    """Whiten a fit's residual with its prior rows and orthonormalise its sensitivities.

    ``law_free`` drops the prior rows of level, slope and curvature: then whatever such a law error of any size could
    do is taken out. Waves keep their prior.
    """
    problem = fit.problem
    whiten = fit.whitener
    scale = np.sqrt(prior_precision(problem, fit.sizes)[problem.fixed :])
    if law_free:
        scale[: SMOOTH_TERMS * len(problem.presses.pads)] = 0.0
    turned = fit.whitened_jacobian.reshape(-1, len(fit.vector))
    # the base parameters have no prior
    prior = np.diag(np.r_[np.zeros(problem.fixed), scale])[problem.fixed :]
    stacked = np.concatenate([turned, prior])
    norm = np.linalg.norm(stacked, axis=0)
    basis, singular, _ = np.linalg.svd(stacked / np.where(norm > 0, norm, 1.0), full_matrices=False)
    basis = basis[:, singular > 1e-9 * singular[0]]
    residual = np.r_[whiten(fit.residual).ravel(), -scale * fit.vector[problem.fixed :]]
    return Projection(basis, residual, len(prior), whiten)


def change_by(fit: CampaignFit, effect: Effect, start: NDArray) -> NDArray:
    """Change of the bins (T, B) when an effect joins what a fit holds, from a start of its coordinates. [N]"""
    problem, vector = fit.problem.plus(effect), np.insert(fit.vector, fit.problem.fixed, start)
    return np.where(problem.presses.used, problem.predict(vector) - fit.forces, 0.0)


def screen(fit: CampaignFit, candidates: tuple[Effect, ...]) -> list[Screened]:
    """Score all candidates at a fit, best first.

    One simulation per starting value of each effect; z = a . r / |a| with a the whitened change, base and
    law error projected out.
    """
    projection = project(fit)
    clean = projection.remove(projection.residual)
    out = []
    for effect in candidates:
        tried = []
        size_of = effect.parameters[0]
        low, high = sorted(size_of.to_coordinate(end) for end in (size_of.low, size_of.high))
        for start in starts_of(effect):
            change = change_by(fit, effect, start)
            if not np.all(np.isfinite(change)):
                values = ", ".join(f"{p.name} = {p.to_value(at):g}" for p, at in zip(effect.parameters, start))
                message = f"effect '{effect.name}' gives a force that is not finite at {values} on these trials"
                raise InputError(message, "out_of_range", "effect", effect.name)
            column = projection.remove(projection.column(change))
            length = float(np.linalg.norm(column))
            if length < 1e-6:
                continue
            z = float(column @ clean) / length
            size = z / length * start[0]
            inside = low - 1e-9 <= np.sign(size) * 1e-6 <= high + 1e-9
            tried.append(Screened(effect, z if inside else 0.0, size if inside else 0.0, column / length, start))
        if tried:
            out.append(max(tried, key=lambda one: abs(one.z)))
    return sorted(out, key=lambda one: -abs(one.z))


def starts_of(effect: Effect) -> list[NDArray]:
    """Coordinates to try: the typical size, with each start of a second parameter (its null if that is not 0)."""
    first, *others = effect.parameters
    size = 1.0 if first.to_value(1.0) != first.null else -1.0
    usual = [(p.typical if p.log or p.null == 0.0 else p.null, *p.starts) for p in others]
    grid = product(*([p.to_coordinate(value) for value in values] for p, values in zip(others, usual)))
    return [np.array([size, *rest]) for rest in grid]


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
    own, priors = campaign_fit.sizes, campaign_fit.problem.law.error_priors
    noise = replace(own.noise, position_mm=min(own.noise.position_mm, USUAL_POSITION_MM))
    law = tuple(min(size, median) for size, (median, _) in zip(own.law, priors))
    sizes = NoiseSizes(noise, law, min(own.gain, USUAL_GAIN), own.most)
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
