"""A function learned from the base model, with named effects beside it, against named effects alone.

Named effects imitate what has no name: several of them together explain a good part of a sensor curve or a law that is
another one. So where they leave something unexplained, the function is learned before them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from dummydesign.core.process import Progress
from dummydesign.loop.effects.learned import Learned
from dummydesign.loop.fitting.candidates import EffectCandidate
from dummydesign.loop.fitting.fit import CampaignFit
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.selection.cross_validation import AssessedModel, assess
from dummydesign.loop.selection.learn_effect import Learnt, can_be_learned, learn, refitted_squares
from dummydesign.loop.selection.residuals import dependences, run_checks
from dummydesign.loop.selection.search import search
from dummydesign.loop.selection.verdict import EACH_PARAMETER, AcceptedEffect, remainder


@dataclass(frozen=True)
class LearnedFirst:
    """A learned function and the named effects that were found beside it."""

    learnt: Learnt
    after: AssessedModel
    effects: tuple[AcceptedEffect, ...]


def learned_alone(base: AssessedModel, ranking: list[EffectCandidate], progress: Progress) -> LearnedFirst | None:
    """A function that leaves nothing but noise, where the best single effect leaves more and explains less."""
    best = ranking[0].fit if ranking else base.fit
    if not _leaves(base, base.fit) or not can_be_learned(run_checks(base.fit), dependences(base.fit)):
        return None
    if best is not base.fit and not _leaves(base, best):
        return None
    progress("learning from the base model")
    function = learn(base.fit)
    if function is None or _leaves(base, function.fit):
        return None
    after = assess(function.fit)
    if _cost(after, function) >= best.score + EACH_PARAMETER:
        return None
    return LearnedFirst(function, after, ())


def _leaves(base: AssessedModel, fit: CampaignFit) -> bool:
    """Whether a model leaves more than noise."""
    return bool(remainder(base, assess(fit), dependences(fit), run_checks(fit)).reasons)


def learned_first(
    base: AssessedModel, named: AssessedModel, available: tuple[Effect, ...], progress: Progress
) -> LearnedFirst | None:
    """Learn from the base, add named effects, and return that when it explains and predicts better than ``named``.

    Explained is compared by the marginal likelihood of the
    curve and a cost of each named parameter; predicted by real refits without each part of the conditions.
    """
    if not named.fit.problem.effects or not can_be_learned(run_checks(base.fit), dependences(base.fit)):
        return None
    progress("learning before the named effects")
    function = learn(base.fit)
    if function is None:
        return None
    found = search(assess(function.fit), available, progress)
    after = found.after
    if _cost(after, function) >= _cost(named):
        return None
    if _squares(after, function) >= _squares(named):
        return None
    kept = [one for one in after.fit.problem.effects if isinstance(one, Learned)]
    if not kept:
        return None
    effects = tuple(one for one in found.effects if not isinstance(one.candidate.effect, Learned))
    return LearnedFirst(replace(function, fit=after.fit), after, effects)


def _cost(model: AssessedModel, learnt: Learnt | None = None) -> float:
    """Minus twice the log likelihood, with what the curve and the named parameters cost."""
    named = sum(not p.of_form for one in model.fit.problem.effects if not one.held for p in one.parameters)
    return model.fit.score + (0.0 if learnt is None else learnt.cost) + EACH_PARAMETER * named


def _squares(model: AssessedModel, learnt: Learnt | None = None) -> float:
    return refitted_squares(model.fit, None if learnt is None else learnt.effect.shape)
