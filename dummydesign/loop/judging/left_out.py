"""Errors in newton on raw samples, on what was fitted and on conditions that were left out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Bins, whitener
from dummydesign.loop.fitting.fit import Fit, prior_precision
from dummydesign.loop.fitting.noise import contrasts, make_whitener
from dummydesign.loop.fitting.problem import BASE

ESTIMABLE = 0.2
"""A cell counts when the rest still holds this share of the information on an effect's size."""

UNSEEN_POSITION_MM, LARGEST_POSITION_MM = 0.008, 0.01
"""Contact scatter that is taken for usual when no repeats show it, and the largest that is."""
CHI2_MEDIAN = 0.4549
"""Median of the chi-square distribution of one degree of freedom."""


@dataclass(frozen=True)
class Errors:
    """Root mean square residuals.

    Attributes
    ----------
    train_N : float
        Over all samples that the bins cover.
    heldout_N : float or None
        Each condition (thickness x speed x force) predicted from the others.
    by_trial_N, heldout_by_trial_N : ndarray, shape (T,)
        NaN where a condition could not be left out.
    """

    train_N: float
    heldout_N: float | None
    by_trial_N: NDArray
    heldout_by_trial_N: NDArray


@dataclass(frozen=True)
class _Squares:
    """Per bin: count of raw samples, mean and sum of squares of the raw residual, all (T, B)."""

    count: NDArray
    mean: NDArray
    total: NDArray


def _squares(found: Fit) -> _Squares:
    presses = found.problem.presses
    modelled = presses.at_samples(found.problem.nodes(found.vector))
    count, mean, total = (np.zeros(presses.used.shape) for _ in range(3))
    for row, (press, trial, model) in enumerate(zip(presses.presses, presses.trials, modelled)):
        time = trial.trace.time_s
        which = np.searchsorted(press.start_s, time, side="right") - 1
        inside = (which >= 0) & (time < np.r_[press.end_s, 0.0][which])
        residual = (trial.trace.force_N - model)[inside]
        size = len(press.start_s)
        which = which[inside]
        count[row, :size] = np.bincount(which, minlength=size)
        mean[row, :size] = np.bincount(which, residual, minlength=size) / np.maximum(count[row, :size], 1)
        total[row, :size] = np.bincount(which, residual**2, minlength=size)
    return _Squares(count, mean, total)


def errors(found: Fit, cells: NDArray | None = None) -> Errors:
    """Errors of a fit; every cell is left out once and predicted by the fit to the rest, linearised.

    delta = -(N - N_S + P)^-1 g_S with N the normal matrix, S the cell, P the prior of the law error.

    Parameters
    ----------
    found : Fit
    cells : ndarray of int, shape (T,), optional
        Groups to leave out; the conditions by default, single trials when there is one condition.
    """
    presses = found.problem.presses
    if cells is None:
        one = np.all(presses.cell == presses.cell[0])
        cells = np.arange(len(presses.cell)) if one else presses.cell
    squares = _squares(found)
    counted = squares.count.sum(axis=1)
    by_trial = np.sqrt(squares.total.sum(axis=1) / counted)
    train = float(np.sqrt(squares.total.sum() / counted.sum()))
    changes = leave_out(found, cells)
    heldout = np.full(len(cells), np.nan)
    for cell, change in changes.items():
        for row in np.nonzero(cells == cell)[0]:
            moved = found.jacobian[row] @ change
            n, mean = squares.count[row], squares.mean[row]
            total = squares.total[row].sum() + (n * moved * (moved - 2.0 * mean)).sum()
            heldout[row] = np.sqrt(max(total, 0.0) / counted[row])
    use = np.isfinite(heldout)
    value = float(np.sqrt((heldout[use] ** 2 * counted[use]).sum() / counted[use].sum())) if use.any() else None
    return Errors(train, value, by_trial, heldout)


def expected_heldout_N(found: Fit) -> float:
    """Error on left-out conditions when nothing is missing: noise, contact scatter, uncertainty of all parameters. [N]

    Contact scatter counts as far as repeats show it and a test machine has it: more is a sign of a missing effect.
    """
    presses, noise = found.problem.presses, found.sizes.noise
    weight = presses.samples * presses.used
    position = min(noise.position_mm, repeat_scatter_mm(found), LARGEST_POSITION_MM)
    spread = np.einsum("tbi,ij,tbj->tb", found.jacobian, found.covariance, found.jacobian)
    return float(np.sqrt(found.sizes.floor_N**2 + np.average((position * found.slope) ** 2 + spread, weights=weight)))


def repeat_scatter_mm(found: Fit) -> float:
    """Scatter of the contact position as differences of repeats show it, by their median so that few cannot make it.

    Each difference is fitted with a shift d, of variance v by noise alone, and a change of scale; the scatter p is such
    that the median of d^2 / (p^2 + v) is that of the chi-square of one degree. Not below half of, and without three
    pairs equal to, :data:`UNSEEN_POSITION_MM`. [mm]
    """
    presses, noise = found.problem.presses, found.sizes.noise
    parts, places = contrasts(presses, found.residual)
    if len(parts) < 3:
        return UNSEEN_POSITION_MM
    bins = Bins(parts)
    difference = bins.stacked(np.concatenate([part.force_N for part in parts]))
    sides = [np.stack([found.slope[i, a], found.forces[i, a]], axis=1) for i, _, a, _ in places]
    factor = whitener(bins.covariance(replace(noise, position_mm=0.0), np.zeros(difference.shape)))
    columns, values = factor @ bins.stacked(np.concatenate(sides)), factor @ difference[..., None]
    turned = np.swapaxes(columns, 1, 2)
    inverse = np.linalg.pinv(turned @ columns, hermitian=True)
    shift, own = (inverse @ turned @ values)[:, 0, 0], inverse[:, 0, 0]
    sizes = np.geomspace(0.5 * UNSEEN_POSITION_MM, 1.0, 200)
    ratio = np.median(shift**2 / (sizes[:, None] ** 2 + own), axis=1)
    return float(sizes[np.argmin(ratio > CHI2_MEDIAN)])


def leave_out(found: Fit, cells: NDArray) -> dict[int, NDArray]:
    """Change of the vector when each cell is left out; cells without which an effect is not known are missing."""
    problem = found.problem
    whiten = make_whitener(problem.presses, found.sizes.noise, found.slope, True)
    turned, white = whiten(found.jacobian), whiten(found.residual)
    normal = np.einsum("tbi,tbj->tij", turned, turned)
    gradient = np.einsum("tbi,tb->ti", turned, white)
    prior = np.diag(prior_precision(problem, found.sizes) + 1e-9)
    low, high = problem.bounds()
    pinned = (found.vector <= low + 1e-9) | (found.vector >= high - 1e-9)
    pinned[problem.frozen()] = True
    free = ~pinned
    full = (normal.sum(axis=0) + prior)[np.ix_(free, free)]
    sizes = [i for i, at in enumerate(np.nonzero(free)[0]) if BASE <= at < problem.fixed]
    variance = np.diag(np.linalg.inv(full))
    changes = {}
    for cell in np.unique(cells):
        out = cells == cell
        if out.all():
            continue
        rest = full - normal[out].sum(axis=0)[np.ix_(free, free)]
        try:
            inverse = np.linalg.inv(rest)
        except np.linalg.LinAlgError:
            continue
        kept = variance / np.maximum(np.diag(inverse), 1e-300)
        if np.any(np.diag(inverse) <= 0) or any(kept[i] < ESTIMABLE for i in sizes):
            continue
        change = np.zeros(len(found.vector))
        change[free] = -inverse @ gradient[out].sum(axis=0)[free]
        changes[int(cell)] = change
    return changes
