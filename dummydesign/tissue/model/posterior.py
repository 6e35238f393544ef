"""Posterior draws of an inferred tissue: stored, as subjects, and as groups of persons."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import csv_text
from dummydesign.core.quantity import Quantity
from dummydesign.core.user_library import find
from dummydesign.tissue.model.maxwell_law import speed_key
from dummydesign.tissue.model.subject import KIND, Subject, flatten, nest

Subjects = tuple[Subject, ...]
DRAWN = 49
"""Tissues that are drawn for what is not known of one."""

LAW = "ode"
"""Law of the inferred tissues."""

SPEEDS_MM_S = (10.0, 250.0)
"""Speeds at which dampers are given. [mm/s]"""

STEADY_N = 10.0
"""Force at the end of the hold at which depths and relaxation times are compared. [N]"""


COLUMNS = (
    *(f"gamma{number}_N_per_mm3" for number in (1, 2, 3)),
    *(f"c{arm}_N_s_per_mm.{speed_key(speed)}" for arm in (2, 3) for speed in SPEEDS_MM_S),
)

DEALT = {
    "gamma2": (1, 4, 0, 3, 2),
    "gamma3": (3, 0, 2, 4, 1),
    "time2": (2, 4, 1, 0, 3),
    "time3": (0, 3, 4, 1, 2),
}
"""Place in the order of its own values that each subject gets, by rising gamma1."""


def draws_path(tissue_path: Path) -> Path:
    """Path of the draws that belong to a tissue file."""
    return tissue_path.with_name(f"{tissue_path.stem}_draws.csv")


def draws_csv(draws: NDArray, weight: NDArray | None = None) -> str:
    """Write draws (m, 5, 7) as CSV: draw, weight, rank and the columns of :data:`COLUMNS`."""
    share = np.full(len(draws), 1.0 / len(draws)) if weight is None else weight / weight.sum()
    rows = (
        (index + 1, f"{share[index]:.5g}", rank, *(f"{x:.4g}" for x in row))
        for index, draw in enumerate(draws)
        for rank, row in enumerate(draw, start=1)
    )
    return csv_text(("draw", "weight", "rank", *COLUMNS), rows)


def read_draws(path: Path) -> tuple[NDArray, NDArray]:
    """Read draws (m, 5, 7) and their weights (m,)."""
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        values = np.array([[float(row[name]) for name in COLUMNS] for row in rows])
        weight = np.array([float(row["weight"]) for row in rows])
        ranks = max(int(row["rank"]) for row in rows)
        draws = values.reshape(-1, ranks, len(COLUMNS))
    except (OSError, KeyError, ValueError, TypeError) as problem:
        message = f"{path.name}: cannot be read as posterior draws ({problem})"
        raise InputError(message, "file_unreadable", "posterior") from None
    return draws, weight[::ranks]


def weighted_quantile(values: NDArray, share: float, weight: NDArray) -> NDArray:
    """Quantile of weighted values along their first axis."""
    found = []
    for column in values.reshape(len(values), -1).T:
        order = np.argsort(column)
        passed = np.cumsum(weight[order]) - 0.5 * weight[order]
        found.append(np.interp(share * weight.sum(), passed, column[order]))
    return np.reshape(found, values.shape[1:])


def typical_subjects(draws: NDArray, weight: NDArray | None = None) -> NDArray:
    """Five subjects that differ as those of the draws do.

    gamma1 are the posterior medians of the k-th smallest of five; the ratios gamma_i / gamma1 and the
    times c / (gamma x^2) at the depth of 10 N are medians of their own k-th smallest, dealt to the subjects by
    :data:`DEALT`; the gammas of an arm are put in the order of gamma1.
    """
    weight = np.ones(len(draws)) if weight is None else weight

    def medians(values: NDArray) -> NDArray:
        return weighted_quantile(np.sort(values, axis=1), 0.5, weight)

    drawn = draws[..., 0]
    typical = np.empty(draws.shape[1:])
    typical[:, 0] = medians(drawn)
    area, own_area = np.cbrt(STEADY_N / drawn) ** 2, np.cbrt(STEADY_N / typical[:, 0]) ** 2
    for arm in (2, 3):
        ratio = medians(draws[..., arm - 1] / drawn)[list(DEALT[f"gamma{arm}"])]
        typical[:, arm - 1] = np.sort(typical[:, 0] * ratio)
        for at in range(len(SPEEDS_MM_S)):
            column = 3 + 2 * (arm - 2) + at
            time = medians(draws[..., column] / (draws[..., arm - 1] * area))[list(DEALT[f"time{arm}"])]
            typical[:, column] = time * typical[:, arm - 1] * own_area
    return typical


def subject_of(name: str, value: NDArray, low: NDArray, high: NDArray, kinds: list[tuple[str, str]]) -> Subject:
    """Make a subject from a row of values and the ends of their intervals."""
    numbers = {}
    for column, label in enumerate(COLUMNS):
        centre, least, most = (float(f"{row[column]:.4g}") for row in (value, low, high))
        key, _, speed = label.partition(".")
        numbers[key, speed] = Quantity(centre, min(least, centre), max(most, centre), *kinds[column])
    return Subject.of(name, LAW, nest(numbers))


SEED, FARTHEST = 47, float(np.log(10.0))
"""No parameter is drawn farther than a factor of ten from the middle of the subjects."""


def posterior_subjects(name: str, subjects: Subjects, count: int) -> list[Subjects]:
    """Groups from the draws stored with a tissue, by their weights; none where it has none."""
    path = draws_path(find(KIND, "tissue", name).path)
    if not path.is_file():
        return []
    draws, weight = read_draws(path)
    order = _in_strata(np.log(draws[..., 0]), weight, max(round(np.sqrt(count)), 1))
    # evenly over the weights, so that few draws stand for all
    index = np.searchsorted(np.cumsum(weight[order] / weight.sum()), (np.arange(count) + 0.5) / count)
    kinds = [("inferred", "drawn from the posterior")] * len(COLUMNS)
    groups = []
    for one in draws[order[np.minimum(index, len(draws) - 1)]]:
        pairs = zip(subjects, one[np.argsort(one[:, 0])])
        groups.append(tuple(subject_of(subject.name, row, row, row, kinds) for subject, row in pairs))
    return groups


def _in_strata(logs: NDArray, weight: NDArray, strata: int) -> NDArray:
    """Order of draws (m, persons) by strata of rising stiffness, in each by the spread of persons, there and back."""
    by_mean = np.argsort(logs.mean(axis=1), kind="stable")
    passed = np.cumsum(weight[by_mean]) / weight.sum()
    stratum = np.minimum((passed - 0.5 * weight[by_mean] / weight.sum()) * strata, strata - 1).astype(int)
    spread = logs[by_mean].std(axis=1) * np.where(stratum % 2, -1.0, 1.0)
    return by_mean[np.lexsort((spread, stratum))]


def drawn_subjects(subjects: Subjects, count: int) -> list[Subjects]:
    """Groups of the subjects moved and spread as their number allows."""
    rng = np.random.default_rng(SEED)
    return [_drawn_group(subjects, rng) for _ in range(count)]


def _drawn_group(subjects: Subjects, rng: np.random.Generator) -> Subjects:
    flat = [flatten(subject.numbers) for subject in subjects]
    drawn = np.exp(drawn_logs(np.log([[number.value for number in numbers.values()] for numbers in flat]), rng))
    source = "drawn from what the number of subjects leaves open"
    group = []
    for subject, row in zip(subjects, drawn):
        numbers = {key: Quantity(value, value, value, "inferred", source) for key, value in zip(flat[0], row)}
        group.append(Subject.of(subject.name, subject.parameters.law, nest(numbers)))
    return tuple(group)


def drawn_logs(values: NDArray, rng: np.random.Generator) -> NDArray:
    """Another group of n persons with a mean and spread that n persons (n, parameters) leave open."""
    n = len(values)
    middle = values.mean(axis=0)
    residual = values - middle
    spread = np.sqrt((n - 1) / rng.chisquare(n - 1))
    shift = rng.standard_normal(n) @ residual / np.sqrt(n * (n - 1))
    return middle + np.clip(spread * (shift + residual), -FARTHEST, FARTHEST)
