"""Fit of base parameters, effects and law error together, with the sizes of the noise; the budget of counted work."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.progress import Progress, quiet
from dummydesign.inference.least_squares import solve_marquardt
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.noise import (
    NoiseSizes,
    SizeLikelihood,
    Whitener,
    estimate_slow_noise,
    make_whitener,
    repeat_scatter,
    volume,
)
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.forward_model import LAW_TERMS, SMOOTH_TERMS, WAVES, Active, BaseParameters
from dummydesign.loop.model.material import UNDECLARED, BasePrior

NORMAL_95 = 1.959964


@dataclass
class Budget:
    """Models that were fitted, and their iterations (sensitivities of all presses); ``stopped`` once something was left
    undone because these reached ``most``."""

    most: int
    models: int = 0
    iterations: int = 0
    stopped: bool = False


_BUDGET: ContextVar[Budget | None] = ContextVar("search_budget", default=None)


@contextmanager
def counted(most: int) -> Iterator[Budget]:
    """Give the fits inside so many iterations."""
    budget = Budget(most)
    token = _BUDGET.set(budget)
    try:
        yield budget
    finally:
        _BUDGET.reset(token)


def count(models: int = 0, iterations: int = 0) -> None:
    """Count work that was done."""
    if budget := _BUDGET.get():
        budget.models += models
        budget.iterations += iterations


def budget_spent() -> bool:
    """Whether no further model may be begun, asked where one is left out then; never without a budget."""
    if not (budget := _BUDGET.get()):
        return False
    budget.stopped = budget.stopped or budget.iterations >= budget.most
    return budget.stopped


ENOUGH = 0.02
TRUSTED = 0.8  # share of its promise that a step must keep for its Jacobian to serve again


@dataclass(frozen=True)
class CampaignFit:
    """An optimum with what is needed to judge it."""

    problem: CampaignProblem
    vector: NDArray
    sizes: NoiseSizes
    residual: NDArray
    slope: NDArray
    forces: NDArray
    columns: NDArray
    """Sensitivities of the bins, see :meth:`CampaignProblem.jacobian`."""
    covariance: NDArray
    chi2: float
    score: float
    joined: bool = False
    doubt: NDArray | None = None
    """Covariance of the base logarithms beside the fit's own, from rivals and the law; see ``doubt_of``."""

    @property
    def base(self) -> BaseParameters:
        """The fitted base parameters."""
        return self.problem.base_of(self.vector)

    @property
    def whitener(self) -> Whitener:
        """Whitening by all noise, the scatter of presses at its estimated size."""
        return make_whitener(self.problem.presses, self.sizes.noise, (self.slope, self.forces), self.sizes.scatter)

    @cached_property
    def jacobian(self) -> NDArray:
        """Sensitivities of the bins to the vector (T, B, len(vector))."""
        return self.problem.spread(self.columns)

    @cached_property
    def whitened_jacobian(self) -> NDArray:
        """The same by :attr:`whitener`."""
        return self.problem.spread(self.whitener(self.columns))

    @property
    def active(self) -> tuple[Active, ...]:
        """The fitted effects."""
        return self.problem.active_of(self.vector)


def start_vector(problem: CampaignProblem, young_MPa: float) -> NDArray:
    """Relaxation as declared, or that of a usual gel; effects at null."""
    base = problem.prior.mean.copy()
    base[0] = np.log(young_MPa)
    if problem.presses.elastic_only:
        base[2::2] = np.log(1e-3)
    null = [p.to_coordinate(p.null) for effect in problem.effects for p in effect.parameters]
    return np.r_[base, null, np.zeros(LAW_TERMS * len(problem.presses.pads))]


def prior_precision(problem: CampaignProblem, sizes: NoiseSizes) -> NDArray:
    """Inverse prior variances of the vector: of the material, of parameters of form, and of the law error."""
    own = np.r_[problem.prior.spread, [p.spread for effect in problem.effects for p in effect.parameters]]
    return np.r_[own**-2.0, np.repeat(np.array(sizes.law) ** -2.0, law_counts(problem))]


def law_counts(problem: CampaignProblem) -> tuple[int, ...]:
    """How many entries of the vector are levels, slopes, curvatures and waves."""
    pads = len(problem.presses.pads)
    return *[pads] * SMOOTH_TERMS, pads * WAVES


def fit(
    problem: CampaignProblem, start: NDArray, sizes: NoiseSizes, iterations: int = 12, enough: float = ENOUGH
) -> CampaignFit:
    """The optimum with a given noise and what is known there."""
    return fit_at(problem, best_vector(problem, start, sizes, iterations, enough), sizes)


def best_vector(
    problem: CampaignProblem, start: NDArray, sizes: NoiseSizes, iterations: int = 12, enough: float = ENOUGH
) -> NDArray:
    """Levenberg-Marquardt with a given noise."""
    count(models=1)
    low, high = problem.bounds()
    begin = np.clip(start, low, high)
    root, centre = np.sqrt(prior_precision(problem, sizes)), problem.centre
    used = problem.presses.used
    first = problem.predict(begin)
    whiten = make_whitener(problem.presses, sizes.noise, (problem.slope(begin, first), first), sizes.scatter)

    def residual(vector: NDArray) -> NDArray:
        error = np.where(used, problem.predict(vector) - problem.presses.force_N, 0.0)
        return np.r_[whiten(error).ravel(), root * (vector - centre)]

    def jacobian(vector: NDArray) -> NDArray:
        count(iterations=1)
        change = np.where(used[..., None], problem.jacobian(vector, problem.predict(vector)), 0.0)
        return np.concatenate([problem.spread(whiten(change)).reshape(-1, len(vector)), np.diag(root)])

    vector = solve_marquardt(residual, jacobian, begin, low, high, problem.frozen(), iterations, enough, TRUSTED)
    if not problem.prior.declared:
        arms = vector[1 : problem.base_count].reshape(-1, 2)
        ordered = np.r_[vector[0], arms[np.argsort(arms[:, 0])].ravel(), vector[problem.base_count :]]
        if np.all((low <= ordered) & (ordered <= high)):
            vector = ordered  # the fast arm first
    return vector


def fit_at(problem: CampaignProblem, vector: NDArray, sizes: NoiseSizes) -> CampaignFit:
    """What a fit knows at a vector, without a search."""
    used, prior, forces = problem.presses.used, prior_precision(problem, sizes), problem.predict(vector)
    columns = np.where(used[..., None], problem.jacobian(vector, forces), 0.0)
    slope = np.where(used, problem.slope(vector, forces), 0.0)
    residual = np.where(used, problem.presses.force_N - forces, 0.0)
    whiten = make_whitener(problem.presses, sizes.noise, (slope, forces), sizes.scatter)
    turned = problem.spread(whiten(columns)).reshape(-1, len(vector))
    covariance = np.linalg.pinv(turned.T @ turned + np.diag(prior), rcond=1e-12, hermitian=True)
    chi2 = float((whiten(residual) ** 2).sum() + (prior * (vector - problem.centre) ** 2).sum())
    return CampaignFit(problem, vector, sizes, residual, slope, forces, columns, covariance, chi2, float("nan"))


def with_sizes(campaign_fit: CampaignFit) -> CampaignFit:
    """Re-estimate scatter of presses and law error at an optimum and set its score."""
    sizes, score = size_likelihood(campaign_fit).estimate(campaign_fit.sizes)
    return replace(campaign_fit, sizes=sizes, score=score)


def size_likelihood(campaign_fit: CampaignFit) -> SizeLikelihood:
    """Likelihood of scatter of presses and law error at an optimum."""
    fit, problem, p = campaign_fit, campaign_fit.problem, campaign_fit.problem.fixed
    whiten = make_whitener(problem.presses, fit.sizes.noise)
    residual = fit.residual + fit.jacobian[..., p:] @ fit.vector[p:]
    turned = problem.spread(whiten(fit.columns)).reshape(-1, len(fit.vector))
    scatter = np.stack([whiten(fit.slope), whiten(np.where(problem.presses.used, fit.forces, 0.0))])
    dense = np.column_stack([whiten(residual).ravel(), turned])
    inner, count = dense.T @ dense, 2 * scatter.shape[1]
    wide = (scatter[:, :, None] @ dense.reshape(*scatter.shape[1:], -1)).reshape(count, -1)
    same = (scatter[:, None] * scatter).sum(axis=-1)
    # material and parameters of form have a prior, a row each
    prior, known, at = prior_precision(problem, fit.sizes)[:p], (fit.vector - problem.centre)[:p], 1 + np.arange(p)
    inner[0, 0] += float(prior @ known**2)
    inner[0, at] -= prior * known
    inner[at, 0] -= prior * known
    inner[at, at] += prior
    gram = np.block([[inner, wide.T], [wide, np.block([[np.diag(one) for one in row] for row in same])]])
    # the scatter of the trials stands before the law's errors
    order = np.r_[: 1 + p, len(inner) : len(gram), 1 + p : len(inner)]
    counts = p, count // 2, count // 2, *law_counts(problem)
    return SizeLikelihood(gram[np.ix_(order, order)], counts, problem.law.error_priors, fit.sizes.most)


def fit_with_noise(
    problem: CampaignProblem, start: NDArray, sizes: NoiseSizes, rounds: int = 2, iterations: int = 12
) -> CampaignFit:
    """Alternate the fit and the estimate of scatter of presses and law error."""
    for _ in range(rounds):
        fitted = with_sizes(fit(problem, start, sizes, iterations))
        start, sizes = fitted.vector, fitted.sizes
    return fitted


def fit_base(
    presses: Presses, law: SetupLaw, young_MPa: float, progress: Progress = quiet, prior: BasePrior = UNDECLARED
) -> CampaignFit:
    """Fit modulus, relaxing arms and law error; the noise is estimated in between, twice."""
    problem = CampaignProblem(presses, law, prior=prior)
    progress("base")
    first = fit_with_noise(problem, start_vector(problem, young_MPa), NoiseSizes.first(presses, law.error_priors), 1)
    seen = repeat_scatter(presses, first.residual, first.slope, first.forces, first.sizes.noise)
    most = (LOOSE * seen[0], LOOSE * seen[1]) if seen else first.sizes.most
    first = fit_with_noise(problem, first.vector, replace(first.sizes, most=most), 2)
    progress("base")
    return same_noise(same_noise(first, 12), 12)


LOOSE = 1.5
"""Scatter of presses over what repeats show of it, at most: what a fit puts there beyond that is an effect."""


def same_noise(fitted: CampaignFit, iterations: int = 8) -> CampaignFit:
    """Estimate the slow noise again at a fit and refit: a better model shows the noise better.

    What repeats do not differ in, they do not show: an estimate with which the campaign is less likely is not taken.
    """
    problem, presses = fitted.problem, fitted.problem.presses
    noise = estimate_slow_noise(presses, fitted.residual, fitted.slope, fitted.forces, fitted.sizes.noise)
    sizes = replace(fitted.sizes, noise=noise)
    trial = with_sizes(replace(fitted, sizes=sizes))
    old, new = (one.score + volume(presses, one.sizes.noise) for one in (fitted, trial))
    return fit_with_noise(problem, fitted.vector, sizes, 2, iterations) if new < old else fitted
