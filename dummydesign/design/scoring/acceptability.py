"""Which designs may be cast by their central estimates, and what designs and subjects do in the presses of a test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.deviations import Ranges, Readings, deviations
from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import representative

SAFE_SIDE = "safe-side"
NOT_ACCEPTABLE, BORDERLINE, ACCEPTABLE = 0, 1, 2


def acceptability_rank(evaluation: Evaluation, targets: Targets, tighter: bool = False) -> NDArray:
    """Rank designs by their verdict at central estimates, shape (D,).

    2 may be cast; 1 as well, but is beyond a limit by less than the limits' tie; 0 is not representative.

    Parameters
    ----------
    evaluation : Evaluation
    targets : Targets
    tighter : bool
        Take the limits tighter by their tie: what then has 1 is tied with what is just beyond a limit.
    """
    strict = strict_aim(targets)
    found = deviations(ranges_of(targets), readings_of(evaluation), strict)
    slack = -targets.limits.tie if tighter else 0.0
    kept, near = (representative(found, targets.limits, strict, one) for one in (slack, None))
    return np.where(kept, ACCEPTABLE, np.where(near, BORDERLINE, NOT_ACCEPTABLE))


def strict_aim(targets: Targets) -> bool:
    """Whether nothing may be below any subject: the aim safe-side."""
    return targets.aim.lower() == SAFE_SIDE


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
