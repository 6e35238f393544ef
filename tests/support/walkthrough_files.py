"""The files of docs/from-machine-to-design.md, simulated: exports of a finger, presses of a puck and of a pad. Seeded.

``python -m tests.support.walkthrough_files DIR`` writes ``exports/finger_*.txt`` (a German test machine, force negative
in compression, tare, lead-in), ``puck.csv`` (one slow loading of a puck of 50 x 30 mm), ``puck50x30-v*.csv`` (the same
size by its protocol, of a batch that is stiffer and relaxes more than the resin's file says) and ``pad/*.csv`` (the pad
of that batch that the page recommends).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from benchmarks.accuracy.fit_coverage import press
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Puck

GAMMA1, GAMMA, DAMPER = 0.55, np.array([0.10, 0.25]), {10.0: np.array([1.0, 0.12]), 250.0: np.array([1.0, 0.012])}
"""A finger within the forefinger's band. [N/mm3, N/mm3, N s/mm by speed]"""
YOUNG_KPA = 31.0
BATCH_YOUNG, BATCH_RELAXATION = 1.35, 1.15
"""Modulus and strengths of the batch over those of the paper's polyurethane."""
PUCK_RATIO, PAD = 15.4, ("crowned:radius=2.4,height=3.5,foot=7.8", 11.0, 15.3)
"""Ratio of the puck; shape, thickness and ratio of the pad on the page."""


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
    _write_puck(folder, draw)
    _write_pad(folder / "pad", draw)


def _batch(ratio: float) -> tuple[float, list[tuple[float, float]]]:
    """Modulus [kPa] and arms of the batch at a ratio."""
    from dummydesign.resin import load_resin

    resin = load_resin()
    arms = [(term.tau_s, BATCH_RELAXATION * term.beta) for term in resin.prony(ratio)]
    return BATCH_YOUNG * 1e3 * float(resin.young_MPa(ratio)), arms


def _write_puck(folder: Path, draw: np.random.Generator) -> None:
    young_kPa, arms = _batch(PUCK_RATIO)
    depth = np.r_[0.05, 0.3, np.arange(1.0, 9.51, 0.85)]
    solved = solve_puck(Puck(30.0, young_kPa * 1e-3, 50.0, plates="friction:0.02", law=Yeoh(1.0)), depth)
    for speed in (10.0, 50.0):
        time = np.arange(0.0, 0.1 + 9.0 / speed + 10.2, 1e-3)
        x = np.clip((time - 0.1) * speed, -1.0, 9.0)
        elastic = np.interp(np.maximum(x, 0.0), np.r_[0.0, solved.depth_mm], np.r_[0.0, solved.force_N])
        force = elastic + sum(_arm(time, elastic, tau, beta) for tau, beta in arms)
        rows = np.column_stack([time, x, force + draw.normal(0.0, 0.02, len(time))])
        np.savetxt(
            folder / f"puck50x30-v{speed:g}.csv",
            rows,
            "%.5f",
            ",",
            header="time_s,displacement_mm,force_N",
            comments="",
        )


def _arm(time: np.ndarray, elastic: np.ndarray, tau: float, beta: float) -> np.ndarray:
    """Force of one arm: what rises within a step relaxes for half of it."""
    step, held, out = float(time[1] - time[0]), 0.0, np.zeros_like(elastic)
    for at in range(1, len(time)):
        held = held * np.exp(-step / tau) + beta * (elastic[at] - elastic[at - 1]) * np.exp(-0.5 * step / tau)
        out[at] = held
    return out


def _write_pad(folder: Path, draw: np.random.Generator) -> None:
    import dummydesign

    folder.mkdir(exist_ok=True)
    shape, thickness, ratio = PAD
    young_kPa, arms = _batch(ratio)
    prony = ",".join(f"{tau:g}:{beta:.5g}" for tau, beta in arms)
    for speed in (10.0, 250.0):
        for force in (5.0, 10.0, 15.0):
            file = folder / f"pad_v{speed:03.0f}_f{force:02.0f}.csv"
            dummydesign.predict(
                thickness,
                young_kPa=young_kPa,
                shape=shape,
                prony=prony,
                force_N=force,
                velocity_mm_s=speed,
                rate_Hz=2000.0,
                out=file,
            )
            made = np.loadtxt(file, delimiter=",", skiprows=1)[:, :3].T
            lead = np.arange(-0.1, -2.5e-4, 5e-4)
            force = np.r_[0.0 * lead, made[2]] + draw.normal(0.0, 0.02, len(lead) + len(made[0]))
            rows = np.column_stack([np.r_[lead, made[0]] + 0.1, np.r_[lead * speed, made[1]], force])
            np.savetxt(file, rows, "%.5f", ",", header="time_s,displacement_mm,force_N", comments="")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
