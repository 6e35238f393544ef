"""The answer of ``dummydesign suggest`` on one screen; ``--details`` prints everything."""

from __future__ import annotations

from typing import Any

from dummydesign.cli.texts.screen import fitted, labelled
from dummydesign.cli.texts.suggested_details import batch_lines, test_line
from dummydesign.cli.texts.verdict import impact_of, verdict_lines

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

    from dummydesign.geometry.shapes import read_shape

    best, (length, width) = result["recommendation"], result["inputs"]["pad_mm"]
    base = {"bonded": "glued to a rigid base", "sliding": "sliding on a rigid base"}.get(
        result["inputs"]["base"], f"resting, {result['inputs']['base']}"
    )
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
    """What a free mass does on pad and people, where one was asked for."""
    pad, known = impact_of(result)
    if not pad or not known:
        return []
    span = f"{min(known):.3g} to {max(known):.3g} N" if len(known) > 1 else f"{known[0]:.3g} N"
    return labelled("IMPACT", f"peak {pad['peak_force_N']:.3g} N at {pad['depth_mm']:.3g} mm on the pad, "
                              f"{span} on people")  # fmt: skip


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
        given = result["inputs"]
        steps.append(f"dummydesign suggest --tissue {given['tissue']}{_asked(given)} --resin {name}")
    return labelled("NEXT", "\n".join(f"{number}. {step}" for number, step in enumerate(steps, 1)), 8)


ASKED = {
    "aim": ("--aim", "average"), "shape": ("--shape", "auto"), "punch": ("--punch", "square:14"),
    "edge_radius_mm": ("--edge-radius", 0.0), "force_N": ("--force", [5.0, 10.0, 15.0]),
    "velocity_mm_s": ("--velocity", [10.0, 250.0]), "hold_s": ("--hold", 10.0), "base": ("--base", "bonded"),
    "condition": ("--condition", "bonded"), "preset": ("--preset", "open"), "pad_mm": ("--pad", [150.0, 120.0]),
    "thickness_mm": ("--thickness", None), "ratio": ("--ratio", None), "sites": ("--sites", None),
}  # fmt: skip
PARTED = {"pad_mm": "x", "sites": "x", "thickness_mm": ":", "ratio": ":"}


def _asked(given: dict[str, Any]) -> str:
    """What was asked for beside tissue and resin, as it is typed."""
    words = ""
    for key, (option, usual) in ASKED.items():
        value = given[key]
        value = list(value) if isinstance(value, tuple) else value
        if value is None or value == usual:
            continue
        if isinstance(value, list):
            value = PARTED.get(key, ",").join(f"{one:g}" for one in value)
        words += f" {option} {value:g}" if isinstance(value, float) else f" {option} {value}"
    return words


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
