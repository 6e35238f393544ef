"""What a suggestion's answer states on one screen and on its report's first page: pad, recipe, correction, steps.

Every text is made of the answer's values; terminal and report only lay it out.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from dummydesign.core.tables import Table
from dummydesign.design.request import base_words
from dummydesign.tissue.model.people_share import is_strict

MOST_NOTES = 4
NOTES = (
    "people_bound",
    "measured_curves",
    "law_does_not_follow",
    "tissue_punch",
    "force_not_in_band",
    "speed_not_in_band",
    "calibration_resin",
    "out_of_reach",
    "one_subject",
    "contradictory_points",
    "calibration",
    "at_edge",
    "outside_steady_range",
    "cad_unavailable",
    "curved_master",
)
"""Warnings that change what one does, the most pressing first."""
NOTE_WORDS = {
    "out_of_reach": "{message}. Allow a thicker pad (--thickness) or a smaller force.",
    "one_subject": "Only one subject: a range needs at least two ('dummydesign tissues add').",
    "at_edge": "{message}.",
    "outside_steady_range": "{message}.",
    "curved_master": "Print the curved plug in layers of at most 0.1 mm, or machine it: its height sets the force.",
}
"""Words of a warning on the screen, where they are not its message."""


WIDEST = 90.0
"""Interval of the share of people, in per cent, from which on the share is called unknown."""
PARTS = {"crowned": "crown", "boned": "bone", "layered": "layers"}
"""What the lengths of a shape measure."""


def calibration_text(result: dict[str, Any]) -> str:
    """The calibration that was used and the first thing that it leaves unexplained; empty without one."""
    used = result["calibration"]
    if used is None:
        return ""
    return used["text"] + "".join(f"; unexplained: {reason}" for reason in used["unexplained_because"][:1])


def pad_text(result: dict[str, Any]) -> str:
    """Shape, thickness, size and base; the shape's lengths and its sites in lines of their own."""
    import numpy as np

    from dummydesign.geometry.shape_registry import read_shape

    best, (length, width) = result["recommendation"], result["inputs"]["pad_mm"]
    base = base_words(result["inputs"]["base"])
    name, _, lengths = best["shape"].partition(":")
    thickness = f"{best['thickness_mm']:g} mm"
    if lengths:
        shape = read_shape(best["shape"])
        drop = float(shape.drop_mm(np.array(length / 2), np.array(width / 2)))
        least = best["thickness_mm"] - max(shape.bone_height_mm, drop)
        if not shape.flat_top:
            thickness += f" at the tip, {least:.3g} mm beside it"
        elif shape.bone_height_mm:
            thickness += f", {least:.3g} mm of gel over the bone"
    text = f"{name}, {thickness}, {length:g} x {width:g} mm, {base}"
    if lengths:
        in_mm = {one.name.removesuffix("_mm") for one in fields(shape) if one.name.endswith("_mm")}
        given = (part.partition("=") for part in lengths.split(","))
        words = (f"{key.replace('_', ' ')} {value}{' mm' if key in in_mm else ''}" for key, _, value in given)
        text += f"\n{PARTS.get(name, name)}: {', '.join(words)}"
    return text + (f"\n{result['sites']['text']}" if result["sites"] else "")


def ratio_meaning(best: dict[str, Any]) -> str:
    """What the ratio counts, in few words."""
    return best["ratio_meaning"].replace("isocyanate parts", "isocyanate").removesuffix(" by weight")


def ratio_by_words(best: dict[str, Any]) -> str:
    """What the ratio counts, and that it is by weight where it is not by volume."""
    return ratio_meaning(best) if "by volume" in best["ratio_meaning"] else f"{ratio_meaning(best)}, by weight"


def modulus_text(best: dict[str, Any]) -> str:
    """Long-term modulus with its interval."""
    young = best["young_kPa"]
    return f"{young['value']:.3g} kPa (95 %: {young['low']:.3g} to {young['high']:.3g})"


def batch_lines(batch: dict[str, Any]) -> list[str]:
    """What to mix and how much of it to pour; of a layered pad both pours, and what a puck takes besides."""
    lines = []
    for name, one in (("", batch), *((("base: ", batch["base"]),) if "base" in batch else ())):
        weigh = " + ".join(f"{item['name']} {item['mass_g']:.1f} g" for item in one["components"])
        lines.append(f"{name}{weigh} = {one['total_g']:.1f} g; pour {one['pour_g']:.1f} g of it")
    if batch["witness"]["total_g"] > batch["total_g"]:
        lines[0] += f" (mix {batch['witness']['total_g']:.1f} g with a puck)"
    return lines


def test_text(given: dict[str, Any]) -> str:
    """The presses for which the answer holds."""
    forces, speeds = (sorted(given[name]) for name in ("force_N", "velocity_mm_s"))
    span = f"{forces[0]:g} to {forces[-1]:g} N" if len(forces) > 1 else f"{forces[0]:g} N"
    edge = f", edge radius {given['edge_radius_mm']:g} mm" if given["edge_radius_mm"] else ""
    face = "" if given["condition"] == "bonded" else f", {given['condition']}"
    hold = "" if given["hold_s"] == 10.0 else f", held {given['hold_s']:g} s"
    return f"{punch_text(given['punch'])}{edge}{face}, {span}, {' and '.join(f'{v:g}' for v in speeds)} mm/s{hold}"


def punch_text(punch: str) -> str:
    """The punch and its size."""
    kind, _, size = punch.partition(":")
    if kind == "profile":
        return f"punch of profile {size}"
    return f"{size} x {size} mm punch" if kind == "square" else f"{kind} punch {size} mm"


def valid_text(result: dict[str, Any]) -> str:
    """For which presses the answer holds, and where people's data come from."""
    given, text = result["inputs"], test_text(result["inputs"])
    if "inferred_tissue" in {item["code"] for item in result["warnings"]}:
        text += f"; {given['tissue']}: inferred, not measured"
    return text + ("; limits of the verdict: your own" if result["verdict"]["limits"]["origin"] != "built-in" else "")


def press_rows(result: dict[str, Any]) -> Table:
    """The table of presses; a row of a press out of reach ends after its test."""
    rows = [
        [
            f"{row['steady_force_N']:g}",
            f"{row['velocity_mm_s']:g}",
            *(
                ["out of reach"]
                if row["depth_mm"] is None
                else [
                    f"{row['depth_mm']:.2f}",
                    f"{100 * row['gel_compression']:.0f} %",
                    f"{row['peak_force_N']:.1f}",
                    *press_texts(row),
                ]
            ),
        ]
        for row in result["recommendation"]["conditions"]
    ]
    head = ["steady N", "mm/s", "depth mm", "% of gel", "pad peak N", "subjects N", ""]
    outside = frozenset(number for number, cells in enumerate(rows) if cells[-1] != "inside")
    return Table(head, rows, marked=outside)


def press_texts(row: dict[str, Any]) -> tuple[str, str]:
    """The subjects' peaks in a press, and how the pad reads beside them; nothing out of reach."""
    people, reads = f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}", row["reads"] or ""
    return people, reads if reads in ("", "inside") else f"{row['percent_outside']:.0f} % {reads}"


def people_text(people: dict[str, Any]) -> str:
    """The share of all people below the pad's peak, in the press where it is least; empty where it is not known."""
    known = [row for row in people["conditions"] if row["below_expected"] is not None]
    if not known:
        return ""
    row = min(known, key=lambda one: one["below_expected"])
    low, high = (100 * share for share in row["below_90"])
    subjects = f"{people['subjects']} subjects{', inferred, not measured' if people['inferred'] else ''}"
    press = f"{row['steady_force_N']:.3g} N, {row['velocity_mm_s']:g} mm/s"
    if high - low > WIDEST:
        return (
            f"{people['subjects']} subjects do not show which share of people lies below the pad's peak "
            f"(90 %: {low:.0f} to {high:.0f} %)"
        )
    span = f"90 %: {' to '.join(dict.fromkeys(map(_rounded, (low, high))))} %"
    return (
        f"{subjects}: the pad's peak is above {_rounded(100 * row['below_expected'])} % of people at {press} ({span})"
    )


def _rounded(percent: float) -> str:
    """A share of people that few subjects do not show to be none or all."""
    return "below 1" if percent < 1.0 else "above 99" if percent > 99.0 else f"{percent:.0f}"


def people_lines(people: dict[str, Any]) -> list[str]:
    """The share of all people below the pad's peak in every press, for the detailed answer."""
    rows = [row for row in people["conditions"] if row["below_expected"] is not None]
    head = [f"share of people whose peak is at most the pad's, by {people['subjects']} subjects (90 % interval):"]
    return (head if rows else []) + [
        "  {:g} N, {:g} mm/s: {} % ({} to {} %)".format(
            float(f"{row['steady_force_N']:.3g}"),
            row["velocity_mm_s"],
            *(_rounded(100 * share) for share in (row["below_expected"], *row["below_90"])),
        )
        for row in rows
    ]


def correction_lines(result: dict[str, Any]) -> list[str]:
    """By what readings are multiplied: at central estimates, for 95 % of castings, and after one puck of each batch."""
    factors, puck = result["verdict"]["correction"], result["shares"]["after_puck"]
    if result["verdict"]["light"] == "red" or factors["factor"] is None:
        return []
    forces = [factors["force_central"], factors["force"], puck["force_factor"]]
    energies = [factors["factor_central"], factors["factor"], puck["factor"]]
    if max(value for value in (*forces, *energies) if value is not None) <= 1.01:
        return ["multiply readings by 1.00: they are not low"]
    if result["batch_measured"]:
        forces[2] = energies[2] = None
    elif result["verdict"]["level"] == "not_settled":
        both = (("forces", forces[2]), ("energies", energies[2]))
        after = " and ".join(f"{what} by {value:.2f}" for what, value in both if value is not None)
        return [f"after the puck multiply {after} for 95 % of castings{_in_reach(puck)}"] if after else []
    reach = _in_reach(result["shares"]["as_poured"])
    if any(e is not None and f is not None and e - f > 0.005 for f, e in zip(forces, energies)):
        return [_factors("forces", forces, reach), _factors("energies", energies, None)]
    return [_factors("readings", energies, reach)]


def _in_reach(shares: dict[str, Any]) -> str:
    """Whether some castings miss a press: no factor helps them."""
    return " in reach" if shares["out_of_reach"] >= 0.005 else ""


def _factors(what: str, values: list[float | None], reach: str | None) -> str:
    """Factors of forces or energies: for 95 % of castings, at central estimates, and after one puck."""
    central, most, after = values
    text = f"multiply {what} by {most:.2f} for 95 %" + ("" if reach is None else f" of castings{reach}")
    later = "" if after is None or (most or 1.0) - after < 0.005 else f"; after one puck {after:.2f}"
    return f"{text} (nominal {max(central or 1.0, 1.0):.2f}{later})"


def castings_lines(result: dict[str, Any]) -> list[str]:
    """Castings that are usable as poured, of an average batch and after one puck, and the window of moduli."""
    shares, strict = result["shares"], is_strict(result["inputs"]["aim"])
    good = {name: share["usable"] for name, share in shares.items()}
    after = shares["after_puck"]
    words = "on the safe side" if strict else "usable"
    line = f"{_percent(good['as_poured'])} {words} as poured"
    if not result["batch_measured"]:
        line += f", {_percent(good['resin_known'])} of an average batch, {_percent(good['after_puck'])} after one puck"
        line += f" ({_percent(after['no_ratio'])} never)" if after["no_ratio"] >= 0.005 else ""
    lines = [line]
    window, young = result["window_kPa"], result["recommendation"]["young_kPa"]
    if window is not None:
        # on the safe side a stiffer pad only reads higher
        end = "" if strict else f" to {window[1]:.3g}"
        lines.append(
            f"{words} from {window[0]:.3g}{end} kPa; batches of this ratio: "
            f"{young['low']:.3g} to {young['high']:.3g} kPa (95 %)"
        )
    return lines


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"


def why_text(result: dict[str, Any]) -> str:
    """How near each kind comes to the tissue; what decided where another comes nearer, or none was compared."""
    name = "misfit_rms_ln_force"
    known = [row for row in result["shapes"] if row["shape"] is not None and row[name] is not None]
    known.sort(key=lambda row: row[name])
    if len(known) < 2 or known[0]["shape"] != result["recommendation"]["shape"]:
        return str(result["choice"]["text"])
    forces = sorted(result["inputs"]["force_N"])
    listed = ", ".join(f"{row['kind']} {row[name]:.2f}" for row in known[1:])
    fit = f"{known[0][name]:.2f} ({listed})"
    return f"misfit to the subjects, {0.1 * forces[0]:g} to {forces[-1]:g} N: {fit}"


def risk_text(result: dict[str, Any]) -> str:
    """How steeply the modulus follows the ratio; empty where it hardly does."""
    slope = abs(100 * result["sensitivity"]["d_ln_young_per_percent_ratio"])
    return "" if slope < 0.5 else f"1 % of the ratio changes the modulus by {slope:.0f} %"


def warning_texts(result: dict[str, Any]) -> list[str]:
    """At most four warnings, each with what to do."""
    messages = {item["code"]: item["message"] for item in reversed(result["warnings"])}
    shown = [code for code in NOTES if code in messages][:MOST_NOTES]
    texts = {code: f"{messages[code][0].upper()}{messages[code][1:]}" for code in shown}
    return [NOTE_WORDS.get(code, "{message}").format(message=text) for code, text in texts.items()]


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do now, a step each: what to type, else what to do."""
    return [step["command"] or step["do"] for step in result["next"]]


def paths_lines(result: dict[str, Any]) -> list[str]:
    """The ways to a pad that can be used, where a puck comes first."""
    if result["verdict"]["level"] != "not_settled" or result["batch_measured"]:
        return []
    return ["; ".join(path["text"] for path in result["paths"])]
