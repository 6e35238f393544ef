"""The files of docs/from-machine-to-design.md, simulated: exports of a finger's presses and of a puck. Seeded.

``python -m tests.support.walkthrough_files DIR`` writes ``exports/finger_*.txt`` (a German test machine, force negative
in compression, tare, lead-in) and ``puck.csv`` (one slow loading of a puck of 50 x 30 mm).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from benchmarks.fit_coverage import press
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.specimen import Puck

GAMMA1, GAMMA, DAMPER = 0.55, np.array([0.10, 0.25]), {10.0: np.array([1.0, 0.12]), 250.0: np.array([1.0, 0.012])}
"""A finger within the forefinger's band. [N/mm3, N/mm3, N s/mm by speed]"""
YOUNG_KPA = 31.0


def write(folder: Path, seed: int = 11) -> None:
    """Write the files."""
    draw = np.random.default_rng(seed)
    (folder / "exports").mkdir(parents=True, exist_ok=True)
    for speed in (10.0, 250.0):
        for force in (4.0, 8.0, 14.0):
            truth = np.r_[GAMMA1, GAMMA, DAMPER[speed]]
            made = press(speed, np.cbrt(force / GAMMA1), truth=truth)
            lead = np.arange(-0.3, made.time_s[0] - 5e-4, 1e-3)
            time = np.r_[lead, made.time_s]
            x = np.r_[np.full(len(lead), made.displacement_mm[0]), made.displacement_mm]
            load = np.r_[np.zeros(len(lead)), made.force_N] + 0.35 + draw.normal(0.0, 0.02, len(time))
            text = ["Prüfprotokoll;Finger links", "Zeit [s];Traversenweg [mm];Kraft [N]"]
            rows = (f"{t - time[0]:.4f};{d:.4f};{-f:.4f}".replace(".", ",") for t, d, f in zip(time, x, load))
            name = folder / "exports" / f"finger_v{speed:03.0f}_f{force:02.0f}.txt"
            name.write_text("\n".join([*text, *rows]) + "\n", encoding="cp1252")
    depth = np.linspace(0.5, 13.0, 14)
    solved = solve_puck(Puck(30.0, YOUNG_KPA * 1e-3, 50.0, plates="friction:0.3", law=Yeoh(1.0)), depth)
    place, load = np.r_[0.0, solved.depth_mm], np.r_[0.0, solved.force_N]
    x = np.linspace(0.0, place[-1], 500)
    force = np.interp(x, place, load) + draw.normal(0.0, 0.02, len(x))
    rows = np.column_stack([x / 0.5, x, force])
    np.savetxt(folder / "puck.csv", rows, "%.5f", ",", header="time_s,displacement_mm,force_N", comments="")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
