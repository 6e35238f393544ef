"""Fit of base parameters, effects and law error together, with the sizes of the noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.progress import Progress, quiet
from dummydesign.inference.least_squares import solve_marquardt
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.noise import NoiseSizes, SizeLikelihood, estimate_slow_noise, make_whitener
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.base_law import USUAL_ROUGHNESS
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.forward_model import LAW_TERMS, Active, BaseParameters
from dummydesign.loop.model.material import UNDECLARED, BasePrior

NORMAL_95 = 1.959964


def student_over_normal(degrees: NDArray) -> NDArray:
    """97.5 % quantile of Student's t over that of the normal distribution."""
    from scipy.stats import t

    return t.ppf(0.975, np.asarray(degrees, float)) / NORMAL_95


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
    jacobian: NDArray
    covariance: NDArray
    chi2: float
    score: float
    joined: bool = False
    doubt: NDArray | None = None
    """Covariance (n, n) beside the fit's own, from rivals and the law; see ``doubt_of`` and ``with_rough_law``."""

    @property
    def base(self) -> BaseParameters:
        """The fitted base parameters."""
        return self.problem.base_of(self.vector)

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
    return np.r_[base, null, np.zeros(LAW_TERMS * len(problem.thicknesses))]


def prior_precision(problem: CampaignProblem, sizes: NoiseSizes) -> NDArray:
    """Inverse prior variances of the vector: of the material, of parameters of form, and of the law error."""
    forms = [p.spread**-2.0 for effect in problem.effects for p in effect.parameters]
    return np.r_[problem.prior.spread**-2.0, forms, np.repeat(np.array(sizes.law) ** -2.0, len(problem.thicknesses))]


def fit(
    problem: CampaignProblem, start: NDArray, sizes: NoiseSizes, iterations: int = 12, enough: float = ENOUGH
) -> CampaignFit:
    """Levenberg-Marquardt with a given noise."""
    low, high = problem.bounds()
    begin = np.clip(start, low, high)
    root, centre = np.sqrt(prior_precision(problem, sizes)), problem.centre
    used = problem.presses.used
    whiten = make_whitener(problem.presses, sizes.noise, problem.slope(begin, problem.predict(begin)))
    kept: dict[bytes, NDArray] = {}

    def forces_at(vector: NDArray) -> NDArray:
        key = vector.tobytes()
        if key not in kept:
            kept[key] = problem.predict(vector)
        return kept[key]

    def residual(vector: NDArray) -> NDArray:
        error = np.where(used, forces_at(vector) - problem.presses.force_N, 0.0)
        return np.r_[whiten(error).ravel(), root * (vector - centre)]

    def jacobian(vector: NDArray) -> NDArray:
        change = problem.jacobian(vector, forces_at(vector))
        change[~used] = 0.0
        return np.concatenate([whiten(change).reshape(-1, len(vector)), np.diag(root)])

    vector = solve_marquardt(residual, jacobian, begin, low, high, problem.frozen(), iterations, enough, TRUSTED)
    forces = forces_at(vector)
    if not problem.prior.declared:
        arms = vector[1 : problem.base_count].reshape(-1, 2)
        ordered = np.r_[vector[0], arms[np.argsort(arms[:, 0])].ravel(), vector[problem.base_count :]]
        if np.all((low <= ordered) & (ordered <= high)):
            vector = ordered  # the fast arm first
    return fit_at(problem, vector, forces, sizes)


def fit_at(problem: CampaignProblem, vector: NDArray, forces: NDArray, sizes: NoiseSizes) -> CampaignFit:
    """What a fit knows at a vector and its forces, without a search."""
    used, prior = problem.presses.used, prior_precision(problem, sizes)
    jacobian = problem.jacobian(vector, forces)
    jacobian[~used] = 0.0
    slope = np.where(used, problem.slope(vector, forces), 0.0)
    residual = np.where(used, problem.presses.force_N - forces, 0.0)
    whiten = make_whitener(problem.presses, sizes.noise, slope)
    turned = whiten(jacobian).reshape(-1, len(vector))
    covariance = np.linalg.pinv(turned.T @ turned + np.diag(prior), rcond=1e-12, hermitian=True)
    chi2 = float((whiten(residual) ** 2).sum() + (prior * (vector - problem.centre) ** 2).sum())
    return CampaignFit(problem, vector, sizes, residual, slope, forces, jacobian, covariance, chi2, float("nan"))


def with_sizes(campaign_fit: CampaignFit) -> CampaignFit:
    """Re-estimate contact scatter and law error at an optimum and set its score."""
    sizes, score = size_likelihood(campaign_fit).estimate(campaign_fit.sizes)
    return replace(campaign_fit, sizes=sizes, score=score)


def size_likelihood(campaign_fit: CampaignFit) -> SizeLikelihood:
    """Likelihood of contact scatter and law error at an optimum."""
    fit, problem, p = campaign_fit, campaign_fit.problem, campaign_fit.problem.fixed
    whiten = make_whitener(problem.presses, fit.sizes.noise, fit.slope, False)
    residual = fit.residual + fit.jacobian[..., p:] @ fit.vector[p:]
    turned, shift = whiten(fit.jacobian).reshape(-1, len(fit.vector)), whiten(fit.slope)
    dense = np.column_stack([whiten(residual).ravel(), turned])
    inner, wide = dense.T @ dense, np.einsum("tb,tbk->tk", shift, dense.reshape(*shift.shape, -1))
    # material and parameters of form have a prior, a row each
    prior, known, at = prior_precision(problem, fit.sizes)[:p], (fit.vector - problem.centre)[:p], 1 + np.arange(p)
    inner[0, 0] += float(prior @ known**2)
    inner[0, at] -= prior * known
    inner[at, 0] -= prior * known
    inner[at, at] += prior
    gram = np.block([[inner, wide.T], [wide, np.diag((shift**2).sum(axis=1))]])
    # the shifts of the trials stand before the law's errors
    order = np.r_[: 1 + p, len(inner) : len(gram), 1 + p : len(inner)]
    counts = p, len(shift), *[len(problem.thicknesses)] * LAW_TERMS
    return SizeLikelihood(gram[np.ix_(order, order)], counts, problem.law.error_priors)


def fit_with_noise(
    problem: CampaignProblem, start: NDArray, sizes: NoiseSizes, rounds: int = 2, iterations: int = 12
) -> CampaignFit:
    """Alternate the fit and the estimate of contact scatter and law error."""
    fitted = fit(problem, start, sizes, iterations)
    for _ in range(rounds - 1):
        sized = with_sizes(fitted)
        fitted = fit(problem, sized.vector, sized.sizes, iterations)
    return with_sizes(fitted)


def fit_base(
    presses: Presses, law: SetupLaw, young_MPa: float, progress: Progress = quiet, prior: BasePrior = UNDECLARED
) -> CampaignFit:
    """Fit modulus, relaxing arms and law error; the noise is estimated in between, twice."""
    problem = CampaignProblem(presses, law, prior=prior)
    progress("base")
    first = fit_with_noise(problem, start_vector(problem, young_MPa), NoiseSizes.first(presses, law.error_priors))
    progress("base")
    return same_noise(same_noise(first, 12), 12)


def same_noise(fitted: CampaignFit, iterations: int = 8) -> CampaignFit:
    """Estimate the slow noise again at a fit and refit: a better model shows the noise better."""
    problem, sizes = fitted.problem, fitted.sizes
    noise = estimate_slow_noise(problem.presses, fitted.residual, fitted.slope, fitted.forces, sizes.noise)
    return fit_with_noise(problem, fitted.vector, replace(sizes, noise=noise), 2, iterations)


KNOTS = 9


def hats(values: NDArray, knots: NDArray) -> list[NDArray]:
    """Piecewise-linear hat functions on knots, constant outside."""
    return [np.interp(values, knots, hat) for hat in np.eye(len(knots))]


def rough_columns(campaign_fit: CampaignFit) -> NDArray:
    """What a rough law could add, in newton at one standard deviation, shape (T, B, q)."""
    presses, law = campaign_fit.problem.presses, campaign_fit.problem.law
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    columns = []
    for pad in presses.pads:
        size = law.roughness(pad) if hasattr(law, "roughness") else USUAL_ROUGHNESS
        own = np.array([trial.pad == pad for trial in presses.trials])[:, None] & presses.used
        if not own.any():
            continue  # every press of the pad is left out
        for hat in hats(depth, np.linspace(0.0, float(depth[own].max()), KNOTS))[1:]:
            columns.append(np.where(own, size * campaign_fit.forces * hat, 0.0))
    return np.stack(columns, axis=-1) if columns else np.zeros((*presses.used.shape, 0))


LARGEST_WAVES = 2.0
"""Largest waves of a law that are believed, rms in standard deviations; laws by GetFEM ask for 0.5 to 0.9."""


def with_rough_law(campaign_fit: CampaignFit, of_base: NDArray | float = 0.0) -> CampaignFit:
    """The fit where its force law may be rough over depth: one linear step from the optimum, and the doubt it leaves
    beside one ``of_base`` of the base logarithms.

    With C the fit's covariance, J and R the whitened sensitivities and :func:`rough_columns`, each with a standard
    deviation of one, S = R'R + 1 - R'J C J'R and r the whitened residual: step - C J'R S^-1 R'r, doubt
    C J'R S^-1 R'J C. Without it, what changes the force over depth takes up the law's waves. Where the residual asks
    for waves above :data:`LARGEST_WAVES` it is something else, and the fit stays.
    """
    fit, problem = campaign_fit, campaign_fit.problem
    whiten = make_whitener(problem.presses, fit.sizes.noise, fit.slope)
    count = len(fit.vector)
    turned, left = whiten(fit.jacobian).reshape(-1, count), whiten(fit.residual).ravel()
    rough = whiten(rough_columns(fit)).reshape(len(turned), -1)
    apart = fit.covariance @ (turned.T @ rough)
    inverse = np.linalg.inv(rough.T @ rough + np.eye(rough.shape[1]) - (rough.T @ turned) @ apart)
    waves, doubt = inverse @ (rough.T @ left), apart @ inverse @ apart.T
    doubt[: problem.base_count, : problem.base_count] += of_base
    if np.mean(waves**2) > LARGEST_WAVES**2:
        return replace(fit, doubt=doubt)
    low, high = problem.bounds()
    vector = np.clip(fit.vector - apart @ waves, low, high)
    moved = fit_at(problem, vector, problem.predict(vector), fit.sizes)

    def squares(at: CampaignFit) -> float:
        """Squares with the waves at their likeliest."""
        error = whiten(at.residual).ravel()
        seen = rough.T @ error
        taken = seen @ np.linalg.solve(rough.T @ rough + np.eye(len(seen)), seen)
        return float(error @ error - taken + prior_precision(problem, fit.sizes) @ (at.vector - problem.centre) ** 2)

    return replace(moved if squares(moved) < squares(fit) else fit, score=fit.score, doubt=doubt)
