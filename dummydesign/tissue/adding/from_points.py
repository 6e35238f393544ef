"""`tissues add-points`: update a tissue by points or measured depths; what to measure next."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.quantity import Quantity
from dummydesign.core.user_library import find, hidden_by
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue.adding.from_traces import tissue_folder
from dummydesign.tissue.adding.observations import SteadyPoints, read_points
from dummydesign.tissue.model import posterior
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import KIND, read_tissue, tissue_toml

MEASUREMENTS = {
    "steady_depth": "the depth at which one more person carries a steady 10 N",
    "fast_peak": "one press of one person at 250 mm/s to 10 N: its peak over the steady force",
    "slow_peak": "one press of one person at 10 mm/s to 10 N: its peak over the steady force",
    "slow_decay": "the force of one person 1 s after the stop of a press at 10 mm/s to 10 N",
    "fast_decay": "the force of one person 50 ms after the stop of a press at 250 mm/s to 10 N",
}
"""What could be measured on one person, in words."""


def next_measurement(draws: NDArray, weight: NDArray, persons_measured: int = 0) -> dict[str, Any]:
    """Rank single measurements on one person by how much of the ranges' variance they would remove.

    The ranges are described at 10 N by the logarithms of the smallest and largest depth, peaks at both
    speeds, and forces 1 s (10 mm/s) and 50 ms (250 mm/s) after the stop. Over the draws, the variance
    of each that a linear regression on the measured quantity explains is what would be saved.
    """
    seen = _observed(draws)
    outcomes = np.column_stack([end(seen[name], axis=1) for name in MEASUREMENTS for end in (np.min, np.max)])
    share = weight / weight.sum()
    middle = draws.shape[1] // 2
    ranking: list[dict[str, Any]] = []
    for name in MEASUREMENTS:
        if name == "steady_depth" and persons_measured >= draws.shape[1]:
            continue
        at = seen[name][:, middle]
        centred, spread = at - share @ at, outcomes - share @ outcomes
        variance = share @ centred**2
        explained = (share @ (centred[:, None] * spread)) ** 2 / max(variance, 1e-30)
        ranking.append({"measurement": name, "variance_removed": float(explained.sum() / (share @ spread**2).sum())})
    ranking.sort(key=lambda row: -row["variance_removed"])
    best = ranking[0]
    text = f"{MEASUREMENTS[best['measurement']]} (would remove {100 * best['variance_removed']:.0f} % of the variance)"
    return {**best, "text": text, "ranking": ranking}


def _observed(draws: NDArray) -> dict[str, NDArray]:
    """Logarithms of what a press of each person (m, 5) to 10 N would show."""
    gamma1, gamma = draws[..., 0], draws[..., 1:3]
    depth = np.cbrt(posterior.STEADY_N / gamma1)
    seen = {"steady_depth": np.log(depth)}
    for at, speed in enumerate(posterior.SPEEDS_MM_S):
        motion = ramp_and_hold(speed, depth, 10.0, ramp_points=24, brake_points=8, hold_points=24)
        curve = law_named(posterior.LAW).force(motion, gamma1, gamma, draws[..., [3 + at, 5 + at]])
        label, after = (("slow", 1.0), ("fast", 0.05))[at]
        seen[f"{label}_peak"] = np.log(curve.max(axis=-1) / curve[..., -1])
        # the hold is sampled alike for all persons
        since = motion.time_s[..., -24:] - (motion.time_s[..., -1:] - 10.0)
        index = int(np.argmin(np.abs(since.reshape(-1, 24)[0] - after)))
        seen[f"{label}_decay"] = np.log(curve[..., index - 24] / curve[..., -1])
    return seen


FEWEST_EFFECTIVE = 20.0
"""Draws that must be left in effect; with fewer the points contradict what was inferred."""


def add_points(name: str, points: str) -> dict[str, Any]:
    """Update a tissue by points and keep it under the same name in the user's folder.

    Every subject's points give its gamma1 = F / x^3 by weighted least squares in logarithms. In an
    inferred tissue the measured persons stand as they are; the posterior of the population is weighted
    by how well it foresaw them (persons are normal in ln gamma1 with the mean and spread of each draw),
    and the rest of five subjects comes from it. In another tissue the subject of that name is
    combined with its points.
    """
    try:
        entry = find(KIND, "tissue", name)
        tissue = read_tissue(entry)
    except InputError as problem:
        message = f"{problem}; points update a tissue that is there, 'add-curves' and 'add' make one"
        raise InputError(message, problem.code, problem.quantity, problem.value, problem.allowed) from None
    if "gamma1_N_per_mm3" not in tissue.bands:
        raise InputError(
            f"tissue '{tissue.name}' is {law_named(tissue.law).words}: points update gamma1 of a law, which it "
            "does not have; make a tissue of its own from them",
            "unsupported",
            "tissue",
            tissue.name,
        )
    folder = tissue_folder(tissue.name)
    steady = read_points(Path(points))
    warnings = [
        {
            "code": "not_cubic",
            "message": f"{one.name}: the points scatter {one.scatter:.1f} times as much about "
            "gamma1 x^3 as their reading errors allow; its interval was widened",
        }
        for one in steady
        if one.scatter > 2.0
    ]
    draws_file = posterior.draws_path(entry.path)
    files = {"tissue": folder / f"{tissue.name}.toml"}
    extra: dict[str, Any] = {}
    if draws_file.is_file() and "inferred" in tissue.kinds:
        draws, weight = posterior.read_draws(draws_file)
        known = [one for one in _already(tissue) if one.name not in {new.name for new in steady}]
        updated, after_points, notes = _update_inferred(tissue, draws, weight, known + steady)
        files["draws"] = folder / f"{tissue.name}_draws.csv"
        # the draws keep their weight without points: every update starts from there with all points at once
        write_text(files["draws"], posterior.draws_csv(draws, weight))
        extra["next_measurement"] = next_measurement(draws, after_points, len(known + steady))
    else:
        updated, notes = _update_fitted(tissue, steady)
    warnings += notes
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


def _already(tissue: Tissue) -> list[SteadyPoints]:
    """Persons of the tissue whose gamma1 came from points before."""
    known = []
    for subject in tissue.subjects:
        gamma1 = subject.numbers["gamma1_N_per_mm3"]
        if gamma1.kind == "digitised":
            deviation = math.log(gamma1.high / gamma1.low) / 3.92
            known.append(SteadyPoints(subject.name, math.log(gamma1.value), deviation, gamma1.source, 0.0))
    return known


def _update_inferred(
    tissue: Tissue, draws: NDArray, weight: NDArray, steady: list[SteadyPoints]
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
    measured: dict[str, SteadyPoints],
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
        kinds += [("inferred", source)] * (len(posterior.COLUMNS) - 1)
        least = np.r_[value[row, 0] / span, value[row, 1:] * low]
        most = np.r_[value[row, 0] * span, value[row, 1:] * high]
        subjects.append(posterior.subject_of(name, value[row], least, most, kinds))
    notes = (f"gamma1 of {', '.join(measured)} from points; everything else inferred.", *tissue.notes[1:])
    return replace(tissue, subjects=tuple(subjects), notes=notes, origin="user")


def _relative_interval(draws: NDArray, weight: NDArray) -> tuple[NDArray, NDArray]:
    """Ends of the 95 % interval over the median of gamma2, gamma3 and the c at known gamma1, shape (6,)."""
    gamma1 = draws[..., :1]
    area = np.cbrt(posterior.STEADY_N / gamma1) ** 2
    relative = np.concatenate([draws[..., 1:3] / gamma1, draws[..., 3:] / (gamma1 * area)], axis=-1)
    flat, share = relative.reshape(-1, 6), np.repeat(weight, draws.shape[1])
    low, middle, high = (posterior.weighted_quantile(flat, at, share) for at in (0.025, 0.5, 0.975))
    return low / middle, high / middle


def _arms_for(draws: NDArray, weight: NDArray, gamma1: NDArray) -> NDArray:
    """Rows (n, 7) for given rising gamma1; more than five people take the five sets of arms in turn."""
    count, last = draws.shape[1], max(len(gamma1) - 1, 1)
    typical = posterior.typical_subjects(draws, weight)
    area, own_area = (np.cbrt(posterior.STEADY_N / value)[:, None] ** 2 for value in (typical[:, 0], gamma1))
    ratio = typical[:, 1:3] / typical[:, :1]
    time = typical[:, 3:] / (typical[:, [1, 1, 2, 2]] * area)
    rows = np.arange(len(gamma1))
    chosen = np.round(rows * (count - 1) / last).astype(int) if len(gamma1) <= count else rows % count
    gamma = ratio[chosen] * gamma1[:, None]
    return np.c_[gamma1, gamma, time[chosen] * gamma[:, [0, 0, 1, 1]] * own_area]


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


def _update_fitted(tissue: Tissue, steady: list[SteadyPoints]) -> tuple[Tissue, list[dict[str, str]]]:
    """Combine points with the subjects of the same name; refuse names that are not there."""
    warnings = []
    subjects = {subject.name.lower(): subject for subject in tissue.subjects}
    for one in steady:
        if one.name.lower() not in subjects:
            raise InputError(
                f"tissue {tissue.name} has no subject '{one.name}' and no posterior to take its arms from; "
                f"its subjects are {', '.join(s.name for s in tissue.subjects)}",
                "unknown_name",
                "subject",
                one.name,
                [s.name for s in tissue.subjects],
            )
        subject = subjects[one.name.lower()]
        old = subject.numbers["gamma1_N_per_mm3"]
        old_deviation = max(math.log(old.high / old.low) / 3.92, 1e-4)
        distance = abs(math.log(old.value) - one.log_gamma1) / math.hypot(old_deviation, one.deviation)
        if distance > 3:
            warnings.append(
                {
                    "code": "points_contradict",
                    "message": f"{one.name}: points say gamma1 = "
                    f"{math.exp(one.log_gamma1):.4g}, the tissue {old.value:.4g} N/mm3, {distance:.1f} standard "
                    "deviations apart; both were combined anyway",
                }
            )
        a, b = old_deviation**-2, one.deviation**-2
        mean, span = (a * math.log(old.value) + b * one.log_gamma1) / (a + b), math.exp(1.96 * (a + b) ** -0.5)
        value = math.exp(mean)
        source = f"{one.source}; combined with {old.source}"
        number = Quantity(value, value / span, value * span, old.kind, source)
        numbers = {**subject.numbers, "gamma1_N_per_mm3": number}
        changed = replace(subject.parameters, gamma1_N_per_mm3=value)
        subjects[one.name.lower()] = replace(subject, parameters=changed, numbers=numbers)
    return replace(tissue, subjects=tuple(subjects.values()), origin="user"), warnings
