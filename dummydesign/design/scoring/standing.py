"""Which designs may stand for the person: what reads low comes after all that does not, whatever its score."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import FORCE_TOLERANCE, Ranges, Readings, levels

SAFE_SIDE = "safe-side"
NOT_ACCEPTABLE, ACCEPTABLE, ACCEPTABLE_AND_STEADY = 0, 1, 2


def standing(evaluation: Evaluation, targets: Targets) -> NDArray:
    """Standing of designs by their verdict as they are, shape (D,).

    2: nothing is below every subject's, every press is reached and the depths at the steady forces of the protocol lie
    between the subjects'; 1: the same without the last; 0: reads low, or poor. One subject makes no range, and one who
    is named is followed wherever among the others: all are 2. For the safe side those are 2 of whom no peak and no
    steady force is below any subject's, the others 0.
    """
    if len(targets.tissue.subjects) < 2 or targets.aim.startswith("subject:"):
        return np.full(len(evaluation.depth_mm), ACCEPTABLE_AND_STEADY)
    ranges, readings = ranges_of(targets), readings_of(evaluation)
    if targets.aim == SAFE_SIDE:
        met = safe_side_shortfall(ranges, readings) <= FORCE_TOLERANCE
        return np.where(met, ACCEPTABLE_AND_STEADY, NOT_ACCEPTABLE)
    acceptable = np.array([level in ("inside", "reads_high") for level in levels(ranges, readings)])
    wanted = np.searchsorted(ranges.steady_N, np.unique(ranges.force_N) - 1e-9)
    wanted = wanted[wanted < len(ranges.steady_N)]
    depth = readings.depth_mm[:, wanted]
    with np.errstate(invalid="ignore"):
        steady = ((depth >= ranges.stiff_mm[wanted]) & (depth <= ranges.soft_mm[wanted])).all(axis=-1)
    return np.where(acceptable, np.where(steady, ACCEPTABLE_AND_STEADY, ACCEPTABLE), NOT_ACCEPTABLE)


def safe_side_shortfall(ranges: Ranges, readings: Readings) -> NDArray:
    """How far the lowest peak or steady force of each pad is below that of the highest subject there, shape (n,).

    0 where none is below any subject's; a steady force is compared at the pad's depth, where a subject's goes with its
    power; infinite where a press is out of reach.
    """
    peak, depth = np.atleast_2d(readings.peak_N), np.atleast_2d(readings.depth_mm)
    by_peak = 1.0 - peak / ranges.peak_high_N
    by_steady = 1.0 - (ranges.stiff_mm / depth) ** ranges.power
    worst = np.maximum(by_peak.max(axis=-1), by_steady.max(axis=-1))
    return np.where(np.isfinite(worst), np.maximum(worst, 0.0), np.inf)


def ranges_of(targets: Targets) -> Ranges:
    """Peaks and energies of the outermost subjects in every press of a protocol, and their depths from 5 to 15 N."""
    conditions = targets.conditions
    grid_N = targets.protocol.steady_grid_N
    stiff, soft = targets.depth_range_mm(grid_N)
    return Ranges(
        np.array([condition.steady_force_N for condition in conditions]),
        np.array([condition.velocity_mm_s for condition in conditions]),
        np.array([condition.range.peak_low_N for condition in conditions]),
        np.array([condition.range.peak_high_N for condition in conditions]),
        np.array([condition.energy_mJ[0] for condition in conditions]),
        np.array([condition.energy_mJ[1] for condition in conditions]),
        grid_N,
        stiff,
        soft,
        len(targets.tissue.subjects),
        targets.power,
    )


def readings_of(evaluation: Evaluation) -> Readings:
    """Readings of all designs of an evaluation, shapes (D, c) and (D, g)."""
    return Readings(
        np.stack([press.peak_N for press in evaluation.presses], axis=-1),
        np.stack([press.energy_mJ for press in evaluation.presses], axis=-1),
        evaluation.steady_depth_mm,
    )
