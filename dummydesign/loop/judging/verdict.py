"""From candidates to a verdict: effect, none or unexplained; thresholds, families, rivals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.fitting.problem import BASE
from dummydesign.loop.fitting.screening import Screened
from dummydesign.loop.judging.assessed import Stage
from dummydesign.loop.judging.lack_of_fit import lack_of_fit
from dummydesign.loop.judging.left_out import expected_heldout_N
from dummydesign.loop.judging.residual_checks import Check
from dummydesign.loop.judging.residual_dependence import Dependence

GAIN_FLOOR = 30.0
NEXT_FLOOR = 50.0
IMITATED = 0.015
"""Share of an effect's evidence up to which another that acts on the same bins is in doubt: laws of growth are never
quite the true ones, and what they leave must not be called an effect."""
RIVAL_GAP = 10.0
FAMILY_COSINE = 0.9
LACK_LIMIT = 1.5
LACK_P = 0.01
PROBE_LIMIT = 60.0
FORGIVEN = 1.0 / 6.0
"""Share of the evidence won that may follow one factor: laws of growth are never quite the true ones."""
LEFT_LIMIT = 1.3
"""Left-out error over what noise and the force law's own error let expect, up to which it counts as noise."""
DRAWS = 4000


def gain_threshold(screened: list[Screened], ratio: float | None, floor: float = GAIN_FLOOR) -> float:
    """Gain that an effect must beat: 99.9 % of the largest of all scores under noise, and not below ``floor``.

    The scores of all candidates are drawn with the correlations of their signatures. Noise models are never
    quite right, so the limit also grows with the lack of fit that the best candidate leaves.

    Parameters
    ----------
    screened : list of Screened
        Scores of all candidates with their signatures.
    ratio : float or None
        Lack of fit of the best candidate over the scatter of repeats, as a ratio of variances; None without repeats.
    floor : float
        Least threshold.

    Returns
    -------
    float
        In the score (minus two ln likelihood).
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
    """Evidence without which an effect is not accepted, and up to which it must lower the left-out error by much."""

    least: float
    doubted: float


def needed(screened: list[Screened], fit: Fit, name: str, others: dict[str, float], tried: int) -> Needed:
    """Evidence that an effect of a model must have beside others, when so many models were tried.

    Parameters
    ----------
    screened : list of Screened
        Scores of the effects from which this one was chosen.
    fit : Fit
        The model with all its effects.
    name : str
        The effect.
    others : dict
        Evidence of the other effects of the model by name.
    tried : int
        Models that were fitted.
    """
    floor = NEXT_FLOOR + 2.0 * float(np.log(max(tried, 1))) if others else GAIN_FLOOR
    where = _where(fit, {name, *others})
    left = max((gain * float(np.minimum(where[name], where[one]).sum()) for one, gain in others.items()), default=0.0)
    least = gain_threshold(screened, lack_of_fit(fit).ratio, floor)
    return Needed(least, max(least, IMITATED * left))


def _where(fit: Fit, names: set[str]) -> dict[str, NDArray]:
    """How the whitened squares of each effect's size spread over the bins (T, B); each sums to one."""
    whiten = make_whitener(fit.problem.presses, fit.sizes.noise, fit.slope, False)
    out, place = {}, BASE
    for effect in fit.problem.effects:
        if effect.name in names:
            squares = whiten(fit.jacobian[..., place]) ** 2
            out[effect.name] = squares / max(float(squares.sum()), 1e-300)
        place += len(effect.parameters)
    return out


def family_of(one: Screened, others: list[Screened]) -> list[str]:
    """Names of effects whose signature is nearly parallel: they cannot be told apart by this campaign."""
    return [
        other.effect.name
        for other in others
        if other.effect.name != one.effect.name and abs(float(one.signature @ other.signature)) > FAMILY_COSINE
    ]


def rivals(candidates: list[Candidate], first: Candidate, ratio: float | None) -> list[Candidate]:
    """Candidates that explain the data as well as ``first``, or nearly, likeliest first.

    Parameters
    ----------
    candidates : list of Candidate
        Best first.
    first : Candidate
        The one that is compared with.
    ratio : float or None
        Lack of fit that it leaves over the scatter of repeats, a ratio of variances; widens the gap that counts.

    Returns
    -------
    list of Candidate
    """
    gap = RIVAL_GAP * max(1.0, ratio or 1.0)
    return [c for c in candidates if c is not first and first.gain - c.gain < gap]


@dataclass(frozen=True)
class Remainder:
    """What a model leaves, and why it is held to be incomplete.

    Attributes
    ----------
    reasons : tuple of str
        Empty when what is left is noise.
    over_floor, expected : float or None
        Left-out error over the noise floor, and what noise, contact scatter and the parameters' uncertainty let expect.
    """

    reasons: tuple[str, ...]
    over_floor: float | None = None
    expected: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the reasons and both ratios."""
        return {
            "reasons": list(self.reasons), "heldout_over_noise_floor": self.over_floor,
            "expected_over_noise_floor": self.expected,
        }  # fmt: skip


def remainder(base: Stage, after: Stage, where: list[Dependence], checks: list[Check]) -> Remainder:
    """Judge what is left after the best model: noise, or something more.

    Parameters
    ----------
    base, after : Stage
        Without and with the accepted effects (the same when there are none).
    where, checks : list
        Of the best model.
    """
    reasons = [f"{check.name}: {check.text}" for check in checks if check.exceeded]
    floor, left = after.fit.sizes.floor_N, after.errors.heldout_N
    expected = expected_heldout_N(after.fit) / floor
    over = None if left is None else left / floor
    if over is not None and over > LEFT_LIMIT * expected:
        reasons.append(
            f"left-out conditions are predicted to {over:.2f} noise floors; noise and the force law's error would "
            f"leave {expected:.2f}, at most {LEFT_LIMIT * expected:.2f} is taken for noise"
        )
    lack = after.lack
    if lack.ratio is not None and lack.ratio > LACK_LIMIT and lack.p < LACK_P:
        reasons.append(f"lack of fit {lack.ratio:.2f} times the pure error of repeats (p = {lack.p:.4f})")
    # a law of growth that is a little off is allowed for
    scale, won = max(1.0, lack.ratio or 1.0), base.fit.score - after.fit.score
    for one in where:
        if one.excess > PROBE_LIMIT * scale and one.excess > FORGIVEN * won:
            reasons.append(f"residual follows {one.factor} ({one.excess:.0f} in chi2 beyond noise)")
            break
    return Remainder(tuple(reasons), over, expected)
