"""The noise of a trace without any law: white noise of neighbouring samples, and what a smooth hold leaves."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

ROBUST = 1.4826
"""Standard deviation of a normal variable over the median of its absolute value."""


def white_noise(second_differences_N: NDArray, robust: bool = False) -> float:
    """Standard deviation of white noise from second differences F(k+1) - 2 F(k) + F(k-1), 0 without any. [N]

    Second differences of independent errors have six times their variance. ``robust`` takes the median of
    their absolute values, which a few jumps do not move; without it rounding to the resolution counts as noise.
    """
    if not second_differences_N.size:
        return 0.0
    if robust:
        return float(ROBUST * np.median(np.abs(second_differences_N)) / np.sqrt(6.0))
    return float(np.sqrt(np.mean(second_differences_N**2) / 6.0))


def noise_floor(holds: Iterable[tuple[NDArray, NDArray]]) -> float:
    """Rms of what a smooth curve in the logarithm of time cannot follow of holds. [N]

    Parameters
    ----------
    holds : iterable of (time, force)
        Time since the stop [s] and force [N] of the samples of each trace; the first twentieth is left out, and a
        hold of less than 20 samples does not count.
    """
    squares, count = 0.0, 0
    for time, force_N in holds:
        late = time > 0.05 * time[-1]
        if late.sum() < 20:
            continue
        at = np.log(time[late])
        at = 2.0 * (at - at[0]) / (at[-1] - at[0]) - 1.0
        smooth = np.polynomial.chebyshev.Chebyshev.fit(at, force_N[late], 6)
        squares += float(((force_N[late] - smooth(at)) ** 2).sum())
        count += int(late.sum()) - 7
    return float(np.sqrt(squares / count)) if count > 0 else 0.0
