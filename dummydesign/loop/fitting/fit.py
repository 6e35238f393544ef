"""Fit of base parameters, effects and law error together, with the sizes of the noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.process import Progress, quiet
from dummydesign.inference.least_squares import solve_marquardt
from dummydesign.inference.noise import Noise, likeliest
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.noise import (
    LAW_TERMS,
    POSITION_PRIOR_MM,
    SIZE_BOUNDS,
    Priors,
    Sizes,
    estimate_slow_noise,
    first_sizes,
    make_whitener,
)
from dummydesign.loop.fitting.problem import BASE, CampaignProblem
from dummydesign.loop.model.base_law import USUAL_ROUGHNESS, SetupLaw
from dummydesign.loop.model.forward_model import Active, BaseParameters

NORMAL_95 = 1.959964
LEAST_DEGREES = 2.0
"""The expansion does not hold for fewer; the priors on the sizes keep them above, but for a handful of trials."""
STEP = 0.05


@dataclass(frozen=True)
class SizeLikelihood:
    """Minus twice the log likelihood of contact scatter and law error."""

    gram: NDArray
    counts: tuple[int, ...]
    law_priors: Priors

    def estimate(self, sizes: Sizes) -> tuple[Sizes, float]:
        """Likeliest sizes, and minus twice the log likelihood there."""
        terms = self._terms()
        begin = np.array([max(sizes.noise.position_mm, 1e-3), *sizes.law])
        low, high = SIZE_BOUNDS
        likely = likeliest(lambda z: self._score(terms, z, True), begin, low, high, gradient=True)[0]
        position, *law = likely.tolist()
        noise = Noise(sizes.noise.white_N, sizes.noise.slow_N, sizes.noise.slow_time_s, position)
        return Sizes(noise, *law), self._score(terms, likely, False)[0]

    def variances(self, sizes: NDArray) -> NDArray:
        """Variances (p,) of the fitted parameters for given sizes (4,), random columns integrated out."""
        p = self.counts[0]
        fixed, cross = self.gram[1 : 1 + p, 1 : 1 + p], self.gram[1 : 1 + p, 1 + p :]
        scale = sizes[self._groups()]
        inner = np.eye(len(scale)) + scale[:, None] * self.gram[1 + p :, 1 + p :] * scale
        turned = cross * scale
        known = fixed - turned @ np.linalg.solve(inner, turned.T)
        length = np.sqrt(np.maximum(np.diag(fixed), 0.0))
        seen = np.where(length > 0.0, length, 1.0)
        inverse = np.linalg.pinv(known / np.outer(seen, seen), rcond=1e-12, hermitian=True)
        return np.where(length > 0.0, np.diag(inverse) / seen**2, 0.0)

    def degrees(self, sizes: Sizes) -> tuple[NDArray, NDArray]:
        """Degrees of freedom of the variances of the fitted parameters (p,), and of the four sizes squared (4,)."""
        at = np.clip(np.array([sizes.noise.position_mm, *sizes.law]), *SIZE_BOUNDS)
        terms = self._terms()
        steps = np.exp(STEP * np.eye(len(at)))
        sides = [(at * step, at / step) for step in steps]
        bend = np.stack([self._score(terms, up, True)[1] - self._score(terms, down, True)[1] for up, down in sides])
        bend = 0.25 * (bend + bend.T) / STEP
        # of -2 ln L, whose second derivative is twice the inverse covariance; flat or upward where a size is unseen
        values, turn = np.linalg.eigh(bend)
        priors = np.array([POSITION_PRIOR_MM[1], *(spread for _, spread in self.law_priors)])
        values = np.maximum(values, 2.0 / priors.max() ** 2)
        covariance = turn @ np.diag(2.0 / values) @ turn.T
        middle = self.variances(at)
        slopes = np.stack([self.variances(up) - self.variances(down) for up, down in sides], axis=1) / (2.0 * STEP)
        spread = np.einsum("pi,ij,pj->p", slopes, covariance, slopes)
        own = 0.5 / np.diag(covariance)
        known = 2.0 * middle**2 / np.maximum(spread, 1e-12 * middle**2 + 1e-300)
        return np.maximum(known, LEAST_DEGREES), np.maximum(own, LEAST_DEGREES)

    def _groups(self) -> NDArray:
        return np.repeat(np.arange(len(self.counts) - 1), self.counts[1:])

    def _terms(self) -> tuple[float, NDArray, NDArray, NDArray]:
        """Squares of the residual, its inner products with the random columns, and theirs: the fixed at their best."""
        p = self.counts[0]
        gram = self.gram
        fixed = gram[: 1 + p, : 1 + p][1:, 1:] + np.diag(1e-9 * np.diag(gram)[1 : 1 + p] + 1e-12)
        others = np.r_[0, np.arange(1 + p, len(gram))]
        cross = gram[1 : 1 + p][:, others]
        rest = gram[np.ix_(others, others)] - cross.T @ np.linalg.solve(fixed, cross)
        return float(rest[0, 0]), rest[1:, 0], rest[1:, 1:], gram[1 + p :, 1 + p :]

    def _score(
        self, terms: tuple[float, NDArray, NDArray, NDArray], sizes: NDArray, restricted: bool
    ) -> tuple[float, NDArray]:
        """Minus twice the log likelihood, and (restricted) its gradient in the logarithms of the sizes."""
        total, inner, cleaned, random = terms
        groups = self._groups()
        medians, spreads = np.array((POSITION_PRIOR_MM, *self.law_priors)).T
        eye, scale, logs = np.eye(len(random)), sizes[groups], np.log(sizes)
        # in units of the scale the matrix is 1 + S R S, which is never singular
        inverse = np.linalg.inv(eye + scale[:, None] * cleaned * scale)
        pull = inverse @ (scale * inner)
        chi2 = total - (scale * inner) @ pull
        spectrum = cleaned if restricted else random
        volume = np.linalg.slogdet(eye + scale[:, None] * spectrum * scale)[1]
        prior = (logs - np.log(medians)) / spreads
        each = -2.0 * pull**2 + 2.0 * (1.0 - np.diag(inverse))
        return float(chi2 + volume + prior @ prior), np.bincount(groups, each) + 2.0 * prior / spreads


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
    sizes: Sizes
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
    """Usual parameters of a soft gel, effects at null."""
    strength = 1e-3 if problem.presses.elastic_only else 0.3
    base = BaseParameters(young_MPa, (0.07, 1.5), (strength, strength)).to_logs()
    null = [p.to_coordinate(p.null) for effect in problem.effects for p in effect.parameters]
    return np.r_[base, null, np.zeros(LAW_TERMS * len(problem.thicknesses))]


def prior_precision(problem: CampaignProblem, sizes: Sizes) -> NDArray:
    """Inverse prior variances of the vector: of the law error, and of parameters of form."""
    forms = [p.spread**-2.0 for effect in problem.effects for p in effect.parameters]
    return np.r_[np.zeros(BASE), forms, np.repeat(np.array(sizes.law) ** -2.0, len(problem.thicknesses))]


def fit(
    problem: CampaignProblem, start: NDArray, sizes: Sizes, iterations: int = 12, enough: float = ENOUGH
) -> CampaignFit:
    """Levenberg-Marquardt with a given noise."""
    low, high = problem.bounds()
    begin = np.clip(start, low, high)
    root = np.sqrt(prior_precision(problem, sizes))
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
        return np.r_[whiten(error).ravel(), root * vector]

    def jacobian(vector: NDArray) -> NDArray:
        change = problem.jacobian(vector, forces_at(vector))
        change[~used] = 0.0
        return np.concatenate([whiten(change).reshape(-1, len(vector)), np.diag(root)])

    vector = solve_marquardt(residual, jacobian, begin, low, high, problem.frozen(), iterations, enough, TRUSTED)
    forces = forces_at(vector)
    if vector[1] > vector[3] and low[3] <= vector[1] and vector[3] <= high[1]:
        vector = vector[[0, 3, 4, 1, 2, *range(BASE, len(vector))]]  # the fast arm first
    return _finish(problem, vector, forces, sizes)


def _finish(problem: CampaignProblem, vector: NDArray, forces: NDArray, sizes: Sizes) -> CampaignFit:
    used = problem.presses.used
    prior = prior_precision(problem, sizes)
    jacobian = problem.jacobian(vector, forces)
    jacobian[~used] = 0.0
    slope = np.where(used, problem.slope(vector, forces), 0.0)
    residual = np.where(used, problem.presses.force_N - forces, 0.0)
    whiten = make_whitener(problem.presses, sizes.noise, slope)
    turned = whiten(jacobian).reshape(-1, len(vector))
    normal = turned.T @ turned + np.diag(prior)
    covariance = np.linalg.pinv(normal, rcond=1e-12, hermitian=True)
    chi2 = float((whiten(residual) ** 2).sum() + (prior * vector**2).sum())
    return CampaignFit(problem, vector, sizes, residual, slope, forces, jacobian, covariance, chi2, float("nan"))


def with_sizes(campaign_fit: CampaignFit) -> CampaignFit:
    """Re-estimate contact scatter and law error at an optimum and set its score."""
    sizes, score = size_likelihood(campaign_fit).estimate(campaign_fit.sizes)
    return replace(campaign_fit, sizes=sizes, score=score)


def size_likelihood(campaign_fit: CampaignFit) -> SizeLikelihood:
    """Likelihood of contact scatter and law error at an optimum."""
    problem = campaign_fit.problem
    presses = problem.presses
    count, half = len(presses.trials), len(problem.thicknesses)
    whiten = make_whitener(presses, campaign_fit.sizes.noise, campaign_fit.slope, False)
    law = campaign_fit.jacobian[..., problem.fixed :]
    residual = campaign_fit.residual + law @ campaign_fit.vector[problem.fixed :]
    turned = whiten(campaign_fit.jacobian).reshape(-1, len(campaign_fit.vector))
    shift = whiten(campaign_fit.slope)
    white = whiten(residual)
    p = problem.fixed
    gram = np.zeros((1 + p + count + LAW_TERMS * half,) * 2)
    dense = np.column_stack([white.ravel(), turned])
    inner = dense.T @ dense
    wide = np.einsum("tb,tbk->tk", shift, dense.reshape(*shift.shape, -1))
    order = np.r_[0, 1 + np.arange(p), 1 + p + count + np.arange(LAW_TERMS * half)]
    gram[np.ix_(order, order)] = inner
    # parameters of form have a prior, a row each
    prior = prior_precision(problem, campaign_fit.sizes)[:p]
    known, at = campaign_fit.vector[:p], 1 + np.arange(p)
    gram[0, 0] += float(prior @ known**2)
    gram[0, at] -= prior * known
    gram[at, 0] -= prior * known
    gram[at, at] += prior
    trials = 1 + p + np.arange(count)
    gram[np.ix_(trials, order)] = wide
    gram[np.ix_(order, trials)] = wide.T
    gram[trials, trials] = (shift**2).sum(axis=1)
    return SizeLikelihood(gram, (p, count, *[half] * LAW_TERMS), problem.law.error_priors)


def fit_with_noise(
    problem: CampaignProblem, start: NDArray, sizes: Sizes, rounds: int = 2, iterations: int = 12
) -> CampaignFit:
    """Alternate the fit and the estimate of contact scatter and law error."""
    fitted = fit(problem, start, sizes, iterations)
    for _ in range(rounds - 1):
        sized = with_sizes(fitted)
        fitted = fit(problem, sized.vector, sized.sizes, iterations)
    return with_sizes(fitted)


def fit_base(
    presses: Presses, law: SetupLaw, young_MPa: float, progress: Progress = quiet
) -> CampaignFit:
    """Fit modulus, two Prony arms and law error; the noise is estimated in between, twice."""
    problem = CampaignProblem(presses, law)
    vector, sizes = start_vector(problem, young_MPa), first_sizes(presses, law.error_priors)
    for _ in range(2):
        progress("base")
        fitted = fit_with_noise(problem, vector, sizes)
        noise = estimate_slow_noise(presses, fitted.residual, fitted.slope, fitted.forces, fitted.sizes.noise)
        vector, sizes = fitted.vector, replace(fitted.sizes, noise=noise)
    return fit_with_noise(problem, vector, sizes)


def same_noise(campaign_fit: CampaignFit) -> CampaignFit:
    """Estimate the slow noise again at a fit and refit: a better model shows the noise better."""
    noise = estimate_slow_noise(
        campaign_fit.problem.presses, campaign_fit.residual, campaign_fit.slope, campaign_fit.forces,
        campaign_fit.sizes.noise,
    )  # fmt: skip
    return fit_with_noise(campaign_fit.problem, campaign_fit.vector, replace(campaign_fit.sizes, noise=noise), 2, 8)


KNOTS = 9


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
        knots = np.linspace(0.0, float(depth[own].max()), KNOTS)
        at = np.clip(depth, knots[0], knots[-1])
        for knot in range(1, KNOTS):
            hat = np.interp(at, knots, np.eye(KNOTS)[knot])
            columns.append(np.where(own, size * campaign_fit.forces * hat, 0.0))
    return np.stack(columns, axis=-1) if columns else np.zeros((*presses.used.shape, 0))


LARGEST_WAVES = 2.0
"""Waves of a law, rms in standard deviations, that are believed; laws by GetFEM ask for 0.5 to 0.9."""


def with_rough_law(campaign_fit: CampaignFit, of_base: NDArray | float = 0.0) -> CampaignFit:
    """The fit where its force law may be rough over depth: one linear step from the optimum, and the doubt it leaves
    beside one ``of_base`` (5, 5) of the base logarithms.

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
    doubt[:BASE, :BASE] += of_base
    if np.mean(waves**2) > LARGEST_WAVES**2:
        return replace(fit, doubt=doubt)
    low, high = problem.bounds()
    vector = np.clip(fit.vector - apart @ waves, low, high)
    moved = _finish(problem, vector, problem.predict(vector), fit.sizes)

    def squares(at: CampaignFit) -> float:
        """Squares with the waves at their likeliest."""
        error = whiten(at.residual).ravel()
        seen = rough.T @ error
        taken = seen @ np.linalg.solve(rough.T @ rough + np.eye(len(seen)), seen)
        return float(error @ error - taken + prior_precision(problem, fit.sizes) @ at.vector**2)

    best = moved if squares(moved) < squares(fit) else fit
    return replace(best, score=fit.score, doubt=doubt)
