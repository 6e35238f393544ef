"""Make the response tables from axisymmetric finite elements: ``python -m dummydesign.pad.build_table``.

One curve per a / h at Chebyshev nodes in ln(a / h), to d / h = 0.6 or as far as the elements stay sound;
a least-squares Chebyshev series through all points; its misfit goes into the stated error.
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
from dummydesign.pad.axisymmetric import Ladder, Slab, first_stiffness, ladder
from dummydesign.pad.laws import Yeoh
from dummydesign.pad.mesh import Resolution

RATIO_RANGE = (0.25, 2.7)
DEPTHS = np.concatenate([[0.01, 0.02, 0.03, 0.04], np.arange(0.05, 0.6001, 0.025)])
# Outer over punch radius: the 150 x 120 mm slab and the 14 mm square punch, each as the circle of equal area.
EXTENT_OVER_RADIUS = float(np.sqrt(150.0 * 120.0) / 14.0)
TERMS = (10, 9)


def solve_ratio(task: tuple[float, str]) -> tuple[float, Ladder, float]:
    """Solve one curve; return a / h, the ladder's answer and the stiffness at first touch."""
    ratio, base = task
    slab = Slab(ratio, EXTENT_OVER_RADIUS * ratio, base)
    law = Yeoh(1.0)
    return ratio, ladder(slab, law, 0.5, DEPTHS, Resolution()), first_stiffness(slab, law)


def nodes(count: int) -> np.ndarray:
    """Chebyshev nodes in ln(a / h), ends included, in increasing order."""
    low, high = np.log(RATIO_RANGE)
    return np.exp(low + (high - low) * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2.0)


def fit(solved: list[tuple[float, Ladder, float]], base: str) -> dict[str, Any]:
    """Fit the series to the curves and state its errors; return what goes into the file."""
    low, high = np.log(RATIO_RANGE)
    x, v, y, weight = [], [], [], []
    for ratio, curve, first in solved:
        x += [0.0, *curve.depth]
        v += [2.0 * (np.log(ratio) - low) / (high - low) - 1.0] * (len(curve.depth) + 1)
        y += [np.log(first), *np.log(curve.stiffness)]
        weight += [1e3, *(curve.stiffness / curve.error)]
    u = 2.0 * np.array(x) / DEPTHS[-1] - 1.0
    matrix = np.polynomial.chebyshev.chebvander2d(u, np.array(v), [TERMS[0] - 1, TERMS[1] - 1])
    w = np.sqrt(np.array(weight))
    # A touch of smoothing on high orders: the ladder's own scatter is about 0.1 %.
    order = np.add.outer(np.arange(TERMS[0]), np.arange(TERMS[1])).ravel()
    damping = 1e-3 * 2.0**order * np.sqrt(len(w)) * 1e-2
    stacked = np.concatenate([matrix * w[:, None], np.diag(damping)])
    solution, *_ = np.linalg.lstsq(stacked, np.concatenate([np.array(y) * w, np.zeros(len(order))]), rcond=None)
    misfit = np.abs(np.exp(matrix @ solution - np.array(y)) - 1.0)
    grid, start = [], 0
    for _, curve, _first in solved:
        part = misfit[start : start + len(curve.depth) + 1]
        own = np.concatenate([[1e-3], curve.error / curve.stiffness])
        total = np.interp(np.concatenate([[0.0], DEPTHS]), [0.0, *curve.depth], own + part)
        grid.append(total)
        start += len(curve.depth) + 1
    return {
        "base": base,
        "meaning": "ln(F / (E a d)) = Chebyshev series in d/h and ln(a/h); E long-term, a punch radius, glued punch",
        "coefficients": [[float(f"{c:.9g}") for c in row] for row in solution.reshape(TERMS)],
        "ratio_range": list(RATIO_RANGE),
        "depth_range": [0.0, float(DEPTHS[-1])],
        "limit_ratio": [float(f"{r:.6g}") for r, _, _ in solved],
        "limit_depth": [float(f"{c.depth[-1]:.6g}") for _, c, _ in solved],
        "error_ratio": [float(f"{r:.6g}") for r, _, _ in solved],
        "error_depth": [0.0, *(float(f"{d:.6g}") for d in DEPTHS)],
        "error": [[float(f"{e:.3g}") for e in row] for row in grid],
        "provenance": {
            "command": "python -m dummydesign.pad.build_table",
            "version": __version__,
            "law": "neo-Hookean, incompressible",
            "punch": "round, flat, glued, sharp edge as the limit of a small rim",
            "extent_over_radius": EXTENT_OVER_RADIUS,
            "curves": len(solved),
            "largest_interpolation_error": float(f"{misfit.max():.3g}"),
            "rms_interpolation_error": float(f"{np.sqrt((misfit**2).mean()):.3g}"),
        },
        "curves": [
            {
                "ratio": float(f"{r:.9g}"),
                "first": float(f"{f:.8g}"),
                "depth": [float(f"{d:.6g}") for d in c.depth],
                "stiffness": [float(f"{s:.7g}") for s in c.stiffness],
                "error": [float(f"{e:.3g}") for e in c.error],
            }
            for r, c, f in solved
        ],
    }


def main(arguments: list[str] | None = None) -> None:
    """Build the tables named on the command line (both by default)."""
    parser = argparse.ArgumentParser(description="Make the response tables by finite elements.")
    parser.add_argument("--base", choices=("bonded", "sliding"), action="append")
    parser.add_argument("--count", type=int, default=14, help="curves, one per a / h")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    for base in options.base or ["bonded", "sliding"]:
        tasks = [(float(ratio), base) for ratio in nodes(options.count)]
        with ProcessPoolExecutor(options.workers) as pool:
            solved = []
            for answer in pool.map(solve_ratio, tasks):
                solved.append(answer)
                reached = answer[1].depth[-1]
                print(f"{base} a/h = {answer[0]:.3f} to d/h = {reached:.3f}", file=sys.stderr, flush=True)
        content = fit(solved, base)
        write_text(options.out / f"slab-{base}.json", json.dumps(content, indent=1) + "\n")
        print(f"slab-{base}.json: {content['provenance']}")


if __name__ == "__main__":
    main()
