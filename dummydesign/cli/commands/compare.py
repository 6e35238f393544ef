"""``dummydesign compare``: is a measured dummy inside the tissue's ranges?"""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli import text
from dummydesign.cli.common_options import add_options, named_by
from dummydesign.cli.text import file_lines, labelled, tissue_lines, verdict_lines, warning_lines
from dummydesign.core.tables import Table

HELP = "Compare the traces of a cast dummy with a tissue: parameters, steady-state range, force variation range."
CALL = "traces.compare"
default_out = named_by("compare", "tissue")

OWN_TEST = "punch edge_radius_mm condition force_N velocity_mm_s hold_s deceleration_mm_s2".split()
"""How the presses are chosen and judged."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add_options(parser, CALL, OWN_TEST)
    words = "as in 'suggest'; without them every press is used as measured. Numbers may carry a unit"
    test = parser.add_argument_group("your own test", words)
    add_options(test, CALL)


ABOUT_STEPS = 13
"""Steps of a usual comparison: those of the fit, and the tissue's ranges."""


def render(result: dict[str, Any]) -> str:
    """The verdict, each press beside the subjects' range, then which parameters lie outside."""
    from dummydesign.report import compare as facts
    from dummydesign.report.sections import curves_text
    from dummydesign.report.suggest_facts import people_text

    tissue = f"{result['tissue']}, {facts.law_text(result)}"
    head = [*verdict_lines(result["verdict"]), *tissue_lines(result), *labelled("TISSUE", tissue)]
    rows = facts.press_rows(result).lines("<8 <5 <8 <10 <14 <1".split(), "  ")
    steady = f"fraction inside the subjects' range: {facts.steady_text(result)}"
    return text.screen(
        [*head, *labelled("PAD", facts.pad_text(result)), ""],
        rows,
        ["", *labelled("PEOPLE", people_text(result["people"]), 2)],
        labelled("STEADY", steady),
        labelled("CURVES", curves_text(result["curves"], result["verdict"]["subjects"]), 2),
        labelled("LAW", facts.parameters_text(result), 2),
        text.warning_block(result),
        text.step_lines(facts.next_steps(result), 2, 5),
        text.files_block(result, ("report", "first_page", "picture")),
        labelled("MORE", "--details: parameters of the law with their intervals"),
    )


PARAMETERS = {
    "parameter": "name:<22",
    "dummy": "value:>10.4g",
    "95 % low": "low:>10.4g",
    "95 % high": "high:>10.4g",
    "band low": "band_low:>10.4g",
    "band high": "band_high:>10.4g",
    "": "position:<1",
}
POSITIONS = {True: " inside", False: " outside", None: " no band"}
PRESSES = {
    "mm/s": "velocity_mm_s:>6.4g",
    "steady N": "steady_force_N:>9.3f",
    "depth mm": "depth_mm:>9.3f",
    "peak N": "peak_force_N:>8.3f",
    "range of peak N": "span:>17",
    "inside": "inside:>7",
}


def render_details(result: dict[str, Any]) -> str:
    """Make the readable tables."""
    from dummydesign.report import compare as facts
    from dummydesign.report.sections import budget_lines, curves_text
    from dummydesign.report.suggest_facts import people_lines

    against = f"against {result['tissue']}, {facts.law_text(result)}"
    lines = [*verdict_lines(result["verdict"]), *tissue_lines(result), against]
    if "pad" in result:
        lines.append(f"pad of {facts.pad_text(result)}")
    if result["parametric"]:
        rows = [
            {**row, "name": name, "position": POSITIONS[row["inside"]]} for name, row in result["parametric"].items()
        ]
        lines += Table.of(rows, PARAMETERS).lines(indent="")
    steady = result["steady_state_range"]
    lines.append("steady-state curve, fraction in range of the force reached:")
    low, high = steady["span_N"]
    spans = (f"{0.1 * low:g} to {low:g} N", "below_5N_fraction"), (f"{low:g} to {high:g} N", "above_5N_fraction")
    for label, key in spans:
        share = steady[key]
        lines.append(f"  {label:<11} {'not reached' if share is None else f'{100 * share:.0f} %'}")
    presses = [
        {
            **row,
            "span": f"{row['range_peak_low_N']:.2f} to {row['range_peak_high_N']:.2f}",
            "inside": f"{100 * row['inside_fraction']:.0f} %",
        }
        for row in result["force_variation_range"]
    ]
    lines += Table.of(presses, PRESSES).lines(indent="")
    lines.append(f"curves over time: {curves_text(result['curves'], result['verdict']['subjects'])}")
    lines += budget_lines(result["budget"])
    lines += people_lines(result["people"])
    return "\n".join(lines + warning_lines(result) + file_lines(result))
