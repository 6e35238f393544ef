"""Fit of base parameters, effects and law error together: Levenberg-Marquardt on whitened bins."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import solve_marquardt
from dummydesign.loop.fitting.noise import LAW_TERMS, Sizes, make_whitener
from dummydesign.loop.fitting.problem import Problem
from dummydesign.loop.fitting.size_likelihood import SizeLikelihood
from dummydesign.loop.model.forward_model import Active
from dummydesign.loop.model.parameters import BaseParameters

ENOUGH = 0.02
TRUSTED = 0.8
"""Share of its promise that a step must keep for its Jacobian to serve again."""


@dataclass(frozen=True)
class Fit:
    """An optimum with what is needed to judge it.

    Attributes
    ----------
    problem : Problem
    vector : ndarray, shape (n,)
    sizes : Sizes
    residual, slope, forces : ndarray, shape (T, B)
        Measured minus modelled; dF/dx; modelled. [N, N/mm, N]
    jacobian : ndarray, shape (T, B, n)
    covariance : ndarray, shape (n, n)
    chi2 : float
        Whitened squares including the prior rows of the law error.
    score : float
        Minus twice the log likelihood, law error and contact scatter integrated out (see
        :class:`dummydesign.loop.fitting.size_likelihood.SizeLikelihood`).
    joined : bool
        Whether it was joined with a prior; its covariance then holds all that is known of both.
    """

    problem: Problem
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

    @property
    def base(self) -> BaseParameters:
        """The fitted base parameters."""
        return self.problem.base_of(self.vector)

    @property
    def active(self) -> tuple[Active, ...]:
        """The fitted effects."""
        return self.problem.active_of(self.vector)


def start_vector(problem: Problem, young_MPa: float) -> NDArray:
    """Usual parameters of a soft gel, effects at null."""
    strength = 1e-3 if problem.presses.elastic_only else 0.3
    base = BaseParameters(young_MPa, (0.07, 1.5), (strength, strength)).to_logs()
    return extend(problem, base, np.zeros(LAW_TERMS * len(problem.thicknesses)))


def extend(problem: Problem, base_logs: NDArray, law: NDArray) -> NDArray:
    """A vector of parameters with the effects at their null values.

    Parameters
    ----------
    problem : Problem
        With E effects, all parameters of which are appended.
    base_logs : ndarray, shape (b,)
        Logarithms of the base parameters.
    law : ndarray, shape (l,)
        Deviations of the force law.

    Returns
    -------
    ndarray, shape (b + effects + l,)
    """
    null = [p.to_coordinate(p.null) for effect in problem.effects for p in effect.parameters]
    return np.r_[base_logs, null, law]


def prior_precision(problem: Problem, sizes: Sizes) -> NDArray:
    """Inverse prior variances of the vector: of the law error only."""
    return np.r_[np.zeros(problem.fixed), np.repeat(np.array(sizes.law) ** -2.0, len(problem.thicknesses))]


def fit(problem: Problem, start: NDArray, sizes: Sizes, iterations: int = 12, enough: float = ENOUGH) -> Fit:
    """Levenberg-Marquardt with a given noise.

    Parameters
    ----------
    problem : Problem
        The data and the model.
    start : ndarray, shape (p,)
        Where to begin; brought inside the bounds.
    sizes : Sizes
        Sizes of noise and law error.
    iterations : int
        Most steps.
    enough : float
        Gain in chi-square below which the search ends.

    Returns
    -------
    Fit
        ``score`` is NaN: see :func:`with_sizes`.
    """
    low, high = problem.bounds()
    begin = np.clip(start, low, high)
    root = np.sqrt(prior_precision(problem, sizes))
    used = problem.presses.used
    whiten = make_whitener(problem.presses, sizes.noise, problem.slope(begin, problem.predict(begin)), True)
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
        vector = vector[[0, 3, 4, 1, 2, *range(5, len(vector))]]  # the fast arm first
    return _finish(problem, vector, forces, sizes)


def _finish(problem: Problem, vector: NDArray, forces: NDArray, sizes: Sizes) -> Fit:
    used = problem.presses.used
    prior = prior_precision(problem, sizes)
    jacobian = problem.jacobian(vector, forces)
    jacobian[~used] = 0.0
    slope = np.where(used, problem.slope(vector, forces), 0.0)
    residual = np.where(used, problem.presses.force_N - forces, 0.0)
    whiten = make_whitener(problem.presses, sizes.noise, slope, True)
    turned = whiten(jacobian).reshape(-1, len(vector))
    normal = turned.T @ turned + np.diag(prior)
    covariance = np.linalg.pinv(normal, rcond=1e-12, hermitian=True)
    chi2 = float((whiten(residual) ** 2).sum() + (prior * vector**2).sum())
    return Fit(problem, vector, sizes, residual, slope, forces, jacobian, covariance, chi2, float("nan"))


def with_sizes(found: Fit) -> Fit:
    """Re-estimate contact scatter and law error at an optimum and set its score."""
    sizes, score = size_likelihood(found).estimate(found.sizes)
    return replace(found, sizes=sizes, score=score)


def size_likelihood(found: Fit) -> SizeLikelihood:
    """Likelihood of contact scatter and law error at an optimum."""
    problem = found.problem
    presses = problem.presses
    count, half = len(presses.trials), len(problem.thicknesses)
    whiten = make_whitener(presses, found.sizes.noise, found.slope, False)
    law = found.jacobian[..., problem.fixed :]
    residual = found.residual + law @ found.vector[problem.fixed :]
    turned = whiten(found.jacobian).reshape(-1, len(found.vector))
    shift = whiten(found.slope)
    white = whiten(residual)
    p = problem.fixed
    gram = np.zeros((1 + p + count + LAW_TERMS * half,) * 2)
    dense = np.column_stack([white.ravel(), turned])
    inner = dense.T @ dense
    wide = np.einsum("tb,tbk->tk", shift, dense.reshape(*shift.shape, -1))
    order = np.r_[0, 1 + np.arange(p), 1 + p + count + np.arange(LAW_TERMS * half)]
    gram[np.ix_(order, order)] = inner
    trials = 1 + p + np.arange(count)
    gram[np.ix_(trials, order)] = wide
    gram[np.ix_(order, trials)] = wide.T
    gram[trials, trials] = (shift**2).sum(axis=1)
    return SizeLikelihood(gram, (p, count, *[half] * LAW_TERMS), problem.law.error_priors)


def settle(problem: Problem, start: NDArray, sizes: Sizes, rounds: int = 2, iterations: int = 12) -> Fit:
    """Alternate the fit and the estimate of contact scatter and law error.

    Parameters
    ----------
    problem, start, iterations
        As for :func:`fit`.
    sizes : Sizes
        First guess of the sizes of noise and law error.
    rounds : int
        Fits, with an estimate of the sizes after each.

    Returns
    -------
    Fit
    """
    found = fit(problem, start, sizes, iterations)
    for _ in range(rounds - 1):
        sized = with_sizes(found)
        found = fit(problem, sized.vector, sized.sizes, iterations)
    return with_sizes(found)
