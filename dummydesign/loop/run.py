"""The whole loop: campaign in, verdict, corrected model and its errors out."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from dummydesign.core.threads import one_blas_thread
from dummydesign.loop.data.trials import Presses, make_presses
from dummydesign.loop.effects import known_effects
from dummydesign.loop.effects.own import refuse_unsound
from dummydesign.loop.fitting.base_fit import fit_base
from dummydesign.loop.fitting.candidates import Candidate
from dummydesign.loop.fitting.noise import repeat_pairs
from dummydesign.loop.judging.acceptance import Found
from dummydesign.loop.judging.assessed import Stage, make_stage
from dummydesign.loop.judging.residual_checks import run_checks
from dummydesign.loop.judging.residual_dependence import dependences
from dummydesign.loop.judging.search import search
from dummydesign.loop.judging.verdict import Remainder, remainder
from dummydesign.loop.learned.learn import can_be_learned, learn
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.expected import start_young_kPa
from dummydesign.loop.model.reach import within_reach
from dummydesign.loop.next_measurement import NextMeasurement, next_measurement
from dummydesign.loop.prior import Joined, check_prior, join, with_prior_effects
from dummydesign.loop.result import LoopResult
from dummydesign.measurement.campaign import Campaign

if TYPE_CHECKING:
    from dummydesign.loop.calibration import Calibration

Progress = Callable[[str], None]


@one_blas_thread()
def close_loop(
    campaign: Campaign,
    progress: Progress | None = None,
    young_MPa: float | None = None,
    prior: Calibration | None = None,
) -> LoopResult:
    """Run the loop on a campaign.

    Parameters
    ----------
    campaign : Campaign
        What was measured.
    prior : Calibration, optional
        Of an earlier campaign of the same material; see :mod:`dummydesign.loop.prior`.
    progress : callable, optional
        Called with a word for each step.
    young_MPa : float, optional
        Where to start the modulus; by default the nominal one of the campaign. [MPa]

    Raises
    ------
    InputError
        When the campaign declares a set-up without a fast force law.
    """

    def tell(word: str) -> None:
        if progress is not None:
            progress(word)

    if prior is not None:
        check_prior(prior, campaign)
    law = law_of(campaign, progress)
    campaign, presses, beyond = within_reach(campaign, make_presses(campaign), law)
    start = young_MPa or 1e-3 * start_young_kPa(campaign)
    base_fit = fit_base(presses, law, start, progress)
    base = make_stage(base_fit)
    available, untested = _available(presses, law)
    found = search(base, available, progress)
    after, effects = found.after, found.effects
    tell("remainder")
    where_after = dependences(after.fit)
    checks = run_checks(after.fit)
    left = remainder(base, after, where_after, checks)
    verdict = "unexplained" if left.reasons else "effect" if effects else "none"
    learnt = None
    if left.reasons and can_be_learned(checks, where_after):
        tell("learning what is left")
        learnt = learn(after.fit)
    if learnt is not None:
        after = make_stage(learnt.fit)
        where_after, checks = dependences(after.fit), run_checks(after.fit)
        still = remainder(base, after, where_after, checks)
        left = Remainder((learnt.text, *still.reasons), still.over_floor, still.expected)
    joined = None
    if prior is not None:
        tell("prior")
        fit, joined = join(with_prior_effects(after.fit, prior, presses, law), prior, after.lack.ratio)
        after = make_stage(fit) if joined.used else after
    tell("next measurement")
    following = _next(campaign, base, effects, found.ranking)
    return LoopResult(
        campaign, presses, base, after, verdict, effects, tuple(found.screened), tuple(found.ranking), left,
        tuple(dependences(base.fit)), tuple(where_after), tuple(checks), following, untested,
        (*_warnings(campaign, presses, beyond), *_contradicted(joined)), learnt, joined,
    )  # fmt: skip


def _contradicted(joined: Joined | None) -> tuple[dict[str, str], ...]:
    if joined is None or joined.used:
        return ()
    text = f"the prior contradicts this campaign and was not used: {'; '.join(joined.conflicts)}"
    return ({"code": "prior_conflict", "message": text},)


def _available(presses: Presses, law: SetupLaw) -> tuple[tuple[Effect, ...], dict[str, str]]:
    known = known_effects()
    reasons = {effect.name: effect.unavailable(presses, law) for effect in known}
    if presses.elastic_only:
        relaxing = [effect.name for effect in known if effect.relaxes]
        reasons.update({name: "needs holds or two speeds" for name in relaxing})
    usable = tuple(effect for effect in known if not reasons[effect.name])
    refuse_unsound(usable, presses, law)
    return usable, {name: reason for name, reason in reasons.items() if reason}


def _next(
    campaign: Campaign, base: Stage, effects: tuple[Found, ...], ranking: list[Candidate]
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


def _warnings(campaign: Campaign, presses: Presses, beyond: str) -> tuple[dict[str, str], ...]:
    # what a fit does not see is said first
    out = [{"code": "beyond_table", "message": beyond}] if beyond else []
    out += campaign.warnings
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
    return tuple(out)
