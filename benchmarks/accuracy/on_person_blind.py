"""Blind check of `on-person`: does the 95 % interval hold what the press is on a person nobody measured?

Every case makes a population of people, measures a few of them with errors, and presses a pad with a robot of one of
the five drives, by equations and an integrator (scipy's LSODA) that share no code with the package. Arms with a spring
are there without damping and, as "damped", with a declared damping ratio of 0.01 to 0.1. The trace gets noise in
both columns, an error of contact, a sampling rate, and in every third case a declared sensor filter. One more person of
the population is pressed by the same robot; the interval must hold that person in 95 % of cases.

    python -m benchmarks.accuracy.on_person_blind [--cases 240] [--seed 8801] [--drives steady,force] [--out FILE.csv]
"""

from __future__ import annotations

import argparse
import csv
import time
from collections import defaultdict
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.quantity import Quantity
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.person import on_person as module
from dummydesign.person.drives import read_drive
from dummydesign.person.drives.drive import FOUR
from dummydesign.person.on_person import on_person
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.maxwell_law import speed_key
from dummydesign.tissue.model.subject import Subject, nest
from dummydesign.tissue.model.tissue import Tissue
from tests.support.robot_presses import (
    Run,
    by_mass,
    by_path,
    by_robot,
    command,
    gel_pad,
    sampled,
    skin,
    skin_by_force,
)

DRIVES = ("position", "steady", "force", "mass", "spring", "damped")
METHOD = "LSODA"
CONTACT_MM = 0.01
TRIVIAL = {
    ("position", "depth_mm"),
    ("steady", "steady_N"),
    ("force", "peak_N"),
    ("force", "steady_N"),
    ("mass", "energy_mJ"),
}
"""What the drive itself prescribes: the interval there is that of the trace alone."""


def population(rng: np.random.Generator, velocity: float) -> tuple[Tissue, np.ndarray]:
    """Subjects as they were measured, and ln gamma1, gamma2, gamma3, c2, c3 of one more person."""
    start = load_tissue(str(rng.choice(["forefinger", "palm", "thenar"])))
    average = start.target()
    middle = np.log([average.gamma1_N_per_mm3, *average.gamma_N_per_mm3, *average.dampers_at(velocity)])
    middle = middle + rng.normal(0.0, 0.2, 5)
    spread = rng.uniform(0.1, 0.35) * np.array([1.0, 1.0, 1.0, 1.2, 1.2])
    mixed = 0.6 * np.ones((5, 5)) + 0.4 * np.eye(5)
    root = np.linalg.cholesky(mixed) * spread[:, None]
    count = int(rng.integers(4, 10))
    true = middle + rng.standard_normal((count + 1, 5)) @ root.T
    error = rng.uniform(0.1, 0.3) * spread
    measured = true[:-1] + error * rng.standard_normal((count, 5))
    names = ["gamma1_N_per_mm3", "gamma2_N_per_mm3", "gamma3_N_per_mm3", "c2_N_s_per_mm", "c3_N_s_per_mm"]
    subjects = []
    for number, row in enumerate(measured):
        numbers = {}
        for name, value, sd in zip(names, row, error):
            middle_value, low, high = np.exp(value + 1.96 * sd * np.array([0.0, -1.0, 1.0])).tolist()
            speed = speed_key(velocity) if name[0] == "c" else ""
            numbers[name, speed] = Quantity(middle_value, low, high, "fitted", "blind")
        subjects.append(Subject.of(f"subject-{number + 1}", "ode", nest(numbers)))
    return replace(start, name="blind", subjects=tuple(subjects), origin="file"), true[-1]


def case(number: int, seed: int) -> tuple[str, dict[str, tuple[float, float, float]], str]:
    """Drive, truth with the ends of its interval by quantity, and words on the case."""
    rng = np.random.default_rng([seed, number])
    drive = DRIVES[number % len(DRIVES)]
    velocity = float(np.exp(rng.uniform(np.log(10.0), np.log(250.0))))
    velocity = float(f"{velocity:.2g}")
    tissue, hidden = population(rng, velocity)
    values = np.exp(hidden)
    person = skin(values[0], values[1:3], values[3:])
    scale = (10.0 / values[0]) ** (1.0 / 3.0)
    pad = gel_pad(
        rng.uniform(0.7, 1.3) * 9.0 / scale**1.35, rng.uniform(1.2, 1.7), rng.uniform(0.2, 0.8), rng.uniform(0.05, 0.4)
    )
    depth, hold = rng.uniform(0.8, 1.1) * scale, rng.uniform(1.0, 2.0)
    rounding = max(velocity / (4.0 * rng.uniform(5e3, 30e3)), 2e-4)
    path, speed, end = command(velocity, depth, hold, rounding)
    begin = -0.5 / velocity
    text, mass, stiffness, ratio = drive, 0.0, 0.0, 0.0
    if drive in ("mass", "spring", "damped"):
        mass = float(f"{2.0 * 5e-3 * scale / (velocity * 1e-3) ** 2 * rng.uniform(0.5, 1.5):.3g}")
    if drive in ("spring", "damped"):
        stiffness, mass = float(f"{rng.uniform(15.0, 100.0):.3g}"), float(f"{rng.uniform(0.1, 0.5):.3g}")
        text = f"spring:{stiffness}N/mm,{mass}kg"
        if drive == "damped":
            ratio = float(f"{rng.uniform(0.01, 0.1):.3g}")
            text += f",{ratio}"
        run = by_robot(pad, path, speed, end, begin, stiffness, mass, 12001, ratio=ratio, method=METHOD)
    elif drive == "mass":
        text = f"mass:{mass}kg"
        hit = by_mass(pad, velocity, mass, 6001, 0.4)
        lead = np.linspace(begin, 0.0, 500)[:-1]
        run = Run(np.r_[lead, hit.t], np.r_[velocity * lead, hit.x], np.r_[0.0 * lead, hit.f])
    else:
        run = by_path(pad, path, speed, end, begin, 12001, method=METHOD)
    passed = Lowpass(float(rng.uniform(50.0, 150.0)), 2, 1) if number % 3 == 0 else None
    rate = float(rng.choice([1000.0, 2000.0]) if velocity < 60 else rng.choice([2000.0, 5000.0]))
    trace = sampled(
        run,
        rate,
        rng.uniform(0.005, 0.03),
        rng.uniform(0.0005, 0.002),
        int(rng.integers(1 << 30)),
        f"case-{number}",
        passed,
    )
    trace = Trace(trace.name, trace.time_s, trace.displacement_mm + CONTACT_MM * rng.standard_normal(), trace.force_N)
    truth = truth_of(
        drive, person, values, run, (path, speed, end, begin, hold, rounding), velocity, mass, stiffness, ratio
    )
    answer = on_person([trace], tissue, read_drive(text), lowpass=passed)
    interval = answer.presses[0].interval
    rows = {}
    for name in FOUR:
        low, high = interval[name]
        if low is not None and high is not None and np.isfinite(truth[name]):
            rows[name] = (truth[name], low, high)
    return drive, rows, f"{tissue.name} {len(tissue.subjects)} {velocity:g} mm/s {text}"


def truth_of(
    drive: str,
    person: Any,
    values: np.ndarray,
    pad: Run,
    robot: tuple[Any, ...],
    velocity: float,
    mass: float,
    stiffness: float,
    ratio: float,
) -> dict[str, float]:
    """What the press is on the person."""
    path, speed, end, begin, hold, rounding = robot
    late = pad.t[-1] - 0.05 * hold
    if drive == "mass":
        run = by_mass(person, velocity, mass, 6001)
    elif drive in ("spring", "damped"):
        run = by_robot(person, path, speed, end, begin, stiffness, mass, 12001, ratio=ratio, method=METHOD)
    elif drive == "position":
        run = by_path(person, path, speed, end, begin, 12001, method=METHOD)
    elif drive == "force":
        after = pad.t > 0.0
        rate = np.gradient(pad.f[after], pad.t[after])
        first = pad.t[after][np.argmax(pad.f[after] > 0.01 * pad.peak)]
        run = skin_by_force(
            values[0],
            values[1:3],
            values[3:],
            lambda t: np.interp(t, pad.t, pad.f),
            lambda t: np.interp(t, pad.t[after], rate),
            first,
            pad.t[-1],
            12001,
        )
    else:
        run = pressed_to(person, float(pad.f[pad.t >= late].mean()), hold, rounding, begin, velocity, values)
    held = float(run.f[run.t >= run.t[-1] - 0.05 * hold].mean()) if drive != "mass" else np.nan
    return {"peak_N": run.peak, "steady_N": held, "depth_mm": run.depth, "energy_mJ": run.energy}


def pressed_to(
    person: Any, force: float, hold: float, rounding: float, begin: float, velocity: float, values: np.ndarray
) -> Run:
    """The same robot, sent deeper until the force at the end of the hold is that of the pad."""
    guess = (force / values[0]) ** (1.0 / 3.0)
    low, high = 0.3 * guess, 1.3 * guess
    for _ in range(16):
        middle = 0.5 * (low + high)
        path, speed, end = command(velocity, middle, hold, rounding)
        run = by_path(person, path, speed, end, begin, 12001, method=METHOD)
        held = float(run.f[run.t >= run.t[-1] - 0.05 * hold].mean())
        low, high = (middle, high) if held < force else (low, middle)
    return run


def main() -> None:
    """Run the cases and print the rates."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=240)
    parser.add_argument("--seed", type=int, default=8801)
    parser.add_argument("--drives", default=",".join(DRIVES), help="run only the cases of these drives")
    parser.add_argument("--out")
    options = parser.parse_args()
    module.OWN = 1  # the subjects' own intervals are not asked here, and take most of the time
    inside: dict[tuple[str, str], list[bool]] = defaultdict(list)
    table, begun = [], time.time()
    try:
        for number in range(options.cases):
            if DRIVES[number % len(DRIVES)] not in options.drives.split(","):
                continue
            drive, rows, words = case(number, options.seed)
            for name, (truth, low, high) in rows.items():
                inside[drive, name].append(low <= truth <= high)
                numbers = (f"{value:.6g}" for value in (truth, low, high))
                table.append([number, drive, name, *numbers, int(low <= truth <= high), words])
            if number % 10 == 9:
                shares = [one for (d, n), values in inside.items() if (d, n) not in TRIVIAL for one in values]
                rate = f"{100 * np.mean(shares):.1f} % inside"
                print(f"{number + 1} cases, {time.time() - begun:.0f} s: {rate}", flush=True)
    except KeyboardInterrupt:
        print("stopped: the rates are of the cases so far")
    if options.out:
        with open(options.out, "w", encoding="utf-8", newline="") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["case", "drive", "quantity", "truth", "low_95", "high_95", "inside", "about"])
            writer.writerows(table)
    print(f"\n{'drive':<10} {'quantity':<10} {'inside':>7} {'of':>4}")
    for (drive, name), values in sorted(inside.items()):
        note = "   (prescribed by the drive)" if (drive, name) in TRIVIAL else ""
        print(f"{drive:<10} {name:<10} {100 * np.mean(values):>6.1f}% {len(values):>4}{note}")
    for title, wanted in (("not prescribed", False), ("prescribed by the drive", True)):
        shares = [one for key, values in inside.items() if (key in TRIVIAL) is wanted for one in values]
        print(f"{title}: {100 * np.mean(shares):.1f} % of {len(shares)}")
    peaks = [one for (d, n), values in inside.items() if n == "peak_N" and d != "force" for one in values]
    print(f"peak force, one a case: {100 * np.mean(peaks):.1f} % of {len(peaks)}")


if __name__ == "__main__":
    main()
