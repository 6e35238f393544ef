"""``tissues add-points``: update a tissue by points read off a figure or by a few measured depths."""

from __future__ import annotations

import math
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.datafiles import find
from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.own_files import hidden_by
from dummydesign.core.quantity import Quantity
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from dummydesign.tissue.model.tissue_file import KIND, load_tissue, tissue_toml
from dummydesign.tissue.population.from_traces import tissue_folder
from dummydesign.tissue.population.next_measurement import next_measurement
from dummydesign.tissue.population.points import Steady, read_points
from dummydesign.tissue.population.posterior import (
    COLUMNS,
    draws_csv,
    draws_path,
    read_draws,
    subject_of,
    typical_subjects,
    weighted_quantile,
)
from dummydesign.tissue.population.protocol import STEADY_N

FEWEST_EFFECTIVE = 20.0
"""Draws that must be left in effect; with fewer the points contradict what was inferred."""


def add_points(name: str, points: str) -> dict[str, Any]:
    """Update a tissue by points and keep it under the same name in the user's folder.

    Every subject's points give its gamma1 = F / x^3 by weighted least squares in logarithms. In an
    inferred tissue the measured persons stand as they are; the posterior of the population is weighted
    by how well it foresaw them (persons are normal in ln gamma1 with the mean and spread of each draw),
    and what is left of five subjects comes from it. In another tissue the subject of that name is
    combined with its points.

    Parameters
    ----------
    name : str
        Tissue to update.
    points : str
        CSV with ``subject,depth_mm,force_N`` and, if known, ``depth_error_mm`` and ``force_error_N``
        (one standard deviation); else 2 % of the largest value on each axis is taken.

    Raises
    ------
    InputError
        With file and line for bad points; for an unknown tissue.
    """
    try:
        tissue = load_tissue(name)
    except InputError as problem:
        raise InputError(f"{problem}; points update a tissue that is there, 'add-curves' and 'add' make one") from None
    entry = find(KIND, "tissue", name)
    if "gamma1_N_per_mm3" not in tissue.bands:
        raise InputError(
            f"tissue '{tissue.name}' is {law_named(tissue.law).words}: points update gamma1 of a law, which it "
            "does not have; make a tissue of its own from them"
        )
    folder = tissue_folder(tissue.name)
    steady = read_points(Path(points))
    warnings = [
        {"code": "not_cubic", "message": f"{one.name}: the points scatter {one.scatter:.1f} times as much about "
         "gamma1 x^3 as their reading errors allow; its interval was widened"}
        for one in steady if one.scatter > 2.0
    ]  # fmt: skip
    draws_file = draws_path(entry.path)
    files = {"tissue": folder / f"{tissue.name}.toml"}
    extra: dict[str, Any] = {}
    if draws_file.is_file() and "inferred" in tissue.kinds:
        draws, weight = read_draws(draws_file)
        known = [one for one in _already(tissue) if one.name not in {new.name for new in steady}]
        updated, posterior, told = _update_inferred(tissue, draws, weight, known + steady)
        files["draws"] = folder / f"{tissue.name}_draws.csv"
        # the draws keep their weight without points: every update starts from there with all points at once
        write_text(files["draws"], draws_csv(draws, weight))
        extra["next_measurement"] = next_measurement(draws, posterior, len(known + steady))
        warnings += told
    else:
        updated, told = _update_fitted(tissue, steady)
        warnings += told
    write_text(files["tissue"], tissue_toml(updated))
    if entry.origin == "built-in":
        warnings += hidden_by(KIND, "tissue", tissue.name)
    before, after = (t.bands["gamma1_N_per_mm3"].to_dict() for t in (tissue, updated))
    return {
        "inputs": {"action": "add-points", "name": name, "points": points, "origin_before": entry.origin},
        **updated.to_dict(),
        "before": {"gamma1_N_per_mm3": before},
        "after": {"gamma1_N_per_mm3": after},
        "warnings": warnings,
        "files": {role: str(path) for role, path in files.items()},
        **extra,
    }


def _already(tissue: Tissue) -> list[Steady]:
    """Persons of the tissue whose gamma1 came from points before."""
    found = []
    for subject in tissue.subjects:
        gamma1 = subject.numbers["gamma1_N_per_mm3"]
        if gamma1.kind == "digitised":
            deviation = math.log(gamma1.high / gamma1.low) / 3.92
            found.append(Steady(subject.name, math.log(gamma1.value), deviation, gamma1.source, 0.0))
    return found


def _update_inferred(
    tissue: Tissue, draws: NDArray, weight: NDArray, steady: list[Steady]
) -> tuple[Tissue, NDArray, list[dict[str, str]]]:
    """Measured persons beside what the reweighted posterior says of the rest and of all arms."""
    logs = np.log(draws[..., 0])
    mean, spread = logs.mean(axis=1), logs.std(axis=1, ddof=1)
    fit = np.zeros(len(draws))
    for one in steady:
        variance = spread**2 + one.deviation**2
        fit += -0.5 * (one.log_gamma1 - mean) ** 2 / variance - 0.5 * np.log(variance)
    updated, warnings = _tempered(weight, fit)
    measured = {one.name: one for one in steady}
    missing = max(draws.shape[1] - len(measured), 0)
    centre = float(updated @ mean / updated.sum())
    width = float(updated @ spread / updated.sum())
    unit = [NormalDist().inv_cdf((k + 0.5) / missing) for k in range(missing)]
    people = [(one.name, one.log_gamma1) for one in steady]
    people += [(f"inferred-{k + 1}-of-{missing}", centre + width * z) for k, z in enumerate(unit)]
    people.sort(key=lambda pair: pair[1])
    # a person who was not measured: the population's centre is uncertain, and so is the place in it
    unknown = math.sqrt(float(updated @ (mean - centre) ** 2 / updated.sum()) + (0.7 * width) ** 2)
    return _with_people(tissue, draws, updated, people, measured, unknown), updated, warnings


def _with_people(
    tissue: Tissue,
    draws: NDArray,
    weight: NDArray,
    people: list[tuple[str, float]],
    measured: dict[str, Steady],
    unknown: float,
) -> Tissue:
    """Give everybody the arms of the posterior, with intervals, and make the tissue."""
    gamma1 = np.exp([value for _, value in people])
    value = _arms_for(draws, weight, gamma1)
    low, high = _relative_interval(draws, weight)
    source = f"posterior of {tissue.name} given points of {', '.join(measured)}"
    subjects = []
    for row, (name, _) in enumerate(people):
        one = measured.get(name)
        span = math.exp(1.96 * (one.deviation if one else unknown))
        kinds = [("digitised", one.source) if one else ("inferred", source)]
        kinds += [("inferred", source)] * (len(COLUMNS) - 1)
        least = np.r_[value[row, 0] / span, value[row, 1:] * low]
        most = np.r_[value[row, 0] * span, value[row, 1:] * high]
        subjects.append(subject_of(name, value[row], least, most, kinds))
    notes = (
        f"gamma1 of {', '.join(measured)} from points; everything else inferred.",
        *tissue.notes[1:],
    )
    return Tissue(tissue.name, tissue.title, tissue.law, tuple(subjects), tissue.sources, notes, "user")


def _relative_interval(draws: NDArray, weight: NDArray) -> tuple[NDArray, NDArray]:
    """Ends of the 95 % interval over the median of gamma2, gamma3 and the c at known gamma1, shape (6,)."""
    gamma1 = draws[..., :1]
    area = np.cbrt(STEADY_N / gamma1) ** 2
    relative = np.concatenate([draws[..., 1:3] / gamma1, draws[..., 3:] / (gamma1 * area)], axis=-1)
    flat, share = relative.reshape(-1, 6), np.repeat(weight, draws.shape[1])
    low, middle, high = (weighted_quantile(flat, at, share) for at in (0.025, 0.5, 0.975))
    return low / middle, high / middle


def _arms_for(draws: NDArray, weight: NDArray, gamma1: NDArray) -> NDArray:
    """Rows (n, 7) for given rising gamma1; more than five people take the five sets of arms in turn."""
    count = draws.shape[1]
    typical = typical_subjects(draws, weight)
    relative = typical.copy()
    area = np.cbrt(STEADY_N / typical[:, 0]) ** 2
    relative[:, 1:3] /= typical[:, :1]
    for column, arm in ((3, 1), (4, 1), (5, 2), (6, 2)):
        relative[:, column] = typical[:, column] / (typical[:, arm] * area)
    rows = np.empty((len(gamma1), typical.shape[1]))
    for row, value in enumerate(gamma1):
        place = round(row * (count - 1) / max(len(gamma1) - 1, 1)) if len(gamma1) <= count else row % count
        rows[row, 0] = value
        rows[row, 1:3] = relative[place, 1:3] * value
        own_area = np.cbrt(STEADY_N / value) ** 2
        for column, arm in ((3, 1), (4, 1), (5, 2), (6, 2)):
            rows[row, column] = relative[place, column] * rows[row, arm] * own_area
    return rows


def _tempered(weight: NDArray, log_likelihood: NDArray) -> tuple[NDArray, list[dict[str, str]]]:
    """Weights times likelihood, flattened as far as needed to keep :data:`FEWEST_EFFECTIVE` draws in effect."""
    strength = 1.0
    while True:
        logs = np.log(np.maximum(weight, 1e-300)) + strength * log_likelihood
        new = np.exp(logs - logs.max())
        if new.sum() ** 2 / (new**2).sum() >= FEWEST_EFFECTIVE or strength < 1e-3:
            break
        strength *= 0.7
    if strength == 1.0:
        return new / new.sum(), []
    message = (
        "the points lie far out in what was inferred (or are very exact); the inferred part was moved only "
        f"with {strength:.2f} of their weight and is not to be trusted much; the measured persons stand as given"
    )
    return new / new.sum(), [{"code": "points_contradict", "message": message}]


def _update_fitted(tissue: Tissue, steady: list[Steady]) -> tuple[Tissue, list[dict[str, str]]]:
    """Combine points with the subjects of the same name; refuse names that are not there."""
    warnings = []
    subjects = {subject.name.lower(): subject for subject in tissue.subjects}
    for one in steady:
        if one.name.lower() not in subjects:
            raise InputError(
                f"tissue {tissue.name} has no subject '{one.name}' and no posterior to take its arms from; "
                f"its subjects are {', '.join(s.name for s in tissue.subjects)}"
            )
        subject = subjects[one.name.lower()]
        old = subject.numbers["gamma1_N_per_mm3"]
        old_deviation = max(math.log(old.high / old.low) / 3.92, 1e-4)
        apart = abs(math.log(old.value) - one.log_gamma1) / math.hypot(old_deviation, one.deviation)
        if apart > 3:
            warnings.append(
                {"code": "points_contradict", "message": f"{one.name}: points say gamma1 = "
                 f"{math.exp(one.log_gamma1):.4g}, the tissue {old.value:.4g} N/mm3, {apart:.1f} standard "
                 "deviations apart; both were combined all the same"}
            )  # fmt: skip
        a, b = old_deviation**-2, one.deviation**-2
        mean, span = (a * math.log(old.value) + b * one.log_gamma1) / (a + b), math.exp(1.96 * (a + b) ** -0.5)
        value = math.exp(mean)
        source = f"{one.source}; combined with {old.source}"
        number = Quantity(value, value / span, value * span, old.kind, source)
        numbers = {**subject.numbers, "gamma1_N_per_mm3": number}
        p = subject.parameters
        changed = Parameters(p.law, value, p.gamma_N_per_mm3, p.c_N_s_per_mm)
        subjects[one.name.lower()] = Subject(subject.name, changed, numbers)
    return (
        Tissue(tissue.name, tissue.title, tissue.law, tuple(subjects.values()), tissue.sources, tissue.notes, "user"),
        warnings,
    )
