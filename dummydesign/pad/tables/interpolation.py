"""Straight-line interpolation on grids whose ends are held."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def place_on(grid: NDArray, value: NDArray) -> tuple[NDArray, NDArray]:
    """Where values lie on an increasing grid, held at its ends.

    Parameters
    ----------
    grid : ndarray, shape (n,)
        At least two increasing numbers.
    value : ndarray

    Returns
    -------
    low, part : ndarray
        Index of the lower grid point, at most n - 2, and share of the way to the next, from 0 to 1.
    """
    count = len(grid)
    place = np.interp(value, grid, np.arange(count))
    low = np.minimum(place.astype(int), count - 2)
    return low, place - low


def between(x: NDArray, y: NDArray, columns: NDArray, rows: NDArray, values: NDArray) -> NDArray:
    """Bilinear interpolation of a table; its ends are held.

    Parameters
    ----------
    x, y : ndarray
        Places, of one shape.
    columns, rows : ndarray, shape (m,) and (n,)
        Increasing grid in x and in y.
    values : ndarray, shape (n, m)
        The table: one row for each of ``rows``.

    Returns
    -------
    ndarray
        Of the shape of ``x``.
    """
    by_row = np.array([np.interp(x, columns, row) for row in values])
    low, part = place_on(rows, y)
    first = np.take_along_axis(by_row, low[None], axis=0)[0]
    second = np.take_along_axis(by_row, low[None] + 1, axis=0)[0]
    return (1.0 - part) * first + part * second
