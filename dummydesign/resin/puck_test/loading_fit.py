"""Modulus, stiffening and plate friction of one batch from compression curves of pucks.

Model of a curve k: load(x) = A E u(c; alpha) B(c; alpha, friction), c = (x - x_k) / height, with u the closed
form between frictionless plates and B the table of ``pad.tables.puck``; x_k is where that curve's contact
begins. The machine's load is zeroed at x = 0, in the data and in the model alike. Modulus, stiffening and
friction are common to all curves of the batch.

Intervals: errors are taken as fully correlated along a curve and among the repeats on one puck, so that each
puck counts as ONE independent number, with the scatter between curves and the misfit of the law as its
size. Whatever friction keeps the mean square misfit below its minimum + 3.84 s^2 / pucks belongs to the 95 %
interval.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.inference.least_squares import solve_by_differences
from dummydesign.inference.likelihood import within
from dummydesign.pad.tables.puck import PuckTable, friction_of, uniaxial

Array = np.ndarray

GRIPS = np.linspace(0.0, 1.0, 26)
ALPHA_RANGE = (1.0, 6.0)
LARGEST_OFFSET = 0.04


@dataclass(frozen=True)
class LoadingCurve:
    """Load over compression of one test; curves with the same ``puck`` are repeats on it. [mm, N]"""

    name: str
    puck: str
    compression_mm: Array
    load_N: Array


@dataclass(frozen=True)
class PuckFit:
    """What the curves of one batch say; intervals are 95 %.

    ``friction`` is infinite for plates that hold the faces (bonded). ``rmse`` is the root mean square of
    the relative misfit, ``profile`` what each friction would make of the batch: (friction, young_kPa, chi square above
    the best).
    """

    young_kPa: float
    young_low_kPa: float
    young_high_kPa: float
    alpha: float
    friction: float
    friction_low: float
    friction_high: float
    offset_mm: dict[str, float]
    young_frictionless_kPa: float
    young_bonded_kPa: float
    rmse: float
    rmse_frictionless: float
    scatter: float
    profile: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class _Point:
    """Best fit at one friction."""

    grip: float
    log_young: float
    alpha: float
    offsets: Array
    mean_square: float
    residuals: list[Array]


def fit_pucks(
    curves: Sequence[LoadingCurve], diameter_mm: float, height_mm: float, table: PuckTable,
    window_mm: tuple[float, float],
) -> PuckFit:  # fmt: skip
    """Fit one batch."""
    table.check_shape(diameter_mm, height_mm)
    low, high = window_mm
    if not (0.0 < low < high <= 0.56 * height_mm):
        message = f"window_mm = {low:g} to {high:g} must lie within 0 and {0.56 * height_mm:.4g} (0.56 heights)"
        raise InputError(message, "out_of_range", "window_mm", window_mm, (0.0, 0.56 * height_mm))
    area = 0.25 * np.pi * diameter_mm**2
    parts = []
    for curve in curves:
        inside = (curve.compression_mm >= low) & (curve.compression_mm <= high)
        load = curve.load_N - float(np.interp(0.0, curve.compression_mm, curve.load_N))
        if inside.sum() < 5 or not np.all(load[inside] > 0.0):
            message = f"curve {curve.name}: needs 5 or more loads above 0 between {low:g} and {high:g} mm"
            raise InputError(message, "not_enough_data", "curve", curve.name)
        parts.append((curve.compression_mm[inside] / height_mm, load[inside] / area * 1e3))
    points: list[_Point] = []
    for grip_value in GRIPS[::-1]:
        points.append(_best(parts, table, grip_value, points[-1] if points else None))
    return _summarise(curves, points[::-1], height_mm)


def _model(table: PuckTable, alpha: float, grip_value: float, compression: Array, offset: float) -> Array:
    """Load over area and modulus, zeroed at no compression."""

    def load(c: Array) -> Array:
        c = np.maximum(c, 0.0)
        return uniaxial(alpha, c) * table.factor(alpha, grip_value, c)

    return load(compression - offset) - load(np.array([-offset]))[0]


def _best(parts: list[tuple[Array, Array]], table: PuckTable, grip_value: float, guess: _Point | None) -> _Point:
    count = len(parts)
    if guess is None:
        c, stress = parts[0]
        middle = len(c) // 2
        model = _model(table, 2.0, grip_value, c[middle : middle + 1], 0.0)[0]
        start = np.r_[np.log(stress[middle] / model), 2.0, np.zeros(count)]
    else:
        start = np.r_[guess.log_young, np.clip(guess.alpha, 1.01, 5.99), guess.offsets]
    lower = np.r_[-20.0, ALPHA_RANGE[0], np.full(count, -LARGEST_OFFSET)]
    upper = np.r_[20.0, ALPHA_RANGE[1], np.full(count, LARGEST_OFFSET)]

    def residuals(q: Array) -> list[Array]:
        found = []
        for (c, stress), offset in zip(parts, q[2:]):
            value = np.exp(q[0]) * _model(table, q[1], grip_value, c, offset)
            found.append(np.log(np.maximum(value, 1e-12) / stress))
        return found

    best = solve_by_differences(
        lambda q: np.concatenate(residuals(q)), [start], lower, upper, scale=np.r_[0.1, 0.5, np.full(count, 0.003)]
    ).parameters
    rest = residuals(best)
    mean_square = float(np.mean(np.concatenate(rest) ** 2))
    return _Point(grip_value, best[0], best[1], best[2:], mean_square, rest)


def _summarise(curves: Sequence[LoadingCurve], points: list[_Point], height_mm: float) -> PuckFit:
    best = min(points, key=lambda point: point.mean_square)
    own = np.array([float(np.mean(rest)) for rest in best.residuals])
    scatter = float(np.std(own, ddof=1)) if len(own) > 1 else 0.02
    pucks = len({curve.puck for curve in curves})
    variance = (scatter**2 + best.mean_square) / pucks
    excess = [(point.mean_square - best.mean_square) / variance for point in points]
    kept = [points[place] for place in within(excess)]
    young = np.exp([point.log_young for point in kept])
    # One puck's modulus differs from another's: the mean of all is known to this.
    around = 1.96 * np.sqrt(variance)
    return PuckFit(
        young_kPa=float(np.exp(best.log_young)),
        young_low_kPa=float(young.min() * np.exp(-around)),
        young_high_kPa=float(young.max() * np.exp(around)),
        alpha=best.alpha,
        friction=friction_of(best.grip),
        friction_low=friction_of(kept[0].grip),
        friction_high=friction_of(kept[-1].grip),
        offset_mm={curve.name: float(o * height_mm) for curve, o in zip(curves, best.offsets)},
        young_frictionless_kPa=float(np.exp(points[0].log_young)),
        young_bonded_kPa=float(np.exp(points[-1].log_young)),
        rmse=float(np.sqrt(best.mean_square)),
        rmse_frictionless=float(np.sqrt(points[0].mean_square)),
        scatter=scatter,
        profile=tuple((friction_of(p.grip), float(np.exp(p.log_young)), above) for p, above in zip(points, excess)),
    )
