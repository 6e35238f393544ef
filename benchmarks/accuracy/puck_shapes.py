"""Error of the puck tables of proportions that were not solved, against solves made now.

``python -m benchmarks.accuracy.puck_shapes`` goes half-way (in the logarithm) between the solved proportions, where the
interpolation is worst, and to one shape of a standard (29 x 12.5 mm); alpha lies between its grid too.
``--drawn 12`` draws proportion, alpha and friction at random over the whole table instead.
``--csv FILE`` keeps the first table (docs/data/puck-shapes.csv).
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np

from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import grip, load_shapes, table_for, uniaxial
from studies.tables.puck import SHAPE_STEP

COMPRESSION = np.array([0.02, 0.1, 0.2, 0.3, 0.4, 0.5])


def error(diameter_over_height, alpha, plates):
    """Relative error of the force at those of COMPRESSION that both reach."""
    table = table_for(diameter_over_height, 1.0)
    friction = np.inf if plates == "bonded" else float(plates.partition(":")[2])
    wanted = COMPRESSION[COMPRESSION <= table.compression[-1]]
    law = Ogden([2.0 / alpha], [alpha])
    curve = solve_puck(Puck(1.0, 3.0, diameter_over_height, plates=plates, law=law), wanted)
    area = 0.25 * np.pi * diameter_over_height**2
    free = 3.0 * area * uniaxial(alpha, curve.depth_mm)
    return free * table.factor(alpha, float(grip(friction)), curve.depth_mm) / curve.force_N - 1.0


def drawn(count, seed):
    """Print the errors at random places of the table."""
    rng = np.random.default_rng(seed)
    low, high = (2.0 * table.radius_over_height for table in (load_shapes()[0], load_shapes()[-1]))
    print("diameter_over_height,alpha,friction,compressed_to,error_to_0.2_percent,error_percent")
    for _ in range(count):
        shape, alpha = np.exp(rng.uniform(*np.log([low, high]))), rng.uniform(1.0, 6.0)
        friction = np.exp(rng.uniform(*np.log([0.05, 0.7])))
        percent = 100.0 * np.abs(error(shape, alpha, f"friction:{friction:.3g}"))
        end = COMPRESSION[len(percent) - 1]
        print(f"{shape:.2f},{alpha:.2f},{friction:.3g},{end:g},{percent[:3].max():.2f},{percent.max():.2f}", flush=True)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--drawn", type=int, default=0, help="this many random places instead")
    parser.add_argument("--seed", type=int, default=1, help="of the random places")
    parser.add_argument("--csv", type=Path, help="file of the table")
    options = parser.parse_args()
    heads = ("error_friction_0.08_percent", "error_friction_0.25_percent", "error_bonded_percent")
    rows: list[tuple[str, ...]] = [("diameter_over_height", *heads, "compressed_to")]
    if options.drawn:
        drawn(options.drawn, options.seed)
        return
    shapes = [2.0 * table.radius_over_height * SHAPE_STEP**0.5 for table in load_shapes()[:-1]]
    print("| diameter / height | " + " | ".join(("friction 0.08", "friction 0.25", "bonded")) + " | solved to |")
    print("|---|---|---|---|---|")
    for shape in [*shapes, 29.0 / 12.5]:
        words, end = [], 0.0
        for plates in ("friction:0.08", "friction:0.25", "bonded"):
            errors = [error(shape, alpha, plates) for alpha in (1.5, 3.5)]
            words.append(f"{100 * max(np.max(np.abs(one)) for one in errors):.2f} %")
            end = COMPRESSION[min(len(one) for one in errors) - 1]
        print(f"| {shape:.3f} | " + " | ".join(words) + f" | {end:g} |", flush=True)
        rows.append((f"{shape:.3f}", *(word.removesuffix(" %") for word in words), f"{end:g}"))
    if options.csv:
        with options.csv.open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
