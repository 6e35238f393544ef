"""Search over ratio and thickness: the whole map first, then the best of it exactly, then alternatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError, out_of_range
from dummydesign.design.scoring.law_parameters import fit_presses, gamma1_score, parametric_score
from dummydesign.design.scoring.presses import Curves, ForceLaw, Sampling, Slabs, make_curves
from dummydesign.design.scoring.score import Evaluation, evaluate, steady_gamma1
from dummydesign.design.scoring.standing import WORTH, standing
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.alternatives import ALTERNATIVES, alternatives_to
from dummydesign.design.search.space import SearchSpace
from dummydesign.resin.model.resin import Resin

THICKNESS_MM = (3.0, 30.0)
"""Slabs that can be cast. [mm]"""
THICKNESS_STEP_MM = 0.5
REFINED, FITTED = 24, 6


@dataclass(frozen=True)
class ScoreMap:
    """Scores over thickness (T,) and ratio (R,): arrays (T, R); ``feasible`` reaches 10 N steady."""

    thickness_mm: NDArray
    ratio: NDArray
    total: NDArray
    steady_state_range: NDArray
    force_variation_range: NDArray
    aim: NDArray
    low_force_range: NDArray
    feasible: NDArray

    def to_dict(self) -> dict[str, Any]:
        """Return all arrays as lists."""
        return {name: getattr(self, name).tolist() for name in self.__dataclass_fields__}


@dataclass(frozen=True)
class Candidate:
    """One design worked out exactly: its place in the evaluation, parameters and scores."""

    thickness_mm: float
    ratio: float
    index: int
    evaluation: Evaluation
    parameters: Any
    parametric: float
    total: float
    standing: int = 0
    """Whether it may stand for the person, :mod:`dummydesign.design.scoring.standing`."""

    def merit(self, low_share: float) -> float:
        """By what designs are ranked: the total, with a share of the closeness to the aim below 5 N."""
        return (1.0 - low_share) * self.total + low_share * float(self.evaluation.low_aim[self.index])

    def worth(self, low_share: float) -> float:
        """By what designs are chosen: the merit, less where it reads low or leaves the steady range."""
        return WORTH[self.standing] * self.merit(low_share)


@dataclass(frozen=True)
class SearchResult:
    """What a search found: best design, Pareto alternatives, and the map."""

    best: Candidate
    alternatives: tuple[Candidate, ...]
    score_map: ScoreMap


def thickness_steps(low_mm: float, high_mm: float) -> NDArray:
    """Thicknesses in steps of 0.5 mm inside a range, both ends included. [mm]

    Raises
    ------
    InputError
        When the range leaves what can be cast (3 to 30 mm) or holds no step.
    """
    for value in (low_mm, high_mm):
        if not (math.isfinite(value) and THICKNESS_MM[0] <= value <= THICKNESS_MM[1]):
            raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
    first = math.ceil(low_mm / THICKNESS_STEP_MM - 1e-9)
    last = math.floor(high_mm / THICKNESS_STEP_MM + 1e-9)
    if last < first:
        raise out_of_range(
            "thickness range in mm",
            f"{low_mm:g}:{high_mm:g}",
            *THICKNESS_MM,
            f"it holds no step of {THICKNESS_STEP_MM} mm",
        )
    return np.arange(first, last + 1) * THICKNESS_STEP_MM


def make_slabs(curves: Curves, slab: NDArray, resin: Resin, ratio: NDArray) -> Slabs:
    """Designs with the central numbers of a resin.

    Parameters
    ----------
    curves : Curves
        Elastic curves of the slabs, per modulus.
    slab : ndarray of int, shape (D,)
        Which of the curves each design has.
    resin : Resin
        Gives modulus and relaxation at a ratio.
    ratio : ndarray, shape (D,)
        Mixing ratio of each, in the resin's own definition.

    Returns
    -------
    Slabs
    """
    known, back = np.unique(ratio, return_inverse=True)
    beta = np.array([[term.beta for term in resin.prony(float(value))] for value in known])
    tau = tuple(arm.tau_s.value for arm in resin.arms)
    young = np.atleast_1d(resin.young_MPa(known))
    return Slabs(curves, slab, young[back], tau, beta.reshape(len(known), len(tau))[back])


def search(
    law: ForceLaw, space: SearchSpace, low_share: float = 0.0, refined: int = REFINED, fitted: int = FITTED
) -> SearchResult:
    """Find the slab and ratio that score best, in practical steps.

    Every combination is scored on a coarse time grid (the map); the best of it are worked out on a fine
    one, with the tissue's law fitted to their simulated presses, and ranked again. The map has no fitted
    parameters: there the parametric part is that of gamma1 alone.

    Parameters
    ----------
    law : ForceLaw
        Elastic force of slabs.
    space : SearchSpace
        Resin, targets and the steps to combine.
    low_share : float
        Weight, in the choice of the best, of the closeness to the aim below 5 N beside the total.
    refined, fitted : int
        How many of the map's best are worked out on the fine grid, and to how many of these the law is fitted; with
        no fit the parametric part is that of gamma1 and ``parameters`` are None (:func:`with_parameters`).

    Returns
    -------
    SearchResult

    Raises
    ------
    NoAnswerError
        ``no_feasible_design`` when none reaches 10 N steady within its depth limit.
    """
    resin, targets, sampling = space.resin, space.targets, space.sampling
    thickness_mm, ratio = space.thickness_mm, space.ratio
    curves = make_curves(law, thickness_mm, space.radius_mm)
    slab, column = (
        index.ravel() for index in np.meshgrid(np.arange(len(thickness_mm)), np.arange(len(ratio)), indexing="ij")
    )
    slabs = make_slabs(curves, slab, resin, ratio[column])
    coarse = Sampling(16, 8, 20, sampling.hold_s, sampling.deceleration_mm_s2)
    rough = evaluate(slabs, targets, coarse)
    total = rough.total(gamma1_score(steady_gamma1(slabs), targets))
    shape = (len(thickness_mm), len(ratio))
    score_map = ScoreMap(
        thickness_mm,
        ratio,
        *(
            np.asarray(values).reshape(shape)
            for values in (
                total,
                rough.steady_state_range,
                rough.force_variation_range,
                rough.aim,
                rough.low_force_range,
                rough.feasible,
            )
        ),
    )
    if not rough.feasible.any():
        raise NoAnswerError("no_feasible_design", _why_none(resin, thickness_mm, ratio))
    merit = (1.0 - low_share) * total + low_share * rough.low_aim
    order = merit * np.array(WORTH)[standing(rough, targets)]
    ranked = np.argsort(-np.where(rough.feasible, order, -1.0), kind="stable")
    ranked = ranked[: min(refined, int(rough.feasible.sum()))]
    others = np.setdiff1d(_pareto(score_map, ranked[0]), ranked)
    chosen = np.r_[ranked, others]
    counts = len(ranked), fitted
    candidates = _work_out(slabs.take(chosen), ratio[column[chosen]], targets, sampling, counts, low_share)
    best = max(candidates, key=lambda candidate: candidate.worth(low_share))
    return SearchResult(best, alternatives_to(candidates, best), score_map)


def _work_out(
    slabs: Slabs, ratio: NDArray, targets: Targets, sampling: Sampling, counts: tuple[int, int], low_share: float
) -> list[Candidate]:
    """Evaluate designs on the fine grid; fit the best of the first ones (how many, how many fitted) and all others."""
    ranked, fitted = counts
    exact = evaluate(slabs, targets, sampling, exact=True)
    stands = standing(exact, targets)
    parametric = gamma1_score(steady_gamma1(slabs), targets)
    before = exact.total(parametric)
    if fitted:
        order = ((1.0 - low_share) * before + low_share * exact.low_aim) * np.array(WORTH)[stands]
        best = np.argsort(-order[:ranked], kind="stable")[:fitted]
        kept = np.sort(np.r_[best, np.arange(ranked, len(ratio))])
        found = fit_presses(slabs.take(kept), targets, exact.depth_mm[kept], sampling)
        parametric = parametric_score(found, targets)
        total = exact.take(kept).total(parametric)
    else:
        kept, found, total = np.arange(len(ratio)), [None] * len(ratio), before
    return [
        Candidate(
            float(slabs.thickness_mm[index]),
            float(ratio[index]),
            int(index),
            exact,
            found[row],
            float(parametric[row]),
            float(total[row]),
            int(stands[index]),
        )
        for row, index in enumerate(kept)
    ]


def with_parameters(candidates: Sequence[Candidate], space: SearchSpace) -> tuple[Candidate, ...]:
    """Designs with the tissue's law fitted to their presses, and the total that goes with it, where it was not yet.

    Parameters
    ----------
    candidates : sequence of Candidate
    space : SearchSpace
    """
    done = []
    for candidate in candidates:
        if candidate.parameters is None:
            evaluation, row = candidate.evaluation, np.array([candidate.index])
            slabs, depth = evaluation.slabs.take(row), evaluation.depth_mm[row]
            found = fit_presses(slabs, space.targets, depth, space.sampling)
            score = parametric_score(found, space.targets)
            total = float(evaluation.take(row).total(score)[0])
            candidate = replace(candidate, parameters=found[0], parametric=float(score[0]), total=total)
        done.append(candidate)
    return tuple(done)


def _objectives(score_map: ScoreMap) -> NDArray:
    """What a user may weigh differently: measured steady range, force range, aim, low forces. (D, 4)"""
    parts = ("steady_state_range", "force_variation_range", "aim", "low_force_range")
    return np.stack([getattr(score_map, name).ravel() for name in parts], axis=-1)


def _pareto(score_map: ScoreMap, best: int) -> NDArray:
    """Feasible designs of the map that no other beats in every objective, the far ones from each other.

    From those with at least half of the best total, the highest is taken again and again, leaving out what
    lies within 1 mm and 0.3 parts of one already taken.
    """
    values, total = _objectives(score_map), score_map.total.ravel()
    able = np.nonzero(score_map.feasible.ravel() & (total >= 0.5 * total[best]))[0]
    order = able[np.argsort(-values[able].sum(axis=-1), kind="stable")]
    front: list[int] = []
    for index in order:
        if not front:
            front.append(index)
            continue
        others = values[front]
        beaten = np.all(others >= values[index] - 1e-12, axis=-1)
        if not beaten.any():
            front.append(index)
    place = np.stack(np.unravel_index(np.array(front), score_map.total.shape), axis=-1)
    thickness, ratio = score_map.thickness_mm[place[:, 0]], score_map.ratio[place[:, 1]]
    at = np.unravel_index(best, score_map.total.shape)
    taken = [(score_map.thickness_mm[at[0]], score_map.ratio[at[1]])]
    kept = []
    for index in np.argsort(-total[front], kind="stable"):
        here = (thickness[index], ratio[index])
        if all(abs(here[0] - t) > 1.0 or abs(here[1] - r) > 0.3 for t, r in taken):
            taken.append(here)
            kept.append(front[index])
        if len(kept) == ALTERNATIVES:
            break
    return np.array(kept, dtype=int)


def _why_none(resin: Resin, thickness_mm: NDArray, ratio: NDArray) -> str:
    slabs = f"slab of {thickness_mm[0]:g} to {thickness_mm[-1]:g} mm"
    return (
        f"no {slabs} and ratio {ratio[0]:g} to {ratio[-1]:g} of {resin.name} reaches 10 N "
        "within its depth limit; allow stiffer ratios or thinner pads"
    )
