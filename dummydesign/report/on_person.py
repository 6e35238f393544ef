"""Report of presses carried over to people: figures, tables, limits, and the curves as CSV."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.files import csv_text, write_text
from dummydesign.core.interpolation import uniform_times
from dummydesign.core.tables import Table
from dummydesign.core.user_library import data_folder
from dummydesign.person.on_person import OnPerson, PersonPress
from dummydesign.person.validity_range import subject_words
from dummydesign.report import on_person_facts as facts
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Panel, sentence, warning_texts
from dummydesign.report.on_person_facts import number_text, span_text
from dummydesign.report.page import Section, log_start, unique, write_report
from dummydesign.report.plot import Plot, Series, press_plot
from dummydesign.report.plot_drawing import plot_drawing
from dummydesign.report.sections.conformity import budget_section

DRAWN, MOST_CHECKS = 400, 5


def write_on_person(answer: OnPerson, result: dict[str, Any], rate_hz: float, folder: Path) -> dict[str, str]:
    """Write the report, ``on_person.csv`` (curves at a uniform rate), ``on_person.json`` and a template of limits."""
    pressed = people_sections(answer, result["presses"])
    sections = [*pressed, *budget_section(result["budget"]), _drive_section(answer, result)]
    worst = max(result["presses"], key=lambda row: row["factor_peak"][1] or 0.0)
    shown = [
        (span_text(worst["factor_peak"]), "times the pad's peak force: the subjects, largest press"),
        (span_text(worst["interval_95"]["peak_N"]) + " N", "peak force, 95 % of people"),
    ]
    lead = f"Drive {answer.drive.text}: {answer.drive.words}. People: {facts.people_text(result)}."
    title = f"On people: {answer.tissue.name}"
    front = _front(title, lead, result, [plot for section in pressed for plot in section.plots])
    whole = f"{verdict_text(result)} {lead}"
    files = write_report(
        folder, title, whole, sections, facts=shown, warnings=result["warnings"], sources=result["sources"], front=front
    )
    files["curves"] = str(write_text(folder / "on_person.csv", curves_csv(answer, rate_hz)))
    files["json"] = str(write_text(folder / "on_person.json", json.dumps(result["presses"], indent=1) + "\n"))
    if result["limits_file"] is None:
        form = (data_folder() / "materials" / "limits.toml").read_text(encoding="utf-8")
        files["limits_template"] = str(write_text(folder / facts.LIMITS_TEMPLATE, form))
    return files


def verdict_text(result: dict[str, Any]) -> str:
    """The answer in a paragraph: a drive that does not fit, then the result."""
    word, text = facts.headline(result)
    return f"{facts.mismatch(result)} {text if word == 'result' else f'{word.upper()}. {text}'}".strip()


def _front(title: str, lead: str, result: dict[str, Any], plots: list[Plot]) -> FrontPage:
    """The first page: a drive that does not fit, the closest limit, the hardest press, every press, the limits."""
    presses = result["presses"]
    at = max(range(len(presses)), key=lambda row: presses[row]["factor_peak"][1] or 0.0)
    hardest = presses[at]
    times = f"{span_text(hardest['factor_peak'])} times"
    factors = [f"up to {one['factor_peak'][1] or 0.0:.3g} times the pad" for one in presses]
    checks = [
        sentence(f"{row['result']}: {facts.limit_text(row)}") for row, _ in facts.limit_rows(result)[:MOST_CHECKS]
    ]
    shown = [one for one in result["warnings"] if one["code"] not in facts.IN_HEADLINE]
    return FrontPage(
        title,
        lead,
        (None, verdict_text(result)),
        (f"Force [N] over time, {hardest['file']}", plot_drawing(plots[at])),
        "Largest peak against the pad's",
        [
            Fact("peak force on the subjects over the pad's", times, True),
            Fact("peak force, 95 % of people", f"{span_text(hardest['interval_95']['peak_N'])} N"),
            Fact("peak force on the pad", f"{number_text(hardest['pad']['peak_N'])} N"),
            Fact("drive", result["drive"]),
        ],
        "Force [N] over time since contact",
        [
            Panel(plot, f"{one['velocity_mm_s']:g} mm/s, {one['file']}", factor)
            for plot, one, factor in zip(plots, presses, factors)
        ]
        if len(presses) > 1
        else (),
        [("band", "subjects"), ("main", "pad")],
        facts.press_table(result),
        [("Limits", checks)] if checks else (),
        warning_texts(shown),
        steps=[sentence(step) for step in facts.next_steps(result)],
        foot=FOOT,
    )


def people_sections(answer: OnPerson, rows: list[dict[str, Any]], prefix: str = "press") -> list[Section]:
    """Sections of the limits, where there are any, and of each press."""
    names: set[str] = set()
    limits = [_limit_section(rows)] if any(row["limits"] for row in rows) else []
    return [*limits, *(_press_section(one, row, prefix, names) for one, row in zip(answer.presses, rows))]


def on_grid(one: PersonPress, time_s: NDArray) -> tuple[NDArray, NDArray]:
    """Depths and forces of the subjects at times since contact, shape (subjects, n); NaN where they are not known."""
    rows = []
    for curve in (one.response.depth_curve_mm, one.response.force_curve_N):
        times = np.broadcast_to(one.response.time_s, curve.shape)
        rows.append(np.array([np.interp(time_s, t, y, right=np.nan) for t, y in zip(times, curve)]))
    return rows[0], rows[1]


def curves_csv(answer: OnPerson, rate_hz: float) -> str:
    """Curves of pad and subjects at a uniform rate, one block a press."""
    head = ["file", "time_s", "pad_displacement_mm", "pad_force_N", "people_low_N", "people_high_N"]
    for subject in answer.tissue.subjects:
        head += [f"{subject.name}_displacement_mm", f"{subject.name}_force_N"]
    rows: list[list[str]] = []
    spans = [(0.0, max(float(one.press.time_s[-1]), float(np.max(one.response.time_s)))) for one in answer.presses]
    for one, time in zip(answer.presses, uniform_times(spans, rate_hz)):
        depth, force = on_grid(one, time)
        pad = [np.interp(time, one.press.time_s, row, right=np.nan) for row in (one.press.x_mm, one.press.force_N)]
        with np.errstate(all="ignore"):
            outer = [np.where(np.isnan(force).any(axis=0), np.nan, edge) for edge in (force.min(0), force.max(0))]
        columns = [time, *pad, *outer, *(row for pair in zip(depth, force) for row in pair)]
        rows += [
            [one.press.trace.name, *("" if v != v else f"{v:.6g}" for v in values)]
            for values in zip(*(column.tolist() for column in columns))
        ]
    return csv_text(head, rows)


def press_figure(one: PersonPress, name: str) -> Plot:
    """Force over time: the pad, the subjects, and their band."""
    end = max(float(one.press.time_s[-1]), float(np.max(one.response.time_s)))
    start = log_start(one.press.stop_s)
    time = np.geomspace(start, end, DRAWN)
    force = on_grid(one, time)[1]
    known = ~np.isnan(force).any(axis=0)
    series = (
        Series.band("subjects", time[known], force[:, known].min(axis=0), force[:, known].max(axis=0)),
        Series.line("pad", time, np.interp(time, one.press.time_s, one.press.force_N, right=np.nan)),
    )
    band = one.band["peak_N"]
    alt = (
        f"Force over time since contact on a logarithmic axis: the pad peaks at {one.pad['peak_N']:.3g} N, the "
        f"subjects at {span_text(list(band))} N."
    )
    title = f"{one.press.trace.name}: {one.press.velocity_mm_s:g} mm/s"
    return press_plot(name, title, alt, series, (start, end))


def _press_section(one: PersonPress, row: dict[str, Any], prefix: str, names: set[str]) -> Section:
    body = [
        [
            f"{words} [{unit}]",
            number_text(row["pad"][key]),
            span_text(row["band"][key]),
            span_text(row["interval_95"][key]),
        ]
        for key, words, unit in facts.FIVE
    ]
    body += [
        [
            f"{subject_words(subject['name'])}: peak, depth",
            "",
            f"{number_text(subject['peak_N'])} N, {number_text(subject['depth_mm'])} mm",
            span_text(subject["interval_95"]["peak_N"]) + " N" if subject["interval_95"] else "-",
        ]
        for subject in row["subjects"]
    ]
    text = f"The peak force on the subjects is {span_text(row['factor_peak'])} times the pad's."
    if one.beyond:
        text += " Extrapolated: " + "; ".join(entry.text for entry in one.beyond) + "."
    plot = press_figure(one, unique(prefix, names))
    table = Table(["", "pad", "subjects", "95 % of people"], body)
    return Section(f"Press {one.press.trace.name}", text, [plot], table)


def _limit_section(presses: list[dict[str, Any]]) -> Section:
    rows = ({"file": press["file"], **row} for press in presses for row in press["limits"])
    text = (
        "Pass: the upper 95 % end of people is at most the limit, and nothing is extrapolated. Fail: the lower 95 % "
        "end of one subject is above the limit. Undecided: anything else."
    )
    return Section(
        "Limits",
        text,
        table=Table.of(
            rows,
            {
                "press": "file",
                "limit of": facts.limit_name,
                "limit": "limit",
                "unit": "unit",
                "pad": lambda row: number_text(row["pad"]),
                "95 % of people": lambda row: span_text([row["person_low_95"], row["person_high_95"]]),
                "result": lambda row: row["result"].upper(),
                "why": "reason",
            },
        ),
    )


def _drive_section(answer: OnPerson, result: dict[str, Any]) -> Section:
    text = f"The drive is {answer.drive.text}. What the traces show of the drive that made them:"
    return Section(
        "Which drive",
        text,
        table=Table.of(
            result["presses"],
            {
                "press": "file",
                "looks like": lambda row: row["signs"]["looks_like"] or "not clear",
                "creep in the hold [mm]": lambda row: row["signs"]["creep_mm"],
                "fall of the force [N]": lambda row: row["signs"]["relaxed_N"],
                f"contradiction of {answer.drive.text}": lambda row: row["drive_contradicted"] or "none",
            },
        ),
    )
