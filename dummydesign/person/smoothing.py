"""A smooth curve through noisy samples, with its error; a declared low-pass of the sensor is undone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.sensor import Lowpass

CELLS = 5
"""Bins an interval between nodes is cut into before samples are averaged: few enough to be quick, and so many that an
arm that rings is not averaged out."""
LEAST_NOISE = 1e-5
"""Smallest noise that is assumed, over the largest value: numbers in files are rounded."""
SURE, SMALL = 4.0, 1.5e-3
"""Standard errors, and share of the range, by which a mean of samples must miss the curve to ask for more nodes."""
MOST_UNSURE = 0.03
"""Largest standard deviation, over the range, that undoing a filter may make of the noise."""
SCANNED = np.logspace(-10.0, 4.0, 57)
"""Weights of the roughness that are tried."""


@dataclass(frozen=True, eq=False)
class SmoothCurve:
    """A curve at nodes: values (n,), a factor (n, k) of their covariance, the noise of one sample, and which of the
    n - 1 intervals are too coarse for what the samples show."""

    value: NDArray
    factor: NDArray
    noise: float
    coarse: NDArray


def smooth_curve(
    time_s: NDArray,
    values: NDArray,
    nodes_s: NDArray,
    lowpass: Lowpass | None = None,
    from_zero: bool = True,
    bends: NDArray | None = None,
    noise: float | None = None,
) -> SmoothCurve:
    """Fit a curve, linear between nodes, to samples: least squares with a penalty on second differences.

    The weight of the penalty makes the expected error smallest (Mallows' C_p with the noise of the samples). The
    covariance is the Bayesian one of the same penalty.

    Parameters
    ----------
    time_s, values : ndarray, shape (m,)
        Samples inside the nodes.
    nodes_s : ndarray, shape (n,)
        Rising.
    lowpass : Lowpass, optional
        Filter that the values went through; the curve is what went into it.
    from_zero : bool
        Whether the curve is 0 at the first node.
    bends : ndarray, shape (k, n), optional
        What is penalised, instead of the second differences.
    noise : float, optional
        Of one sample, instead of that which second differences show.

    References
    ----------
    Wahba, Spline Models for Observational Data, SIAM 1990, chapters 4 and 5.
    """
    from scipy.linalg import eigh

    least = LEAST_NOISE * float(np.max(np.abs(values), initial=1e-12))
    noise = max(float(noise_of(values)) if noise is None else noise, least)
    at, mean, count = _averaged(time_s, values, nodes_s)
    design, first = interpolation(at, nodes_s), int(from_zero)
    if lowpass is not None:
        design = design @ lowpass.apply(nodes_s, np.eye(len(nodes_s))).T
    weighted, wanted = design[:, first:] * np.sqrt(count)[:, None], mean * np.sqrt(count)
    normal = weighted.T @ weighted
    rough = (np.diff(np.eye(len(nodes_s)), 2, axis=0) if bends is None else bends)[:, first:]
    penalty = rough.T @ rough
    penalty *= np.trace(normal) / np.trace(penalty)
    ridge = 1e-14 * np.trace(normal) * np.eye(len(normal))
    share, basis = eigh(normal, normal + penalty + ridge)
    share = np.clip(share, 0.0, 1.0)
    loading = basis.T @ (weighted.T @ wanted)
    total = float(wanted @ wanted)
    # residual sum of squares and degrees of freedom of each weight in closed form
    damped = np.maximum(share + SCANNED[:, None] * (1.0 - share), 1e-13)
    left = total - 2.0 * (loading**2 / damped).sum(axis=1) + (share * loading**2 / damped**2).sum(axis=1)
    left, freedom = np.maximum(left, 0.0), (share / damped).sum(axis=1)
    sample, spare = noise, len(wanted) - freedom
    if lowpass is not None:
        # what no weight can fit is an error of the curve's form, not a reason to follow every sample
        floor = float(np.min(np.where(spare > 0.2 * len(wanted), left / np.maximum(spare, 1.0), np.inf)))
        noise = float(np.sqrt(max(noise**2, floor if np.isfinite(floor) else 0.0)))
    risk = left / noise**2 + 2.0 * freedom
    if lowpass is not None:
        unsure = noise * np.sqrt((1.0 / damped @ (basis**2).T).max(axis=1))
        risk = np.where(unsure > MOST_UNSURE * float(np.ptp(mean)), np.inf, risk)
    best = int(np.argmin(risk)) if np.isfinite(risk).any() else -1
    value = basis @ (loading / damped[best])
    missed = np.abs(wanted - weighted @ value)
    amiss = (missed > SURE * sample) & (missed > SMALL * np.sqrt(count) * float(np.ptp(mean)))
    coarse = np.zeros(len(nodes_s) - 1, bool)
    coarse[np.clip(np.searchsorted(nodes_s, at[amiss], side="right") - 1, 0, len(coarse) - 1)] = True
    factor = noise * root_of_inverse(normal + SCANNED[best] * (penalty + ridge))
    if from_zero:
        value, factor = np.r_[0.0, value], np.vstack([np.zeros(factor.shape[1]), factor])
    return SmoothCurve(value, factor, noise, coarse)


def root_of_inverse(precision: NDArray) -> NDArray:
    """Return the upper triangular root (n, n) of the inverse of a symmetric matrix.

    It is unique: draws made with it do not depend on the signs that a machine's linear algebra gives to eigenvectors.
    """
    from scipy.linalg import cholesky, solve_triangular

    scale = 1.0 / np.sqrt(np.diag(precision))
    even = precision * scale[:, None] * scale
    lower = cholesky(even + 1e-13 * np.eye(len(even)), lower=True)
    return scale[:, None] * solve_triangular(lower, np.eye(len(even)), lower=True).T


def _averaged(time_s: NDArray, values: NDArray, nodes_s: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Mean time and value, and number, of the samples in each bin between two nodes."""
    position = np.interp(time_s, nodes_s, np.arange(len(nodes_s)) * float(CELLS))
    cell = np.minimum(position.astype(int), CELLS * (len(nodes_s) - 1) - 1)
    number = np.bincount(cell)
    used = number > 0
    at = np.bincount(cell, time_s)[used] / number[used]
    return at, np.bincount(cell, values)[used] / number[used], number[used].astype(float)


def interpolation(at: NDArray, nodes: NDArray) -> NDArray:
    """Matrix (len(at), n) of linear interpolation between nodes."""
    left = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[left]) / (nodes[left + 1] - nodes[left]), 0.0, 1.0)
    matrix = np.zeros((len(at), len(nodes)))
    rows = np.arange(len(at))
    matrix[rows, left], matrix[rows, left + 1] = 1.0 - share, share
    return matrix
