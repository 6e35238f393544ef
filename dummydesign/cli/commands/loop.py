"""``dummydesign loop``: residual, missing effect and corrected model of a measured campaign."""

from __future__ import annotations

import argparse
from textwrap import wrap
from typing import Any

from dummydesign.cli.text import file_lines, files_block, labelled, screen, warning_block, warning_lines
from dummydesign.core.tables import Table

HELP = "Find which effect the model lacks in a measured campaign, correct the model, and plan what to measure next."
CALL = "campaigns.calibrate"


ABOUT_STEPS = 18
"""Steps of a usual campaign: base, single effects, one more of them, the residual, the next measurement."""


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from pathlib import Path

    return f"loop-{Path(options.campaign).resolve().name}"


def render(result: dict[str, Any]) -> str:
    """The answer in words, then error and parameters before and after."""
    from dummydesign.loop.result import answer_rows, answer_words, read_as_words

    answer = answer_rows(result)
    answer = answer._replace(rows=[[*row[:6], *(f" {word}" for word in row[6:])] for row in answer.rows])
    coming, read_as = result["next_measurement"], read_as_words(result)
    return screen(
        [*labelled("RESULT", answer_words(result), 9), ""],
        [*(f"  {line}" for line in ("to read them so, in campaign.toml:", *read_as)), ""] if read_as else [],
        answer.lines("<20 >9 >9 >9 >9 >9 <1".split()),
        [""],
        warning_block(result),
        labelled("NEXT", coming["text"] if coming else "", 3),
        files_block(result, ("report", "first_page", "calibration")),
        labelled("MORE", "--details: evidence of each effect, rivals, what stays unexplained"),
    )


ERRORS = {
    "": "label:<12",
    "fitted N": "train_rmse_N:>9.4f",
    "held-out N": "heldout_rmse_N:>11.4f",
    "noise floor N": "noise_floor_N:>14.4f",
    "lack of fit p": "lack_of_fit_p:>14.4f",
}
PARAMETERS = {
    "parameter": "name:<12",
    "base": "base:>10.4g",
    "after": "value:>10.4g",
    "95 % low": "low:>10.4g",
    "95 % high": "high:>10.4g",
}


def render_details(result: dict[str, Any]) -> str:
    """The answer in words, then the readable tables."""
    lines = [line for text in result["answer"] for line in wrap(text, 110, subsequent_indent="  ")]
    lines += ["", f"verdict: {result['verdict']}"]
    over, expected = (result["residual"][f"{name}_over_noise_floor"] for name in ("heldout", "expected"))
    if over is not None:
        lines.append(f"left out: predicted to {over:.2f} noise floors; {expected:.2f} when nothing is missing")
    for reason in result["residual"]["unexplained_because"]:
        lines.append(f"  {result['verdict']}: {reason}")
    for effect in result["effects"]:
        lines.append(f"effect {effect['name']}: evidence {effect['evidence']:.0f} (needed {effect['threshold']:.0f})")
        for name, value in effect["parameters"].items():
            lines.append(f"  {name} = {value['value']:.4g}  (95 %: {value['low']:.4g} to {value['high']:.4g})")
        if effect["confounded_with"]:
            lines.append(f"  equally good explanations: {', '.join(effect['confounded_with'])}")
        if effect["family"]:
            lines.append(f"  indistinguishable in this campaign: {', '.join(effect['family'])}")
    models = [label for label in ("as_designed", "base", "after") if result[label]]
    errors = [{"label": label, **result[label]["error"]} for label in models]
    lines += Table.of(errors, ERRORS).lines(indent="")
    before = result["base"]["parameters"]
    parameters = result["after"]["parameters"].items()
    rows = [{"name": name, "base": before[name]["value"], **after} for name, after in parameters]
    lines += Table.of(rows, PARAMETERS).lines(indent="")
    ranked = [f"  {row['name']:<28} {row['evidence']:>10.1f}" for row in result["ranking"]]
    lines += ["evidence of each effect alone:" if ranked else "evidence of each effect alone: none has any", *ranked]
    if result["next_measurement"]:
        lines.append(f"next: {result['next_measurement']['text']}")
    return "\n".join(lines + warning_lines(result) + file_lines(result))
