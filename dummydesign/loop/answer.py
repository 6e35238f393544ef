"""The answer of the loop in words: what was found, how large it is, what causes it as a rule, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.loop.fitting.problem import BASE
from dummydesign.loop.judging.assessed import effect_intervals
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.result import LoopResult


@dataclass(frozen=True)
class Worth:
    """What an effect changes at the largest force of the campaign.

    Attributes
    ----------
    force_N : float
        The largest force, as modelled with all effects. [N]
    change_N : float
        That force minus the one without this effect, all else equal. [N]
    file : str
        The trial in which it was measured.
    """

    force_N: float
    change_N: float
    file: str


def worth_of(result: LoopResult, effect: Effect) -> Worth:
    """What an effect of the corrected model is worth at the largest force that was measured."""
    fit = result.after.fit
    presses, vector = result.presses, fit.vector.copy()
    place = BASE
    for one in fit.problem.effects:
        for parameter in one.parameters:
            if one.name == effect.name:
                vector[place] = parameter.to_coordinate(parameter.null)
            place += 1
    measured = np.where(presses.used, presses.force_N, -np.inf)
    row, column = np.unravel_index(int(np.argmax(measured)), measured.shape)
    without = fit.problem.predict(vector)
    force = float(fit.forces[row, column])
    return Worth(force, force - float(without[row, column]), presses.trials[row].file)


def answer_of(result: LoopResult) -> list[str]:
    """The answer in sentences, the most important first.

    Returns
    -------
    list of str
        The verdict; then for each effect its size, what it is worth in newtons, its cause and the remedy; how far
        the error falls; what to measure next.
    """
    after, floor = result.after, result.after.fit.sizes.floor_N
    names = [named(found.candidate.effect.name) for found in result.effects]
    said = []
    if result.verdict == "none":
        said.append("Nothing is missing: the model describes the campaign down to its noise.")
    elif result.verdict == "effect":
        them = "it" if len(names) == 1 else "them"
        said.append(f"The model lacked {listed(names)}; with {them} what is left is noise.")
    else:
        used = "is" if len(names) == 1 else "are"
        found = f" beyond {listed(names)}, which {used} used all the same" if names else ""
        said.append(f"Something is missing that no known effect explains{found}: {result.remainder.reasons[0]}.")
    # what the fit did not see is said first
    said[0] = "".join(f"{one['message']}. " for one in result.warnings if one["code"] == "beyond_table") + said[0]
    said += [_effect_said(result, found.candidate.effect, found.confounded_with) for found in result.effects]
    before, left = result.base.errors.heldout_N, after.errors.heldout_N
    if left is not None and before is not None:
        change = f"falls from {before:.3g} to {left:.3g} N" if result.effects else f"is {left:.3g} N"
        said.append(f"The error on left-out conditions {change}; the noise floor is {floor:.2g} N.")
    young = after.to_dict()["parameters"]["young_kPa"]
    low, high = min(young["low"], young["high"]), max(young["low"], young["high"])
    said.append(f"The long-term modulus is {young['value']:.3g} kPa (95 %: {low:.4g} to {high:.4g}).")
    if result.joined is not None and result.joined.used:
        said.append("The prior agrees with this campaign: modulus, relaxation and their intervals come from both.")
    elif result.joined is not None:
        said.append(
            "The prior contradicts this campaign, which stands alone: " + "; ".join(result.joined.conflicts) + "."
        )
    if result.next is not None:
        said.append(f"Next: {result.next.text}.")
    return said


def _effect_said(result: LoopResult, effect: Effect, rivals: tuple[str, ...]) -> str:
    size = effect.parameters[0]
    value = effect_intervals(result.after, effect)[size.name]
    worth = worth_of(result, effect)
    unit = "" if size.unit == "1" else f" {size.unit}"
    text = (
        f"{named(effect.name).capitalize()}: {size.name} = {value['value']:.3g}{unit} (95 %: {value['low']:.3g} to "
        f"{value['high']:.3g}), worth {worth.change_N:+.2g} N at the largest force, {worth.force_N:.3g} N."
    )
    if rivals:
        text += f" {listed([named(name) for name in rivals], 'or').capitalize()} would explain it as well."
    if effect.cause:
        text += f" As a rule: {effect.cause}."
    if effect.remedy:
        text += f" {effect.remedy[0].upper()}{effect.remedy[1:]}."
    return text


def named(name: str) -> str:
    """The name of an effect in words."""
    return name.replace("_", " ")


def listed(names: list[str], last: str = "and") -> str:
    """Names in a sentence."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def answer_dict(result: LoopResult) -> dict[str, Any]:
    """What is added to the JSON of ``loop``: the answer, and what each effect is worth at the largest force."""
    worth = {found.candidate.effect.name: worth_of(result, found.candidate.effect) for found in result.effects}
    return {
        "answer": answer_of(result),
        "worth": [
            {"name": name, "change_N": one.change_N, "force_N": one.force_N, "file": one.file}
            for name, one in worth.items()
        ],
    }
