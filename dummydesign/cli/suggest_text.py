"""The answer of `dummydesign suggest` as text: one screen, or all of it."""

from __future__ import annotations

from typing import Any

from dummydesign.cli.text import (
    NO_LAW,
    file_lines,
    first_lines,
    fitted,
    impact_of,
    labelled,
    tissue_lines,
    verdict_lines,
    warning_lines,
)
from dummydesign.core.options import command_words
from dummydesign.design.options import SuggestOptions, base_words
from dummydesign.design.scoring.verdict import OUTCOMES, whole_percents


def details(result: dict[str, Any]) -> str:
    """Lay all of the answer out as tables."""
    best = result["recommendation"]
    young = best["young_kPa"]
    lines = [
        *verdict_lines(result["verdict"]),
        *tissue_lines(result),
        *_calibration(result),
        *first_lines(result),
        f"{result['inputs']['tissue']}, aim {result['inputs']['aim']}",
        "",
        f"  pad        {_pad_details(result)}",
        *([f"  sites      {result['sites']['text']}"] if result["sites"] else []),
        f"  test       {test_line(result['inputs'])}",
        f"  resin      {best['resin']}, ratio {best['ratio']:g} ({best['ratio_meaning']})",
        *(f"  weigh      {line}" for line in batch_lines(best["batch"])),
        f"  modulus    {young['value']:.3g} kPa long-term (95 %: {young['low']:.3g} to {young['high']:.3g})",
        "",
        "scores, 0 to 1 (more is better):",
        "  " + "   ".join(f"{name.replace('_', ' ')} {'none' if value is None else format(value, '.2f')}"
                          for name, value in best["scores"].items()),
        "",
        "  steady N  mm/s   depth mm  depth/thickness  gel used  peak N   tissue peak N   fraction in range  reads",
    ]
    lines += [_condition(row) for row in best["conditions"]]
    no_law = any(item["code"] == NO_LAW for item in result["warnings"])
    words = "the people's slowest rise, scaled to their steady force" if no_law else (
        "the tissue's law extrapolated; no data on people")  # fmt: skip
    lines += ["", f"  small forces ({words}):", "  N      depth mm   tissue mm"]
    for row in best["low_force"]:
        depth = "-" if row["depth_mm"] is None else f"{row['depth_mm']:.2f}"
        span = f"{row['tissue_depth_low_mm']:.2f} to {row['tissue_depth_high_mm']:.2f}"
        lines.append(f"  {row['force_N']:<6g} {depth:<10} {span}")
    lines += _shapes(result) + _parameters(best) + _more_details(result)
    return "\n".join(lines)


def batch_lines(batch: dict[str, Any]) -> list[str]:
    """What to mix and how much of it to pour; of a layered pad both pours, and what a puck takes besides."""
    lines = []
    for name, one in (("", batch), *((("base: ", batch["base"]),) if "base" in batch else ())):
        weigh = " + ".join(f"{item['name']} {item['mass_g']:.1f} g" for item in one["components"])
        lines.append(f"{name}{weigh} = {one['total_g']:.1f} g; pour {one['pour_g']:.1f} g of it")
    if batch["witness"]["total_g"] > batch["total_g"]:
        lines[0] += f" (with a puck: {batch['witness']['total_g']:.1f} g)"
    return lines


def _calibration(result: dict[str, Any]) -> list[str]:
    """What the calibration found and left, where one is used."""
    used = result["calibration"]
    if used is None:
        return []
    return [used["text"], *(f"  unexplained: {reason}" for reason in used["unexplained_because"][:2])]


def _shapes(result: dict[str, Any]) -> list[str]:
    """The best pad of each kind of shape, one a line."""
    if not result["shapes"]:
        return []
    low, high, shown = _forces(result)
    lines = [
        "",
        f"  shapes side by side (misfit: rms of ln F from {0.1 * low:g} to {high:g} N; range: fraction of the steady "
        f"curve in range;\n  exponent d ln F / d ln x, tissue {result['tissue_exponent']:.3g}):",
        f"  misfit  range <{low:g} N  range >{low:g} N  exponent {'/'.join(shown)} N  d/h    total  pad",
    ]
    for row in result["shapes"]:
        if row["shape"] is None:
            lines.append(f"  {row['kind']}: {row['reason']}")
            continue
        misfit, depth = ("-" if row[name] is None else f"{row[name]:.2f}"
                         for name in ("misfit_rms_ln_force", "depth_over_thickness"))  # fmt: skip
        exponents = (row["exponent_at_N"][force] for force in shown)
        powers = " / ".join("-" if value is None else f"{value:.1f}" for value in exponents)
        lines.append(
            f"  {misfit:<7} {row['share_below_5N']:<11.2f} {row['share_above_5N']:<11.2f} {powers:<18} {depth:<6} "
            f"{row['total']:<6.2f} {row['thickness_mm']:g} mm {row['shape']}, ratio {row['ratio']:g}"
        )
    return [*lines, *_passed_over(result)]


def _passed_over(result: dict[str, Any]) -> list[str]:
    """The pad with the best score where it was passed over because it is not representative."""
    known = [row for row in result["shapes"] if row["shape"] is not None]
    nearest = max(known, key=lambda row: row["total"], default=None)
    if nearest is None or nearest["acceptable"] or nearest["shape"] == result["recommendation"]["shape"]:
        return []
    return [
        f"  the {nearest['kind']} pad scores higher (total {nearest['total']:.2f}) and is not representative; "
        f"--shape {nearest['kind']} gives it",
    ]


def _forces(result: dict[str, Any]) -> tuple[float, float, tuple[str, str, str]]:
    """Lowest and highest force of the test, and the keys of three exponents: below, lowest and highest."""
    forces = sorted(result["inputs"]["force_N"])
    return forces[0], forces[-1], (f"{0.2 * forces[0]:g}", f"{forces[0]:g}", f"{forces[-1]:g}")


def _pad_details(result: dict[str, Any]) -> str:
    best, given = result["recommendation"], result["inputs"]
    length, width = given["pad_mm"]
    return f"{best['thickness_mm']:g} mm thick, {length:g} x {width:g} mm {best['shape']}, {base_words(given['base'])}"


def test_line(given: dict[str, Any]) -> str:
    """The presses for which the answer holds."""
    kind, _, size = given["punch"].partition(":")
    punch = f"{size} x {size} mm punch" if kind == "square" else f"{kind} punch {size} mm"
    forces, speeds = (sorted(given[name]) for name in ("force_N", "velocity_mm_s"))
    span = f"{forces[0]:g} to {forces[-1]:g} N" if len(forces) > 1 else f"{forces[0]:g} N"
    edge = f", edge radius {given['edge_radius_mm']:g} mm" if given["edge_radius_mm"] else ""
    face = "" if given["condition"] == "bonded" else f", {given['condition']}"
    hold = "" if given["hold_s"] == 10.0 else f", held {given['hold_s']:g} s"
    return f"{punch}{edge}{face}, {span}, {' and '.join(f'{v:g}' for v in speeds)} mm/s{hold}"


def _condition(row: dict[str, Any]) -> str:
    head = f"  {row['steady_force_N']:<9g} {row['velocity_mm_s']:<6g}"
    if row["depth_mm"] is None:
        return f"{head} {row['out_of_reach']}"
    span = f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}"
    return (
        f"{head} {row['depth_mm']:<9.2f} {row['depth_over_thickness']:<16.2f} {row['gel_compression']:<9.2f} "
        f"{row['peak_force_N']:<8.1f} {span:<15} {row['inside_fraction']:<18.2f} {row['reads']}"
    )


def _parameters(best: dict[str, Any]) -> list[str]:
    if best["parameters"] is None:
        return []
    lines = ["", f"parameters of the tissue law ({best['parameters_law']}) fitted to this pad's simulated presses:"]
    for name, value in best["parameters"].items():
        symbol, unit = name.split("_", 1)
        unit = {"N_per_mm3": "N/mm3", "N_s_per_mm": "N s/mm"}[unit]
        by_speed = value.items() if isinstance(value, dict) else ()
        text = ", ".join(f"{item:.3g} at {speed} mm/s" for speed, item in by_speed) or f"{value:.3g}"
        lines.append(f"  {symbol:<7} {text} {unit}")
    return lines


def _more_details(result: dict[str, Any]) -> list[str]:
    """Alternatives, tolerance, verification, files, and what the answer rests on."""
    head = ["", "alternatives:", "  mm     ratio   kPa     total  steady  force-time  aim   below 5 N"]
    lines = head if result["alternatives"] else []
    for other in result["alternatives"]:
        s, young = other["scores"], other["young_kPa"]["value"]
        lines.append(
            f"  {other['thickness_mm']:<6g} {other['ratio']:<7g} {young:<7.3g} {s['total']:<6.2f} "
            f"{s['steady_state_range']:<7.2f} {s['force_variation_range']:<11.2f} {s['aim']:<5.2f} "
            f"{s['low_force_range']:.2f}"
        )
    tolerance = result["sensitivity"]
    limits, slope = tolerance["tolerances"], 100 * tolerance["d_ln_young_per_percent_ratio"]
    lines += [
        "",
        f"tolerance: modulus changes {slope:.0f} % per 1 % of ratio; "
        f"with {limits['weighing_g']:g} g and {limits['thickness_mm']:g} mm",
        *_castings(result),
    ]
    checked = result["verification"]
    if checked["max_difference_percent"] is not None:
        lines.append(
            f"verified: {checked['fidelity']} finite elements differ by at most "
            f"{checked['max_difference_percent']:.2f} % from the table"
        )
    lines += ["", result["rests_on"]["text"]]
    if not result["measure_first"]["group"]:
        lines.append(f"next: {result['rests_on']['next_step']}")
    return lines + file_lines(result) + warning_lines(result)


def _castings(result: dict[str, Any]) -> list[str]:
    """The castings by class, what each known group makes of them, and their share in the steady range."""
    drawn, first, names = result["castings"], result["measure_first"], ("stands_for", "usable", *OUTCOMES)
    shares = whole_percents([drawn[name] for name in names])
    words = ["need no correction", "are usable with one", *(OUTCOMES[name] for name in OUTCOMES)]
    over = first["acceptable_over_tissues"]
    lines = [
        f"  of {drawn['n']} castings (seed {drawn['seed']}) "
        + ", ".join(f"{share} % {word}" for share, word in zip(shares, words)),
        f"  acceptable ({first['acceptable_means'].replace('_', ' ')}): {100 * first['acceptable_now']:.0f} % now; "
        "with one group known: "
        + ", ".join(f"{name} {100 * share:.0f} %" for name, share in first["acceptable_if_known"].items())
        + ("" if over is None else f"; for tissues that the data allow {100 * over:.0f} %"),
    ]
    return [*lines, *_in_range(result)]


def _in_range(result: dict[str, Any]) -> list[str]:
    """The share of castings in the steady range, which one subject does not make."""
    if result["verdict"]["subjects"] < 2:
        return ["  one subject makes no range: no share of castings is given"]
    tolerance = result["sensitivity"]
    judged = ", ".join(f"{force:g}" for force in tolerance["judged_at_N"]) or "no force, of 5, 10 and 15"
    return [
        f"  {100 * tolerance['yield_fraction']:.0f} % of castings are in the steady range at {judged} N "
        f"({100 * tolerance['making_only_fraction']:.0f} % once the resin is known); by force: "
        + ", ".join(f"{force} N {100 * share:.0f} %" for force, share in tolerance["by_force"].items()),
    ]


MOST_NOTES = 4
NOTES = {
    "bottoms_out": "{message}",
    "measured_curves": "{message}",
    "tissue_punch": "{message}",
    "force_not_in_band": "{message}",
    "speed_not_in_band": "{message}",
    "calibration_resin": "{message}",
    "out_of_reach": "{message}. Allow a thicker pad (--thickness) or a smaller force.",
    "one_subject": "Only one subject: a range needs at least two ('dummydesign tissues add').",
    "contradictory_points": "{message}",
    "calibration": "{message}",
    "at_edge": "{message}. Widen the range.",
    "outside_steady_range": "{message}.",
    "cad_unavailable": "{message}",
    "curved_master": "Print the curved plug in layers of at most 0.1 mm, or machine it: its height sets the force.",
}
"""Warnings that change what one does, the most pressing first, and their words on the screen."""


def render(result: dict[str, Any]) -> str:
    """Lay the answer out on one screen."""
    verdict = verdict_lines(result["verdict"])
    head = [*verdict, *_basis(result), *_pad(result), *_resin(result), *_valid(result), ""]
    tail = [[""], _correct(result), _why(result), _risk(result), _notes(result), _next(result), _meanwhile(result),
            _files(result), _more(result)]  # fmt: skip
    risk, meanwhile, why = 3, 6, 2
    more = "  ... and {} more presses: --details"
    return "\n".join(fitted(head, _table(result), tail, (risk, meanwhile, why), more))


def _basis(result: dict[str, Any]) -> list[str]:
    """The calibration that was used, where one was."""
    used = result["calibration"]
    if used is None:
        return []
    left = "".join(f"; unexplained: {reason}" for reason in used["unexplained_because"][:1])
    return labelled("USED", used["text"] + left, 4)


def _pad(result: dict[str, Any]) -> list[str]:
    """Shape, thickness, size and base; the shape's lengths in a line of their own."""
    import numpy as np

    from dummydesign.geometry.shape_registry import read_shape

    best, (length, width) = result["recommendation"], result["inputs"]["pad_mm"]
    base = base_words(result["inputs"]["base"])
    name, _, lengths = best["shape"].partition(":")
    thickness = f"{best['thickness_mm']:g} mm"
    if lengths:
        shape = read_shape(best["shape"])
        beside = float(shape.drop_mm(np.array(length / 2), np.array(width / 2)))
        least = best["thickness_mm"] - max(shape.bone_height_mm, beside)
        if not shape.flat_top:
            thickness += f" at the tip, {least:.3g} mm beside it"
        elif shape.bone_height_mm:
            thickness += f", {least:.3g} mm of gel over the bone"
    text = f"{name}, {thickness}, {length:g} x {width:g} mm, {base}"
    if lengths:
        text += f"\n{lengths.replace('=', ' ').replace('_', ' ').replace(',', ', ')} (lengths in mm)"
    if result["sites"]:
        text += f"\n{result['sites']['text']}"
    return labelled("PAD", text, 4)


def _resin(result: dict[str, Any]) -> list[str]:
    """Resin, ratio and modulus, then what to weigh."""
    best = result["recommendation"]
    young = best["young_kPa"]
    meaning = best["ratio_meaning"].replace("isocyanate parts", "isocyanate").removesuffix(" by weight")
    return [
        *labelled("RESIN", f"{best['resin']}, ratio {best['ratio']:g} ({meaning}), "
                           f"{young['value']:.3g} kPa (95 %: {young['low']:.3g} to {young['high']:.3g})"),
        *labelled("WEIGH", "\n".join(batch_lines(best["batch"]))),
    ]  # fmt: skip


def _valid(result: dict[str, Any]) -> list[str]:
    """For which presses the answer holds, and where people's data come from."""
    codes = {item["code"] for item in result["warnings"]}
    given = result["inputs"]
    text = test_line(given)
    if "inferred_tissue" in codes:
        text += f"; {given['tissue']}: inferred, not measured"
    if result["verdict"]["limits"]["origin"] != "built-in":
        text += "; limits of the verdict: your own"
    return labelled("VALID", text, 2)


def _table(result: dict[str, Any]) -> list[str]:
    """One row a press."""
    lines = ["  steady N  mm/s   depth mm  gel used  pad peak N  people N"]
    for row in result["recommendation"]["conditions"]:
        head = f"  {row['steady_force_N']:<9g} {row['velocity_mm_s']:<6g} "
        if row["depth_mm"] is None:
            lines.append(f"{head}out of reach")
            continue
        people = f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}"
        reads = row["reads"] if row["reads"] == "inside" else f"{row['percent_outside']:.0f} % {row['reads']}"
        gel = f"{100 * row['gel_compression']:.0f} %"
        lines.append(f"{head}{row['depth_mm']:<9.2f} {gel:<9} {row['peak_force_N']:<11.1f} {people:<13} {reads}")
    return lines


def _correct(result: dict[str, Any]) -> list[str]:
    """By what readings are multiplied: at central estimates, for 95 % of castings, and after measuring."""
    verdict = result["verdict"]
    factors = verdict["correction"]
    if verdict["light"] == "red" or factors["factor"] is None:
        return []
    forces, energies = (
        [factors[f"{name}{when}"] for when in ("_central", "", "_after_measuring")] for name in ("force", "factor")
    )
    if max(value for value in (*forces, *energies) if value is not None) <= 1.01:
        return labelled("CORRECT", "no correction needed")
    reach = " in reach" if result["castings"]["out_of_reach"] >= 0.005 else ""
    lines = [_factors("readings", energies, reach)]
    if any(e is not None and f is not None and e - f > 0.005 for f, e in zip(forces, energies)):
        lines = [_factors("forces", forces, reach), _factors("energies", energies, None)]
    return labelled("CORRECT", "\n".join(lines))


def _factors(what: str, values: list[float | None], reach: str | None) -> str:
    """Factors of forces or energies: central, for 95 % of castings, and once the resin is measured."""
    central, most, after = values
    text = f"multiply {what} by {max(central or 1.0, 1.0):.2f} (central); {most:.2f} covers 95 %"
    text += "" if reach is None else f" of castings{reach}"
    return text + ("" if after is None or (most or 1.0) - after < 0.005 else f", {max(after, 1.0):.2f} once measured")


def _why(result: dict[str, Any]) -> list[str]:
    """How near each kind comes to the tissue, or why no other was compared."""
    known = [row for row in result["shapes"] if row["shape"] is not None and row["misfit_rms_ln_force"] is not None]
    best = result["recommendation"]
    mine = next((row for row in known if row["shape"] == best["shape"]), None)
    undecided = result["choice"]["expectation"]["undecided"]
    text = f"{undecided}\n" if undecided else ""
    if mine is None or len(known) < 2:
        return labelled("WHY", text + result["choice"]["text"], 2)
    forces = sorted(result["inputs"]["force_N"])
    others = sorted((row for row in known if row is not mine), key=lambda row: row["misfit_rms_ln_force"])
    listed = ", ".join(f"{row['kind']} {row['misfit_rms_ln_force']:.2f}" for row in others)
    text += f"misfit to people {0.1 * forces[0]:g} to {forces[-1]:g} N: {mine['misfit_rms_ln_force']:.2f}; {listed}"
    return labelled("WHY", text, 3)


def _risk(result: dict[str, Any]) -> list[str]:
    slope = abs(100 * result["sensitivity"]["d_ln_young_per_percent_ratio"])
    if slope < 0.5:
        return []
    return labelled("RISK", f"1 % of the ratio changes the modulus by {slope:.0f} %")


def _notes(result: dict[str, Any]) -> list[str]:
    """At most four warnings, each with what to do; an impact comes first."""
    lines = []
    for code in [code for code in NOTES if code in {item["code"] for item in result["warnings"]}][:MOST_NOTES]:
        message = next(item["message"] for item in result["warnings"] if item["code"] == code)
        lines += labelled("WARNING", NOTES[code].format(message=f"{message[0].upper()}{message[1:]}"), 2)
    return [*_impact(result), *lines]


def _impact(result: dict[str, Any]) -> list[str]:
    """What a free mass does on pad and people, where one was requested."""
    pad, known = impact_of(result)
    if not pad or not known:
        return []
    span = f"{min(known):.3g} to {max(known):.3g} N" if len(known) > 1 else f"{known[0]:.3g} N"
    return labelled("IMPACT", f"peak {pad['peak_force_N']:.3g} N at {pad['depth_mm']:.3g} mm on the pad, "
                              f"{span} on people")  # fmt: skip


TYPED_AGAIN = ("aim", "shape", "punch", "edge_radius_mm", "force_N", "velocity_mm_s", "hold_s", "base", "condition",
               "preset", "pad_mm", "thickness_mm", "ratio", "sites")  # fmt: skip
"""Options of the next search beside tissue and resin, in the order in which they are typed."""


def _next(result: dict[str, Any]) -> list[str]:
    """What to do now: measure first, or the step that the answer rests on."""
    first = result["measure_first"]
    if result["verdict"]["light"] == "red":
        return labelled("NEXT", "do not cast this pad: try another resin, shape or thickness, or a smaller force", 2)
    if not first["group"]:
        return labelled("NEXT", result["rests_on"]["next_step"], 3)
    steps = [first["text"], first["protocol"].partition("; this")[0], first["command"]]
    if first["group"] in ("modulus", "relaxation"):
        name = first["command"].partition("--name ")[2].split()[0]
        given = dict(result["inputs"])
        if given["condition"] == "bonded":
            given["condition"] = None
        asked = command_words(SuggestOptions, given, TYPED_AGAIN)
        steps.append(f"dummydesign suggest --tissue {given['tissue']}{asked} --resin {name}")
    return labelled("NEXT", "\n".join(f"{number}. {step}" for number, step in enumerate(steps, 1)), 8)


def _meanwhile(result: dict[str, Any]) -> list[str]:
    """Two ratios to pour before anything is measured, where they help."""
    first = result["measure_first"]
    if result["verdict"]["light"] == "red" or not first["ratios"]:
        return []
    if first["either_fraction"] - max(first["each_fraction"]) < 0.03:
        return []
    low, high = first["ratios"]
    words = "usable" if first["acceptable_means"] == "usable" else "right uncorrected"
    share = 100 * first["either_fraction"]
    text = f"or pour at ratios {low:g} and {high:g}: at least one is {words} with {share:.0f} % probability"
    return labelled("", text)


def _files(result: dict[str, Any]) -> list[str]:
    """The folder, and which file to begin with."""
    from pathlib import Path

    files = result["files"]
    if not files:
        return []
    named = {"pour_sheet_a4": "{} (start here)", "mould": "{}", "report": "{}"}
    shown = [words.format(Path(files[role]).name) for role, words in named.items() if role in files]
    folder = Path(next(iter(files.values()))).parent
    return labelled("FILES", f"{folder}/: {', '.join(shown)}, {len(files) - len(shown)} more", 2)


def _more(result: dict[str, Any]) -> list[str]:
    count = len(result["warnings"])
    return labelled("MORE", f"--details: scores, other shapes, parameters, castings, {count} notes")
