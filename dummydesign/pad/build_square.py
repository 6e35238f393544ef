"""Make the square-over-circle factors: ``python -m dummydesign.pad.build_square``.

A square, sharp-edged, glued punch in space and its round twin are solved on the same cells (see ``spatial``)
for several a / h and three corner cells. One regression over all values removes the part that is linear in
the corner cell and gives the factor as a Chebyshev series, with its stated error.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign import __version__
from dummydesign.files import write_text
from dummydesign.library import data_folder
from dummydesign.pad.build_table import RATIO_RANGE, nodes
from dummydesign.pad.laws import Yeoh
from dummydesign.pad.spatial import Block, Cells, Ratios, depth_of_corner, solve_ratios
from dummydesign.pad.square import SIDE_OVER_RADIUS, combined_depth

Array = np.ndarray

CORNERS = (0.45, 0.3, 0.2)
# First touch is cheap: solved at more ratios and with finer corners.
FIRST_CORNERS = (0.14, 0.1)
FIRST_COUNT = 13
STEP = 0.05
DEPTH_END = 0.85
TERMS = (4, 7)
# Half length and half width of the 150 x 120 mm slab over the half side of the 14 mm punch.
EXTENT_OVER_SIDE = (75.0 / 7.0, 60.0 / 7.0)
MESH_ERROR = 5e-4
# Share of its own correction by which an extrapolated factor may be off.
CORRECTION_ERROR = 0.5


def square_block(ratio: float, base: str) -> Block:
    """The square punch of a / h = ``ratio``, a the radius of equal area, on a slab that scales with it."""
    side = ratio * SIDE_OVER_RADIUS
    return Block((side, side), (EXTENT_OVER_SIDE[0] * side, EXTENT_OVER_SIDE[1] * side), base)


def solve_one(task: tuple[float, str, float]) -> Ratios:
    """Solve one a / h with one corner cell, to the depth at which it folds; the finest only at first touch."""
    ratio, base, corner = task
    block, cells = square_block(ratio, base), Cells(corner)
    if corner in FIRST_CORNERS:
        return solve_ratios(block, Yeoh(1.0), 0.5, np.array([]), cells)
    depths = np.arange(STEP, DEPTH_END + 1e-9, STEP) / combined_depth(1.0, ratio)
    return solve_ratios(block, Yeoh(1.0), 0.5, depths[depths <= depth_of_corner(block, cells)], cells)


def _columns(depth: Array, ratio: Array, corner: Array) -> tuple[Array, Array]:
    """Columns of the series and of the corner's correction."""
    u = 2.0 * depth / DEPTH_END - 1.0
    low, high = np.log(RATIO_RANGE)
    v = 2.0 * (np.log(ratio) - low) / (high - low) - 1.0
    series = np.polynomial.chebyshev.chebvander2d(u, v, [TERMS[0] - 1, TERMS[1] - 1])
    turn = np.polynomial.chebyshev.chebvander(v, 3)
    correction = np.concatenate([corner[:, None] * turn, (corner * depth)[:, None] * turn], axis=1)
    return series, correction


def fit(depth: Array, ratio: Array, corner: Array, factor: Array) -> tuple[Array, Array, Array]:
    """Fit ln factor = series(depth, ln a/h) + corner * correction; coefficients, correction, misfit."""
    series, correction = _columns(depth, ratio, corner)
    matrix = np.concatenate([series, correction], axis=1)
    weight = 1.0 / (MESH_ERROR + 2e-3 * corner)
    # Weak preference for low orders: the corner and the depth reached are linked, deep values are coarse.
    order = np.add.outer(np.arange(TERMS[0]) * 2, np.arange(TERMS[1])).ravel()
    damping = np.diag(np.concatenate([2.0 * 1.8**order, np.full(correction.shape[1], 20.0)]))
    system = np.concatenate([matrix * weight[:, None], damping])
    load = np.concatenate([np.log(factor) * weight, np.zeros(matrix.shape[1])])
    solution, *_ = np.linalg.lstsq(system, load, rcond=None)
    count = TERMS[0] * TERMS[1]
    return solution[:count].reshape(TERMS), solution[count:], np.log(factor) - matrix @ solution


def content(tasks: list[tuple[float, str, float]], answers: list[Ratios]) -> dict[str, Any]:
    """Fit all values; return what goes into the file."""
    parts = []
    for (ratio, _, corner), answer in zip(tasks, answers):
        depth = np.concatenate([[0.0], combined_depth(answer.depth, ratio)])
        value = np.concatenate([[answer.first], answer.ratio])
        parts.append(np.stack([depth, np.full(len(depth), ratio), np.full(len(depth), corner), value]))
    values = np.concatenate(parts, axis=1)
    depth, ratio, corner, _ = values
    coefficients, correction, misfit = fit(*values)
    ratios = np.unique(ratio[depth > 0.0])
    reach = np.array([depth[ratio == r].max() for r in ratios])
    depths = np.linspace(0.0, DEPTH_END, 14)
    error = [_error_row(r, depths, values, correction, misfit) for r in ratios]
    return {
        "base": tasks[0][1],
        "meaning": "ln(force of a square over force of the circle of equal area) = Chebyshev series in "
        "(d/h) sqrt(1 + (h/a)^2) and ln(a/h); a radius of equal area, glued punch",
        "coefficients": [[_short(c, 7) for c in row] for row in coefficients],
        "ratio_range": list(RATIO_RANGE),
        "depth_range": [0.0, DEPTH_END],
        "reach_ratio": [_short(r) for r in ratios],
        "reach_depth": [_short(r) for r in reach],
        "error_depth": [_short(d) for d in depths],
        "error": [[_short(e, 3) for e in row] for row in error],
        "provenance": {
            "command": "python -m dummydesign.pad.build_square",
            "version": __version__,
            "law": "neo-Hookean, incompressible",
            "punch": "square over round, flat, glued, sharp edge; both on the same cells",
            "extent_over_side": EXTENT_OVER_SIDE,
            "corner_cells": sorted({task[2] for task in tasks}),
            "values": len(misfit),
            "rms_residual": _short(np.sqrt(np.mean(misfit**2)), 3),
        },
        "values": {n: [_short(v, 7) for v in row] for n, row in zip(("depth", "ratio", "corner", "factor"), values)},
    }


def _error_row(at: float, depths: Array, values: Array, correction: Array, misfit: Array) -> list[float]:
    """Stated error at one a / h: mesh, scatter near by, and half of what the finest cell there was corrected by."""
    depth, ratio, corner, _ = values
    reach = {c: depth[(ratio == at) & (corner == c)].max() for c in np.unique(corner[ratio == at])}
    scatter = np.sqrt(np.mean(misfit[np.abs(np.log(ratio / at)) < 0.5] ** 2))
    row = []
    for d in np.minimum(depths, max(reach.values())):
        finest = min(c for c, deepest in reach.items() if deepest >= d)
        _, columns = _columns(np.array([d]), np.array([at]), np.array([finest]))
        row.append(MESH_ERROR + 2.0 * scatter + CORRECTION_ERROR * abs(float(columns[0] @ correction)))
    return row


def _short(number: float, digits: int = 6) -> float:
    return float(f"{number:.{digits}g}")


def main(arguments: list[str] | None = None) -> None:
    """Build the files named on the command line (both bases by default)."""
    parser = argparse.ArgumentParser(description="Make the square-over-circle factors by finite elements in space.")
    parser.add_argument("--base", choices=("bonded", "sliding"), action="append")
    parser.add_argument("--count", type=int, default=9, help="ratios a / h")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    for base in options.base or ["bonded", "sliding"]:
        tasks = [(float(ratio), base, corner) for ratio in nodes(FIRST_COUNT) for corner in FIRST_CORNERS]
        tasks += [(float(ratio), base, corner) for ratio in nodes(options.count) for corner in CORNERS]
        answers = []
        with ProcessPoolExecutor(options.workers) as pool:
            for task, answer in zip(tasks, pool.map(solve_one, tasks)):
                answers.append(answer)
                print(f"{base} a/h = {task[0]:.3f} corner {task[2]}: {len(answer.depth)} depths", file=sys.stderr)
        table = content(tasks, answers)
        write_text(options.out / f"square-{base}.json", json.dumps(table) + "\n")
        print(f"square-{base}.json: {table['provenance']}")


if __name__ == "__main__":
    main()
