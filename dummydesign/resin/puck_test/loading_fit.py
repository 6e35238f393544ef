"""Modulus, stiffening and plate friction of one batch from compression curves of pucks.

Model of a curve k: load(x) = A E u(c; alpha) B(c; alpha, friction), c = (x - x_k) / height, with u the closed
form between frictionless plates and B the table of ``pad.tables.puck``; x_k is where that curve's contact
begins. The load is zeroed at a curve's first point, in the data and in the model alike. Modulus, stiffening and
friction are common to all curves of the batch.

A declaration of the plates (``puck_test.plates``) gives the friction a prior. Modulus, friction and alpha of a puck are
then the medians over what prior and curves leave open (:func:`over_friction`).

Intervals of :func:`fit_pucks`: errors are taken as fully correlated along a curve and among the repeats on one puck, so
that each puck counts as ONE independent number, with the scatter between curves and the misfit of the law as its
size. Whatever friction keeps the mean square misfit below its minimum + 3.84 s^2 / pucks belongs to the 95 %
interval.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.inference import noise as inference
from dummydesign.inference.least_squares import solve_by_differences
from dummydesign.inference.noise import cut, distinct, hold_edges, mean_around, white_noise
from dummydesign.measurement.ramp_detection import Hold
from dummydesign.pad.tables.puck import PuckTable, uniaxial
from dummydesign.resin.model.resin import PUCK_SCATTER
from dummydesign.resin.puck_test.plates import ALPHA_RANGE, OPEN, OverFriction, Plates, over_friction

GRIPS = np.linspace(0.0, 1.0, 26)
LARGEST_OFFSET = 0.04


@dataclass(frozen=True, eq=False)
class LoadingCurve:
    """Load over compression of one test; curves with the same ``puck`` are repeats on it. [mm, N]"""

    name: str
    puck: str
    compression_mm: np.ndarray
    load_N: np.ndarray


Part = tuple[np.ndarray, np.ndarray, float]
"""A curve's compressions over height, stresses in kPa, and the compression where its load is zeroed."""


@dataclass(frozen=True, eq=False)
class PuckFit:
    """What the curves of one puck say, whichever way they were fitted.

    ``misfit`` is the rms of ln force over what was fitted with the friction as declared, ``misfit_open`` with any
    friction. ``levels`` (presses,) is ln of each press's force over the law's at equal strain, with
    ``level_covariance`` (presses, presses); a level common to all is part of the modulus.
    """

    known: OverFriction
    rmse_N: float
    misfit: float
    misfit_open: float
    levels: np.ndarray
    level_covariance: np.ndarray

    @property
    def contradicts(self) -> bool:
        """Whether plates as declared misfit the curves, and any other friction does not."""
        return self.misfit**2 - self.misfit_open**2 > CONTRADICTS * (TABLE_ERROR**2 + self.misfit_open**2)


@dataclass(frozen=True, eq=False)
class FrictionFit:
    """Best fit at one friction; ``misfit`` is the rms of ln of fitted over measured force.

    ``parameters`` are ln modulus [kPa], alpha and an offset over height for each curve, then what else is fitted;
    ``spread`` their standard deviations. ``residual`` (values,) is what was made least, ``jacobian`` its slopes.
    """

    grip: float
    parameters: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    spread: np.ndarray
    misfit: float


@dataclass(frozen=True, eq=False)
class LoadingFit(PuckFit):
    """With what each friction would make of the batch, by rising grip, and its chi square above the best."""

    profile: list[FrictionFit]
    excess: np.ndarray
    variance: float


def fit_pucks(
    curves: Sequence[LoadingCurve],
    diameter_mm: float,
    height_mm: float,
    table: PuckTable,
    window_mm: tuple[float, float],
    plates: Plates = OPEN,
) -> LoadingFit:
    """Fit one batch."""
    table.check_shape(diameter_mm, height_mm)
    low, high = window_mm
    area = 0.25 * np.pi * diameter_mm**2
    parts: list[Part] = []
    loads = []
    for curve in curves:
        inside = (curve.compression_mm >= low) & (curve.compression_mm <= high)
        zero_mm, load = float(curve.compression_mm[0]), curve.load_N - curve.load_N[0]
        if inside.sum() < 5 or not np.all(load[inside] > 0.0):
            raise InputError(
                f"curve {curve.name}: needs 5 or more loads above 0 between {low:g} and {high:g} mm",
                "not_enough_data",
                "curve",
                curve.name,
            )
        parts.append((curve.compression_mm[inside] / height_mm, load[inside] / area * 1e3, zero_mm / height_mm))
        loads.append(curve.load_N[inside])
    points = _profile(parts, table, GRIPS)
    misfit_open = min(point.misfit for point in points)
    grips, prior = plates.nodes(GRIPS)
    if plates.friction:
        points = _profile(parts, table, grips, points)
    best = min(points, key=lambda point: point.misfit)
    means = [np.mean(rest) for rest in _residuals(parts, table, best.grip, best.parameters)]
    scatter = float(np.std(means, ddof=1)) if len(parts) > 1 else PUCK_SCATTER
    variance = (scatter**2 + best.misfit**2) / len({curve.puck for curve in curves})
    excess = (np.array([point.misfit**2 for point in points]) - best.misfit**2) / variance
    young, alpha = np.array([point.parameters[:2] for point in points]).T
    young_spread, alpha_spread = np.array([point.spread[:2] for point in points]).T
    known = over_friction(
        np.array([point.grip for point in points]),
        excess + prior,
        np.stack([young, np.hypot(np.sqrt(variance), young_spread)]),
        np.stack([alpha, alpha_spread]),
        np.array([point.misfit for point in points]),
        np.concatenate([c for c, *_ in parts]),
    )
    rmse_N = best.misfit * float(np.sqrt(np.mean(np.concatenate(loads) ** 2)))
    levels, error = press_levels(
        lambda grip: np.concatenate(_residuals(parts, table, grip, best.parameters)),
        best.jacobian,
        best.grip,
        _law_covariance(parts),
        [c for c, *_ in parts],
    )
    error += REPEAT**2 * np.eye(len(parts))
    return LoadingFit(known, rmse_N, best.misfit, misfit_open, levels, error, points, excess, variance)


def press_levels(
    residual: Callable[[float], np.ndarray],
    jacobian: np.ndarray,
    grip: float,
    covariance: np.ndarray,
    strains: Sequence[np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Levels of the presses of a fit and their covariance, with contact and friction of each press left open.

    A press that is stiffer than the others is fitted by an earlier contact for the most part; the two, and a film that
    wears, differ by their course over the strain. One step of the linearised fit, with a level, an offset and a
    friction a press in place of the common modulus.

    Parameters
    ----------
    residual : callable
        ln of fitted over measured force (bins,) at a grip.
    jacobian : ndarray, shape (bins, parameters)
        Its slopes; parameters are ln modulus, alpha, an offset a press, others.
    grip : float
        Of the fit.
    covariance : ndarray, shape (bins, bins)
        Of the residuals.
    strains : sequence of ndarray
        Compression over height at the bins of each press.
    """
    count = len(strains)
    presses = np.arange(count)
    # before, the force is no longer linear in the contact; beyond the shallowest press nothing is compared
    strain = np.concatenate(strains)
    rows = (strain >= LEVEL_FROM) & (strain <= min(float(one.max()) for one in strains))
    own = np.repeat(presses, [len(one) for one in strains])[:, None] == presses
    step = math.copysign(GRIP_STEP, 0.5 - grip)
    film = own * ((residual(grip + step) - residual(grip)) / step)[:, None]
    white = inference.whitener(covariance[np.ix_(rows, rows)])
    columns = white @ np.hstack([own, film, jacobian[:, 1:]])[rows]
    priors = np.zeros(columns.shape[1])
    priors[count + presses] = GRIP_REPEAT**-2
    priors[2 * count + 1 + presses] = LARGEST_OFFSET**-2
    known = np.linalg.pinv(columns.T @ columns + np.diag(priors), hermitian=True)
    return -(known @ columns.T @ white @ residual(grip)[rows])[presses], known[np.ix_(presses, presses)]


def _profile(
    parts: list[Part], table: PuckTable, grips: np.ndarray, near: Sequence[FrictionFit] = ()
) -> list[FrictionFit]:
    """Best fits at some grips, by rising grip; the first begins at the nearest of those known."""
    points: list[FrictionFit] = []
    for grip in grips[::-1]:
        start = points[-1] if points else min(near, key=lambda point: abs(point.grip - grip), default=None)
        points.append(_best(parts, table, float(grip), start))
    return points[::-1]


def _model(table: PuckTable, alpha: float, grip_value: float, compression: np.ndarray, zero: float) -> np.ndarray:
    """Load over area and modulus, zeroed at a compression."""

    def load(c: np.ndarray) -> np.ndarray:
        c = np.maximum(c, 0.0)
        return uniaxial(alpha, c) * table.factor(alpha, grip_value, c)

    return load(compression) - load(np.array([zero]))[0]


def _residuals(parts: list[Part], table: PuckTable, grip_value: float, q: np.ndarray) -> list[np.ndarray]:
    """Logarithm of fitted over measured stress of each curve."""
    young, alpha, *offsets = [np.exp(q[0]), *q[1:]]
    models = [_model(table, alpha, grip_value, c - at, zero - at) for (c, _, zero), at in zip(parts, offsets)]
    return [np.log(np.maximum(young * model, 1e-12) / stress) for model, (_, stress, _) in zip(models, parts)]


def _best(parts: list[Part], table: PuckTable, grip_value: float, guess: FrictionFit | None) -> FrictionFit:
    count = len(parts)
    c, stress, _ = parts[0]
    middle = len(c) // 2
    model = _model(table, 2.0, grip_value, c[middle : middle + 1], 0.0)[0]
    starts = [np.r_[np.log(stress[middle] / model), 2.0, np.zeros(count)]]
    if guess is not None:
        # a neighbour may lie in another valley of alpha and offset
        starts.append(np.r_[guess.parameters[0], np.clip(guess.parameters[1], 1.01, 5.99), guess.parameters[2:]])
    solved = solve_by_differences(
        lambda q: np.concatenate(_residuals(parts, table, grip_value, q)),
        starts,
        np.r_[-20.0, ALPHA_RANGE[0], np.full(count, -LARGEST_OFFSET)],
        np.r_[20.0, ALPHA_RANGE[1], np.full(count, LARGEST_OFFSET)],
        scale=np.r_[0.1, 0.5, np.full(count, 0.003)],
    )
    assert solved.residual is not None and solved.jacobian is not None
    # a contact known to no more than its bounds is a prior of them
    bounds = np.diag(np.r_[0.0, 0.0, np.full(count, LARGEST_OFFSET**-2)])
    information = solved.jacobian.T @ np.linalg.solve(_law_covariance(parts), solved.jacobian) + bounds
    spread, misfit = np.sqrt(np.diag(np.linalg.inv(information))), float(np.sqrt(np.mean(solved.residual**2)))
    return FrictionFit(grip_value, solved.parameters, solved.residual, solved.jacobian, spread, misfit)


def _law_covariance(parts: list[Part]) -> np.ndarray:
    """Covariance of the residuals by what the law misfits, the same in every curve, and the table's error."""
    c = np.concatenate([c for c, *_ in parts])
    return LEAST_MISFIT**2 * alike(c, ALIKE) + TABLE_ERROR**2 * np.eye(len(c))


CONTRADICTS, TABLE_ERROR = 8.0, 0.003
"""Excess of the mean square misfit, over that with any friction, from which on declared plates are doubted: of 12 drawn
pucks of several laws the largest of a true declaration was 7, and 7 of 12 wrong ones were above 8. Smallest misfit that
counts: the friction tables' error."""
RAMP_BINS = 25


@dataclass(frozen=True, eq=False)
class PuckPress:
    """One press in bins."""

    holds: tuple[Hold, ...]
    time_s: np.ndarray
    displacement_mm: np.ndarray
    average: np.ndarray
    start_s: np.ndarray
    end_s: np.ndarray
    samples: np.ndarray
    force_N: np.ndarray
    compression_mm: np.ndarray
    white_N: float


def reduce_press(
    time_s: np.ndarray,
    displacement_mm: np.ndarray,
    force_N: np.ndarray,
    holds: tuple[Hold, ...],
    window_mm: tuple[float, float],
) -> PuckPress:
    """Cut a press into bins: evenly in displacement over each ramp, growing by a third over each hold.

    Forces are counted from their median before the displacement reaches zero, in the bins and in their ``average``.
    Bins outside the window and what follows the last hold are left out.
    """
    last = int(np.searchsorted(time_s, holds[-1].end_s, side="right"))
    time, x, force = time_s[:last], displacement_mm[:last], force_N[:last]
    touch = int(np.argmax(x > 0.0))
    force = force - float(np.median(force[: touch or 1]))
    step = float(np.median(np.diff(time)))
    edges = _edges(time, x, touch, step, holds)
    nodes = np.r_[(edges[:-1, None] + np.diff(edges)[:, None] * np.linspace(0.0, 0.75, 4)).ravel(), edges[-1]]
    held = np.any([(nodes > h.start_s + 3 * step) & (nodes < h.end_s) for h in holds], axis=0)
    motion = np.where(held, mean_around(nodes, time, x), np.interp(nodes, time, x))
    binning = cut(time, edges)
    displacement = binning.mean(x)
    zero = [np.interp(np.median(time[: touch or 1]), nodes, one) for one in np.eye(len(nodes))]
    keep = (displacement >= window_mm[0]) & (displacement <= window_mm[1])
    return PuckPress(
        holds,
        nodes,
        motion,
        binning.average(time, nodes)[keep] - np.array(zero),
        binning.start_s[keep],
        binning.end_s[keep],
        binning.samples[keep],
        binning.mean(force)[keep],
        displacement[keep],
        _white(time, force, holds),
    )


def _edges(time: np.ndarray, x: np.ndarray, touch: int, step: float, holds: tuple[Hold, ...]) -> np.ndarray:
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


def _white(time: np.ndarray, force: np.ndarray, holds: tuple[Hold, ...]) -> float:
    """White noise of a sample in the later nine tenths of the holds. [N]"""
    late = [(time >= hold.start_s + 0.1 * hold.duration_s) & (time <= hold.end_s) for hold in holds]
    return white_noise(np.concatenate([np.diff(force[rows], 2) for rows in late]), robust=True)


LEAST_MISFIT = 0.02
"""Misfit of the one-term law that is always reckoned with: the middle of 19 mixtures, ``docs/real-data.md``."""
ALIKE = 0.15
"""Compression, over height, within which the law misfits alike."""
RIPPLE, RIPPLE_LENGTH = 0.0025, 0.02
"""Ripple of the solved force over compression, half of its mesh error, and the compression it goes with: the
bulging side comes to lie on the plate cell by cell."""
REPEAT = 0.01
"""Scatter of the force between presses of one puck (lubricant, seating, rest): assumed, by judgement."""
LEVEL_FROM = 0.1
"""Compression, over height, from which on presses are compared."""
GRIP_STEP, GRIP_REPEAT = 0.02, 0.03
"""Step of a slope over the grip, and the scatter of the grip between presses of one puck; a film of oil
(friction 0.05) has 0.2: assumed, by judgement."""
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


def longest_hold(presses: Sequence[PuckPress]) -> float:
    """The longest hold of all presses. [s]"""
    return max(hold.duration_s for press in presses for hold in press.holds)


def joined(presses: Sequence[PuckPress], name: str) -> np.ndarray:
    """Values of the bins of all presses, one after the other."""
    return np.concatenate([getattr(press, name) for press in presses])


def alike(c: np.ndarray, length: float) -> np.ndarray:
    """Correlation of what goes smoothly with the compression, over a length of it."""
    return np.exp(-0.5 * ((c[:, None] - c) / length) ** 2)


def covariance(presses: Sequence[PuckPress], height_mm: float, noise: PuckNoise) -> np.ndarray:
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


def whitener(presses: Sequence[PuckPress], height_mm: float, noise: PuckNoise) -> np.ndarray:
    """Inverse Cholesky factor: whitened = factor @ residual."""
    return inference.whitener(covariance(presses, height_mm, noise))


def estimate(presses: Sequence[PuckPress], height_mm: float, residual: np.ndarray, jacobian: np.ndarray) -> PuckNoise:
    """Sizes of slow noise and misfit from residuals of ln force and their sensitivity to what was fitted."""
    units = float(joined(presses, "force_N").max()), longest_hold(presses), 1.0
    white_N = float(np.sqrt(np.mean([press.white_N**2 for press in presses])))

    def noise_of(sizes: np.ndarray) -> PuckNoise:
        return PuckNoise(white_N, *sizes.tolist())

    def cost(sizes: np.ndarray) -> float:
        own = covariance(presses, height_mm, noise_of(sizes))
        return inference.restricted_likelihood(own[None], residual[None], jacobian[None])

    start, low, high = np.multiply(
        [[1e-3, 0.1, 1.2 * LEAST_MISFIT], [1e-5, 1e-2, LEAST_MISFIT], [0.02, 1.0, 0.3]], units
    )
    return noise_of(inference.likeliest(cost, start, low, high)[0])
