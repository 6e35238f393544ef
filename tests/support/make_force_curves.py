"""Direct finite-element curves for the campaign generator: ``python tests/support/make_force_curves.py``.

Round punch of the area of the 14 mm square, glued, neo-Hookean; unit modulus. The response table is not used.
Crowned pads are solved on cells of half the size that a design takes, three quarters of those of the loop.
"""

from __future__ import annotations

import json
import sys
from itertools import product
from pathlib import Path

import numpy as np

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.pad_under_punch import Pad

RADIUS_MM = 14.0 / np.sqrt(np.pi)
SHARES = np.array([0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5])
CASES = [("bonded", 0.5), ("sliding", 0.5), ("bonded", 0.48), ("bonded", 0.46)]
CROWN, CROWN_THICKNESSES, CROWN_CELLS = "crowned:radius=20,height=3,foot=11", (7.0, 10.0, 12.0, 14.0), 32
FILLET_MM = 0.4
CROWN_SHARES = np.r_[0.01, 0.02, 0.035, np.arange(0.05, 0.46, 0.025)]
OUT = Path(__file__).parent / "force_curves.json"
CROWNED = Path(__file__).parent / "crowned_curves.json"


def main() -> None:
    """Solve every case that the file does not hold yet."""
    rows = json.loads(OUT.read_text()) if OUT.exists() else []
    done = {(r["base"], r["poisson"], r["thickness_mm"]) for r in rows}
    for base, poisson in CASES:
        for thickness in (5.0, 15.0, 20.0, 10.0):
            if (base, poisson, thickness) in done:
                continue
            curve = solve_curve(
                Pad(thickness, 1.0, RADIUS_MM, base=base, poisson=poisson, extent_mm=75.7),
                SHARES * thickness,
                independent=True,
            )
            rows.append(
                {
                    "base": base,
                    "poisson": poisson,
                    "thickness_mm": thickness,
                    "depth_mm": [float(f"{d:.6g}") for d in curve.depth_mm],
                    "force_over_young_mm2": [float(f"{f:.6g}") for f in curve.force_N],
                }
            )
            OUT.write_text(json.dumps(rows, indent=1) + "\n")
            print(base, poisson, thickness, len(curve.depth_mm), curve.solver["seconds"], file=sys.stderr, flush=True)


def crowned() -> None:
    """The same for a crown on bases of four thicknesses, under a sharp edge and under a fillet."""
    rows = json.loads(CROWNED.read_text()) if CROWNED.exists() else []
    done = {(row["thickness_mm"], row.get("edge_radius_mm", 0.0)) for row in rows}
    for edge, thickness in product((0.0, FILLET_MM), CROWN_THICKNESSES):
        if (thickness, edge) in done:
            continue
        curve = solve_shaped_pad(
            Pad(thickness, 1.0, RADIUS_MM, extent_mm=75.7, geometry=read_shape(CROWN), edge_radius_mm=edge),
            CROWN_SHARES * thickness,
            cells=CROWN_CELLS,
        )
        own = {"edge_radius_mm": edge} if edge else {}
        rows.append(_crowned_row(thickness, curve.depth_mm, curve.force_N) | own)
        CROWNED.write_text(json.dumps(rows, indent=1) + "\n")
        print("crowned", thickness, len(curve.depth_mm), curve.solver["seconds"], file=sys.stderr, flush=True)


def _crowned_row(thickness, depth, force) -> dict:
    return {
        "base": "bonded",
        "poisson": 0.5,
        "thickness_mm": thickness,
        "depth_mm": [float(f"{d:.6g}") for d in depth],
        "force_over_young_mm2": [float(f"{f:.6g}") for f in force],
    }


if __name__ == "__main__":
    main()
    crowned()
