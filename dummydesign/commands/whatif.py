"""``dummydesign whatif``: tables over thickness, ratio, punch, speed and force."""

from __future__ import annotations

import argparse
from typing import Any

HELP = "Work out many slabs at once: depth, stiffness, local exponent, peak over steady, score for a tissue."
SHOWN = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what can be varied; ranges are START:STOP:STEP with STOP included."""
    add = parser.add_argument
    add(
        "--thickness",
        required=True,
        metavar="RANGE|LIST",
        help="in mm, inside 3 to 30, such as 3:30:0.5 or 5,15",
    )
    add("--ratio", metavar="RANGE|LIST", help="mixing ratios (default the resin's reference)")
    add("--resin", default="polyurethane-nagoya", metavar="NAME|FILE")
    add("--tissue", metavar="NAME|FILE", help="score every design for this tissue")
    add("--aim", default="average", metavar="AIM", help="average (default), safe-side or subject:NAME")
    add("--punch", default="square:14", metavar="LIST", help="such as square:14,round:16 (default square:14)")
    add("--condition", default="bonded", metavar="LIST", help="punch on pad: bonded")
    add("--velocity", default="10,250", metavar="RANGE|LIST", help="in mm/s (default 10,250)")
    add("--force", default="1,5,10,15", metavar="RANGE|LIST", help="in N (default 1,5,10,15)")
    add("--fidelity", default="table", metavar="NAME", help="table (default) or axisymmetric")
    add("--workers", type=int, default=1, metavar="N", help="processes for finite elements (default 1)")
    add("--out", metavar="DIR", help="folder of rows.csv (default whatif-RESIN)")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Work out the study, write its CSV and return the rows."""
    from pathlib import Path

    from dummydesign.design.whatif import csv_text
    from dummydesign.files import output_folder, write_text
    from dummydesign.resin import load_resin

    resin = load_resin(options.resin)
    study = _study(options, resin)
    study.check(resin)
    out = Path(options.out if options.out is not None else f"whatif-{resin.name}")
    output_folder(out)
    found = _work(study, options.workers)
    path = write_text(out / "rows.csv", csv_text(found["rows"]))
    inputs = {
        **study.to_dict(),
        "condition": "bonded",
        "base": "bonded",
        "workers": options.workers,
        "out": str(out),
    }
    stopped = sum(row["limit"] is not None for row in found["rows"])
    warnings = []
    if stopped:
        message = f"{stopped} of {study.size} designs do not reach every force; 'limit' says why"
        warnings.append({"code": "out_of_reach", "message": message})
    return {
        "inputs": inputs,
        "warnings": warnings,
        "sources": list(resin.references),
        **found,
        "files": {"rows": str(path)},
    }


def _study(options: argparse.Namespace, resin: Any) -> Any:
    """Read what is varied."""
    from dummydesign.design.punch import equal_area_radius_mm
    from dummydesign.design.ranges import parse_values
    from dummydesign.design.whatif import Study
    from dummydesign.errors import out_of_range, unknown_name

    if options.condition != "bonded":
        raise unknown_name("condition", options.condition, ["bonded"])
    if options.workers < 1:
        raise out_of_range("workers", options.workers, 1, "any number of processes")
    ratio = [resin.relaxation_ratio_ref]
    if options.ratio is not None:
        ratio = parse_values(options.ratio, "ratio")
    return Study(
        thickness_mm=tuple(parse_values(options.thickness, "thickness in mm")),
        ratio=tuple(ratio),
        punches=tuple((name, equal_area_radius_mm(name)) for name in options.punch.split(",")),
        velocities_mm_s=tuple(parse_values(options.velocity, "velocity in mm/s")),
        forces_N=tuple(parse_values(options.force, "force in N")),
        resin=options.resin,
        tissue=options.tissue,
        aim=options.aim,
        fidelity=options.fidelity,
    )


def _work(study: Any, workers: int) -> dict[str, Any]:
    """Work out the study, with a pool of processes when finite elements are asked for."""
    from dummydesign.design.whatif import whatif

    if workers == 1 or study.fidelity == "table":
        return whatif(study)
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        return whatif(study, executor=pool)


def render(result: dict[str, Any]) -> str:
    """Lay the first rows out as a table; the rest stands in the CSV."""
    rows = result["rows"]
    forces = list(rows[0]["depth_mm_at_N"])
    speeds = list(rows[0]["peak_over_steady"])
    scored = "score" in rows[0]
    head = f"{'mm':<6} {'ratio':<6} {'kPa':<7} {'punch':<12} "
    head += " ".join(f"x,n at {force} N".ljust(14) for force in forces)
    head += " " + " ".join(f"peak {speed} mm/s".ljust(14) for speed in speeds)
    lines = ["x depth in mm, n local exponent d ln F / d ln x, peak over steady at 10 N steady", "", head]
    for row in rows[:SHOWN]:
        cells = []
        for force in forces:
            depth, exponent = row["depth_mm_at_N"][force], row["exponent_at_N"][force]
            cells.append(("-" if depth is None else f"{depth:.2f}, {exponent:.2f}").ljust(14))
        for value in row["peak_over_steady"].values():
            cells.append(("-" if value is None else f"{value:.2f}").ljust(14))
        line = f"{row['thickness_mm']:<6g} {row['ratio']:<6g} {row['young_kPa']:<7.3g} {row['punch']:<12} "
        line += " ".join(cells)
        lines.append(line + (f" score {row['score']['total']:.2f}" if scored else ""))
    if len(rows) > SHOWN:
        lines.append(f"... {len(rows) - SHOWN} more rows in {result['files']['rows']}")
    lines += ["", f"{len(rows)} designs in {result['seconds']:.2f} s; rows: {result['files']['rows']}"]
    return "\n".join(lines + [f"warning: {item['message']}" for item in result["warnings"]])
