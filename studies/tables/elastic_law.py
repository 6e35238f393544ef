"""Build the table of pads of another elastic law than neo-Hookean: ``python -m studies.tables.elastic_law``.

One-term Ogden pads of one modulus under a round punch, glued to punch and base, are solved at several exponents on the
same cells; kept is ln of the force over that at exponent 2. Slabs are tabulated over a / h and d / h, crowned pads are
solved at a few proportions that designs take, to see how far they are from the slab.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from dummydesign.core.user_library import data_folder
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import make_shape
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import SLAB, Pad
from studies.tables.common import Build, write_table

NAME = "elastic-law.json"
ALPHAS = (1.0, 2.0, 3.5, 6.0)
RATIOS = (0.4, 0.65, 1.0, 1.6, 2.6)
DEPTHS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
RADIUS_MM = 7.9
CROWNS = ((4.5, (21.2, 2.0, 9.4)), (7.0, (9.0, 3.0, 9.0)), (10.0, (2.6, 3.2, 7.8)), (10.5, (3.6, 4.6, 9.4)))
"""Thickness, and apex radius, height and foot radius of crowns. [mm]"""
CROWN_DEPTHS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5)


def log_factors(thickness_mm: float, radius_mm: float, shape: PadShape, depths: tuple[float, ...]) -> list[list[Any]]:
    """ln of the force over that at alpha = 2 by exponent and d / h; None where a solve ended before."""
    solved = []
    for alpha in ALPHAS:
        law = Ogden([2.0 / alpha], [alpha])
        pad = Pad(thickness_mm, 1.0, radius_mm, law=law, geometry=shape)
        force = solve_points(pad, thickness_mm * np.array(depths)).force_N
        solved.append(np.pad(force, (0, len(depths) - len(force)), constant_values=np.nan))
        print(f"{shape} {thickness_mm:g} mm, alpha {alpha:g}: {len(force)} depths", flush=True)
    rows = np.log(np.array(solved) / solved[ALPHAS.index(2.0)])
    return [[None if np.isnan(value) else round(float(value), 5) for value in row] for row in rows]


def build() -> dict[str, object]:
    """Solve slabs and crowns at all exponents."""
    slabs, crowns = [log_factors(RADIUS_MM / ratio, RADIUS_MM, SLAB, DEPTHS) for ratio in RATIOS], []
    for thickness, (tip, height, foot) in CROWNS:
        shape = make_shape("crowned", [("radius", tip), ("height", height), ("foot", foot)])
        rows = log_factors(thickness, RADIUS_MM, shape, CROWN_DEPTHS)
        crowns.append({"shape": str(shape), "thickness_mm": thickness, "radius_mm": RADIUS_MM, "log_factor": rows})
    return {
        "meaning": "ln F(alpha) / F(2) of one-term Ogden pads of one modulus; [a/h][alpha][d/h], crowns [alpha][d/h]",
        "alpha": list(ALPHAS),
        "ratio": list(RATIOS),
        "depth": list(DEPTHS),
        "log_factor": slabs,
        "crown_depth": list(CROWN_DEPTHS),
        "crowns": crowns,
    }


def main(arguments: list[str] | None = None) -> None:
    """Solve and write the table."""
    parser = argparse.ArgumentParser(prog="python -m studies.tables.elastic_law", description=__doc__)
    parser.parse_args(arguments)
    run = Build.begin("studies.tables.elastic_law", arguments)
    write_table(data_folder() / "materials" / "tables" / NAME, build(), run)


if __name__ == "__main__":
    main()
