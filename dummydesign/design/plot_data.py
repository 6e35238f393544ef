"""What a report draws of a suggestion: its curves, and how it reacts to what is not exact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.request import Protocol
from dummydesign.design.scoring.presses import Curves, Slabs, make_curves, press_to_depth, steady_depth
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from dummydesign.design.scoring.targets import Targets
    from dummydesign.design.search.slabs import DesignCandidate
    from dummydesign.design.suggestion import Suggestion


def ratio_error(answer: Suggestion) -> float:
    """Largest error of the ratio when both components are weighed off by the tolerance, in opposite ways."""
    masses = {item["name"]: item["mass_g"] for item in answer.recommended.batch["components"]}
    by_ratio = next(liquid.name for liquid in answer.resin.liquids if liquid.parts is None)
    varied = masses.get(by_ratio, 0.0)
    rest = sum(mass for name, mass in masses.items() if name != by_ratio)
    error = answer.request.weighing_g
    if varied <= 0.0 or rest <= 0.0:
        return 0.0
    return float(answer.best.ratio * ((1.0 + error / varied) / (1.0 - error / rest) - 1.0))


@dataclass(frozen=True)
class Reaction:
    """Change in per cent of depth (middle force, slow) and peak (middle force, fast) between both ends."""

    name: str
    depth_percent: tuple[float, float]
    peak_percent: tuple[float, float]


def reactions(answer: Suggestion, law: ForceLaw) -> list[Reaction]:
    """How depth and peak of the recommended pad react to each thing that is not exact, one at a time."""
    resin, best, tolerance = answer.resin, answer.best, answer.request.thickness_tolerance_mm
    ratio, thickness, young = best.ratio, best.thickness_mm, resin.young_MPa(best.ratio)
    beta, radius = np.array([term.beta for term in resin.prony(ratio)]), answer.radius_mm
    ends = [np.array([getattr(arm.beta, end) / arm.beta.value for arm in resin.arms]) for end in ("low", "high")]
    smallest, largest = law.ratio_range
    thin = np.clip([thickness - tolerance, thickness + tolerance], radius / largest, radius / smallest)
    curves = make_curves(law, [thickness, *thin], radius)
    off = ratio_error(answer)
    lean, rich = (min(max(ratio + sign * off, resin.ratio_min), resin.ratio_max) for sign in (-1, 1))
    modulus = resin.modulus_kPa(ratio)
    nominal = _measure(curves, 0, young, beta, answer)
    cases = {
        f"thickness ± {tolerance:g} mm": [(1, young, beta), (2, young, beta)],
        f"weighing ± {answer.request.weighing_g:g} g": [
            (0, resin.young_MPa(value), np.array([term.beta for term in resin.prony(value)])) for value in (lean, rich)
        ],
        "modulus, 95 %": [(0, 1e-3 * modulus.low, beta), (0, 1e-3 * modulus.high, beta)],
        "relaxation, 95 %": [(0, young, beta * end) for end in ends],
    }
    found = []
    for name, pair in cases.items():
        change = np.array([100.0 * (_measure(curves, *case, answer) / nominal - 1.0) for case in pair])
        # an end at which the force cannot be reached has no number: the bar then ends at no change, with a note
        name += "" if np.isfinite(change).all() else " *"
        low, high = np.fmin.reduce([*change, 0 * nominal]), np.fmax.reduce([*change, 0 * nominal])
        found.append(Reaction(name, (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))))
    return found


def _measure(curves: Curves, slab: int, young_MPa: float, beta: NDArray, answer: Suggestion) -> NDArray:
    """Depth at the middle steady force when slow, and peak at it when fast."""
    tau = tuple(arm.tau_s.value for arm in answer.resin.arms)
    protocol, sampling = answer.targets.protocol, answer.targets.sampling
    slabs = Slabs(curves, np.array([slab]), np.array([young_MPa]), tau, beta[None, :])
    speeds = protocol.slow_mm_s, protocol.fast_mm_s
    slow, fast = (steady_depth(slabs, protocol.needed_N, velocity, sampling.coarse) for velocity in speeds)
    return np.array([slow[0], press_to_depth(slabs, fast, speeds[1], sampling.coarse).peak_N[0]])


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
    """Everything that is drawn of a suggestion; NaN where a force is out of reach."""

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


def steady_curve(candidate: DesignCandidate, grids: ForceGrids) -> NDArray:
    """Depth of a design at ``grids.pad`` of steady force; NaN out of reach. [mm]"""
    evaluation = candidate.evaluation
    slabs = evaluation.slabs.take(np.array([candidate.index]))
    return steady_depth(slabs, grids.pad, evaluation.protocol.slow_mm_s, evaluation.sampling.coarse)[0]


def relative_force(candidate: DesignCandidate, targets: Targets, grids: ForceGrids) -> NDArray:
    """Steady force of a design over the aim's, at the depths where the aim carries ``grids.relative``."""
    aim, depth = targets.aim_depth_mm(grids.relative), steady_curve(candidate, grids)
    known = np.isfinite(depth)
    ln_force = np.interp(
        np.log(aim), np.log(depth[known]), np.log(grids.pad[known]), left=np.nan, right=np.nan
    )
    return np.exp(ln_force) / grids.relative


def exponent_over_thickness(answer: Suggestion, law: ForceLaw, grids: ForceGrids) -> NDArray:
    """Local exponent d ln F / d ln x at ``grids.exponent_at``, ratio as recommended; (thickness, force).

    NaN at thicknesses that the law does not hold.
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
