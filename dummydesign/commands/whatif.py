"""``dummydesign whatif``: tables over thickness, ratio, punch, speed and force."""

from __future__ import annotations

import argparse
from typing import Any

HELP = "Work out many slabs at once: depth, stiffness, local exponent, peak over steady, score for a tissue."
SHOWN = 40
ROUGH_PERCENT = 2.0


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
    add("--condition", default="bonded", metavar="LIST", help="face: bonded (default), frictionless or friction:MU")
    add("--base", default="bonded", metavar="LIST", help="pad on its base: bonded (default), sliding")
    add("--velocity", default="10,250", metavar="RANGE|LIST", help="in mm/s (default 10,250)")
    add("--force", default="1,5,10,15", metavar="RANGE|LIST", help="in N (default 1,5,10,15)")
    add("--fidelity", default="table", metavar="NAME", help="table (default), axisymmetric or 3d")
    add("--workers", type=int, default=1, metavar="N", help="processes of this machine (default 1)")
    add("--scheduler", metavar="ADDRESS", help="a running Dask scheduler, such as tcp://host:8786")
    add("--resume", action="store_true", help="keep the rows that are in the folder and work out what is missing")
    add("--out", metavar="DIR", help="folder of rows.csv and report.html (default whatif-RESIN)")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Work out the study, write rows and report, and return the rows."""
    from pathlib import Path

    from dummydesign.design.executors import open_executor
    from dummydesign.design.rows_file import RowsFile, settings_of
    from dummydesign.design.whatif import whatif
    from dummydesign.files import output_folder
    from dummydesign.resin import load_resin

    resin = load_resin(options.resin)
    study = _study(options, resin)
    study.check(resin)
    tissue = _tissue(options)
    settings = settings_of(study, resin, tissue)
    out = Path(options.out if options.out is not None else f"whatif-{resin.name}")
    with open_executor(options.workers, options.scheduler) as executor:
        output_folder(out)
        file = RowsFile(out, study, settings, options.resume)
        kept = len(file.rows)
        found = whatif(study, executor=executor, file=file)
    from dummydesign.report.whatif import write_whatif

    warnings = _warnings(study, found["rows"])
    files = {"rows": str(file.path), **write_whatif(out, study, found["rows"], resin, tissue, warnings)}
    inputs = {
        **study.to_dict(),
        "workers": options.workers,
        "scheduler": options.scheduler,
        "resume": options.resume,
        "out": str(out),
    }
    return {
        "inputs": inputs,
        "warnings": warnings,
        "sources": [*resin.references, *([] if tissue is None else tissue.sources)],
        **found,
        "resumed_rows": kept,
        "files": files,
    }


def _warnings(study: Any, rows: list[dict[str, Any]]) -> list[dict[str, str]]:
    said = []
    stopped = sum(row["limit"] is not None for row in rows)
    if stopped:
        message = f"{stopped} of {study.size} designs do not reach every force; 'limit' says why"
        said.append({"code": "out_of_reach", "message": message})
    rough = [row["force_error_percent"] for row in rows if (row["force_error_percent"] or 0.0) > ROUGH_PERCENT]
    if rough:
        message = f"forces of {len(rough)} designs are known to {max(rough):.1f} % at worst ('force_error_percent')"
        said.append({"code": "rough_solve", "message": f"{message}; their exponents are rougher still"})
    if study.reduced:
        message = f"{', '.join(study.reduced)}: taken as the circle of equal area; --fidelity 3d solves the corners"
        said.append({"code": "punch_as_circle", "message": message})
    return said


def _tissue(options: argparse.Namespace) -> Any:
    """The tissue to score for; its aim is tried at once."""
    if options.tissue is None:
        return None
    from dummydesign.tissue.store import load_tissue

    tissue = load_tissue(options.tissue)
    tissue.target(options.aim)
    return tissue


def _study(options: argparse.Namespace, resin: Any) -> Any:
    """Read what is varied."""
    from dummydesign.design.punch import equal_area_radius_mm
    from dummydesign.design.ranges import parse_values
    from dummydesign.design.study import Study

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
        conditions=tuple(options.condition.split(",")),
        bases=tuple(options.base.split(",")),
    )


def render(result: dict[str, Any]) -> str:
    """Lay the first rows out as a table; the rest stands in the CSV."""
    rows = result["rows"]
    forces = list(rows[0]["depth_mm_at_N"])
    speeds = list(rows[0]["peak_over_steady"])
    scored = "score" in rows[0]
    supports = {(row["condition"], row["base"]) for row in rows}
    head = f"{'mm':<6} {'ratio':<6} {'kPa':<7} {'punch':<12} " + ("face, base".ljust(22) if len(supports) > 1 else "")
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
        if len(supports) > 1:
            line += f"{row['condition']}, {row['base']}".ljust(22)
        line += " ".join(cells)
        lines.append(line + (f" score {row['score']['total']:.2f}" if scored else ""))
    if len(rows) > SHOWN:
        lines.append(f"... {len(rows) - SHOWN} more rows in {result['files']['rows']}")
    lines += ["", f"{len(rows)} designs in {result['seconds']:.2f} s; rows: {result['files']['rows']}"]
    lines += [f"{role}: {path}" for role, path in result["files"].items() if role == "report"]
    return "\n".join(lines + [f"warning: {item['message']}" for item in result["warnings"]])
