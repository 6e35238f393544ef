"""Make the square-over-circle factors: ``python -m studies.tables.square``.

A square, glued punch in space and its round twin are solved on the same cells for several a / h, in two ways:
with a sharp edge and several corner cells (see ``pad.slab.square_sharp``), which ends where the corner cell folds,
and with a fillet at the edge of several radii (see ``square_beaded``), which goes on from there. One regression over
all values removes what is linear in the corner cell and in the fillet, and gives the factor as a Chebyshev series, with
its stated error (see ``square_fit``).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dummydesign.core.user_library import data_folder
from dummydesign.pad.spatial.square_punch import (
    CornerCells,
    Ratios,
    SquareProblem,
    depth_of_corner,
    solve_ratios,
    useful_depths,
)
from dummydesign.pad.tables.square import SIDE_OVER_RADIUS, combined_depth
from studies.tables.common import Build, write_table
from studies.tables.slab import nodes
from studies.tables.square_fit import DEPTH_END, Values, content, short

Array = np.ndarray

CORNERS = (0.45, 0.3, 0.2)
# First touch is cheap: solved at more ratios and with finer corners.
FIRST_CORNERS = (0.14, 0.1)
FIRST_COUNT = 13
SHARP_STEP, SHARP_END = 0.05, 0.85
# Fillets, as large as the cells beside them, and the relative depths to which they are followed.
RIMS = (0.28, 0.2, 0.14)
RIMMED_STEP, RIMMED_END = 0.05, 0.5
# Half length and half width of the 150 x 120 mm slab over the half side of the 14 mm punch.
EXTENT_OVER_SIDE = (75.0 / 7.0, 60.0 / 7.0)


@dataclass(frozen=True)
class Task:
    """One a / h on one kind of base, with one corner cell; ``rim`` 0 is a sharp edge."""

    ratio: float
    base: str
    corner: float
    rim: float = 0.0


def square_block(ratio: float, base: str) -> SquareProblem:
    """The square punch of a / h = ``ratio``, a the radius of equal area, on a slab that scales with it."""
    side = ratio * SIDE_OVER_RADIUS
    return SquareProblem((side, side), (EXTENT_OVER_SIDE[0] * side, EXTENT_OVER_SIDE[1] * side), base)


def solve_one(task: Task) -> Ratios:
    """Solve one a / h to the depth at which a cell folds or the last one wanted; the finest only at first touch."""
    block, cells = square_block(task.ratio, task.base), CornerCells(task.corner)
    if task.rim:
        depths = np.arange(RIMMED_STEP, RIMMED_END + 1e-9, RIMMED_STEP)
        depths = depths[combined_depth(depths, task.ratio) <= DEPTH_END]
        return solve_ratios(block, useful_depths(block, depths, task.rim), cells, task.rim)
    if task.corner in FIRST_CORNERS:
        return solve_ratios(block, np.array([]), cells)
    depths = np.arange(SHARP_STEP, SHARP_END + 1e-9, SHARP_STEP) / combined_depth(1.0, task.ratio)
    return solve_ratios(block, depths[depths <= depth_of_corner(block, cells)], cells)


def values_of(task: Task, answer: Ratios) -> Values:
    """The answer's ratios with what they belong to, first touch included if it is known."""
    first = [] if np.isnan(answer.first) else [answer.first]
    depth = np.concatenate([[0.0] * len(first), combined_depth(answer.depth, task.ratio)])
    same = np.ones(len(depth))
    factor = np.concatenate([first, answer.ratio])
    # As written to the file, so that values taken over from it belong to the same ratio.
    return Values(depth, short(task.ratio, 7) * same, task.corner * same, task.rim * same, factor)


def sharp_tasks(base: str, count: int) -> list[Task]:
    """Sharp edges: first touch with fine corners, depth with coarse ones."""
    tasks = [Task(float(ratio), base, corner) for ratio in nodes(FIRST_COUNT) for corner in FIRST_CORNERS]
    return tasks + [Task(float(ratio), base, corner) for ratio in nodes(count) for corner in CORNERS]


def _rimmed_tasks(base: str, count: int, rims: Sequence[float]) -> list[Task]:
    """Edges with a fillet."""
    return [Task(float(ratio), base, rim, rim) for ratio in nodes(count) for rim in rims]


def main(arguments: list[str] | None = None) -> None:
    """Build the files named on the command line (both bases by default)."""
    parser = argparse.ArgumentParser(description="Make the square-over-circle factors by finite elements in space.")
    parser.add_argument("--base", choices=("bonded", "sliding"), action="append")
    parser.add_argument("--count", type=int, default=9, help="ratios a / h")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rims", type=float, nargs="*", default=RIMS, help="beads to solve")
    parser.add_argument("--keep", choices=("sharp", "others"), help="take these values over from the present file")
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    build = Build.begin("studies.tables.square", arguments)
    for base in options.base or ["bonded", "sliding"]:
        path = options.out / f"square-{base}.json"
        tasks, parts = _rimmed_tasks(base, options.count, options.rims), []
        if options.keep:
            kept = Values.read(json.loads(path.read_text(encoding="utf-8"))["values"])
            again = np.isin(kept.rim, options.rims) if options.keep == "others" else kept.rim > 0.0
            parts.append(kept.where(~again))
        else:
            tasks = sharp_tasks(base, options.count) + tasks
        with ProcessPoolExecutor(options.workers) as pool:
            for task, answer in zip(tasks, pool.map(solve_one, tasks)):
                parts.append(values_of(task, answer))
                print(f"{task}: {len(answer.depth)} depths, {answer.solver}", file=sys.stderr, flush=True)
        table = content(base, Values.joined(parts), EXTENT_OVER_SIDE)
        write_table(path, table, build)
        print(f"square-{base}.json: {table['provenance']}")


if __name__ == "__main__":
    main()
