"""Report of a suggestion: what is recommended, how it lies in the tissue's ranges, and what it rests on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.design.curves import SuggestionCurves
from dummydesign.design.safety_view import SafetyView
from dummydesign.design.shown.press_pictures import PressPictures
from dummydesign.report.html.page import Section, Table, write_report
from dummydesign.report.html.viewer import box, read_stl, solid_section, viewer_script
from dummydesign.report.sections.pressed import pressed_section
from dummydesign.report.sections.safety import safety_section
from dummydesign.report.suggest_figures import (
    exponent_plot,
    press_plots,
    relative_force_plot,
    score_maps,
    sensitivity_bars,
    steady_plot,
)

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion


def write_suggestion(
    folder: Path, answer: Suggestion, result: dict[str, Any], curves: SuggestionCurves, safety: SafetyView,
    pictures: PressPictures,
) -> dict[str, str]:
    """Write the report of a suggestion into a folder; see :func:`dummydesign.report.html.page.write_report`.

    Parameters
    ----------
    folder : Path
    answer : Suggestion
    result : dict
        The answer as printed, with the files of the mould when there is one.
    curves : SuggestionCurves
    safety : SafetyView
    pictures : PressPictures
        The inside of the pressed pad, or why it is left out.
    """
    best = result["recommendation"]
    young, batch = best["young_kPa"], best["batch"]
    facts = [
        (f"{best['thickness_mm']:g} mm", f"thickness of the {_pad_words(answer)}, {_base_words(answer)}"),
        *_shape_fact(answer),
        (f"{best['ratio']:g}", f"ratio: {best['ratio_meaning']}"),
        (f"{young['value']:.3g} kPa", f"long-term modulus (95 %: {young['low']:.3g} to {young['high']:.3g})"),
        *((f"{item['mass_g']:.1f} g", f"{item['name']} to weigh") for item in batch["components"]),
        (f"{batch['pour_g']:.1f} g", f"of these {batch['total_g']:.1f} g to pour into the mould"),
        (f"{best['scores']['total']:.2f}", "score, 0 to 1"),
        *_castings_fact(result),
    ]
    first = result["measure_first"]
    lead = (f"{_sentence(first['text'])} {_sentence(first['protocol'])} " if first["text"] else "") + (
        f"Recommended for {answer.tissue.title} ({answer.tissue.name}), aim {answer.request.aim}, of "
        f"{answer.resin.title}. {result['rests_on']['text']}"
        + ("" if first["text"] else f" Next: {result['rests_on']['next_step']}.")
    )
    if answer.tissue.said is not None:
        lead = f"{answer.tissue.said[1]}. {lead}"
    if result["calibration"] is not None:
        lead = f"{result['calibration']['text']}. {lead}"
    sections = [
        Section("Steady force", _steady_words(answer), [steady_plot(answer, curves)], _low_table(best)),
        *_shapes(answer, result, curves),
        Section("Force over time", _press_words(answer),
                press_plots(answer), _conditions(best)),
        pressed_section(answer, pictures),
        Section("Why this design", _why(result),
                [*score_maps(answer, curves), exponent_plot(answer, curves), *sensitivity_bars(answer, curves)],
                _alternatives(result)),
        Section("Recipe", "", table=_recipe(best)),
        _solids(best, result.get("files", {}), answer.request.pad_mm),
        safety_section(safety),
    ]  # fmt: skip
    title = f"Dummy for the {answer.tissue.name}"
    return write_report(
        folder, title, lead, sections, facts, result["warnings"], result["sources"], [viewer_script()],
        verdict=result["verdict"],
    )


def _castings_fact(result: dict[str, Any]) -> list[tuple[str, str]]:
    """The share of castings that are usable, and the correction."""
    castings, factors = result["castings"], result["verdict"]["correction"]
    share = castings["stands_for"] + castings["usable"]
    facts = [(f"{100 * share:.0f} %", f"of {castings['n']} castings are usable")]
    if result["verdict"]["light"] == "amber" and factors["factor"] is not None:
        facts.append((f"{factors['force']:.2f}", "multiply forces by it (95 % of castings in reach)"))
        if factors["factor"] - factors["force"] > 0.005:
            facts.append((f"{factors['factor']:.2f}", "multiply energies by it (95 % of castings in reach)"))
    return facts


def _steady_words(answer: Suggestion) -> str:
    low = "Below 5 N there are no data on people; the range there is their law extrapolated and drawn paler."
    if answer.tissue.measured:
        low = (
            f"Below {answer.request.protocol.forces_N[0]:g} N the subjects' range is their slowest rise, scaled to "
            "their steady force, and drawn paler."
        )
    return (
        f"The relaxed pad and the subjects. {low} The band of the pad holds 95 % of its castings, by what is not known "
        "of the resin and the errors of weighing and thickness. "
        + (_flat_words(answer) if answer.shape.flat_top else "The pad's top is touched gradually, so it starts soft.")
    )


def _flat_words(answer: Suggestion) -> str:
    """A flat pad cannot follow a cube; a straight line it can."""
    return _FLAT if answer.targets.power > 1.0 else ""


_FLAT = "A flat pad starts nearly linear, so it crosses the tissue's curve and cannot follow it."


def _pad_words(answer: Suggestion) -> str:
    return "{:g} x {:g} mm ".format(*answer.request.pad_mm) + answer.shape.title


def _base_words(answer: Suggestion) -> str:
    base = answer.request.base
    return {"bonded": "glued to a rigid base", "sliding": "sliding on a rigid base"}.get(base, f"resting, {base}")


def _press_words(answer: Suggestion) -> str:
    request = answer.request
    edge = f", edge radius {request.edge_radius_mm:g} mm" if request.edge_radius_mm else ""
    edge += "" if request.face == "bonded" else f", {request.face}"
    return (
        f"Each press of the punch ({request.punch}{edge}) is held for {request.hold_s:g} s at the depth that gives the "
        "steady force at its end."
    )


def _shape_fact(answer: Suggestion) -> list[tuple[str, str]]:
    """The shape's lengths, with places where a narrow box may break the line."""
    if answer.shape.plain:
        return []
    return [(answer.shape.name, str(answer.shape).partition(":")[2].replace(",", ", ") + " (mm)")]


def _shapes(answer: Suggestion, result: dict[str, Any], curves: SuggestionCurves) -> list[Section]:
    """The best pad of each kind side by side, when shapes were searched."""
    if not answer.beside:
        return []
    low, high = answer.targets.protocol.forces_N[0], answer.targets.protocol.forces_N[-1]
    text = (
        f"The best pad of each kind by one rule: half the total score, half the closeness to the aim below {low:g} N. "
        f"The misfit is the rms of ln F over {0.1 * low:g} to {high:g} N; below 5 N the tissue's curve is an "
        "extrapolation."
    )
    if answer.sites:
        text += f" Its sites: {answer.sites.text}."
    if answer.centring:
        text += f" Of the recommended pad {answer.centring.text}."
    shown = [f"{force:g}" for force in (0.2 * low, low, high)]
    head = ["pad", "thickness mm", "ratio", "misfit", f"in range {0.1 * low:g} to {low:g} N",
            f"in range {low:g} to {high:g} N", *(f"exponent at {force} N" for force in shown),
            f"depth / thickness, {high:g} N", "total"]  # fmt: skip
    rows = []
    for row in result["shapes"]:
        if row["shape"] is None:
            rows.append([f"{row['kind']}: {row['reason']}", *[""] * (len(head) - 1)])
            continue
        rows.append(
            [
                row["shape"], f"{row['thickness_mm']:g}", f"{row['ratio']:g}", row["misfit_rms_ln_force"],
                row["share_below_5N"], row["share_above_5N"], *(row["exponent_at_N"][f] for f in shown),
                row["depth_over_thickness"], row["total"],
            ]
        )  # fmt: skip
    return [Section("Shapes side by side", text, [relative_force_plot(answer, curves)], Table(head, rows))]


def _why(result: dict[str, Any]) -> str:
    parts = result["recommendation"]["scores"].items()
    scores = ", ".join(f"{name.replace('_', ' ')} {value:.2f}" for name, value in parts if value is not None)
    given = result["choice"]["weights"]
    weights = ", ".join(f"{name.replace('_', ' ')} {given[name]:.3g}" for name in SCORED if name in given)
    slope = 100 * result["sensitivity"]["d_ln_young_per_percent_ratio"]
    return (
        f"{_sentence(result['choice']['text'])} {_sentence(result['choice']['expectation']['text'])}"
        "\n\n"
        f"Scores from 0 to 1: {scores}. The total is their mean by the weights {given['set']} of this aim ({weights}). "
        f"The modulus changes {slope:.0f} % per 1 % of the ratio."
        "\n\n"
        "In the map the ellipse bounds the effect of weighing and thickness errors; the dotted line is the 95 % "
        "interval of the ratio that gives the wanted modulus, given the uncertainty of the resin."
    )


SCORED = ("aim", "steady_state_range", "force_variation_range", "parametric")


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _low_table(best: dict[str, Any]) -> Table:
    rows = [
        [f"{row['force_N']:g}", row["depth_mm"], row["tissue_depth_low_mm"], row["tissue_depth_high_mm"]]
        for row in best["low_force"]
    ]
    return Table(["steady force N", "pad mm", "stiffest subject mm", "softest subject mm"], rows)


def _conditions(best: dict[str, Any]) -> Table:
    head = ["steady N", "speed mm/s", "depth mm", "depth / thickness", "gel compression", "peak N", "subjects' peaks N",
            "reads", "inside", ""]  # fmt: skip
    rows = [
        [
            f"{row['steady_force_N']:g}", f"{row['velocity_mm_s']:g}", row["depth_mm"], row["depth_over_thickness"],
            row["gel_compression"], row["peak_force_N"],
            f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}", _reads(row), row["inside_fraction"],
            row["out_of_reach"] or "",
        ]
        for row in best["conditions"]
    ]  # fmt: skip
    return Table(head, rows)


def _reads(row: dict[str, Any]) -> str:
    """How a press reads, with its size."""
    if row["reads"] in (None, "inside"):
        return row["reads"] or ""
    return f"{row['percent_outside']:.0f} % {row['reads']}"


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


def _solids(best: dict[str, Any], files: dict[str, str], pad_mm: tuple[float, float]) -> Section:
    """The made parts when their STL files are there, else a plain block."""
    found = {name: Path(files[f"{name}_stl"]) for name in ("mould", "pad") if f"{name}_stl" in files}
    parts = {name: read_stl(path) for name, path in found.items() if path.is_file()}
    text = "Drag or use the arrow keys to turn, scroll to zoom."
    if "pad" not in parts:
        parts = {"pad": box(*pad_mm, best["thickness_mm"])}
        text += " No mould was made; this is a block of the pad's size, without its shape."
    return solid_section(parts, text)
