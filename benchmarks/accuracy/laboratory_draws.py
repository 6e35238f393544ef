"""What a laboratory is: its people, its batch of resin, and what nobody has declared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.accuracy.laboratory_press import Batch, Person

DECLARED = ((0.03, 1.09), (0.3, 0.337), (3.0, 0.109))
"""Arms of the resin's file at its reference."""
SITES = {
    "forefinger": (3.0, 0.55, (0.4, 0.9), (0.2, 0.6)),
    "palm": (0.08, 0.5, (0.35, 0.8), (0.6, 1.3)),
    "thenar": (0.045, 0.45, (0.35, 0.7), (0.6, 1.3)),
}
"""Middle and spread of gamma1, then gamma2 and gamma3 over it. [N/mm3]"""
EFFECTS = {
    "contact_offset": (0.05, 0.15),
    "machine_compliance": (0.01, 0.03),
    "thickness_error": (0.3, 0.6),
    "strain_stiffening": (0.5, 1.5),
    "slow_relaxation_mode": (0.1, 0.25),
    "fast_relaxation_mode": (0.3, 0.6),
    "strain_dependent_relaxation": (0.8, 2.0),
    "softening_with_cycles": (0.03, 0.08),
    "temperature": (0.008, 0.015),
    "ageing": (0.03, 0.08),
    "force_bias": (0.06, 0.15),
    "force_drift": (0.01, 0.03),
    "sensor_lag": (0.004, 0.012),
    "sensor_curve": (0.002, 0.006),
}
"""Sizes that are drawn: mm, mm/N, mm, factor (d/h)^2, two strengths, factor, shares, 1/K, a decade, N, N/s, s, 1/N."""
SIGNED = {"contact_offset", "thickness_error", "force_bias", "force_drift", "sensor_curve"}
OF_MATERIAL = {"slow_relaxation_mode", "fast_relaxation_mode", "strain_dependent_relaxation", "temperature", "ageing"}
SAME_SIZE = {"contact_offset", "machine_compliance", "thickness_error", "force_bias"}
"""Effects of the material act on pucks too; sizes are compared where both laws have the same one."""
QUIET = 7
"""Laboratories with nothing undeclared for one of each effect."""


@dataclass(frozen=True)
class Drawn:
    """People of one site, a batch, and an undeclared effect with its size or none."""

    site: str
    people: list[Person]
    batch: Batch
    put: dict[str, float]


def draw(seed: int, number: int, rng: np.random.Generator) -> Drawn:
    """A laboratory of a study; sites and effects take turns."""
    site = list(SITES)[number % 3]
    middle, spread, second, third = SITES[site]
    level = middle * np.exp(rng.normal(0.0, 0.15))
    own = bool(rng.random() < 0.5)
    people = []
    for _ in range(int(rng.integers(3, 5))):
        gamma1 = level * np.exp(rng.normal(0.0, spread))
        gamma = gamma1, gamma1 * rng.uniform(*second), gamma1 * rng.uniform(*third)
        times = rng.uniform(0.9, 2.0), float(np.exp(rng.uniform(np.log(0.01), np.log(0.06))))
        people.append(Person(gamma, times, rng.uniform(2.85, 3.15) if own else None))
    young, count = 25.0 * np.exp(rng.normal(0.0, 0.25)), int(rng.integers(1, 5))
    tau_s = np.exp(np.linspace(np.log(0.012), np.log(6.0), count + 2)[1:-1] + rng.normal(0.0, 0.25, count))
    strength = np.zeros(count)
    for tau, beta in DECLARED:
        strength[np.argmin(np.abs(np.log(tau_s / tau)))] += beta * np.exp(rng.normal(0.0, 0.12))
    arms = [(float(tau), float(beta)) for tau, beta in zip(tau_s, strength) if beta > 0.0]
    yeoh = float(rng.choice([0.0, rng.uniform(0.02, 0.08)]))
    batch = Batch(young, rng.uniform(0.83, 0.89), rng.uniform(2.0, 3.0), rng.uniform(0.2, 1.0), arms, yeoh)
    kinds = np.random.default_rng([seed, 59]).permutation([*EFFECTS, *[""] * QUIET])
    if not (name := str(kinds[number % len(kinds)])):
        return Drawn(site, people, batch, {})
    size = float(rng.uniform(*EFFECTS[name])) * (float(rng.choice([-1.0, 1.0])) if name in SIGNED else 1.0)
    return Drawn(site, people, batch, {name: size})
