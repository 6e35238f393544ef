"""When an effect is accepted: evidence above the threshold, and better predictions of what was left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.judging.assessed import Stage, pad_errors
from dummydesign.loop.judging.left_out import Errors, errors
from dummydesign.loop.judging.verdict import Needed

NOTHING, LITTLE, MUCH = 0.002, 0.02, 0.3
"""Relative changes of a squared error that count as none on left-out conditions, as none on left-out pads, and as so
much that no law of growth that is a little off could make it."""


@dataclass(frozen=True)
class Found:
    """An accepted (or best) effect with the ranking it came from."""

    candidate: Candidate
    confounded_with: tuple[str, ...]
    family: tuple[str, ...]
    threshold: float
    heldout_N: float | None
    ranking: tuple[Candidate, ...]


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


def much_better(before: Errors, after: Errors) -> bool:
    """Whether left-out conditions are predicted better by much."""
    change = _change(before, after)
    return change is not None and change < -MUCH


def worth(gain: float, limit: Needed, before: Fit, after: Fit) -> bool:
    """Whether an effect has the evidence it needs, and where that is in doubt lowers the left-out error by much.

    Parameters
    ----------
    gain : float
        Its evidence.
    limit : Needed
        What is needed.
    before, after : Fit
        The models without and with it.
    """
    return gain >= limit.least and (gain >= limit.doubted or much_better(errors(before), errors(after)))


def at_bound(fit: Fit) -> bool:
    """Whether the size of an effect ended at the end of what is plausible: something else is being imitated."""
    for one in fit.active:
        size = one.effect.parameters[0]
        value, reach = one.values[size.name], 1e-3 * (size.high - size.low)
        if value != size.null and (value <= size.low + reach or value >= size.high - reach):
            return True
    return False


def _change(before: Errors, after: Errors) -> float | None:
    """Relative change of the squared error on what both could predict; None when there is nothing."""
    both = np.isfinite(after.heldout_by_trial_N) & np.isfinite(before.heldout_by_trial_N)
    if not both.any():
        return None
    old, new = ((e.heldout_by_trial_N[both] ** 2).sum() for e in (before, after))
    return float(new / old - 1.0)
