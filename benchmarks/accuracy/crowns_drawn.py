"""Drawn crowns on cells of half the size, against which the table of crowned pads is held.

    python -m benchmarks.accuracy.crowns_drawn --count 44 --seed 88127 --out FILE.csv

Half of the pads are even in s = R c / b^2, half in ln s (pointed ones). A row has the pad's numbers (punch radius a)
and F / (E a^2) under a sharp edge at each depth over the thickness, empty where the solve did not get to. Ten seconds
of processor time a pad.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from dummydesign.pad.axisymmetric.case import padded
from dummydesign.pad.axisymmetric.shaped_pad import sharp
from dummydesign.pad.axisymmetric.shaped_problem import CELLS, RIMS, climb, meshed
from studies.tables.designs.base import RADIUS_MM
from studies.tables.designs.crowned import DESIGN

Array = np.ndarray
DEPTHS = np.array(
    [0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.33, 0.36, 0.39, 0.42, 0.45, 0.48, 0.51]
    + [0.54, 0.57, 0.6]
)
NUMBERS = ("h_over_a", "c_over_h", "b_over_a", "s")
DRAWN = 4000


def points(seed: int, count: int) -> list[Array]:
    """Castable pads inside the table's ranges."""
    rng, inside = np.random.default_rng(seed), 2.0 * DESIGN.margin
    low, high = DESIGN.low + inside, DESIGN.high - inside
    drawn = rng.uniform(low, high, (DRAWN, len(low)))
    pointed = rng.uniform(size=DRAWN) < 0.5
    share = (drawn[pointed, 3] - low[3]) / (high[3] - low[3])
    drawn[pointed, 3] = low[3] * (high[3] / low[3]) ** share
    return [point for point in drawn if DESIGN.castable(point)][:count]


def force(point: Array) -> Array:
    """F / (E a^2) at ``DEPTHS``, NaN where the solve did not get to."""
    case = meshed(DESIGN.press(point))
    small = climb(case, DEPTHS[-1], 2 * CELLS, RIMS[1])
    large = climb(case, DEPTHS[-1], 2 * CELLS, RIMS[0], smaller=small)
    best, _ = sharp(*(padded(path.at(DEPTHS), len(DEPTHS)) for path in (large, small)))
    return best / 3.0 * (case.thickness_mm / RADIUS_MM) ** 2


def rows(seed: int, count: int) -> Iterator[list[str]]:
    """A row a pad."""
    for point in points(seed, count):
        yield [str(seed), *(f"{x:.7g}" for x in DESIGN.plain(point))] + [
            f"{x:.6g}" if np.isfinite(x) else "" for x in force(point)
        ]


def main() -> None:
    """Solve the pads and write them, row by row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=44)
    parser.add_argument("--seed", type=int, default=88127)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    with options.out.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["seed", *NUMBERS, *(f"{depth:g}" for depth in DEPTHS)])
        for row in rows(options.seed, options.count):
            writer.writerow(row)
            file.flush()


if __name__ == "__main__":
    main()
