"""``dummydesign suggest``: recipe, pad and mould for a tissue, and the answer as text: one screen, or all of it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from dummydesign.cli import text
from dummydesign.cli.common_options import add_options, call_in_steps, named_by
from dummydesign.cli.text import file_lines, fitted, labelled, tissue_lines, verdict_lines
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.tables import Table

ABOUT_STEPS = 8
CALL = "designs.suggest"
HELP = "Recommend resin ratio, pad thickness, weights to pour and a mould for a tissue."
default_out = named_by("suggest", "tissue")
OWN_TEST = (
    "punch edge_radius_mm condition force_N velocity_mm_s hold_s deceleration_mm_s2 pad base sites preset".split()
)
"""How people and pad are pressed, and what the mould must fit."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be asked."""
    add_options(parser, CALL, OWN_TEST)
    test = parser.add_argument_group("your own test", "numbers may carry their unit: 0.25m/s, 10mm/s")
    add_options(test, CALL)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Find the design, make its mould, write the report and return the answer."""
    named = None if options.calibration == "none" else options.calibration
    answer = call_in_steps(ABOUT_STEPS, CALL, options, calibration=named)
    result = answer.to_dict()
    if not answer.outcome.verdict.acceptable:
        message = "no acceptable pad: the verdict on the best one found is red"
        if options.cad:
            message += f"; no mould was made of it, which '{answer.outcome.mould_command}' makes"
        raise NoAnswerError("no_acceptable_pad", message, result, "verdict")
    return result


SMALL = {"N": "force_N:<6g", "depth mm": "depth_mm:<10.2f", "tissue mm": "span:<1"}
PRESSES = (
    "steady N",
    "mm/s",
    "depth mm",
    "depth/thickness",
    "% of gel",
    "peak N",
    "tissue peak N",
    "fraction in range",
    "reads",
)
OTHERS = {
    "mm": "thickness_mm:<6g",
    "ratio": "ratio:<7g",
    "kPa": "young:<7.3g",
    "total": "total:<6.2f",
    "steady": "steady_state_range:<7.2f",
    "force-time": "force_variation_range:<11.2f",
    "aim": "aim:<5.2f",
    "below 5 N": "low_force_range:<1.2f",
}


def _press(row: dict[str, Any]) -> list[Any]:
    """A press of the pad with the subjects' range, or why it is out of reach."""
    from dummydesign.report import suggest_facts as facts

    asked = [row["steady_force_N"], row["velocity_mm_s"]]
    if row["depth_mm"] is None:
        return [*asked, row["out_of_reach"]]
    solved = [row[name] for name in ("depth_mm", "depth_over_thickness", "gel_compression", "peak_force_N")]
    return [*asked, *solved, facts.press_texts(row)[0], row["inside_fraction"], row["reads"]]


def render_details(result: dict[str, Any]) -> str:
    """Lay all of the answer out as tables."""
    from dummydesign.report import suggest_facts as facts

    best = result["recommendation"]
    young = best["young_kPa"]
    lines = [
        *verdict_lines(result["verdict"]),
        *tissue_lines(result),
        *_calibration(result),
        f"why this pad: {result['choice']['text']}",
        "",
        f"{result['inputs']['tissue']}, aim {result['inputs']['aim']}",
        "",
        f"  pad        {_pad_details(result)}",
        *([f"  sites      {result['sites']['text']}"] if result["sites"] else []),
        f"  test       {facts.test_text(result['inputs'])}",
        f"  resin      {best['resin']}, ratio {best['ratio']:g} ({best['ratio_meaning']})",
        *(f"  weigh      {line}" for line in facts.batch_lines(best["batch"])),
        f"  modulus    {young['value']:.3g} kPa long-term (95 %: {young['low']:.3g} to {young['high']:.3g})",
        "",
        "scores, 0 to 1 (more is better):",
        "  "
        + "   ".join(
            f"{name.replace('_', ' ')} {'none' if value is None else format(value, '.2f')}"
            for name, value in best["scores"].items()
        ),
        "",
        *Table(PRESSES, [_press(row) for row in best["conditions"]]).lines(
            "<9g <6g <9.2f <16.2f <9.2f <8.1f <15 <18.2f <1".split()
        ),
    ]
    no_law = any(item["code"] == text.NO_LAW for item in result["warnings"])
    words = (
        "the people's slowest rise, scaled to their steady force"
        if no_law
        else ("the tissue's law; extrapolated where nobody was pressed so lightly")
    )
    small = [
        {**row, "span": f"{row['tissue_depth_low_mm']:.2f} to {row['tissue_depth_high_mm']:.2f}"}
        for row in best["low_force"]
    ]
    lines += ["", *facts.people_lines(result["people"])]
    lines += ["", f"  small forces ({words}):", *Table.of(small, SMALL).lines()]
    lines += _shapes(result) + _parameters(best) + _more_details(result)
    return "\n".join(lines)


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
    words = [
        "",
        f"  shapes side by side (misfit: rms of ln F from {0.1 * low:g} to {high:g} N; range: fraction of the steady "
        f"curve in range;\n  exponent d ln F / d ln x, tissue {result['tissue_exponent']:.3g}):",
    ]
    ranges, exponent = (f"range <{low:g} N", f"range >{low:g} N"), f"exponent {'/'.join(shown)} N"
    rows = [
        [f"{row['kind']}: {row['reason']}"]
        if row["shape"] is None
        else [
            *(row[name] for name in ("misfit_rms_ln_force", "share_below_5N", "share_above_5N")),
            " / ".join("-" if (one := row["exponent_at_N"][force]) is None else f"{one:.1f}" for force in shown),
            row["depth_over_thickness"],
            row["total"],
            f"{row['thickness_mm']:g} mm {row['shape']}, ratio {row['ratio']:g}",
        ]
        for row in result["shapes"]
    ]
    table = Table(["misfit", *ranges, exponent, "d/h", "total", "pad"], rows)
    return [*words, *table.lines("<7.2f <11.2f <11.2f <18 <6.2f <6.2f <1".split()), *_passed_over(result)]


def _passed_over(result: dict[str, Any]) -> list[str]:
    """The pad with the best score where it was passed over because it is red."""
    known = [row for row in result["shapes"] if row["shape"] is not None]
    nearest = max(known, key=lambda row: row["total"], default=None)
    if nearest is None or nearest["acceptable"] or nearest["shape"] == result["recommendation"]["shape"]:
        return []
    return [
        f"  the {nearest['kind']} pad scores higher (total {nearest['total']:.2f}) and is red; "
        f"--shape {nearest['kind']} gives it",
    ]


def _forces(result: dict[str, Any]) -> tuple[float, float, tuple[str, str, str]]:
    """Lowest and highest force of the test, and the keys of three exponents: below, lowest and highest."""
    forces = sorted(result["inputs"]["force_N"])
    return forces[0], forces[-1], (f"{0.2 * forces[0]:g}", f"{forces[0]:g}", f"{forces[-1]:g}")


def _pad_details(result: dict[str, Any]) -> str:
    from dummydesign.design.request import base_words

    best, given = result["recommendation"], result["inputs"]
    length, width = given["pad_mm"]
    return f"{best['thickness_mm']:g} mm thick, {length:g} x {width:g} mm {best['shape']}, {base_words(given['base'])}"


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
    from dummydesign.report.sections import budget_lines

    others = [{**other, **other["scores"], "young": other["young_kPa"]["value"]} for other in result["alternatives"]]
    lines = ["", "alternatives:", *Table.of(others, OTHERS).lines()] if others else []
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
            f"{checked['max_difference_percent']:.2f} % from the stored solutions"
        )
    lines += ["", *budget_lines(result["budget"]), "", result["rests_on"]["text"]]
    return lines + file_lines(result) + text.warning_lines(result)


def _castings(result: dict[str, Any]) -> list[str]:
    """The castings by class, and their share in the steady range."""
    from dummydesign.design.scoring.verdict import OUTCOMES, whole_percents

    drawn, names = result["shares"]["as_poured"], ("stands_for", "with_correction", *OUTCOMES)
    shares = whole_percents([drawn[name] for name in names])
    words = ["need no correction", "are usable with one", *(OUTCOMES[name] for name in OUTCOMES)]
    return [
        f"  of {drawn['n']} castings (seed {drawn['seed']}) "
        + ", ".join(f"{share} % {word}" for share, word in zip(shares, words)),
        *_in_range(result),
    ]


def _in_range(result: dict[str, Any]) -> list[str]:
    """The share of castings in the steady range, which one subject does not make."""
    if result["verdict"]["subjects"] < 2:
        return ["  one subject makes no range: no share of castings is given"]
    tolerance = result["sensitivity"]
    judged = (
        ", ".join(f"{force:g}" for force in tolerance["judged_at_N"])
        or f"no force, of {', '.join(tolerance['by_force'])}"
    )
    return [
        f"  {100 * tolerance['yield_fraction']:.0f} % of castings are in the steady range at {judged} N "
        f"({100 * tolerance['making_only_fraction']:.0f} % of an average batch); by force: "
        + ", ".join(f"{force} N {100 * share:.0f} %" for force, share in tolerance["by_force"].items()),
    ]


def render(result: dict[str, Any]) -> str:
    """Lay the answer out on one screen."""
    from dummydesign.report import suggest_facts as facts
    from dummydesign.report.sections import curves_text

    best = result["recommendation"]
    resin = f"{best['resin']}, ratio {best['ratio']:g} ({facts.ratio_meaning(best)}), {facts.modulus_text(best)}"
    puck_first = result["verdict"]["level"] == "not_settled"
    head = [
        *verdict_lines(result["verdict"]),
        *labelled("USED", facts.calibration_text(result), 4),
        *labelled("PAD", facts.pad_text(result), 4),
        *labelled("RESIN", resin),
        # before the puck the ratio of the pad is not settled
        *labelled("WEIGH", "" if puck_first else "\n".join(facts.batch_lines(best["batch"]))),
        *labelled("VALID", facts.valid_text(result), 2),
        "",
    ]
    more = f"--details: scores, other shapes, parameters, castings, {len(result['warnings'])} notes"
    tail = [
        labelled("PEOPLE", facts.people_text(result["people"]), 2),
        labelled("CURVES", curves_text(result["curves"], result["verdict"]["subjects"]), 2),
        labelled("SHARES", "\n".join(facts.castings_lines(result))),
        labelled("MOULD", result["other_mould"]["text"] if result["other_mould"] else ""),
        labelled("CORRECT", "\n".join(facts.correction_lines(result))),
        labelled("WHY", facts.why_text(result), 3),
        labelled("RISK", facts.risk_text(result)),
        [line for note in facts.warning_texts(result) for line in labelled("WARNING", note, 2)],
        text.step_lines(facts.next_steps(result), 2 if result["verdict"]["light"] == "red" else 3, 8),
        labelled("PATHS", "\n".join(facts.paths_lines(result))),
        _files(result),
        labelled("MORE", more),
    ]
    presses = facts.press_rows(result).lines("<8 <5 <8 <8 <10 <12 <1".split(), "  ")
    return "\n".join(fitted(head, presses, tail, (6, 5), "  ... and {} more presses: --details"))


def _files(result: dict[str, Any]) -> list[str]:
    """The folder, and which file to begin with."""
    files = result["files"]
    if not files:
        return []
    start = "after the puck" if result["verdict"]["level"] == "not_settled" else "start here"
    named = {"pour_sheet": f"{{}} ({start})", "mould": "{}", "report": "{}", "first_page": "{}"}
    shown = [words.format(Path(files[role]).name) for role, words in named.items() if role in files]
    folder = Path(next(iter(files.values()))).parent
    return labelled("FILES", f"{folder}/: {', '.join(shown)}, {len(files) - len(shown)} more", 2)
