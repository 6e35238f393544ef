"""Posterior draws of an inferred tissue: what is stored of them, and the subjects they represent."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.tissue.model.parameters import Parameters, speed_key
from dummydesign.tissue.model.tissue import Subject
from dummydesign.tissue.population.protocol import LAW, SPEEDS_MM_S, STEADY_N

COLUMNS = (
    "gamma1_N_per_mm3",
    "gamma2_N_per_mm3",
    "gamma3_N_per_mm3",
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
    lines = ["draw,weight,rank," + ",".join(COLUMNS)]
    for index, draw in enumerate(draws):
        for rank, row in enumerate(draw, start=1):
            lines.append(f"{index + 1},{share[index]:.5g},{rank}," + ",".join(f"{x:.4g}" for x in row))
    return "\n".join(lines) + "\n"


def read_draws(path: Path) -> tuple[NDArray, NDArray]:
    """Read draws (m, 5, 7) and their weights (m,).

    Raises
    ------
    InputError
        When the file is not one that :func:`draws_csv` wrote.
    """
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream))
        values = np.array([[float(row[name]) for name in COLUMNS] for row in rows])
        weight = np.array([float(row["weight"]) for row in rows])
        ranks = max(int(row["rank"]) for row in rows)
        draws = values.reshape(-1, ranks, len(COLUMNS))
    except (OSError, KeyError, ValueError, TypeError) as problem:
        raise InputError(f"{path.name}: cannot be read as posterior draws ({problem})") from None
    return draws, weight[::ranks]


def weighted_quantile(values: NDArray, share: float, weight: NDArray) -> NDArray:
    """Quantile of weighted values along their first axis.

    Parameters
    ----------
    values : ndarray, shape (m, ...)
        The draws.
    share : float
        Which quantile, from 0 to 1.
    weight : ndarray, shape (m,)
        Of each draw; they need not add up to 1.

    Returns
    -------
    ndarray, shape (...)
    """
    order = np.argsort(values, axis=0)
    ordered = np.take_along_axis(values, order, 0)
    cumulated = np.cumsum(weight[order], axis=0)
    cumulated = (cumulated - 0.5 * weight[order]) / weight.sum()
    place = np.sum(cumulated < share, axis=0)
    upper, lower = np.minimum(place, len(values) - 1), np.maximum(place - 1, 0)

    def take(source: NDArray, at: NDArray) -> NDArray:
        return np.take_along_axis(source, at[None], 0)[0]

    below, above = take(cumulated, lower), take(cumulated, upper)
    gap = np.where(above > below, above - below, 1.0)
    part = np.clip((share - below) / gap, 0.0, 1.0)
    return take(ordered, lower) * (1 - part) + take(ordered, upper) * part


def typical_subjects(draws: NDArray, weight: NDArray | None = None, gamma1: NDArray | None = None) -> NDArray:
    """Five subjects that differ as those of the draws do.

    gamma1 are the posterior medians of the k-th smallest of five (or as given); the ratios gamma_i / gamma1 and the
    times c / (gamma x^2) at the depth of 10 N are medians of their own k-th smallest, dealt to the subjects by
    :data:`DEALT`; the gammas of an arm are put in the order of gamma1.

    Parameters
    ----------
    draws : ndarray, shape (m, 5, 7)
        Posterior draws, columns as :data:`COLUMNS`.
    weight : ndarray, shape (m,), optional
        Of each draw; equal by default.
    gamma1 : ndarray, shape (5,), optional
        Measured gamma1 to be kept. [N/mm3]

    Returns
    -------
    ndarray, shape (5, 7)
        Subjects by rising gamma1.
    """
    weight = np.ones(len(draws)) if weight is None else weight

    def medians(values: NDArray) -> NDArray:
        return weighted_quantile(np.sort(values, axis=1), 0.5, weight)

    drawn = draws[..., 0]
    typical = np.empty(draws.shape[1:])
    typical[:, 0] = medians(drawn) if gamma1 is None else np.sort(gamma1)
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
    """Make a subject from a row of values and the ends of their intervals.

    Parameters
    ----------
    name : str
        Of the subject.
    value, low, high : ndarray, shape (7,)
        Columns as :data:`COLUMNS`; an end that contradicts its value is moved to it.
    kinds : list of (str, str)
        Kind and source of each column.

    Returns
    -------
    Subject
    """
    numbers: dict[str, Any] = {}
    for column, label in enumerate(COLUMNS):
        centre, least, most = (float(f"{row[column]:.4g}") for row in (value, low, high))
        quantity = Quantity(centre, min(least, centre), max(most, centre), *kinds[column])
        key, _, speed = label.partition(".")
        if speed:
            numbers.setdefault(key, {})[speed] = quantity
        else:
            numbers[key] = quantity
    plain = {
        key: {speed: q.value for speed, q in entry.items()} if isinstance(entry, dict) else entry.value
        for key, entry in numbers.items()
    }
    return Subject(name, Parameters.from_dict(LAW, plain), numbers)
