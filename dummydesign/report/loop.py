"""Report of a loop: verdict, effects with intervals, residual by trial before and after, what to measure next."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.loop.answer import answer_of, listed, named
from dummydesign.loop.result import LoopResult, result_dict
from dummydesign.report.html.page import Section, Table, write_report
from dummydesign.report.loop_figures import press_plots, ranking_plots, residual_plots, trial_plot
from dummydesign.report.press_figures import digits


def write_loop_report(folder: Path, result: LoopResult) -> dict[str, str]:
    """Write the report of a loop; see :func:`dummydesign.report.html.page.write_report`."""
    data = result_dict(result)
    base, after = (data[label]["error"] for label in ("base", "after"))
    facts = [
        (data["verdict"], "verdict"),
        *((named(effect["name"]), f"effect, evidence {effect['evidence']:.0f} where "
           f"{effect['threshold']:.0f} are needed") for effect in data["effects"]),
        (f"{base['train_rmse_N']:.3g} N", "rms residual of the base model"),
        (f"{after['train_rmse_N']:.3g} N", "rms residual of the corrected model"),
        (f"{after['noise_floor_N']:.3g} N", "noise floor"),
    ]  # fmt: skip
    left = data["residual"]
    if left["heldout_over_noise_floor"] is not None:
        expected = f"{left['expected_over_noise_floor']:.2f} when nothing is missing"
        words = f"noise floors of error on left-out conditions, {expected}"
        facts.insert(1, (f"{left['heldout_over_noise_floor']:.2f}", words))
    answer = answer_of(result)
    lead = f"{result.campaign.name}, {len(result.presses.trials)} trials. {answer[0]}"
    because = [f"Unexplained: {reason}." for reason in data["residual"]["unexplained_because"]]
    sections = [
        Section("Answer", "\n\n".join(answer[1:])),
        Section("Effects", "\n\n".join([*because, *_effect_words(data)]), ranking_plots(data), _effects(data)),
        Section("Error", "Left out: each thickness, speed and force predicted from the others.", table=_errors(data)),
        Section("Parameters of the pad", "", table=_parameters(data)),
        Section("Residual by trial", "", [trial_plot(result, data)]),
        Section("What the residual depends on", _where_words(data), residual_plots(result), _where(data)),
        *_next(data),
        Section("Force over time", "Dots are measured means over bins, broken lines the base model, full lines the "
                "corrected one; repeats of a condition share a figure.", list(press_plots(result))),
        *_untested(data),
    ]  # fmt: skip
    title = f"Loop: {result.campaign.name}"
    return write_report(folder, title, lead, sections, facts, data["warnings"], data["sources"])


def _effect_words(data: dict[str, Any]) -> list[str]:
    out = []
    for effect in data["effects"]:
        name = named(effect["name"])
        text = f"{name.capitalize()} acts at the {effect['stage']}."
        if effect["confounded_with"]:
            text += f" Explains the data as well: {listed([named(name) for name in effect['confounded_with']])}."
        if effect["family"]:
            text += f" Acts alike in this campaign: {listed([named(name) for name in effect['family']])}."
        out.append(text)
    return out or ["No effect was accepted."]


def _effects(data: dict[str, Any]) -> Table | None:
    rows = [
        [named(effect["name"]), name, *(digits(p[key]) for key in ("value", "low", "high")),
         "at bound" if p["at_bound"] else ""]
        for effect in data["effects"]
        for name, p in effect["parameters"].items()
    ]  # fmt: skip
    return Table(["effect", "parameter", "value", "95 % low", "95 % high", ""], rows) if rows else None


def _errors(data: dict[str, Any]) -> Table:
    keys = ("train_rmse_N", "heldout_rmse_N", "heldout_pad_rmse_N", "noise_floor_N", "lack_of_fit_p")
    rows = [[label, *(data[stage]["error"][key] for key in keys)] for label, stage in (("base", "base"),
            ("corrected", "after"))]  # fmt: skip
    head = ["model", "fitted rms N", "left out rms N", "left-out pads rms N", "noise floor N", "lack of fit p"]
    return Table(head, rows)


def _parameters(data: dict[str, Any]) -> Table:
    rows = [
        [name, *(digits(data["base"]["parameters"][name][key]) for key in ("value", "low", "high")),
         *(digits(p[key]) for key in ("value", "low", "high"))]
        for name, p in data["after"]["parameters"].items()
    ]  # fmt: skip
    return Table(["parameter", "base", "low", "high", "corrected", "low", "high"], rows)


def _where_words(data: dict[str, Any]) -> str:
    checks = "\n\n".join(f"{check['name']}: {check['text']}" for check in data["residual"]["checks"])
    return "Excess is the drop of chi-square by a factor's columns beyond what noise gives." + (
        f"\n\n{checks}" if checks else ""
    )


def _where(data: dict[str, Any]) -> Table:
    after = {row["factor"]: row for row in data["residual"]["where_after"]}
    rows = [
        [row["factor"], f"{row['excess']:.0f}", f"{100 * row['share']:.0f} %",
         f"{after[row['factor']]['excess']:.0f}" if row["factor"] in after else None]
        for row in data["residual"]["where"]
    ]  # fmt: skip
    return Table(["factor", "base: excess", "fraction of chi-square", "corrected: excess"], rows)


def _next(data: dict[str, Any]) -> list[Section]:
    plan = data["next_measurement"]
    if plan is None:
        return []
    separates = " from ".join(name.replace("_", " ") for name in plan["separates"])
    text = f"{plan['text'].capitalize()}. It separates {separates} by {plan['expected_gain']:.3g} in chi-square."
    rows = [[words, f"{gain:.3g}"] for words, gain in plan["alternatives"]]
    return [Section("Next measurement", text, table=Table(["else", "expected chi-square"], rows) if rows else None)]


def _untested(data: dict[str, Any]) -> list[Section]:
    if not data["untested"]:
        return []
    rows = [[name.replace("_", " "), why] for name, why in data["untested"].items()]
    return [Section("Not tested", "", table=Table(["effect", "why"], rows))]
