"""Search for the effects of a campaign: a beam of models that grows, then is pruned; and rivals of the result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.progress import Progress, quiet
from dummydesign.loop.fitting.candidates import (
    EffectCandidate,
    Screened,
    finished,
    first_fit,
    first_fits,
    modest,
    screen,
    to_the_end,
)
from dummydesign.loop.fitting.fit import CampaignFit, budget_spent, fit_with_noise, same_noise
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.selection.cross_validation import AssessedModel, assess, errors, holds_null
from dummydesign.loop.selection.residuals import diagnose
from dummydesign.loop.selection.verdict import (
    EACH_PARAMETER,
    AcceptedEffect,
    Needed,
    at_bound,
    gain_floor,
    much_better,
    needed,
    predicts_better,
    remainder,
    worth,
)

RIVAL_GAP, FAMILY_COSINE, ALIKE_SHARE = 10.0, 0.9, 0.005
"""Evidence by which another effect may explain less and still be the cause; the cosine from which on two signatures
look the same; and then also that share of the evidence: the law of either is a convention, and what it misses decides
between them. Below 1 ms, the right one of lag and delay was up to 0.3 % behind."""
ALTERNATIVES, PRUNE_LEAST_Z, LIKE = 3, 4.0, 0.3
"""Effects tried in the place of each one found: how many, from which score on, and from which share of the squared
score of the one found."""
NEAR = 40.0  # a first fit so near the evidence of the effect found is fitted to the end
CERTAIN = 10.0  # times the evidence that an effect needs, from which on it is not dropped for its interval
SWAP = 10.0  # evidence by which another effect must be better to take a place


@dataclass(frozen=True)
class EffectCheck:
    """One effect of a model: the model without it, and what was tried in its place, itself first."""

    effect: Effect
    reduced: CampaignFit
    screened: list[Screened]
    options: list[EffectCandidate]


def names_of(fit: CampaignFit) -> frozenset[str]:
    """Names of a model's effects."""
    return frozenset(effect.name for effect in fit.problem.effects)


def without(fit: CampaignFit, effect: Effect) -> CampaignFit:
    """A model refitted without one of its effects."""
    rest = tuple(one for one in fit.problem.effects if one.name != effect.name)
    vector = np.delete(fit.vector, fit.problem.entries[effect.name])
    return fit_with_noise(replace(fit.problem, effects=rest), vector, fit.sizes, 2, 8)


def refit_without(full: CampaignFit, effect: Effect, available: tuple[Effect, ...]) -> EffectCheck:
    """Refit a model without an effect, and with others in its place."""
    reduced = without(full, effect)
    taken = names_of(full) - {effect.name}
    usual = modest(reduced)
    screened = screen(usual, tuple(one for one in available if one.name not in taken))
    nothing = Screened(effect, 0.0, 0.0, np.zeros_like(screened[0].signature), np.zeros(len(effect.parameters)))
    own = next((one for one in screened if one.effect.name == effect.name), nothing)
    first = EffectCandidate(effect, full, reduced.score - full.score, own)
    least = max(PRUNE_LEAST_Z**2, LIKE * own.z**2)
    others = [one for one in screened if one.effect.name != effect.name and one.z**2 >= least][:ALTERNATIVES]
    options = []
    for one in others:
        if budget_spent():
            break
        trial = first_fit(usual, one)
        option = EffectCandidate(one.effect, trial, reduced.score - trial.score, one)
        options.append(finished(reduced, option) if option.gain > first.gain - NEAR else option)
    return EffectCheck(effect, reduced, screened, [first, *sorted(options, key=lambda one: -one.gain)])


def prune_effects(
    current: AssessedModel, available: tuple[Effect, ...], tried: int, progress: Progress
) -> tuple[AssessedModel, list[AcceptedEffect]]:
    """Look at all effects of a model until none is dropped or exchanged, one change at a time."""
    changes = 2 * len(current.fit.problem.effects)
    while current.fit.problem.effects:
        progress("each effect again")
        checks = [refit_without(current.fit, effect, available) for effect in current.fit.problem.effects]
        tried += sum(len(check.options) for check in checks)
        changed = _change(current, checks, tried) if changes else None
        if changed is None:
            return current, _accepted(current, checks, tried)
        changes -= 1
        current = assess(same_noise(changed))
    return current, []


def _limit(check: EffectCheck, checks: list[EffectCheck], tried: int) -> Needed:
    others = {one.effect.name: one.options[0].gain for one in checks if one is not check}
    own = check.options[0].fit, check.effect.name
    return needed(check.screened, *own, others, tried, gain_floor(check.reduced))


def _near(check: EffectCheck, ratio: float | None) -> list[EffectCandidate]:
    """What explains the data as well as an effect, or nearly, likeliest first."""
    first, *others = check.options
    gap = RIVAL_GAP * max(1.0, ratio or 1.0)
    wide = max(gap, ALIKE_SHARE * first.gain)
    return [one for one in others if first.gain - one.gain < (wide if _alike(first.screened, one.screened) else gap)]


def _alike(one: Screened, other: Screened) -> bool:
    """Whether two effects look the same to first order."""
    return abs(float(one.signature @ other.signature)) > FAMILY_COSINE


def _change(current: AssessedModel, checks: list[EffectCheck], tried: int) -> CampaignFit | None:
    """The model with one effect dropped or exchanged, when that is called for."""
    weakest_first = sorted(checks, key=lambda check: check.options[0].gain)
    for check in weakest_first:
        limit = _limit(check, checks, tried)
        sized = not _negligible(current.fit, check.effect)
        if not (sized and worth(check.options[0].gain, limit, check.reduced, current.fit)):
            return check.reduced
    for check in weakest_first:
        # the interval is linear: where nothing else explains what the effect does, its size is unknown and not null
        plain = check.options[0].gain < CERTAIN * _limit(check, checks, tried).least
        if plain and holds_null(current, check.effect):
            return check.reduced
    swaps = [one for check in checks for one in check.options[1:] if not at_bound(one.fit)]
    better = min(swaps, key=lambda one: one.fit.score, default=None)
    if better is not None and current.fit.score - better.fit.score > SWAP and predicts_better(current, better.fit):
        return better.fit
    for check in weakest_first:
        before = assess(check.reduced)
        # rivals that look the same may stand in for it: which of them predicts best is chance
        stand_ins = [one for one in _near(check, current.lack.ratio) if one.gain <= check.options[0].gain]
        if not any(predicts_better(before, one.fit) for one in (check.options[0], *stand_ins)):
            return check.reduced
    return None


def _negligible(fit: CampaignFit, effect: Effect) -> bool:
    size = effect.parameters[0]
    values = next(one.values for one in fit.active if one.effect.name == effect.name)
    return abs(values[size.name] - size.null) < effect.negligible


def _accepted(current: AssessedModel, checks: list[EffectCheck], tried: int) -> list[AcceptedEffect]:
    accepted = []
    for check in checks:
        own = replace(check.options[0], fit=current.fit)
        names = tuple(one.effect.name for one in _near(check, current.lack.ratio)[:2])
        others = [one for one in check.screened if one.effect.name != check.effect.name]
        # effects whose signature is nearly parallel look the same in this campaign
        family = tuple(one.effect.name for one in others if _alike(own.screened, one))
        limit, left = _limit(check, checks, tried).least, current.errors.heldout_N
        accepted.append(AcceptedEffect(own, names, family, limit, left, tuple(check.options)))
    return sorted(accepted, key=lambda one: -one.candidate.gain)


WIDTH = 3  # models of each size that are kept
WITHIN = (0.5, 0.8, 0.9)
"""A rival model of one, two, or more effects is kept when it has this share of the best one's evidence."""
BOUND_SHARE = 0.5
"""Share of the evidence of a model at its bound that another must have to be taken before it."""
MOST = 6  # effects in a model at most
USUAL = 3  # effects that are usual at once; a further one must lower the left-out error by much
FIRST, NEXT = (7, 2.0), (4, 5.0)
"""Effects that are fitted after a screening, alone and beside others already found: how many, and from which score on.
"""
PROMISING = (12.0, 25.0)
"""Evidence of the best model with one effect, and with one effect more than the last that was worth it, below which
it is not continued to see whether two are worth it together."""


@dataclass(frozen=True)
class Selection:
    """The model that was chosen and how it came about."""

    after: AssessedModel
    effects: tuple[AcceptedEffect, ...]
    screened: list[Screened]
    ranking: list[EffectCandidate]
    rivals: tuple[Rival, ...] = ()
    """Models that were tried with one effect more, or another in the place of one."""


Ranked = tuple[list[Screened], list[EffectCandidate]]


def rank(base: AssessedModel, available: tuple[Effect, ...], progress: Progress = quiet) -> Ranked:
    """Scores of all effects, and the models with one effect; both best first."""
    screened, first = first_fits(base.fit, available, *FIRST, progress)
    return screened, to_the_end(base.fit, first)


def search(
    base: AssessedModel,
    available: tuple[Effect, ...],
    progress: Progress = quiet,
    ranked: Ranked | None = None,
    most: int = MOST,
) -> Selection:
    """Grow models by one effect at a time, take the largest that is worth its effects, then look at each of them.

    The best models of each size are kept, so that a rival that fits less well alone may win with a partner,
    and one size beyond the last that was worth it, because two effects may only be worth it together: unless the last
    that was worth it left nothing but noise. What must be gained grows with the number of models tried. At most
    ``most`` effects are added. Once a processor budget is spent no model is begun that is not needed to judge the best.
    """
    screened, ranking = ranked or rank(base, available, progress)
    tried = len(ranking)
    chosen, before, beam, won = base.fit, base.fit, _beam(ranking, 0.0, 1), 0.0
    waiting = done = False
    children = ranking
    gained = ranking[0].gain if ranking else 0.0
    for size in range(1, most + 1):
        if not beam or gained < PROMISING[min(size, 2) - 1]:
            break
        best = same_noise(beam[0].fit)
        *others, last = (effect.name for effect in best.problem.effects)
        limit = needed(screened, best, last, dict.fromkeys(others, won), tried, gain_floor(before))
        if worth(gained, limit, before, best) and (size <= USUAL or much_better(errors(before), errors(best))):
            chosen, waiting = best, False
            done = not remainder(base, assess(best), diagnose(best)).reasons
        elif waiting or done:
            break
        else:
            waiting = True
        if budget_spent():
            break
        before, won = best, won + gained
        progress(f"effect {size + 1}")
        # rivals are continued where something is missing
        parents = [best, *(with_noise_of(best, one.fit) for one in beam[1:] if not done)]
        children = _children(parents, available, won)
        tried += len(children)
        beam = _beam(children, won, size + 1)
        gained = beam[0].gain if beam else 0.0
    after, effects = (base, []) if chosen is base.fit else prune_effects(assess(chosen), available, tried, progress)
    if not effects:
        return Selection(base, (), screened, ranking, tuple((one.gain, one.fit) for one in ranking))
    more = [(one.gain, one.fit) for one in children if names_of(after.fit) < names_of(one.fit)]
    swaps = [(option.gain - one.ranking[0].gain, option.fit) for one in effects for option in one.ranking[1:]]
    return Selection(after, tuple(effects), screened, ranking, (*more, *swaps))


def _beam(candidates: list[EffectCandidate], won: float, size: int) -> list[EffectCandidate]:
    """The best models with different effects, when ``won`` is what their parent gained.

    One at its bound is kept when no other comes near its evidence: what explains most may not be passed over.
    """
    inside = max((one.gain for one in candidates if not at_bound(one.fit)), default=0.0)
    seen: set[frozenset[str]] = set()
    kept: list[EffectCandidate] = []
    share = _share(size)
    for one in candidates:
        imitates = at_bound(one.fit) and (kept or won + inside >= BOUND_SHARE * (won + one.gain))
        if imitates or names_of(one.fit) in seen or len(kept) == WIDTH:
            continue
        if kept and won + one.gain < share * (won + kept[0].gain):
            break
        seen.add(names_of(one.fit))
        kept.append(one)
    return kept


def with_noise_of(other: CampaignFit, fit: CampaignFit) -> CampaignFit:
    """The same model refitted with the white and slow noise of another, so that their scores can be compared."""
    noise = replace(other.sizes.noise, position_mm=fit.sizes.noise.position_mm)
    return fit_with_noise(fit.problem, fit.vector, replace(fit.sizes, noise=noise), 1, 6)


def _children(parents: list[CampaignFit], available: tuple[Effect, ...], won: float) -> list[EffectCandidate]:
    """Models with one effect more than a parent, best first; their gain is counted from the first parent.

    A child of another parent that could not come near the best even with all it may gain is not fitted; ``won`` is the
    evidence of the first parent.
    """
    best: dict[frozenset[str], EffectCandidate] = {}
    size = len(parents[0].problem.effects) + 1
    for parent in parents:
        if best and budget_spent():
            break
        known, behind = names_of(parent), parent.score - parents[0].score
        rest = tuple(one for one in available if one.name not in known and known | {one.name} not in best)
        top = max((child.gain for child in best.values()), default=0.0)
        near = _share(size) * (won + top) - won + behind
        for one in first_fits(parent, rest, *NEXT, quiet, near if best else 0.0)[1]:
            best[names_of(one.fit)] = replace(one, gain=parents[0].score - one.fit.score)
    return to_the_end(parents[0], list(best.values()))


def _share(size: int) -> float:
    return WITHIN[min(size, len(WITHIN)) - 1]


LAW_ERROR = 0.004
"""Relative standard deviation of what a force law is off on all pads of a shape alike: slabs differ from GetFEM's by
0.1 to 0.4 %, and pads of one shape do not average it out."""


Rival = tuple[float, CampaignFit]
"""Evidence of a model over that of the chosen one, with the same noise, and its fit."""


def doubt_of(chosen: CampaignFit, rivals: Iterable[Rival], curve: ArrayLike = 0.0) -> NDArray:
    """Covariance of the base logarithms over rival models, and the law's error in the modulus.

    A rival weighs exp(evidence / 2) of the chosen model, less :data:`EACH_PARAMETER` for each named parameter more; its
    own covariance counts as well. A learned ``curve`` and the modulus share their level.
    """
    own = named_parameters(chosen)
    rows = [(gain - EACH_PARAMETER * (named_parameters(one) - own), one) for gain, one in rivals if not at_bound(one)]
    weights = np.exp(0.5 * np.array([0.0, *(gain for gain, _ in rows)]).clip(-60.0, 60.0))
    count = chosen.problem.base_count
    out = np.zeros((count, count))
    for weight, (_, one) in zip((weights / weights.sum())[1:], rows):
        difference = one.vector[:count] - chosen.vector[:count]
        out += weight * (np.outer(difference, difference) + one.covariance[:count, :count])
    out[0, 0] += LAW_ERROR**2 + float(np.abs(curve).max()) ** 2
    return out


def named_parameters(fit: CampaignFit) -> int:
    """Number of parameters of a model's named effects, those of form left out."""
    return sum(not p.of_form for one in fit.problem.effects if not one.held for p in one.parameters)
