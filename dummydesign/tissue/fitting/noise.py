"""Noise of the presses of a tissue: white, slow, contact position, and the misfit of the law.

What a wrong law leaves is a fraction of the peak of the press in every bin; without that part, a misfit of newtons
would be taken for certainty. (In proportion to the force of the moment, or correlated over a whole rise, it would
pull the fit away from least squares: a curve far from the data would cost little. That neighbouring bins misfit
alike is counted by :data:`ALIKE`.) Slow noise and contact position are bounded by what can be seen without a law
and by what a robot can do, and the misfit takes the rest.
"""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Bins, Noise, likeliest, restricted_likelihood

LOWEST = 1e-4
"""Slow noise [N], position [mm] and misfit over peak below which they count as none."""

MISFIT_GAIN = 6.0
"""Gain in twice the log likelihood for which misfit is believed."""

LARGEST_POSITION_MM = 0.05
"""Largest error of the contact position that is believed; robot precision is 0.02 mm."""

ALIKE = 3.0
"""Neighbouring bins that misfit alike: the variance of misfit is raised by as much for the intervals."""

FLOOR_N = 1e-3
"""Smallest white noise that is believed: a tenth of the usual step of a force sensor. [N]"""


def estimate_noise(
    bins: Bins,
    level: NDArray,
    slope: NDArray,
    residual: NDArray,
    jacobian: NDArray,
    largest_slow_N: float,
    start: Noise | None = None,
) -> Noise:
    """Estimate the noise by restricted maximum likelihood.

    Parameters
    ----------
    bins : Bins
    level, slope, residual : ndarray, shape (traces, longest)
        Peak of the press [N], dF / dx [N/mm] and residual [N] of each bin.
    jacobian : ndarray, shape (traces, longest, parameters)
        Sensitivity to what was fitted.
    largest_slow_N : float
        Bound of the slow part, from the data without any law; that of the white part is half as much
        again. Misfit is looked for only when one of them is reached. [N]
    start : Noise, optional
        A former estimate to start from.

    Returns
    -------
    Noise
        The contact position is left at 0 with fewer than four traces: one press cannot tell it from
        the parameters. Misfit and position at their lower bounds are returned as 0.
    """
    with_position = len(residual) >= 4
    scale = max(float(np.sqrt((residual**2).sum() / bins.used.sum())), FLOOR_N)
    begin = start or Noise(max(min(scale, largest_slow_N), 2 * FLOOR_N), 0.5 * scale, 0.5, 5e-3 * with_position)
    low = Noise(FLOOR_N, LOWEST, 5e-3, LOWEST if with_position else 0.0)
    high = Noise(1.5 * largest_slow_N, largest_slow_N, 5.0, LARGEST_POSITION_MM if with_position else 0.0)

    def search(begin: Noise, low: Noise, high: Noise) -> tuple[Noise, float]:
        """Sizes whose upper bound is not 0; those at their lower bound become 0."""
        names = [name for name, value in asdict(high).items() if value > 0]

        def made(sizes: NDArray) -> Noise:
            kept = {name: 0.0 if value <= 1.02 * LOWEST else value for name, value in zip(names, sizes.tolist())}
            return Noise(**{**dict.fromkeys(asdict(high), 0.0), **kept})

        first, least, most = (np.array([getattr(one, name) for name in names]) for one in (begin, low, high))
        sizes, cost = likeliest(
            lambda sizes: restricted_likelihood(bins.covariance(made(sizes), slope, level), residual, jacobian),
            first, least, most,
        )
        return made(sizes), cost

    plain, plain_cost = search(begin, low, high)
    if plain.white_N < 0.9 * high.white_N and plain.slow_N < 0.9 * high.slow_N:
        return plain  # what is left looks like the noise of the holds
    low, high = replace(low, misfit_fraction=LOWEST), replace(high, misfit_fraction=1.0)
    wide, wide_cost = search(replace(plain, misfit_fraction=max(plain.misfit_fraction, 3e-3)), low, high)
    # slow noise and misfit are alike: misfit must earn its place
    if wide_cost > plain_cost - MISFIT_GAIN:
        return plain
    return replace(wide, misfit_fraction=ALIKE**0.5 * wide.misfit_fraction)
