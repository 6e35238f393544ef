"""Cost of the pad model: work counted, and times as ratios within one run.

Run with ``python -m benchmarks.speed.pad``; seconds are processor time. The axisymmetric curve has 12 depths to d / h =
0.5, for thin to thick pads, with three rims and the table's correction and with six rims alone; the table is timed
against it in the same process. Then the same depths under a punch with a fillet of 0.5 mm, and of the forefinger's
crowned pad.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from itertools import product

import numpy as np

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_table

RADIUS_MM = PUNCH_RADIUS_MM
SHARES = np.linspace(0.5 / 12, 0.5, 12)
FILLET_MM = 0.5
CROWN, CROWN_MM = Crowned(21.2, 2.0, 9.4), 4.5


def main() -> None:
    """Print one row per pad."""
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    table = load_table()
    print("thickness_mm  rims  unknowns  load_steps  newton_iterations  seconds  table_speed_up  largest_difference_%")
    for thickness, rims in product((5.0, 10.0, 15.0, 20.0), (3, 6)):
        depth = thickness * SHARES
        began = time.process_time()
        solved = solve_curve(Pad(thickness, 0.025, RADIUS_MM), depth, independent=rims == 6)
        seconds = time.process_time() - began
        began = time.process_time()
        for _ in range(100):
            force = table.force(solved.depth_mm, thickness, 0.025, RADIUS_MM)
        quick = (time.process_time() - began) / 100
        work = solved.solver
        off = 100 * np.abs(force / solved.force_N - 1).max()
        print(
            f"{thickness:12.1f}  {rims:4d}  {work['unknowns']:8d}  {work['load_steps']:10d}"
            f"  {work['newton_iterations']:17d}  {seconds:7.2f}  {seconds / quick:14.0f}  {off:20.2f}"
        )
    print("pad                      seconds  newton_iterations_a_depth")
    for thickness in (5.0, 10.0, 20.0):
        depth = thickness * SHARES
        pad = Pad(thickness, 0.025, RADIUS_MM, edge_radius_mm=FILLET_MM)
        _row(f"{thickness:g} mm, fillet {FILLET_MM:g} mm", partial(solve_under_fillet, pad, depth))
    _row(
        f"{CROWN_MM:g} mm, crowned",
        lambda: solve_shaped_pad(Pad(CROWN_MM, 0.025, RADIUS_MM, geometry=CROWN), CROWN_MM * SHARES),
    )


def _row(name: str, solve: Callable[[], PadCurve]) -> None:
    began = time.process_time()
    solved = solve()
    each = solved.solver["newton_iterations"] / len(solved.depth_mm)
    print(f"{name:<25}{time.process_time() - began:7.2f}  {each:25.1f}")


if __name__ == "__main__":
    main()
