"""The safety view as a section of a suggestion's report."""

from __future__ import annotations

from html import escape

import numpy as np

from dummydesign.design.safety_view import SafetyView
from dummydesign.report.figures.layers import Band, Line
from dummydesign.report.figures.plot import Plot
from dummydesign.report.html.page import Section, Table


def safety_section(view: SafetyView) -> Section:
    """Energy and pressure at each condition, and when asked for an impact and a user's limits."""
    rows = [
        [
            f"{row.steady_force_N:g}", f"{row.velocity_mm_s:g}",
            _pair(row.tissue_energy_mJ), row.pad_energy_mJ, _pair(row.tissue_pressure_N_per_cm2),
            row.pad_pressure_N_per_cm2,
        ]
        for row in view.presses
    ]  # fmt: skip
    head = ["steady N", "speed mm/s", "energy of the rise, subjects mJ", "pad mJ",
            "largest mean pressure, subjects N/cm2", "pad N/cm2"]  # fmt: skip
    plots = [_energy(view)]
    html = ""
    if view.impact:
        html += _impact_html(view)
    if view.limits:
        lines = [[row["body"], row["case"], row["criterion"], row["contact"], row["value"], row["limit"],
                  {True: "yes", False: "no", None: "–"}[row["within"]]] for row in view.limits]  # fmt: skip
        table = Table(["body", "case", "criterion", "contact", "value", "limit", "within"], lines)
        html += f"<p>{escape(view.limits_source)}</p>" + table.html()
    return Section("Safety view", view.text, plots, Table(head, rows), html)


def _pair(values: tuple[float, float]) -> str:
    return f"{values[0]:.3g} to {values[1]:.3g}"


def _energy(view: SafetyView) -> Plot:
    layers, styles = [], {10.0: "main", 250.0: "alt1"}
    for speed in dict.fromkeys(row.velocity_mm_s for row in view.presses):
        rows = [row for row in view.presses if row.velocity_mm_s == speed]
        forces = [row.steady_force_N for row in rows]
        low, high = zip(*(row.tissue_energy_mJ for row in rows))
        layers.append(Band(f"subjects, {speed:g} mm/s", forces, low, high, style="band" if speed > 50 else "extra"))
        pad = [np.nan if row.pad_energy_mJ is None else row.pad_energy_mJ for row in rows]
        layers.append(Line(f"pad, {speed:g} mm/s", forces, pad, styles.get(speed, "alt2")))
    alt = "Energy of the rise over steady force for the pad and the subjects at each speed."
    return Plot("energy", "Energy of the rise", alt, "steady force [N]", "energy [mJ]", "force_N", "energy_mJ",
                tuple(layers), note="integral of F dx from touch to stop")  # fmt: skip


def _impact_html(view: SafetyView) -> str:
    lines = [[row["body"], row["depth_mm"], row["peak_force_N"], row["energy_mJ"], row["mean_pressure_N_per_cm2"],
              row["note"]] for row in view.impact]  # fmt: skip
    head = ["body", "depth mm", "peak N", "energy mJ", "mean pressure N/cm2", ""]
    return f"<p>{escape(view.impact_text)}</p>" + Table(head, lines).html()
