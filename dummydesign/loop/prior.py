"""The posterior of one campaign as the prior of the next: checked for conflict first, then joined.

Both are normal around their optimum. What they share are the parameters of the material: modulus, arms, and effects
that belong to the pad. What belongs to the rig, to the sensor or to single pads is not carried over. Where the two
contradict each other beyond chance the new campaign stands alone, and what contradicts is named.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import Fit, settle
from dummydesign.loop.fitting.noise import LAW_TERMS
from dummydesign.loop.fitting.problem import BASE, Problem
from dummydesign.loop.judging.uncertainty import widened
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.parameters import NAMES
from dummydesign.measurement.campaign import Campaign
from dummydesign.resin.update.relaxation import POUR

if TYPE_CHECKING:
    from dummydesign.loop.calibration import Calibration

CONFLICT_P = 0.01
"""Probability of a larger difference by chance below which a prior is held to contradict the data."""
NAMED_Z = 2.5
"""Parameters that differ by more standard deviations than this are named."""
SAME_RATIO = 1e-3
ARM_TOLERANCE = POUR
"""Standard deviation of the logarithm of an arm's time and strength from campaign to campaign beside what the data say:
the next campaign presses newly cast pads, whose strengths scatter from pour to pour as pucks do."""


@dataclass(frozen=True)
class Joined:
    """How a prior met the data.

    Attributes
    ----------
    used : bool
        Whether it was joined; if not, the data contradict it.
    chi2, p : float
        Squared distance of prior and data over their joint covariance, and its probability by chance.
    conflicts : tuple of str
        Parameters that contradict, in words with both values.
    shared : tuple of str
        Parameters that both know.
    """

    used: bool
    chi2: float
    p: float
    conflicts: tuple[str, ...]
    shared: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "used": self.used, "chi2": self.chi2, "p": self.p, "conflicts": list(self.conflicts),
            "shared": list(self.shared),
        }  # fmt: skip


def check_prior(prior: Calibration, campaign: Campaign) -> None:
    """Refuse a prior that cannot speak of a campaign.

    Parameters
    ----------
    prior : Calibration
    campaign : Campaign

    Raises
    ------
    InputError
        For a calibration without a posterior (of an earlier version), or of another resin or ratio.
    """
    if prior.posterior is None:
        raise InputError("the prior's calibration has no posterior: it is of an earlier version; run loop again")
    for name, own, other in (
        ("resin", campaign.pad.resin, prior.pad["resin"]), ("ratio", campaign.pad.ratio, prior.pad["ratio"]),
    ):  # fmt: skip
        if own is None or other is None:
            continue
        same = own == other if isinstance(own, str) else abs(own - other) <= SAME_RATIO * abs(other)
        if not same:
            raise InputError(f"the prior is of {name} = {other}, the campaign of {name} = {own}: give one of the same")


def with_prior_effects(fit: Fit, prior: Calibration, presses: Presses, law: SetupLaw) -> Fit:
    """The model refitted with the prior's effects of the pad beside its own, as far as the campaign can take them.

    Parameters
    ----------
    fit : Fit
        The best model of the new campaign alone.
    prior : Calibration
    presses : Presses
        Of the new campaign.
    law : SetupLaw
    """
    known = {effect.name for effect in fit.problem.effects}
    more = [one for one in prior.design_effects() if one.effect.name not in known]
    more = [one for one in more if not one.effect.undefined(presses, law)]
    if not more:
        return fit
    problem = Problem(presses, law, (*fit.problem.effects, *(one.effect for one in more)))
    start = [p.to_coordinate(one.values[p.name]) for one in more for p in one.effect.parameters]
    at = fit.problem.fixed
    return settle(problem, np.r_[fit.vector[:at], start, fit.vector[at:]], fit.sizes, 2, 8)


def join(fit: Fit, prior: Calibration, lack_ratio: float | None = None) -> tuple[Fit, Joined]:
    """Join a prior to a fit, or leave the fit as it is where the two contradict each other.

    With H taking the vector to the shared parameters: gain K = C H' (H C H' + P)^-1, vector + K (m - H vector),
    covariance (1 - K H) C; C is widened by a lack of fit as the posterior's is, and P is the prior's covariance
    with :data:`ARM_TOLERANCE` for the arms.

    Parameters
    ----------
    fit : Fit
        Of the new campaign alone, effects of the prior included (:func:`with_prior_effects`).
    prior : Calibration
    lack_ratio : float, optional
        Lack of fit of the new campaign; above one it widens its covariance.

    Returns
    -------
    Fit
        With the vector, covariance, forces and residual of both together.
    Joined
    """
    from scipy.stats import chi2 as chi_square

    known = prior.posterior
    assert known is not None
    rows, own = _shared(fit, known.names)
    take = [known.names.index(name) for name, _, _ in own]
    turn = np.zeros((len(own), len(fit.vector)))
    turn[np.arange(len(own)), rows] = [unit for _, unit, _ in own]
    null = np.array([zero for _, _, zero in own])
    covariance = widened(fit, lack_ratio)
    arms = np.array([name.startswith(("log tau_", "log beta_")) for name, _, _ in own])
    there = known.covariance[np.ix_(take, take)] + np.diag(np.where(arms, ARM_TOLERANCE, 0.0) ** 2)
    together = turn @ covariance @ turn.T + there
    here = turn @ fit.vector + null
    away = known.mean[take] - here
    distance = float(away @ np.linalg.solve(together, away))
    p = float(chi_square.sf(distance, len(own)))
    names = tuple(name for name, _, _ in own)
    if p < CONFLICT_P:
        spread = np.sqrt(np.diag(together))
        order = np.argsort(-np.abs(away / spread))
        named = [k for k in order if abs(away[k]) > NAMED_Z * spread[k]] or [order[0]]
        words = tuple(_said(names[k], known.mean[take][k], here[k], abs(away[k] / spread[k])) for k in named)
        return fit, Joined(False, distance, p, words, names)
    gain = np.linalg.solve(together, turn @ covariance).T
    low, high = fit.problem.bounds()
    vector = np.clip(fit.vector + gain @ away, low, high)
    left = covariance - gain @ turn @ covariance
    forces = fit.problem.predict(vector)
    residual = np.where(fit.problem.presses.used, fit.problem.presses.force_N - forces, 0.0)
    both = 0.5 * (left + left.T)
    joined = replace(fit, vector=vector, covariance=both, forces=forces, residual=residual, joined=True)
    return joined, Joined(True, distance, p, (), names)


def _shared(fit: Fit, names: tuple[str, ...]) -> tuple[list[int], list[tuple[str, float, float]]]:
    """Places in the vector, and for each: the posterior's name, its unit per coordinate, its value at coordinate 0."""
    rows, own = list(range(BASE)), [(f"log {name}", 1.0, 0.0) for name in NAMES]
    own[0] = (own[0][0], 1.0, float(np.log(1e3)))  # MPa to kPa
    place = BASE
    for effect in fit.problem.effects:
        for parameter in effect.parameters:
            name = f"{'log ' if parameter.log else ''}{effect.name}.{parameter.name}"
            if effect.belongs_to == "pad" and name in names:
                rows.append(place)
                zero = float(np.log(parameter.typical)) if parameter.log else parameter.null
                own.append((name, 1.0 if parameter.log else parameter.typical, zero))
            place += 1
    return rows, own


def _said(name: str, prior: float, data: float, z: float) -> str:
    values = np.exp([prior, data]) if name.startswith("log ") else np.array([prior, data])
    return f"{name.removeprefix('log ')}: {values[0]:.4g} before, {values[1]:.4g} now ({z:.1f} standard deviations)"


def carried_law(
    prior: Calibration, pads: tuple[tuple[str, float], ...], law: NDArray
) -> tuple[tuple[tuple[str, float], ...], NDArray]:
    """Law errors of all pads that were pressed in either campaign; the new campaign's where both pressed a pad.

    Parameters
    ----------
    prior : Calibration
    pads : tuple of (str, float)
        Shape and thickness of the new campaign's pads. [-, mm]
    law : ndarray, shape (3, h)
        Their law errors.

    Returns
    -------
    pads : tuple of (str, float)
    law : ndarray, shape (3, all)
    """
    old = prior.after
    shapes = old.shapes or ("",) * len(old.thickness_mm)
    rows = {(shape, float(h)): old.law[:, k] for k, (shape, h) in enumerate(zip(shapes, old.thickness_mm))}
    rows |= {pad: law[:, k] for k, pad in enumerate(pads)}
    every = tuple(sorted(rows))
    return every, np.stack([rows[pad] for pad in every], axis=1).reshape(LAW_TERMS, -1)

