"""Presses carried over to people: words and rows for terminal, studio and report; figures, and curves as CSV."""

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
from dummydesign.person.validity_range import FAR, short_number, subject_words
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Panel, full_sentence, plot_drawing, warning_texts
from dummydesign.report.page import Section, log_start, unique, write_report
from dummydesign.report.plot import Plot, Series, press_plot
from dummydesign.report.sections import budget_section

DRAWN, MOST_CHECKS = 400, 5
FIVE = (
    ("peak_N", "peak force", "N"),
    ("steady_N", "steady force", "N"),
    ("depth_mm", "depth", "mm"),
    ("energy_mJ", "energy", "mJ"),
    ("mean_pressure_N_per_cm2", "mean pressure", "N/cm2"),
)
WORST = ("fail", "undecided", "pass")
LIMITS_TEMPLATE = "limits-template.toml"
IN_HEADLINE = ("drive_mismatch", "beyond_range", "inferred_tissue")
"""Warnings whose facts the first lines of an answer give."""


def write_on_person(answer: OnPerson, result: dict[str, Any], rate_hz: float, folder: Path) -> dict[str, str]:
    """Write the report, ``on_person.csv`` (curves at a uniform rate), ``on_person.json`` and a template of limits."""
    names: set[str] = set()
    pressed = [_press_section(one, row, names) for one, row in zip(answer.presses, result["presses"])]
    limits = [_limit_section(result["presses"])] if any(row["limits"] for row in result["presses"]) else []
    sections = [*limits, *pressed, *budget_section(result["budget"]), _drive_section(answer, result)]
    worst = max(result["presses"], key=lambda row: row["factor_peak"][1] or 0.0)
    shown = [
        (span_text(worst["factor_peak"]), "times the pad's peak force: the subjects, largest press"),
        (span_text(worst["interval_95"]["peak_N"]) + " N", "peak force, 95 % of people"),
    ]
    lead = f"Drive {answer.drive.text}: {answer.drive.words}. People: {people_text(result)}."
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
        files["limits_template"] = str(write_text(folder / LIMITS_TEMPLATE, form))
    return files


def verdict_text(result: dict[str, Any]) -> str:
    """The answer in a paragraph: a drive that does not fit, then the result."""
    word, text = headline(result)
    return f"{mismatch(result)} {text if word == 'result' else f'{word.upper()}. {text}'}".strip()


def _front(title: str, lead: str, result: dict[str, Any], plots: list[Plot]) -> FrontPage:
    """The first page: a drive that does not fit, the closest limit, the hardest press, every press, the limits."""
    presses = result["presses"]
    at = max(range(len(presses)), key=lambda row: presses[row]["factor_peak"][1] or 0.0)
    hardest = presses[at]
    times = f"{span_text(hardest['factor_peak'])} times"
    factors = [f"up to {one['factor_peak'][1] or 0.0:.3g} times the pad" for one in presses]
    checks = [full_sentence(f"{row['result']}: {limit_text(row)}") for row, _ in limit_rows(result)[:MOST_CHECKS]]
    shown = [one for one in result["warnings"] if one["code"] not in IN_HEADLINE]
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
        press_table(result),
        [("Limits", checks)] if checks else (),
        warning_texts(shown),
        steps=[full_sentence(step) for step in next_steps(result)],
        foot=FOOT,
    )


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


def _press_section(one: PersonPress, row: dict[str, Any], names: set[str]) -> Section:
    body = _five_rows(row, "{} [{}]")
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
    plot = press_figure(one, unique("press", names))
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
                "limit of": limit_name,
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


def number_text(value: float | None) -> str:
    """Three digits; none as a power of ten below a million."""
    return "-" if value is None else short_number(value)


def span_text(ends: list[float | None]) -> str:
    """Both ends of an interval, or the one value that both are."""
    if ends[0] is None or ends[1] is None:
        return "-"
    low, high = number_text(ends[0]), number_text(ends[1])
    return low if low == high else f"{low} to {high}"


def limit_rows(result: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Checks of limits with the file of their press, the worst first."""
    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]

    def rank(pair: tuple[dict[str, Any], str]) -> tuple[int, float]:
        """Worse results first, of those the nearest to its limit."""
        return WORST.index(pair[0]["result"]), -(pair[0]["person_high_95"] or 0.0) / pair[0]["limit"]

    return sorted(rows, key=rank)


def mismatch(result: dict[str, Any]) -> str:
    """The drive does not fit the traces: how, by how much, and what to do; nothing where it fits."""
    wrong = [one for one in result["presses"] if one["drive_contradicted"]]
    if not wrong:
        return ""
    one, drive = wrong[0], result["drive"]
    count = len(result["presses"])
    what = "The trace does" if count == 1 else f"{len(wrong)} of {count} traces do"
    where = "" if count == 1 else f"{one['file']}: "
    reason = one["drive_contradicted"]
    change, name = full_sentence(other_drive(drive, one["signs"])), drive.partition(":")[0]
    return (
        f"{what} not fit --drive {drive}. {where}{full_sentence(reason)} {change} Keep --drive {name} if this is how "
        "the robot acts on people."
    )


def other_drive(drive: str, signs: dict[str, Any]) -> str:
    """What to type where a drive does not fit."""
    name, fits = drive.partition(":")[0], signs["looks_like"]
    if fits == "mass":
        fits = f"mass:{signs['mass_kg']:.3g}"
    elif fits == name:
        fits = None
    return f"use --drive {fits}" if fits else "give the drive that made the trace"


def headline(result: dict[str, Any]) -> tuple[str, str]:
    """A word and its text: the worst check of the limits where there are any, else people's peak over the pad's."""
    rows = limit_rows(result)
    beyond = extrapolation_text(result["presses"])
    if not rows:
        return "result", f"{beyond}{comparison_text(result)}"
    row, file = rows[0]
    count = sum(one["result"] == row["result"] for one, _ in rows)
    words = {"pass": "limits are met", "fail": "limits are exceeded", "undecided": "checks"}
    reason = "" if row["result"] == "pass" else f" {full_sentence(row['reason'])}"
    if row["result"] == "undecided" and beyond and row["reason"].startswith("the press goes beyond"):
        reason = f" {beyond.strip()}"
    where = f"{file}, " if len(result["presses"]) > 1 else ""
    return row["result"], (
        f"{count} of {len(rows)} {words[row['result']]}. {'Worst' if row['result'] == 'fail' else 'Closest'}: "
        f"{where}{limit_text(row)}.{reason}"
    )


def comparison_text(result: dict[str, Any]) -> str:
    """People's peak force over the pad's; where the drive makes both equal, how deep people are pressed."""
    presses = result["presses"]
    press = max(presses, key=lambda one: one["factor_peak"][1] or 0.0)
    where = f" ({press['file']})" if len(presses) > 1 else ""
    factor, of_people = span_text(press["factor_peak"]), span_text(press["factor_peak_95"])
    if factor == "1":
        press = max(presses, key=lambda one: one["band"]["depth_mm"][1] or 0.0)
        where = f" ({press['file']})" if len(presses) > 1 else ""
        return (
            f"The force is the pad's. The subjects are pressed {span_text(press['band']['depth_mm'])} mm deep, "
            f"the pad {number_text(press['pad']['depth_mm'])} mm. For 95 % of people it is "
            f"{span_text(press['interval_95']['depth_mm'])} mm{where}."
        )
    return (
        f"The peak force on the subjects is {factor} times the pad's. For 95 % of people it is {of_people} "
        f"times{where}."
    )


def worst_beyond(presses: list[dict[str, Any]]) -> tuple[dict[str, Any], float] | None:
    """The farthest way in which presses go beyond those on people, and how many times; None where none does."""
    ways = [one for press in presses for one in press["beyond_range"]]
    times = [max(one["value"] / one["pressed_to"], one["pressed_to"] / max(one["value"], 1e-12)) for one in ways]
    return None if not ways else max(zip(ways, times), key=lambda pair: pair[1])


def extrapolation_text(presses: list[dict[str, Any]]) -> str:
    """How far the presses go beyond those on people, the worst first; nothing where they do not."""
    worst = worst_beyond(presses)
    if worst is None:
        return ""
    way, times = worst
    first = "Do not use these numbers: " if times > FAR else "Extrapolated: "
    return f"{first}{way['text']}. "


def people_text(result: dict[str, Any]) -> str:
    """Whose numbers these are."""
    count = len(result["presses"][0]["subjects"])
    inferred = any(one["code"] == "inferred_tissue" for one in result["warnings"])
    subjects = f"{count} subjects" if count != 1 else "1 subject"
    return f"{result['tissue']}, {subjects}" + (", inferred, not measured" if inferred else "")


def _five_rows(press: dict[str, Any], label: str) -> list[list[str]]:
    """Each of the five numbers of a press: the pad's, the subjects', and the range of people; a label for it."""
    return [
        [
            label.format(words, unit),
            number_text(press["pad"][key]),
            span_text(press["band"][key]),
            span_text(press["interval_95"][key]),
        ]
        for key, words, unit in FIVE
    ]


def press_table(result: dict[str, Any]) -> Table:
    """All five numbers of a single press, a row a press of several."""
    if len(result["presses"]) == 1:
        return Table(["", "pad", "subjects", "95 % of people"], _five_rows(result["presses"][0], "{} {}"))
    rows = [
        [
            one["file"],
            f"{one['velocity_mm_s']:.4g}",
            number_text(one["pad"]["peak_N"]),
            *(
                span_text(ends)
                for ends in (
                    one["band"]["peak_N"],
                    one["interval_95"]["peak_N"],
                    one["factor_peak"],
                    one["band"]["depth_mm"],
                )
            ),
        ]
        for one in result["presses"]
    ]
    return Table(["press", "mm/s", "pad peak N", "subjects N", "95 % N", "subjects/pad", "depth mm"], rows)


def subject_table(press: dict[str, Any]) -> Table:
    """Each subject's numbers."""
    rows = [[subject_words(one["name"]), *(number_text(one[key]) for key, _, _ in FIVE)] for one in press["subjects"]]
    return Table(["subject", *(f"{words} {unit}" for _, words, unit in FIVE)], rows)


def limit_name(row: dict[str, Any]) -> str:
    """What a limit is of, as it is read: quasi-static force."""
    quantity, _, kind = row["name"].rpartition(" ")
    return f"{kind} {quantity}"


def limit_text(row: dict[str, Any]) -> str:
    """A check of a limit with its numbers."""
    unit, people = row["unit"], number_text(row["person_high_95"])
    return (
        f"{limit_name(row)}, people up to {people} {unit} (95 %), limit {number_text(row['limit'])} {unit}, "
        f"pad {number_text(row['pad'])} {unit}"
    )


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do now: first what makes the numbers valid, then what the worst check of the limits asks for."""
    word, worst = headline(result)[0], worst_beyond(result["presses"])
    wrong = next((one for one in result["presses"] if one["drive_contradicted"]), None)
    template = result["files"].get("limits_template", LIMITS_TEMPLATE)
    fewer = "reduce speed, force or moving mass, or measure more subjects: dummydesign tissues add NAME TRACE.csv..."
    asked = {
        "fail": "reduce speed, force or moving mass; press the pad again with the new setting",
        "pass": "keep speed, force and moving mass at or below those of these presses",
        "undecided": "" if worst else fewer,
        "result": f"compare with your limits: copy {template} to limits.toml, fill it in, "
        "repeat with --limits limits.toml",
    }
    steps = (
        wrong and other_drive(result["drive"], wrong["signs"]),
        worst and _into_range(worst[0]),
        asked[word],
    )
    return [step for step in steps if step]


def _into_range(way: dict[str, Any]) -> str:
    """How to press so that people's presses cover it."""
    low = way["value"] < way["pressed_to"]
    speed, depth = ("faster", "deeper") if low else ("more slowly", "less deep")
    change = {"velocity_mm_s": speed, "peak_force_N": f"{speed} or {depth}"}.get(way["quantity"], depth)
    how = ("slowly" if low else "fast") if way["quantity"] == "velocity_mm_s" else ("lightly" if low else "hard")
    people = f"add people who were pressed this {how}: dummydesign tissues add NAME TRACE.csv..."
    return f"press the pad {change}, or {people}"
