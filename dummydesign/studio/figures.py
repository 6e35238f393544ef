"""What the pages draw: curves, presses, cross-sections, kinds of pads side by side."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.core.levels import level_name
from dummydesign.design.pad_evaluator import EvaluatedPad
from dummydesign.design.plot_data import force_grids
from dummydesign.design.problem import Problem
from dummydesign.design.request import ANSWER
from dummydesign.design.scoring.targets import Targets
from dummydesign.geometry.dimensions import PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.report.page import STYLES, figure_values, log_start
from dummydesign.report.plot import Plot, Series, keys_html, press_plot, steady_plot
from dummydesign.studio.markup import Markup, filled
from dummydesign.studio.state import State, punch_of

SMALL_PX, WIDE_PX = (300.0, 222.0), (600.0, 300.0)
ABOVE_MM, TALL_MM = 0.4, 3.6
"""How far over the pad the punch is drawn, and how much of it. [mm]"""


def steady(targets: Targets, pad: EvaluatedPad | None = None, people: Sequence[Series] = ()) -> Plot:
    """Steady force over depth: the subjects, the aim, and a pad where one is given."""
    grid = force_grids(targets.protocol).pad
    extrapolated, band, aim = people or _people(targets)
    series: list[Series] = [extrapolated, band, aim]
    alt = f"Steady force over depth of the subjects of {targets.tissue.name}"
    if pad is not None:
        depth = pad.candidate.steady_depth_mm(grid)
        series.append(Series.line("this pad", depth, grid))
        most_N = float(force_grids(targets.protocol).measured[-1])
        at = float(np.interp(most_N, grid, depth))
        alt += f"; the pad is {at:.2f} mm deep at {most_N:g} N" if np.isfinite(at) else f", not up to {most_N:g} N"
    deepest = float(max(band.high.max(), aim.x.max()))
    return replace(steady_plot(f"{alt}.", series), x_range=(0.0, 1.25 * deepest), y_range=(0.0, 16.0))


def _people(targets: Targets) -> tuple[Series, ...]:
    """Steady force over depth of the subjects and of the aim."""
    grids = force_grids(targets.protocol)
    below, band = (targets.depth_range_mm(force_N) for force_N in (grids.extrapolated, grids.measured))
    return (
        Series.band("subjects, extrapolated", grids.extrapolated, *below, sideways=True, style="extra"),
        Series.band("subjects", grids.measured, *band, sideways=True),
        Series.line("aim", targets.aim_depth_mm(grids.aim), grids.aim, "aim"),
    )


def depth_text(targets: Targets) -> str:
    """How deep the highest steady force presses the subjects and the aim, in a sentence."""
    force_N = force_grids(targets.protocol).measured[-1:]
    (low,), (high,) = targets.depth_range_mm(force_N)
    (aim,) = targets.aim_depth_mm(force_N)
    span = " to ".join(dict.fromkeys((f"{low:.1f}", f"{high:.1f}")))
    return f"At {force_N[0]:g} N the depth is {span} mm; the pad aims at {aim:.1f} mm."


@lru_cache(maxsize=8)
def _behind(problem: Problem) -> list[tuple[Series, ...]]:
    """What stands behind the pads of a question in each plot, once: a page is then sent what changed."""
    presses = [
        (
            Series.band("subjects", one.range.time_s, one.range.low_N, one.range.high_N),
            Series.line("aim", one.aim.time_s, one.aim.curves_N[0], "aim"),
        )
        for one in problem.targets.conditions
    ]
    return [_people(problem.targets), *presses]


def pad_plots(problem: Problem, shape: PadShape, pad: EvaluatedPad) -> list[Plot]:
    """Steady force of a pad, its cross-section, and force over time of every press of the protocol, small."""
    people, *behind = _behind(problem)
    plots = [
        steady(problem.targets, pad, people),
        section(shape, pad.candidate.thickness_mm, problem.punch),
    ]
    for number, (condition, series) in enumerate(zip(problem.targets.conditions, behind)):
        press = pad.candidate.evaluation.presses[number]
        own, reached = [], "out of reach"
        if np.isfinite(press.depth_mm[0]):
            own, reached = (
                [Series.line("this pad", press.time_s[0], press.force_N[0])],
                f"peak\u00a0{press.force_N[0].max():.1f}\u00a0N",
            )
        title = f"{condition.steady_force_N:g} N, {condition.velocity_mm_s:g} mm/s: {reached}"
        ends = 1e-2 if condition.velocity_mm_s < 50 else 1e-3, float(condition.range.time_s[-1])
        alt = f"Force over time of the press to {title}."
        plots.append(replace(press_plot(f"press-{number}", title, alt, [*series, *own], ends), size=SMALL_PX))
    return plots


def pad_html(plots: Sequence[Plot]) -> Markup:
    """The plots of a pad as HTML: one legend for force over depth and over time, the presses as a strip."""
    first, across, *presses = plots
    keys = dict.fromkeys(key for plot in (first, *presses) for key in plot.legend())
    strip = "".join(plot.html(keyed=False) for plot in presses)
    return filled(
        '{}<div class="plots large">{}{}</div><p class="source">Force [N] over time [s] of each press</p>'
        '<div class="plots small strip" role="group" aria-label="force [N] over time [s] of the presses">{}</div>',
        *map(Markup, (keys_html(keys), first.html(keyed=False), across.html(), strip)),
    )


def designs_plot(root: Path, folders: Sequence[str]) -> Plot | None:
    """Steady force over depth of several designs, and the range of each tissue; None without two that can be read."""
    bands: dict[str, Series] = {}
    pads: list[Series] = []
    for folder in folders:
        with suppress(KeyError, TypeError, ValueError):
            answer = read_json(root / folder / ANSWER)
            curve, tissue = answer["steady_curve"], answer["inputs"]["tissue"]
            name, people = folder.rpartition("/")[2], curve["subjects"]
            low, high = (np.array(people[key], float) for key in ("depth_low_mm", "depth_high_mm"))
            label, style = f"subjects of {tissue}", "extra" if bands else "band"
            band = Series.band(label, people["force_N"], low, high, sideways=True, style=style)
            depth = np.array(curve["depth_mm"], float)
            pads.append(Series.line(name, depth, curve["force_N"], STYLES[len(pads) % len(STYLES)]))
            bands.setdefault(tissue, band)
    if len(pads) < 2:
        return None
    names = ", ".join(one.label for one in pads)
    plot = steady_plot(f"Steady force over depth of {names}, and the subjects' range.", [*bands.values(), *pads])
    return replace(plot, name="designs")  # the page has a steady plot of its own


def measured_presses(path: Path) -> list[Plot]:
    """Measured force over time with the model's curve, one plot a condition, from the values that a report wrote."""
    figures = figure_values(path) if path.is_file() else {}
    return [_measured_press(name, rows) for name, rows in figures.items() if name.startswith("press-")]


def _measured_press(plot: str, rows: Sequence[Mapping[str, str]]) -> Plot:
    """One plot from the values of a report's plot: series, time, force."""
    series = _series(rows)
    curves = [one for one in series if one.kind != "band"]
    seen = [one for one in curves if one.kind == "dots"] or curves
    peak = max(float(one.y.max()) for one in seen)
    rise = min(float(one.x[int(np.argmax(one.y))]) for one in seen)
    last = max(float(one.x.max()) for one in curves)
    title = _condition_of(plot)
    alt = f"Measured force and the model's over time on a logarithmic axis, {title}; measured peak {peak:.3g} N."
    return press_plot(plot, title, alt, series, (min(log_start(rise), 0.5 * last), last))


def _series(rows: Sequence[Mapping[str, str]]) -> list[Series]:
    """The series of a plot of a report, from its values, bands first; measured ones are dots."""
    by_name: dict[str, list[Mapping[str, str]]] = {}
    for row in rows:
        if (row["x"] and row["y"]) or (row["low"] and row["high"]):  # a pad does not reach every force
            by_name.setdefault(row["series"], []).append(row)
    bands, curves = [], []
    for name, own in by_name.items():
        x, y, low, high = (np.array([float(row[key] or "nan") for row in own]) for key in ("x", "y", "low", "high"))
        label, sideways = name.partition(", ")[0], not np.isfinite(x).any()
        if np.isfinite(low).any():
            style = "extra" if "extrapolated" in name else "band"
            bands.append(Series.band(name, y if sideways else x, low, high, sideways=sideways, style=style))
        elif label == "measured":
            curves.append(Series.dots(label, x, y, "other"))
        else:
            curves.append(Series.line(label, x, y, "aim" if label == "base" else "main"))
    return [*bands, *curves]


def compared_plots(path: Path) -> list[Plot]:
    """Steady force over depth, then the presses, of a report that compares a pad with a tissue."""
    rows = (figure_values(path) if path.is_file() else {}).get("steady", [])
    series = [one for one in _series(rows) if one.kind == "band" or len(one.x) > 1]
    steady = steady_plot("Steady force over depth of the pad and of the subjects.", series)
    return [replace(steady, name="compared")] * bool(rows) + measured_presses(path)


def _condition_of(plot: str) -> str:
    """The condition in the name of a plot, in words."""
    name = plot.removeprefix("press-")
    if fitted := re.fullmatch(r"(.+)N-(.+)mm-s(?:-\d+)?", name):
        return f"{fitted[1]} N steady at {fitted[2]} mm/s"
    if looped := re.fullmatch(r"(.+?)mm-(.+?)mm-s-([\d.e+-]+)(N|mmdeep)(?:-\d+)?", name):
        level = f"{looped[3]} N" if looped[4] == "N" else f"{looped[3]} mm deep"
        return f"{looped[1]} mm pad, {looped[2]} mm/s, {level}"
    return name


def section(shape: PadShape, thickness_mm: float, punch: Punch) -> Plot:
    """Cross-section through the middle of a pad, with the punch over it."""
    half = 32.0
    y = np.linspace(-half, half, 257)
    top = thickness_mm - np.asarray(shape.drop_mm(np.zeros_like(y), y), float)
    bone = np.broadcast_to(np.asarray(shape.bone_mm(np.zeros_like(y), y), float), y.shape)
    series: list[Series] = [Series.band("pad", y, bone, top)]
    if float(bone.max()) > 0.0:
        series.append(Series.band("rigid bone", y, np.zeros_like(y), bone, style="extra"))
    if (parts := shape.layers()) is not None:
        series.append(Series.line("between the layers", y, np.full_like(y, thickness_mm - parts[0]), "other"))
    series.append(Series.line("tested face", y, top))
    series.append(Series.line(f"punch, {punch.text}", *_outline(punch, thickness_mm + ABOVE_MM), "aim"))
    alt = f"Cross-section of a {shape.title}, {thickness_mm:g} mm thick; 64 mm of {PAD_WIDTH_MM:g} mm are shown."
    return Plot(
        "section",
        "Cross-section, heights stretched",
        alt,
        "across [mm]",
        "height [mm]",
        "across_mm",
        "height_mm",
        tuple(series),
        x_range=(-half, half),
        y_range=(0.0, thickness_mm + 5.0),
        size=WIDE_PX,
    )


def section_html(root: Path, state: State) -> Markup:
    """The cross-section of the pad that is chosen, as HTML; empty while its shape is none."""
    with suppress(InputError):
        return Markup(section(read_shape(state.shape), state.thickness_mm, punch_of(root, state.punch)).html())
    return Markup()


def _outline(punch: Punch, foot_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Half of a punch and its mirror image over a height, from the left; closed at no end."""
    across, height = np.array([0.0, punch.half_width_mm]), np.zeros(2)
    if punch.profile_mm is not None:
        across, height = (np.asarray(part, float) for part in punch.profile_mm)
        across, height = across[height < TALL_MM], height[height < TALL_MM]
    if height[-1] < TALL_MM:
        across, height = np.r_[across, across[-1]], np.r_[height, TALL_MM]
    return np.r_[-across[::-1], across], foot_mm + np.r_[height[::-1], height]


KIND_COLUMNS: dict[str, str | Callable[[Any], object]] = {
    "pad": lambda row: f"{row['kind']}: {row['reason']}" if row["shape"] is None else row["kind"],
    "verdict": lambda row: level_name(row.get("level", "")) + " (estimate)" * (row.get("by") in ("table", "law")),
    "misfit": lambda row: row.get("misfit_rms_ln_force"),
    "usable after a puck": lambda row: f"{100.0 * row['after_puck']:.0f} %" if "after_puck" in row else None,
    "thickness mm": lambda row: row.get("thickness_mm"),
    "ratio": lambda row: row.get("ratio"),
}


def kind_rows(answer: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The best pad of each kind as the command judged it; the recommended one first, with its final verdict."""
    best = answer["recommendation"]
    kind = best["shape"].partition(":")[0]
    final = {"level": answer["verdict"]["level"], "by": "", **{key: best[key] for key in ("thickness_mm", "ratio")}}
    rows = [row | final if row["kind"] == kind else row for row in answer["shapes"]]
    return sorted(rows, key=lambda row: (row["kind"] != kind, -row.get("after_puck", -1.0)))
