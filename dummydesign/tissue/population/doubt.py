"""What is not known of a tissue: other groups of persons that its data allow, each as a tissue of its own.

An inferred tissue has draws of its posterior; each is such a group. Of a tissue of n measured subjects the logarithms
of the parameters are taken as normal over persons, and mean and spread of the population as what n persons leave of
them (Jeffreys' prior): the mean is t-distributed with n - 1 degrees of freedom about the subjects', the variance an
inverse chi-squared multiple of theirs. Parameters that go together in the subjects go together in the draws.

References
----------
Gelman et al., Bayesian Data Analysis, 3rd ed., section 3.2 (normal data with unknown mean and variance).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.quantity import Quantity
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from dummydesign.tissue.model.tissue_file import KIND

SEED, FARTHEST = 47, float(np.log(10.0))
"""No parameter is drawn farther than a factor of ten from the middle of the subjects."""


def drawn_tissues(tissue: Tissue, count: int, seed: int = SEED) -> tuple[Tissue, ...]:
    """Tissues that the data of one allow; none where one subject, or a standard's spring, says nothing of others.

    Parameters
    ----------
    tissue : Tissue
    count : int
        How many.
    seed : int
        The same seed gives the same tissues.
    """
    if len(tissue.subjects) < 2 or not law_named(tissue.law).fitted:
        return ()
    rng = np.random.default_rng(seed)
    groups = _posterior(tissue, count)
    return groups or tuple(_of_subjects(tissue, rng) for _ in range(count))


def _posterior(tissue: Tissue, count: int) -> tuple[Tissue, ...]:
    """Draws that lie beside the file of an inferred tissue, by their weights; none where a person was measured."""
    from dummydesign.core.datafiles import find
    from dummydesign.tissue.population.posterior import COLUMNS, draws_path, read_draws, subject_of

    inferred = all(subject.numbers["gamma1_N_per_mm3"].kind == "inferred" for subject in tissue.subjects)
    if tissue.origin == "file" or not inferred:
        return ()
    path = draws_path(find(KIND, "tissue", tissue.name).path)
    if not path.is_file():
        return ()
    draws, weight = read_draws(path)
    order = _in_strata(np.log(draws[..., 0]), weight, max(round(np.sqrt(count)), 1))
    # evenly over the weights, so that few draws stand for all
    place = np.searchsorted(np.cumsum(weight[order] / weight.sum()), (np.arange(count) + 0.5) / count)
    kinds = [("inferred", "drawn from the posterior")] * len(COLUMNS)
    found = []
    for one in draws[order[np.minimum(place, len(draws) - 1)]]:
        people = one[np.argsort(one[:, 0])]
        subjects = tuple(
            subject_of(subject.name, row, row, row, kinds) for subject, row in zip(tissue.subjects, people)
        )
        found.append(replace(tissue, subjects=subjects))
    return tuple(found)


def _in_strata(logs: NDArray, weight: NDArray, strata: int) -> NDArray:
    """Order of draws (m, persons) by strata of rising stiffness, in each by the spread of persons, there and back."""
    by_mean = np.argsort(logs.mean(axis=1), kind="stable")
    passed = np.cumsum(weight[by_mean]) / weight.sum()
    stratum = np.minimum((passed - 0.5 * weight[by_mean] / weight.sum()) * strata, strata - 1).astype(int)
    spread = logs[by_mean].std(axis=1) * np.where(stratum % 2, -1.0, 1.0)
    return by_mean[np.lexsort((spread, stratum))]


def _of_subjects(tissue: Tissue, rng: np.random.Generator) -> Tissue:
    """The subjects moved and spread as their number allows."""
    values = np.log(np.array([list(_flat(subject).values()) for subject in tissue.subjects]))
    moved = np.exp(drawn_logs(values, rng))
    names = list(_flat(tissue.subjects[0]))
    return replace(
        tissue, subjects=tuple(_moved(one, dict(zip(names, row))) for one, row in zip(tissue.subjects, moved))
    )


def drawn_logs(values: NDArray, rng: np.random.Generator) -> NDArray:
    """Another group of n persons with a mean and spread that n persons (n, parameters) leave open.

    Parameters
    ----------
    values : ndarray, shape (n, parameters)
        Logarithms of the parameters of the persons.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n, parameters)
    """
    n = len(values)
    middle = values.mean(axis=0)
    residual = values - middle
    spread = np.sqrt((n - 1) / rng.chisquare(n - 1))
    shift = rng.standard_normal(n) @ residual / np.sqrt(n * (n - 1))
    return middle + np.clip(spread * (shift + residual), -FARTHEST, FARTHEST)


def _flat(subject: Subject) -> dict[tuple[str, str], float]:
    """Every number of a subject by (name, speed); no speed for springs."""
    found: dict[tuple[str, str], float] = {}
    for name, entry in subject.numbers.items():
        if isinstance(entry, dict):
            found |= {(name, speed): number.value for speed, number in entry.items()}
        else:
            found[name, ""] = entry.value
    return found


def _moved(subject: Subject, values: dict[tuple[str, str], float]) -> Subject:
    numbers: dict[str, Any] = {}
    plain: dict[str, Any] = {}
    for (name, speed), value in values.items():
        number = Quantity(value, value, value, "inferred", "drawn from what the number of subjects leaves open")
        if speed:
            numbers.setdefault(name, {})[speed] = number
            plain.setdefault(name, {})[speed] = value
        else:
            numbers[name], plain[name] = number, value
    return Subject(subject.name, Parameters.from_dict(subject.parameters.law, plain), numbers)
