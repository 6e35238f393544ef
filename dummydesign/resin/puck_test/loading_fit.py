"""Modulus, stiffening and plate friction of one batch from compression curves of pucks.

Model of a curve k: load(x) = A E u(c; alpha) B(c; alpha, friction), c = (x - x_k) / height, with u the closed
form between frictionless plates and B the table of ``pad.tables.puck``; x_k is where that curve's contact
begins. The machine's load is zeroed at x = 0, in the data and in the model alike. Modulus, stiffening and
friction are common to all curves of the batch.

A declaration of the plates (``puck_test.plates``) gives the friction a prior. Modulus, friction and alpha of a puck are
then the medians over what prior and curves leave open (:func:`over_friction`).

Intervals of :func:`fit_pucks`: errors are taken as fully correlated along a curve and among the repeats on one puck, so
that each puck counts as ONE independent number, with the scatter between curves and the misfit of the law as its
size. Whatever friction keeps the mean square misfit below its minimum + 3.84 s^2 / pucks belongs to the 95 %
interval.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.inference import noise as inference
from dummydesign.inference.binning import cut, distinct, hold_edges, mean_around
from dummydesign.inference.least_squares import CHI_SQUARE_95, solve_by_differences, within
from dummydesign.inference.noise import white_noise
from dummydesign.measurement.ramp_detection import Hold
from dummydesign.pad.tables.puck import PuckTable, friction_of, uniaxial
from dummydesign.resin.model.resin import PUCK_SCATTER
from dummydesign.resin.puck_test.plates import ALPHA_RANGE, OPEN, OverFriction, Plates, over_friction

Array = np.ndarray

GRIPS = np.linspace(0.0, 1.0, 26)
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
    the best). ``rmse_open`` is the misfit with the declared friction let go, ``levels`` are ln of each curve's force
    over the law's, ``known`` the spread when the friction is integrated over its prior.
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
    rmse_open: float
    levels: tuple[float, ...]
    known: OverFriction


@dataclass(frozen=True)
class _Point:
    """Best fit at one friction; ``spread`` are the standard deviations of ln modulus and alpha by the law's misfit."""

    grip: float
    log_young: float
    alpha: float
    offsets: Array
    mean_square: float
    residuals: list[Array]
    spread: Array


def fit_pucks(
    curves: Sequence[LoadingCurve],
    diameter_mm: float,
    height_mm: float,
    table: PuckTable,
    window_mm: tuple[float, float],
    plates: Plates = OPEN,
) -> PuckFit:
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
    points = _profile(parts, table, GRIPS)
    grips, prior = plates.nodes(GRIPS)
    free = min(points, key=lambda point: point.mean_square)
    return _summarise(curves, _profile(parts, table, grips, points) if plates else points, height_mm, prior, free)


def _profile(
    parts: list[tuple[Array, Array]], table: PuckTable, grips: Array, near: Sequence[_Point] = ()
) -> list[_Point]:
    """Best fits at some grips, by rising grip; the first begins at the nearest of those known."""
    points: list[_Point] = []
    for grip in grips[::-1]:
        start = points[-1] if points else min(near, key=lambda point: abs(point.grip - grip), default=None)
        points.append(_best(parts, table, float(grip), start))
    return points[::-1]


def _model(table: PuckTable, alpha: float, grip_value: float, compression: Array, offset: float) -> Array:
    """Load over area and modulus, zeroed at no compression."""

    def load(c: Array) -> Array:
        c = np.maximum(c, 0.0)
        return uniaxial(alpha, c) * table.factor(alpha, grip_value, c)

    return load(compression - offset) - load(np.array([-offset]))[0]


def _best(parts: list[tuple[Array, Array]], table: PuckTable, grip_value: float, guess: _Point | None) -> _Point:
    count = len(parts)
    c, stress = parts[0]
    middle = len(c) // 2
    model = _model(table, 2.0, grip_value, c[middle : middle + 1], 0.0)[0]
    starts = [np.r_[np.log(stress[middle] / model), 2.0, np.zeros(count)]]
    if guess is not None:
        # a neighbour may lie in another valley of alpha and offset
        starts.append(np.r_[guess.log_young, np.clip(guess.alpha, 1.01, 5.99), guess.offsets])
    lower = np.r_[-20.0, ALPHA_RANGE[0], np.full(count, -LARGEST_OFFSET)]
    upper = np.r_[20.0, ALPHA_RANGE[1], np.full(count, LARGEST_OFFSET)]

    def residuals(q: Array) -> list[Array]:
        models = [np.exp(q[0]) * _model(table, q[1], grip_value, c, at) for (c, _), at in zip(parts, q[2:])]
        return [np.log(np.maximum(model, 1e-12) / stress) for model, (_, stress) in zip(models, parts)]

    solved = solve_by_differences(
        lambda q: np.concatenate(residuals(q)), starts, lower, upper, scale=np.r_[0.1, 0.5, np.full(count, 0.003)]
    )
    best = solved.parameters
    assert solved.jacobian is not None
    rest = residuals(best)
    c = np.concatenate([c for c, _ in parts])
    law = LEAST_MISFIT**2 * alike(c, ALIKE) + TABLE_ERROR**2 * np.eye(len(c))
    # a contact known to no more than its bounds is a prior of them
    bounds = np.diag(np.r_[0.0, 0.0, np.full(count, LARGEST_OFFSET**-2)])
    spread = np.sqrt(np.diag(np.linalg.inv(solved.jacobian.T @ np.linalg.solve(law, solved.jacobian) + bounds)))[:2]
    return _Point(grip_value, best[0], best[1], best[2:], float(np.mean(np.concatenate(rest) ** 2)), rest, spread)


def _summarise(
    curves: Sequence[LoadingCurve], points: list[_Point], height_mm: float, prior: Array, free: _Point
) -> PuckFit:
    """Intervals from the points of a profile; ``free`` is the best fit without the declaration of the plates."""
    pucks = len({curve.puck for curve in curves})
    best = min(points, key=lambda point: point.mean_square)
    own = np.array([float(np.mean(rest)) for rest in best.residuals])
    scatter = float(np.std(own, ddof=1)) if len(own) > 1 else PUCK_SCATTER
    variance = (scatter**2 + best.mean_square) / pucks
    excess = np.array([(point.mean_square - best.mean_square) / variance for point in points])
    kept = within(excess.tolist())
    # One puck's modulus differs from another's: the mean of all is known to this.
    around = float(np.sqrt(CHI_SQUARE_95 * variance))
    logs = [points[index].log_young for index in kept]
    profile = tuple((friction_of(p.grip), float(np.exp(p.log_young)), float(one)) for p, one in zip(points, excess))
    grips, young, alpha = np.array([(p.grip, p.log_young, p.alpha) for p in points]).T
    young_spread, alpha_spread = np.array([point.spread for point in points]).T
    known = over_friction(
        grips,
        excess + prior,
        np.stack([young, np.hypot(np.sqrt(variance), young_spread)]),
        np.stack([alpha, alpha_spread]),
    )
    return PuckFit(
        young_kPa=float(np.exp(best.log_young)),
        young_low_kPa=float(np.exp(min(logs) - around)),
        young_high_kPa=float(np.exp(max(logs) + around)),
        alpha=best.alpha,
        friction=friction_of(best.grip),
        friction_low=friction_of(points[kept[0]].grip),
        friction_high=friction_of(points[kept[-1]].grip),
        offset_mm={curve.name: float(o * height_mm) for curve, o in zip(curves, best.offsets)},
        young_frictionless_kPa=profile[0][1],
        young_bonded_kPa=profile[-1][1],
        rmse=float(np.sqrt(best.mean_square)),
        rmse_frictionless=float(np.sqrt(points[0].mean_square)),
        scatter=scatter,
        profile=profile,
        rmse_open=float(np.sqrt(free.mean_square)),
        levels=tuple((-own).tolist()),
        known=known,
    )


def contradicts(declared: float, open_: float) -> bool:
    """Whether plates as declared misfit the curves, and any other friction does not (relative rms misfits)."""
    return declared**2 - open_**2 > CONTRADICTS * (TABLE_ERROR**2 + open_**2)


CONTRADICTS, TABLE_ERROR = 8.0, 0.003
"""Excess of the mean square misfit, over that with any friction, from which on declared plates are doubted: of 12 drawn
pucks of several laws the largest of a true declaration was 7, and 7 of 12 wrong ones were above 8. Smallest misfit that
counts: the friction tables' error."""


RAMP_BINS = 25


@dataclass(frozen=True)
class PuckPress:
    """One press in bins."""

    holds: tuple[Hold, ...]
    time_s: Array
    displacement_mm: Array
    average: Array
    start_s: Array
    end_s: Array
    samples: Array
    force_N: Array
    compression_mm: Array
    white_N: float


def reduce_press(
    time_s: Array, displacement_mm: Array, force_N: Array, holds: tuple[Hold, ...], window_mm: tuple[float, float]
) -> PuckPress:
    """Cut a press into bins: evenly in displacement over each ramp, growing by a third over each hold.

    Forces are counted from their median before the displacement reaches zero, which a contact that comes a little
    earlier does not move. Bins outside the window and what
    follows the last hold are left out.
    """
    last = int(np.searchsorted(time_s, holds[-1].end_s, side="right"))
    time, x, force = time_s[:last], displacement_mm[:last], force_N[:last]
    touch = int(np.argmax(x > 0.0))
    force = force - (float(np.median(force[:touch])) if touch else float(force[0]))
    step = float(np.median(np.diff(time)))
    edges = _edges(time, x, touch, step, holds)
    parts = np.linspace(0.0, 1.0, 5)[:-1]
    nodes = np.r_[(edges[:-1, None] + np.diff(edges)[:, None] * parts).ravel(), edges[-1]]
    held = np.any([(nodes > h.start_s + 3 * step) & (nodes < h.end_s) for h in holds], axis=0)
    motion = np.where(held, mean_around(nodes, time, x), np.interp(nodes, time, x))
    binning = cut(time, edges)
    displacement = binning.mean(x)
    keep = (displacement >= window_mm[0]) & (displacement <= window_mm[1])
    return PuckPress(
        holds,
        nodes,
        motion,
        binning.average(time, nodes)[keep],
        binning.start_s[keep],
        binning.end_s[keep],
        binning.samples[keep],
        binning.mean(force)[keep],
        displacement[keep],
        _white(time, force, holds),
    )


def _edges(time: Array, x: Array, touch: int, step: float, holds: tuple[Hold, ...]) -> Array:
    """Bin edges [s]: what is before contact, then each ramp evenly in displacement and each hold growing."""
    edges = [np.array([time[0]])]
    begin = time[max(touch - 1, 0)]
    for hold in holds:
        ramp = (time >= begin) & (time <= hold.start_s)
        rising = np.maximum.accumulate(x[ramp])
        if ramp.sum() > 1:
            levels = np.linspace(max(rising[0], 0.0), rising[-1], RAMP_BINS + 1)
            # where the motion stands for a sample the earlier time is taken
            edges.append(np.interp(levels, rising + 1e-12 * np.arange(len(rising)), time[ramp]))
        first = max(2.0 * step, 1e-4 * hold.duration_s)
        edges.append(hold.start_s + np.r_[0.0, hold_edges(first, hold.duration_s, 3)])
        begin = hold.end_s
    return distinct(np.concatenate(edges), 1e-9)


def _white(time: Array, force: Array, holds: tuple[Hold, ...]) -> float:
    """White noise of a sample in the later nine tenths of the holds. [N]"""
    late = [(time >= hold.start_s + 0.1 * hold.duration_s) & (time <= hold.end_s) for hold in holds]
    return white_noise(np.concatenate([np.diff(force[rows], 2) for rows in late]), robust=True)


LEAST_MISFIT = 0.02
"""Misfit of the one-term law that is always reckoned with: the middle of 19 mixtures, ``docs/ecoflex.md``."""
ALIKE = 0.15
"""Compression, over height, within which the law misfits alike."""
RIPPLE, RIPPLE_LENGTH = 0.0025, 0.02
"""Ripple of the solved force over compression, half of its mesh error, and the compression it goes with: the
bulging side comes to lie on the plate cell by cell."""
REPEAT = 0.01
"""Scatter of the force between presses of one puck (lubricant, seating, rest): assumed, by judgement."""
JITTER = 1e-4
"""Relative error of taking the motion as straight between nodes."""


@dataclass(frozen=True)
class PuckNoise:
    """Standard deviations: white per sample (each press has its own) and slow [N], life of the slow part [s], misfit
    over force."""

    white_N: float
    slow_N: float
    slow_time_s: float
    misfit: float


def joined(presses: Sequence[PuckPress], name: str) -> Array:
    """Values of the bins of all presses, one after the other."""
    return np.concatenate([getattr(press, name) for press in presses])


def alike(c: Array, length: float) -> Array:
    """Correlation of what goes smoothly with the compression, over a length of it."""
    return np.exp(-0.5 * ((c[:, None] - c) / length) ** 2)


def covariance(presses: Sequence[PuckPress], height_mm: float, noise: PuckNoise) -> Array:
    """Covariance of the residuals of ln force at the bins of all presses of a puck, shape (bins, bins).

    Its law misfits alike in every press; noise and drift are each press's own, and so is :data:`REPEAT`.
    """
    c, force = joined(presses, "compression_mm") / height_mm, joined(presses, "force_N")
    total = noise.misfit**2 * alike(c, ALIKE) + RIPPLE**2 * alike(c, RIPPLE_LENGTH)
    white = np.concatenate([np.full(len(press.samples), press.white_N) for press in presses])
    total[np.diag_indices_from(total)] += white**2 / joined(presses, "samples") / force**2 + JITTER**2
    first = 0
    for press in presses:
        own = slice(first, first := first + len(press.samples))
        slow = inference.Bins([press]).slow(noise.slow_time_s)[0]
        total[own, own] += noise.slow_N**2 * slow / np.outer(press.force_N, press.force_N)
        total[own, own] += REPEAT**2 if len(presses) > 1 else 0.0
    return total


def whitener(presses: Sequence[PuckPress], height_mm: float, noise: PuckNoise) -> Array:
    """Inverse Cholesky factor: whitened = factor @ residual."""
    return inference.whitener(covariance(presses, height_mm, noise))


def estimate(presses: Sequence[PuckPress], height_mm: float, residual: Array, jacobian: Array) -> PuckNoise:
    """Sizes of slow noise and misfit from residuals of ln force and their sensitivity to what was fitted."""
    level = float(joined(presses, "force_N").max())
    longest = max(hold.duration_s for press in presses for hold in press.holds)
    white_N = float(np.sqrt(np.mean([press.white_N**2 for press in presses])))
    start = np.array([1e-3 * level, 0.1 * longest, 1.2 * LEAST_MISFIT])
    low = np.array([1e-5 * level, 1e-2 * longest, LEAST_MISFIT])
    high = np.array([0.02 * level, longest, 0.3])

    def noise_of(sizes: Array) -> PuckNoise:
        return PuckNoise(white_N, *sizes.tolist())

    def cost(sizes: Array) -> float:
        own = covariance(presses, height_mm, noise_of(sizes))
        return inference.restricted_likelihood(own[None], residual[None], jacobian[None])

    return noise_of(inference.likeliest(cost, start, low, high)[0])
