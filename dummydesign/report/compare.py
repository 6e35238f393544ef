"""Report of a comparison: a measured pad in the tissue's ranges, its parameters, its files."""

from __future__ import annotations

import json
import math
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from dummydesign.core.files import csv_text, write_bytes, write_text
from dummydesign.core.tables import Table
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.measurement.campaign_file import FILE as CAMPAIGN
from dummydesign.report.front_page import (
    FOOT,
    Fact,
    FrontPage,
    Panel,
    full_sentence,
    picture,
    plot_drawing,
    warning_texts,
)
from dummydesign.report.page import STYLES, Section, digits, log_start, unique, write_report
from dummydesign.report.plot import Plot, Series, press_plot, steady_plot
from dummydesign.report.sections import budget_section, curves_section
from dummydesign.tissue.comparison import Comparison
from dummydesign.tissue.model.ranges import interpolate_rows
from dummydesign.tissue.model.tissue import Tissue

PARAMETERS = (
    "The same law fitted to the dummy, speed by speed, beside the band of the subjects: 0 and 1 are the ends of the "
    "band on a logarithmic scale, bars are the dummy's 95 % intervals. A slab does not follow the law, so its "
    "parameters are a compromise over the forces."
)
FARTHEST = 3.0
"""Parameters are drawn up to this many widths of the band beside it."""


def write_comparison(comparison: Comparison, tissue: Tissue, folder: Path, answer: dict[str, Any]) -> dict[str, str]:
    """Write parametric.csv, steady_state.csv, force_variation.csv, ranges.png, compare.json and the report."""
    data, fit = comparison.result, comparison.result["fit"]
    steady, rows = data["steady_state_range"], data["force_variation_range"]
    low, high = steady["span_N"]
    known = [row["inside"] for row in data["parametric"].values() if row["inside"] is not None]
    mean = float(np.mean([row["inside_fraction"] for row in rows]))
    unknown = ", where there are no data on people" if tissue.origin == "built-in" and low <= 5.0 else ""
    facts = [
        (_percent(steady["above_5N_fraction"]), f"of the steady-state curve inside, {low:g} to {high:g} N"),
        (_percent(steady["below_5N_fraction"]), f"of it in range below {low:g} N{unknown}"),
        (_percent(mean), "of force over time inside, mean of the conditions"),
        *([(f"{sum(known)} of {len(known)}", "parameters inside their bands")] if data["parametric"] else []),
    ]
    lead = "" if tissue.notice is None else f"{tissue.notice[1]}. "
    lead += (
        f"Measured dummy against {tissue.title} ({tissue.name}), {len(tissue.subjects)} subjects, "
        f"{'no law' if tissue.measured else 'law ' + data['law']}. "
        "Each press is compared with the subjects at its own steady force, speed, hold and braking."
    ) + _test_words(data)
    steady_figure, presses = _steady(comparison, tissue), _presses(comparison, data)
    sections = [
        Section("Steady force", _steady_words(data), [steady_figure]),
        Section(
            "Force over time",
            "Repeats of a condition share a figure; the range is that of the first.",
            presses,
            _conditions(rows),
        ),
        *([curves_section(data["curves"], len(tissue.subjects), "average")] if "curves" in data else []),
        *([Section("Parameters", PARAMETERS, _parameters(data), _parametric(data))] if data["parametric"] else []),
        Section(
            "Fit behind the parameters",
            f"Rms residual {fit['rmse_N']:.3g} N, noise floor "
            f"{fit['noise_floor_N']:.3g} N, largest residual {fit['max_residual_N']:.3g} N.",
            table=_traces(data),
        ),
        *budget_section(data.get("budget")),
    ]
    title = f"Dummy against {tissue.name}"
    files = {
        "parametric": write_text(folder / "parametric.csv", _parametric_file(comparison)),
        "steady_state": write_text(folder / "steady_state.csv", _steady_file(comparison)),
        "force_variation": write_text(folder / "force_variation.csv", _force_variation(comparison)),
        "picture": write_bytes(folder / "ranges.png", picture(title, [steady_figure, *presses])),
        "json": write_text(
            folder / "compare.json", json.dumps({"verdict": answer["verdict"], **data}, indent=1) + "\n"
        ),
    }
    return {role: str(path) for role, path in files.items()} | write_report(
        folder,
        title,
        lead,
        sections,
        facts=facts,
        warnings=data["warnings"],
        sources=tissue.sources,
        verdict=answer["verdict"],
        front=_front(title, data, answer, steady_figure, presses),
    )


def _front(title: str, data: dict[str, Any], answer: dict[str, Any], steady: Plot, presses: list[Plot]) -> FrontPage:
    """The first page: verdict, steady curve, each press in the subjects' range."""
    table = press_rows(data)
    facts = [
        Fact("tissue", f"{data['tissue']}, {law_text(data)}", True),
        Fact("part of the steady curve inside the subjects' range", steady_text(data).replace("; ", "\n")),
        Fact("parameters of the law", parameters_text(data)),
        Fact("pad", pad_text(data)),
    ]
    return FrontPage(
        title,
        f"Each press is compared with the subjects at its own steady force, speed and hold.{_test_words(data)}",
        (answer["verdict"]["light"], answer["verdict"]["text"]),
        ("Steady force over depth", plot_drawing(steady)),
        "Comparison",
        [fact for fact in facts if fact.text],
        "Force [N] over time since contact",
        [
            Panel(plot, f"{row[0]} N, {row[1]} mm/s", f"{row[3]} N: {row[5]} inside")
            for plot, row in zip(presses, table.rows)
        ],
        [("band", "subjects"), ("main", "this pad")],
        table,
        notes=warning_texts(data["warnings"]),
        steps=[one if one.startswith("dummydesign ") else full_sentence(one) for one in next_steps(answer)],
        foot=FOOT,
    )


def _test_words(data: dict[str, Any]) -> str:
    """The test, where it was given."""
    test = data.get("test")
    if not test:
        return ""
    words = [f"punch {test['punch']}"] if "punch" in test else []
    if test.get("edge_radius_mm"):
        words.append(f"edge radius {test['edge_radius_mm']:g} mm")
    words += [f"condition {test['condition']}"] if test.get("condition", "bonded") != "bonded" else []
    for name, unit in (("force_N", "N"), ("velocity_mm_s", "mm/s")):
        words += [f"{', '.join(f'{v:g}' for v in test[name])} {unit}"] if test.get(name) else []
    for name, text in (("hold_s", "hold {:g} s"), ("deceleration_mm_s2", "braking {:g} mm/s2")):
        words += [text.format(test[name])] if test.get(name) else []
    return f" The test: {'; '.join(words)}."


def _percent(share: float | None) -> str:
    return "not reached" if share is None else f"{100 * share:.0f} %"


def _steady_words(data: dict[str, Any]) -> str:
    reached, low = data["steady_state_range"]["reached_N"], data["steady_state_range"]["span_N"][0]
    curves = data["law"] == "curves"
    carried = "their slowest rise, scaled to their steady force" if curves else "their law extrapolated"
    text = f"Below {low:g} N the subjects' range is {carried}, and drawn paler."
    return text if reached is None else f"The dummy was pressed from {reached[0]:.3g} to {reached[1]:.3g} N. {text}"


def _steady(comparison: Comparison, tissue: Tissue) -> Plot:
    low, high = comparison.test.span_N
    parts = [
        np.r_[0.0, comparison.grid_N[comparison.grid_N <= low * (1 + 1e-9)]],
        comparison.grid_N[comparison.grid_N >= low * (1 - 1e-9)],
    ]
    below, among = (
        [np.interp(part, np.r_[0.0, comparison.grid_N], np.r_[0.0, edge]) for edge in comparison.range_mm]
        for part in parts
    )
    series = (
        Series.band("subjects, extrapolated", parts[0], below[0], below[1], sideways=True, style="extra"),
        Series.band(f"subjects of {tissue.name}", parts[1], among[0], among[1], sideways=True),
        Series.line("dummy", comparison.steady, comparison.grid_N),
        Series.dots("measured at the end of the hold", comparison.points[:, 0], comparison.points[:, 1], "aim"),
    )
    share = comparison.result["steady_state_range"]["above_5N_fraction"]
    alt = (
        f"Steady force over depth: the dummy against the subjects' range; {_percent(share)} inside from {low:g} to "
        f"{high:g} N. Measured points at {', '.join(f'{x:.2f} mm {f:.1f} N' for x, f in comparison.points)}."
    )
    return steady_plot(alt, series)


def _presses(comparison: Comparison, data: dict[str, Any]) -> list[Plot]:
    """One figure a condition, in the order of the rows of the force variation range."""
    plots: list[Plot] = []
    names: set[str] = set()
    for (speed, pressed), row in zip(comparison.conditions, data["force_variation_range"]):
        band, force, share = pressed[0].range, row["steady_force_N"], row["inside_fraction"]
        series: list[Series] = [Series.band(f"subjects of {data['tissue']}", band.time_s, band.low_N, band.high_N)]
        for number, (trace, _, _) in enumerate(pressed):
            time, measured = trace.since_contact
            name = "dummy" if len(pressed) == 1 else f"dummy, {trace.trace.name}"
            series.append(Series.line(name, *_thin(time[time > 0], measured[time > 0]), STYLES[number % len(STYLES)]))
        title = f"{force:.3g} N at {speed:g} mm/s: {_percent(share)} inside"
        alt = (
            f"Force over time on a logarithmic axis, {force:.3g} N steady at {speed:g} mm/s: the dummy peaks at "
            f"{row['peak_force_N']:.1f} N, the subjects between {row['range_peak_low_N']:.1f} and "
            f"{row['range_peak_high_N']:.1f} N; {_percent(share)} of the press lies inside."
        )
        ends = (log_start(min(press.trace.ramp.rise_time_s for press in pressed)), float(band.time_s[-1]))
        plots.append(press_plot(unique(f"press-{force:.2g}N-{speed:g}mm-s", names), title, alt, series, ends))
    return plots


def _thin(time: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At most some three hundred samples, evenly in the logarithm of time, the peak among them."""
    chosen = np.searchsorted(time, np.geomspace(time[0], time[-1], 300)).clip(0, len(time) - 1)
    rows = np.unique(np.r_[chosen, int(np.argmax(force))])
    return time[rows], force[rows]


def _conditions(rows: list[dict[str, Any]]) -> Table:
    return Table.of(
        rows,
        {
            "steady N": "steady_force_N",
            "mm/s": "velocity_mm_s:g",
            "depth mm": "depth_mm",
            "peak N": "peak_force_N",
            "subjects' peaks N": lambda row: f"{row['range_peak_low_N']:.1f} to {row['range_peak_high_N']:.1f}",
            "inside": lambda row: _percent(row["inside_fraction"]),
            "of the rise": lambda row: _percent(row["inside_rise_fraction"]),
            "of the hold": lambda row: _percent(row["inside_hold_fraction"]),
            "repeats": "repeats",
        },
    )


def _parameters(data: dict[str, Any]) -> list[Plot]:
    labels, places = [], []
    for name, row in data["parametric"].items():
        if row["band_low"] is None or not 0.0 < row["band_low"] < row["band_high"]:
            continue
        ends = [row["value"] if row[end] is None else row[end] for end in ("value", "low", "high")]
        width = math.log(row["band_high"] / row["band_low"])
        places.append([math.log(end / row["band_low"]) / width for end in ends])
        labels.append(name.replace("_N_per_mm3", "").replace("_N_s_per_mm.", " at ") + (" mm/s" if "." in name else ""))
    if not labels:
        return []
    middle, *outer = np.transpose(places)
    low, high = np.clip(outer, -FARTHEST, 1.0 + FARTHEST)
    count = float(len(labels))
    series = (
        Series.band("band of the subjects", np.array([0.0, count]), np.zeros(2), np.ones(2), sideways=True),
        Series.bars(labels, low, high),
        Series.dots("dummy", middle, count - 0.5 - np.arange(len(labels)), "aim"),
    )
    words = "; ".join(f"{label} {a:.2g} to {b:.2g}" for label, a, b in zip(labels, low, high))
    return [
        Plot(
            "parameters",
            "Parameters in their bands",
            f"Place of each parameter in its band, 0 and 1 are the ends: {words}.",
            "place in the band [0 to 1]",
            "",
            "place",
            "none",
            series,
            y_range=(0.0, count),
            x_range=(min(-0.3, *low) - 0.1, max(1.3, *high) + 0.1),
            note=f"cut off {FARTHEST:g} widths beside the band",
        )
    ]


def _parametric(data: dict[str, Any]) -> Table:
    verdict = {True: "inside", False: "outside", None: "no band"}
    keys = ("value", "low", "high", "band_low", "band_high")
    body = [
        [name, *(digits(row[key]) for key in keys), verdict[row["inside"]], "at bound" if row["at_bound"] else ""]
        for name, row in data["parametric"].items()
    ]
    return Table(["parameter", "dummy", "95 % low", "95 % high", "band low", "band high", "", ""], body)


def _traces(data: dict[str, Any]) -> Table:
    return Table.of(
        data["by_trace"],
        {
            "file": "file",
            "mm/s": "velocity_mm_s:g",
            "steady N": "steady_force_N",
            "depth mm": "depth_mm",
            "peak N": "peak_force_N",
            "inside": lambda row: _percent(row["inside_fraction"]),
        },
    )


def _parametric_file(comparison: Comparison) -> str:
    keys = ("value", "low", "high", "band_low", "band_high", "inside")
    rows = comparison.result["parametric"].items()
    return csv_text(("parameter", *keys), ((name, *(row[key] for key in keys)) for name, row in rows))


def _steady_file(comparison: Comparison) -> str:
    rows = zip(comparison.grid_N, comparison.steady, *comparison.range_mm)
    return csv_text(
        ("force_N", "depth_mm", "range_low_mm", "range_high_mm"),
        [
            (f"{force:.4g}", "" if np.isnan(depth) else f"{depth:.5g}", f"{least:.5g}", f"{most:.5g}")
            for force, depth, least, most in rows
        ],
    )


def _force_variation(comparison: Comparison) -> str:
    lines: list[tuple[str, ...]] = []
    for trace, band, _ in comparison.presses:
        time, force = trace.since_contact
        at = band.time_s[:: max(len(band.time_s) // 300, 1)]
        seen = interpolate_rows(at[None], time[None], force[None])[0]
        low, high = np.interp(at, band.time_s, band.low_N), np.interp(at, band.time_s, band.high_N)
        for row in zip(at, seen, low, high):
            lines.append((trace.trace.name, *(f"{number:.6g}" for number in row)))
    return csv_text(("file", "time_s", "force_N", "range_low_N", "range_high_N"), lines)


def law_text(result: dict[str, Any]) -> str:
    """By what the subjects are known."""
    return "measured curves, no law" if result["law"] == "curves" else f"law {result['law']}"


def pad_text(result: dict[str, Any]) -> str:
    """The pad as it was cast; empty without its record."""
    pad = result.get("pad")
    if pad is None:
        return ""
    force = "" if pad["force_percent"] is None else f", force {pad['force_percent']:+.1f} % off the designed pad's"
    state = "accepted" if pad["accepted"] else "not accepted"
    return f"{pad['thickness_mm']:.2f} +- {pad['thickness_sd_mm']:.2f} mm as cast, {state}{force}"


def press_rows(result: dict[str, Any]) -> Table:
    """The table of presses."""
    rows = [
        [
            f"{row['steady_force_N']:.3g}",
            f"{row['velocity_mm_s']:.4g}",
            f"{row['depth_mm']:.2f}",
            f"{row['peak_force_N']:.2f}",
            f"{row['range_peak_low_N']:.2f} to {row['range_peak_high_N']:.2f}",
            _percent(row["inside_fraction"]),
        ]
        for row in result["force_variation_range"]
    ]
    return Table(["steady N", "mm/s", "depth mm", "pad peak N", "subjects N", "samples inside"], rows)


def steady_text(result: dict[str, Any]) -> str:
    """How much of the steady curve is inside the subjects' range, below and within the forces of the test."""
    steady = result["steady_state_range"]
    low, high = steady["span_N"]
    below, above = _percent(steady["below_5N_fraction"]), _percent(steady["above_5N_fraction"])
    return f"{0.1 * low:g} to {low:g} N: {below}; {low:g} to {high:g} N: {above}"


def parameters_text(result: dict[str, Any]) -> str:
    """Which parameters of the law are outside the subjects' band; empty without a law."""
    known = {name: row["inside"] for name, row in result["parametric"].items() if row["inside"] is not None}
    outside = [name for name, inside in known.items() if not inside]
    if outside:
        count = f"{len(outside)} of {len(known)} parameters of the force law"
        return f"{count} are outside the subjects' band: {', '.join(outside)}"
    return f"all {len(known)} parameters of the force law are inside the subjects' band" if known else ""


PLAN = "dummydesign campaign new DIR --resin NAME --ratio R"


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do with the pad, by the light of its verdict; nothing without one."""
    verdict, traces = result["verdict"] or {"light": ""}, result["inputs"]["traces"]
    if not verdict["light"]:
        return []
    if verdict["level"] == "not_settled":
        return [
            "do not use the pad yet: press what is missing, or press more repeats, and compare again",
            f"a plan of the presses: '{PLAN}'",
        ]
    if verdict["light"] == "red":
        return ["do not use this pad for these presses", *_correct_the_design(traces)]
    if verdict["light"] == "green" or verdict["correction"]["factor"] is None:
        used = "use the pad; its readings need no correction"
    else:
        force, energy = (max(verdict["correction"][name] or 1.0, 1.0) for name in ("force", "factor"))
        used = f"use the pad; multiply forces by {force:.2f}, energies by {energy:.2f}"
    return [used, _on_person(result["inputs"])]


def _on_person(inputs: dict[str, Any]) -> str:
    """The press on people with the drive by which the pad was compared, as it is typed."""
    passed, punch = inputs["lowpass"], inputs["punch"]
    words = f" --lowpass {passed['cutoff_hz']:g}:{passed['order']}:{passed['passes']}" if passed else ""
    words += "" if punch == PUNCH else f" --punch {quote(punch)}"
    trace, tissue = quote(inputs["traces"][0]), quote(inputs["tissue"])
    return f"dummydesign on-person {trace} --tissue {tissue} --drive steady{words}"


def _correct_the_design(traces: list[str]) -> list[str]:
    """How the next design is corrected: by the campaign to which the presses belong, or by one that is to be made."""
    folder = Path(traces[0]).parent
    if (folder / CAMPAIGN).is_file():
        return [f"dummydesign loop {quote(str(folder))}"]
    return [f"press a campaign of it: '{PLAN}'", "let it correct the next design: 'dummydesign loop DIR'"]
