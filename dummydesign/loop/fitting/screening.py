"""Score screening: how much of the residual each effect could explain, to first order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.loop.fitting.fit import CampaignFit, prior_precision, rough_columns
from dummydesign.loop.fitting.noise import Whitener, make_whitener
from dummydesign.loop.model.effect import Effect


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

    def remove(self, vector: NDArray) -> NDArray:
        """Take out of a whitened vector what the base could absorb."""
        return vector - self.basis @ (self.basis.T @ vector)


def project(fit: CampaignFit, law_free: bool = False) -> tuple[Projection, Whitener]:
    """Whiten a fit's residual with its prior rows and orthonormalise its sensitivities.

    ``law_free`` drops the prior rows of level, slope and curvature: then whatever such a law error of any size could
    do is taken out. The roughness of a solved law keeps its prior.
    """
    problem = fit.problem
    whiten = make_whitener(problem.presses, fit.sizes.noise, fit.slope)
    scale = np.sqrt(prior_precision(problem, fit.sizes)[problem.fixed :]) * (0.0 if law_free else 1.0)
    turned = whiten(fit.jacobian).reshape(-1, len(fit.vector))
    rough = rough_columns(fit)
    count = rough.shape[-1]
    prior = np.zeros((len(scale) + count, len(fit.vector) + count))
    prior[: len(scale), problem.fixed : len(fit.vector)] = np.diag(scale)
    prior[len(scale) :, len(fit.vector) :] = np.eye(count)
    if count:
        turned = np.concatenate([turned, whiten(rough).reshape(len(turned), count)], axis=1)
    stacked = np.concatenate([turned, prior])
    norm = np.linalg.norm(stacked, axis=0)
    basis, singular, _ = np.linalg.svd(stacked / np.where(norm > 0, norm, 1.0), full_matrices=False)
    basis = basis[:, singular > 1e-9 * singular[0]]
    residual = np.r_[whiten(fit.residual).ravel(), -scale * fit.vector[problem.fixed :], np.zeros(count)]
    return Projection(basis, residual, len(prior)), whiten


def screen(fit: CampaignFit, candidates: tuple[Effect, ...]) -> list[Screened]:
    """Score all candidates at a fit, best first.

    One simulation per starting value of each effect; z = a . r / |a| with a the whitened change, base and
    law error projected out.
    """
    projection, whiten = project(fit)
    clean = projection.remove(projection.residual)
    out = []
    for effect in candidates:
        problem, at = fit.problem.plus(effect), fit.problem.fixed
        best: Screened | None = None
        for start in starts_of(effect):
            vector = np.insert(fit.vector, at, start)
            change = np.where(problem.presses.used, problem.predict(vector) - fit.forces, 0.0)
            if not np.all(np.isfinite(change)):
                values = ", ".join(f"{k} = {v:g}" for k, v in problem.active_of(vector)[-1].values.items())
                message = f"effect '{effect.name}' gives a force that is not finite at {values} on these trials"
                raise InputError(message, "out_of_range", "effect", effect.name)
            column = projection.remove(np.r_[whiten(change).ravel(), np.zeros(projection.rows)])
            length = float(np.linalg.norm(column))
            if length < 1e-6:
                continue
            z = float(column @ clean) / length
            size = z / length * start[0]
            low, high = sorted(effect.parameters[0].to_coordinate(end) for end in _ends(effect))
            inside = low - 1e-9 <= np.sign(size) * 1e-6 <= high + 1e-9
            entry = Screened(effect, z if inside else 0.0, size if inside else 0.0, column / length, start)
            if best is None or abs(entry.z) > abs(best.z):
                best = entry
        if best is not None:
            out.append(best)
    return sorted(out, key=lambda one: -abs(one.z))


def _ends(effect: Effect) -> tuple[float, float]:
    return effect.parameters[0].low, effect.parameters[0].high


def starts_of(effect: Effect) -> list[NDArray]:
    """Coordinates to try: the typical size, with each start of a second parameter (its null if that is not 0)."""
    first = effect.parameters[0]
    size = 1.0 if first.to_value(1.0) != first.null else -1.0
    rest = [(p.typical if p.log or p.null == 0.0 else p.null, *p.starts) for p in effect.parameters[1:]]
    grid: list[list[float]] = [[]]
    for parameter, values in zip(effect.parameters[1:], rest):
        grid = [[*g, parameter.to_coordinate(v)] for g in grid for v in values]
    return [np.r_[size, g] for g in grid]
