"""Figures of a suggestion's report; every number in them was worked out before."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dummydesign.design.curves import (
    THICKNESS_GRID_MM,
    SuggestionCurves,
)
from dummydesign.report.figures.layers import Band, Bars, Cells, Dots, Ellipse, Line
from dummydesign.report.figures.plot import Plot

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion

STYLES = ("alt1", "alt2", "alt3", "alt4")


def relative_force_plot(answer: Suggestion, curves: SuggestionCurves) -> Plot:
    """Force of each kind's best pad over the aim's, at the aim's depth."""
    force = curves.forces_N.relative
    layers = [Line(f"aim: {answer.request.aim}", force, np.ones_like(force), "aim")]
    words = []
    for item, relative, style in zip(answer.beside, curves.relative_forces, ("main", *STYLES)):
        if relative is None:
            continue
        layers.append(Line(str(item.shape), force, relative, style))
        misfit = item.low_force.misfit_rms_ln_force
        words.append(f"{item.shape}: misfit {'not reached' if misfit is None else f'{misfit:.2f}'}")
    alt = f"Steady force of each pad over the tissue's at the same depth; 1 is the tissue. {'; '.join(words)}."
    return Plot("shapes", "Force of each pad over the tissue's, at equal depth", alt, "steady force of the tissue [N]",
                "force / tissue's force", "tissue_force_N", "force_ratio", tuple(layers), log_x=True,
                x_range=(float(force[0]), float(force[-1])), y_range=(0.0, 4.0),
                note="1 is the tissue; above 4 is cut off")  # fmt: skip


def steady_plot(answer: Suggestion, curves: SuggestionCurves) -> Plot:
    """Steady force over depth: subjects, aim, the recommended pad and the alternatives."""
    grids, protocol = curves.forces_N, answer.targets.protocol
    below = curves.subjects_extrapolated_mm
    layers = [
        Band("subjects, extrapolated", grids.extrapolated, *below, sideways=True, style="extra"),
        Band(f"subjects of {answer.tissue.name}", grids.measured, *curves.subjects_measured_mm, sideways=True),
        Line(f"aim: {answer.request.aim}", curves.aim_depth_mm, grids.aim, "aim"),
    ]
    stiff, soft, unreached = curves.castings_mm
    # where the softest castings do not reach a force, the band ends at the depth at which the gel bottoms out
    known, soft = np.isfinite(stiff), np.where(np.isfinite(soft), soft, curves.limit_mm)
    note = ""
    if unreached[-1] > 0.005:
        note = (
            f"{100 * unreached[-1]:.0f} % of castings do not reach {grids.pad[-1]:g} N: the gel bottoms out at "
            f"{curves.limit_mm:.1f} mm, where the band ends"
        )
    if known.any():
        layers.append(Band("95 % of the pad's castings", grids.pad[known], stiff[known], soft[known], sideways=True,
                           style="cast"))  # fmt: skip
    for other, depth, style in zip(answer.found.alternatives, curves.other_depths_mm, STYLES):
        layers.append(Line(f"{other.thickness_mm:g} mm, ratio {other.ratio:g}", depth, grids.pad, style))
    layers.append(Line("recommended pad", curves.pad_depth_mm, grids.pad))
    inside = float(answer.best.evaluation.steady_state_range[answer.best.index])
    alt = (
        f"Steady force over depth. The recommended pad lies inside the subjects' range for {100 * inside:.0f} % of "
        f"{protocol.words}; at {protocol.needed_N:g} N it is {curves.pad_depth_at_needed_mm:.2f} mm deep."
    )
    return Plot("steady", "Steady force over depth", alt, "depth [mm]", "steady force [N]", "depth_mm", "force_N",
                tuple(layers), note=note)  # fmt: skip


def press_plots(answer: Suggestion) -> list[Plot]:
    """Force over time of each condition: subjects, aim, recommended pad."""
    plots, best = [], answer.best
    for column, condition in enumerate(answer.targets.conditions):
        band, press = condition.range, best.evaluation.presses[column]
        force, speed = condition.steady_force_N, condition.velocity_mm_s
        layers = [Band("subjects", band.time_s, band.low_N, band.high_N)]
        layers.append(Line("aim", condition.aim.time_s, condition.aim.curves_N[0], "aim"))
        words = "out of the pad's reach"
        if np.isfinite(press.depth_mm[best.index]):
            curve = press.force_N[best.index]
            layers.append(Line("recommended pad", press.time_s[best.index], curve))
            share = float(best.evaluation.inside[best.index, column])
            words = f"peak {curve.max():.1f} N, {100 * share:.0f} % inside"
        title = f"{force:g} N at {speed:g} mm/s: {words}"
        alt = (
            f"Force over time on a logarithmic axis, {force:g} N steady at {speed:g} mm/s. Pad: {words}; "
            f"subjects peak between {band.peak_low_N:.1f} and {band.peak_high_N:.1f} N."
        )
        start = 1e-2 if speed < 50 else 1e-3
        plots.append(
            Plot(f"press-{force:g}N-{speed:g}mm-s", title, alt, "time since contact [s]", "force [N]", "time_s",
                 "force_N", tuple(layers), log_x=True, x_range=(start, float(band.time_s[-1])))
        )  # fmt: skip
    return plots


def score_maps(answer: Suggestion, curves: SuggestionCurves) -> list[Plot]:
    """The whole map, and its surroundings of the recommended design, where the ellipse can be seen."""
    found, best, needed = answer.found.score_map, answer.best, answer.targets.protocol.needed_N
    value = np.where(found.feasible, found.total, np.nan)
    rests = answer.rests_on
    layers = [Cells("total score", found.ratio, found.thickness_mm, value)]
    layers.append(Line("ratio that gives the modulus, 95 %", [rests["ratio_low"], rests["ratio_high"]],
                       [best.thickness_mm] * 2, "other"))  # fmt: skip
    off, thick = curves.ratio_error, answer.request.thickness_tolerance_mm
    layers.append(Ellipse("tolerance of weighing and thickness", best.ratio, best.thickness_mm, off, thick))
    others = answer.found.alternatives
    if others:
        layers.append(Dots("alternatives", [o.ratio for o in others], [o.thickness_mm for o in others], "other"))
    layers.append(Dots("recommended", [best.ratio], [best.thickness_mm], "aim"))
    alt = (
        f"Map of the score over ratio and thickness; the recommended {best.thickness_mm:g} mm and ratio "
        f"{best.ratio:g} score {best.total:.2f}. Designs that do not reach {needed:g} N are left out."
    )
    ends = [float(found.ratio[0]), float(found.ratio[-1])]
    wide = None if len(found.ratio) < 2 else (ends[0], ends[1])
    label = f"ratio ({answer.resin.ratio_meaning})"
    whole = Plot("score-map", "Score over ratio and thickness", alt, label, "thickness [mm]", "ratio", "thickness_mm",
                 tuple(layers), x_range=wide, note=f"1 is best; empty: {needed:g} N out of reach")  # fmt: skip
    if wide is None or off == 0.0:
        return [whole]
    columns = np.abs(found.ratio - best.ratio) <= 8 * off + 0.1
    rows = np.abs(found.thickness_mm - best.thickness_mm) <= 8 * thick + 0.5
    layers[0] = Cells("total score", found.ratio[columns], found.thickness_mm[rows], value[rows][:, columns])
    close = Plot("score-map-near", "The same around the recommended design", f"{alt} The ellipse is {off:.3g} parts "
                 f"and {thick:g} mm in half.", label, "thickness [mm]", "ratio", "thickness_mm", tuple(layers),
                 x_range=(best.ratio - 6 * off, best.ratio + 6 * off),
                 y_range=(best.thickness_mm - 6 * thick, best.thickness_mm + 6 * thick))  # fmt: skip
    return [whole, close]


def exponent_plot(answer: Suggestion, curves: SuggestionCurves) -> Plot:
    """Local exponent over thickness at several forces."""
    layers = [
        Line(f"{force:g} N", THICKNESS_GRID_MM, curves.exponent[:, column], style)
        for column, (force, style) in enumerate(zip(curves.forces_N.exponent_at, ("main", *STYLES)))
    ]
    here = list(curves.exponent_here)
    layers.append(Dots("recommended", [answer.best.thickness_mm] * len(here), here, "aim"))
    alt = f"Local exponent over thickness at ratio {answer.best.ratio:g}; the tissue's law has 3 everywhere."
    return Plot("exponent", f"Local exponent over thickness, ratio {answer.best.ratio:g}", alt, "thickness [mm]",
                "d ln F / d ln x", "thickness_mm", "exponent", tuple(layers), zero=False,
                note="1 is linear; the tissue's law has 3")  # fmt: skip


def sensitivity_bars(answer: Suggestion, curves: SuggestionCurves) -> list[Plot]:
    """Change of depth and of peak between both ends of each uncertainty."""
    found = curves.reactions
    names = [item.name for item in found]
    plots = []
    force, protocol = answer.targets.protocol.needed_N, answer.targets.protocol
    note = f"* at one end {force:g} N is out of reach" if any(name.endswith("*") for name in names) else ""
    depths, peaks = [item.depth_percent for item in found], [item.peak_percent for item in found]
    for name, title, pairs in (
        ("sensitivity-depth", f"Change of depth at {force:g} N, {protocol.slow_mm_s:g} mm/s", depths),
        ("sensitivity-peak", f"Change of peak at {force:g} N, {protocol.fast_mm_s:g} mm/s", peaks),
    ):
        low, high = np.array(pairs).T
        words = "; ".join(f"{label} {a:.1f} to {b:.1f} %" for label, (a, b) in zip(names, pairs))
        plots.append(Plot(name, title, f"{title}: {words}.", "change [%]", "", "change_percent", "none",
                          (Bars("change", names, low, high),), y_range=(0.0, float(len(names))),
                          note=note))  # fmt: skip
    return plots
