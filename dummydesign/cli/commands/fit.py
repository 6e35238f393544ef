"""``dummydesign fit``: fit the tissue law to traces."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_replace_option, call_in_steps
from dummydesign.cli.text import file_lines, files_block, labelled, screen, warning_block, warning_lines

HELP = "Fit the nonlinear 3, 5 or 7 element law to traces of one tissue or dummy."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("traces", nargs="+", metavar="TRACE.csv", help="time_s,displacement_mm,force_N")
    add = parser.add_argument
    add("--elements", default="auto", metavar="3|5|7|auto",
        help="auto (default): chosen by AICc, or fewer if these predict left-out presses better")  # fmt: skip
    add("--law", default="ode", metavar="published|consistent|ode",
        help="ode (default): the law along the measured motion; published, consistent: closed forms of an ideal "
        "ramp and hold, as printed and as they follow from the law")  # fmt: skip
    add("--mode", default="auto", metavar="joint|per-speed|per-condition",
        help="joint: one set of parameters for all presses; per-speed: springs shared, dampers of their own for each "
        "speed, as the paper reports them; per-condition: every speed and depth by itself, then the mean, without "
        "intervals; default auto: per-speed when speeds differ, else joint")  # fmt: skip
    add("--contact", default="none", metavar="none|per-press",
        help="per-press: fit where each press touched, as an offset of its zero; for presses whose contact is "
        "late or early (fit proposes it when that explains the residual)")  # fmt: skip
    parser.add_argument("--lowpass", metavar="HZ[:ORDER[:PASSES]]", help="filter the force went through")
    parser.add_argument("--out", metavar="tissue.toml", help="write a tissue file; residuals and report beside it")
    add_replace_option(parser)


ABOUT_STEPS = 12
"""Steps of a usual fit: three numbers of elements, presses left out, seven intervals, the contact."""


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read the traces, fit, and write the requested files."""
    from dummydesign.api.traces import fit

    return call_in_steps(ABOUT_STEPS, fit, options, out=options.out or None).to_dict()


def render(result: dict[str, Any]) -> str:
    """How well the law fits, its parameters, and the presses with the largest residuals."""
    from dummydesign.core.serialise import parameter_rows

    rows = sorted(result["by_trace"], key=lambda row: -row["rmse_N"])
    worst = rows[0]
    count = f"{len(rows)} press{'es' * (len(rows) != 1)}"
    head = labelled("FIT", f"{result['elements']} elements (law {result['law']}, mode {result['mode']}): residual "
                           f"{result['rmse_N']:.3g} N rms, noise alone {result['noise_floor_N']:.3g} N. {count}; "
                           f"the worst is {worst['file']} with {worst['rmse_N']:.3g} N rms.")  # fmt: skip
    table = [f"  {'parameter':<28} {'value':>10} {'95 % low':>10} {'95 % high':>10}"]
    for label, one in parameter_rows(result["parameters"]):
        low, high = (f"{one[end]:.4g}" if one[end] is not None else "-" for end in ("low", "high"))
        state = "  at its bound" if one["at_bound"] else ""
        table.append(f"  {label:<28} {one['value']:>10.4g} {low:>10} {high:>10}{state}")
    left = {number: row["heldout_rmse_N"] for number, row in result["comparison"].items()}
    rivals = "; ".join(f"{number} elements {error:.3g} N" for number, error in left.items() if error is not None)
    return screen(
        [*head, ""], table, [""], labelled("RIVALS", f"error on presses left out: {rivals}" if rivals else ""),
        warning_block(result), files_block(result, ("tissue", "report")),
        labelled("MORE", "--details: residual of every press, other numbers of elements"),
    )  # fmt: skip


def render_details(result: dict[str, Any]) -> str:
    """Make the readable tables."""
    from dummydesign.core.serialise import parameter_rows

    lines = [
        f"{result['elements']} elements, law {result['law']}, {result['mode']}: rms residual "
        f"{result['rmse_N']:.4g} N (noise floor {result['noise_floor_N']:.3g} N), largest "
        f"{result['max_residual_N']:.3g} N",
        f"{'parameter':<30} {'value':>11} {'95 % low':>11} {'95 % high':>11}",
    ]
    for label, one in parameter_rows(result["parameters"]):
        low, high = (f"{one[end]:.5g}" if one[end] is not None else "-" for end in ("low", "high"))
        state = "  at bound" if one["at_bound"] else ""
        lines.append(f"{label:<30} {one['value']:>11.5g} {low:>11} {high:>11}{state}")
    lines.append(f"{'elements':<9} {'rms N':>9} {'AICc above':>11} {'held-out rms N':>15}")
    lowest = min(row["aicc"] for row in result["comparison"].values())
    for number, row in result["comparison"].items():
        above = f"{row['aicc'] - lowest:.1f}" if row["aicc"] - lowest < 1000 else "> 1000"
        heldout = f"{row['heldout_rmse_N']:.4g}" if row["heldout_rmse_N"] is not None else "-"
        lines.append(f"{number:<9} {row['rmse_N']:>9.4g} {above:>11} {heldout:>15}")
    tried = result["starts"]
    lines.append(f"{tried['same_optimum']} of {tried['tried']} starts ended in the same optimum")
    lines.append(f"{'trace':<28} {'mm/s':>7} {'mm':>7} {'steady N':>9} {'peak N':>8} {'rms N':>8} {'worst N':>8}")
    for row in result["by_trace"]:
        lines.append(
            f"{row['file'][:28]:<28} {row['velocity_mm_s']:>7.4g} {row['depth_mm']:>7.3f} "
            f"{row['steady_force_N']:>9.3f} {row['peak_force_N']:>8.3f} {row['rmse_N']:>8.4f} "
            f"{row['max_residual_N']:>8.4f}"
        )
    for row in result.get("contact_offsets") or []:
        lines.append(
            f"{row['file'][:28]:<28} touched {row['value_mm']:+.3f} mm before its zero "
            f"({row['low_mm']:+.3f} to {row['high_mm']:+.3f})"
        )
    return "\n".join(lines + warning_lines(result) + file_lines(result))
