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
from dummydesign.design.scoring.law_parameters import fit_presses, gamma1_score, parametric_score, rough_parametric
from dummydesign.design.scoring.presses import (
    Curves,
    Sampling,
    Slabs,
    join_curves,
    join_slabs,
    make_curves,
    steady_depth,
)
from dummydesign.design.scoring.score import Evaluation, evaluate, evaluated_gamma1
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Readings, acceptability_rank, readings_of
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, THICKNESS_MM
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin

if TYPE_CHECKING:
    from dummydesign.design.search.shape_family import Family

# What a calibration makes of a family of shapes.
Correct = Callable[["Family"], "Family"]


@dataclass(frozen=True)
class SearchSpace:
    """Every combination of the steps of thickness and ratio, of one resin, for one set of targets."""

    resin: Resin
    targets: Targets
    thickness_mm: NDArray
    ratio: NDArray
    radius_mm: float
    sampling: Sampling = field(default_factory=Sampling)
    pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM)
    base: str = "bonded"
    correct: Correct | None = None
    edge_radius_mm: float = 0.0

    @property
    def extent_mm(self) -> float:
        """Radius of the circle of the pad's area. [mm]"""
        return float(np.sqrt(self.pad_mm[0] * self.pad_mm[1] / np.pi))


QUANTILES = (np.arange(9) + 0.5) / 9.0
DRAWS, ALTERNATIVES = 400, 4
THICKNESS_STEP_MM = 0.5
REFINED, FITTED = 24, 6
# What a user may weigh differently: measured steady range, force range, aim, low forces.
OBJECTIVES = ("steady_state_range", "force_variation_range", "aim", "low_force_range")


def averaging(resin: Resin, ratio: NDArray) -> NDArray:
    """Weights (R, R) of the ratios whose modulus the castings of each ratio may have; every row sums to 1.

    Moduli beyond the ends count at the ends.
    """
    count = len(ratio)
    if count < 2:
        return np.eye(count)
    drawn = resin.draw(DRAWS)
    moduli = np.array([np.log(np.maximum(drawn.young_MPa(value), 1e-12)) for value in ratio])
    spread = np.quantile(moduli, QUANTILES, axis=1).T
    central = np.log(resin.young_MPa(ratio))
    # the draws' median may lie off the central law: what counts here is their spread about it
    spread += (central - np.median(moduli, axis=1))[:, None]
    order = np.argsort(central)
    position = np.interp(spread, central[order], np.arange(count)[order].astype(float))
    left = np.minimum(position.astype(int), count - 2)
    share = position - left
    weights = np.zeros((count, count))
    rows = np.arange(count)[:, None]
    np.add.at(weights, (rows, left), (1.0 - share) / len(QUANTILES))
    np.add.at(weights, (rows, left + 1), share / len(QUANTILES))
    return weights


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


@dataclass(frozen=True)
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
    """One design worked out exactly: its place in the evaluation, parameters and scores."""

    thickness_mm: float
    ratio: float
    index: int
    evaluation: Evaluation
    parameters: Any = None
    parametric: float = 0.0
    total: float = 0.0
    # Whether it may be cast, by its verdict; what its castings are expected to lose of the merit.
    rank: int = 0
    loss: float = 0.0

    @property
    def alone(self) -> Slabs:
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

    def merit(self, low_share: float | None = None) -> float:
        """By what designs are ranked: the total, with a share (by default the weights') of the closeness below 5 N."""
        share = self.evaluation.weights.low_aim if low_share is None else low_share
        return (1.0 - share) * self.total + share * float(self.evaluation.low_aim[self.index])

    def worth(self, low_share: float | None = None) -> float:
        """By what designs are searched: the merit expected of castings, almost nothing where not representative."""
        return self.evaluation.weights.worth[self.rank] * max(self.merit(low_share) - self.loss, 0.0)


@dataclass(frozen=True)
class SearchResult:
    """What a search found: best design, Pareto alternatives, and the map."""

    best: DesignCandidate
    alternatives: tuple[DesignCandidate, ...]
    score_map: ScoreMap


def thickness_steps(low_mm: float, high_mm: float) -> NDArray:
    """Thicknesses in steps of 0.5 mm inside a range, both ends included. [mm]"""
    for value in (low_mm, high_mm):
        if not (math.isfinite(value) and THICKNESS_MM[0] <= value <= THICKNESS_MM[1]):
            raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
    first = math.ceil(low_mm / THICKNESS_STEP_MM - 1e-9)
    last = math.floor(high_mm / THICKNESS_STEP_MM + 1e-9)
    if last < first:
        advice = f"it holds no step of {THICKNESS_STEP_MM} mm"
        raise out_of_range("thickness range in mm", f"{low_mm:g}:{high_mm:g}", *THICKNESS_MM, advice)
    return np.arange(first, last + 1) * THICKNESS_STEP_MM


def make_slabs(curves: Curves, slab: NDArray, resin: Resin, ratio: NDArray) -> Slabs:
    """Designs with the central numbers of a resin."""
    known, back = np.unique(ratio, return_inverse=True)
    return Slabs(curves, slab, resin.young_MPa(known)[back], resin.tau_s, resin.strengths(known)[back])


def search(
    law: ForceLaw, space: SearchSpace, low_share: float = 0.0, refined: int = REFINED, fitted: int = FITTED
) -> SearchResult:
    """Find the slab and ratio that score best, in practical steps.

    Every combination is scored on a coarse time grid (the map); the best of it are worked out on a fine
    one, with the tissue's law fitted to their simulated presses, and ranked again. The map has no fitted
    parameters: there the parametric part is that of gamma1 alone.
    """
    result = search_each([(law, space.thickness_mm)], space, low_share, refined, fitted)[0]
    if isinstance(result, NoAnswerError):
        raise result
    return result


def search_each(
    laws: Sequence[tuple[ForceLaw, NDArray]], space: SearchSpace, low_share: float = 0.0, refined: int = REFINED,
    fitted: int = FITTED, others: bool = True,
) -> list[SearchResult | NoAnswerError]:  # fmt: skip
    """Make the search of :func:`search` for several force laws, each on thicknesses of its own, all designs at once.
    """
    if not laws:
        return []
    resin, targets, ratio = space.resin, space.targets, space.ratio
    curves = join_curves([make_curves(law, thickness, space.radius_mm) for law, thickness in laws])
    slab, column = (i.ravel() for i in np.indices((len(curves.thickness_mm), len(ratio))))
    slabs = make_slabs(curves, slab, resin, ratio[column])
    rough = evaluate(slabs, targets, space.sampling.coarse)
    total = rough.total(gamma1_score(evaluated_gamma1(rough, targets.power), targets))
    merit = (1.0 - low_share) * total + low_share * rough.low_aim
    expected = (merit.reshape(-1, len(ratio)) @ averaging(resin, ratio).T).ravel()
    loss = merit - expected
    order = expected * np.array(targets.weights.worth)[acceptability_rank(rough, targets)]
    order = np.where(rough.feasible, order, -1.0)
    results: list[SearchResult | NoAnswerError] = []
    maps, groups, end = [], [], 0
    for _, thickness in laws:
        start, end = end, end + len(thickness) * len(ratio)
        columns = (total, *(getattr(rough, name) for name in OBJECTIVES), rough.feasible)
        parts = (values[start:end].reshape(len(thickness), len(ratio)) for values in columns)
        score_map = ScoreMap(thickness, ratio, *parts)
        maps.append(score_map)
        able = int(score_map.feasible.sum())
        ranked = np.argsort(-order[start:end], kind="stable")[: min(refined, able)]
        unbeaten = np.setdiff1d(pareto(score_map, ranked[0]), ranked) if able and others else ranked[:0]
        groups.append((start + ranked, start + unbeaten))
    chosen = np.concatenate([index for group in groups for index in group])
    counts = [(len(ranked), len(unbeaten)) for ranked, unbeaten in groups]
    worked: list[list[DesignCandidate]] = [[]] * len(maps)
    if len(chosen):
        worked = _work_out(slabs.take(chosen), ratio[column[chosen]], space, counts, fitted, low_share, loss[chosen])
    for score_map, candidates in zip(maps, worked):
        if not candidates:
            thickness = score_map.thickness_mm
            why = (
                f"no slab of {thickness[0]:g} to {thickness[-1]:g} mm and ratio {ratio[0]:g} to {ratio[-1]:g} of "
                f"{resin.name} reaches {targets.protocol.needed_N:g} N within its depth limit; allow stiffer ratios or "
                "thinner pads"
            )
            results.append(NoAnswerError("no_feasible_design", why, quantity="pad"))
            continue
        best = max(candidates, key=lambda candidate: candidate.worth(low_share))
        results.append(SearchResult(best, alternatives_to(candidates, best), score_map))
    return results


def _work_out(
    slabs: Slabs, ratio: NDArray, space: SearchSpace, counts: Sequence[tuple[int, int]], fitted: int, low_share: float,
    loss: NDArray,
) -> list[list[DesignCandidate]]:  # fmt: skip
    """Evaluate groups of designs on the fine grid; fit the best of each group's ranked ones and all its others."""
    candidates, groups, end = exact_candidates(slabs, ratio, space, loss), [], 0
    for ranked, others in counts:
        start, end = end, end + ranked + others
        group = candidates[start:end]
        if fitted:
            worth = [candidate.worth(low_share) for candidate in group[:ranked]]
            best = np.sort(np.argsort(-np.array(worth), kind="stable")[:fitted]).tolist()
            group = [group[at] for at in (*best, *range(ranked, ranked + others))]
        groups.append(group)
    if not fitted:
        return groups
    done = iter(with_parameters([candidate for group in groups for candidate in group], space))
    return [[next(done) for _ in group] for group in groups]


def exact_candidates(
    slabs: Slabs, ratio: NDArray, space: SearchSpace, loss: NDArray | None = None
) -> list[DesignCandidate]:
    """Designs evaluated on the fine grid, in their order, with the parametric part of gamma1 alone."""
    exact = evaluate(slabs, space.targets, space.sampling, exact=True)
    parametric = rough_parametric(slabs, space.targets, space.sampling)
    ranks, lost = acceptability_rank(exact, space.targets), np.zeros(len(ratio)) if loss is None else loss
    columns = (slabs.thickness_mm, ratio, parametric, exact.total(parametric), ranks, lost)
    return [
        DesignCandidate(thickness, at, index, exact, None, score, total, rank, lost)
        for index, (thickness, at, score, total, rank, lost) in enumerate(zip(*(one.tolist() for one in columns)))
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
