"""What the verdict on a design is worked out from: its readings, and those of its castings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import RESIN, PadCastings
from dummydesign.design.scoring.acceptability import ranges_of, readings_of, strict_aim
from dummydesign.design.scoring.deviations import Readings
from dummydesign.design.scoring.verdict import Verdict, verdict

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate

AT_LIMIT = 0.99


def reading_of(candidate: Candidate) -> Readings:
    """Readings of one design, shapes (c,) and (g,)."""
    every = readings_of(candidate.evaluation)
    return Readings(*(values[candidate.index] for values in vars(every).values()))


def limits_that_bind(candidate: Candidate, thickness_mm: NDArray, ratio: NDArray) -> tuple[str, ...]:
    """Which limits a design lies at: depth over thickness, and the ends of what was searched.

    Parameters
    ----------
    candidate : Candidate
    thickness_mm, ratio : ndarray, shapes (T,) and (R,)
        What was searched. [mm, resin's ratio]
    """
    depth = candidate.evaluation.depth_mm[candidate.index]
    slabs = candidate.evaluation.slabs
    limit = float(slabs.curves.limit_mm[slabs.slab[candidate.index]])
    bound = []
    if not np.isfinite(depth).all() or np.nanmax(depth) >= AT_LIMIT * limit:
        bound.append(f"depth over thickness (at most {limit / candidate.thickness_mm:.2f})")
    for name, value, steps, unit in (
        ("thickness", candidate.thickness_mm, thickness_mm, " mm"),
        ("ratio", candidate.ratio, ratio, ""),
    ):
        if len(steps) > 1 and value in (steps[0], steps[-1]):
            bound.append(f"{name} ({steps[0]:g} to {steps[-1]:g}{unit})")
    return tuple(bound)


def verdict_of_design(cast: PadCastings, beyond: float = 1.0) -> Verdict:
    """Verdict on a design: at central estimates, over its castings, and with the limits that bind it.

    Parameters
    ----------
    cast : PadCastings
    beyond : float
        Largest steady force of the test over the hardest press of people.
    """
    space, candidate = cast.space, cast.candidate
    bound = limits_that_bind(candidate, space.thickness_mm, space.ratio)
    return verdict(
        ranges_of(space.targets), reading_of(candidate), cast.readings(), bound,
        strict=strict_aim(space.targets), measured=cast.readings(RESIN), limits=space.targets.limits,
        beyond=beyond,
    )  # fmt: skip
