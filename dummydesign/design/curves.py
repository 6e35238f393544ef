"""What a report draws of a suggestion, worked out once: its curves and what they are compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.request import Protocol
from dummydesign.design.scoring.presses import ForceLaw, make_curves, steady_depth
from dummydesign.design.search.slabs import THICKNESS_MM
from dummydesign.design.sensitivity import Reaction, ratio_error, reactions

if TYPE_CHECKING:
    from dummydesign.design.scoring.targets import Targets
    from dummydesign.design.search.slabs import Candidate
    from dummydesign.design.suggestion import Suggestion

THICKNESS_GRID_MM = np.linspace(*THICKNESS_MM, 55)


@dataclass(frozen=True)
class ForceGrids:
    """Steady forces at which curves are drawn. [N]

    ``pad`` for pads; ``extrapolated``, ``measured`` and ``aim`` for subjects and aim; ``relative`` for the ratio of
    both; ``exponent_at`` for exponents over thickness.
    """

    pad: NDArray
    extrapolated: NDArray
    measured: NDArray
    aim: NDArray
    relative: NDArray
    exponent_at: tuple[float, ...]


def force_grids(protocol: Protocol) -> ForceGrids:
    """Lay out the forces of a test."""
    low, high = protocol.forces_N[0], protocol.forces_N[-1]
    above = np.linspace(low + 0.025 * (high - low), high, 40) if high > low else np.zeros(0)
    return ForceGrids(
        np.r_[np.linspace(0.02 * low, low, 25), above],
        np.linspace(0.0, low, 21),
        np.linspace(low, high, 41 if high > low else 1),
        np.linspace(0.0, high, 61),
        np.geomspace(0.06 * low, high, 60),
        protocol.forces_N,
    )


@dataclass(frozen=True)
class SuggestionCurves:
    """Everything that is drawn of a suggestion; NaN where a force is out of reach.

    Attributes
    ----------
    forces_N : ForceGrids
        Forces at which the curves are taken.
    pad_depth_mm : ndarray, shape (n,)
        Depth of the recommended pad at ``forces_N.pad``.
    castings_mm : (stiffest, softest, unreached)
        Depths between which 95 % of its castings are at ``forces_N.pad``, and the share that does not reach each force.
    limit_mm : float
        Depth at which the gel bottoms out.
    pad_depth_at_needed_mm : float
        At the middle force of the test.
    other_depths_mm : tuple of ndarray, shape (n,)
        The same of each alternative.
    subjects_extrapolated_mm, subjects_measured_mm : (stiffest, softest)
        Depths of the subjects at ``forces_N.extrapolated`` and ``forces_N.measured``.
    aim_depth_mm : ndarray
        Depth of the aim at ``forces_N.aim``.
    relative_forces : tuple of ndarray or None
        Of each kind of shape: force over the aim's at the aim's depth at ``forces_N.relative``; None without a design.
    exponent : ndarray, shape (thickness, force)
        d ln F / d ln x at :data:`THICKNESS_GRID_MM` and ``forces_N.exponent_at``, ratio as recommended.
    exponent_here : tuple of float
        The same at the recommended thickness.
    ratio_error : float
        Largest error of the ratio by the weighing tolerance.
    reactions : tuple of Reaction
        What each uncertainty does to depth and peak.
    """

    forces_N: ForceGrids
    pad_depth_mm: NDArray
    castings_mm: tuple[NDArray, NDArray, NDArray]
    limit_mm: float
    pad_depth_at_needed_mm: float
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
    grids = force_grids(targets.protocol)
    depth, slabs = steady_curve(answer.best, grids), answer.best.evaluation.slabs
    exponent = exponent_over_thickness(answer, answer.law, grids)
    return SuggestionCurves(
        forces_N=grids,
        pad_depth_mm=depth,
        castings_mm=answer.castings.depth_band_mm(grids.pad),
        limit_mm=float(slabs.curves.limit_mm[slabs.slab[answer.best.index]]),
        pad_depth_at_needed_mm=float(np.interp(targets.protocol.needed_N, grids.pad, depth)),
        other_depths_mm=tuple(steady_curve(other.candidate, grids) for other in answer.alternatives),
        subjects_extrapolated_mm=targets.depth_range_mm(grids.extrapolated),
        subjects_measured_mm=targets.depth_range_mm(grids.measured),
        aim_depth_mm=targets.aim_depth_mm(grids.aim),
        relative_forces=tuple(
            None if item.candidate is None else relative_force(item.candidate, targets, grids) for item in answer.beside
        ),
        exponent=exponent,
        exponent_here=tuple(float(np.interp(here, THICKNESS_GRID_MM, column)) for column in exponent.T),
        ratio_error=ratio_error(answer),
        reactions=tuple(reactions(answer, answer.cast)),
    )


def steady_curve(candidate: Candidate, grids: ForceGrids) -> NDArray:
    """Depth of a design at ``grids.pad`` of steady force; NaN out of reach. [mm]"""
    evaluation = candidate.evaluation
    slabs = evaluation.slabs.take(np.array([candidate.index]))
    return steady_depth(slabs, grids.pad, evaluation.protocol.slow_mm_s, evaluation.sampling.coarse)[0]


def relative_force(candidate: Candidate, targets: Targets, grids: ForceGrids) -> NDArray:
    """Steady force of a design over the aim's, at the depths where the aim carries ``grids.relative``.

    Parameters
    ----------
    candidate : Candidate
    targets : Targets
        With the aim.
    grids : ForceGrids
        Of its test.
    """
    aim, depth = targets.aim_depth_mm(grids.relative), steady_curve(candidate, grids)
    known = np.isfinite(depth)
    ln_force = np.interp(
        np.log(aim), np.log(depth[known]), np.log(grids.pad[known]), left=np.nan, right=np.nan
    )
    return np.exp(ln_force) / grids.relative


def exponent_over_thickness(answer: Suggestion, law: ForceLaw, grids: ForceGrids) -> NDArray:
    """Local exponent d ln F / d ln x at ``grids.exponent_at``, ratio as recommended; (thickness, force).

    NaN at thicknesses that the law does not hold.

    Parameters
    ----------
    answer : Suggestion
        Resin, ratio and punch.
    law : ForceLaw
        In proportion with the thickness.
    grids : ForceGrids
        Of its test.
    """
    low, high = law.ratio_range
    held = (answer.radius_mm / THICKNESS_GRID_MM >= low) & (answer.radius_mm / THICKNESS_GRID_MM <= high)
    held[held] = np.asarray(law.depth_limit_mm(THICKNESS_GRID_MM[held], answer.radius_mm)) > 0.0
    curves = make_curves(law, THICKNESS_GRID_MM[held], answer.radius_mm)
    slab = np.arange(int(held.sum()))
    area = np.array(grids.exponent_at) / answer.resin.young_MPa(answer.best.ratio)
    depth = curves.depth_at(slab, np.broadcast_to(area, (len(slab), len(area))))
    exponent = np.full((len(held), len(area)), np.nan)
    exponent[held] = curves.slope_at(slab, depth) * depth / area
    return exponent
