"""The posterior of one campaign as the prior of the next: checked for conflict first, then joined.

Both are normal around their optimum. What they share are the parameters of the material: modulus, arms, and effects
that belong to the pad. What belongs to the rig, to the sensor or to single pads is not carried over. Where the two
contradict each other beyond chance the new campaign stands alone, and what contradicts is named.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.loop.calibration import SAME_RATIO, Calibration
from dummydesign.loop.fitting.fit import CampaignFit, fit_with_noise
from dummydesign.loop.model.forward_model import parameter_names
from dummydesign.loop.model.material import ARM_TOLERANCE
from dummydesign.loop.result import PooledFit
from dummydesign.loop.selection.cross_validation import widened
from dummydesign.measurement.campaign import Campaign

CONFLICT_P = 0.01  # probability of a larger difference by chance below which a prior is held to contradict the data
NAMED_Z = 2.5  # parameters that differ by more standard deviations than this are named


def check_prior(prior: Calibration, campaign: Campaign) -> None:
    """Refuse a prior that cannot speak of a campaign."""
    if prior.posterior is None:
        raise InputError("the prior's calibration has no posterior: run loop again", "missing", "prior.posterior")
    pad, known = campaign.pad, prior.pad
    for name, own, other in (("resin", pad.resin, known["resin"]), ("ratio", pad.ratio, known["ratio"])):
        if own is None or other is None:
            continue
        same = own == other if isinstance(own, str) else abs(own - other) <= SAME_RATIO * abs(other)
        if not same:
            message = f"the prior is of {name} = {other}, the campaign of {name} = {own}: give one of the same"
            raise InputError(message, "inconsistent", f"prior.{name}", other, own)


def with_prior_effects(fit: CampaignFit, prior: Calibration) -> CampaignFit:
    """The model refitted with the prior's effects of the pad beside its own, as far as the campaign can take them."""
    problem = fit.problem
    more = [
        one
        for one in prior.design_effects()
        if one.effect.name not in problem.entries and not one.effect.undefined(problem.presses, problem.law)
    ]
    if not more:
        return fit
    start = [p.to_coordinate(one.values[p.name]) for one in more for p in one.effect.parameters]
    vector = np.insert(fit.vector, problem.fixed, start)
    return fit_with_noise(problem.plus(*(one.effect for one in more)), vector, fit.sizes, 2, 8)


def join(fit: CampaignFit, prior: Calibration, lack_ratio: float | None = None) -> tuple[CampaignFit, PooledFit]:
    """Join a prior to a fit, or leave the fit as it is where the two contradict each other.

    With H taking the vector to the shared parameters: gain K = C H' (H C H' + P)^-1, vector + K (m - H vector),
    covariance (1 - K H) C; C is widened by a lack of fit as the posterior's is, and P is the prior's covariance
    with :data:`ARM_TOLERANCE` for the arms.
    """
    from scipy.special import chdtrc

    known = prior.posterior
    assert known is not None
    entries, names, units, zeros = zip(*_shared(fit, known.names))
    take = [known.names.index(name) for name in names]
    turn = np.zeros((len(names), len(fit.vector)))
    turn[np.arange(len(names)), entries] = units
    covariance = widened(fit, lack_ratio)
    arms = np.array([name.startswith(("log tau_", "log beta_")) for name in names])
    there = known.covariance[np.ix_(take, take)] + np.diag(np.where(arms, ARM_TOLERANCE, 0.0) ** 2)
    together = turn @ covariance @ turn.T + there
    here = turn @ fit.vector + np.array(zeros)
    away = known.mean[take] - here
    distance = float(away @ np.linalg.solve(together, away))
    p = float(chdtrc(len(names), distance))
    if p < CONFLICT_P:
        spread = np.sqrt(np.diag(together))
        order = np.argsort(-np.abs(away / spread))
        named = [k for k in order if abs(away[k]) > NAMED_Z * spread[k]] or [order[0]]
        words = tuple(_conflict(names[k], known.mean[take][k], here[k], abs(away[k] / spread[k])) for k in named)
        return fit, PooledFit(False, distance, p, words, names)
    gain = np.linalg.solve(together, turn @ covariance).T
    low, high = fit.problem.bounds()
    vector = np.clip(fit.vector + gain @ away, low, high)
    left = covariance - gain @ turn @ covariance
    forces = fit.problem.predict(vector)
    residual = np.where(fit.problem.presses.used, fit.problem.presses.force_N - forces, 0.0)
    both = 0.5 * (left + left.T)
    joined = replace(fit, vector=vector, covariance=both, forces=forces, residual=residual, joined=True)
    return joined, PooledFit(True, distance, p, (), names)


def _shared(fit: CampaignFit, known: tuple[str, ...]) -> list[tuple[int, str, float, float]]:
    """Entry in the vector, name in the posterior, unit per coordinate and value at coordinate 0 of what is shared."""
    problem = fit.problem
    names = parameter_names(problem.prior.arms, problem.effects)
    # arms of another number are other arms: only the modulus is then shared
    same = sum(name.startswith("log beta_") for name in known) == problem.prior.arms
    own = [(effect, p) for effect in problem.effects for p in effect.parameters]
    return [
        (0, names[0], 1.0, float(np.log(1e3))),  # MPa to kPa
        *((entry, names[entry], 1.0, 0.0) for entry in range(1, problem.base_count if same else 1)),
        *(
            (entry, names[entry], 1.0, float(np.log(p.typical))) if p.log else (entry, names[entry], p.typical, p.null)
            for entry, (effect, p) in enumerate(own, problem.base_count)
            if effect.belongs_to == "pad" and names[entry] in known
        ),
    ]


def _conflict(name: str, prior: float, data: float, z: float) -> str:
    values = np.exp([prior, data]) if name.startswith("log ") else np.array([prior, data])
    return f"{name.removeprefix('log ')}: {values[0]:.4g} before, {values[1]:.4g} now ({z:.1f} standard deviations)"
