"""Whether a corrected model predicts presses it has not seen worse than the base model, by fits without them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import CampaignFit
from dummydesign.loop.selection.cross_validation import AssessedModel
from dummydesign.loop.selection.nonparametric_effect import refitted_squares, squares_without

WORSE = 1.02
"""Squared error over the base's beyond which the base predicts better; up to it the two are the same."""
CLEAR = 0.5
"""Squared left-out error over the base's, both by a linear step, below which no refit is needed to compare them."""
PADS = "other pads"
NEAR_END = 0.8  # share of the largest depth of a pad, or speed, beyond which a press lies beyond the others


@dataclass(frozen=True)
class LeftOut:
    """Root mean square errors of one kind of left-out presses. [N]"""

    kind: str
    base_N: float
    corrected_N: float


def left_out_errors(base: AssessedModel, corrected: AssessedModel) -> tuple[LeftOut, ...]:
    """Errors of both models on other conditions, and on deeper and faster presses than those that they are fitted to.

    Where these are worse together, errors on whole pads left out come last, or on a single pad without its law error.
    Kinds that a campaign does not have are missing.
    """
    models = base.fit, corrected.fit
    rows = []
    before, after = base.errors.heldout_N, corrected.errors.heldout_N
    if before is not None and after is not None:
        if after**2 >= CLEAR * before**2:
            before, after = (float(np.sqrt(refitted_squares(one))) for one in models)
        rows.append(LeftOut("other conditions", before, after))
    for kind, out in (("deeper presses", deepest(base.fit)), ("faster presses", fastest(base.fit))):
        if out.any():
            rows.append(LeftOut(kind, *(_error_N(one, [out]) for one in models)))
    pad = base.fit.problem.presses.pad
    if predicts_worse(tuple(rows)) and len(np.unique(pad)) > 1:
        # what acts as one factor per pad shows on pads that were left out with their law error
        rows.append(LeftOut(PADS, *(_error_N(one, [pad == number for number in np.unique(pad)]) for one in models)))
    elif predicts_worse(tuple(rows)) and not any(one.held for one in corrected.fit.problem.effects):
        # a base that predicts by a law far from the stated one is no better; a learned curve would imitate any law
        rows.append(LeftOut(PADS, *(float(one.by_pad.heldout_N or np.nan) for one in (base, corrected))))
    return tuple(rows)


def predicts_worse(rows: tuple[LeftOut, ...]) -> bool:
    """Whether the corrected model predicts presses worse than the base, and pads that were left out not better."""
    pads = [one for one in rows if one.kind == PADS]
    kinds = [one for one in rows if one.kind != PADS]
    base, corrected = (sum(getattr(one, name) ** 2 for one in kinds) for name in ("base_N", "corrected_N"))
    return bool(corrected > WORSE * base) and not any(one.corrected_N < one.base_N for one in pads)


def deepest(fit: CampaignFit) -> NDArray:
    """The presses of each pad beyond the others in depth (T,); none where a pad would keep less than two."""
    presses = fit.problem.presses
    most = np.array([presses.depth_mm[presses.pad == pad].max() for pad in presses.pad])
    return _sparing(presses.pad, presses.depth_mm > NEAR_END * most)


def fastest(fit: CampaignFit) -> NDArray:
    """The presses beyond the others in speed (T,); none where a pad or the arms would not be known without them."""
    presses = fit.problem.presses
    return _sparing(presses.pad, presses.velocity_mm_s > NEAR_END * presses.velocity_mm_s.max())


def _sparing(pads: NDArray, out: NDArray) -> NDArray:
    """Presses to leave out (T,); none where a pad would keep less than two."""
    left = [int((~out)[pads == pad].sum()) for pad in np.unique(pads)]
    return out if min(left) > 1 else np.zeros_like(out)


def _error_N(fit: CampaignFit, parts: list[NDArray]) -> float:
    """Error on parts of the presses, each predicted by a fit without it. [N]"""
    return float(np.sqrt(np.divide(*squares_without(fit, parts))))
