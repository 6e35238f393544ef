"""Landmarks and gamma1 of presses that overshoot and ring, against drawn presses with known truths.

``python -m benchmarks.accuracy.overshoot landmarks|fit [--draws N] [--seed S] [--overshoot LOW HIGH]`` draws overshoot
(0 to 10 % of the depth), ringing (3 to 50 Hz), damping (0.02 to 1), depth (0.5 to 12 mm), speed (1 to 400 mm/s),
sampling (20 Hz to 5 kHz), hold (2 to 10 s), release, noise and rounding of both columns. ``landmarks`` prints how often
depth (1 %), hold (0.3 s or 3 %) and steady force (1 %) are right. ``fit`` fits one press at a time with five elements
(depth from 2 mm, 5 to 100 mm/s, from 200 Hz) and prints the error of gamma1, and how often its 95 % interval holds the
truth. The forces are those of an integrator of their own.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GAMMA1, GAMMA, DAMPER = 0.06, np.array([0.03, 0.07]), np.array([1.0, 0.15])
LEAD_S, APPROACH_MM = 0.3, 1.0
STEP_SHARE = 0.004


@dataclass(frozen=True)
class Drawn:
    """One press as it was drawn, with what a reader must find."""

    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    depth_mm: float
    stop_s: float
    end_s: float
    steady_N: float
    settings: dict[str, float]


def law_force(time: NDArray, x: NDArray) -> NDArray:
    """Force of the five-element law along a path by the exact factor of each short step, all steps joined at once."""
    pressed = np.maximum(x, 0.0)
    step, moved = np.diff(time), np.diff(pressed)
    square = (0.5 * (pressed[1:] + pressed[:-1])) ** 2
    force = GAMMA1 * pressed**3
    for gamma, damper in zip(GAMMA, DAMPER):
        decay = gamma * square / damper * step
        keep = np.exp(-decay)
        stretch = moved * np.where(decay > 1e-9, -np.expm1(-decay) / np.maximum(decay, 1e-300), 1.0)
        reach = 1
        while reach < len(step):
            # each step takes on what the steps up to twice as far back left
            stretch[reach:] = stretch[reach:] + keep[reach:] * stretch[:-reach]
            keep[reach:] = keep[reach:] * keep[:-reach]
            reach *= 2
        force[1:] += gamma * pressed[1:] ** 2 * stretch
    return force


def path(time: NDArray, settings: dict[str, float], ringing: bool = True) -> NDArray:
    """Approach at an even speed, a stop with a damped sine, hold and release; contact at time 0. [mm]"""
    depth, speed = settings["depth_mm"], settings["speed_mm_s"]
    stop = depth / speed
    x = np.clip(speed * time, -APPROACH_MM, depth)
    since = np.clip(time - stop, 0.0, settings["hold_s"])
    if ringing:
        rate, damping = 2.0 * np.pi * settings["ringing_Hz"], min(settings["damping"], 0.999)
        own = rate * np.sqrt(1.0 - damping**2)
        first = np.arctan2(own, damping * rate) / own
        largest = np.exp(-damping * rate * first) * np.sin(own * first)
        x = x + settings["overshoot"] * depth / largest * np.exp(-damping * rate * since) * np.sin(own * since)
    end = stop + settings["hold_s"]
    return np.where(time > end, np.maximum(x - settings["release_mm_s"] * (time - end), -APPROACH_MM), x)


def drawn(rng: np.random.Generator, for_fit: bool = False, overshoot: tuple[float, float] = (0.0, 0.1)) -> Drawn:
    """Draw one press."""

    def spread(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    settings = {
        "overshoot": float(rng.uniform(*overshoot)),
        "ringing_Hz": spread(3.0, 50.0),
        "damping": spread(0.02, 1.0),
        "depth_mm": spread(2.0, 8.0) if for_fit else spread(0.5, 12.0),
        "speed_mm_s": spread(5.0, 100.0) if for_fit else spread(1.0, 400.0),
        "sampling_Hz": spread(200.0, 2000.0) if for_fit else spread(20.0, 5000.0),
        "hold_s": float(rng.uniform(8.0, 12.0) if for_fit else rng.uniform(2.0, 10.0)),
    }
    settings["release_mm_s"] = settings["speed_mm_s"] * float(rng.choice([0.3, 1.0]))
    stop, released = settings["depth_mm"] / settings["speed_mm_s"], rng.random() < 0.5
    end = stop + settings["hold_s"]
    last = end + (settings["depth_mm"] / settings["release_mm_s"] + 0.1 if released else 0.0)
    time = np.arange(
        -APPROACH_MM / settings["speed_mm_s"] - LEAD_S * rng.uniform(0.5, 1.5), last, 1.0 / settings["sampling_Hz"]
    )
    short = min(STEP_SHARE * stop, STEP_SHARE / settings["ringing_Hz"] * 10.0)
    fine = np.union1d(np.arange(0.0, last + short, short), stop + np.array([-1e-6, 0.0, 1e-6]))
    force = law_force(fine, path(fine, settings))
    plain = law_force(fine, path(fine, settings, ringing=False))
    steady = float(plain[(fine > end - 0.05 * settings["hold_s"]) & (fine <= end)].mean())
    noise_N, noise_mm = steady * spread(3e-4, 3e-3), float(rng.choice([0.0, 0.0005, 0.002]))
    x = path(time, settings) + noise_mm * rng.standard_normal(len(time))
    measured = np.interp(time, fine, force, left=0.0) + noise_N * rng.standard_normal(len(time))
    end = end if released else float(time[-1])
    return Drawn(time, np.round(x, 4), np.round(measured, 5), settings["depth_mm"], stop, end, steady, settings)


def landmarks(draws: int, seed: int, overshoot: tuple[float, float]) -> None:
    """Print how often depth, hold and steady force are right."""
    from dummydesign.measurement.ramp_detection import summarise

    rng = np.random.default_rng(seed)
    right, wrong = {"depth": 0, "hold": 0, "steady force": 0}, []
    for number in range(draws):
        press = drawn(rng, overshoot=overshoot)
        found = summarise(f"draw {number}", press.time_s, press.displacement_mm, press.force_N)
        hold, steady = press.end_s - press.stop_s, found.steady_force_N
        hits = {
            "depth": abs(found.depth_mm / press.depth_mm - 1.0) <= 0.01,
            "hold": abs(found.hold_s - hold) <= max(0.3, 0.03 * hold),
            "steady force": steady is not None and abs(steady / press.steady_N - 1.0) <= 0.01,
        }
        for name, hit in hits.items():
            right[name] += hit
        if not all(hits.values()):
            wrong.append((found, hold, press.steady_N, press.settings))
    for name, count in right.items():
        print(f"{name}: right in {count} of {draws}")
    for row in wrong[:5]:
        print("  wrong:", *row)


def fits(draws: int, seed: int, overshoot: tuple[float, float]) -> None:
    """Print the error of gamma1 and the coverage of its interval."""
    from dummydesign.measurement.trace import Trace
    from dummydesign.tissue.fitting.fit import fit_traces

    rng = np.random.default_rng(seed)
    error, covered, width, known, worst = [], 0, [], 0, (0.0, {})
    for number in range(draws):
        press = drawn(rng, True, overshoot)
        trace = Trace(f"draw{number}.csv", press.time_s, press.displacement_mm, press.force_N)
        found = fit_traces([trace], 5).result["parameters"]["gamma1_N_per_mm3"]
        off = found["value"] / GAMMA1 - 1.0
        error.append(off)
        worst = max(worst, (abs(off), press.settings), key=lambda pair: pair[0])
        low, high = found["low"] or 0.0, found["high"] or np.inf
        covered += bool(low <= GAMMA1 <= high)
        known += found["low"] is not None and found["high"] is not None
        width.append((high - low) / GAMMA1)
    size = np.abs(error)
    print(
        f"gamma1: within 3 % in {int((size <= 0.03).sum())} of {draws}; median error {100 * np.median(size):.3f} %, "
        f"mean {100 * np.mean(error):+.3f} %, largest {100 * size.max():.2f} %"
    )
    print(
        f"95 % interval of gamma1 holds the truth in {covered} of {draws} ({100 * covered / draws:.1f} %); bounded "
        f"on both sides in {known}; median width {100 * np.median(width):.2f} %"
    )
    print("largest error at", {key: round(value, 3) for key, value in worst[1].items()})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("landmarks", "fit"))
    parser.add_argument("--draws", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--overshoot", type=float, nargs=2, default=(0.0, 0.1), metavar=("LOW", "HIGH"))
    options = parser.parse_args()
    run = landmarks if options.part == "landmarks" else fits
    run(options.draws, options.seed, tuple(options.overshoot))


if __name__ == "__main__":
    main()
