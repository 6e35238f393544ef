"""Search over ratio and thickness: the whole map first, then the best exactly, then alternatives."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError, out_of_range
from dummydesign.core.serialise import Serialised
from dummydesign.design.scoring.castings import Castings, Tolerances
from dummydesign.design.scoring.law_parameters import fit_presses, gamma1_score, parametric_score, rough_parametric
from dummydesign.design.scoring.press_simulation import (
    PadBatch,
    Sampling,
    SlabCurves,
    join_slabs,
    make_curves,
    steady_depth,
)
from dummydesign.design.scoring.score import Evaluation, evaluate, evaluated_gamma1
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Readings, readings_of
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, THICKNESS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin

if TYPE_CHECKING:
    from dummydesign.design.search.shape_family import Family

# What a calibration makes of a family of shapes.
Correct = Callable[["Family"], "Family"]


@dataclass(frozen=True, eq=False)
class SearchSpace:
    """Every combination of the steps of thickness and ratio, of one resin, for one set of targets.

    ``tolerances`` gives how well a pad of a shape, thickness and ratio is made; ``puck_error`` is the standard
    deviation of ln modulus that one puck leaves; thinner gel than ``least_film_mm`` does not level itself in time;
    ``allowed_mm`` are the ends of what may be searched in such a test.
    """

    resin: Resin
    targets: Targets
    thickness_mm: NDArray
    ratio: NDArray
    radius_mm: float
    castings: Castings
    tolerances: Callable[[PadShape, float, float], Tolerances]
    puck_error: float
    sampling: Sampling = field(default_factory=Sampling)
    pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM)
    base: str = "bonded"
    correct: Correct | None = None
    edge_radius_mm: float = 0.0
    least_film_mm: float = 0.0
    allowed_mm: tuple[float, float] = THICKNESS_MM

    @property
    def extent_mm(self) -> float:
        """Radius of the circle of the pad's area. [mm]"""
        return float(np.sqrt(self.pad_mm[0] * self.pad_mm[1] / np.pi))


ALTERNATIVES = 4
THICKNESS_STEP_MM = 0.5
REFINED, FITTED = 24, 6
# What a user may weigh differently: measured steady range, force range, aim, low forces.
OBJECTIVES = ("steady_state_range", "force_variation_range", "aim", "low_force_range")


def alternatives_to(candidates: list[DesignCandidate], best: DesignCandidate) -> tuple[DesignCandidate, ...]:
    """From all that were worked out exactly, those that no other beats, by falling total."""
    values = np.array([[getattr(c.evaluation, name)[c.index] for name in OBJECTIVES] for c in candidates])
    kept = [best]
    for index in sorted(range(len(candidates)), key=lambda i: -candidates[i].total):
        candidate = candidates[index]
        others = np.delete(values, index, axis=0)
        beaten = np.all(others >= values[index], axis=1) & np.any(others > values[index], axis=1)
        here = candidate.thickness_mm, candidate.ratio
        if candidate is not best and not beaten.any() and _far(here, [(one.thickness_mm, one.ratio) for one in kept]):
            kept.append(candidate)
    return tuple(kept[1 : ALTERNATIVES + 1])


def _far(here: tuple[float, float], others: Sequence[tuple[float, float]]) -> bool:
    """Whether a thickness and ratio differ from all others by more than 1 mm or 0.3 parts."""
    return all(abs(here[0] - thickness) > 1.0 or abs(here[1] - ratio) > 0.3 for thickness, ratio in others)


def pareto(score_map: ScoreMap, best: int) -> NDArray:
    """Feasible designs of the map that no other beats in every objective, the far ones from each other.

    From those with at least half of the best total, the highest is taken again and again, leaving out what
    lies within 1 mm and 0.3 parts of one already taken.
    """
    values = np.stack([getattr(score_map, name).ravel() for name in OBJECTIVES], axis=-1)
    total = score_map.total.ravel()
    able = np.nonzero(score_map.feasible.ravel() & (total >= 0.5 * total[best]))[0]
    order = able[np.argsort(-values[able].sum(axis=-1), kind="stable")]
    front: list[int] = []
    for index in order:
        if not np.all(values[front] >= values[index] - 1e-12, axis=-1).any():
            front.append(index)
    pads = list(product(score_map.thickness_mm, score_map.ratio))
    kept: list[int] = []
    for index in np.argsort(-total[front], kind="stable"):
        if _far(pads[front[index]], [pads[one] for one in (best, *kept)]):
            kept.append(front[index])
    return np.array(kept[:ALTERNATIVES], dtype=int)


@dataclass(frozen=True, eq=False)
class ScoreMap(Serialised):
    """Scores over thickness (T,) and ratio (R,): arrays (T, R); ``feasible`` reaches 10 N steady."""

    thickness_mm: NDArray
    ratio: NDArray
    total: NDArray
    steady_state_range: NDArray
    force_variation_range: NDArray
    aim: NDArray
    low_force_range: NDArray
    feasible: NDArray


@dataclass(frozen=True)
class DesignCandidate:
    """One design worked out exactly: its place in the evaluation, parameters, scores, and its shape in an answer."""

    thickness_mm: float
    ratio: float
    index: int
    evaluation: Evaluation
    parameters: Any = None
    parametric: float = 0.0
    total: float = 0.0
    shape: PadShape = field(default_factory=Slab)

    @property
    def alone(self) -> PadBatch:
        """The one design to press."""
        return self.evaluation.slabs.take(np.array([self.index]))

    @property
    def depth_mm(self) -> NDArray:
        """Steady depth in each condition; NaN out of reach. [mm]"""
        return self.evaluation.depth_mm[self.index]

    @property
    def limit_mm(self) -> float:
        """Depth to which the pad is designed. [mm]"""
        slabs = self.evaluation.slabs
        return float(slabs.curves.limit_mm[slabs.slab[self.index]])

    @property
    def readings(self) -> Readings:
        """Peaks, energies and steady depths of the one design."""
        return readings_of(self.evaluation, self.index)

    def steady_depth_mm(self, force_N: NDArray) -> NDArray:
        """Depth at steady forces after the slowest ramp; NaN out of reach. [mm]"""
        speed, sampling = self.evaluation.protocol.slow_mm_s, self.evaluation.sampling.coarse
        return np.asarray(steady_depth(self.alone, force_N, speed, sampling)[0])


def thickness_steps(low_mm: float, high_mm: float) -> NDArray:
    """Thicknesses in steps of 0.5 mm inside a range, both ends included; of one thickness that alone. [mm]"""
    for value in (low_mm, high_mm):
        if not (math.isfinite(value) and THICKNESS_MM[0] <= value <= THICKNESS_MM[1]):
            raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
    if low_mm == high_mm:
        return np.array([low_mm])
    first = math.ceil(low_mm / THICKNESS_STEP_MM - 1e-9)
    last = math.floor(high_mm / THICKNESS_STEP_MM + 1e-9)
    if last < first:
        advice = f"it holds no step of {THICKNESS_STEP_MM} mm"
        raise out_of_range("thickness range in mm", f"{low_mm:g}:{high_mm:g}", *THICKNESS_MM, advice)
    return np.arange(first, last + 1) * THICKNESS_STEP_MM


def make_slabs(curves: SlabCurves, slab: NDArray, resin: Resin, ratio: NDArray) -> PadBatch:
    """Designs with the central numbers of a resin."""
    known, back = np.unique(ratio, return_inverse=True)
    young, beta = resin.young_MPa(known)[back], resin.strengths(known)[back]
    return PadBatch(curves, slab, young, resin.tau_s, beta, resin.pressed_force)


def search(law: ForceLaw, space: SearchSpace) -> tuple[DesignCandidate, tuple[DesignCandidate, ...], ScoreMap]:
    """Score every thickness and ratio of one force law, in practical steps: best design, Pareto alternatives, map.

    Every combination is scored on a coarse time grid (the map); the best of it are worked out on a fine
    one, with the tissue's law fitted to their simulated presses. The map has no fitted
    parameters: there the parametric part is that of gamma1 alone.

    Raises
    ------
    NoAnswerError
        When no combination reaches the middle force of the test.
    """
    resin, targets, ratio, thickness = space.resin, space.targets, space.ratio, space.thickness_mm
    curves = make_curves(law, thickness, space.radius_mm, targets.limits.gel_compression)
    slab, column = (i.ravel() for i in np.indices((len(thickness), len(ratio))))
    slabs = make_slabs(curves, slab, resin, ratio[column])
    rough = evaluate(slabs, targets, space.sampling.coarse)
    total = rough.total(gamma1_score(evaluated_gamma1(rough, targets.power), targets))
    columns = (total, *(getattr(rough, name) for name in OBJECTIVES), rough.feasible)
    score_map = ScoreMap(thickness, ratio, *(values.reshape(len(thickness), len(ratio)) for values in columns))
    able = int(rough.feasible.sum())
    if not able:
        raise NoAnswerError(
            "no_feasible_design",
            f"no slab of {thickness[0]:g} to {thickness[-1]:g} mm and ratio {ratio[0]:g} to {ratio[-1]:g} of "
            f"{resin.name} reaches {targets.protocol.needed_N:g} N within its depth limit; allow stiffer ratios or "
            "thinner pads",
            quantity="pad",
        )
    ranked = np.argsort(-np.where(rough.feasible, total, -1.0), kind="stable")[: min(REFINED, able)]
    chosen = np.r_[ranked, np.setdiff1d(pareto(score_map, int(ranked[0])), ranked)]
    every = exact_candidates(slabs.take(chosen), ratio[column[chosen]], space)
    first = sorted(every[: len(ranked)], key=lambda candidate: -candidate.total)[:FITTED]
    candidates = list(with_parameters([*first, *every[len(ranked) :]], space))
    best = max(candidates, key=lambda candidate: candidate.total)
    return best, alternatives_to(candidates, best), score_map


def exact_candidates(slabs: PadBatch, ratio: NDArray, space: SearchSpace) -> list[DesignCandidate]:
    """Designs evaluated on the fine grid, in their order, with the parametric part of gamma1 alone."""
    exact = evaluate(slabs, space.targets, space.sampling, exact=True)
    parametric = rough_parametric(slabs, space.targets, space.sampling)
    columns = (slabs.thickness_mm, ratio, parametric, exact.total(parametric))
    return [
        DesignCandidate(thickness, at, index, exact, None, score, total)
        for index, (thickness, at, score, total) in enumerate(zip(*(one.tolist() for one in columns)))
    ]


def with_parameters(candidates: Sequence[DesignCandidate], space: SearchSpace) -> tuple[DesignCandidate, ...]:
    """Designs with the tissue's law fitted to their presses, and the total that goes with it, where it was not yet."""
    arms = space.targets.parameters.gamma_N_per_mm3
    lacking = [candidate for candidate in candidates if candidate.parameters is None] if arms else []
    if not lacking:
        return tuple(candidates)
    slabs, depth = join_slabs([one.alone for one in lacking]), np.stack([one.depth_mm for one in lacking])
    fits = fit_presses(slabs, space.targets, depth, space.sampling)
    scores = iter(zip(fits, parametric_score(fits, space.targets)))
    done = []
    for candidate in candidates:
        if candidate.parameters is None:
            fit, score = next(scores)
            total = candidate.evaluation.take(np.array([candidate.index])).total(np.array([score]))
            candidate = replace(candidate, parameters=fit, parametric=float(score), total=float(total[0]))
        done.append(candidate)
    return tuple(done)
