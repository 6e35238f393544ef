"""Search for the effects of a campaign: a beam of models that grows, then a last look at each effect of the best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from dummydesign.loop.fitting.base_fit import same_noise
from dummydesign.loop.fitting.candidates import Candidate, first_fits, rank, to_the_end
from dummydesign.loop.fitting.fit import Fit, settle
from dummydesign.loop.fitting.screening import Screened
from dummydesign.loop.judging.acceptance import Found, at_bound, much_better, worth
from dummydesign.loop.judging.assessed import Stage, make_stage
from dummydesign.loop.judging.backward import look_again, names_of
from dummydesign.loop.judging.left_out import errors
from dummydesign.loop.judging.residual_checks import run_checks
from dummydesign.loop.judging.residual_dependence import dependences
from dummydesign.loop.judging.verdict import needed, remainder
from dummydesign.loop.model.effect import Effect

Progress = Callable[[str], None]

WIDTH = 3
"""Models of each size that are kept."""
WITHIN = (0.5, 0.8, 0.9)
"""A rival model of one, two, or more effects is kept when it has this share of the best one's evidence."""
MOST = 6
"""Effects in a model at most."""
USUAL = 3
"""Effects that are usual at once; a further one must lower the left-out error by much."""
KEEP, LEAST_Z = 4, 5.0
"""Effects that are fitted beside others already found: how many, and from which score on."""
PROMISING = (12.0, 25.0)
"""Evidence of the best model with one effect, and with one effect more than the last that was worth it, below which
it is not carried on to see whether two are worth it together."""


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
    """Grow models by one effect at a time, take the largest that is worth its effects, then look at each of them.

    The best models of each size are kept, so that a rival that fits less well alone may win with a partner,
    and one size beyond the last that was worth it, because two effects may only be worth it together: unless the last
    that was worth it left nothing but noise. What must be gained grows with the number of models tried.

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
    chosen, before, beam, won = base.fit, base.fit, _beam(ranking, 0.0, 1), 0.0
    waiting = done = False
    gained = ranking[0].gain if ranking else 0.0
    for size in range(1, MOST + 1):
        if not beam or gained < PROMISING[min(size, 2) - 1]:
            break
        best = same_noise(beam[0].fit)
        *others, last = (effect.name for effect in best.problem.effects)
        limit = needed(screened, best, last, dict.fromkeys(others, won), tried)
        if worth(gained, limit, before, best) and (size <= USUAL or much_better(errors(before), errors(best))):
            chosen, waiting, done = best, False, explained(base, best)
        elif waiting or done:
            break
        else:
            waiting = True
        before, won = best, won + gained
        if progress is not None:
            progress(f"effect {size + 1}")
        # rivals are carried on where something is missing
        parents = [best, *(with_noise_of(best, one.fit) for one in beam[1:] if not done)]
        children = _children(parents, available, won)
        tried += len(children)
        beam = _beam(children, won, size + 1)
        gained = beam[0].gain if beam else 0.0
    if chosen is base.fit:
        return Selection(base, (), screened, ranking, tried)
    after, effects, tried = look_again(make_stage(chosen), available, tried, progress)
    return Selection(after if effects else base, tuple(effects), screened, ranking, tried)


def explained(base: Stage, fit: Fit) -> bool:
    """Whether a model leaves nothing but noise."""
    return not remainder(base, make_stage(fit), dependences(fit), run_checks(fit)).reasons


def _beam(candidates: list[Candidate], won: float, size: int) -> list[Candidate]:
    """The best models with different effects, none of them at its bound, when ``won`` is what their parent gained."""
    seen, kept = set(), []
    share = _share(size)
    for one in candidates:
        if at_bound(one.fit) or names_of(one.fit) in seen or len(kept) == WIDTH:
            continue
        if kept and won + one.gain < share * (won + kept[0].gain):
            break
        seen.add(names_of(one.fit))
        kept.append(one)
    return kept


def with_noise_of(other: Fit, fit: Fit) -> Fit:
    """The same model refitted with the white and slow noise of another, so that their scores can be compared."""
    noise = replace(other.sizes.noise, position_mm=fit.sizes.noise.position_mm)
    return settle(fit.problem, fit.vector, replace(fit.sizes, noise=noise), 1, 6)


def _children(parents: list[Fit], available: tuple[Effect, ...], won: float) -> list[Candidate]:
    """Models with one effect more than a parent, best first; their gain is counted from the first parent.

    A child of another parent that could not come near the best even with all it may gain is not fitted; ``won`` is the
    evidence of the first parent.
    """
    best: dict[frozenset[str], Candidate] = {}
    size = len(parents[0].problem.effects) + 1
    for parent in parents:
        known, behind = names_of(parent), parent.score - parents[0].score
        rest = tuple(one for one in available if one.name not in known and known | {one.name} not in best)
        top = max((child.gain for child in best.values()), default=0.0)
        near = _share(size) * (won + top) - won + behind
        for one in first_fits(parent, rest, KEEP, LEAST_Z, None, near if best else 0.0)[1]:
            best[names_of(one.fit)] = replace(one, gain=parents[0].score - one.fit.score)
    return to_the_end(parents[0], list(best.values()))


def _share(size: int) -> float:
    return WITHIN[min(size, len(WITHIN)) - 1]
