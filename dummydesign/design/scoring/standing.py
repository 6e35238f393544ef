"""Which designs may stand for the person: what reads low counts half, whatever its score."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import STEADY_GRID_N, Targets
from dummydesign.design.scoring.verdict import Ranges, Readings, levels

NOT_ACCEPTABLE, ACCEPTABLE, ACCEPTABLE_AND_STEADY = 0, 1, 2
WORTH = (0.5, 0.8, 1.0)
"""What the merit of a design of each standing counts. A choice: a pad that reads low is recommended only where one that
does not has less than about half of its merit, and it is then not called acceptable."""


def standing(evaluation: Evaluation, targets: Targets) -> NDArray:
    """Standing of designs by their verdict as they are, shape (D,).

    2: nothing is below every subject's, every press is reached and the depths at the steady forces of the protocol lie
    between the subjects'; 1: the same without the last; 0: reads low, or poor. One subject makes no range: all are 2.
    """
    if len(targets.tissue.subjects) < 2:
        return np.full(len(evaluation.depth_mm), ACCEPTABLE_AND_STEADY)
    ranges, readings = ranges_of(targets), readings_of(evaluation)
    acceptable = np.array([level in ("inside", "reads_high") for level in levels(ranges, readings)])
    wanted = np.searchsorted(ranges.steady_N, np.unique(ranges.force_N) - 1e-9)
    wanted = wanted[wanted < len(ranges.steady_N)]
    depth = readings.depth_mm[:, wanted]
    with np.errstate(invalid="ignore"):
        steady = ((depth >= ranges.stiff_mm[wanted]) & (depth <= ranges.soft_mm[wanted])).all(axis=-1)
    return np.where(acceptable, np.where(steady, ACCEPTABLE_AND_STEADY, ACCEPTABLE), NOT_ACCEPTABLE)


def ranges_of(targets: Targets) -> Ranges:
    """Peaks and energies of the outermost subjects in every press of a protocol, and their depths from 5 to 15 N."""
    conditions = targets.conditions
    stiff, soft = targets.depth_range_mm(STEADY_GRID_N)
    return Ranges(
        np.array([condition.steady_force_N for condition in conditions]),
        np.array([condition.velocity_mm_s for condition in conditions]),
        np.array([condition.range.peak_low_N for condition in conditions]),
        np.array([condition.range.peak_high_N for condition in conditions]),
        np.array([condition.energy_mJ[0] for condition in conditions]),
        np.array([condition.energy_mJ[1] for condition in conditions]),
        STEADY_GRID_N,
        stiff,
        soft,
        len(targets.tissue.subjects),
    )


def readings_of(evaluation: Evaluation) -> Readings:
    """Readings of all designs of an evaluation, shapes (D, c) and (D, g)."""
    return Readings(
        np.stack([press.peak_N for press in evaluation.presses], axis=-1),
        np.stack([press.energy_mJ for press in evaluation.presses], axis=-1),
        evaluation.steady_depth_mm,
    )
