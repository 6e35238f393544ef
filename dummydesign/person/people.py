"""Persons in numbers, many at once; those that a tissue's data allow: each subject, and one more of their kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, Parameters, law_named, stack
from dummydesign.tissue.model.posterior import FARTHEST
from dummydesign.tissue.model.subject import Subject, flatten, subject_parameters
from dummydesign.tissue.model.tissue import Tissue


@dataclass(frozen=True, eq=False)
class People:
    """Persons of one law at one speed.

    Attributes
    ----------
    law : MaxwellLaw
    gamma1 : ndarray, shape (p,)
        Steady coefficient. [N/mm^power]
    gamma, c : ndarray, shape (p, arms)
        Springs and dampers of the arms. [N/mm3, N s/mm]
    """

    law: MaxwellLaw
    gamma1: NDArray
    gamma: NDArray
    c: NDArray

    @classmethod
    def of(cls, subjects: Sequence[Parameters], velocity_mm_s: float) -> People:
        """Collect subjects with their dampers at a speed; see :func:`~.maxwell_law.stack`."""
        return cls(law_named(subjects[0].law), *stack(subjects, velocity_mm_s))

    def __len__(self) -> int:
        return len(self.gamma1)

    @cached_property
    def rate(self) -> NDArray:
        """gamma / c. [1/(mm2 s)]"""
        return self.gamma / self.c

    def force(self, time_s: NDArray, depth_mm: NDArray) -> NDArray:
        """Force under a motion of shape (n,) or (p, n); never below 0, as skin does not pull. [N]"""
        force = self.law.force(Motion(time_s, depth_mm), self.gamma1, self.gamma, self.c)
        return np.maximum(np.broadcast_to(force, (len(self), force.shape[-1])), 0.0)

    def at_rest(self) -> NDArray:
        """Stretches of the arms before contact, shape (p, arms). [mm]"""
        return np.zeros(self.gamma.shape)

    def carried(self, depth: NDArray, stretch: NDArray, new: NDArray, step: float) -> tuple[NDArray, NDArray]:
        """Return the stretches after a step at even speed, and their slopes over the new depth, both (p, arms).

        Stretch q' = gain x' - decay q; the decay is its mean over the step (Simpson), the rest exact.
        """
        low, high = np.maximum(depth, 0.0), np.maximum(new, 0.0)
        rates = [self.law.stretch_rates(at, self.rate) for at in (low, 0.5 * (low + high), high)]
        decay = (rates[0][1] + 4.0 * rates[1][1] + rates[2][1]) * (step / 6.0)
        gain = rates[1][0] * np.where(decay > 1e-9, -np.expm1(-decay) / np.maximum(decay, 1e-9), 1.0)
        return stretch * np.exp(-decay) + gain * (high - low)[:, None], gain

    def force_of(self, depth: NDArray, stretch: NDArray) -> NDArray:
        """Force at depths (p,) with stretches (p, arms), not below 0. [N]"""
        x = np.maximum(depth, 0.0)
        return np.maximum(self.gamma1 * x**self.law.power + (self.gamma * stretch).sum(axis=-1) * x**2, 0.0)

    def slope_of(self, depth: NDArray, stretch: NDArray, gain: NDArray) -> NDArray:
        """Slope of the force over depth within a step, shape (p,). [N/mm]"""
        x, power = np.maximum(depth, 0.0), self.law.power
        steady = self.gamma1 * power * x ** (power - 1.0) * (depth >= 0.0)
        arms = (self.gamma * (2.0 * x[:, None] * stretch + (x**2)[:, None] * gain)).sum(axis=-1)
        return np.maximum(steady + arms, 0.0)

    def depth_taking(self, energy_mJ: float) -> NDArray:
        """Depth at which an energy is taken if nothing relaxes, shape (p,). [mm]"""
        low, high = np.zeros(len(self)), np.full(len(self), 1e3)
        power, arms = self.law.power, self.gamma.sum(axis=-1)
        for _ in range(60):
            middle = 0.5 * (low + high)
            enough = self.gamma1 * middle ** (power + 1) / (power + 1) + 0.25 * arms * middle**4 > energy_mJ
            low, high = np.where(enough, low, middle), np.where(enough, middle, high)
        return high


WIDTH = 2.0 * 1.959964
"""Width of a 95 % interval in standard deviations."""
GROUPS = 200
"""Groups of persons that are taken from the draws beside an inferred tissue."""


def log_parameters(people: People) -> NDArray:
    """Return ln gamma1, ln gamma and ln c of persons, shape (p, 1 + 2 arms)."""
    return np.log(np.concatenate([people.gamma1[:, None], people.gamma, people.c], axis=1))


def people_of_logs(people: People, logs: NDArray) -> People:
    """Return persons of the same law with other parameters, shape (p, 1 + 2 arms)."""
    values, arms = np.exp(logs), people.gamma.shape[-1]
    return People(people.law, values[:, 0], values[:, 1 : 1 + arms], values[:, 1 + arms :])


def own_spread(subject: Subject, velocity_mm_s: float) -> NDArray:
    """Standard deviations of a subject's ln parameters, from its 95 % intervals, shape (1 + 2 arms,)."""
    ends = (subject_parameters(subject.parameters.law, subject.numbers, end) for end in ("low", "high"))
    low, high = (log_parameters(People.of([one], velocity_mm_s))[0] for one in ends)
    return (high - low) / WIDTH


def draw_subject(tissue: Tissue, row: int, velocity_mm_s: float, count: int, rng: np.random.Generator) -> People:
    """Draw one subject within its own intervals, ``count`` times.

    Parameters are drawn one by one: what a fit leaves open together is then counted too wide, never too narrow.
    """
    people = People.of(tissue.parameter_sets[row : row + 1], velocity_mm_s)
    spread = own_spread(tissue.subjects[row], velocity_mm_s)
    return people_of_logs(people, log_parameters(people) + spread * rng.standard_normal((count, len(spread))))


def draw_another(tissue: Tissue, velocity_mm_s: float, count: int, rng: np.random.Generator) -> People:
    """Draw one more person of the subjects' kind, ``count`` times.

    Of an inferred tissue: persons of its posterior. Of n subjects with ln parameters of mean m and residuals R (n, k):
    m + sqrt((n - 1) / chi2_(n-1)) sqrt(1 + 1 / n) S z, S S = R' R / (n - 1), z standard normal, which for every
    linear function of the parameters is Student's prediction for one more value; what the subjects' own intervals
    add is in their scatter. Of one subject nothing is known of others: its own intervals.

    References
    ----------
    Gelman et al., Bayesian Data Analysis, 3rd edition, section 3.2 (prediction with flat priors).
    """
    from scipy.special import gammaincinv, ndtri

    people = People.of(tissue.parameter_sets, velocity_mm_s)
    subjects = len(people)
    if subjects < 2:
        return draw_subject(tissue, 0, velocity_mm_s, count, rng)
    groups = tissue.drawn(GROUPS) if _inferred(tissue) else ()
    if groups:
        persons = [one for group in groups for one in group.parameter_sets]
        return People.of([persons[at] for at in rng.integers(len(persons), size=count)], velocity_mm_s)
    logs = log_parameters(people)
    middle = logs.mean(axis=0)
    scatter = (logs - middle).T @ (logs - middle) / (subjects - 1.0) * (1.0 + 1.0 / subjects)
    length, basis = np.linalg.eigh(scatter)
    root = (basis * np.sqrt(np.maximum(length, 0.0))) @ basis.T
    even = _even_draws(count, 1 + len(root), rng)
    spread = np.sqrt((subjects - 1.0) / (2.0 * gammaincinv(0.5 * (subjects - 1.0), even[:, :1])))
    shift = spread * (ndtri(even[:, 1:]) @ root)
    return people_of_logs(people, middle + np.clip(shift, -FARTHEST, FARTHEST))


def _even_draws(count: int, size: int, rng: np.random.Generator) -> NDArray:
    """Draws in the unit cube that fill it evenly (Sobol's sequence, scrambled), shape (count, size).

    Plain draws leave more or less than their share beyond the ends of an interval, and one seed does so always.
    """
    from scipy.stats.qmc import Sobol

    power = int(np.ceil(np.log2(max(count, 2))))
    draws = Sobol(size, seed=rng).random_base2(power)[rng.permutation(1 << power)[:count]]
    return np.clip(draws, 1e-9, 1.0 - 1e-9)


def _inferred(tissue: Tissue) -> bool:
    """Whether draws lie beside the tissue's file: it is in the library and all its subjects are inferred."""
    if tissue.origin == "file" or not law_named(tissue.law).fitted:
        return False
    return all(number.kind == "inferred" for one in tissue.subjects for number in flatten(one.numbers).values())
