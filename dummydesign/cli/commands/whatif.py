"""``dummydesign whatif``: tables over thickness, ratio, punch, speed and force."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_replace_option, call
from dummydesign.cli.progress import Count
from dummydesign.cli.text import files_block, labelled, screen, tissue_lines, warning_block, warning_lines

HELP = "Compute many pads at once: depth, stiffness, local exponent, peak over steady, score for a tissue."
SHOWN = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be varied; ranges are START:STOP:STEP with STOP included."""
    add = parser.add_argument
    thickness = "in mm, inside 3 to 30, such as 3:30:0.5 or 5,15"
    add("--thickness", required=True, metavar="RANGE|LIST", help=thickness)
    add("--ratio", metavar="RANGE|LIST", help="mixing ratios (default the resin's reference)")
    add("--resin", default="polyurethane-nagoya", metavar="NAME|FILE", help="default polyurethane-nagoya")
    add("--tissue", metavar="NAME|FILE", help="score every design for this tissue")
    add("--aim", default="average", metavar="AIM", help="average (default), safe-side or subject:NAME")
    add("--punch", default="square:14", metavar="LIST", help="such as square:14,round:16 (default square:14)")
    add("--condition", default="bonded", metavar="LIST", help="face: bonded (default), frictionless or friction:MU")
    add("--base", default="bonded", metavar="LIST", help="pad on its base: bonded (default), sliding")
    add("--shape", default="slab", metavar="NAME[:KEY=RANGE,..],..",
        help="such as slab,crowned:radius=10:20:2,height=1.5/2; every combination of its lengths (default slab)")
    edges = "fillets of the punch's edge in mm, for slabs (default 0, sharp)"
    add("--edge-radius", default="0", metavar="RANGE|LIST", help=edges)
    add("--velocity", default="10,250", metavar="RANGE|LIST", help="in mm/s (default 10,250)")
    add("--force", default="1,5,10,15", metavar="RANGE|LIST", help="in N (default 1,5,10,15)")
    add("--hold", default=10.0, metavar="S", help="hold after the stop (default 10 s)")
    add("--deceleration", default=30000.0, metavar="MM_S2", help="braking (default 30000 mm/s2)")
    add("--fidelity", default="table", metavar="NAME", help="table (default), axisymmetric or 3d")
    add("--workers", type=int, default=1, metavar="N", help="processes of this machine (default 1)")
    add("--scheduler", metavar="ADDRESS", help="a running Dask scheduler, such as tcp://host:8786")
    add("--resume", action="store_true", help="keep the rows that are in the folder and work out what is missing")
    add("--out", metavar="DIR", help="folder of rows.csv and report.html (default whatif-RESIN)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Work out the study, write rows and report, and return the rows."""
    from dummydesign.api.sweeps import whatif

    count = Count("designs")
    try:
        return call(whatif, options, progress=count).to_dict()
    finally:
        count.clear()


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from dummydesign.resin import load_resin

    return f"whatif-{load_resin(options.resin).name}"


def best_first(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows by falling score, those of equal score as they were; as they are without scores."""
    if not rows or "score" not in rows[0]:
        return rows
    return sorted(rows, key=lambda row: -row["score"]["total"])


BEST, ACROSS = 10, 7


def render(result: dict[str, Any]) -> str:
    """The ten best for the tissue, or depths with thickness across and ratio down."""
    rows = best_first(result["rows"])
    scored = "score" in rows[0]
    varied = {name: list(dict.fromkeys(row[name] for row in rows)) for name in VARIED}
    head = [*tissue_lines(result), *labelled("DESIGNS", f"{len(rows)} in {result['seconds']:.2f} s; " + "; ".join(
        f"{name.removesuffix('_mm').replace('_', ' ')} {values[0]}" for name, values in varied.items()
        if len(values) == 1 and values[0]))]  # fmt: skip
    plane = not scored and all(len(values) == 1 for values in varied.values())
    table = _plane(rows) if plane else _first(rows, varied)
    more = "  ... and {} more rows: --details" if plane else "  ... and {} more designs: --details"
    return screen(
        [*head, ""], table, [""], warning_block(result), files_block(result, ("report", "rows")),
        labelled("MORE", "--details: exponents, peaks and every design; rows.csv has every number"), more=more,
    )  # fmt: skip


VARIED = ("shape", "punch", "condition", "base", "edge_radius_mm")


def _plane(rows: list[dict[str, Any]]) -> list[str]:
    """Depth at one force, thickness across, ratio down."""
    forces = list(rows[0]["depth_mm_at_N"])
    force = forces[len(forces) // 2]
    across = sorted({row["thickness_mm"] for row in rows})
    shown = across if len(across) <= ACROSS else [across[round(i * (len(across) - 1) / (ACROSS - 1))]
                                                  for i in range(ACROSS)]  # fmt: skip
    at = {(row["ratio"], row["thickness_mm"]): row for row in rows}
    lines = [f"  depth in mm at {force} N steady ('-': not reached), peak over steady at the highest speed",
             f"  {'ratio':<7}{'kPa':<8}" + "".join(f"{f'{thickness:g} mm':<12}" for thickness in shown)]  # fmt: skip
    for ratio in sorted({row["ratio"] for row in rows}):
        cells = []
        for thickness in shown:
            row = at.get((ratio, thickness))
            depth = None if row is None else row["depth_mm_at_N"][force]
            peak = None if row is None else list(row["peak_over_steady"].values())[-1]
            cells.append("-" if depth is None else f"{depth:.2f}" + ("" if peak is None else f", {peak:.2f}"))
        young = next(row["young_kPa"] for row in rows if row["ratio"] == ratio)
        lines.append(f"  {ratio:<7g}{young:<8.3g}" + "".join(f"{cell:<12}" for cell in cells))
    left = len(across) - len(shown)
    return [*lines, *([f"  {left} more thicknesses: --details"] if left else [])]


def _first(rows: list[dict[str, Any]], varied: dict[str, list[Any]]) -> list[str]:
    """The best designs, one a row, with what differs between them."""
    forces = list(rows[0]["depth_mm_at_N"])
    shown = forces if len(forces) <= 3 else [forces[0], forces[len(forces) // 2], forces[-1]]
    differ = [name for name, values in varied.items() if len(values) > 1]
    score = "score" in rows[0]
    lines = [f"  {'score  ' if score else ''}{'mm':<7}{'ratio':<7}{'kPa':<7}"
             + "".join(f"{f'at {force} N':<10}" for force in shown) + ", ".join(differ)]  # fmt: skip
    for row in rows[:BEST] if score else rows:
        depths = (row["depth_mm_at_N"][force] for force in shown)
        cells = "".join(f"{'-' if depth is None else f'{depth:.2f}':<10}" for depth in depths)
        total = f"{row['score']['total']:<7.2f}" if score else ""
        lines.append(f"  {total}{row['thickness_mm']:<7g}{row['ratio']:<7g}{row['young_kPa']:<7.3g}{cells}"
                     + ", ".join(str(row[name]) for name in differ))  # fmt: skip
    left = len(rows) - BEST
    return [*lines, *([f"  ... and {left} more designs: --details"] if score and left > 0 else [])]


def render_details(result: dict[str, Any]) -> str:
    """Lay the first rows out as a table; the rest stands in the CSV."""
    rows = best_first(result["rows"])
    forces = list(rows[0]["depth_mm_at_N"])
    speeds = list(rows[0]["peak_over_steady"])
    scored = "score" in rows[0]
    shaped = len({row["shape"] for row in rows} | {"slab"}) > 1
    filleted = any(row["edge_radius_mm"] for row in rows)
    supports = {(row["condition"], row["base"]) for row in rows}
    head = f"{'mm':<6} {'ratio':<6} {'kPa':<7} {'punch':<12} " + ("face, base".ljust(22) if len(supports) > 1 else "")
    head += "edge ".ljust(6) if filleted else ""
    head += " ".join(f"x,n at {force} N".ljust(14) for force in forces)
    head += " " + " ".join(f"peak {speed} mm/s".ljust(14) for speed in speeds)
    hold = result["inputs"]["hold_s"]
    end = "" if hold == 10.0 else f", the force at the end of a hold of {hold:g} s"
    what = f"x depth in mm, n local exponent d ln F / d ln x (both relaxed), peak over steady at 10 N steady{end}"
    lines = [*tissue_lines(result), what, "", head]
    for row in rows[:SHOWN]:
        cells = []
        for force in forces:
            depth, exponent = row["depth_mm_at_N"][force], row["exponent_at_N"][force]
            cells.append(("-" if depth is None else f"{depth:.2f}, {exponent:.2f}").ljust(14))
        for value in row["peak_over_steady"].values():
            cells.append(("-" if value is None else f"{value:.2f}").ljust(14))
        line = f"{row['thickness_mm']:<6g} {row['ratio']:<6g} {row['young_kPa']:<7.3g} {row['punch']:<12} "
        if len(supports) > 1:
            line += f"{row['condition']}, {row['base']}".ljust(22)
        line += f"{row['edge_radius_mm']:<6g}" if filleted else ""
        line += " ".join(cells) + (f" score {row['score']['total']:.2f}" if scored else "")
        lines.append(line + (f" {row['shape']}" if shaped else ""))
    if len(rows) > SHOWN:
        lines.append(f"... {len(rows) - SHOWN} more rows in {result['files']['rows']}")
    lines += ["", f"{len(rows)} designs in {result['seconds']:.2f} s; rows: {result['files']['rows']}"]
    lines += [f"{role}: {path}" for role, path in result["files"].items() if role == "report"]
    return "\n".join(lines + warning_lines(result))
