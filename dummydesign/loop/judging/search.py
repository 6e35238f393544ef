"""Search for the effects of a campaign: a beam of models, joint refits, and a last look at each effect of the best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.loop.fitting.base_fit import same_noise
from dummydesign.loop.fitting.candidates import Candidate, first_fit, modest, rank
from dummydesign.loop.fitting.fit import BASE, Fit, Problem, settle
from dummydesign.loop.fitting.screening import Screened, screen
from dummydesign.loop.judging.acceptance import Found, accept, at_bound, predicts_better
from dummydesign.loop.judging.assessed import Stage, make_stage
from dummydesign.loop.judging.lack_of_fit import lack_of_fit
from dummydesign.loop.judging.verdict import GAIN_FLOOR, NEXT_FLOOR, NEXT_SHARE, family_of, gain_threshold, rivals
from dummydesign.loop.model.effect import Effect

Progress = Callable[[str], None]

WIDTH = 2
"""Models of each size that are kept."""
WITHIN = 0.5
"""A rival model is kept when it has at least this share of the best one's evidence."""
MOST = 6
"""Effects in a model at most."""
KEEP, LEAST_Z, REFITTED = 6, 4.0, 4
"""Effects that are fitted beside others already found: how many, from which score on, how many with all sizes."""
ALTERNATIVES = 3
"""Effects that are tried in the place of each one found."""


@dataclass(frozen=True)
class Selection:
    """The model that was chosen and how it came about.

    Attributes
    ----------
    after : Stage
        The base when nothing was accepted.
    effects : tuple of Found
        Accepted effects, the one with the most evidence beside the others first.
    screened, ranking : list
        Scores and joint fits of single effects at the base, best first.
    tried : int
        Models that were fitted.
    """

    after: Stage
    effects: tuple[Found, ...]
    screened: list[Screened]
    ranking: list[Candidate]
    tried: int


def search(base: Stage, available: tuple[Effect, ...], progress: Progress | None = None) -> Selection:
    """Add effects while one is accepted, then look again at each of those found.

    The best models of each size are kept, so that a rival that fits less well alone may win with a partner.
    What must be gained grows with the number of models tried.

    Parameters
    ----------
    base : Stage
        The base model, assessed.
    available : tuple of Effect
        Effects that the campaign can test.
    progress : callable, optional
        Called with a word for each step.
    """
    screened, ranking = rank(base.fit, available, progress)
    tried = len(ranking)
    first = accept(base, screened, ranking, GAIN_FLOOR)
    if first is None:
        return Selection(base, (), screened, ranking, tried)
    current, found = make_stage(same_noise(first.candidate.fit)), [first]
    beam = _beside(current, [first.candidate, *ranking])
    while len(found) < MOST:
        if progress is not None:
            progress(f"effect {len(found) + 1}")
        won = base.fit.score - current.fit.score
        options = [_children(current, fit, available, best=fit is current.fit) for fit in (current.fit, *beam)]
        tried += sum(len(children) for _, children in options)
        following = _accepted(current, options, tried, won)
        if following is None:
            break
        found.append(following)
        current = make_stage(same_noise(following.candidate.fit))
        beam = _beside(current, [following.candidate, *(one for _, children in options for one in children)])
    if len(found) == 1:
        return Selection(current, (first,), screened, ranking, tried)
    after, effects = _looked_at_again(current, available, tried, progress)
    return Selection(after, tuple(effects), screened, ranking, tried)


def _names(fit: Fit) -> frozenset[str]:
    return frozenset(effect.name for effect in fit.problem.effects)


def _beside(current: Stage, candidates: list[Candidate]) -> list[Fit]:
    """The next best models with other effects, refitted with the noise of the current one."""
    least = WITHIN * candidates[0].gain
    seen, kept = {_names(current.fit)}, []
    for one in sorted(candidates[1:], key=lambda c: c.fit.score):
        if one.gain >= least and _names(one.fit) not in seen and not at_bound(one) and len(kept) < WIDTH - 1:
            seen.add(_names(one.fit))
            kept.append(with_noise_of(current.fit, one.fit))
    return kept


def with_noise_of(other: Fit, fit: Fit) -> Fit:
    """The same model refitted with the white and slow noise of another, so that their scores can be compared."""
    sizes = fit.sizes
    noise = replace(other.sizes.noise, position_mm=sizes.noise.position_mm)
    return settle(fit.problem, fit.vector, replace(sizes, noise=noise), 1, 6)


def _children(
    current: Stage, parent: Fit, available: tuple[Effect, ...], best: bool
) -> tuple[list[Screened], list[Candidate]]:
    """Models with one effect more than a parent; their gain is counted from the current model."""
    rest = tuple(effect for effect in available if effect.name not in _names(parent))
    screened, ranking = rank(parent, rest, None, KEEP, LEAST_Z, REFITTED, always=best)
    gained = [replace(one, gain=current.fit.score - one.fit.score) for one in ranking]
    return screened, sorted(gained, key=lambda one: -one.gain)


def _accepted(
    current: Stage, options: list[tuple[list[Screened], list[Candidate]]], tried: int, won: float
) -> Found | None:
    """The likeliest child that is accepted, of any parent."""
    floor = NEXT_FLOOR + 2.0 * float(np.log(max(tried, 1)))
    promising = [(screened, children) for screened, children in options if children]
    for screened, children in sorted(promising, key=lambda option: -option[1][0].gain):
        found = accept(current, screened, children, floor, NEXT_SHARE * won)
        if found is not None:
            return found
    return None


def without(fit: Fit, effect: Effect) -> Fit:
    """A model refitted without one of its effects."""
    vector, at = fit.vector, BASE
    for one in fit.problem.effects:
        if one.name == effect.name:
            vector = np.delete(vector, slice(at, at + len(one.parameters)))
        at += len(one.parameters)
    rest = tuple(one for one in fit.problem.effects if one.name != effect.name)
    return settle(Problem(fit.problem.presses, fit.problem.law, rest), vector, fit.sizes, 2, 8)


@dataclass(frozen=True)
class _Place:
    """One effect of a model: the model without it, and what was tried in its place, itself first."""

    effect: Effect
    reduced: Fit
    screened: list[Screened]
    options: list[Candidate]


def _place(full: Fit, effect: Effect, available: tuple[Effect, ...]) -> _Place:
    reduced = without(full, effect)
    taken = _names(full) - {effect.name}
    usual = modest(reduced)
    screened = screen(usual, tuple(one for one in available if one.name not in taken))
    own = next(one for one in screened if one.effect.name == effect.name)
    options = [Candidate(effect, full, reduced.score - full.score, own)]
    for one in [one for one in screened if one.effect.name != effect.name and abs(one.z) >= LEAST_Z][:ALTERNATIVES]:
        trial = first_fit(usual, one)
        trial = settle(trial.problem, trial.vector, trial.sizes, 2, 8)
        options.append(Candidate(one.effect, trial, reduced.score - trial.score, one))
    return _Place(effect, reduced, screened, options)


def _looked_at_again(
    current: Stage, available: tuple[Effect, ...], tried: int, progress: Progress | None
) -> tuple[Stage, list[Found]]:
    """Drop what has become needless, put a better rival in its place, and say who else would do.

    One change at a time, then all are looked at again; the number of changes is that of the effects at most.
    """
    for _ in range(len(current.fit.problem.effects)):
        if progress is not None:
            progress("each effect again")
        places = [_place(current.fit, effect, available) for effect in current.fit.problem.effects]
        tried += sum(len(place.options) for place in places)
        changed = _change(current, places, tried)
        if changed is None:
            return current, _found(current, places, tried)
        current = make_stage(same_noise(changed))
    places = [_place(current.fit, effect, available) for effect in current.fit.problem.effects]
    return current, _found(current, places, tried)


def _needed(place: _Place, tried: int) -> float:
    floor = NEXT_FLOOR + 2.0 * float(np.log(max(tried, 1)))
    return gain_threshold(place.screened, lack_of_fit(place.options[0].fit).ratio, floor)


def _change(current: Stage, places: list[_Place], tried: int) -> Fit | None:
    """The model with one effect dropped or exchanged, when that is called for."""
    weakest = min(places, key=lambda place: place.options[0].gain)
    if len(places) > 1 and weakest.options[0].gain < _needed(weakest, tried):
        return weakest.reduced
    swaps = [one for place in places for one in place.options[1:] if not at_bound(one)]
    better = min(swaps, key=lambda one: one.fit.score, default=None)
    if better is not None and current.fit.score - better.fit.score > 10.0 and predicts_better(current, better.fit):
        return better.fit
    return None


def _found(current: Stage, places: list[_Place], tried: int) -> list[Found]:
    found = []
    for place in places:
        own = replace(place.options[0], fit=current.fit)
        others = sorted(place.options[1:], key=lambda one: -one.gain)
        near = rivals(others, own, current.lack.ratio)
        names = tuple(one.effect.name for one in near[:2])
        found.append(
            Found(
                own,
                names,
                tuple(family_of(own.screened, place.screened)),
                _needed(place, tried),
                current.errors.heldout_N,
                (own, *others),
            )
        )
    return sorted(found, key=lambda one: -one.candidate.gain)

