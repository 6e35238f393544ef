"""What the verdict on a design is worked out from: its readings, and those of its pours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.pour_yield import Pours, Tolerances, draw_pours
from dummydesign.design.scoring.presses import ForceLaw, Slabs, make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.standing import SAFE_SIDE, ranges_of, readings_of, safe_side_shortfall
from dummydesign.design.scoring.verdict import FORCE_TOLERANCE, Readings, Verdict, verdict
from dummydesign.resin.model.distribution import HALF_WIDTH

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.search.space import SearchSpace

POURS, NODES, SEED = 400, 41, 17
AT_LIMIT = 0.99


def reading_of(candidate: Candidate) -> Readings:
    """Readings of one design, shapes (c,) and (g,)."""
    every = readings_of(candidate.evaluation)
    return Readings(*(values[candidate.index] for values in vars(every).values()))


def spread_of(
    law: ForceLaw, candidate: Candidate, space: SearchSpace, tolerances: Tolerances, pours: int = POURS
) -> Readings:
    """Readings of pours of a design: weighing, thickness, what is not known of the resin, and the law's own error.

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    candidate : Candidate
    space : SearchSpace
    tolerances : Tolerances
    pours : int
        How many.
    """
    every, _ = draw_pours(space.resin, candidate.thickness_mm, candidate.ratio, tolerances, pours)
    depth = candidate.evaluation.depth_mm[candidate.index]
    known = depth[np.isfinite(depth)]
    off = np.zeros(pours)
    if len(known):
        error = float(np.max(law.relative_error(known, candidate.thickness_mm, space.radius_mm)))
        off = error / HALF_WIDTH * np.random.default_rng(SEED).standard_normal(pours)
    slabs = poured_slabs(law, replace(every, young_MPa=every.young_MPa * np.exp(off)), space)
    return readings_of(evaluate(slabs, space.targets, space.sampling.coarse))


def poured_slabs(law: ForceLaw, pours: Pours, space: SearchSpace) -> Slabs:
    """Pours as designs to press; their thicknesses are taken at the nearest of 41 even steps.

    These are a hundredth of a millimetre apart for 0.2 mm either way.

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    pours : Pours
    space : SearchSpace
    """
    smallest, largest = law.ratio_range
    thickness = np.clip(pours.thickness_mm, space.radius_mm / largest, space.radius_mm / smallest)
    low, high = float(thickness.min()), float(thickness.max())
    nodes = np.linspace(low, high, NODES) if high > low else np.array([low])
    place = np.rint((thickness - low) / max(high - low, 1e-12) * (len(nodes) - 1)).astype(int)
    tau = tuple(arm.tau_s.value for arm in space.resin.arms)
    return Slabs(make_curves(law, nodes, space.radius_mm), place, pours.young_MPa, tau, pours.beta)


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


def verdict_of_design(law: ForceLaw, candidate: Candidate, space: SearchSpace, tolerances: Tolerances) -> Verdict:
    """Verdict on a design: as it stands, with what its pours may turn out as, and the limits that bind it.

    Parameters
    ----------
    law : ForceLaw
        Of the pad as cast.
    candidate : Candidate
    space : SearchSpace
        What was searched.
    tolerances : Tolerances
        Of weighing and thickness.
    """
    ranges, reading = ranges_of(space.targets), reading_of(candidate)
    bound = limits_that_bind(candidate, space.thickness_mm, space.ratio)
    found = verdict(ranges, reading, spread_of(law, candidate, space, tolerances), bound)
    if space.targets.aim != SAFE_SIDE:
        return found
    short = 100.0 * float(safe_side_shortfall(ranges, reading)[0])
    if short <= 100.0 * FORCE_TOLERANCE:
        words = "the safe side is kept: no peak and no steady force is below any subject's"
    elif np.isfinite(short):
        words = f"the safe side is missed: a peak or steady force is up to {short:.0f} % below the highest subject's"
    else:
        words = "the safe side is missed: a press is out of reach"
    value = short if np.isfinite(short) else None
    return replace(found, text=f"{found.text}; {words}", safe_side_shortfall_percent=value)
