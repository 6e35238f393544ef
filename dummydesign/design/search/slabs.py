"""Search over ratio and thickness: the whole map first, then the best of it exactly, then alternatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError, out_of_range
from dummydesign.design.scoring.acceptability import acceptability_rank
from dummydesign.design.scoring.law_parameters import fit_presses, gamma1_score, parametric_score, rough_parametric
from dummydesign.design.scoring.presses import Curves, ForceLaw, Slabs, join_curves, join_slabs, make_curves
from dummydesign.design.scoring.score import Evaluation, evaluate, evaluated_gamma1
from dummydesign.design.search.alternatives import alternatives_to, pareto
from dummydesign.design.search.expected_map import averaging
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
    rank: int = 0
    """Whether it may be cast, :mod:`dummydesign.design.scoring.acceptability`."""
    loss: float = 0.0
    """What its castings are expected to lose of the merit, by :mod:`dummydesign.design.search.expected_map`."""

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
    found = search_each([(law, space.thickness_mm)], space, low_share, refined, fitted)[0]
    if isinstance(found, NoAnswerError):
        raise found
    return found


def search_each(
    laws: Sequence[tuple[ForceLaw, NDArray]],
    space: SearchSpace,
    low_share: float = 0.0,
    refined: int = REFINED,
    fitted: int = FITTED,
    others: bool = True,
) -> list[SearchResult | NoAnswerError]:
    """Make the search of :func:`search` for several force laws, each on thicknesses of its own, all designs at once.

    Parameters
    ----------
    laws : sequence of (ForceLaw, ndarray of shape (T,))
        Force laws with the thicknesses to combine with every ratio of the space. [mm]
    space, low_share, refined, fitted
        As for :func:`search`; the thicknesses of the space are not used.
    others : bool
        Whether designs that no other beats are worked out beside the best ones.

    Returns
    -------
    list of SearchResult or NoAnswerError
        One a law; ``no_feasible_design`` where none reaches 10 N steady within its depth limit.
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
    found: list[SearchResult | NoAnswerError] = []
    maps, groups, end = [], [], 0
    for _, thickness in laws:
        start, end = end, end + len(thickness) * len(ratio)
        score_map = _score_map(rough, total, thickness, ratio, slice(start, end))
        maps.append(score_map)
        able = int(score_map.feasible.sum())
        ranked = np.argsort(-order[start:end], kind="stable")[: min(refined, able)]
        unbeaten = np.setdiff1d(pareto(score_map, ranked[0]), ranked) if able and others else ranked[:0]
        groups.append((start + ranked, start + unbeaten))
    chosen = np.concatenate([index for group in groups for index in group])
    if len(chosen):
        counts = [(len(ranked), len(unbeaten)) for ranked, unbeaten in groups]
        worked = _work_out(
            slabs.take(chosen), ratio[column[chosen]], space, counts, fitted, low_share, loss[chosen]
        )
    for place, score_map in enumerate(maps):
        if not score_map.feasible.any():
            why = _why_none(resin, score_map.thickness_mm, ratio, targets.protocol.needed_N)
            found.append(NoAnswerError("no_feasible_design", why))
            continue
        best = max(worked[place], key=lambda candidate: candidate.worth(low_share))
        found.append(SearchResult(best, alternatives_to(worked[place], best), score_map))
    return found


def _score_map(rough: Evaluation, total: NDArray, thickness: NDArray, ratio: NDArray, rows: slice) -> ScoreMap:
    parts = (total, rough.steady_state_range, rough.force_variation_range, rough.aim, rough.low_force_range)
    shape = (len(thickness), len(ratio))
    return ScoreMap(
        thickness, ratio, *(np.asarray(values[rows]).reshape(shape) for values in (*parts, rough.feasible))
    )


def _work_out(
    slabs: Slabs,
    ratio: NDArray,
    space: SearchSpace,
    counts: Sequence[tuple[int, int]],
    fitted: int,
    low_share: float,
    loss: NDArray,
) -> list[list[Candidate]]:
    """Evaluate groups of designs on the fine grid; fit the best of each group's ranked ones and all its others."""
    targets = space.targets
    exact = evaluate(slabs, targets, space.sampling, exact=True)
    ranks = acceptability_rank(exact, targets)
    parametric = rough_parametric(slabs, targets, space.sampling)
    total = exact.total(parametric)
    found: list[Any] = [None] * len(ratio)
    groups, end = [], 0
    order = (1.0 - low_share) * total + low_share * exact.low_aim - loss
    order = np.maximum(order, 0.0) * np.array(targets.weights.worth)[ranks]
    for ranked, others in counts:
        start, end = end, end + ranked + others
        kept = np.arange(start, end)
        if fitted:
            best = np.argsort(-order[start : start + ranked], kind="stable")[:fitted]
            kept = np.sort(np.r_[start + best, np.arange(start + ranked, end)])
        groups.append(kept)
    if fitted and targets.parameters.gamma_N_per_mm3:
        every = np.concatenate(groups)
        fits = fit_presses(slabs.take(every), targets, exact.depth_mm[every], space.sampling)
        parametric = parametric.copy()
        parametric[every] = parametric_score(fits, targets)
        total = exact.total(parametric)
        for index, fit in zip(every, fits):
            found[index] = fit
    columns = (slabs.thickness_mm, ratio, parametric, total, ranks, loss)
    candidates = [
        Candidate(thickness, at, index, exact, found[index], score, sum_, int(rank), lost)
        for index, (thickness, at, score, sum_, rank, lost) in enumerate(zip(*(one.tolist() for one in columns)))
    ]
    return [[candidates[index] for index in kept] for kept in groups]


def with_parameters(candidates: Sequence[Candidate], space: SearchSpace) -> tuple[Candidate, ...]:
    """Designs with the tissue's law fitted to their presses, and the total that goes with it, where it was not yet.

    Parameters
    ----------
    candidates : sequence of Candidate
    space : SearchSpace
    """
    arms = space.targets.parameters.gamma_N_per_mm3
    lacking = [candidate for candidate in candidates if candidate.parameters is None] if arms else []
    if not lacking:
        return tuple(candidates)
    own = [(c.evaluation.slabs.take(np.array([c.index])), c.evaluation.depth_mm[[c.index]]) for c in lacking]
    fits = fit_presses(join_slabs([one for one, _ in own]), space.targets, np.concatenate([d for _, d in own]),
                       space.sampling)  # fmt: skip
    scores = iter(zip(fits, parametric_score(fits, space.targets)))
    done = []
    for candidate in candidates:
        if candidate.parameters is None:
            fit, score = next(scores)
            total = candidate.evaluation.take(np.array([candidate.index])).total(np.array([score]))
            candidate = replace(candidate, parameters=fit, parametric=float(score), total=float(total[0]))
        done.append(candidate)
    return tuple(done)


def _why_none(resin: Resin, thickness_mm: NDArray, ratio: NDArray, force_N: float) -> str:
    return (
        f"no slab of {thickness_mm[0]:g} to {thickness_mm[-1]:g} mm and ratio {ratio[0]:g} to {ratio[-1]:g} of "
        f"{resin.name} reaches {force_N:g} N within its depth limit; allow stiffer ratios or thinner pads"
    )
