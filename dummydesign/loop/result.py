"""What the loop found: the JSON of `loop`, and the answer in words."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.core.tables import Table
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import Budget
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import Active
from dummydesign.loop.next_measurement import NextMeasurement
from dummydesign.loop.pad_scatter import pad_scatter
from dummydesign.loop.selection.cross_validation import AssessedModel, effect_intervals, lack_of_fit
from dummydesign.loop.selection.doubt_words import Doubt
from dummydesign.loop.selection.explanations import Among, Explanation, residual_N
from dummydesign.loop.selection.nonparametric_effect import NonparametricEffect
from dummydesign.loop.selection.residuals import ResidualDiagnostics
from dummydesign.loop.selection.search import Selection
from dummydesign.loop.selection.verdict import AcceptedEffect, AsDesigned, Remainder, gain_threshold
from dummydesign.measurement.campaign import Campaign


@dataclass(frozen=True)
class PooledFit(Serialised):
    """How a prior met the data."""

    used: bool
    chi2: float
    p: float
    conflicts: tuple[str, ...]
    shared: tuple[str, ...]


@dataclass(frozen=True)
class EffectModel:
    """A model that explains a campaign, with what it leaves; ``base_kept`` says why it is the base, no better fit."""

    selection: Selection
    after: AssessedModel
    effects: tuple[AcceptedEffect, ...]
    learnt: NonparametricEffect | None
    verdict: str
    remainder: Remainder
    seen: ResidualDiagnostics
    base_kept: str
    among: Among | None


@dataclass(frozen=True)
class LoopResult(EffectModel):
    """All that the loop found; ``seen_before`` is what the base leaves."""

    campaign: Campaign
    presses: Presses
    base: AssessedModel
    seen_before: ResidualDiagnostics
    next: NextMeasurement | None
    untested: dict[str, str]
    warnings: tuple[dict[str, str], ...]
    joined: PooledFit | None
    budget: Budget
    doubts: tuple[Doubt, ...] = ()
    designed: AsDesigned | None = None
    """The design's own prediction; None where the campaign declares no material with intervals."""


def result_dict(result: LoopResult) -> dict[str, Any]:
    """Return the result in the form of the ``loop`` contract."""
    effects = [accepted.candidate.effect for accepted in result.effects]
    errors = (result.base.errors.by_trial_N, result.after.errors.by_trial_N, result.after.errors.heldout_by_trial_N)
    screened, ranking = result.selection.screened, result.selection.ranking
    lack = lack_of_fit(ranking[0].fit).ratio if ranking else None
    return {
        "answer": answer_of(result),
        "doubts": to_plain(result.doubts),
        "worth": [asdict(worth_of(result, effect)) for effect in effects],
        "as_designed": to_plain(result.designed),
        "base": result.base.to_dict(),
        "verdict": result.verdict,
        "effects": [_effect(accepted, result) for accepted in result.effects],
        "after": result.after.to_dict(),
        "residual": {
            "where": to_plain(result.seen_before.where),
            "where_after": to_plain(result.seen.where),
            "unexplained_because": list(result.remainder.reasons),
            "heldout_over_noise_floor": result.remainder.over_floor,
            "expected_over_noise_floor": result.remainder.expected,
            "checks": to_plain(result.seen.checks),
            "by_trial": [
                {
                    "file": trial.file,
                    "thickness_mm": trial.thickness_mm,
                    "velocity_mm_s": trial.velocity_mm_s,
                    "base_rmse_N": float(base),
                    "rmse_N": float(after),
                    "heldout_rmse_N": float(left) if np.isfinite(left) else None,
                }
                for trial, base, after, left in zip(result.presses.trials, *errors)
            ],
        },
        # evidence that a first effect needs in this campaign
        "threshold": gain_threshold(screened, lack),
        "ranking": [{"name": c.effect.name, "evidence": c.gain} for c in ranking],
        "screening": [{"name": one.effect.name, "z": one.z} for one in screened],
        "pad_factors": pad_scatter(result.after.fit).to_dict(),
        "learned": to_plain(result.learnt),
        "ambiguity": None if result.among is None else _ambiguity(result.among),
        "untested": result.untested,
        "prior": to_plain(result.joined),
        "search": {name: getattr(result.budget, name) for name in ("models", "iterations", "stopped")},
        "next_measurement": to_plain(result.next),
        "warnings": list(result.warnings),
        "sources": sorted({effect.reference for effect in effects}),
    }


def _ambiguity(among: Among) -> dict[str, Any]:
    rows = [
        {
            "effects": [{"name": active.effect.name, "parameters": dict(active.values)} for active in _own(one)],
            "young_kPa": 1e3 * one.fit.base.young_MPa,
            "evidence": one.gain,
            "residual_N": residual_N(one.fit),
        }
        for one in among.found
    ]
    return {"explanations": rows, "base_residual_N": residual_N(among.base), "repeats_differ_N": among.differ_N}


def _own(one: Explanation) -> list[Active]:
    """The effects of an explanation with their values."""
    return [active for active in one.fit.active if active.effect.name in one.names]


def _effect(accepted: AcceptedEffect, result: LoopResult) -> dict[str, Any]:
    effect = accepted.candidate.effect
    return {
        "name": effect.name,
        "class": type(effect).__name__,
        "stage": effect.hook,
        "parameters": effect_intervals(result.after, effect),
        "heldout_rmse_N": accepted.heldout_N,
        "evidence": accepted.candidate.gain,
        "evidence_meaning": "drop of minus twice the log likelihood against the model without it",
        "threshold": accepted.threshold,
        "confounded_with": list(accepted.confounded_with),
        "family": list(accepted.family),
    }


@dataclass(frozen=True)
class Worth:
    """What an effect changes at the largest force of the campaign, and the most that it changes anywhere."""

    name: str
    change_N: float
    force_N: float
    file: str
    most_N: float
    most_file: str


def worth_of(result: LoopResult, effect: Effect) -> Worth:
    """What an effect of the corrected model is worth at the largest force that was measured."""
    fit, presses = result.after.fit, result.presses
    measured = np.where(presses.used, presses.force_N, -np.inf)
    row, column = np.unravel_index(int(np.argmax(measured)), measured.shape)
    change = fit.problem.change_by(effect, fit.vector, fit.forces)
    most, at = np.unravel_index(int(np.argmax(np.abs(change))), change.shape)
    files = presses.trials[row].file, presses.trials[most].file
    change_N, force_N = float(change[row, column]), float(fit.forces[row, column])
    return Worth(effect.name, change_N, force_N, files[0], float(change[most, at]), files[1])


def answer_of(result: LoopResult) -> list[str]:
    """The answer in sentences, the most important first."""
    after, joined = result.after, result.joined
    names = [named(accepted.candidate.effect.name) for accepted in result.effects]
    doubted = result.among is not None and len(result.among.found) != 1
    if result.among is not None and doubted:
        first = _ambiguity_text(result.among)
    elif result.verdict == "none":
        first = "Nothing is missing: the model describes the campaign down to its noise."
        if result.designed is not None and result.designed.held:
            first += " As designed: modulus and relaxation lie within the declared intervals."
    elif result.verdict == "effect":
        them = "it" if len(names) == 1 else "them"
        first = f"The model lacked {listed(names)}; with {them} the residual is noise."
    else:
        used = "is" if len(names) == 1 else "are"
        insufficient = f" {listed(names).capitalize()} {used} used, but not enough." if names else ""
        first = (
            f"Something is missing that no known effect explains.{insufficient} What remains: "
            f"{result.remainder.reasons[0]}."
        )
    # what the fit did not see comes first
    unseen = "".join(f"{one['message']}. " for one in result.warnings if one["code"] == "beyond_table")
    doubtful = f"Look at the sheet first: {'; '.join(one.text for one in result.doubts)}. " if result.doubts else ""
    lines = [doubtful + unseen + first]
    if result.among is None or not doubted:
        lines += [_effect_text(result, one.candidate.effect, one.confounded_with) for one in result.effects]
    else:
        lines += [_explanation_text(one) for one in result.among.found[:SHOWN]]
    if result.designed is not None:
        lines.append(
            f"The design's own prediction is {result.designed.rmse_N:.3g} N off (rms), nothing fitted; the refitted "
            f"material {result.base.errors.train_N:.3g} N."
        )
    before, left = result.base.errors.heldout_N, after.errors.heldout_N
    if left is not None and before is not None:
        way = "falls" if left < before else "goes"
        change = f"{way} from {before:.3g} to {left:.3g} N" if result.effects else f"is {left:.3g} N"
        floor = after.fit.sizes.floor_N
        lines.append(f"The error on presses left out of the fit {change}; noise alone leaves {floor:.2g} N.")
    parameters = after.to_dict()["parameters"]
    young = parameters["young_kPa"]
    lines.append(
        f"The long-term modulus is {young['value']:.3g} kPa (95 %: {young['low']:.4g} to {young['high']:.4g})."
        if young["determined"]
        else "The long-term modulus is not determined by this campaign."
    )
    unknown = [name for name, one in parameters.items() if not one["determined"] and name != "young_kPa"]
    if unknown and not result.presses.elastic_only:  # there arms are not fitted
        lines.append(f"Not determined by this campaign: {', '.join(unknown)}.")
    if joined is not None and joined.used:
        lines.append("The prior agrees with this campaign: modulus, relaxation and their intervals come from both.")
    elif joined is not None:
        lines.append(f"The prior contradicts this campaign, which stands alone: {'; '.join(joined.conflicts)}.")
    scatter = pad_scatter(after.fit)
    if scatter.recorded:
        lines.append(scatter.text)
    if result.next is not None:
        lines.append(f"Next: {result.next.text}.")
    return lines


def answer_words(data: dict[str, Any]) -> str:
    """The answer's sentences in one text, without the next measurement."""
    return " ".join(text.strip() for text in data["answer"] if not text.startswith("Next:"))


def read_as_words(data: dict[str, Any]) -> list[str]:
    """Lines of ``campaign.toml`` that read presses in doubt as they look, and what to write if the sheet is right."""
    if not data["doubts"]:
        return []
    lines = [line for one in data["doubts"] for line in one["read_as"].splitlines()]
    return [*lines, "# where the sheet is right: confirmed = true in place of the last line"]


def answer_rows(data: dict[str, Any]) -> Table:
    """Errors and parameters before and after; of an effect's parameters its name comes last."""
    rows, designed = [], data["as_designed"]
    for name, label in (("train", "fitted"), ("heldout", "left out")):
        models = (designed, data["base"], data["after"])
        errors = [None if one is None else one["error"][f"{name}_rmse_N"] for one in models]
        rows.append([f"error N, {label}", *("-" if error is None else f"{error:.4f}" for error in errors)])
    for name, after in data["after"]["parameters"].items():
        values = (data["base"]["parameters"][name]["value"], *(after[end] for end in ("value", "low", "high")))
        declared = [f"{designed['parameters'][name]:.4g}"] if designed else ["-"]
        rows.append([name, *declared, *(f"{value:.4g}" for value in values)])
    for effect in data["effects"]:
        rows += [
            [name, "-", "-", *(f"{value[end]:.4g}" for end in ("value", "low", "high")), f"({effect['name']})"]
            for name, value in effect["parameters"].items()
        ]
    return Table(["", "designed", "base", "corrected", "95 % low", "95 % high"], rows)


SHOWN = 4
"""Explanations that the answer lists; the JSON has all."""


def _ambiguity_text(among: Among) -> str:
    differ = f"presses of one condition differ by {among.differ_N:.2g} N" if among.differ_N else "no press is repeated"
    if not among.found:
        left = residual_N(among.base)
        return f"Nothing is missing beyond the difference of pads: {differ}, the model leaves {left:.2g} N."
    forces, moduli = (
        np.array(rows) for rows in zip(*((one.fit.forces, one.fit.base.young_MPa) for one in among.found))
    )
    known = [name for name in among.names if all(name in one.names for one in among.found)]
    doubted = listed([named(name) for name in among.names if name not in known], "or")
    apart = float(np.ptp(forces, axis=0).max())
    certain = f"{listed([named(name) for name in known]).capitalize()} is part of all explanations; " if known else ""
    # a puck that slips freely has the same force at the same strain, whatever its height
    shapes, other = ("pucks of one shape", "height") if among.one_shape else ("these pucks", "diameter")
    return (
        f"{certain}{doubted if certain else doubted.capitalize()}, or several of them: presses of {shapes} cannot "
        f"tell. Known: the force on pucks of these shapes ({differ}, the explanations by at most {apart:.2g} N). "
        f"Not known: the cause, and with it the modulus ({1e3 * moduli.min():.3g} to {1e3 * moduli.max():.3g} kPa). "
        f"Press pucks of another {other}, and one between lubricated plates."
    )


def _explanation_text(one: Explanation) -> str:
    sizes = []
    for active in _own(one):
        size = active.effect.parameters[0]
        unit = "" if size.unit == "1" else f" {size.unit}"
        sizes.append(f"{named(active.effect.name)} ({size.name} = {active.values[size.name]:.3g}{unit})")
    alone = " alone" if len(sizes) == 1 else ""
    young = 1e3 * one.fit.base.young_MPa
    return f"{listed(sizes).capitalize()}{alone}: modulus {young:.3g} kPa, leaves {residual_N(one.fit):.2g} N."


def _effect_text(result: LoopResult, effect: Effect, rivals: tuple[str, ...]) -> str:
    size = effect.parameters[0]
    value, worth = effect_intervals(result.after, effect)[size.name], worth_of(result, effect)
    unit = "" if size.unit == "1" else f" {size.unit}"
    span = f"95 %: {value['low']:.3g} to {value['high']:.3g}" if value["determined"] else "not determined"
    if abs(worth.change_N) < 0.1 * abs(worth.most_N):  # the largest force hides what the effect does
        change = f"changes forces by up to {worth.most_N:+.2g} N ({worth.most_file})"
    else:
        change = f"changes the largest force ({worth.force_N:.3g} N) by {worth.change_N:+.2g} N"
    text = f"{named(effect.name).capitalize()}: {size.name} = {value['value']:.3g}{unit} ({span}), {change}."
    if value["at_bound"]:
        text += " Its size is at the end of its range, so another cause is possible."
    if rivals:
        text += f" {listed([named(name) for name in rivals], 'or').capitalize()} would explain it as well."
    if effect.cause:
        text += f" Usual cause: {effect.cause}."
    if effect.remedy:
        text += f" {effect.remedy[0].upper()}{effect.remedy[1:]}."
    return text


def named(name: str) -> str:
    """The name of an effect in words."""
    return name.replace("_", " ")


def listed(names: list[str], last: str = "and") -> str:
    """Names in a sentence."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"
