"""Simulated people whose skin follows Fung's quasi-linear viscoelasticity, written without the package.

Force = integral of G(t - s) dT/ds ds with the elastic force T(x) = a (exp(b x) - 1) and the reduced relaxation
G(t) = 1 + sum g_i exp(-t / tau_i), relative to the long-term force (Fung, Biomechanics: Mechanical Properties of Living
Tissues, 2nd ed., section 7.6). A press goes at constant speed, brakes at constant deceleration, and is held.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

BRAKING_MM_S2 = 30_000.0


@dataclass(frozen=True)
class Person:
    """a in N, b in 1/mm, strengths g and times tau in s."""

    name: str
    a_N: float
    b_per_mm: float
    g: tuple[float, ...] = (0.45, 0.35)
    tau_s: tuple[float, ...] = (0.02, 0.6)

    def depth_mm(self, steady_N: float) -> float:
        """Depth with this long-term force."""
        return float(np.log1p(steady_N / self.a_N) / self.b_per_mm)

    def force_N(self, time_s: np.ndarray, x_mm: np.ndarray) -> np.ndarray:
        """Force along a motion: each arm answers exactly to elastic force that is linear between samples."""
        elastic = self.a_N * np.expm1(self.b_per_mm * np.maximum(x_mm, 0.0))
        total = elastic.copy()
        step, rise = np.diff(time_s), np.diff(elastic)
        for g, tau in zip(self.g, self.tau_s):
            arm = np.zeros(len(time_s))
            for k, (dt, dT) in enumerate(zip(step, rise)):
                arm[k + 1] = arm[k] * np.exp(-dt / tau) + g * dT * tau / dt * -np.expm1(-dt / tau)
            total += arm
        return total


PEOPLE = (
    Person("ada", 0.60, 1.55, (0.30, 0.30)),
    Person("ben", 0.75, 1.85, (0.90, 0.70)),
    Person("cora", 0.50, 2.25, (0.55, 0.45)),
    Person("dan", 0.85, 2.10, (0.70, 1.10)),
)


def motion(velocity_mm_s: float, depth_mm: float, hold_s: float, rise: int = 1500) -> tuple[np.ndarray, np.ndarray]:
    """Times and displacements from contact on; braking may begin above the surface."""
    touch = min(velocity_mm_s, np.sqrt(2.0 * BRAKING_MM_S2 * depth_mm))
    brake = touch / BRAKING_MM_S2
    way = 0.5 * touch * brake
    stop = max(depth_mm - way, 0.0) / touch + brake
    when = np.linspace(0.0, stop, rise + 1)
    left = np.maximum(stop - when, 0.0)
    x = np.where(left > brake, touch * when, depth_mm - 0.5 * BRAKING_MM_S2 * left**2)
    after = np.geomspace(2e-5, hold_s, 1200)
    return np.r_[when, stop + after], np.r_[np.clip(x, 0.0, depth_mm), np.full(len(after), depth_mm)]


def press(
    person: Person, steady_N: float, velocity_mm_s: float, hold_s: float = 10.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, displacements and forces of a press to the depth with that force at the end of the hold."""
    depth = person.depth_mm(steady_N)
    for _ in range(20):
        when, x = motion(velocity_mm_s, depth, hold_s)
        force = person.force_N(when, x)
        if abs(force[-1] / steady_N - 1.0) < 1e-9:
            break
        depth = person.depth_mm(steady_N * float(person.a_N * np.expm1(person.b_per_mm * depth) / force[-1]))
    return when, x, force


def write_table(
    path: Path,
    people=PEOPLE,
    forces=(5.0, 10.0, 15.0),
    speeds=(10.0, 250.0),
    hold_s=10.0,
    repeats=1,
    noise_N=0.0,
    depth_sd_mm=0.0,
    seed=1,
) -> Path:
    """A table of curves as ``tissues add-curves`` reads it, a few hundred samples a press."""
    rng = np.random.default_rng(seed)
    rows = ["subject,velocity_mm_s,press,time_s,depth_mm,force_N"]
    number = 0
    for person in people:
        for speed in speeds:
            for steady in forces:
                for _ in range(repeats):
                    number += 1
                    when, x, force = press(person, steady, speed, hold_s)
                    keep = np.r_[np.arange(0, 1501, 15), np.arange(1501, len(when), 6)]
                    keep = np.unique(np.r_[keep, len(when) - 1])
                    zero = depth_sd_mm * rng.standard_normal()
                    noisy = force[keep] + noise_N * rng.standard_normal(len(keep))
                    cells = zip(when[keep], x[keep] + zero * (x[keep] > 0), noisy)
                    rows += [f"{person.name},{speed:g},{number},{t:.7f},{d:.6f},{f:.5f}" for t, d, f in cells]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path
