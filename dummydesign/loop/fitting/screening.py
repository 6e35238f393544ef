"""Score screening: how much of the residual each effect could explain, to first order."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.loop.fitting.fit import CampaignFit, prior_precision
from dummydesign.loop.fitting.noise import Whitener
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import SMOOTH_TERMS


@dataclass(frozen=True)
class Screened:
    """One effect after screening."""

    effect: Effect
    z: float
    coordinate: float
    signature: NDArray
    start: NDArray


@dataclass(frozen=True)
class Projection:
    """Whitened residual and the space that base parameters, law error and accepted effects span.

    ``rows`` are those of priors, below the bins.
    """

    basis: NDArray
    residual: NDArray
    rows: int
    whiten: Whitener

    def column(self, change_N: NDArray) -> NDArray:
        """A change of the bins (T, B), whitened, with the rows of the priors."""
        return np.r_[self.whiten(change_N).ravel(), np.zeros(self.rows)]

    def remove(self, vector: NDArray) -> NDArray:
        """Take out of a whitened vector what the base could absorb."""
        return vector - self.basis @ (self.basis.T @ vector)


def project(fit: CampaignFit, law_free: bool = False) -> Projection:
    """Whiten a fit's residual with its prior rows and orthonormalise its sensitivities.

    ``law_free`` drops the prior rows of level, slope and curvature: then whatever such a law error of any size could
    do is taken out. Waves keep their prior.
    """
    problem = fit.problem
    whiten = fit.whitener
    scale = np.sqrt(prior_precision(problem, fit.sizes)[problem.fixed :])
    if law_free:
        scale[: SMOOTH_TERMS * len(problem.presses.pads)] = 0.0
    turned = fit.whitened_jacobian.reshape(-1, len(fit.vector))
    # the base parameters have no prior
    prior = np.diag(np.r_[np.zeros(problem.fixed), scale])[problem.fixed :]
    stacked = np.concatenate([turned, prior])
    norm = np.linalg.norm(stacked, axis=0)
    basis, singular, _ = np.linalg.svd(stacked / np.where(norm > 0, norm, 1.0), full_matrices=False)
    basis = basis[:, singular > 1e-9 * singular[0]]
    residual = np.r_[whiten(fit.residual).ravel(), -scale * fit.vector[problem.fixed :]]
    return Projection(basis, residual, len(prior), whiten)


def change_by(fit: CampaignFit, effect: Effect, start: NDArray) -> NDArray:
    """Change of the bins (T, B) when an effect joins what a fit holds, from a start of its coordinates. [N]"""
    problem, vector = fit.problem.plus(effect), np.insert(fit.vector, fit.problem.fixed, start)
    return np.where(problem.presses.used, problem.predict(vector) - fit.forces, 0.0)


def screen(fit: CampaignFit, candidates: tuple[Effect, ...]) -> list[Screened]:
    """Score all candidates at a fit, best first.

    One simulation per starting value of each effect; z = a . r / |a| with a the whitened change, base and
    law error projected out.
    """
    projection = project(fit)
    clean = projection.remove(projection.residual)
    out = []
    for effect in candidates:
        tried = []
        size_of = effect.parameters[0]
        low, high = sorted(size_of.to_coordinate(end) for end in (size_of.low, size_of.high))
        for start in starts_of(effect):
            change = change_by(fit, effect, start)
            if not np.all(np.isfinite(change)):
                values = ", ".join(f"{p.name} = {p.to_value(at):g}" for p, at in zip(effect.parameters, start))
                message = f"effect '{effect.name}' gives a force that is not finite at {values} on these trials"
                raise InputError(message, "out_of_range", "effect", effect.name)
            column = projection.remove(projection.column(change))
            length = float(np.linalg.norm(column))
            if length < 1e-6:
                continue
            z = float(column @ clean) / length
            size = z / length * start[0]
            inside = low - 1e-9 <= np.sign(size) * 1e-6 <= high + 1e-9
            tried.append(Screened(effect, z if inside else 0.0, size if inside else 0.0, column / length, start))
        if tried:
            out.append(max(tried, key=lambda one: abs(one.z)))
    return sorted(out, key=lambda one: -abs(one.z))


def starts_of(effect: Effect) -> list[NDArray]:
    """Coordinates to try: the typical size, with each start of a second parameter (its null if that is not 0)."""
    first, *others = effect.parameters
    size = 1.0 if first.to_value(1.0) != first.null else -1.0
    usual = [(p.typical if p.log or p.null == 0.0 else p.null, *p.starts) for p in others]
    grid = product(*([p.to_coordinate(value) for value in values] for p, values in zip(others, usual)))
    return [np.array([size, *rest]) for rest in grid]
