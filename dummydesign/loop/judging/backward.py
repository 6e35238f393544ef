"""A last look at each effect of a model: dropped when needless, exchanged for a better one, and who else would do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.loop.fitting.base_fit import same_noise
from dummydesign.loop.fitting.candidates import Candidate, finished, first_fit, modest
from dummydesign.loop.fitting.fit import Fit, settle
from dummydesign.loop.fitting.problem import BASE, Problem
from dummydesign.loop.fitting.screening import Screened, screen
from dummydesign.loop.judging.acceptance import Found, at_bound, predicts_better, worth
from dummydesign.loop.judging.assessed import Stage, make_stage
from dummydesign.loop.judging.verdict import Needed, family_of, needed, rivals
from dummydesign.loop.model.effect import Effect

ALTERNATIVES, LEAST_Z, LIKE = 3, 4.0, 0.3
"""Effects tried in the place of each one found: how many, from which score on, and from which share of the squared
score of the one found."""
NEAR = 40.0
"""A first fit so near the evidence of the effect found is fitted to the end."""
SWAP = 10.0
"""Evidence by which another effect must be better to take a place."""


@dataclass(frozen=True)
class Place:
    """One effect of a model: the model without it, and what was tried in its place, itself first."""

    effect: Effect
    reduced: Fit
    screened: list[Screened]
    options: list[Candidate]


def names_of(fit: Fit) -> frozenset[str]:
    """Names of a model's effects."""
    return frozenset(effect.name for effect in fit.problem.effects)


def without(fit: Fit, effect: Effect) -> Fit:
    """A model refitted without one of its effects."""
    vector, at = fit.vector, BASE
    for one in fit.problem.effects:
        if one.name == effect.name:
            vector = np.delete(vector, slice(at, at + len(one.parameters)))
        at += len(one.parameters)
    rest = tuple(one for one in fit.problem.effects if one.name != effect.name)
    return settle(Problem(fit.problem.presses, fit.problem.law, rest), vector, fit.sizes, 2, 8)


def look_at(full: Fit, effect: Effect, available: tuple[Effect, ...]) -> Place:
    """Refit a model without an effect, and with others in its place.

    Parameters
    ----------
    full : Fit
        The model with all its effects.
    effect : Effect
        One of them.
    available : tuple of Effect
        Effects that the campaign can test.
    """
    reduced = without(full, effect)
    taken = names_of(full) - {effect.name}
    usual = modest(reduced)
    screened = screen(usual, tuple(one for one in available if one.name not in taken))
    nothing = Screened(effect, 0.0, 0.0, np.zeros_like(screened[0].signature), np.zeros(len(effect.parameters)))
    own = next((one for one in screened if one.effect.name == effect.name), nothing)
    first = Candidate(effect, full, reduced.score - full.score, own)
    least = max(LEAST_Z**2, LIKE * own.z**2)
    others = [one for one in screened if one.effect.name != effect.name and one.z**2 >= least][:ALTERNATIVES]
    options = []
    for one in others:
        trial = first_fit(usual, one)
        option = Candidate(one.effect, trial, reduced.score - trial.score, one)
        options.append(finished(reduced, option) if option.gain > first.gain - NEAR else option)
    return Place(effect, reduced, screened, [first, *sorted(options, key=lambda one: -one.gain)])


def look_again(
    current: Stage, available: tuple[Effect, ...], tried: int, progress: Callable[[str], None] | None
) -> tuple[Stage, list[Found], int]:
    """Look at all effects of a model until none is dropped or exchanged, one change at a time.

    Parameters
    ----------
    current : Stage
        The model, assessed.
    available : tuple of Effect
        Effects that the campaign can test.
    tried : int
        Models tried before.
    progress : callable or None
        Called with a word for each round.

    Returns
    -------
    Stage
        The model that stands.
    list of Found
        Its effects, that with the most evidence beside the others first; empty when none stands.
    int
        Models tried so far.
    """
    changes = 2 * len(current.fit.problem.effects)
    while current.fit.problem.effects:
        if progress is not None:
            progress("each effect again")
        places = [look_at(current.fit, effect, available) for effect in current.fit.problem.effects]
        tried += sum(len(place.options) for place in places)
        changed = _change(current, places, tried) if changes else None
        if changed is None:
            return current, _found(current, places, tried), tried
        changes -= 1
        current = make_stage(same_noise(changed))
    return current, [], tried


def _limit(place: Place, places: list[Place], tried: int) -> Needed:
    others = {one.effect.name: one.options[0].gain for one in places if one is not place}
    return needed(place.screened, place.options[0].fit, place.effect.name, others, tried)


def _near(place: Place, ratio: float | None) -> list[Candidate]:
    return rivals(place.options[1:], place.options[0], ratio)


def _change(current: Stage, places: list[Place], tried: int) -> Fit | None:
    """The model with one effect dropped or exchanged, when that is called for."""
    weakest_first = sorted(places, key=lambda place: place.options[0].gain)
    for place in weakest_first:
        if not worth(place.options[0].gain, _limit(place, places, tried), place.reduced, current.fit):
            return place.reduced
    swaps = [one for place in places for one in place.options[1:] if not at_bound(one.fit)]
    better = min(swaps, key=lambda one: one.fit.score, default=None)
    if better is not None and current.fit.score - better.fit.score > SWAP and predicts_better(current, better.fit):
        return better.fit
    for place in weakest_first:
        before = make_stage(place.reduced)
        # rivals that cannot be told from it may stand in for it: which of them predicts best is chance
        stand_ins = [one for one in _near(place, current.lack.ratio) if one.gain <= place.options[0].gain]
        if not any(predicts_better(before, one.fit) for one in (place.options[0], *stand_ins)):
            return place.reduced
    return None


def _found(current: Stage, places: list[Place], tried: int) -> list[Found]:
    found = []
    for place in places:
        own = replace(place.options[0], fit=current.fit)
        names = tuple(one.effect.name for one in _near(place, current.lack.ratio)[:2])
        family = tuple(family_of(own.screened, place.screened))
        limit, left = _limit(place, places, tried).least, current.errors.heldout_N
        found.append(Found(own, names, family, limit, left, tuple(place.options)))
    return sorted(found, key=lambda one: -one.candidate.gain)
