"""Report of a suggestion, and its figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.serialise import percent_below_limit
from dummydesign.core.tables import Table
from dummydesign.design.plot_data import (
    THICKNESS_GRID_MM,
    PressPictures,
    exponent_over_thickness,
    force_grids,
    ratio_error,
    reactions,
    relative_force,
)
from dummydesign.design.request import base_words
from dummydesign.design.suggestion import Suggestion
from dummydesign.design.test_conditions import KNOWN_FORCE_N, pressed_N
from dummydesign.geometry.punch import read_punch
from dummydesign.mold.files.solid_view import box, read_view, view_script
from dummydesign.report import suggest_facts
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Panel, full_sentence, pad_section
from dummydesign.report.page import STYLES, Section, solid_section, write_report
from dummydesign.report.plot import Plot, Series, press_plot, steady_plot
from dummydesign.report.sections import budget_section, curves_section
from dummydesign.report.suggest_sections import pressed_section


def relative_force_plot(answer: Suggestion) -> Plot:
    """Force of each kind's best pad over the aim's, at the aim's depth."""
    grids = force_grids(answer.targets.protocol)
    force = grids.relative
    series: list[Series] = [Series.line(f"aim: {answer.request.aim}", force, np.ones_like(force), "aim")]
    words = []
    for item, style in zip(answer.comparisons, STYLES[:5]):
        if item.candidate is None:
            continue
        series.append(Series.line(str(item.shape), force, relative_force(item.candidate, answer.targets, grids), style))
        misfit = None if item.low_force is None else item.low_force.misfit_rms_ln_force
        words.append(f"{item.shape}: misfit {'not reached' if misfit is None else f'{misfit:.2f}'}")
    alt = f"Steady force of each pad over the tissue's at the same depth; 1 is the tissue. {'; '.join(words)}."
    return Plot(
        "shapes",
        "Force of each pad over the tissue's, at equal depth",
        alt,
        "steady force of the tissue [N]",
        "ratio to tissue's force",
        "tissue_force_N",
        "force_ratio",
        series,
        log_x=True,
        x_range=(float(force[0]), float(force[-1])),
        y_range=(0.0, 4.0),
        note="1 is the tissue; above 4 is cut off",
    )


def steady_figure(answer: Suggestion) -> Plot:
    """Steady force over depth: subjects, aim, the recommended pad and the alternatives."""
    targets, best = answer.targets, answer.best
    protocol, grids = targets.protocol, force_grids(targets.protocol)
    below, among = (targets.depth_range_mm(force) for force in (grids.extrapolated, grids.measured))
    series: list[Series] = [
        Series.band("subjects, extrapolated", grids.extrapolated, *below, sideways=True, style="extra"),
        Series.band(f"subjects of {answer.tissue.name}", grids.measured, *among, sideways=True),
        Series.line(f"aim: {answer.request.aim}", targets.aim_depth_mm(grids.aim), grids.aim, "aim"),
    ]
    stiff, soft, unreached = answer.castings.few.depth_band_mm(grids.pad)
    # where the softest castings do not reach a force, the band ends at the depth at which the gel bottoms out
    known, soft = np.isfinite(stiff), np.where(np.isfinite(soft), soft, best.limit_mm)
    note = ""
    if unreached[-1] > 0.005:
        note = (
            f"{100 * unreached[-1]:.0f} % of castings do not reach {grids.pad[-1]:g} N: the gel bottoms out at "
            f"{best.limit_mm:.1f} mm, where the band ends"
        )
    if known.any():
        series.append(
            Series.band(
                "95 % of the pad's castings", grids.pad[known], stiff[known], soft[known], sideways=True, style="cast"
            )
        )
    others = sorted(answer.alternatives, key=lambda other: other.thickness_mm)
    for other, style in zip(others, STYLES[1:5]):
        depth = other.steady_depth_mm(grids.pad)
        series.append(Series.line(f"{other.thickness_mm:g} mm, ratio {other.ratio:g}", depth, grids.pad, style))
    depth = best.steady_depth_mm(grids.pad)
    series.append(Series.line("recommended pad", depth, grids.pad))
    inside = float(best.evaluation.steady_state_range[best.index])
    needed_mm = float(np.interp(protocol.needed_N, grids.pad, depth))
    alt = (
        f"Steady force over depth. The recommended pad lies inside the subjects' range for {100 * inside:.0f} % of "
        f"{protocol.words}; at {protocol.needed_N:g} N it is {needed_mm:.2f} mm deep."
    )
    return steady_plot(alt, series, note)


def press_plots(answer: Suggestion) -> list[Plot]:
    """Force over time of each condition: subjects, aim, recommended pad."""
    plots, best = [], answer.best
    for column, condition in enumerate(answer.targets.conditions):
        band, press = condition.range, best.evaluation.presses[column]
        force, speed = condition.steady_force_N, condition.velocity_mm_s
        series: list[Series] = [
            Series.band("subjects", band.time_s, band.low_N, band.high_N),
            Series.line("aim", condition.aim.time_s, condition.aim.curves_N[0], "aim"),
        ]
        words = "out of the pad's reach"
        if np.isfinite(press.depth_mm[best.index]):
            curve = press.force_N[best.index]
            series.append(Series.line("recommended pad", press.time_s[best.index], curve))
            share = float(best.evaluation.inside[best.index, column])
            words = f"peak {curve.max():.1f} N, {100 * share:.0f} % inside"
        title = f"{force:g} N at {speed:g} mm/s: {words}"
        alt = (
            f"Force over time on a logarithmic axis, {force:g} N steady at {speed:g} mm/s. Pad: {words}; "
            f"subjects peak between {band.peak_low_N:.1f} and {band.peak_high_N:.1f} N."
        )
        ends = (1e-2 if speed < 50 else 1e-3, float(band.time_s[-1]))
        plots.append(press_plot(f"press-{force:g}N-{speed:g}mm-s", title, alt, series, ends))
    return plots


def score_maps(answer: Suggestion) -> list[Plot]:
    """The whole map, and its surroundings of the recommended design, where the ellipse can be seen."""
    scores, best, needed = answer.score_map, answer.best, answer.targets.protocol.needed_N
    value = np.where(scores.feasible, scores.total, np.nan)
    rests = answer.rests_on
    series: list[Series] = [
        Series.map("total score", scores.ratio, scores.thickness_mm, value),
        Series.line(
            "ratio that gives the modulus, 95 %",
            [rests["ratio_low"], rests["ratio_high"]],
            [best.thickness_mm] * 2,
            "other",
        ),
    ]
    off, thick = ratio_error(answer), answer.castings.tolerances.thickness_mm
    series.append(Series.ellipse("tolerance of weighing and thickness", best.ratio, best.thickness_mm, off, thick))
    others = answer.alternatives
    if others:
        series.append(Series.dots("alternatives", [o.ratio for o in others], [o.thickness_mm for o in others], "other"))
    series.append(Series.dots("recommended", [best.ratio], [best.thickness_mm], "aim"))
    alt = (
        f"Map of the score over ratio and thickness; the recommended {best.thickness_mm:g} mm and ratio "
        f"{best.ratio:g} score {best.total:.2f}. Designs that do not reach {needed:g} N are left out."
    )
    ends = [float(scores.ratio[0]), float(scores.ratio[-1])]
    wide = None if len(scores.ratio) < 2 else (ends[0], ends[1])
    label = f"ratio ({answer.resin.ratio_meaning})"
    whole = Plot(
        "score-map",
        "Score over ratio and thickness",
        alt,
        label,
        "thickness [mm]",
        "ratio",
        "thickness_mm",
        tuple(series),
        x_range=wide,
        note=f"1 is best; empty: {needed:g} N out of reach",
    )
    if wide is None or off == 0.0:
        return [whole]
    columns = np.abs(scores.ratio - best.ratio) <= 8 * off + 0.1
    rows = np.abs(scores.thickness_mm - best.thickness_mm) <= 8 * thick + 0.5
    series[0] = Series.map("total score", scores.ratio[columns], scores.thickness_mm[rows], value[rows][:, columns])
    close = replace(
        whole,
        name="score-map-near",
        title="The same around the recommended design",
        alt=f"{alt} The ellipse is {off:.3g} parts and {thick:g} mm in half.",
        series=tuple(series),
        note="",
        x_range=(best.ratio - 6 * off, best.ratio + 6 * off),
        y_range=(best.thickness_mm - 6 * thick, best.thickness_mm + 6 * thick),
    )
    return [whole, close]


def exponent_plot(answer: Suggestion) -> Plot:
    """Local exponent over thickness at several forces."""
    thickness, grids = answer.best.thickness_mm, force_grids(answer.targets.protocol)
    exponent = exponent_over_thickness(answer, answer.law, grids)
    here = [float(np.interp(thickness, THICKNESS_GRID_MM, column)) for column in exponent.T]
    series = [
        *(
            Series.line(f"{force:g} N", THICKNESS_GRID_MM, exponent[:, column], style)
            for column, (force, style) in enumerate(zip(grids.exponent_at, STYLES[:5]))
        ),
        Series.dots("recommended", [thickness] * len(here), here, "aim"),
    ]
    alt = f"Local exponent over thickness at ratio {answer.best.ratio:g}; the tissue's law has 3 everywhere."
    return Plot(
        "exponent",
        f"Local exponent over thickness, ratio {answer.best.ratio:g}",
        alt,
        "thickness [mm]",
        "d ln F / d ln x",
        "thickness_mm",
        "exponent",
        series,
        zero=False,
        note="1 is linear; the tissue's law has 3",
    )


def sensitivity_bars(answer: Suggestion) -> list[Plot]:
    """Change of depth and of peak between both ends of each uncertainty."""
    bars, protocol, plots = reactions(answer, answer.cast), answer.targets.protocol, []
    names, force = [item.name for item in bars], protocol.needed_N
    note = f"* at one end {force:g} N is out of reach" if any(name.endswith("*") for name in names) else ""
    for what, speed in (("depth", protocol.slow_mm_s), ("peak", protocol.fast_mm_s)):
        low, high = np.array([getattr(item, f"{what}_percent") for item in bars]).T
        title = f"Change of {what} at {force:g} N, {speed:g} mm/s"
        words = "; ".join(f"{label} {a:.1f} to {b:.1f} %" for label, a, b in zip(names, low, high))
        plots.append(
            Plot(
                f"sensitivity-{what}",
                title,
                f"{title}: {words}.",
                "change [%]",
                "",
                "change_percent",
                "none",
                (Series.bars(names, low, high),),
                y_range=(0.0, float(len(names))),
                note=note,
            )
        )
    return plots


def suggestion_front(answer: Suggestion, result: dict[str, Any], presses: Sequence[Plot]) -> FrontPage:
    """Fill the first page from the answer and the plots of its presses, in the order of its conditions."""
    best, given = result["recommendation"], result["inputs"]
    section = pad_section(
        answer.shape,
        best["thickness_mm"],
        tuple(given["pad_mm"]),
        read_punch(given["punch"]),
        base_words(given["base"]),
    )
    table = suggest_facts.press_rows(result)
    steps, risk = suggest_facts.next_steps(result), suggest_facts.risk_text(result)
    blocks = [
        ("Correction", [full_sentence(line) for line in suggest_facts.correction_lines(result)]),
        ("Why this pad", [full_sentence(suggest_facts.why_text(result))]),
        ("Risk", [full_sentence(risk)] if risk else []),
    ]
    return FrontPage(
        title=f"Pad for the {answer.tissue.name}",
        basis=_basis(result),
        verdict=(result["verdict"]["light"], result["verdict"]["text"]),
        drawing=("Pad, cut through its highest point (mm)", section),
        facts_title="Recipe",
        facts=_recipe_facts(result),
        panels_title="Force [N] over time since contact",
        panels=[_panel(plot, row, cells) for plot, row, cells in zip(presses, best["conditions"], table.rows)],
        keys=[("band", "subjects"), ("main", "this pad"), ("aim", f"aim: {given['aim']}")],
        table=table,
        blocks=[(title, texts) for title, texts in blocks if texts],
        notes=suggest_facts.warning_texts(result),
        steps=[step if step.startswith("dummydesign ") else full_sentence(step) for step in steps],
        foot=FOOT,
    )


def _basis(result: dict[str, Any]) -> str:
    """What the answer holds for, and the calibration that it uses."""
    used = suggest_facts.calibration_text(result)
    return f"Valid for {suggest_facts.valid_text(result)}." + (f" {full_sentence(used)}" if used else "")


def _recipe_facts(result: dict[str, Any]) -> list[Fact]:
    """Ratio, weights, modulus and the words for the pad."""
    best = result["recommendation"]
    return [
        Fact(f"ratio: {suggest_facts.ratio_by_words(best)}", f"{best['ratio']:g}", True),
        Fact(f"weigh ({best['resin']})", "\n".join(suggest_facts.batch_lines(best["batch"]))),
        Fact("long-term modulus", suggest_facts.modulus_text(best)),
        Fact("pad", suggest_facts.pad_text(result)),
    ]


def _panel(plot: Plot, row: dict[str, Any], cells: Sequence[str]) -> Panel:
    """One press with its peak."""
    test = f"{row['steady_force_N']:g} N, {row['velocity_mm_s']:g} mm/s"
    reads = cells[-1] if row["depth_mm"] is None else f"{row['peak_force_N']:.1f} N: {cells[-1]}"
    return Panel(plot, test, reads, cells[-1] != "inside", f"{row['steady_force_N']:g}")


def write_suggestion(
    folder: Path,
    answer: Suggestion,
    result: dict[str, Any],
    pictures: PressPictures,
) -> dict[str, str]:
    """Write the report of a suggestion into a folder; see :func:`dummydesign.report.page.write_report`."""
    best = result["recommendation"]
    young, batch = best["young_kPa"], best["batch"]
    size, base = "{:g} x {:g} mm".format(*answer.request.pad_mm), base_words(answer.request.base)
    numbers = str(answer.shape).partition(":")[2]
    # with places where a narrow box may break the line
    lengths = [] if answer.shape.plain else [(answer.shape.name, f"{numbers.replace(',', ', ')} (mm)")]
    facts = [
        (f"{best['thickness_mm']:g} mm", f"thickness of the {size} {answer.shape.title}, {base}"),
        *lengths,
        (f"{best['ratio']:g}", f"ratio: {best['ratio_meaning']}"),
        (f"{young['value']:.3g} kPa", f"long-term modulus (95 %: {young['low']:.3g} to {young['high']:.3g})"),
        *((f"{item['mass_g']:.1f} g", f"{item['name']} to weigh") for item in batch["components"]),
        (f"{batch['pour_g']:.1f} g", f"of these {batch['total_g']:.1f} g to pour into the mould"),
        (f"{best['scores']['total']:.2f}", "score, 0 to 1"),
        *_castings_fact(result),
    ]
    lead = (
        f"Tissue: {answer.tissue.title}, aim {answer.request.aim}. Resin: {answer.resin.title}. "
        f"{result['rests_on']['text']} {full_sentence('next: ' + result['next'][0]['do'])}"
    )
    if answer.tissue.notice is not None:
        lead = f"{answer.tissue.notice[1]}. {lead}"
    if result["calibration"] is not None:
        lead = f"{result['calibration']['text']}. {lead}"
    presses = press_plots(answer)
    sections = [
        Section("Steady force", _steady_words(answer), [steady_figure(answer)], _low_table(best)),
        *_shapes(answer, result),
        Section("Force over time", _press_words(answer), presses, _conditions(best)),
        curves_section(result["curves"], result["verdict"]["subjects"], answer.request.aim),
        pressed_section(answer, pictures),
        Section(
            "Why this design",
            _why(result),
            [*score_maps(answer), exponent_plot(answer), *sensitivity_bars(answer)],
            _alternatives(result),
        ),
        Section(
            "Recipe",
            "Weigh the whole batch: it keeps the weighing error small. Pour the mass in the last column "
            "into the mould; the rest is spare.",
            table=_recipe_table(best),
        ),
        _solids(best, result.get("files", {}), answer.request.pad_mm),
        *budget_section(result["budget"]),
    ]
    title = f"Dummy for the {answer.tissue.name}"
    return write_report(
        folder,
        title,
        lead,
        sections,
        facts=facts,
        scripts=[view_script()],
        front=suggestion_front(answer, result, presses),
        **{name: result[name] for name in ("warnings", "sources", "verdict")},
    )


def _recipe_table(best: dict[str, Any]) -> Table:
    """What to weigh, the least batch that fills the mould, and what to pour; of a layered pad both pours."""
    rows = []
    for layer, batch, recipe in (
        ("", best["batch"], best["recipe"]),
        *((("base: ", best["batch"]["base"], best["recipe"].get("base")),) if "base" in best["batch"] else ()),
    ):
        needs = {} if recipe is None else {item["name"]: f"{item['mass_g']:.1f}" for item in recipe["components"]}
        rows += [
            [layer + item["name"], f"{item['mass_g']:.1f}", needs.get(item["name"], ""), ""]
            for item in batch["components"]
        ]
        total = "" if recipe is None else f"{recipe['total_g']:.1f}"
        rows.append([f"{layer}total", f"{batch['total_g']:.1f}", total, f"{batch['pour_g']:.1f}"])
    return Table(["component", "weigh g", "least batch g", "pour g"], rows)


def _castings_fact(result: dict[str, Any]) -> list[tuple[str, str]]:
    """The share of castings that are usable, and the correction."""
    castings, factors = result["shares"]["as_poured"], result["verdict"]["correction"]
    share, needed = castings["usable"], result["verdict"]["limits"]["share"]
    words = f"of {castings['n']} castings are usable ({100 * needed:g} % needed)"
    facts = [(percent_below_limit(share, needed), words)]
    if result["verdict"]["light"] == "amber" and factors["factor"] is not None:
        facts.append((f"{factors['force']:.2f}", "multiply forces by this as poured (95 % of castings in reach)"))
        if factors["factor"] - factors["force"] > 0.005:
            facts.append(
                (f"{factors['factor']:.2f}", "multiply energies by this as poured (95 % of castings in reach)")
            )
    return facts


def _known_from_N(answer: Suggestion) -> float:
    """Steady force from which on people were pressed; that of the built-in tissues where it is not known. [N]"""
    return (pressed_N(answer.tissue) or KNOWN_FORCE_N)[0]


def _steady_words(answer: Suggestion) -> str:
    low = (
        f"Below {_known_from_N(answer):.2g} N there are no data on people; the range there is their law extrapolated "
        "and drawn paler."
    )
    if answer.tissue.measured:
        low = (
            f"Below {answer.request.protocol.forces_N[0]:g} N the subjects' range is their slowest rise, scaled to "
            "their steady force, and drawn paler."
        )
    top = "The pad's top is touched gradually, so it starts soft."
    if answer.shape.flat_top:
        # a straight line it can follow, a cube not
        steep = answer.targets.power > 1.0
        top = "A flat pad starts nearly linear, so it crosses the tissue's curve and cannot follow it." if steep else ""
    return (
        f"The relaxed pad and the subjects. {low} The band of the pad holds 95 % of its castings. It covers the "
        f"uncertainty of the resin and the errors of weighing and thickness. {top}"
    )


def _press_words(answer: Suggestion) -> str:
    request = answer.request
    edge = f", edge radius {request.edge_radius_mm:g} mm" if request.edge_radius_mm else ""
    edge += "" if request.face == "bonded" else f", {request.face}"
    return (
        f"Each press of the punch ({request.punch}{edge}) is held for {request.hold_s:g} s at the depth that gives the "
        "steady force at its end."
    )


def _shapes(answer: Suggestion, result: dict[str, Any]) -> list[Section]:
    """The best pad of each kind side by side, when shapes were searched."""
    if not answer.comparisons:
        return []
    low, high = answer.targets.protocol.forces_N[0], answer.targets.protocol.forces_N[-1]
    text = (
        "The best pad of each kind by one rule: its level, then the castings that are usable after one puck, then the "
        f"misfit. The misfit is the rms of ln F over {0.1 * low:g} to {high:g} N; below "
        f"{_known_from_N(answer):.2g} N the tissue's curve is an extrapolation."
    )
    if answer.sites:
        text += f" Its sites: {answer.sites.text}."
    if answer.centring:
        text += f" Recommended pad, {answer.centring.text}."
    shown = [f"{force:g}" for force in (0.2 * low, low, high)]
    head = [
        "pad",
        "thickness mm",
        "ratio",
        "misfit",
        f"in range {0.1 * low:g} to {low:g} N",
        f"in range {low:g} to {high:g} N",
        *(f"exponent at {force} N" for force in shown),
        f"depth / thickness, {high:g} N",
        "total",
        "usable after a puck",
    ]
    rows = []
    for row in result["shapes"]:
        if row["shape"] is None:
            rows.append([f"{row['kind']}: {row['reason']}", *[""] * (len(head) - 1)])
            continue
        rows.append(
            [
                row["shape"],
                f"{row['thickness_mm']:g}",
                f"{row['ratio']:g}",
                row["misfit_rms_ln_force"],
                row["share_below_5N"],
                row["share_above_5N"],
                *(row["exponent_at_N"][f] for f in shown),
                row["depth_over_thickness"],
                row["total"],
                f"{100 * row['after_puck']:.0f} %",
            ]
        )
    return [Section("Shapes side by side", text, [relative_force_plot(answer)], Table(head, rows))]


def _why(result: dict[str, Any]) -> str:
    parts = result["recommendation"]["scores"].items()
    scores = ", ".join(f"{name.replace('_', ' ')} {value:.2f}" for name, value in parts if value is not None)
    given = result["choice"]["weights"]
    weights = ", ".join(f"{name.replace('_', ' ')} {given[name]:.3g}" for name in SCORED if name in given)
    slope = 100 * result["sensitivity"]["d_ln_young_per_percent_ratio"]
    return (
        f"{full_sentence(result['choice']['text'])} The score does not choose the pad."
        "\n\n"
        f"Scores from 0 to 1: {scores}. The total is their mean by the weights {given['set']} of this aim ({weights}). "
        f"The modulus changes {slope:.0f} % per 1 % of the ratio."
        "\n\n"
        "In the map the ellipse bounds the effect of weighing and thickness errors; the dotted line is the 95 % "
        "interval of the ratio that gives the wanted modulus, given the uncertainty of the resin."
    )


SCORED = ("aim", "steady_state_range", "force_variation_range", "parametric")


def _low_table(best: dict[str, Any]) -> Table:
    return Table.of(
        best["low_force"],
        {
            "steady force N": "force_N:g",
            "pad mm": "depth_mm",
            "stiffest subject mm": "tissue_depth_low_mm",
            "softest subject mm": "tissue_depth_high_mm",
        },
    )


def _conditions(best: dict[str, Any]) -> Table:
    return Table.of(
        best["conditions"],
        {
            "steady N": "steady_force_N:g",
            "speed mm/s": "velocity_mm_s:g",
            "depth mm": "depth_mm",
            "depth / thickness": "depth_over_thickness",
            "gel compression": "gel_compression",
            "peak N": "peak_force_N",
            "subjects' peaks N": lambda row: suggest_facts.press_texts(row)[0],
            "reads": lambda row: suggest_facts.press_texts(row)[1],
            "inside": "inside_fraction",
            "": lambda row: row["out_of_reach"] or "",
        },
    )


def _alternatives(result: dict[str, Any]) -> Table | None:
    designs = [result["recommendation"], *result["alternatives"]]
    rows = [
        [f"{one['thickness_mm']:g} mm", f"{one['ratio']:g}", one["young_kPa"]["value"], *one["scores"].values()]
        for one in designs
    ]
    names = (name.replace("_", " ") for name in designs[0]["scores"])
    return Table(["design (first: recommended)", "ratio", "E kPa", *names], rows)


def _solids(best: dict[str, Any], files: dict[str, str], pad_mm: tuple[float, float]) -> Section:
    """Pad and mould as they were made, else a plain block."""
    parts = read_view(Path(files["view"])) if "view" in files else {}
    text = "Drag or use the arrow keys to turn, scroll to zoom."
    if not parts:
        parts = {"pad": box(*pad_mm, best["thickness_mm"])}
        text += " No mould was made; this is a block of the pad's size, without its shape."
    return solid_section(parts, text)
