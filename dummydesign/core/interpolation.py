"""Interpolation without scipy's heavy module: monotone cubics, straight lines on held grids; runs and groups."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError

MOST_ROWS = 500_000


def monotone_cubic(x: NDArray, y: NDArray) -> Callable[[ArrayLike], NDArray]:
    """Piecewise cubic of Fritsch and Butland, as ``scipy.interpolate.PchipInterpolator``, whose package loads slowly;
    of values (n, k) at one place.

    References
    ----------
    F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, doi 10.1137/0905021.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    return cubic_by_slopes(x, y, monotone_slopes(x, y))


def monotone_slopes(x: NDArray, y: NDArray) -> NDArray:
    """Slopes of :func:`monotone_cubic` at its points; each knows of the points next to it, those of the ends of two."""
    step = _steps(x, y)
    return _tilts(step, np.diff(y, axis=0) / step)


def _steps(x: NDArray, y: NDArray) -> NDArray:
    """Distances of places, to divide the rises of values (n, ...) at them."""
    return np.diff(x).reshape(-1, *(1,) * (y.ndim - 1))


def cubic_by_slopes(x: NDArray, y: NDArray, tilt: NDArray) -> Callable[[ArrayLike], NDArray]:
    """Piecewise cubic of Hermite: values and slopes are known at increasing places."""
    step = _steps(x, y)
    slope = np.diff(y, axis=0) / step
    bend = (3.0 * slope - 2.0 * tilt[:-1] - tilt[1:]) / step
    twist = (tilt[:-1] + tilt[1:] - 2.0 * slope) / step**2

    def value(at: ArrayLike) -> NDArray:
        position = np.asarray(at, float)
        left = np.clip(np.searchsorted(x, position, side="right") - 1, 0, len(step) - 1)
        t = position - x[left]
        return y[left] + t * (tilt[left] + t * (bend[left] + t * twist[left]))

    return value


def _tilts(step: NDArray, slope: NDArray) -> NDArray:
    """Slopes at the points: weighted harmonic means of those beside, 0 where these differ in sign."""
    if len(slope) == 1:
        return np.repeat(slope, 2, axis=0)
    tilt = np.zeros((len(slope) + 1, *slope.shape[1:]))
    before, after = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    same = slope[1:] * slope[:-1] > 0.0
    neighbours = [np.where(same, one, 1.0) for one in (slope[:-1], slope[1:])]
    tilt[1:-1] = np.where(same, (before + after) / (before / neighbours[0] + after / neighbours[1]), 0.0)
    tilt[0] = _end(*step[:2], *slope[:2])
    tilt[-1] = _end(*step[:-3:-1], *slope[:-3:-1])
    return tilt


def _end(near: NDArray, next_: NDArray, slope: NDArray, beyond: NDArray) -> NDArray:
    """Slope at an end by the parabola through three points, kept in shape."""
    tilt = ((2.0 * near + next_) * slope - near * beyond) / (near + next_)
    steep = (np.sign(slope) != np.sign(beyond)) & (np.abs(tilt) > 3.0 * np.abs(slope))
    return np.where(np.sign(tilt) != np.sign(slope), 0.0, np.where(steep, 3.0 * slope, tilt))


def locate_on_grid(grid: NDArray, value: NDArray) -> tuple[NDArray, NDArray]:
    """The point below each value on an increasing grid and the share of the way to the next, held at its ends."""
    count = len(grid)
    position = np.interp(value, grid, np.arange(count))
    low = np.minimum(position.astype(int), count - 2)
    return low, position - low


def between(x: NDArray, y: NDArray, columns: NDArray, rows: NDArray, values: NDArray) -> NDArray:
    """Bilinear interpolation of a table; its ends are held."""
    return between_rows(np.array([np.interp(x, columns, row) for row in values]), rows, y)


def between_rows(by_row: NDArray, rows: NDArray, y: NDArray) -> NDArray:
    """Values between those of neighbouring rows, shape (rows, ...); the ends are held."""
    low, part = locate_on_grid(rows, y)
    first = np.take_along_axis(by_row, low[None], axis=0)[0]
    second = np.take_along_axis(by_row, low[None] + 1, axis=0)[0]
    return (1.0 - part) * first + part * second


def uniform_times(spans_s: Sequence[tuple[float, float]], rate_hz: float) -> list[NDArray]:
    """Times at a uniform rate over each span, from its start; refused when all together are too many for a file. [s]"""
    total = sum(end - start for start, end in spans_s) * rate_hz
    if total > MOST_ROWS:
        message = f"--rate {rate_hz:g} Hz makes {total:.3g} rows; at most {MOST_ROWS} are written: give a lower rate"
        raise InputError(message, "too_large", "rate_Hz", rate_hz, MOST_ROWS)
    # an end that is a whole number of steps belongs to the times
    return [start + np.arange(int((end - start) * rate_hz * (1 + 1e-9)) + 1) / rate_hz for start, end in spans_s]


def true_runs(mask: NDArray) -> list[tuple[int, int]]:
    """Half-open ranges in which a mask is true."""
    edges = np.flatnonzero(np.diff(np.r_[0, mask.astype(np.int8), 0]))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


Item = TypeVar("Item")


def group_near(items: Iterable[Item], size: Callable[[Item], float], factor: float, of: int = -1) -> list[list[Item]]:
    """Group items by rising size: each lies within a factor of the last (or, ``of`` = 0, the first) of its group."""
    groups: list[list[Item]] = []
    for item in sorted(items, key=size):
        if groups and size(item) < factor * size(groups[-1][of]):
            groups[-1].append(item)
        else:
            groups.append([item])
    return groups
