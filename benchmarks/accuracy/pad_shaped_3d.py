"""Shaped pads in space: a punch that lands beside the apex, and square over round.

    python -m benchmarks.accuracy.pad_shaped_3d offset|square [--cells N] [--only K]

Forces are F / E in mm2 under the 14 x 14 mm punch with a bead of 0.1 of the smaller of half side and thickness
at its edge; what touches sticks. ``offset`` prints each force over the centred one, ``square`` that over the round
punch of equal area on an axisymmetric grid with the same bead.
Work is counted in unknowns and Newton iterations; minutes per curve.
"""

from __future__ import annotations

import argparse

import numpy as np

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_problem import solve_path
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial.shaped_pad import GridFineness, Load, shaped_problem

SHARES = np.array([0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5])
SIDE_MM = 7.0
RADIUS_MM = 14.0 / np.sqrt(np.pi)
CROWNS = ((Crowned(10.0, 2.0), 5.0), (Crowned(3.0, 8.0, 8.0), 15.0))
OFFSETS_MM = (1.0, 2.0, 3.0)


def force(shape: PadShape, thickness_mm: float, offset_mm: float, cells: int) -> np.ndarray:
    """F / E at the depths that are reached, NaN beyond. [mm2]"""
    h = thickness_mm
    load = Load(
        (SIDE_MM / h,) * 2,
        (75.0 / h, 60.0 / h),
        shape=shape,
        thickness_mm=h,
        offset=(offset_mm / h, 0.0),
        first=float(SHARES[0]),
    )
    problem = shaped_problem(load, GridFineness(cells))
    path = follow(problem, SHARES, 0.25 * SHARES[0], 0.05 * load.scale, SHARES[0] / 256.0)
    values = np.full(len(SHARES), np.nan)
    values[: len(path.force)] = load.multiplicity * path.force * h**2 / 3.0
    stop = f"; {path.stop}" if path.stop else ""
    print(f"  {path.unknowns} unknowns, {path.newton_iterations} iterations, {path.seconds:.0f} s{stop}", flush=True)
    return values


def show(name: str, values: np.ndarray) -> None:
    """Print one row."""
    print(f"{name:<34}" + "".join(f"{value:9.4g}" for value in values), flush=True)


def main() -> None:
    """Run one study."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", choices=("offset", "square"))
    parser.add_argument("--cells", type=int, default=5)
    parser.add_argument("--only", type=int, help="number of the pad in the list")
    options = parser.parse_args()
    show("d/h", SHARES)
    for number, (shape, h) in enumerate(CROWNS):
        if options.only not in (None, number):
            continue
        centred = force(shape, h, 0.0, options.cells)
        show(f"{shape}, h {h:g}: F/E", centred)
        if options.study == "square":
            extent = np.sqrt(150.0 * 120.0 / np.pi) / h
            for cells in (8, 16):
                press = Case(RADIUS_MM / h, extent, shape=shape, thickness_mm=h, first=SHARES[0])
                path = solve_path(press, SHARES, cells, 0.1)
                show(f"square over round ({cells} cells)", centred[: len(path.force)] / (path.force * h**2 / 3.0))
        else:
            for offset in OFFSETS_MM:
                show(f"{offset:g} mm off / centred", force(shape, h, offset, options.cells) / centred)


if __name__ == "__main__":
    main()
