"""Coverage of the fit's 95 % intervals over many draws of white and of correlated noise.

``python -m benchmarks.accuracy.fit_coverage [--draws 400] [--seed 1 2] [--csv FILE]`` presses a five-element tissue at
three steady forces and two speeds (an independent integrator makes the force), adds noise, fits jointly, and counts how
often the interval of each parameter holds the truth.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from dummydesign.inference.least_squares import profile_interval
from dummydesign.measurement.motion import contact_velocity
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.problem import TissueProblem, largest_slow
from dummydesign.tissue.fitting.reduction import reduce_trace

GAMMA1, GAMMA, DAMPER = 0.09, np.array([0.03, 0.11]), np.array([1.2, 0.08])
TRUTH = np.r_[GAMMA1, GAMMA, DAMPER]


def press(velocity_mm_s, depth_mm, hold_s=10.0, braking=30_000.0, step_s=1e-3, truth=TRUTH):
    """Trace of a braked press by scipy's LSODA on the law's ODE, without noise; any number of arms."""
    arms = (len(truth) - 1) // 2
    gamma, damper = truth[1 : 1 + arms], truth[1 + arms :]
    touch = float(contact_velocity(velocity_mm_s, depth_mm, braking))
    brake = touch / braking
    straight = (depth_mm - 0.5 * touch * brake) / touch
    stop = straight + brake

    def x_of(t):
        left = np.clip(stop - t, 0.0, None)
        return np.where(t < straight, touch * t, depth_mm - 0.5 * braking * left**2 * (t >= straight))

    time = np.arange(-0.05, stop + hold_s, step_s)
    force, stretch = np.zeros(len(time)), np.zeros(arms)
    for begin, end in ((0.0, straight), (straight, stop), (stop, stop + hold_s)):
        inside = (time > begin) & (time <= end)

        def change(t, e, begin=begin):
            if begin >= stop:
                speed = 0.0
            else:
                speed = touch if begin < straight else braking * max(stop - t, 0.0)
            return speed - gamma * float(x_of(np.float64(t))) ** 2 * e / damper

        at = np.r_[time[inside], end] if not inside.any() or time[inside][-1] < end else time[inside]
        run = solve_ivp(change, (begin, end), stretch, "LSODA", at, rtol=1e-9, atol=1e-12)
        stretch, count = run.y[:, -1], int(inside.sum())
        x = x_of(time[inside])
        force[inside] = truth[0] * x**3 + (gamma[:, None] * x**2 * run.y[:, :count]).sum(axis=0)
    x = np.where(time < 0, velocity_mm_s * time, x_of(time))
    return Trace(f"v{velocity_mm_s:g}_x{depth_mm:.3f}.csv", time, x, force)


def slow_noise(time, size_N, life_s, rng):
    """Ornstein-Uhlenbeck noise at the given times."""
    keep = np.exp(-np.diff(time) / life_s)
    kick = rng.normal(size=len(time)) * size_N
    out = np.empty(len(time))
    out[0] = kick[0]
    for k in range(1, len(time)):
        out[k] = keep[k - 1] * out[k - 1] + np.sqrt(1 - keep[k - 1] ** 2) * kick[k]
    return out


def coverage(draws, seed, slow_N, white_N=0.03, life_s=1.0, forces=(5.0, 10.0, 15.0), speeds=(10.0, 250.0)):
    """Share of draws (5,) whose interval holds the truth, in the order gamma1, gamma2, gamma3, c2, c3."""
    rng = np.random.default_rng(seed)
    clean = [press(v, np.cbrt(f / GAMMA1)) for v in speeds for f in forces]
    reduced = [reduce_trace(trace) for trace in clean]
    problem = TissueProblem("ode", [reduced], None)
    held = np.zeros(5)
    for _ in range(draws):
        parts, noisy = [], []
        for trace in reduced:
            raw = trace.trace
            noise = rng.normal(size=len(raw.time_s)) * white_N
            if slow_N:
                noise = noise + slow_noise(raw.time_s, slow_N, life_s, rng)
            bin_index = np.repeat(np.arange(len(trace.samples)), trace.samples)
            force = raw.force_N + noise
            noisy.append(replace(trace, trace=replace(raw, force_N=force)))
            values = force[trace.inside]
            parts.append(np.bincount(bin_index, values) / trace.samples)
        problem.force = np.concatenate(parts)
        problem.largest_slow_N = largest_slow(noisy)
        optimum = problem.optimum(2)
        model, (low, high) = problem.model(2, optimum.factor), problem.box(2)
        for index in range(5):
            interval = profile_interval(model, optimum.solution, index, low, high)
            above = interval.low is None or interval.low <= np.log(TRUTH[index])
            below = interval.high is None or interval.high >= np.log(TRUTH[index])
            held[index] += above and below
    return held / draws


def main():
    """Print the coverage table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--draws", type=int, default=400)
    parser.add_argument("--seed", type=int, nargs="+", default=[1], help="draws are made with each; shares are of all")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    count, rows = options.draws * len(options.seed), []
    print(f"{count} draws; a share of 0.95 is right, +-{1.96 * np.sqrt(0.0475 / count):.3f} by chance")
    print(f"{'noise':<44} {'gamma1':>7} {'gamma2':>7} {'gamma3':>7} {'c2':>7} {'c3':>7}")
    for name, slow, life in (
        ("white 0.03 N", 0.0, 1.0),
        ("white 0.03 N + slow 0.02 N over 1 s", 0.02, 1.0),
        ("white 0.03 N + slow 0.05 N over 0.1 s", 0.05, 0.1),
    ):
        shares = np.mean([coverage(options.draws, seed, slow, life_s=life) for seed in options.seed], axis=0)
        print(f"{name:<44} " + " ".join(f"{share:7.3f}" for share in shares))
        rows.append((name, *(f"{share:.3f}" for share in shares)))
    if options.csv:
        with options.csv.open("w", encoding="utf-8", newline="") as stream:
            head = "noise", "gamma1", "gamma2", "gamma3", "c2", "c3"
            csv.writer(stream, lineterminator="\n").writerows([head, *rows])


if __name__ == "__main__":
    main()
