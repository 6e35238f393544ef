"""Persons that a tissue's data allow: each subject within its own intervals, and one more person of their kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.person.people import People
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.posterior import FARTHEST, drawn_tissues
from dummydesign.tissue.model.tissue import flatten, nest

if TYPE_CHECKING:
    from dummydesign.tissue.model.tissue import Subject, Tissue

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
    ends = []
    for end in ("low", "high"):
        values = nest({key: getattr(number, end) for key, number in flatten(subject.numbers).items()})
        ends.append(Parameters.from_dict(subject.parameters.law, values))
    low, high = (log_parameters(People.of([one], velocity_mm_s))[0] for one in ends)
    return (high - low) / WIDTH


def draw_subject(tissue: Tissue, row: int, velocity_mm_s: float, count: int, rng: np.random.Generator) -> People:
    """Draw one subject within its own intervals, ``count`` times.

    Parameters are drawn one by one: what a fit leaves open together is then counted too wide, never too narrow.
    """
    people = People.of(tissue.parameter_sets[row : row + 1], velocity_mm_s)
    spread = own_spread(tissue.subjects[row], velocity_mm_s)
    logs = log_parameters(people) + spread * rng.standard_normal((count, len(spread)))
    return people_of_logs(people, logs)


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
    from scipy.special import ndtri
    from scipy.stats import chi2

    people = People.of(tissue.parameter_sets, velocity_mm_s)
    subjects = len(people)
    if subjects < 2:
        return draw_subject(tissue, 0, velocity_mm_s, count, rng)
    groups = drawn_tissues(tissue, GROUPS) if _inferred(tissue) else ()
    if groups:
        persons = [one for group in groups for one in group.parameter_sets]
        chosen = [persons[at] for at in rng.integers(len(persons), size=count)]
        return People.of(chosen, velocity_mm_s)
    logs = log_parameters(people)
    middle = logs.mean(axis=0)
    scatter = (logs - middle).T @ (logs - middle) / (subjects - 1.0) * (1.0 + 1.0 / subjects)
    length, basis = np.linalg.eigh(scatter)
    root = (basis * np.sqrt(np.maximum(length, 0.0))) @ basis.T
    even = _even_draws(count, 1 + len(root), rng)
    spread = np.sqrt((subjects - 1.0) / chi2.ppf(even[:, :1], subjects - 1.0))
    shift = spread * (ndtri(even[:, 1:]) @ root)
    return people_of_logs(people, middle + np.clip(shift, -FARTHEST, FARTHEST))


def _even_draws(count: int, size: int, rng: np.random.Generator) -> NDArray:
    """Draws in the unit cube that fill it evenly (Sobol's sequence, scrambled), shape (count, size).

    Plain draws leave more or less than their share beyond the ends of an interval, and one seed does so always.
    """
    from scipy.stats.qmc import Sobol

    power = int(np.ceil(np.log2(max(count, 2))))
    found = Sobol(size, seed=rng).random_base2(power)[rng.permutation(1 << power)[:count]]
    return np.clip(found, 1e-9, 1.0 - 1e-9)


def _inferred(tissue: Tissue) -> bool:
    """Whether draws lie beside the tissue's file: it is in the library and all its subjects are inferred."""
    if tissue.origin == "file" or not law_named(tissue.law).fitted:
        return False
    return all(number.kind == "inferred" for one in tissue.subjects for number in flatten(one.numbers).values())
