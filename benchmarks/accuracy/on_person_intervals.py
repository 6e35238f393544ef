"""Coverage of the 95 % intervals of `on-person` without a trace's noise: the statistics of few subjects alone.

Each group of cases shares one exact press; each case has its own population, measured subjects and one more person,
drawn as in `on_person_blind`. Truth and draws use the same drive, so that what is counted is the prediction from few
subjects, over many more cases than the blind check can press. The numbers of one person are not independent: the error
of a rate follows from the number of cases, not of numbers.

    python -m benchmarks.accuracy.on_person_intervals [--groups 30] [--seed 3] [--drives steady,force,spring]
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from benchmarks.accuracy.on_person_blind import TRIVIAL, population
from dummydesign.measurement.trace import Trace
from dummydesign.person.drives import read_drive
from dummydesign.person.on_person import _ends
from dummydesign.person.people import People, draw_another
from dummydesign.person.press import Press
from tests.support.robot_presses import command

SIZE, DRAWS = 25, 160
"""Cases a group, and draws a case: fewer than in the package, with the same coverage."""


def exact_press(rng: np.random.Generator, velocity: float, gamma1: float) -> Press:
    """A pad of power law with one relaxing arm, followed by a stiff robot."""
    scale = (10.0 / gamma1) ** (1.0 / 3.0)
    stiffness, power = rng.uniform(0.7, 1.3) * 9.0 / scale**1.35, rng.uniform(1.2, 1.7)
    strength, relaxing_s = rng.uniform(0.2, 0.8), rng.uniform(0.05, 0.4)
    depth, hold = rng.uniform(0.8, 1.1) * scale, rng.uniform(1.0, 2.0)
    path, speed, end = command(velocity, depth, hold, max(velocity / (4.0 * rng.uniform(5e3, 30e3)), 2e-4))
    stop = end - hold
    near = 1.25 * stop + 0.008
    nodes = np.unique(np.r_[np.linspace(0.0, near, 161), np.geomspace(near, end, 60)])
    fine = np.unique(np.r_[np.linspace(0.0, near, 4000), np.linspace(near, end, 4000), nodes])
    x = np.maximum(np.array([path(time) for time in fine]), 0.0)
    arm, shape = np.zeros(len(fine)), x**power
    for at, (step, gain) in enumerate(zip(np.diff(fine) / relaxing_s, np.diff(shape)), 1):
        arm[at] = arm[at - 1] * np.exp(-step) + gain * np.exp(-0.5 * step)
    force = stiffness * (shape + strength * arm)
    lead = np.linspace(-0.5 / velocity, 0.0, 50)[:-1]
    trace = Trace("exact", np.r_[lead, fine], np.r_[velocity * lead, x], np.r_[0.0 * lead, force])
    chosen, none = np.searchsorted(fine, nodes), np.zeros((len(nodes), 1))
    steady = np.asarray(force[fine >= end - 0.05 * hold].mean())
    return Press(
        trace,
        nodes,
        x[chosen],
        force[chosen],
        none,
        none,
        0.0,
        stop,
        hold,
        velocity,
        np.asarray(speed(0.0)),
        0.0,
        steady,
        0.01,
    )


def together(rows: Sequence[People]) -> People:
    """Several groups of people as one."""
    return People(
        rows[0].law, *(np.concatenate([getattr(one, part) for one in rows]) for part in ("gamma1", "gamma", "c"))
    )


def group(number: int, seed: int, drives: Sequence[str]) -> dict[tuple[str, str], list[int]]:
    """-1, 0 or 1 for one more person below, inside or above the interval, of each case by drive and quantity."""
    rng = np.random.default_rng([seed, number])
    velocity = float(f"{np.exp(rng.uniform(np.log(10.0), np.log(250.0))):.2g}")
    made = [population(rng, velocity) for _ in range(SIZE)]
    hidden = np.exp(np.array([person for _, person in made]))
    drawn = [draw_another(tissue, velocity, DRAWS, rng) for tissue, _ in made]
    everyone = together([People(drawn[0].law, hidden[:, 0], hidden[:, 1:3], hidden[:, 3:]), *drawn])
    subjects = [one for tissue, _ in made for one in tissue.parameter_sets]
    gamma1 = float(np.exp(np.mean(np.log([one.gamma1_N_per_mm3 for one in subjects]))))
    press = exact_press(rng, velocity, gamma1)
    mass = 1e-2 * (10.0 / gamma1) ** (1.0 / 3.0) / (velocity * 1e-3) ** 2 * rng.uniform(0.5, 1.5)
    full = {
        "mass": f"mass:{mass:.3g}kg",
        "spring": f"spring:{rng.uniform(15.0, 100.0):.3g},{rng.uniform(0.1, 0.5):.3g},0.05",
    }
    rows: dict[tuple[str, str], list[int]] = {}
    for name in drives:
        answer = read_drive(full.get(name, name)).respond(press, everyone, keep=False).four()
        for quantity, values in answer.items():
            if (name, quantity) in TRIVIAL or not np.isfinite(values[:SIZE]).all():
                continue
            ends = [_ends(one) for one in values[SIZE:].reshape(SIZE, DRAWS)]
            rows[name, quantity] = [
                -1 if low is None or value < low else int(high is None or value > high)
                for value, (low, high) in zip(values[:SIZE], ends)
            ]
    return rows


def main() -> None:
    """Run the groups and print the rates."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--groups", type=int, default=30)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--drives", default="position,steady,force,mass,spring")
    options = parser.parse_args()
    sides: dict[tuple[str, str], list[int]] = defaultdict(list)
    for number in range(options.groups):
        for key, own in group(number, options.seed, options.drives.split(",")).items():
            sides[key] += own
    print(f"{'drive':<10} {'quantity':<10} {'cases':>6} {'inside':>8} {'below':>7} {'above':>7} {'error':>7}")
    for (drive, quantity), own in sides.items():
        rates = [100.0 * float(np.mean(np.array(own) == side)) for side in (0, -1, 1)]
        error = 100.0 * np.sqrt(0.95 * 0.05 / len(own))
        shown = "".join(f" {rate:>6.1f}%" for rate in (*rates, error))
        print(f"{drive:<10} {quantity:<10} {len(own):>6} {shown}")


if __name__ == "__main__":
    main()
