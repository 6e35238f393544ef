"""Recovery of modulus, friction and relaxation of pucks pressed with holds, over many draws.

``python -m benchmarks.accuracy.puck_hold [--draws 100] [--seed 1] [--csv FILE]`` makes the elastic force by finite
elements, relaxes it by summing the hereditary integral over its whole history (none of the package's recursion), adds a
smooth misfit of the law (2 % of the force), white noise and drift, and fits. It counts how often intervals hold the
truth, how often the number of arms is right, and how often an arm slower than half of the hold is flagged.
"""

from __future__ import annotations

import argparse
import csv
import itertools
from functools import lru_cache
from pathlib import Path

import numpy as np

from dummydesign.measurement.ramp_detection import find_holds
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import table_for
from dummydesign.resin.puck_test.loading_fit import reduce_press
from dummydesign.resin.puck_test.relaxation_fit import fit_relaxation

YOUNG_KPA = 30.0


@lru_cache(maxsize=32)
def elastic_curve(diameter_mm, height_mm, alpha, plates):
    """Compressions and forces of a puck of 1 kPa by finite elements."""
    at = np.r_[0.002, 0.01, 0.03, np.arange(0.06, 0.43, 0.03)]
    puck = Puck(height_mm, 1e-3, diameter_mm, plates=plates, law=Ogden([2.0 / alpha], [alpha]))
    curve = solve_puck(puck, height_mm * at)
    return np.r_[0.0, curve.depth_mm / height_mm], np.r_[0.0, curve.force_N]


def elastic_force(c, diameter_mm, height_mm, alpha, plates):
    """Force per kPa at compressions over height: the solved ratio to the uniaxial closed form, interpolated."""
    at, force = elastic_curve(diameter_mm, height_mm, alpha, plates)
    stretch, grid = 1.0 - np.maximum(c, 0.0), 1.0 - at[1:]
    nominal = stretch ** (-0.5 * alpha - 1.0) - stretch ** (alpha - 1.0)
    ratio = force[1:] / (grid ** (-0.5 * alpha - 1.0) - grid ** (alpha - 1.0))
    return nominal * np.interp(np.maximum(c, 0.0), at[1:], ratio)


def hereditary(time, force, arms):
    """F(t) = sum over the whole history of (1 + sum beta exp(-(t - s) / tau)) dF, at the middle of each step."""
    rise, middle = np.diff(force), 0.5 * (time[1:] + time[:-1])
    out = np.zeros(len(time))
    for k in range(1, len(time)):
        age = time[k] - middle[:k]
        out[k] = rise[:k] @ (1.0 + sum(beta * np.exp(-age / tau) for tau, beta in arms))
    return out


def motion(levels_mm, velocity_mm_s, hold_s, step_s=0.05, before_s=1.0):
    """Times and displacements of ramps and holds, beginning above the puck."""
    knots_t, knots_x = [-before_s, 0.0], [-velocity_mm_s * min(before_s, 0.2), 0.0]
    knots_x[0] = -0.1
    for level in levels_mm:
        stop = knots_t[-1] + (level - knots_x[-1]) / velocity_mm_s
        knots_t += [stop, stop + hold_s]
        knots_x += [level, level]
    time = np.concatenate([np.arange(begin, end, step_s) for begin, end in itertools.pairwise(knots_t)])
    return time, np.interp(time, knots_t, knots_x)


def made(
    rng,
    arms,
    levels=(0.1, 0.2, 0.3),
    hold_s=60.0,
    velocity_mm_s=2.0,
    diameter_mm=50.0,
    height_mm=30.0,
    alpha=2.3,
    plates="friction:0.2",
    offset_mm=0.15,
    misfit=0.02,
    white_N=0.02,
    drift=1e-3,
):
    """One noisy press: time, displacement, force."""
    time, x = motion([level * height_mm for level in levels], velocity_mm_s, hold_s)
    c = np.maximum(x - offset_mm, 0.0) / height_mm
    force = YOUNG_KPA * elastic_force(c, diameter_mm, height_mm, alpha, plates)
    phase = rng.uniform(0.0, 2.0 * np.pi, 3)
    waves = sum(np.cos(2.0 * np.pi * c / length + p) for length, p in zip((0.9, 0.6, 0.4), phase))
    force = force * (1.0 + misfit * waves * np.sqrt(2.0 / 3.0))
    force = hereditary(time, force, arms)
    keep = np.exp(-np.diff(time, prepend=time[0]) / 20.0)
    kick = rng.normal(size=len(time)) * np.sqrt(1.0 - keep**2)
    slow = np.zeros(len(time))
    for k in range(1, len(time)):
        slow[k] = keep[k] * slow[k - 1] + kick[k]
    return time, x, force + drift * force.max() * slow + white_N * rng.normal(size=len(time))


def fitted(time, x, force, diameter_mm=50.0, height_mm=30.0):
    """The package's answer to one press."""
    press = reduce_press(time, x, force, find_holds(time, x), (0.03 * height_mm, 0.5 * height_mm))
    return fit_relaxation((press,), diameter_mm, height_mm, table_for(diameter_mm, height_mm))


def holds(interval, truth):
    """Whether an interval holds the truth."""
    return interval.low <= truth <= interval.high


CASES = {
    "two arms, three holds of 60 s, 50 x 30 mm, friction 0.2": dict(arms=((0.8, 0.25), (8.0, 0.12))),
    "one arm, one hold of 60 s at 25 %, bonded": dict(arms=((3.0, 0.2),), levels=(0.25,), plates="bonded"),
    "two arms, 40 x 25 mm, friction 0.1": dict(
        arms=((0.8, 0.25), (8.0, 0.12)), diameter_mm=40.0, height_mm=25.0, plates="friction:0.1"
    ),
    "an arm of 60 s beside one of 1.5 s, holds of 60 s": dict(arms=((1.5, 0.2), (60.0, 0.15))),
}


def study(draws, seed, options):
    """Shares over draws of one case."""
    rng = np.random.default_rng(seed)
    size = {name: options[name] for name in ("diameter_mm", "height_mm") if name in options}
    plates = options.get("plates", "friction:0.2")
    friction = np.inf if plates == "bonded" else float(plates.split(":")[1])
    count = {name: [] for name in ("young", "friction", "tau", "beta", "arms", "flagged", "error", "half")}
    for _ in range(draws):
        relaxation = fitted(*made(rng, **options), **size)
        count["young"].append(holds(relaxation.known.young_kPa, YOUNG_KPA))
        count["error"].append(relaxation.known.young_kPa.value / YOUNG_KPA - 1.0)
        count["half"].append(0.5 * np.log(relaxation.known.young_kPa.high / relaxation.known.young_kPa.low))
        count["friction"].append(relaxation.known.friction.low <= friction <= relaxation.known.friction.high)
        count["arms"].append(len(relaxation.arms) == len(options["arms"]))
        if len(relaxation.arms) == len(options["arms"]):
            for arm, (tau, beta) in zip(relaxation.arms, options["arms"]):
                if tau <= 30.0:
                    count["tau"].append(holds(arm.tau_s, tau))
                    count["beta"].append(holds(arm.beta, beta))
        count["flagged"].append(any(arm.slow for arm in relaxation.arms))
    return {name: np.array(values, float) for name, values in count.items()}


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    rows = []
    print(f"{options.draws} draws a case; a share of 0.95 is right, +-{1.96 * np.sqrt(0.0475 / options.draws):.3f}")
    head = "E | friction | times | strengths | arms right | slow arm flagged | E: rms error, half interval"
    print(f"| case | {head} |")
    print("|---|---|---|---|---|---|---|---|")
    for name, case in CASES.items():
        got = study(options.draws, options.seed, case)
        words = [f"{np.mean(got[k]):.2f}" for k in ("young", "friction", "tau", "beta", "arms", "flagged")]
        size = f"{100 * np.sqrt(np.mean(got['error'] ** 2)):.1f} %, {100 * np.median(got['half']):.1f} %"
        print(f"| {name} | " + " | ".join(words) + f" | {size} |", flush=True)
        rows.append((name, *words, *size.replace(" %", "").split(", ")))
    if options.csv:
        heads = ["case", "E", "friction", "times", "strengths", "number_of_arms_right", "slow_arm_flagged"]
        heads += ["E_rms_error_percent", "E_half_interval_percent"]
        with options.csv.open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([heads, *rows])


if __name__ == "__main__":
    main()
