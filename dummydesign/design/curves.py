"""What a report draws of a suggestion, worked out once: its curves and what they are compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.request import RADIUS_MM
from dummydesign.design.scoring.presses import ForceLaw, make_curves, steady_depth
from dummydesign.design.search.slabs import THICKNESS_MM
from dummydesign.design.sensitivity import SLOW_MM_S, Reaction, ratio_error, reactions

if TYPE_CHECKING:
    from dummydesign.design.scoring.targets import Targets
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.suggestion import Suggestion

FORCE_GRID_N = np.r_[np.linspace(0.1, 5.0, 25), np.linspace(5.25, 15.0, 40)]
EXTRAPOLATED_N, MEASURED_N, AIM_N = np.linspace(0.0, 5.0, 21), np.linspace(5.0, 15.0, 41), np.linspace(0.0, 15.0, 61)
RELATIVE_N = np.geomspace(0.3, 15.0, 60)
THICKNESS_GRID_MM = np.linspace(*THICKNESS_MM, 55)
EXPONENT_AT_N = (5.0, 10.0, 15.0)


@dataclass(frozen=True)
class SuggestionCurves:
    """Everything that is drawn of a suggestion; NaN where a force is out of reach.

    Attributes
    ----------
    pad_depth_mm : ndarray, shape (n,)
        Depth of the recommended pad at :data:`FORCE_GRID_N`.
    pad_depth_at_10N_mm : float
    other_depths_mm : tuple of ndarray, shape (n,)
        The same of each alternative.
    subjects_extrapolated_mm, subjects_measured_mm : (stiffest, softest)
        Depths of the subjects at :data:`EXTRAPOLATED_N` and :data:`MEASURED_N`.
    aim_depth_mm : ndarray
        Depth of the aim at :data:`AIM_N`.
    relative_forces : tuple of ndarray or None
        Of each kind of shape: force over the aim's at the aim's depth at :data:`RELATIVE_N`; None without a design.
    exponent : ndarray, shape (thickness, force)
        d ln F / d ln x at :data:`THICKNESS_GRID_MM` and :data:`EXPONENT_AT_N`, ratio as recommended.
    exponent_here : tuple of float
        The same at the recommended thickness.
    ratio_error : float
        Largest error of the ratio by the weighing tolerance.
    reactions : tuple of Reaction
        What each uncertainty does to depth and peak.
    """

    pad_depth_mm: NDArray
    pad_depth_at_10N_mm: float
    other_depths_mm: tuple[NDArray, ...]
    subjects_extrapolated_mm: tuple[NDArray, NDArray]
    subjects_measured_mm: tuple[NDArray, NDArray]
    aim_depth_mm: NDArray
    relative_forces: tuple[NDArray | None, ...]
    exponent: NDArray
    exponent_here: tuple[float, ...]
    ratio_error: float
    reactions: tuple[Reaction, ...]


def suggestion_curves(answer: Suggestion) -> SuggestionCurves:
    """Work out what a report draws of a suggestion."""
    targets, here = answer.targets, answer.best.thickness_mm
    depth = steady_curve(answer.best)
    exponent = exponent_over_thickness(answer, answer.law)
    return SuggestionCurves(
        pad_depth_mm=depth,
        pad_depth_at_10N_mm=float(np.interp(10.0, FORCE_GRID_N, depth)),
        other_depths_mm=tuple(steady_curve(other.candidate) for other in answer.alternatives),
        subjects_extrapolated_mm=targets.depth_range_mm(EXTRAPOLATED_N),
        subjects_measured_mm=targets.depth_range_mm(MEASURED_N),
        aim_depth_mm=targets.aim_depth_mm(AIM_N),
        relative_forces=tuple(
            None if item.candidate is None else relative_force(item.candidate, targets) for item in answer.beside
        ),
        exponent=exponent,
        exponent_here=tuple(float(np.interp(here, THICKNESS_GRID_MM, column)) for column in exponent.T),
        ratio_error=ratio_error(answer),
        reactions=tuple(reactions(answer, answer.cast)),
    )


def steady_curve(candidate: Candidate) -> NDArray:
    """Depth of a design at :data:`FORCE_GRID_N` of steady force; NaN out of reach. [mm]"""
    slabs = candidate.evaluation.slabs.take(np.array([candidate.index]))
    return steady_depth(slabs, FORCE_GRID_N, SLOW_MM_S)[0]


def relative_force(candidate: Candidate, targets: Targets) -> NDArray:
    """Steady force of a design over the aim's, at the depths where the aim carries :data:`RELATIVE_N`."""
    aim, depth = targets.aim_depth_mm(RELATIVE_N), steady_curve(candidate)
    known = np.isfinite(depth)
    ln_force = np.interp(
        np.log(aim), np.log(depth[known]), np.log(FORCE_GRID_N[known]), left=np.nan, right=np.nan
    )
    return np.exp(ln_force) / RELATIVE_N


def exponent_over_thickness(answer: Suggestion, law: ForceLaw) -> NDArray:
    """Local exponent d ln F / d ln x at :data:`EXPONENT_AT_N`, ratio as recommended; (thickness, force).

    NaN at thicknesses that the law does not hold.
    """
    held = np.asarray(law.depth_limit_mm(THICKNESS_GRID_MM, RADIUS_MM)) > 0.0
    curves = make_curves(law, THICKNESS_GRID_MM[held], RADIUS_MM)
    slab = np.arange(int(held.sum()))
    area = np.array(EXPONENT_AT_N) / answer.resin.young_MPa(answer.best.ratio)
    depth = curves.depth_at(slab, np.broadcast_to(area, (len(slab), len(area))))
    exponent = np.full((len(held), len(area)), np.nan)
    exponent[held] = curves.slope_at(slab, depth) * depth / area
    return exponent
