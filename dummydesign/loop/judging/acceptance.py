"""When an effect is accepted: evidence above the threshold, and better predictions of what was left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.screening import Screened
from dummydesign.loop.judging.assessed import Stage, pad_errors
from dummydesign.loop.judging.lack_of_fit import lack_of_fit
from dummydesign.loop.judging.left_out import Errors, errors
from dummydesign.loop.judging.verdict import family_of, gain_threshold, rivals

NOTHING, LITTLE = 0.002, 0.02
"""Relative changes of a squared error that count as none on left-out conditions, and on left-out pads."""


@dataclass(frozen=True)
class Found:
    """An accepted (or best) effect with the ranking it came from."""

    candidate: Candidate
    confounded_with: tuple[str, ...]
    family: tuple[str, ...]
    threshold: float
    heldout_N: float | None
    ranking: tuple[Candidate, ...]


def accept(
    before: Stage, screened: list[Screened], ranking: list[Candidate], floor: float, least: float = 0.0
) -> Found | None:
    """The first candidate that beats the threshold inside its bounds and predicts left-out conditions better.

    Rivals that cannot be told from it may stand in for it there: which of them predicts best is chance.

    Parameters
    ----------
    before : Stage
        The accepted model so far.
    screened : list of Screened
        Scores of all effects.
    ranking : list of Candidate
        Fitted effects, best first.
    floor : float
        Least gain that ever counts, in the score (minus two ln likelihood).
    least : float
        A further lower limit of the gain.

    Returns
    -------
    Found or None
        None when no candidate is accepted.
    """
    inside = [candidate for candidate in ranking if not at_bound(candidate)]
    for candidate in inside[:4]:
        ratio = lack_of_fit(candidate.fit).ratio
        threshold = max(gain_threshold(screened, ratio, floor), least)
        if candidate.gain < threshold:
            return None
        near = [c for c in rivals(inside, candidate, ratio) if c.gain <= candidate.gain]
        if not any(predicts_better(before, c.fit) for c in (candidate, *near)):
            continue
        return Found(
            candidate, tuple(c.effect.name for c in rivals(ranking, candidate, ratio)[:2]),
            tuple(family_of(candidate.screened, screened)), threshold, errors(candidate.fit).heldout_N,
            (candidate, *(c for c in inside if c is not candidate)),
        )  # fmt: skip
    return None


def predicts_better(before: Stage, after: Fit) -> bool:
    """Whether left-out conditions are predicted better.

    What acts as one factor per pad is absorbed by the law error of that pad, so that other conditions on the
    same pad are predicted as well without the effect. Then whole pads, left out with their law error, decide.
    """
    cells = _change(before.errors, errors(after))
    if cells is not None and cells < -NOTHING:
        return True
    pads = _change(before.by_pad, pad_errors(after))
    return (cells is None or cells < LITTLE) and pads is not None and pads < -LITTLE


def at_bound(candidate: Candidate) -> bool:
    """Whether the size ended at the end of what is plausible: something else is being imitated."""
    size = candidate.effect.parameters[0]
    place = candidate.fit.problem.fixed - len(candidate.effect.parameters)
    value = size.to_value(candidate.fit.vector[place])
    reach = 1e-3 * (size.high - size.low)
    return value != size.null and (value <= size.low + reach or value >= size.high - reach)


def _change(before: Errors, after: Errors) -> float | None:
    """Relative change of the squared error on what both could predict; None when there is nothing."""
    both = np.isfinite(after.heldout_by_trial_N) & np.isfinite(before.heldout_by_trial_N)
    if not both.any():
        return None
    old, new = ((e.heldout_by_trial_N[both] ** 2).sum() for e in (before, after))
    return float(new / old - 1.0)
