"""The whole loop: campaign in, verdict, corrected model and its errors out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.errors import InputError
from dummydesign.loop.base import fit_base, same_noise
from dummydesign.loop.candidates import Candidate, rank
from dummydesign.loop.checks import Check, run_checks
from dummydesign.loop.effects import EFFECTS
from dummydesign.loop.effects.base import Effect
from dummydesign.loop.fit import Fit
from dummydesign.loop.heldout import Errors, errors
from dummydesign.loop.lackoffit import LackOfFit, lack_of_fit
from dummydesign.loop.law import law_of
from dummydesign.loop.noise import repeat_pairs
from dummydesign.loop.parameters import NAMES
from dummydesign.loop.planning import NextMeasurement, next_measurement
from dummydesign.loop.presses import Presses, make_presses
from dummydesign.loop.screen import Screened
from dummydesign.loop.verdict import (
    GAIN_FLOOR,
    SECOND_FLOOR,
    SECOND_SHARE,
    Remainder,
    family_of,
    gain_threshold,
    remainder,
    rivals,
)
from dummydesign.loop.where import Dependence, dependences
from dummydesign.protocol.campaign import Campaign

Progress = Callable[[str], None]
NOTHING, LITTLE = 0.002, 0.02
"""Relative changes of a squared error that count as none on left-out conditions, and on left-out pads."""


@dataclass(frozen=True)
class Stage:
    """A model with its errors and its lack of fit."""

    fit: Fit
    errors: Errors
    by_pad: Errors
    lack: LackOfFit

    def to_dict(self) -> dict[str, Any]:
        """Parameters with 95 % intervals, and errors."""
        return {
            "parameters": base_intervals(self.fit),
            "error": {
                "train_rmse_N": self.errors.train_N,
                "heldout_rmse_N": self.errors.heldout_N,
                "heldout_pad_rmse_N": self.by_pad.heldout_N,
                "noise_floor_N": self.fit.sizes.floor_N,
                "lack_of_fit_p": self.lack.p,
                "lack_of_fit_ratio": self.lack.ratio,
            },
            "noise": self.fit.sizes.to_dict(),
        }


@dataclass(frozen=True)
class Found:
    """An accepted (or best) effect with the ranking it came from."""

    candidate: Candidate
    confounded_with: tuple[str, ...]
    family: tuple[str, ...]
    threshold: float
    heldout_N: float | None
    ranking: tuple[Candidate, ...]


@dataclass(frozen=True)
class LoopResult:
    """All that the loop found.

    Attributes
    ----------
    campaign, presses
    base, after : Stage
        Without and with the accepted effects; the same when there are none.
    verdict : str
        ``effect``, ``none`` or ``unexplained``.
    effects : tuple of Found
    screened : tuple of Screened
        Scores of all effects at the base.
    ranking : tuple of Candidate
        Joint fits at the base, best first.
    remainder : Remainder
    where, where_after : tuple of Dependence
        What the residual of the base and of the corrected model depends on.
    checks : tuple of Check
        Of the corrected model.
    next : NextMeasurement or None
    untested : dict
        Effects that this campaign cannot test, with the reason.
    warnings : tuple of dict
    """

    campaign: Campaign
    presses: Presses
    base: Stage
    after: Stage
    verdict: str
    effects: tuple[Found, ...]
    screened: tuple[Screened, ...]
    ranking: tuple[Candidate, ...]
    remainder: Remainder
    where: tuple[Dependence, ...]
    where_after: tuple[Dependence, ...]
    checks: tuple[Check, ...]
    next: NextMeasurement | None
    untested: dict[str, str]
    warnings: tuple[dict[str, str], ...]


def interval(fit: Fit, place: int, to_value: Callable[[float], float]) -> dict[str, Any]:
    """Value with its 95 % interval from the curvature at the optimum, widened by the lack of fit."""
    low, high = fit.problem.bounds()
    at, spread = fit.vector[place], 1.96 * float(np.sqrt(max(fit.covariance[place, place], 0.0)))
    ends = sorted((to_value(max(at - spread, low[place])), to_value(min(at + spread, high[place]))))
    bound = bool(at <= low[place] + 1e-6 or at >= high[place] - 1e-6)
    return {"value": to_value(at), "low": ends[0], "high": ends[1], "at_bound": bound}


def base_intervals(fit: Fit) -> dict[str, Any]:
    """Base parameters with 95 % intervals; modulus in kPa."""
    out = {}
    for place, name in enumerate(NAMES):
        unit = 1e3 if name == "young_kPa" else 1.0
        out[name] = interval(fit, place, lambda z, unit=unit: float(np.exp(z)) * unit)
    return out


def effect_intervals(fit: Fit, effect: Effect) -> dict[str, Any]:
    """Parameters of one fitted effect with 95 % intervals."""
    place = fit.problem.fixed - sum(len(e.parameters) for e in fit.problem.effects)
    for other in fit.problem.effects:
        if other.name == effect.name:
            return {p.name: interval(fit, place + i, p.to_value) for i, p in enumerate(other.parameters)}
        place += len(other.parameters)
    raise KeyError(effect.name)


def close_loop(campaign: Campaign, progress: Progress | None = None, young_MPa: float | None = None) -> LoopResult:
    """Run the loop on a campaign.

    Parameters
    ----------
    campaign : Campaign
    progress : callable, optional
        Called with a word for each step.
    young_MPa : float, optional
        Where to start the modulus; by default the nominal one of the campaign.

    Raises
    ------
    InputError
        When the campaign declares a set-up without a fast force law.
    """

    def tell(word: str) -> None:
        if progress is not None:
            progress(word)

    law = law_of(campaign)
    presses = make_presses(campaign)
    start = young_MPa or 1e-3 * start_young_kPa(campaign)
    base_fit = fit_base(presses, law, start, progress)
    base = _stage(base_fit)
    available, untested = _available(presses, law.shape)
    screened, ranking = rank(base_fit, available, progress)
    effects: list[Found] = []
    after = base
    first = _accept(base, screened, ranking, GAIN_FLOOR)
    if first is not None:
        after = _stage(same_noise(first.candidate.fit))
        effects.append(first)
        tell("second effect")
        rest = tuple(e for e in available if e.name != first.candidate.effect.name)
        more, second_ranking = rank(after.fit, rest, progress, keep=6, least_z=4.0)
        second = _accept(after, more, second_ranking, max(SECOND_FLOOR, SECOND_SHARE * first.candidate.gain))
        if second is not None:
            after = _stage(same_noise(second.candidate.fit))
            effects.append(second)
    tell("remainder")
    where_after = dependences(after.fit)
    checks = run_checks(after.fit)
    won = sum(found.candidate.gain for found in effects)
    left = remainder(base.lack, after.lack, won, where_after, checks)
    verdict = "unexplained" if left.reasons else "effect" if effects else "none"
    tell("next measurement")
    following = _next(campaign, base, effects, ranking)
    return LoopResult(
        campaign, presses, base, after, verdict, tuple(effects), tuple(screened), tuple(ranking), left,
        tuple(dependences(base.fit)), tuple(where_after), tuple(checks), following, untested,
        _warnings(campaign, presses, law),
    )  # fmt: skip


def _stage(fit: Fit) -> Stage:
    return Stage(fit, errors(fit), _pad_errors(fit), lack_of_fit(fit))


def _pad_errors(fit: Fit) -> Errors:
    """Errors with all trials on one thickness left out at a time, and with them its law error."""
    presses = fit.problem.presses
    return errors(fit, np.searchsorted(fit.problem.thicknesses, presses.thickness_mm))


def _at_bound(candidate: Candidate) -> bool:
    """Whether the size ended at the end of what is plausible: something else is being imitated."""
    size = candidate.effect.parameters[0]
    place = candidate.fit.problem.fixed - len(candidate.effect.parameters)
    value = size.to_value(candidate.fit.vector[place])
    reach = 1e-3 * (size.high - size.low)
    return value != size.null and (value <= size.low + reach or value >= size.high - reach)


def _change(before: Errors, after: Errors) -> float | None:
    """Relative change of the squared error on what both could predict; None when there is nothing."""
    both = np.isfinite(after.heldout_by_trial_N) & np.isfinite(before.heldout_by_trial_N)
    if not both.any():
        return None
    old, new = ((e.heldout_by_trial_N[both] ** 2).sum() for e in (before, after))
    return float(new / old - 1.0)


def _predicts_better(before: Stage, after: Fit) -> bool:
    """Whether left-out conditions are predicted better.

    What acts as one factor per pad is absorbed by the law error of that pad, so that other conditions on the
    same pad are predicted as well without the effect. Then whole pads, left out with their law error, decide.
    """
    cells = _change(before.errors, errors(after))
    if cells is not None and cells < -NOTHING:
        return True
    pads = _change(before.by_pad, _pad_errors(after))
    return (cells is None or cells < LITTLE) and pads is not None and pads < -LITTLE


def start_young_kPa(campaign: Campaign) -> float:
    """Nominal modulus of a campaign, or that of its resin at its ratio. [kPa]"""
    pad = campaign.pad
    if pad.young_kPa_nominal is not None:
        return pad.young_kPa_nominal
    if pad.resin is None or pad.ratio is None:
        raise InputError("campaign.toml: [pad] needs young_kPa_nominal, or resin and ratio")
    from dummydesign.resin import load_resin

    resin = load_resin(pad.resin)
    resin.check_ratio(pad.ratio)
    return float(resin.modulus_kPa(pad.ratio).value)


def _available(presses: Presses, shape: str) -> tuple[tuple[Effect, ...], dict[str, str]]:
    reasons = {effect.name: effect.unavailable(presses, shape) for effect in EFFECTS}
    if presses.elastic_only:
        relaxing = [effect.name for effect in EFFECTS if type(effect).arms is not Effect.arms]
        reasons.update({name: "needs holds or two speeds" for name in relaxing})
    usable = tuple(effect for effect in EFFECTS if not reasons[effect.name])
    return usable, {name: reason for name, reason in reasons.items() if reason}


def _accept(before: Stage, screened: list[Screened], ranking: list[Candidate], floor: float) -> Found | None:
    """The first candidate that beats the threshold inside its bounds and predicts left-out conditions better.

    Rivals that cannot be told from it may stand in for it there: which of them predicts best is chance.
    """
    inside = [candidate for candidate in ranking if not _at_bound(candidate)]
    for candidate in inside[:4]:
        ratio = lack_of_fit(candidate.fit).ratio
        threshold = gain_threshold(screened, ratio, floor)
        if candidate.gain < threshold:
            return None
        near = [c for c in rivals(inside, candidate, ratio) if c.gain <= candidate.gain]
        if not any(_predicts_better(before, c.fit) for c in (candidate, *near)):
            continue
        return Found(
            candidate, tuple(c.effect.name for c in rivals(inside, candidate, ratio)[:2]),
            tuple(family_of(candidate.screened, screened)), threshold, errors(candidate.fit).heldout_N,
            (candidate, *(c for c in inside if c is not candidate)),
        )  # fmt: skip
    return None


def _next(
    campaign: Campaign, base: Stage, effects: list[Found], ranking: list[Candidate]
) -> NextMeasurement | None:
    """Separate the two likeliest explanations: effect and runner-up, or nothing and the best candidate."""
    if effects:
        found = effects[0]
        other = found.ranking[1] if len(found.ranking) > 1 else None
        pair = (found.candidate.fit, base.fit if other is None else other.fit)
        names = (found.candidate.effect.name, "none" if other is None else other.effect.name)
    elif ranking:
        pair, names = (ranking[0].fit, base.fit), (ranking[0].effect.name, "none")
    else:
        return None
    return next_measurement(*pair, names, campaign.lowpass)


def _warnings(campaign: Campaign, presses: Presses, law: object) -> tuple[dict[str, str], ...]:
    out = list(campaign.warnings)
    if not repeat_pairs(presses):
        out.append(
            {"code": "no_repeats", "message": "no condition is repeated: lack of fit cannot be tested against pure "
             "error, and the slow noise is taken from the residuals, where model error counts as noise"}
        )  # fmt: skip
    if presses.elastic_only:
        out.append(
            {"code": "elastic_only", "message": "no trial holds and all have one speed: relaxation is not fitted, the "
             "modulus is that of this speed"}
        )  # fmt: skip
    deep = presses.depth_mm > law.limit(presses.thickness_mm)
    if deep.any():
        files = ", ".join(t.file for t, d in zip(presses.trials, deep) if d)
        out.append({"code": "beyond_table", "message": f"deeper than the force law knows: {files}"})
    return tuple(out)
