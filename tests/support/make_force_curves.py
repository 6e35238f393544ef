"""Direct finite-element curves for the campaign generator: ``python tests/support/make_force_curves.py``.

Round punch of the area of the 14 mm square, glued, neo-Hookean; unit modulus. The response table is not used.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from dummydesign.pad.slab.sharp_edge import solve_curve

RADIUS_MM = 14.0 / np.sqrt(np.pi)
SHARES = np.array([0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5])
CASES = [("bonded", 0.5), ("sliding", 0.5), ("bonded", 0.48), ("bonded", 0.46)]
OUT = Path(__file__).parent / "force_curves.json"


def main() -> None:
    """Solve every case that the file does not hold yet."""
    rows = json.loads(OUT.read_text()) if OUT.exists() else []
    done = {(r["base"], r["poisson"], r["thickness_mm"]) for r in rows}
    for base, poisson in CASES:
        for thickness in (5.0, 15.0, 20.0, 10.0):
            if (base, poisson, thickness) in done:
                continue
            curve = solve_curve(
                thickness, RADIUS_MM, 1.0, SHARES * thickness, base=base, poisson=poisson, extent_mm=75.7
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


if __name__ == "__main__":
    main()
