"""Make the tables of slabs under filleted punches: ``python -m studies.tables.filleted``.

Every fillet of a grid is solved at Chebyshev nodes in ln(a / h), on two meshes each (see ``pad.slab.filleted``). The
error of what lies between is measured on solves drawn at random.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.user_library import data_folder
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS, MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.axisymmetric.case import LATTICE
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import FILLETS, between_fillets
from studies.tables.common import Build, write_table
from studies.tables.slab import RATIO_RANGE, nodes

Array = np.ndarray

# Depths over thickness in the table: those a solve visits.
DEPTHS = LATTICE * np.concatenate([[1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2], np.arange(1.0, 31.0)])
DEPTHS = DEPTHS[DEPTHS <= MAX_DEPTH_OVER_THICKNESS * (1.0 + 1e-9)]
SEED = 77041


def solve(task: tuple[float, float, str]) -> tuple[Array, Array]:
    """ln(F / (E a d)) and its relative error at the depths, NaN where none was reached.

    Parameters
    ----------
    task : (float, float, str)
        a / h, fillet over a, and base.
    """
    ratio, fillet, base = task
    value, error = np.full(len(DEPTHS), np.nan), np.full(len(DEPTHS), np.nan)
    try:
        extent_mm = EXTENT_OVER_RADIUS * ratio
        pad = Pad(1.0, 1.0, ratio, base=base, extent_mm=extent_mm, edge_radius_mm=fillet * ratio)
        curve = solve_under_fillet(pad, DEPTHS)
    except NoAnswerError as problem:
        print(f"a/h {ratio:.3g}, fillet {fillet:g} a: {problem}", file=sys.stderr)
        return value, error
    count = len(curve.depth_mm)
    value[:count] = np.log(curve.force_N / (ratio * curve.depth_mm))
    error[:count] = curve.error_N / curve.force_N
    return value, error


def content(base: str, count: int, fresh: int, pool: ProcessPoolExecutor) -> dict[str, Any]:
    """Solve grid and random pads; return what goes into the file.

    Parameters
    ----------
    base : str
        ``bonded`` or ``sliding``.
    count, fresh : int
        Values of a / h, and random pads.
    pool : ProcessPoolExecutor
        Solves them.
    """
    ratios = nodes(count)
    tasks = [(float(ratio), float(fillet), base) for ratio in ratios for fillet in FILLETS]
    answers = []
    for task, answer in zip(tasks, pool.map(solve, tasks)):
        answers.append(answer)
        print(f"{base} a/h {task[0]:.3f} fillet {task[1]:g} a: {np.isfinite(answer[0]).sum()} depths", file=sys.stderr)
    shape = (len(ratios), len(FILLETS), len(DEPTHS))
    value, error = (np.array([answer[k] for answer in answers]).reshape(shape) for k in (0, 1))
    table = {
        "base": base,
        "meaning": "ln(F / (E a d)) over a/h, fillet over a, and d/h; E long-term, a punch radius, glued, with sides",
        "ratio": _list(ratios),
        "fillet": _list(FILLETS),
        "depth": _list(DEPTHS),
        "value": _list(value),
        "error": _list(error, 3),
    }
    rng = np.random.default_rng(SEED)
    low, high = np.log(RATIO_RANGE)
    places = np.exp(rng.uniform(low, high, fresh)), rng.uniform(FILLETS[0], FILLETS[-1], fresh)
    drawn = [(float(ratio), float(fillet), base) for ratio, fillet in zip(*places)]
    miss = []
    for task, (solved, _) in zip(drawn, pool.map(solve, drawn)):
        between = between_fillets(table, task[1])
        wanted = np.minimum(DEPTHS, between.depth_limit(task[0]))
        known = np.isfinite(solved) & (DEPTHS <= wanted * (1.0 + 1e-9))
        miss.append(np.where(known, np.abs(between.log(wanted, task[0]) - solved), np.nan))
    rows = np.array(miss)
    table["provenance"] = {
        "law": "neo-Hookean, incompressible",
        "punch": "round, flat, glued where it touches, edge a fillet with an upright side above it",
        "extent_over_radius": EXTENT_OVER_RADIUS,
        "curves": len(tasks),
        "fresh_curves": fresh,
        "median_error": _short(np.nanmedian(rows), 3),
        "error_of_95_percent": _short(np.nanpercentile(rows, 95.0), 3),
        "largest_error": _short(np.nanmax(rows), 3),
    }
    return table


def _short(number: float, digits: int = 6) -> float | None:
    return float(f"{number:.{digits}g}") if np.isfinite(number) else None


def _list(values: Array, digits: int = 6) -> list[Any]:
    return [_list(row, digits) if np.ndim(row) else _short(float(row), digits) for row in np.asarray(values)]


def main(arguments: list[str] | None = None) -> None:
    """Build the tables of the bases named on the command line (both by default)."""
    parser = argparse.ArgumentParser(description="Make the tables of slabs under filleted punches.")
    parser.add_argument("--base", choices=("bonded", "sliding"), action="append")
    parser.add_argument("--count", type=int, default=9, help="values of a / h")
    parser.add_argument("--fresh", type=int, default=24, help="random solves, for the table's error")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    build = Build.begin("studies.tables.filleted", arguments)
    with ProcessPoolExecutor(options.workers) as pool:
        for base in options.base or ["bonded", "sliding"]:
            table = content(base, options.count, options.fresh, pool)
            write_table(options.out / f"filleted-{base}.json", table, build, SEED)
            print(f"filleted-{base}.json: {table['provenance']}")


if __name__ == "__main__":
    main()
