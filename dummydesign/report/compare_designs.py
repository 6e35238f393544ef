"""Report of designs side by side: what was asked, one table of all numbers, presses, weights, steady curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.levels import level_name
from dummydesign.core.serialise import percent_below_limit
from dummydesign.report.page import STYLES, Section, Table, write_report
from dummydesign.report.plot import Plot, Series, steady_plot

if TYPE_CHECKING:
    from dummydesign.design.comparison import DesignComparison

Row = tuple[str, list[str]]
TERMS = {
    "aim": "aim",
    "steady_state_range": "steady range",
    "force_variation_range": "force range",
    "parametric": "parametric",
    "low_force_range": "low forces",
}
"""Score terms in the order of the answer's weights."""


def write_designs_report(folder: Path, comparison: DesignComparison) -> dict[str, str]:
    """Write the report of a comparison of designs; see :func:`dummydesign.report.page.write_report`."""
    designs = comparison.designs
    head = ["", *(one["name"] for one in designs)]
    asked = [Section("Different questions", "", table=Table(head, difference_rows(comparison.differences)))]
    facts = [(one["verdict"]["light"].upper(), f"{one['name']}: {_level(one)}") for one in designs]
    sections = [
        *(asked if comparison.differences else []),
        Section("Verdicts", "\n\n".join(f"{one['name']}: {one['verdict']['text']}" for one in designs)),
        Section(
            "Designs",
            table=Table(
                head,
                [
                    [label.replace("  ", "score: "), *cells]
                    for label, cells in [*design_rows(designs), *_lengths(designs)]
                ],
            ),
        ),
        Section(
            "Peak force against the subjects' range",
            "Peak of the pad, then the range of the subjects' peaks, in N: < below it, in inside it, > above it.",
            table=Table(head, [[label, *cells] for label, cells in press_rows(designs)]),
        ),
        Section("Steady force", "", [_steady(designs)]),
        Section(
            "Weights to mix",
            table=Table(["design", "pour", "component", "weigh g", "of total g", "pour g"], _weights(designs)),
        ),
    ]
    lead = f"{len(designs)} designs of 'dummydesign suggest': {', '.join(one['folder'] for one in designs)}."
    if comparison.differences:
        names = ", ".join(one["name"] for one in comparison.differences)
        lead = f"These designs answer different questions: they differ in {names}. {lead}"
    return write_report(
        folder,
        "Designs side by side",
        lead,
        sections,
        facts=facts,
        warnings=comparison.warnings,
        sources=comparison.sources,
    )


def difference_rows(differences: Sequence[Mapping[str, Any]]) -> list[list[str]]:
    """One row an input in which the questions differ."""
    return [[one["name"], *(value_words(value) for value in one["values"])] for one in differences]


def value_words(value: Any) -> str:
    """An input as it is read; a table of numbers by its name and where it comes from."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {value_words(one)}" for key, one in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(value_words(one) for one in value)
    if isinstance(value, float):
        return f"{value:g}"
    return "none" if value is None else str(value)[:60]


def design_rows(designs: Sequence[Mapping[str, Any]]) -> list[Row]:
    """All quantities but the presses, a cell a design."""
    rows: list[Row] = [
        ("verdict", [f"{one['verdict']['light'].upper()} {_level(one)}" for one in designs]),
        ("tissue", [one["tissue"] for one in designs]),
        ("pad", [f"{one['pad']['shape'].partition(':')[0]} {one['pad']['thickness_mm']:g} mm" for one in designs]),
        ("resin, ratio", [f"{one['resin']}, {one['ratio']:g}" for one in designs]),
        ("modulus kPa", [_interval(one["young_kPa"]) for one in designs]),
        ("score", [_number(one["scores"]["total"]) for one in designs]),
    ]
    for key, words in TERMS.items():
        values = [one["scores"].get(key) for one in designs]
        if any(value is not None for value in values):
            rows.append((f"  {words}", [_number(value) for value in values]))
    for key, words in (("shortfall", "subjects/pad"), ("over", "pad/subjects")):
        cells = [f"{_number(one[key]['central'])}, 95 %: {_number(one[key]['q95'])}" for one in designs]
        rows.append((words, cells))
    return [
        *rows,
        ("correction", [_correction(one) for one in designs]),
        ("usable", [f"{_usable(one['castings'])} of castings" for one in designs]),
        ("mix", [_mix(one["batch"]) for one in designs]),
    ]


def _correction(design: Mapping[str, Any]) -> str:
    """The factor of readings; of a red pad none helps."""
    if design["verdict"]["light"] == "red":
        return "none helps"
    return f"{_number(design['correction']['factor_central'])}, 95 %: {_number(design['correction']['factor'])}"


def _usable(castings: Mapping[str, Any]) -> str:
    return percent_below_limit(castings["usable_fraction"], castings["needed_fraction"])


def _lengths(designs: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Size and lengths of the pads, which have no room on a screen."""
    pads = [one["pad"] for one in designs]
    size = [f"{pad['length_mm']:g} x {pad['width_mm']:g} mm, {pad['base']}" for pad in pads]
    return [("shape", [pad["shape"].replace(",", ", ") for pad in pads]), ("size, base", size)]


def press_rows(designs: Sequence[Mapping[str, Any]]) -> list[Row]:
    """Peak of each press against the subjects' range, a cell a design."""
    pressed = [{(row["steady_force_N"], row["velocity_mm_s"]): row for row in one["conditions"]} for one in designs]
    keys = sorted({key for one in pressed for key in one}, key=lambda key: (key[1], key[0]))
    return [
        (f"{force:g} N {speed:g} mm/s", [_press(one.get((force, speed))) for one in pressed]) for force, speed in keys
    ]


def _press(row: Mapping[str, Any] | None) -> str:
    if row is None:
        return "not asked"
    if row["peak_force_N"] is None:
        return "out of reach"
    sign = {"low": "<", "high": ">"}.get(row["reads"], "in")
    return f"{row['peak_force_N']:.3g} {sign} {row['target_peak_low_N']:.3g}-{row['target_peak_high_N']:.3g}"


def _level(design: Mapping[str, Any]) -> str:
    return level_name(design["verdict"]["level"])


def _interval(value: Mapping[str, float]) -> str:
    return f"{value['value']:.3g} ({value['low']:.3g}-{value['high']:.3g})"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _mix(batch: Mapping[str, Any]) -> str:
    text = " + ".join(f"{one['mass_g']:.1f}" for one in batch["components"]) + f" = {batch['total_g']:.1f} g"
    return f"{text}; base {_mix(batch['base'])}" if "base" in batch else text


def _weights(designs: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """One row a component."""
    rows = []
    for one in designs:
        pours = [("gel", one["batch"]), *([("base", one["batch"]["base"])] if "base" in one["batch"] else [])]
        for name, batch in pours:
            rows += [
                [
                    one["name"],
                    name,
                    part["name"],
                    f"{part['mass_g']:.1f}",
                    f"{batch['total_g']:.1f}",
                    f"{batch['pour_g']:.1f}",
                ]
                for part in batch["components"]
            ]
    return rows


def _steady(designs: Sequence[Mapping[str, Any]]) -> Plot:
    """Steady force over depth of all pads, and each tissue's range."""
    series: list[Series] = []
    for tissue, one in {one["tissue"]: one for one in reversed(designs)}.items():
        people = one["steady_curve"]["subjects"]
        series.append(
            Series.band(
                f"subjects of {tissue}",
                people["force_N"],
                people["depth_low_mm"],
                people["depth_high_mm"],
                sideways=True,
                style="band" if tissue == designs[0]["tissue"] else "extra",
            )
        )
    for number, one in enumerate(designs):
        curve = one["steady_curve"]
        depth = np.array(curve["depth_mm"], float)
        series.append(Series.line(one["name"], depth, curve["force_N"], STYLES[number % len(STYLES)]))
    alt = f"Steady force over depth of {', '.join(one['name'] for one in designs)}, and the subjects' range."
    return steady_plot(alt, series)
