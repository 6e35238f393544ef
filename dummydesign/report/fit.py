"""Report of a fit: measured against fitted, residuals, parameters, its files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import write_bytes, write_text
from dummydesign.core.tables import Table
from dummydesign.report.front_page import picture
from dummydesign.report.page import STYLES, Section, log_start, table_of_parameters, unique, write_report
from dummydesign.report.plot import Plot, Series, press_plot
from dummydesign.tissue.fitting.fit import TissueFit, subject_from_fit
from dummydesign.tissue.fitting.problem import fitted_force, residual_table
from dummydesign.tissue.fitting.reduction import ReducedTrace, condition_groups
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import tissue_toml

MOST_PLOTS = 24
RIVALS = (
    "AICc is counted under one and the same noise, that of seven elements; lower is better, and more elements must "
    "earn six. The left-out error is that of speeds and depths that were not fitted."
)
MODES = {
    "joint": "one set of parameters for all traces",
    "per-speed": "springs common to all traces, dampers of each speed by themselves",
    "per-condition": "every speed and depth by itself, then the mean",
}


def write_fit(fit: TissueFit, out: str, sources: Sequence[str] = ()) -> dict[str, str]:
    """Write ``out`` (a tissue TOML of one subject) and a folder beside it: the report, residuals as CSV and PNG."""
    path, data, residuals = Path(out), fit.result, _residuals(fit)
    folder = path.with_name(f"{path.stem}-report")
    folder.mkdir()
    facts = [
        (str(data["elements"]), f"elements ({(data['elements'] - 1) // 2} relaxing arms)"),
        (f"{data['rmse_N']:.3g} N", "rms residual over all samples"),
        (f"{data['noise_floor_N']:.3g} N", "noise floor, seen in the holds without any law"),
        (f"{data['max_residual_N']:.3g} N", "largest residual of a bin"),
        (str(len(data["by_trace"])), "traces"),
    ]
    lead = (
        f"Nonlinear law of {data['elements']} elements fitted to traces: {law_named(fit.law).words}; "
        f"{MODES[fit.mode]}. Low and high are the ends of 95 % intervals."
    )
    more = len(_groups(fit)) - MOST_PLOTS
    left_out = f" {more} more conditions are in the residual table." if more > 0 else ""
    sections = [
        Section(
            "Force over time",
            f"Dots are means over the bins that were fitted, the line is the fit along the measured motion.{left_out}",
            _presses(fit),
        ),
        Section(
            "Residual",
            "Measured minus fitted, in bins. The area is three times the noise floor, up and down.",
            residuals,
        ),
        Section("Parameters", _notes(data), table=table_of_parameters(data["parameters"])),
        *_by_condition(data),
        Section("3, 5 and 7 elements", f"{data['elements']} elements are reported. {RIVALS}", table=_rivals(data)),
        Section("Traces", "", table=_traces(data)),
    ]
    title, warnings = f"Fit {path.stem}", data["warnings"]
    notes, subjects = tuple(warning["message"] for warning in warnings), (subject_from_fit(path.stem, fit),)
    tissue = Tissue(path.stem, f"fit of {path.stem}", fit.law, subjects, (), notes, "file")
    drawn = picture(f"{path.stem}, law {fit.law}, {fit.mode}", residuals)
    files = {
        "tissue": write_text(path, tissue_toml(tissue)),
        "residuals": write_text(folder / "residuals.csv", residual_table(fit.problems)),
        "residual_plot": write_bytes(folder / "residuals.png", drawn),
    }
    report = write_report(folder, title, lead, sections, facts=facts, warnings=warnings, sources=sources)
    return {role: str(file) for role, file in files.items()} | report


def _series(fit: TissueFit) -> Iterable[tuple[ReducedTrace, np.ndarray, np.ndarray, np.ndarray]]:
    """Each trace with its fitted force in bins, and the fitted curve at its nodes with times since contact."""
    for problem, optimum in fit.problems:
        binned = problem.predict(optimum.solution.parameters, optimum.arms)[0]
        for index, (trace, own) in enumerate(problem.by_trace(binned)):
            time = trace.motion.time_s - trace.ramp.contact_time_s
            yield trace, own, time, fitted_force(problem, optimum, index)


def _groups(fit: TissueFit) -> list[tuple[float, float, list[tuple[Any, ...]]]]:
    """Speed, mean steady force and series of each condition, repeats together."""
    series = {id(row[0]): row for row in _series(fit)}
    return [
        (speed, float(np.mean([trace.steady_force_N for trace in group])), [series[id(trace)] for trace in group])
        for speed, _, group in condition_groups([row[0] for row in series.values()])
    ]


def _presses(fit: TissueFit) -> list[Plot]:
    plots: list[Plot] = []
    names: set[str] = set()
    for speed, force, rows in _groups(fit)[:MOST_PLOTS]:
        series: list[Series] = []
        for number, (trace, _, time, curve) in enumerate(rows):
            middle = trace.middle_s - trace.ramp.contact_time_s
            shown, style = middle > 0, STYLES[number % len(STYLES)]
            label = "measured" if len(rows) == 1 else f"measured, {trace.trace.name}"
            series.append(Series.dots(label, middle[shown], trace.force_N[shown], "other" if len(rows) == 1 else style))
            keep = time > 0
            series.append(
                Series.line(
                    "fitted" if len(rows) == 1 else f"fitted, {trace.trace.name}",
                    time[keep],
                    curve[keep],
                    "main" if len(rows) == 1 else style,
                )
            )
        rms = float(np.sqrt(np.mean(np.concatenate([trace.force_N - binned for trace, binned, *_ in rows]) ** 2)))
        peak = max(float(trace.force_N.max()) for trace, *_ in rows)
        ends = [float(time[-1]) for *_, time, _ in rows]
        title = f"{force:.3g} N steady at {speed:g} mm/s: rms {rms:.2g} N"
        alt = (
            f"Force over time on a logarithmic axis at {speed:g} mm/s, {force:.3g} N steady, peak {peak:.3g} N; bin "
            f"means and fit differ by {rms:.2g} N rms."
        )
        name = unique(f"press-{force:.2g}N-{speed:g}mm-s", names)
        rise = min(trace.ramp.rise_time_s for trace, *_ in rows)
        plots.append(press_plot(name, title, alt, series, (log_start(rise), max(ends))))
    return plots


def _residuals(fit: TissueFit) -> list[Plot]:
    rise: list[Series] = []
    hold: list[Series] = []
    for number, (speed, force, rows) in enumerate(_groups(fit)):
        style = STYLES[number % len(STYLES)]
        for trace, binned, *_ in rows:
            middle, depth = trace.middle_s, trace.depth_mm
            after, left = middle > trace.ramp.stop_time_s, trace.force_N - binned
            name = f"{speed:g} mm/s, {force:.3g} N"
            rise.append(Series.line(name, depth[~after], left[~after], style))
            hold.append(Series.line(name, middle[after] - trace.ramp.stop_time_s, left[after], style))
    floor, plots = 3.0 * fit.result["noise_floor_N"], []
    largest = max(float(np.max(np.abs(line.y))) for line in (*rise, *hold) if np.size(line.y))
    reach = 1.08 * max(largest, 1.5 * floor)
    for name, lines, label, column, log in (
        ("residual-rise", rise, "depth in the rise [mm]", "depth_mm", False),
        ("residual-hold", hold, "time since the stop [s]", "time_s", True),
    ):
        known = np.concatenate([np.asarray(line.x, float) for line in lines])
        ends = (max(float(known.min()), 1e-4) if log else 0.0, float(known.max()))
        band = Series.band("three noise floors", np.array(ends), np.full(2, -floor), np.full(2, floor))
        words = "over depth in the rise" if name.endswith("rise") else "over time in the hold"
        alt = f"Residual {words}; the largest of all bins is {largest:.3g} N, three noise floors are {floor:.2g} N."
        plots.append(
            Plot(
                name,
                f"Residual {words}",
                alt,
                label,
                "measured - fitted [N]",
                column,
                "residual_N",
                (band, *lines),
                log_x=log,
                x_range=ends,
                y_range=(-reach, reach),
            )
        )
    return plots


def _notes(data: dict[str, Any]) -> str:
    starts = data["starts"]
    noise = "; ".join(
        f"white {one['white_N']:.2g} N, slow {one['slow_N']:.2g} N over {one['slow_time_s']:.2g} s, contact "
        f"{one['position_mm']:.2g} mm, misfit {100 * one['misfit_fraction']:.2g} % of the peak"
        for one in data["noise"][:1]
    )
    return (
        f"{starts['same_optimum']} of {starts['tried']} starts ended in the same optimum. Noise behind the intervals"
        f"{' (of the first condition)' if len(data['noise']) > 1 else ''}: {noise}."
    )


def _by_condition(data: dict[str, Any]) -> list[Section]:
    if "by_condition" not in data:
        return []
    rows = [row | {name: one["value"] for name, one in row["parameters"].items()} for row in data["by_condition"]]
    columns = {"mm/s": "velocity_mm_s:g", "depth mm": "depth_mm", "steady N": "steady_force_N"}
    columns |= {name: name for name in rows[0]["parameters"]}
    text = "A parameter that changes with force or speed here need not change in the material; see the documentation."
    return [Section("Condition by condition", text, table=Table.of(rows, columns))]


def _rivals(data: dict[str, Any]) -> Table:
    lowest = min(row["aicc"] for row in data["comparison"].values())
    rows = [
        [
            f"{name}{' (reported)' if int(name) == data['elements'] else ''}",
            row["parameters"],
            row["rmse_N"],
            row["heldout_rmse_N"],
            f"{row['aicc']:.1f}",
            f"{row['aicc'] - lowest:.1f}",
        ]
        for name, row in data["comparison"].items()
    ]
    return Table(["elements", "parameters", "rms N", "left out rms N", "AICc", "above lowest"], rows)


def _traces(data: dict[str, Any]) -> Table:
    return Table.of(
        data["by_trace"],
        {
            "file": "file",
            "mm/s": "velocity_mm_s",
            "depth mm": "depth_mm",
            "steady N": "steady_force_N",
            "peak N": "peak_force_N",
            "fitted peak N": "fitted_peak_force_N",
            "rms N": "rmse_N",
            "worst bin N": "max_residual_N",
            "at s": "max_residual_time_s",
        },
    )
