"""Which designs may stand for the person at all, before any score: those that never read low come first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import STEADY_GRID_N, Targets
from dummydesign.design.scoring.verdict import Ranges, Readings, levels

NOT_ACCEPTABLE, ACCEPTABLE, ACCEPTABLE_AND_STEADY = 0, 1, 2


def standing(evaluation: Evaluation, targets: Targets) -> NDArray:
    """Rank of designs by their verdict on peaks and steady forces, shape (D,).

    2: nothing is below every subject's, every press is reached and the depths at the steady forces of the protocol lie
    between the subjects'; 1: the same without the last; 0: reads low, or poor.

    Energies are left out: the ranges of the subjects' are worked out for the verdict on the chosen pad alone.
    """
    conditions = targets.conditions
    force = np.array([condition.steady_force_N for condition in conditions])
    nothing = np.full(len(conditions), np.nan)
    stiff, soft = targets.depth_range_mm(STEADY_GRID_N)
    ranges = Ranges(
        force,
        np.array([condition.velocity_mm_s for condition in conditions]),
        np.array([condition.range.peak_low_N for condition in conditions]),
        np.array([condition.range.peak_high_N for condition in conditions]),
        nothing,
        nothing,
        STEADY_GRID_N,
        stiff,
        soft,
        len(targets.tissue.subjects),
    )
    peak = np.stack([press.peak_N for press in evaluation.presses], axis=-1)
    found = levels(ranges, Readings(peak, np.full(peak.shape, np.nan), evaluation.steady_depth_mm))
    acceptable = np.array([level in ("inside", "reads_high") for level in found])
    wanted = np.searchsorted(STEADY_GRID_N, np.unique(force) - 1e-9)
    wanted = wanted[wanted < len(STEADY_GRID_N)]
    depth = evaluation.steady_depth_mm[:, wanted]
    with np.errstate(invalid="ignore"):
        steady = ((depth >= stiff[wanted]) & (depth <= soft[wanted])).all(axis=-1)
    return np.where(acceptable, np.where(steady, ACCEPTABLE_AND_STEADY, ACCEPTABLE), NOT_ACCEPTABLE)


