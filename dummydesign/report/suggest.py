"""Report of a suggestion: what is recommended, how it lies in the tissue's ranges, and what it rests on."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design import sensitivity as details
from dummydesign.design.safety_view import SafetyView
from dummydesign.report.figures.layers import Band, Bars, Cells, Dots, Ellipse, Line
from dummydesign.report.figures.plot import Plot
from dummydesign.report.html.page import Section, Table, write_report
from dummydesign.report.html.viewer import box, read_stl, solid_section, viewer_script

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion

STYLES = ("alt1", "alt2", "alt3", "alt4")
STEADY_N = np.linspace(0.0, 15.0, 61)


def write_suggestion(
    folder: Path, answer: Suggestion, result: dict[str, Any], safety: SafetyView
) -> dict[str, str]:
    """Write the report of a suggestion into a folder; see :func:`dummydesign.report.html.page.write_report`.

    Parameters
    ----------
    folder : Path
    answer : Suggestion
    result : dict
        The answer as printed, with the files of the mould when there is one.
    safety : SafetyView
    """
    best = result["recommendation"]
    young, recipe = best["young_kPa"], best["recipe"]
    facts = [
        (f"{best['thickness_mm']:g} mm", f"thickness of the 150 x 120 mm {_pad_words(answer)}, glued to a rigid base"),
        *_shape_fact(answer),
        (f"{best['ratio']:g}", f"ratio: {best['ratio_meaning']}"),
        (f"{young['value']:.3g} kPa", f"long-term modulus (95 %: {young['low']:.3g} to {young['high']:.3g})"),
        *((f"{item['mass_g']:.1f} g", f"{item['name']} to weigh") for item in recipe["components"]),
        (f"{best['scores']['total']:.2f}", "score, 0 to 1"),
        (f"{100 * result['sensitivity']['yield_fraction']:.0f} %", "of pours stay in the steady-state range"),
    ]
    lead = (
        f"Recommended for {answer.tissue.title} ({answer.tissue.name}), aim {answer.request.aim}, of "
        f"{answer.resin.title}. {result['rests_on']['text']} Next: {result['rests_on']['next_step']}."
    )
    sections = [
        Section("Steady force", _steady_words(answer), [_steady(answer)], _low_table(best)),
        *_shapes(answer, result),
        Section("Force over time", "Each press is held for 10 s at the depth that gives the steady force at its end.",
                _presses(answer), _conditions(best)),
        Section("Why this design", _why(result), [*_maps(answer, result), _exponent(answer), *_reactions(answer)],
                _alternatives(result)),
        Section("Recipe", "", table=_recipe(best)),
        _solids(best, result.get("files", {})),
        _safety(safety),
    ]  # fmt: skip
    title = f"Dummy for the {answer.tissue.name}"
    return write_report(
        folder, title, lead, sections, facts, result["warnings"], result["sources"], [viewer_script()]
    )


def _steady_words(answer: Suggestion) -> str:
    return (
        "The relaxed pad against the subjects. Below 5 N nobody was measured; the range there is the cubic law "
        "extrapolated and drawn paler. "
        + (_FLAT if answer.shape.flat_top else "The pad's top is touched gradually, so it starts soft.")
    )


_FLAT = "A flat pad starts nearly linear, so it crosses the tissue's curve and cannot follow it."


def _pad_words(answer: Suggestion) -> str:
    return "slab" if answer.shape.name == "slab" else f"{answer.shape.name} pad"


def _shape_fact(answer: Suggestion) -> list[tuple[str, str]]:
    """The shape's lengths, with places where a narrow box may break the line."""
    if answer.shape.name == "slab":
        return []
    return [(answer.shape.name, str(answer.shape).partition(":")[2].replace(",", ", ") + " (mm)")]


def _shapes(answer: Suggestion, result: dict[str, Any]) -> list[Section]:
    """The best pad of each kind side by side, when shapes were searched."""
    if not answer.beside:
        return []
    text = (
        "The best pad of each kind by one rule: half the total score, half the closeness to the aim below 5 N. "
        "The misfit is the rms of ln F over 0.5 to 15 N; below 5 N the tissue's curve is an extrapolation."
    )
    if answer.centring:
        text += f" Of the recommended pad {answer.centring.text}."
    head = ["pad", "thickness mm", "ratio", "misfit", "share 0.5 to 5 N", "share 5 to 15 N",
            *(f"exponent at {force} N" for force in ("1", "5", "15")), "depth / thickness, 15 N", "total"]  # fmt: skip
    rows = []
    for row in result["shapes"]:
        if row["shape"] is None:
            rows.append([f"{row['kind']}: {row['reason']}", *[""] * (len(head) - 1)])
            continue
        rows.append(
            [
                row["shape"], f"{row['thickness_mm']:g}", f"{row['ratio']:g}", row["misfit_rms_ln_force"],
                row["share_below_5N"], row["share_above_5N"], *(row["exponent_at_N"][f] for f in ("1", "5", "15")),
                row["depth_over_thickness"], row["total"],
            ]
        )  # fmt: skip
    return [Section("Shapes side by side", text, [_beside(answer)], Table(head, rows))]


def _beside(answer: Suggestion) -> Plot:
    """Relative force of each kind's best pad over the aim's depth, on logarithmic axes by their logarithms."""
    force = np.geomspace(0.3, 15.0, 60)
    aim = answer.targets.aim_depth_mm(force)
    layers = [Line(f"aim: {answer.request.aim}", force, np.ones_like(force), "aim")]
    words = []
    for item, style in zip(answer.beside, ("main", *STYLES)):
        if item.candidate is None:
            continue
        depth, grid = details.steady_curve(item.candidate), details.FORCE_GRID_N
        known = np.isfinite(depth)
        at = np.exp(np.interp(np.log(aim), np.log(depth[known]), np.log(grid[known]), left=np.nan, right=np.nan))
        layers.append(Line(str(item.shape), force, at / force, style))
        misfit = item.low_force.misfit_rms_ln_force
        words.append(f"{item.shape}: misfit {'not reached' if misfit is None else f'{misfit:.2f}'}")
    alt = f"Steady force of each pad over the tissue's at the same depth; 1 is the tissue. {'; '.join(words)}."
    return Plot("shapes", "Force of each pad over the tissue's, at equal depth", alt, "steady force of the tissue [N]",
                "force / tissue's force", "tissue_force_N", "force_ratio", tuple(layers), log_x=True,
                x_range=(0.3, 15.0), y_range=(0.0, 4.0), note="1 is the tissue; above 4 is cut off")  # fmt: skip


def _steady(answer: Suggestion) -> Plot:
    measured = np.linspace(5.0, 15.0, 41)
    low = np.linspace(0.0, 5.0, 21)
    layers = [
        Band("subjects, extrapolated", low, *answer.targets.depth_range_mm(low), sideways=True, style="extra"),
        Band(f"subjects of {answer.tissue.name}", measured, *answer.targets.depth_range_mm(measured), sideways=True),
        Line(f"aim: {answer.request.aim}", answer.targets.aim_depth_mm(STEADY_N), STEADY_N, "aim"),
    ]
    for other, style in zip(answer.found.alternatives, STYLES):
        name = f"{other.thickness_mm:g} mm, ratio {other.ratio:g}"
        layers.append(Line(name, details.steady_curve(other), details.FORCE_GRID_N, style))
    depth = details.steady_curve(answer.best)
    layers.append(Line("recommended pad", depth, details.FORCE_GRID_N))
    inside = float(answer.best.evaluation.steady_state_range[answer.best.index])
    alt = (
        f"Steady force over depth. The recommended pad lies inside the subjects' range for {100 * inside:.0f} % of "
        f"5 to 15 N; at 10 N it is {np.interp(10.0, details.FORCE_GRID_N, depth):.2f} mm deep."
    )
    return Plot("steady", "Steady force over depth", alt, "depth [mm]", "steady force [N]", "depth_mm", "force_N",
                tuple(layers))  # fmt: skip


def _presses(answer: Suggestion) -> list[Plot]:
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


def _why(result: dict[str, Any]) -> str:
    parts = result["recommendation"]["scores"].items()
    scores = ", ".join(f"{name.replace('_', ' ')} {value:.2f}" for name, value in parts)
    slope = 100 * result["sensitivity"]["d_ln_young_per_percent_ratio"]
    return (
        f"Scores from 0 to 1: {scores}. The modulus changes {slope:.0f} % per 1 % of the ratio."
        "\n\n"
        "In the map the ellipse holds what weighing and thickness errors can do at most; the dotted line is the 95 % "
        "interval of the ratio that really gives the wanted modulus, over what is not known of the resin."
    )


def _maps(answer: Suggestion, result: dict[str, Any]) -> list[Plot]:
    """The whole map, and its surroundings of the recommended design, where the ellipse can be seen."""
    found, best = answer.found.score_map, answer.best
    value = np.where(found.feasible, found.total, np.nan)
    rests = result["rests_on"]
    layers = [Cells("total score", found.ratio, found.thickness_mm, value)]
    layers.append(Line("ratio that gives the modulus, 95 %", [rests["ratio_low"], rests["ratio_high"]],
                       [best.thickness_mm] * 2, "other"))  # fmt: skip
    off, thick = details.ratio_error(answer), answer.request.thickness_tolerance_mm
    layers.append(Ellipse("tolerance of weighing and thickness", best.ratio, best.thickness_mm, off, thick))
    others = answer.found.alternatives
    if others:
        layers.append(Dots("alternatives", [o.ratio for o in others], [o.thickness_mm for o in others], "other"))
    layers.append(Dots("recommended", [best.ratio], [best.thickness_mm], "aim"))
    alt = (
        f"Map of the score over ratio and thickness; the recommended {best.thickness_mm:g} mm and ratio "
        f"{best.ratio:g} score {best.total:.2f}. Designs that do not reach 10 N are left out."
    )
    ends = [float(found.ratio[0]), float(found.ratio[-1])]
    wide = None if len(found.ratio) < 2 else (ends[0], ends[1])
    label = f"ratio ({answer.resin.ratio_meaning})"
    whole = Plot("score-map", "Score over ratio and thickness", alt, label, "thickness [mm]", "ratio", "thickness_mm",
                 tuple(layers), x_range=wide, note="1 is best; empty: 10 N out of reach")  # fmt: skip
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


def _exponent(answer: Suggestion) -> Plot:
    exponent = details.exponent_over_thickness(answer, answer.law)
    layers = [
        Line(f"{force:g} N", details.THICKNESS_GRID_MM, exponent[:, column], style)
        for column, (force, style) in enumerate(zip(details.EXPONENT_AT_N, ("main", *STYLES)))
    ]
    here = [
        float(np.interp(answer.best.thickness_mm, details.THICKNESS_GRID_MM, exponent[:, column]))
        for column in range(len(details.EXPONENT_AT_N))
    ]
    layers.append(Dots("recommended", [answer.best.thickness_mm] * len(here), here, "aim"))
    alt = f"Local exponent over thickness at ratio {answer.best.ratio:g}; the tissue's law has 3 everywhere."
    return Plot("exponent", f"Local exponent over thickness, ratio {answer.best.ratio:g}", alt, "thickness [mm]",
                "d ln F / d ln x", "thickness_mm", "exponent", tuple(layers), zero=False,
                note="1 is a straight line; the tissue's law has 3")  # fmt: skip


def _reactions(answer: Suggestion) -> list[Plot]:
    found = details.reactions(answer, answer.cast)
    names = [item.name for item in found]
    plots = []
    note = "* at one end 10 N is out of reach" if any(name.endswith("*") for name in names) else ""
    for name, title, pairs in (
        ("sensitivity-depth", "Change of depth at 10 N, 10 mm/s", [item.depth_percent for item in found]),
        ("sensitivity-peak", "Change of peak at 10 N, 250 mm/s", [item.peak_percent for item in found]),
    ):
        low, high = np.array(pairs).T
        words = "; ".join(f"{label} {a:.1f} to {b:.1f} %" for label, (a, b) in zip(names, pairs))
        plots.append(Plot(name, title, f"{title}: {words}.", "change [%]", "", "change_percent", "none",
                          (Bars("change", names, low, high),), y_range=(0.0, float(len(names))),
                          note=note))  # fmt: skip
    return plots


def _low_table(best: dict[str, Any]) -> Table:
    rows = [
        [f"{row['force_N']:g}", row["depth_mm"], row["tissue_depth_low_mm"], row["tissue_depth_high_mm"]]
        for row in best["low_force"]
    ]
    return Table(["steady force N", "pad mm", "stiffest subject mm", "softest subject mm"], rows)


def _conditions(best: dict[str, Any]) -> Table:
    head = ["steady N", "speed mm/s", "depth mm", "depth / thickness", "peak N", "subjects' peaks N", "inside", ""]
    rows = [
        [
            f"{row['steady_force_N']:g}", f"{row['velocity_mm_s']:g}", row["depth_mm"], row["depth_over_thickness"],
            row["peak_force_N"], f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}",
            row["inside_fraction"], row["out_of_reach"] or "",
        ]
        for row in best["conditions"]
    ]  # fmt: skip
    return Table(head, rows)


def _alternatives(result: dict[str, Any]) -> Table | None:
    designs = [result["recommendation"], *result["alternatives"]]
    names = list(designs[0]["scores"])
    rows = [
        [f"{d['thickness_mm']:g} mm", f"{d['ratio']:g}", d["young_kPa"]["value"], *(d["scores"][n] for n in names)]
        for d in designs
    ]
    return Table(["design (first: recommended)", "ratio", "E kPa", *(name.replace("_", " ") for name in names)], rows)


def _recipe(best: dict[str, Any]) -> Table:
    recipe = best["recipe"]
    rows = [[item["name"], f"{item['mass_g']:.1f}"] for item in recipe["components"]]
    return Table(["component", "weigh g"], [*rows, ["total", f"{recipe['total_g']:.1f}"]])


def _solids(best: dict[str, Any], files: dict[str, str]) -> Section:
    """The made parts when their STL files are there, else a plain block."""
    found = {name: Path(files[f"{name}_stl"]) for name in ("mould", "pad") if f"{name}_stl" in files}
    parts = {name: read_stl(path) for name, path in found.items() if path.is_file()}
    text = "Drag or use the arrow keys to turn, scroll to come closer."
    if "pad" not in parts:
        parts = {"pad": box(150.0, 120.0, best["thickness_mm"])}
        text += " No mould was made; this is a block of the pad's size, without its shape."
    return solid_section(parts, text)


def _safety(view: SafetyView) -> Section:
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
