"""The whole loop: campaign in, verdict, corrected model and its errors out; and replay of a campaign."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import InputError
from dummydesign.core.progress import Progress, quiet
from dummydesign.loop.calibration import Calibration, check_prior, join, with_prior_effects
from dummydesign.loop.data.pad_modulus_factors import with_pad_factors
from dummydesign.loop.data.trials import Presses, make_presses
from dummydesign.loop.effects.registry import known_effects, refuse_unsound
from dummydesign.loop.fitting.candidates import EffectCandidate
from dummydesign.loop.fitting.fit import budget_spent, counted, fit_base
from dummydesign.loop.fitting.noise import repeat_pairs
from dummydesign.loop.model.campaign_law import law_of, within_reach
from dummydesign.loop.model.effect import Effect, SetupLaw
from dummydesign.loop.model.forward_model import readings
from dummydesign.loop.model.material import material_of
from dummydesign.loop.next_measurement import NextMeasurement, next_measurement
from dummydesign.loop.pad_scatter import known_pads
from dummydesign.loop.result import EffectModel, LoopResult, listed, named
from dummydesign.loop.selection.cross_validation import AssessedModel, assess
from dummydesign.loop.selection.doubts import doubts_of, without_doubted
from dummydesign.loop.selection.explanations import explain, one_shape
from dummydesign.loop.selection.holdout_test import left_out_errors, predicts_worse
from dummydesign.loop.selection.nonparametric_effect import can_be_learned, learn, learned_alone, learned_first
from dummydesign.loop.selection.residuals import ResidualDiagnostics, diagnose
from dummydesign.loop.selection.search import Selection, doubt_of, names_of, rank, search, without
from dummydesign.loop.selection.verdict import (
    GAIN_FLOOR,
    AcceptedEffect,
    as_designed,
    at_bound,
    needed,
    remainder,
)
from dummydesign.measurement.campaign import Campaign

HOLDS_WITHIN = 2.0
"""A calibration holds where its error is at most so many noise floors of its own campaign."""


@dataclass(frozen=True)
class Replayed:
    """A campaign predicted with a calibration: errors per trial and over all samples. [N]"""

    files: tuple[str, ...]
    rmse_N: NDArray
    base_rmse_N: NDArray
    peak_error_N: NDArray
    total_rmse_N: float
    total_base_rmse_N: float
    pads: tuple[dict[str, Any], ...] = ()
    """What was known of each pad's modulus and thickness before; empty where nothing was."""
    left_out: str = ""
    """Presses deeper than the force law of their pad, in words; empty where there are none."""

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON of ``replay``."""
        rows = zip(self.files, self.rmse_N, self.base_rmse_N, self.peak_error_N)
        return {
            "trials": [
                {"file": file, "rmse_N": float(own), "base_rmse_N": float(base), "peak_error_N": float(peak)}
                for file, own, base, peak in rows
            ],
            "rmse_N": self.total_rmse_N,
            "base_rmse_N": self.total_base_rmse_N,
            "known_pads": list(self.pads),
        }


@one_blas_thread()
def replay(campaign: Campaign, calibration: Calibration, progress: Progress = quiet) -> Replayed:
    """Predict a campaign with the corrected and with the base model, nothing fitted.

    ``peak_error_N`` is modelled minus measured largest force, both smoothed over five samples.
    """
    campaign, calibration = with_pad_factors(campaign, calibration.pad), calibration.at_ratio_of(campaign.pad)
    law = law_of(campaign, progress)
    progress("presses")
    campaign, presses, left_out = within_reach(campaign, make_presses(campaign), law, least=1)
    effects = [one.effect for one in calibration.after.active]
    for effect in effects:
        reason = effect.undefined(presses, law)
        if reason:
            message = f"the calibration holds {effect.name}, which this campaign cannot take: {reason}"
            raise InputError(message, "not_applicable", "effect", effect.name)
    refuse_unsound(effects, presses, law)
    progress("with what was found")
    shown = presses.at_samples(calibration.after.nodes(presses, law))
    after = [readings(presses, one, calibration.after.active) for one in shown]
    progress("with the base model")
    base = presses.at_samples(calibration.base.nodes(presses, law))
    measured = [trial.trace.force_N for trial in campaign.trials]
    weight = [len(force) for force in measured]
    smooth = np.ones(5) / 5.0
    peaks = [np.array([np.convolve(f, smooth, "valid").max() for f in forces]) for forces in (after, measured)]
    squares, base_squares = (
        np.array([float(np.mean((f - m) ** 2)) for f, m in zip(forces, measured)]) for forces in (after, base)
    )
    own, plain = (float(np.sqrt(np.average(one, weights=weight))) for one in (squares, base_squares))
    return Replayed(
        tuple(trial.file for trial in campaign.trials),
        np.sqrt(squares),
        np.sqrt(base_squares),
        peaks[0] - peaks[1],
        own,
        plain,
        known_pads(presses.trials),
        left_out,
    )


SEARCH_ITERATIONS = 1000
"""Iterations of fits after which no further model is begun; usual searches take 30 to 200, two effects up to 600."""


@one_blas_thread()
def close_loop(
    campaign: Campaign,
    progress: Progress = quiet,
    prior: Calibration | None = None,
    most_iterations: int = SEARCH_ITERATIONS,
) -> LoopResult:
    """Run the loop on a campaign.

    After ``most_iterations`` the best model so far is judged and returned, with a warning: work is counted, so that a
    busy machine gives the same answer.
    """
    if prior is not None:
        check_prior(prior, campaign)
    campaign = with_pad_factors(campaign, None if prior is None else prior.pad)
    law = law_of(campaign, progress)
    declared, every = campaign, make_presses(campaign)
    campaign, presses, beyond = within_reach(declared, every, law)
    material = material_of(campaign)
    with counted(most_iterations) as budget:
        first = fit_base(presses, law, 1e-3 * material.young_kPa.value, progress, material.prior)
        progress("checking the labels of the presses")
        # a label that is wrong is no effect, and would be taken for one
        doubts = doubts_of(declared, every, first)
        campaign, presses, first = without_doubted(campaign, presses, first, doubts)
        designed = as_designed(first)
        if designed is not None and designed.contradicted:
            free = first.problem.prior.released([one.name for one in designed.contradicted])
            first = fit_base(presses, law, first.base.young_MPa, progress, free)
        base = assess(first)
        available, untested = _available(presses, law)
        seen = diagnose(base.fit)
        explained = _explain(base, seen, available, progress)
    answer = _against_base(base, seen, explained, progress)
    if law.shape == "cylinder":
        base, answer = _of_pucks(base, answer, available, progress)
    plain, learnt = answer.after.fit, answer.learnt
    doubt = (
        doubt_of(plain, answer.selection.rivals)
        if learnt is None
        else doubt_of(plain, (), curve=learnt.effect.shape.flat)
    )
    after = replace(answer.after, fit=replace(plain, doubt=doubt))
    base = after if plain is base.fit else base
    joined = None
    if prior is not None:
        progress("prior")
        both = with_prior_effects(plain, prior)
        fit, joined = join(replace(both, doubt=doubt), prior, after.lack.ratio)
        after = assess(fit) if joined.used else after
    progress("next measurement")
    most = 2 if answer.among is None else len(answer.among.found)
    following = _next(campaign, base, answer.effects, answer.selection.ranking, most)
    result = LoopResult(
        **{**vars(answer), "after": after},
        campaign=campaign,
        presses=presses,
        base=base,
        seen_before=seen,
        next=following,
        untested=untested,
        warnings=(),
        joined=joined,
        doubts=doubts,
        designed=designed,
        budget=budget,
    )
    better = _better_alone(answer.selection, after) if answer.among is None else ()
    return replace(result, warnings=(*_warnings(result, beyond), *better))


def _explain(
    base: AssessedModel, seen: ResidualDiagnostics, available: tuple[Effect, ...], progress: Progress
) -> EffectModel:
    """Named effects and a learned function, whichever explain the campaign best; ``seen`` is what the base leaves."""
    ranked = rank(base, available, progress)
    alone = learned_alone(base, seen, ranked[1], progress)
    selection = search(base, available, progress, ranked) if alone is None else Selection(alone.after, (), *ranked)
    after, effects, learnt = selection.after, selection.effects, None if alone is None else alone.learnt
    progress("remainder")
    seen_after = seen if after is base else diagnose(after.fit)
    left = remainder(base, after, seen_after)
    verdict = "unexplained" if left.reasons or alone else "effect" if effects else "none"
    if left.reasons and not budget_spent():
        progress("learning the remainder")
        first = learned_first(base, seen, after, available, progress)
        if first is not None:
            learnt, after, effects = first.learnt, first.after, first.effects
        elif among := can_be_learned(seen_after):
            learnt = learn(after.fit, among)
            after = after if learnt is None else assess(learnt.fit)
    if learnt is not None:
        seen_after = diagnose(after.fit)
        still = remainder(base, after, seen_after)
        left = replace(still, reasons=(learnt.text, *still.reasons))
    return EffectModel(selection, after, effects, learnt, verdict, left, seen_after, "", None)


def _against_base(
    base: AssessedModel, seen: ResidualDiagnostics, answer: EffectModel, progress: Progress
) -> EffectModel:
    """The answer, or the base model where it predicts left-out presses better."""
    if answer.after is base:
        return answer
    progress("against the base model")
    compared = left_out_errors(base, answer.after)
    if not predicts_worse(compared):
        return answer
    dropped = (base.fit.score - answer.after.fit.score, answer.after.fit)
    rivals = (dropped, *((one.gain, one.fit) for one in answer.selection.ranking))
    left = remainder(base, base, seen)
    names = [named(one.candidate.effect.name) for one in answer.effects]
    names += [] if answer.learnt is None else [f"a function of {answer.learnt.effect.shape.text}"]
    errors = ", ".join(f"{one.kind} {one.corrected_N:.3g} N with it, {one.base_N:.3g} N without" for one in compared)
    kept = (
        f"{' and '.join(names)} explains this campaign but predicts left-out presses worse ({errors}): the base "
        "model is kept"
    )
    verdict = "unexplained" if left.reasons else "none"
    return EffectModel(replace(answer.selection, rivals=rivals), base, (), None, verdict, left, seen, kept, None)


def _of_pucks(
    base: AssessedModel, answer: EffectModel, available: tuple[Effect, ...], progress: Progress
) -> tuple[AssessedModel, EffectModel]:
    """Base and answer for pucks in the scatter of their specimens, with all causes that these cannot tell apart."""
    presses = base.fit.problem.presses
    single = one_shape(presses)
    if answer.verdict == "none" or (answer.verdict == "effect" and not single):
        return base, answer
    progress("what pucks of these shapes can tell apart")
    first: list[Effect | None] = [one.candidate.effect for one in answer.effects]
    contexts = (
        [without(answer.after.fit, one.candidate.effect) for one in answer.effects]
        if single and len(first) > 1
        else [base.fit]
    )
    for context, effect in zip(contexts, first or [None]):
        among = explain(context, available, single)
        if among is None or (answer.verdict == "effect" and (effect is None or effect.name not in among.names)):
            continue
        plain = assess(among.base)
        base = plain if context is base.fit else base
        if not among.found:
            none = Selection(plain, (), answer.selection.screened, answer.selection.ranking)
            left = replace(remainder(plain, plain, answer.seen), reasons=())
            return base, EffectModel(none, plain, (), None, "none", left, diagnose(plain.fit), "", among)
        best, after = among.found[0], assess(among.found[0].fit)
        others = tuple(name for name in among.names if name not in best.names)
        ranking = tuple(
            EffectCandidate(one.effects[-1].effect, one.fit, one.gain, one.effects[-1].screened) for one in among.found
        )
        accepted = tuple(
            AcceptedEffect(one, others, others, GAIN_FLOOR, after.errors.heldout_N, ranking) for one in best.effects
        )
        rivals = tuple((0.0, one.fit) for one in among.found[1:])
        chosen = Selection(after, accepted, answer.selection.screened, list(ranking), rivals)
        seen, alone = diagnose(after.fit), len(among.found) == 1
        cannot_tell = f"{listed([named(name) for name in among.names], 'or')}: these presses cannot tell"
        left = replace(remainder(plain, after, seen), reasons=() if alone else (cannot_tell,))
        verdict = "effect" if alone else "ambiguous"
        return base, EffectModel(chosen, after, accepted, None, verdict, left, seen, "", among)
    return base, answer


def _available(presses: Presses, law: SetupLaw) -> tuple[tuple[Effect, ...], dict[str, str]]:
    """Effects that can be fitted to these presses, and why each of the others cannot."""
    known = known_effects()
    reasons = {effect.name: effect.unavailable(presses, law) or effect.unseen(presses) for effect in known}
    if presses.elastic_only:
        reasons |= {effect.name: "needs holds or two speeds" for effect in known if effect.relaxes}
    usable = tuple(effect for effect in known if not reasons[effect.name])
    refuse_unsound(usable, presses, law)
    return usable, {name: reason for name, reason in reasons.items() if reason}


def _next(
    campaign: Campaign,
    base: AssessedModel,
    effects: tuple[AcceptedEffect, ...],
    ranking: list[EffectCandidate],
    most: int = 2,
) -> NextMeasurement | None:
    """Separate the ``most`` likeliest explanations: effect and runner-up, or nothing and the best candidate."""
    if not effects and not ranking:
        return None
    first, *others = (effects[0].candidate, *effects[0].ranking[1:most]) if effects else ranking[:1]
    fits = tuple(one.fit for one in others) or (base.fit,)
    names = tuple(one.effect.name for one in others) or ("none",)
    return next_measurement(first.fit, fits, (first.effect.name, *names), campaign.lowpass)


BETTER = 10.0
"""Minus twice the log likelihood by which an effect that was not taken must explain more than the model to be named."""


def _better_alone(selection: Selection, after: AssessedModel) -> Iterator[dict[str, str]]:
    """Single effects beyond noise that explain more than the model that is returned, and why they were not taken."""
    for one in selection.ranking:
        name = one.effect.name
        if name in names_of(after.fit) or one.fit.score >= after.fit.score - BETTER:
            continue
        if one.gain < needed(selection.screened, one.fit, name, {}, len(selection.ranking)).least:
            continue  # noise alone may explain as much
        why = "its size is at its bound" if at_bound(one.fit) else "it does not predict left-out presses better"
        message = f"{named(name)} alone fits better, but was not added: {why}; test for it by itself"
        yield {"code": "explains_more", "message": message}


def _warnings(result: LoopResult, beyond: str) -> list[dict[str, str]]:
    """What a reader must know: wrong labels first, then what the fit does not see."""
    campaign, presses, budget = result.campaign, result.presses, result.budget
    used = {trial.file for trial in presses.trials}
    declared = [
        f"{one.name} is {one.declared:.4g} as declared, {one.refitted:.4g} in these presses without any effect "
        f"({one.distance:.1f} standard deviations): it is fitted freely; check resin and ratio of the campaign"
        for one in (() if result.designed is None else result.designed.contradicted)
    ]
    labels = [
        f"{one.text}; {'it is' if len(one.files) == 1 else 'they are'} "
        f"{'used' if used & set(one.files) else 'left out'}"
        for one in result.doubts
    ]
    curve = "" if result.learnt is None else result.learnt.effect.shape.text
    hides_friction = result.verdict == "none" and campaign.pad.shape == "cylinder" and one_shape(presses)
    conflicts = "" if result.joined is None else "; ".join(result.joined.conflicts)
    rows: list[tuple[str, object, str]] = [
        *(("material_contradicted", True, text) for text in declared),
        *(("doubtful_label", True, text) for text in labels),
        (
            "search_stopped",
            budget.stopped,
            f"the search was stopped after {budget.iterations} iterations in {budget.models} models: the best model so "
            "far is used, and further effects were not tried",
        ),
        ("base_kept", result.base_kept, result.base_kept),
        (
            "modulus_beside_curve",
            curve,
            f"do not use the modulus: it shares its level with the learned curve of {curve}; compress a puck of this "
            "batch",
        ),
        (
            "friction_hidden",
            hides_friction,
            "pucks of one height can hide plate friction whole: the modulus is then too high; unless the plates were "
            "lubricated, press pucks of another height",
        ),
        ("beyond_table", beyond, beyond),
        *((one["code"], True, one["message"]) for one in campaign.warnings),
        (
            "no_repeats",
            not repeat_pairs(presses),
            "no condition is repeated: lack of fit cannot be tested against pure error, and the slow noise is taken "
            "from the residuals, where model error counts as noise",
        ),
        (
            "elastic_only",
            presses.elastic_only,
            "no trial holds and all have one speed: relaxation is not fitted, the modulus is that of this speed",
        ),
        ("prior_conflict", conflicts, f"the prior contradicts this campaign and was not used: {conflicts}"),
    ]
    return [{"code": code, "message": message} for code, holds, message in rows if holds]
