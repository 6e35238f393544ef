"""The design's own prediction against a campaign, nothing fitted, and what its presses say of the declared material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.loop.fitting.fit import CampaignFit, fit_at
from dummydesign.loop.model.forward_model import base_names
from dummydesign.loop.selection.cross_validation import errors, lack_of_fit

CONTRADICTED = 3.0
"""Standard deviations by which a refitted number leaves what was declared, from which on they contradict each other."""


@dataclass(frozen=True)
class Agreement:
    """A number of the material: as declared, as refitted, and their distance in standard deviations."""

    name: str
    declared: float
    refitted: float
    distance: float


@dataclass(frozen=True)
class AsDesigned:
    """Error of the design's prediction over all samples [N], p of its lack of fit, and the numbers of its material."""

    rmse_N: float
    noise_floor_N: float
    lack_of_fit_p: float | None
    agreement: tuple[Agreement, ...]

    @property
    def held(self) -> bool:
        """Whether all refitted numbers lie inside the declared 95 % intervals."""
        return all(one.distance <= HALF_WIDTH for one in self.agreement)

    @property
    def contradicted(self) -> tuple[Agreement, ...]:
        """Numbers that leave what was declared by more than :data:`CONTRADICTED` standard deviations."""
        return tuple(one for one in self.agreement if one.distance > CONTRADICTED)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON: nothing is fitted, so that presses left out are predicted as all are."""
        error = {
            "train_rmse_N": self.rmse_N,
            "heldout_rmse_N": self.rmse_N,
            "noise_floor_N": self.noise_floor_N,
            "lack_of_fit_p": self.lack_of_fit_p,
        }
        return {"error": error, "held": self.held, "parameters": {one.name: one.declared for one in self.agreement}}


def as_designed(refitted: CampaignFit) -> AsDesigned | None:
    """Predict a campaign with its declared material; None where modulus or relaxation are not declared with intervals.

    A refit with a prior of standard deviation s that leaves p has moved to where its data alone differ from the prior
    by (refitted - declared) / sqrt(s^2 - p^2) standard deviations.
    """
    problem = refitted.problem
    prior, count = problem.prior, problem.base_count
    if not np.isfinite(prior.spread).all():
        return None
    design = fit_at(problem, problem.centre, refitted.sizes)
    learnt = prior.spread**2 - np.diag(refitted.covariance)[:count]
    distance = np.abs(refitted.vector[:count] - prior.mean) / np.sqrt(np.maximum(learnt, 1e-2 * prior.spread**2))
    declared, fitted = (problem.base_of(at).to_dict() for at in (prior.mean, refitted.vector))
    names = zip(base_names(prior.arms), distance.tolist())
    agreement = tuple(Agreement(name, declared[name], fitted[name], far) for name, far in names)
    return AsDesigned(errors(design).train_N, refitted.sizes.floor_N, lack_of_fit(design).p, agreement)
