"""Force curves by GetFEM for the loop's other generator.

    python -m benchmarks.accuracy.independent_generator_curves --out FILE

A filleted round punch on slabs, glued or on a smooth base, incompressible or not; F / E over depth in mm2, from the
program of :mod:`benchmarks.accuracy.pad_getfem` (contact by a penalty, sticking). The package takes no part.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from benchmarks.accuracy import pad_getfem as getfem
from dummydesign.core.files import write_text
from dummydesign.pad.pad_under_punch import Pad

THICKNESSES_MM = (6.0, 10.0, 12.0, 16.0)
DEEPEST, POINTS = 0.42, 21
CELL_MM, STEPS, AGREED = 0.15, (0.01, 0.005), 0.01
GLUED = 'model.add_Dirichlet_condition_with_simplification("u", 1)'
SMOOTH = (
    'model.add_initialized_data("upright", np.array([[0.0, 0.0], [0.0, 1.0]]))\n'
    'model.add_initialized_data("rest", [0.0, 0.0])\n'
    'model.add_generalized_Dirichlet_condition_with_multipliers(rule, "u", u, 1, "rest", "upright")'
)
CASES = (("bonded", 0.5), ("sliding", 0.5), ("bonded", 0.47))


def limit_N(python: str, pad: Pad, depth_mm: np.ndarray) -> list[float]:
    """Forces with the load step taken to nothing, as deep as both steps came; the penalty that came deepest."""
    deepest: list[float] = []
    for penalty in getfem.PENALTIES:
        coarse, fine = (
            getfem.theirs(python, pad, depth_mm, step * pad.thickness_mm, CELL_MM, penalty).get("force", [])
            for step in STEPS
        )
        same = [abs(b / a - 1.0) < AGREED for a, b in zip(coarse, fine)]
        # a path that ends in another state than the press: what comes after is not of it
        good = same.index(False) if False in same else len(same)
        limit = [2.0 * b - a for a, b in zip(coarse[:good], fine)]
        deepest = max(deepest, limit, key=len)
        if len(deepest) == len(depth_mm):
            break
    return deepest


def main() -> None:
    """Solve every case and write the curves."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default="/usr/bin/python3", help="a Python that has GetFEM")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    glued, rows = getfem.PROGRAM, []
    for base, poisson in CASES:
        getfem.PROGRAM = glued if base == "bonded" else glued.replace(GLUED, SMOOTH)
        if poisson < 0.5:
            getfem.BULK_OVER_SHEAR = 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson))
        for thickness in THICKNESSES_MM:
            pad = Pad(thickness, getfem.YOUNG_MPA, getfem.RADIUS_MM, edge_radius_mm=getfem.FILLET_MM)
            depth = thickness * DEEPEST * (np.arange(1, POINTS + 1) / POINTS) ** 1.5
            solved = limit_N(options.python, pad, depth)
            # the program's modulus is 3 mu, whatever Poisson's ratio
            over = 3.0 / (2.0 * (1.0 + poisson)) / getfem.YOUNG_MPA
            force = [round(over * value, 5) for value in solved]
            kept = [round(float(one), 5) for one in depth[: len(force)]]
            print(base, poisson, thickness, f"to d/h {kept[-1] / thickness if kept else 0:.3f}", flush=True)
            rows.append(
                {
                    "base": base,
                    "poisson": poisson,
                    "thickness_mm": thickness,
                    "depth_mm": kept,
                    "force_over_young_mm2": force,
                }
            )
            write_text(options.out, json.dumps(rows, indent=0) + "\n")


if __name__ == "__main__":
    main()
