"""Build the table of compressible slabs: ``python -m studies.tables.compressibility``."""

from __future__ import annotations

import argparse

import numpy as np

from dummydesign.core.user_library import data_folder
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import NAME
from studies.tables.common import Build, write_table

POISSON = 0.48
RATIOS = (0.28, 0.395, 0.527, 0.79, 1.1, 1.58, 2.2, 2.6)
DEPTHS = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5)


def build() -> dict[str, object]:
    """Solve the compressible and the incompressible slab at all nodes."""
    rows = []
    for ratio in RATIOS:
        soft, hard = (
            solve_curve(Pad(1.0, 1.0, ratio, poisson=poisson, extent_mm=ratio + 8.0), DEPTHS, independent=True)
            for poisson in (POISSON, 0.5)
        )
        both, at, under = np.intersect1d(np.round(soft.depth_mm, 6), np.round(hard.depth_mm, 6), return_indices=True)
        row = (hard.force_N[under] / soft.force_N[at] - 1.0) / (1.0 - 2.0 * POISSON)
        rows.append([float(f"{c:.5g}") for c in np.interp(DEPTHS, both, row)])
    return {
        "meaning": "F(nu) / F(1/2) = 1 / (1 + (1 - 2 nu) coefficient[a/h][d/h]); equal E, glued punch and base",
        "ratio": list(RATIOS),
        "depth": list(DEPTHS),
        "values": rows,
        "provenance": {"poisson": POISSON},
    }


def main(arguments: list[str] | None = None) -> None:
    """Solve and write the table."""
    parser = argparse.ArgumentParser(prog="python -m studies.tables.compressibility", description=__doc__)
    parser.parse_args(arguments)
    run = Build.begin("studies.tables.compressibility", arguments)
    write_table(data_folder() / "materials" / "tables" / NAME, build(), run)


if __name__ == "__main__":
    main()
