"""Errors in newton on raw samples, on what was fitted and on conditions that were left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.candidates import USUAL_POSITION_MM
from dummydesign.loop.fitting.fit import BASE, Fit, prior_precision
from dummydesign.loop.fitting.noise import make_whitener

ESTIMABLE = 0.2
"""A cell counts when the rest still holds this share of the information on an effect's size."""


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

    Contact scatter counts up to that of a usual robot: more of it is a sign that something is missing.
    """
    presses, noise = found.problem.presses, found.sizes.noise
    weight = presses.samples * presses.used
    position = min(noise.position_mm, USUAL_POSITION_MM)
    spread = np.einsum("tbi,ij,tbj->tb", found.jacobian, found.covariance, found.jacobian)
    return float(np.sqrt(found.sizes.floor_N**2 + np.average((position * found.slope) ** 2 + spread, weights=weight)))


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
