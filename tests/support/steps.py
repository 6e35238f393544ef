"""The largest step of a function along short paths through its parameters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray


def largest_steps(
    function: Callable[[Array], Array], start: Array, end: Array, width: float = 1e-6, points: int = 33
) -> Array:
    """Steps (n,) of a function of paths' points over ``width`` of each path, narrowed down to where it is steepest.

    Parameters
    ----------
    function : callable
        Values (m,) at points (m, k); NaN where there is no value.
    start, end : ndarray, shape (n, k)
        Ends of the straight paths.
    width : float
        Share of a path over which a step is returned.
    points : int
        Of each path, at every narrowing.
    """
    low, high = np.zeros(len(start)), np.ones(len(start))
    every = np.arange(len(start))
    while True:
        share = np.linspace(low, high, points, axis=1)
        at = start[:, None] + share[:, :, None] * (end - start)[:, None]
        value = function(at.reshape(-1, start.shape[1])).reshape(share.shape)
        step = np.nan_to_num(np.abs(np.diff(value, axis=1)))
        place = step.argmax(axis=1)
        low, high = share[every, place], share[every, place + 1]
        if np.max(high - low) <= width:
            return step[every, place]
