"""When an effect is accepted, the verdict: effect, none or unexplained, and the design's own prediction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.loop.fitting.candidates import EffectCandidate, Screened
from dummydesign.loop.fitting.fit import CampaignFit, fit_at, prior_precision
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.model.forward_model import base_names
from dummydesign.loop.selection.cross_validation import AssessedModel, Errors, errors, expected_heldout_N, lack_of_fit
from dummydesign.loop.selection.residuals import ResidualDiagnostics

GAIN_FLOOR = 30.0
EACH_PARAMETER = 12.0
"""Evidence that each parameter of a named effect costs where models of different kinds are compared."""
NEXT_FLOOR = 50.0
IMITATED = 0.015
"""Share of an effect's evidence up to which another that acts on the same bins is in doubt: laws of growth are never
quite the true ones, and what they leave must not be called an effect."""
FORM_ERROR_LIMIT = 0.1
"""Squared form error of the other effects, over the noise of a bin, up to which the bin shows an effect in doubt."""
LACK_LIMIT = 1.5
LACK_P = 0.01
PROBE_LIMIT = 60.0
FORGIVEN = 1.0 / 6.0
"""Share of the evidence won that may follow one factor: laws of growth are never quite the true ones."""
STATED = 3.0
"""Standard deviations, of the logarithm of its size, by which the law's error may exceed what is stated of it."""
LEFT_LIMIT = 1.3
"""Left-out error over what noise and the force law's own error let expect, up to which it counts as noise."""
DRAWS = 4000


def gain_threshold(screened: list[Screened], ratio: float | None, floor: float = GAIN_FLOOR) -> float:
    """Gain that an effect must beat: 99.9 % of the largest of all scores under noise, and not below ``floor``.

    The scores of all candidates are drawn with the correlations of their signatures. Noise models are never
    quite right, so the limit also grows with the lack of fit that the best candidate leaves.
    """
    if not screened:
        return floor
    signatures = np.stack([one.signature for one in screened], axis=1)
    correlation = signatures.T @ signatures
    root = np.linalg.cholesky(correlation + 1e-9 * np.eye(len(correlation)))
    draws = root @ np.random.default_rng(0).normal(size=(len(correlation), DRAWS))
    limit = float(np.quantile((draws**2).max(axis=0), 0.999))
    return max(limit, floor) * max(1.0, ratio or 1.0)


@dataclass(frozen=True)
class Needed:
    """Evidence without which an effect is not accepted, and up to which it must lower the left-out error by much, or
    have it on bins where the other effects do not act."""

    least: float
    doubted: float
    name: str


def gain_floor(without: CampaignFit) -> float:
    """Least evidence of an effect: a model that needs a law beyond its stated error is no rival as noise is."""
    return EACH_PARAMETER if laws_off(without) else GAIN_FLOOR


def needed(
    screened: list[Screened],
    fit: CampaignFit,
    name: str,
    others: dict[str, float],
    tried: int,
    first: float = GAIN_FLOOR,
) -> Needed:
    """Evidence that an effect of a model must have beside others, when so many models were tried, or as the first, or
    where the model without it needs a law beyond its stated error (:func:`gain_floor`)."""
    floor = NEXT_FLOOR + 2.0 * float(np.log(max(tried, 1))) if others and first >= GAIN_FLOOR else first
    where = _where(fit, {name, *others})
    left = max((gain * float(np.minimum(where[name], where[one]).sum()) for one, gain in others.items()), default=0.0)
    least = gain_threshold(screened, lack_of_fit(fit).ratio, floor)
    return Needed(least, max(least, IMITATED * left), name)


def _where(fit: CampaignFit, names: set[str]) -> dict[str, NDArray]:
    """How the whitened squares of each effect's size spread over the bins (T, B); each sums to one."""
    whiten = make_whitener(fit.problem.presses, fit.sizes.noise)
    squares = {name: whiten(fit.columns[..., fit.problem.entries[name][0]]) ** 2 for name in names}
    return {name: values / max(float(values.sum()), 1e-300) for name, values in squares.items()}


def separate_evidence(fit: CampaignFit, name: str) -> float:
    """Evidence of an effect's size on those bins alone that the form error of the other effects does not reach.

    Of each other effect the share :data:`IMITATED` of its squares may be form. Its evidence is the square of the size
    over its standard error there, base, law error and all other parameters free.
    """
    problem, quiet = fit.problem, np.zeros(fit.problem.presses.used.shape)
    whiten = fit.whitener
    for one in problem.effects:
        if one.name != name and not one.held:
            quiet += IMITATED * whiten(problem.change_by(one, fit.vector, fit.forces)) ** 2
    shown = problem.presses.used & (quiet < FORM_ERROR_LIMIT)
    rows, left = fit.whitened_jacobian[shown], whiten(fit.residual)[shown]
    prior = prior_precision(problem, fit.sizes)
    inverse = np.linalg.pinv(rows.T @ rows + np.diag(prior + 1e-9), rcond=1e-14, hermitian=True)
    index = problem.entries[name][0]
    size = fit.vector[index] + inverse[index] @ (rows.T @ left - prior * (fit.vector - problem.centre))
    return float(size**2 / max(inverse[index, index], 1e-300))


@dataclass(frozen=True)
class Remainder:
    """What a model leaves, and why it is held to be incomplete."""

    reasons: tuple[str, ...]
    over_floor: float | None = None
    expected: float | None = None


def laws_off(fit: CampaignFit) -> list[str]:
    """Each term in which the force law would have to be off by more than is stated of it, in words."""
    terms = zip(("slope", "curvature", "waves"), fit.sizes.law[1:], fit.problem.law.error_priors[1:])
    return [
        f"the force law would have to be off by {100.0 * size:.2g} % ({name} over depth), where {100.0 * median:.2g} % "
        "is stated"
        for name, size, (median, spread) in terms
        if np.log(size / median) > STATED * spread
    ]


def remainder(base: AssessedModel, after: AssessedModel, seen: ResidualDiagnostics) -> Remainder:
    """Judge the remainder of the best model: noise, or something more."""
    reasons = [f"{check.name}: {check.text}" for check in seen.checks if check.exceeded]
    floor, left = after.fit.sizes.floor_N, after.errors.heldout_N
    expected = expected_heldout_N(after.fit) / floor
    over = None if left is None else left / floor
    if over is not None and over > LEFT_LIMIT * expected:
        reasons.append(
            f"left-out conditions are predicted to {over:.2f} noise floors; noise and the force law's error would "
            f"leave {expected:.2f}, at most {LEFT_LIMIT * expected:.2f} is taken for noise"
        )
    lack = after.lack
    if lack.ratio is not None and lack.p is not None and lack.ratio > LACK_LIMIT and lack.p < LACK_P:
        reasons.append(f"lack of fit {lack.ratio:.2f} times the pure error of repeats (p = {lack.p:.4f})")
    reasons += laws_off(after.fit)
    # a law of growth that is a little off is allowed for
    scale, won = max(1.0, lack.ratio or 1.0), base.fit.score - after.fit.score
    for one in seen.where:
        if one.excess > PROBE_LIMIT * scale and one.excess > FORGIVEN * won:
            reasons.append(f"residual follows {one.factor} ({one.excess:.0f} in chi2 beyond noise)")
            break
    return Remainder(tuple(reasons), over, expected)


NOTHING, LITTLE, MUCH = 0.002, 0.02, 0.3
"""Relative changes of a squared error that count as none on left-out conditions, as none on left-out pads, and as so
much that no law of growth that is a little off could make it."""


@dataclass(frozen=True)
class AcceptedEffect:
    """An accepted (or best) effect with the ranking it came from."""

    candidate: EffectCandidate
    confounded_with: tuple[str, ...]
    family: tuple[str, ...]
    threshold: float
    heldout_N: float | None
    ranking: tuple[EffectCandidate, ...]


def predicts_better(before: AssessedModel, after: CampaignFit) -> bool:
    """Whether left-out conditions are predicted better.

    What acts as one factor per pad is absorbed by the law error of that pad, so that other conditions on the
    same pad are predicted as well without the effect. Then whole pads, left out with their law error, decide.
    """
    cells = _change(before.errors, errors(after))
    if cells is not None and cells < -NOTHING:
        return True
    pads = _change(before.by_pad, errors(after, after.problem.presses.pad))
    if pads is None or pads >= -LITTLE:
        return False
    # the law error of a single pad imitates what grows with depth: its conditions may lose some of what its law wins
    alone = len(after.problem.presses.pads) == 1 and pads < -MUCH
    return cells is None or cells < (MUCH if alone else LITTLE)


def much_better(before: Errors, after: Errors) -> bool:
    """Whether left-out conditions are predicted better by much."""
    change = _change(before, after)
    return change is not None and change < -MUCH


def worth(gain: float, limit: Needed, before: CampaignFit, after: CampaignFit) -> bool:
    """Whether an effect has the evidence it needs; where that is in doubt, whether it has it apart from the others or
    lowers the left-out error by much."""
    if gain < limit.least or gain >= limit.doubted:
        return gain >= limit.least
    return separate_evidence(after, limit.name) >= limit.least or much_better(errors(before), errors(after))


def at_bound(fit: CampaignFit) -> bool:
    """Whether the size of an effect ended at the end of what is plausible: something else is being imitated."""
    for one in fit.active:
        if one.effect.held:  # learned: its size is one
            continue
        size = one.effect.parameters[0]
        value, reach = one.values[size.name], 1e-3 * (size.high - size.low)
        if value != size.null and (value <= size.low + reach or value >= size.high - reach):
            return True
    return False


def _change(before: Errors, after: Errors) -> float | None:
    """Relative change of the squared error on what both could predict; None when there is nothing."""
    both = np.isfinite(after.heldout_by_trial_N) & np.isfinite(before.heldout_by_trial_N)
    if not both.any():
        return None
    old, new = ((e.heldout_by_trial_N[both] ** 2).sum() for e in (before, after))
    return float(new / old - 1.0)


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
