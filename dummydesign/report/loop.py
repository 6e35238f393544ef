"""Report of a loop and its figures: verdict, effects, residuals, presses."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.tables import Table
from dummydesign.loop.result import LoopResult, answer_rows, answer_words, listed, named, read_as_words, result_dict
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Panel, full_sentence, plot_drawing, warning_texts
from dummydesign.report.page import STYLES, Section, digits, log_start, unique, write_report
from dummydesign.report.plot import Plot, Series, press_plot

MOST_BARS = 12
FITTED_FROM = 2.0
"""Score from which an effect is fitted together with the base."""


def _screening(data: dict[str, Any]) -> list[Plot]:
    """Score of every effect that was tested, with the threshold from which it is fitted."""
    rows = sorted(data["screening"], key=lambda row: -abs(row["z"]))[:MOST_BARS]
    if not rows:
        return []
    labels, z = [named(row["name"]) for row in rows], np.array([row["z"] for row in rows])
    words = "; ".join(f"{label} {value:.1f}" for label, value in zip(labels, z))
    top = float(len(rows))
    ends = [-FITTED_FROM, -FITTED_FROM, np.nan, FITTED_FROM, FITTED_FROM]
    series = (
        Series.bars(labels, np.minimum(z, 0.0), np.maximum(z, 0.0)),
        Series.line(f"fitted from {FITTED_FROM:g} on", ends, [0.0, top, np.nan, 0.0, top], "aim"),
    )
    return [
        Plot(
            "screening",
            "Score of each effect at the base model",
            f"Score of each effect: {words}.",
            "score [standard deviations]",
            "",
            "z",
            "none",
            series,
            y_range=(0.0, top),
            note=f"the {len(rows)} largest of {len(data['screening'])}; one fit step, each effect alone",
        )
    ]


def _evidence(data: dict[str, Any]) -> list[Plot]:
    """Evidence where several effects were fitted; the square root keeps the small ones in sight."""
    rows = data["ranking"][:MOST_BARS]
    if len(rows) < 2:
        return []
    labels = [named(row["name"]) for row in rows]
    gain = np.array([max(row["evidence"], 0.0) for row in rows])
    words = "; ".join(f"{label} {value:.0f}" for label, value in zip(labels, gain))
    needed, top = data["threshold"], float(len(rows))
    series = (
        Series.bars(labels, np.zeros(len(rows)), np.sqrt(gain)),
        Series.line(f"needed: {needed:.0f}", [needed**0.5] * 2, [0.0, top], "aim"),
    )
    alt = f"Evidence of each effect alone: {words}; {needed:.0f} are needed."
    return [
        Plot(
            "evidence",
            "Evidence of each effect alone",
            alt,
            "root of evidence [-]",
            "",
            "root_of_evidence",
            "none",
            series,
            x_range=(0.0, 1.05 * max(float(np.sqrt(gain.max())), needed**0.5)),
            y_range=(0.0, top),
            note="evidence: drop of minus twice the log likelihood against the base model",
        )
    ]


def trial_plot(result: LoopResult, data: dict[str, Any]) -> Plot:
    """Rms residual of each trial before and after, with the noise floor."""
    rows = data["residual"]["by_trial"]
    number = np.arange(1, len(rows) + 1, dtype=float)

    def column(key: str) -> NDArray:
        return np.array([row[key] for row in rows], float)

    floor = data["after"]["error"]["noise_floor_N"]
    series = (
        Series.dots("base", number, column("base_rmse_N"), "aim"),
        Series.dots("corrected", number, column("rmse_N")),
        Series.dots("corrected, its condition left out", number, column("heldout_rmse_N"), "other"),
        Series.line("noise floor", number[[0, -1]], [floor, floor], "other"),
    )
    worst = max(rows, key=lambda row: row["rmse_N"])
    alt = (
        f"Rms residual of each of {len(rows)} trials before and after; the worst after is {worst['file']} with "
        f"{worst['rmse_N']:.3g} N, it was {worst['base_rmse_N']:.3g} N; the noise floor is {floor:.3g} N."
    )
    return Plot(
        "by-trial",
        "Rms residual of each trial",
        alt,
        "trial [number in the campaign]",
        "rms residual [N]",
        "trial",
        "rmse_N",
        series,
        note="in the order of campaign.toml",
    )


def _groups(result: LoopResult) -> Iterator[tuple[str, NDArray]]:
    """Name and rows of each condition, by thickness, speed and depth."""
    presses = result.presses
    groups = [np.nonzero(presses.cell == cell)[0] for cell in np.unique(presses.cell)]
    groups.sort(
        key=lambda rows: (
            presses.thickness_mm[rows[0]],
            presses.trials[rows[0]].velocity_mm_s,
            presses.depth_mm[rows[0]],
        )
    )
    for rows in groups:
        trial = presses.trials[rows[0]]
        force = trial.target_force_N
        level = f"{force:g} N" if force is not None else f"{presses.depth_mm[rows[0]]:.2g} mm deep"
        yield f"{trial.thickness_mm:g} mm, {trial.velocity_mm_s:g} mm/s, {level}", rows


def _times(result: LoopResult, row: int) -> tuple[NDArray, NDArray]:
    """Bins that are used and lie after contact, and their times since contact. [s]"""
    presses = result.presses
    middle = 0.5 * (presses.bins.start[row] + presses.bins.end[row]) - presses.contact_s[row]
    shown = presses.used[row] & (middle > 0)
    return shown, middle[shown]


def residual_plots(result: LoopResult) -> list[Plot]:
    """One figure a pad, all at one scale: what the base model and the corrected one leave of every trial."""
    presses, floor = result.presses, 3.0 * result.after.fit.sizes.floor_N
    stages = [("base", result.base, "aim"), ("corrected", result.after, "main")]
    if result.base is result.after:
        del stages[0]
    left = {name: np.where(presses.used, presses.force_N - model.fit.forces, 0.0) for name, model, _ in stages}
    times = [_times(result, row) for row in range(len(presses.trials))]
    reach = max(1.5 * floor, *(float(np.abs(values).max()) for values in left.values()))
    ends = (max(min(float(time[0]) for _, time in times), 1e-3), max(float(time[-1]) for _, time in times))
    plots = []
    for number, (shape, thickness) in enumerate(presses.pads):
        rows = np.nonzero(presses.pad == number)[0]
        series: list[Series] = [
            Series.band("three noise floors", np.array(ends), np.full(2, -floor), np.full(2, floor))
        ]
        words = []
        for name, _, style in stages:
            curves = [(times[row][1], left[name][row][times[row][0]]) for row in rows]
            time, most = max(curves, key=lambda curve: float(np.max(np.abs(curve[1]))))
            at = int(np.argmax(np.abs(most)))
            series += [Series.line(name, *curve, style) for curve in curves]
            series.append(Series.words(name, float(time[at]), float(most[at]), style))
            words.append(f"{name} at most {abs(float(most[at])):.3g} N")
        pad = f"{thickness:g} mm{' ' + shape if shape else ''}"
        plots.append(
            Plot(
                f"residual-pad-{number + 1}",
                f"Residual on the {pad} pad",
                f"{pad}: {'; '.join(words)}.",
                "time since contact [s]",
                "measured - modelled [N]",
                "time_s",
                "residual_N",
                series,
                log_x=True,
                x_range=ends,
                y_range=(-1.05 * reach, 1.05 * reach),
            )
        )
    return plots


def press_plots(result: LoopResult) -> Iterator[Plot]:
    """Force over time of each condition: measured, base and corrected."""
    presses = result.presses
    names: set[str] = set()
    base, after = (model.fit.forces for model in (result.base, result.after))
    for label, rows in _groups(result):
        series, ends, rises, rms = list[Series](), [], [], []
        for number, row in enumerate(rows):
            shown, time = _times(result, row)
            own = "" if len(rows) == 1 else f", {presses.trials[row].file}"
            series.append(
                Series.dots(
                    f"measured{own}",
                    time,
                    presses.force_N[row][shown],
                    "other" if len(rows) == 1 else STYLES[number % len(STYLES)],
                )
            )
            series.append(Series.line(f"base{own}", time, base[row][shown], "aim"))
            series.append(Series.line(f"corrected{own}", time, after[row][shown], STYLES[number % len(STYLES)]))
            ends.append(float(time[-1]))
            rises.append(float(presses.stop_s[row] - presses.contact_s[row]))
            rms.append((result.base.errors.by_trial_N[row], result.after.errors.by_trial_N[row]))
        before, left = (float(np.sqrt(np.mean(np.square(column)))) for column in zip(*rms))
        peak = float(presses.force_N[rows].max())
        alt = (
            f"Force over time on a logarithmic axis, {label}: peak {peak:.3g} N, rms residual {before:.3g} N before "
            f"and {left:.3g} N after."
        )
        name = unique("press-" + label.replace(" mm/s", "mm-s").replace(", ", "-").replace(" ", ""), names)
        title = f"{label}: rms {1e3 * before:.0f} to {1e3 * left:.0f} mN"
        yield press_plot(name, title, alt, series, (log_start(min(rises)), max(ends)))


def write_loop_report(folder: Path, result: LoopResult) -> dict[str, str]:
    """Write the report of a loop; see :func:`dummydesign.report.page.write_report`."""
    data = result_dict(result)
    base, after = (data[label]["error"] for label in ("base", "after"))
    facts = [
        (data["verdict"], "verdict"),
        *(
            (
                named(effect["name"]),
                f"effect, evidence {effect['evidence']:.0f} where {effect['threshold']:.0f} are needed",
            )
            for effect in data["effects"]
        ),
        (f"{base['train_rmse_N']:.3g} N", "rms residual of the base model"),
        (f"{after['train_rmse_N']:.3g} N", "rms residual of the corrected model"),
        (f"{after['noise_floor_N']:.3g} N", "noise floor"),
    ]
    left = data["residual"]
    if left["heldout_over_noise_floor"] is not None:
        expected = f"{left['expected_over_noise_floor']:.2f} when nothing is missing"
        words = f"error on presses left out of the fit, over the noise; {expected}"
        facts.insert(1, (f"{left['heldout_over_noise_floor']:.2f}", words))
    answer, presses = data["answer"], list(press_plots(result))
    lead = f"{result.campaign.name}, {len(result.presses.trials)} trials. {answer[0]}"
    because = [f"{data['verdict'].capitalize()}: {reason}." for reason in data["residual"]["unexplained_because"]]
    sections = [
        Section("Answer", "\n\n".join(answer[1:])),
        *_sheet(data),
        Section(
            "Effects",
            "\n\n".join([*because, *_effect_words(data)]),
            [*_screening(data), *_evidence(data)],
            _effects(data),
        ),
        Section("Error", "Left out: each thickness, speed and force predicted from the others.", table=_errors(data)),
        Section("Parameters of the pad", "", table=_parameters(data)),
        Section("Residual by trial", "", [trial_plot(result, data)]),
        Section("What the residual depends on", _where_words(data), residual_plots(result), _where(data)),
        *_next(data),
        Section(
            "Force over time",
            "Dots are measured means over bins, broken lines the base model, full lines the "
            "corrected one; repeats of a condition share a figure.",
            presses,
        ),
        *_untested(data),
    ]
    title = f"Loop: {result.campaign.name}"
    return write_report(
        folder,
        title,
        lead,
        sections,
        facts=facts,
        warnings=data["warnings"],
        sources=data["sources"],
        front=_front(title, data, presses, trial_plot(result, data)),
    )


def _sheet(data: dict[str, Any]) -> Iterator[Section]:
    """Labels in doubt, and the lines that read them as they look."""
    if data["doubts"]:
        rows = [[one["kind"], one["text"], f"{abs(one['z']):.1f}"] for one in data["doubts"]]
        words = "Nothing is read otherwise before these lines are in campaign.toml:\n\n" + "\n\n".join(
            read_as_words(data)
        )
        yield Section("Labels in doubt", words, table=Table(["kind", "what", "standard deviations"], rows))


def _front(title: str, data: dict[str, Any], presses: list[Plot], trials: Plot) -> FrontPage:
    """The first page: answer, residual of each trial, presses, parameters, next measurement."""
    base, after = (data[model]["error"] for model in ("base", "after"))
    young, coming = data["after"]["parameters"]["young_kPa"], data["next_measurement"]
    texts = [plot.title.partition(": ") for plot in presses]
    answer = answer_rows(data)
    change = f"{base['train_rmse_N']:.3g} to {after['train_rmse_N']:.3g} N"
    facts = [Fact("rms residual, base to corrected", change, True)]
    if base["heldout_rmse_N"] is not None and after["heldout_rmse_N"] is not None:
        change = f"{base['heldout_rmse_N']:.3g} to {after['heldout_rmse_N']:.3g} N"
        facts.append(Fact("on presses left out of the fit, base to corrected", change))
    facts.append(Fact("noise floor", f"{after['noise_floor_N']:.3g} N"))
    if young["determined"]:
        words = f"{young['value']:.3g} kPa (95 %: {young['low']:.4g} to {young['high']:.4g})"
        facts.append(Fact("long-term modulus", words))
    blocks = [
        ("Effects", _effect_words(data)),
        (data["verdict"].capitalize(), [full_sentence(text) for text in data["residual"]["unexplained_because"]]),
    ]
    return FrontPage(
        title,
        f"{len(data['residual']['by_trial'])} trials; base: the model without effects.",
        (None, answer_words(data)),
        ("Rms residual of each trial", plot_drawing(trials)),
        "Result",
        facts,
        "Force [N] over time since contact",
        [Panel(plot, words[0], words[2]) for plot, words in zip(presses, texts)],
        [("dots", "measured"), ("aim", "base"), ("main", "corrected")],
        Table([*answer.head, ""], answer.rows),
        [(name, texts) for name, texts in blocks if texts],
        warning_texts(data["warnings"]),
        [full_sentence(coming["text"])] if coming else [],
        foot=FOOT,
    )


def _effect_words(data: dict[str, Any]) -> list[str]:
    out = []
    for effect in data["effects"]:
        name = named(effect["name"])
        text = f"{name.capitalize()} acts on the {effect['stage']}."
        if effect["confounded_with"]:
            text += f" Would explain the data as well: {listed([named(name) for name in effect['confounded_with']])}."
        if effect["family"]:
            text += f" Looks the same in this campaign: {listed([named(name) for name in effect['family']])}."
        out.append(text)
    return out or ["No effect was accepted."]


def _effects(data: dict[str, Any]) -> Table | None:
    rows = [
        [
            named(effect["name"]),
            name,
            *(digits(p[key]) for key in ("value", "low", "high")),
            "at bound" if p["at_bound"] else "",
        ]
        for effect in data["effects"]
        for name, p in effect["parameters"].items()
    ]
    return Table(["effect", "parameter", "value", "95 % low", "95 % high", ""], rows) if rows else None


def _errors(data: dict[str, Any]) -> Table:
    rows = ({"model": label, **data[model]["error"]} for label, model in (("base", "base"), ("corrected", "after")))
    return Table.of(
        rows,
        {
            "model": "model",
            "fitted rms N": "train_rmse_N",
            "left out rms N": "heldout_rmse_N",
            "left-out pads rms N": "heldout_pad_rmse_N",
            "noise floor N": "noise_floor_N",
            "lack of fit p": "lack_of_fit_p",
        },
    )


def _parameters(data: dict[str, Any]) -> Table:
    rows = [
        [
            name,
            *(digits(data["base"]["parameters"][name][key]) for key in ("value", "low", "high")),
            *(digits(p[key]) for key in ("value", "low", "high")),
        ]
        for name, p in data["after"]["parameters"].items()
    ]
    return Table(["parameter", "base", "low", "high", "corrected", "low", "high"], rows)


def _where_words(data: dict[str, Any]) -> str:
    checks = "\n\n".join(f"{check['name']}: {check['text']}" for check in data["residual"]["checks"])
    return "Excess is the drop of chi-square by a factor's columns beyond what noise gives." + (
        f"\n\n{checks}" if checks else ""
    )


def _where(data: dict[str, Any]) -> Table:
    after = {row["factor"]: row for row in data["residual"]["where_after"]}
    return Table.of(
        data["residual"]["where"],
        {
            "factor": "factor",
            "base: excess": "excess:.0f",
            "fraction of chi-square": lambda row: f"{100 * row['share']:.0f} %",
            "corrected: excess": lambda row: (
                f"{after[row['factor']]['excess']:.0f}" if row["factor"] in after else None
            ),
        },
    )


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
