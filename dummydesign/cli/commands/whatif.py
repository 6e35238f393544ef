"""``dummydesign whatif``: tables over thickness, ratio, punch, speed and force."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli import text
from dummydesign.cli.common_options import call
from dummydesign.cli.progress import Count
from dummydesign.cli.text import labelled, screen, tissue_lines, warning_lines
from dummydesign.core.tables import Table

CALL = "designs.whatif"
HELP = "Compute many pads at once: depth, stiffness, local exponent, peak over steady, score for a tissue."
SHOWN = 40
BOTH = 7  # ratios up to which depths and peaks both fit one screen


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Work out the study, write rows and report, and return the rows."""
    count = Count("designs")
    try:
        return call(CALL, options, progress=count).to_dict()
    finally:
        count.clear()


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from dummydesign.resin import load_resin

    return f"whatif-{load_resin(options.resin).name}"


def render(result: dict[str, Any]) -> str:
    """The ten best for the tissue, or depths with thickness across and ratio down."""
    from dummydesign.report import whatif as facts

    rows = facts.best_first(result["rows"])
    seconds = f"{len(rows)} in {result['seconds']:.2f} s; "
    head = [*tissue_lines(result), *labelled("DESIGNS", seconds + "; ".join(facts.fixed_texts(rows)))]
    plane = facts.in_plane(rows)
    if plane:
        depths, peaks, left = facts.plane_tables(rows)
        forms, (depth_text, peak_text) = ["<7", "<8", *["<9"] * len(depths.head)], facts.plane_texts(rows)
        shown = [f"  {depth_text}", *depths.lines(forms, "")]
        if len(depths.rows) <= BOTH:
            shown += ["", f"  {peak_text}", *peaks.lines(forms, "")]
    else:
        best, left = facts.first_table(rows)
        first = best.head.index("kPa") + 1
        forms = [*["<7"] * first, *["<10"] * (len(best.head) - first - 1), "<1"]
        shown = [f"  {facts.first_text(rows)}", *best.lines(forms, "")]
    if left > 0:
        columns_left = f"  {left} more thickness{'es' * (left != 1)}: --details"
        shown.append(columns_left if plane else f"  ... and {left} more designs: --details")
    more = "  ... and {} more rows: --details" if plane else "  ... and {} more designs: --details"
    files = text.files_block(result, ("report", "first_page", "rows"))
    return screen(
        [*head, ""],
        shown,
        [""],
        text.warning_block(result),
        files,
        labelled("MORE", "--details: exponents, peaks and every design; rows.csv has every number"),
        more=more,
    )


def render_details(result: dict[str, Any]) -> str:
    """Lay the first rows out as a table; the rest stands in the CSV."""
    from dummydesign.report.whatif import best_first

    rows = best_first(result["rows"])
    scored = "score" in rows[0]
    shaped = len({row["shape"] for row in rows} | {"slab"}) > 1
    filleted = any(row["edge_radius_mm"] for row in rows)
    supports = {(row["condition"], row["base"]) for row in rows}
    columns = {"mm": "thickness_mm:<6g", "ratio": "ratio:<6g", "kPa": "young_kPa:<7.3g", "punch": "punch:<12"}
    columns |= {"face, base": "support:<21"} if len(supports) > 1 else {}
    columns |= {"edge": "edge_radius_mm:<5g"} if filleted else {}
    columns |= {f"x,n at {force} N": f"at {force} N:<14" for force in rows[0]["depth_mm_at_N"]}
    columns |= {f"peak {speed} mm/s": f"peak {speed}:<14.2f" for speed in rows[0]["peak_over_steady"]}
    columns |= {"": "score:<1"} if scored else {}
    columns |= {" ": "shape:<1"} if shaped else {}
    hold = result["inputs"]["hold_s"]
    end = "" if hold == 10.0 else f", the force at the end of a hold of {hold:g} s"
    what = f"x depth in mm, n local exponent d ln F / d ln x (both relaxed), peak over steady at 10 N steady{end}"
    shown = []
    for row in rows[:SHOWN]:
        depths = {
            f"at {force} N": None if depth is None else f"{depth:.2f}, {row['exponent_at_N'][force]:.2f}"
            for force, depth in row["depth_mm_at_N"].items()
        }
        peaks = {f"peak {speed}": value for speed, value in row["peak_over_steady"].items()}
        score = {"score": f"score {row['score']['total']:.2f}"} if scored else {}
        shown.append({**row, "support": f"{row['condition']}, {row['base']}", **depths, **peaks, **score})
    lines = [*tissue_lines(result), what, "", *Table.of(shown, columns).lines(indent="")]
    if len(rows) > SHOWN:
        lines.append(f"... {len(rows) - SHOWN} more rows in {result['files']['rows']}")
    lines += ["", f"{len(rows)} designs in {result['seconds']:.2f} s; rows: {result['files']['rows']}"]
    lines += [f"{role}: {path}" for role, path in result["files"].items() if role == "report"]
    return "\n".join(lines + warning_lines(result))
