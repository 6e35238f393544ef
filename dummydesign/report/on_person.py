"""Report of presses carried over to people: figures, tables, limits, and the curves as CSV."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.files import write_text
from dummydesign.core.interpolation import uniform_times
from dummydesign.person.on_person import OnPerson, PersonPress
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Grid, Panel, sentence, warning_texts
from dummydesign.report.page import Section, Table, log_start, unique, write_report
from dummydesign.report.plot import Plot, press_plot
from dummydesign.report.plot_drawing import plot_drawing
from dummydesign.report.plot_layers import Band, Line

ROWS = (("peak_N", "peak force [N]"), ("steady_N", "steady force [N]"), ("depth_mm", "depth [mm]"),
        ("energy_mJ", "energy [mJ]"), ("mean_pressure_N_per_cm2", "mean pressure [N/cm2]"))  # fmt: skip
FOUR = (("peak_N", "peak force N"), ("steady_N", "steady force N"), ("depth_mm", "depth mm"),
        ("energy_mJ", "energy mJ"), ("mean_pressure_N_per_cm2", "mean pressure N/cm2"))  # fmt: skip
WORST = ("fail", "undecided", "pass")
DRAWN, MOST_CHECKS = 400, 5


def write_on_person(answer: OnPerson, result: dict[str, Any], rate_hz: float, folder: Path) -> dict[str, str]:
    """Write ``report.html``, ``on_person.csv`` (curves at a uniform rate) and ``on_person.json``."""
    pressed = people_sections(answer, result["presses"])
    sections = [*pressed, _drive_section(answer, result)]
    worst = max(result["presses"], key=lambda row: row["factor_peak"][1] or 0.0)
    facts = [
        (_span(worst["factor_peak"]), "times the pad's peak on the subjects, largest press"),
        (_span(worst["interval_95"]["peak_N"]) + " N", "peak force on one more person, 95 %"),
    ]
    words = f"{answer.drive.words[0].upper()}{answer.drive.words[1:]}"
    lead = f"{words}. {answer.tissue.title}, {len(answer.tissue.subjects)} subjects."
    title = f"On people: {answer.tissue.name}"
    front = _front(title, lead, result, [plot for section in pressed for plot in section.plots])
    files = write_report(folder, title, lead, sections, facts=facts, warnings=result["warnings"],
                         sources=result["sources"], front=front)  # fmt: skip
    files["curves"] = str(write_text(folder / "on_person.csv", curves_csv(answer, rate_hz)))
    files["json"] = str(write_text(folder / "on_person.json", json.dumps(result["presses"], indent=1) + "\n"))
    return files


def _front(title: str, lead: str, result: dict[str, Any], plots: list[Plot]) -> FrontPage:
    """The first page: the closest limit, the hardest press, every press, the limits."""
    presses = result["presses"]
    word, text = headline(result)
    at = max(range(len(presses)), key=lambda row: presses[row]["factor_peak"][1] or 0.0)
    hardest, (head, rows) = presses[at], press_table(result)
    times = f"{span_text(hardest['factor_peak'])} times"
    factors = [f"{one['factor_peak'][1] or 0.0:.3g} times at most" for one in presses]
    checks = [sentence(f"{row['result']}: {limit_text(row)}")
              for row, _ in limit_rows(result)[:MOST_CHECKS]]  # fmt: skip
    return FrontPage(
        title, lead, (None, text if word == "result" else f"{word.upper()}. {text}"),
        (f"Force [N] over time, {hardest['file']}", plot_drawing(plots[at])), "Largest factor of the peak",
        [Fact("peak force on the subjects over the pad's", times, True),
         Fact("peak force, 95 % of people", f"{span_text(hardest['interval_95']['peak_N'])} N"),
         Fact("peak force on the pad", f"{number_text(hardest['pad']['peak_N'])} N"),
         Fact("drive", result["drive"])],
        "Force [N] over time since contact",
        [Panel(plot, f"{one['velocity_mm_s']:g} mm/s, {one['file']}", factor)
         for plot, one, factor in zip(plots, presses, factors)] if len(presses) > 1 else (),
        [("band", "subjects"), ("main", "pad")], Grid(head, rows), [("Limits", checks)] if checks else (),
        warning_texts(result["warnings"]), steps=[sentence(step) for step in next_steps(result)], foot=FOOT,
    )  # fmt: skip


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do with the result, by the worst check of the limits."""
    word = headline(result)[0]
    if word == "result":
        return ["compare the peak force on people with your limits: on-person --limits FILE.toml"]
    if word == "pass":
        return ["keep speed, force and moving mass at or below those of these presses"]
    if word == "fail":
        return ["reduce speed, force or moving mass", "press the pad again with the new setting"]
    return ["reduce speed, force or moving mass, or measure more subjects of this tissue: dummydesign tissues add"]


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
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    spans = [(0.0, max(float(one.press.time_s[-1]), float(np.max(one.response.time_s)))) for one in answer.presses]
    for one, time in zip(answer.presses, uniform_times(spans, rate_hz)):
        depth, force = on_grid(one, time)
        pad = [np.interp(time, one.press.time_s, row, right=np.nan) for row in (one.press.x_mm, one.press.force_N)]
        with np.errstate(all="ignore"):
            outer = [np.where(np.isnan(force).any(axis=0), np.nan, edge) for edge in (force.min(0), force.max(0))]
        columns = [time, *pad, *outer, *(row for pair in zip(depth, force) for row in pair)]
        for values in zip(*(column.tolist() for column in columns)):
            writer.writerow([one.press.trace.name, *("" if v != v else f"{v:.6g}" for v in values)])
    return stream.getvalue()


def _span(ends: list[float | None]) -> str:
    return "–" if ends[0] is None or ends[1] is None else f"{ends[0]:.3g} to {ends[1]:.3g}"


def press_figure(one: PersonPress, name: str) -> Plot:
    """Force over time: the pad, the subjects, and their band."""
    end = max(float(one.press.time_s[-1]), float(np.max(one.response.time_s)))
    start = log_start(one.press.stop_s)
    time = np.geomspace(start, end, DRAWN)
    force = on_grid(one, time)[1]
    known = ~np.isnan(force).any(axis=0)
    layers = (
        Band("subjects", time[known], force[:, known].min(axis=0), force[:, known].max(axis=0)),
        Line("pad", time, np.interp(time, one.press.time_s, one.press.force_N, right=np.nan)),
    )
    band = one.band["peak_N"]
    alt = (
        f"Force over time since contact on a logarithmic axis: the pad peaks at {one.pad['peak_N']:.3g} N, the "
        f"subjects between {band[0]:.3g} and {band[1]:.3g} N."
    )
    title = f"{one.press.trace.name}: {one.press.velocity_mm_s:g} mm/s"
    return press_plot(name, title, alt, layers, (start, end))


def _press_section(one: PersonPress, row: dict[str, Any], prefix: str, names: set[str]) -> Section:
    body = [[words, row["pad"][key], _span(row["band"][key]), _span(row["interval_95"][key])] for key, words in ROWS]
    body += [[f"{subject['name']}: peak, depth", "", f"{subject['peak_N']:.3g} N, {subject['depth_mm']:.3g} mm",
              _span(subject["interval_95"]["peak_N"]) + " N" if subject["interval_95"] else "–"]
             for subject in row["subjects"]]  # fmt: skip
    text = f"Peak force on the subjects is {_span(row['factor_peak'])} times the pad's."
    if one.beyond:
        text += " Extrapolated: " + "; ".join(entry.text for entry in one.beyond) + "."
    plot = press_figure(one, unique(prefix, names))
    table = Table(["", "pad", "subjects", "95 % of people"], body)
    return Section(f"Press {one.press.trace.name}", text, [plot], table)


def _limit_section(presses: list[dict[str, Any]]) -> Section:
    body = [
        [press["file"], row["name"], row["limit"], row["unit"], row["pad"],
         _span([row["person_low_95"], row["person_high_95"]]), row["result"].upper(), row["reason"]]
        for press in presses for row in press["limits"]
    ]  # fmt: skip
    text = (
        "Pass: the upper end of the 95 % interval of one more person is at most the limit, and nothing is "
        "extrapolated. Fail: the lower 95 % end of one subject is above it. Undecided: anything else."
    )
    head = ["press", "limit of", "limit", "unit", "pad", "people, 95 %", "result", "why"]
    return Section("Limits", text, table=Table(head, body))


def _drive_section(answer: OnPerson, result: dict[str, Any]) -> Section:
    body = [
        [row["file"], row["signs"]["looks_like"] or "not clear", row["signs"]["creep_mm"], row["signs"]["relaxed_N"],
         row["drive_contradicted"] or "nothing speaks against it"]
        for row in result["presses"]
    ]  # fmt: skip
    text = f"Given: {answer.drive.text}. What the traces show of the robot that made them:"
    head = ["press", "looks like", "creep in the hold [mm]", "force relaxed [N]", "against the given drive"]
    return Section("Which drive", text, table=Table(head, body))


def number_text(value: float | None) -> str:
    """Three digits; none as a power of ten below a million."""
    if value is None:
        return "-"
    return f"{value:.3g}" if not 999.5 <= abs(value) < 1e6 else f"{float(f'{value:.3g}'):.0f}"


def span_text(ends: list[float | None]) -> str:
    """Both ends of an interval."""
    return "-" if ends[0] is None or ends[1] is None else f"{number_text(ends[0])} to {number_text(ends[1])}"


def limit_rows(result: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Checks of limits with the file of their press, the worst first."""
    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]

    def rank(pair: tuple[dict[str, Any], str]) -> tuple[int, float]:
        """Worse results first, of those the nearest to its limit."""
        return WORST.index(pair[0]["result"]), -(pair[0]["person_high_95"] or 0.0) / pair[0]["limit"]

    return sorted(rows, key=rank)


def headline(result: dict[str, Any]) -> tuple[str, str]:
    """A word and its text: the worst check of the limits where there are any, else people's peak over the pad's."""
    rows = limit_rows(result)
    if not rows:
        press = max(result["presses"], key=lambda one: one["factor_peak"][1] or 0.0)
        factor, of_people = span_text(press["factor_peak"]), span_text(press["factor_peak_95"])
        first = extrapolation_text(result["presses"])
        return "result", (f"{first}Peak force on the subjects is {factor} times the pad's; for 95 % of people "
                          f"{of_people} times ({press['file']}).")  # fmt: skip
    row = rows[0][0]
    count = sum(one["result"] == row["result"] for one, _ in rows)
    reason = "" if row["result"] == "pass" else f" {row['reason'][0].upper()}{row['reason'][1:]}."
    if any(one["drive_contradicted"] for one in result["presses"]):
        reason += " The drive does not fit the trace."
    return row["result"], (
        f"{count} of {len(rows)} checks. Closest: {row['name']}, people up to {number_text(row['person_high_95'])} "
        f"{row['unit']} (95 %), limit {row['limit']:.4g}, pad {number_text(row['pad'])}.{reason}"
    )


FAR = 2.0
"""Times beyond the presses on people from which on numbers must not be used, as in the verdict on a pad."""


def extrapolation_text(presses: list[dict[str, Any]]) -> str:
    """How far the presses go beyond those on people, the worst first; nothing where they do not."""
    ways = [one for press in presses for one in press["beyond_range"]]
    times = [max(one["value"] / one["pressed_to"], one["pressed_to"] / max(one["value"], 1e-12)) for one in ways]
    if not ways:
        return ""
    size, worst = max(zip(times, ways), key=lambda pair: pair[0])
    first, then = ("Do not use these numbers: ", ". Extrapolated: ") if size > FAR else ("Extrapolated: ", ". ")
    return first + str(worst["text"]) + then


def press_table(result: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Head and rows: all five numbers of a single press, a row a press of several."""
    if len(result["presses"]) == 1:
        one = result["presses"][0]
        rows = [[words, number_text(one["pad"][key]), span_text(one["band"][key]), span_text(one["interval_95"][key])]
                for key, words in FOUR]  # fmt: skip
        return ["", "pad", "subjects", "95 % of people"], rows
    rows = [
        [one["file"], f"{one['velocity_mm_s']:.4g}", number_text(one["pad"]["peak_N"]),
         *(span_text(ends) for ends in (one["band"]["peak_N"], one["interval_95"]["peak_N"], one["factor_peak"],
                                        one["band"]["depth_mm"]))]
        for one in result["presses"]
    ]  # fmt: skip
    return ["press", "mm/s", "pad peak N", "subjects N", "95 % N", "times", "depth mm"], rows


def limit_text(row: dict[str, Any]) -> str:
    """A check of a limit with its numbers."""
    people = span_text([row["person_low_95"], row["person_high_95"]])
    return f"{row['name']}: limit {row['limit']:.4g}, pad {number_text(row['pad'])}, people {people} {row['unit']}"
