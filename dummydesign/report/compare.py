"""Report of a comparison: a measured dummy in the tissue's two ranges, and its parameters in their bands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.report.figures.layers import Band, Bars, Dots, Line
from dummydesign.report.figures.plot import Plot
from dummydesign.report.html.page import Section, Table, write_report
from dummydesign.report.press_figures import STYLES, digits, log_start, unique

if TYPE_CHECKING:
    from dummydesign.tissue.comparison.compare import Comparison
    from dummydesign.tissue.model.tissue import Tissue

FARTHEST = 3.0
"""Parameters are drawn up to this many widths of the band beside it."""


def write_compare_report(
    folder: Path, found: Comparison, tissue: Tissue, sources: Sequence[str], verdict: dict[str, Any] | None = None
) -> dict[str, str]:
    """Write the report of a comparison; see :func:`dummydesign.report.html.page.write_report`.

    Parameters
    ----------
    folder : Path
        Made when it is not there.
    found : Comparison
        What was compared.
    tissue : Tissue
        With whom.
    sources : sequence of str
        Where the tissue's numbers come from, for the foot of the page.
    verdict : dict, optional
        ``light`` and ``text``, the first thing on the page.

    Returns
    -------
    dict
        Paths by role: ``report`` and one ``report_NAME`` a plot.
    """
    data = found.result
    steady, rows = data["steady_state_range"], data["force_variation_range"]
    low, high = steady["span_N"]
    known = [row["inside"] for row in data["parametric"].values() if row["inside"] is not None]
    mean = float(np.mean([row["inside_fraction"] for row in rows]))
    facts = [
        (_percent(steady["above_5N_fraction"]), f"of the steady-state curve inside, {low:g} to {high:g} N"),
        (_percent(steady["below_5N_fraction"]), _below_words(tissue, low)),
        (_percent(mean), "of force over time inside, mean of the conditions"),
        *([(f"{sum(known)} of {len(known)}", "parameters inside their bands")] if data["parametric"] else []),
    ]
    lead = "" if tissue.said is None else f"{tissue.said[1]}. "
    lead += (
        f"Measured dummy against {tissue.title} ({tissue.name}), {len(tissue.subjects)} subjects, "
        f"{'no law' if tissue.measured else 'law ' + data['law']}. "
        "Each press is compared with the subjects at its own steady force, speed, hold and braking."
    ) + _test_words(data)
    sections = [
        Section("Steady force", _steady_words(data), [_steady(found, tissue)]),
        Section("Force over time", "Repeats of a condition share a figure; the range is that of the first.",
                _presses(found, data), _conditions(rows)),
        *_parameter_sections(data),
        Section("Fit behind the parameters", _fit_words(data), table=_traces(data)),
    ]  # fmt: skip
    title = f"Dummy against {tissue.name}"
    return write_report(folder, title, lead, sections, facts, data["warnings"], sources, verdict=verdict)


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


def _below_words(tissue: Tissue, low: float) -> str:
    known = ", where there are no data on people" if tissue.origin == "built-in" and low <= 5.0 else ""
    return f"of it in range below {low:g} N{known}"


def _steady_words(data: dict[str, Any]) -> str:
    reached, low = data["steady_state_range"]["reached_N"], data["steady_state_range"]["span_N"][0]
    carried = "their slowest rise, scaled to their steady force" if data["law"] == "curves" else "their law carried on"
    text = f"Below {low:g} N the subjects' range is {carried}, and drawn paler."
    return text if reached is None else f"The dummy was pressed from {reached[0]:.3g} to {reached[1]:.3g} N. {text}"


def _steady(found: Comparison, tissue: Tissue) -> Plot:
    low, high = found.test.span_N
    parts = [np.r_[0.0, found.grid_N[found.grid_N <= low * (1 + 1e-9)]],
             found.grid_N[found.grid_N >= low * (1 - 1e-9)]]  # fmt: skip
    below, among = ([np.interp(part, np.r_[0.0, found.grid_N], np.r_[0.0, edge]) for edge in found.range_mm]
                    for part in parts)  # fmt: skip
    layers = (
        Band("subjects, extrapolated", parts[0], *below, sideways=True, style="extra"),
        Band(f"subjects of {tissue.name}", parts[1], *among, sideways=True),
        Line("dummy", found.steady, found.grid_N),
        Dots("measured at the end of the hold", found.points[:, 0], found.points[:, 1], "aim"),
    )
    share = found.result["steady_state_range"]["above_5N_fraction"]
    alt = (
        f"Steady force over depth: the dummy against the subjects' range; {_percent(share)} inside from {low:g} to "
        f"{high:g} N. Measured points at {', '.join(f'{x:.2f} mm {f:.1f} N' for x, f in found.points)}."
    )
    return Plot("steady", "Steady force over depth", alt, "depth [mm]", "steady force [N]", "depth_mm", "force_N",
                layers)  # fmt: skip


def _presses(found: Comparison, data: dict[str, Any]) -> list[Plot]:
    """One figure a condition, in the order of the rows of the force variation range."""
    from dummydesign.tissue.fitting.groups import condition_groups

    bands = {id(trace): band for trace, band in found.presses}
    groups = condition_groups([trace for trace, _ in found.presses])
    plots, names = [], set()
    for (_, _, traces), row in zip(groups, data["force_variation_range"]):
        speed = row["velocity_mm_s"]
        band, force = bands[id(traces[0])], row["steady_force_N"]
        layers: list[Band | Line] = [Band(f"subjects of {data['tissue']}", band.time_s, band.low_N, band.high_N)]
        for number, trace in enumerate(traces):
            time = trace.trace.time_s[trace.inside] - trace.ramp.contact_time_s
            keep = time > 0
            name = "dummy" if len(traces) == 1 else f"dummy, {trace.trace.name}"
            layers.append(Line(name, *_thin(time[keep], trace.trace.force_N[trace.inside][keep]),
                               STYLES[number % len(STYLES)]))  # fmt: skip
        share = row["inside_fraction"]
        title = f"{force:.3g} N at {speed:g} mm/s: {_percent(share)} inside"
        alt = (
            f"Force over time on a logarithmic axis, {force:.3g} N steady at {speed:g} mm/s: the dummy peaks at "
            f"{row['peak_force_N']:.1f} N, the subjects between {row['range_peak_low_N']:.1f} and "
            f"{row['range_peak_high_N']:.1f} N; {_percent(share)} of the press lies inside."
        )
        start = log_start(min(trace.ramp.rise_time_s for trace in traces))
        plots.append(
            Plot(unique(f"press-{force:.2g}N-{speed:g}mm-s", names), title, alt, "time since contact [s]",
                 "force [N]", "time_s", "force_N", tuple(layers), log_x=True,
                 x_range=(start, float(band.time_s[-1])))
        )  # fmt: skip
    return plots


def _thin(time: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At most some three hundred samples, evenly in the logarithm of time, the peak among them."""
    chosen = np.searchsorted(time, np.geomspace(time[0], time[-1], 300)).clip(0, len(time) - 1)
    rows = np.unique(np.r_[chosen, int(np.argmax(force))])
    return time[rows], force[rows]


def _conditions(rows: list[dict[str, Any]]) -> Table:
    head = ["steady N", "mm/s", "depth mm", "peak N", "subjects' peaks N", "inside", "of the rise", "of the hold",
            "repeats"]  # fmt: skip
    body = [
        [row["steady_force_N"], f"{row['velocity_mm_s']:g}", row["depth_mm"], row["peak_force_N"],
         f"{row['range_peak_low_N']:.1f} to {row['range_peak_high_N']:.1f}", _percent(row["inside_fraction"]),
         *(_percent(row[key]) for key in ("inside_rise_fraction", "inside_hold_fraction")), row["repeats"]]
        for row in rows
    ]  # fmt: skip
    return Table(head, body)


def _parameter_sections(data: dict[str, Any]) -> list[Section]:
    """Parameters beside their bands, where the tissue has a law."""
    if not data["parametric"]:
        return []
    return [Section("Parameters", _parameter_words(data), _parameters(data), _parametric(data))]


def _parameter_words(data: dict[str, Any]) -> str:
    text = (
        "The same law fitted to the dummy, speed by speed, beside the band of the subjects: 0 and 1 are the ends of "
        "the band on a logarithmic scale, bars are the dummy's 95 % intervals."
    )
    return text + " A slab does not follow the law, so its parameters are a compromise over the forces."


def _parameters(data: dict[str, Any]) -> list[Plot]:
    labels, low, high, middle = [], [], [], []
    for name, row in data["parametric"].items():
        if row["band_low"] is None or not 0.0 < row["band_low"] < row["band_high"]:
            continue
        width = math.log(row["band_high"] / row["band_low"])
        ends = [
            math.log((row["value"] if row[end] is None else row[end]) / row["band_low"]) / width
            for end in ("low", "high")
        ]
        middle.append(math.log(row["value"] / row["band_low"]) / width)
        low.append(min(max(ends[0], -FARTHEST), 1.0 + FARTHEST))
        high.append(min(max(ends[1], -FARTHEST), 1.0 + FARTHEST))
        labels.append(name.replace("_N_per_mm3", "").replace("_N_s_per_mm.", " at ") + (" mm/s" if "." in name else ""))
    if not labels:
        return []
    count = float(len(labels))
    layers = (
        Band("band of the subjects", np.array([0.0, count]), np.zeros(2), np.ones(2), sideways=True),
        Bars("dummy", labels, low, high),
        Dots("dummy", middle, count - 0.5 - np.arange(len(labels)), "aim"),
    )
    words = "; ".join(f"{label} {a:.2g} to {b:.2g}" for label, a, b in zip(labels, low, high))
    return [
        Plot("parameters", "Parameters in their bands", f"Place of each parameter in its band, 0 and 1 are the ends: "
             f"{words}.", "place in the band [0 to 1]", "", "place", "none", layers, y_range=(0.0, count),
             x_range=(min(-0.3, *low) - 0.1, max(1.3, *high) + 0.1),
             note=f"cut off {FARTHEST:g} widths beside the band")
    ]  # fmt: skip


def _parametric(data: dict[str, Any]) -> Table:
    verdict = {True: "inside", False: "outside", None: "no band"}
    body = [
        [name, *(digits(row[key]) for key in ("value", "low", "high", "band_low", "band_high")),
         verdict[row["inside"]], "at bound" if row["at_bound"] else ""]
        for name, row in data["parametric"].items()
    ]  # fmt: skip
    return Table(["parameter", "dummy", "95 % low", "95 % high", "band low", "band high", "", ""], body)


def _fit_words(data: dict[str, Any]) -> str:
    fit = data["fit"]
    return (
        f"Rms residual {fit['rmse_N']:.3g} N, noise floor {fit['noise_floor_N']:.3g} N, largest residual "
        f"{fit['max_residual_N']:.3g} N."
    )


def _traces(data: dict[str, Any]) -> Table:
    body = [
        [row["file"], f"{row['velocity_mm_s']:g}", row["steady_force_N"], row["depth_mm"], row["peak_force_N"],
         _percent(row["inside_fraction"])]
        for row in data["by_trace"]
    ]  # fmt: skip
    return Table(["file", "mm/s", "steady N", "depth mm", "peak N", "inside"], body)
