"""The noise of binned traces: white, slowly correlated, contact position, and misfit of the law itself.

Samples at 1 kHz are not independent: a slow part that lives for a second does not average away in a bin,
and a bias of the contact zero moves a whole press. What a wrong law leaves is a share of the peak of the
press in every bin; without that part, a misfit of newtons would be taken for certainty. (In proportion to
the force of the moment, or correlated over a whole rise, it would pull the fit away from least squares: a
curve far from the data would cost little. That neighbouring bins misfit alike is counted by :data:`ALIKE`.)
Sizes are estimated from the residuals by restricted maximum likelihood, so that parameters that were fitted
do not count as knowledge of the noise; slow noise and contact position are bounded by what can be seen
without a law and by what a robot can do, and the misfit takes the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.reduction import ReducedTrace

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


@dataclass(frozen=True)
class Noise:
    """Sizes: white and slow standard deviation [N], time of the slow one [s], zero [mm], misfit over peak."""

    white_N: float
    slow_N: float
    slow_time_s: float
    position_mm: float
    misfit_fraction: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the five sizes."""
        return asdict(self)


class Bins:
    """Bins of several traces as padded stacks, for batched linear algebra.

    Arrays have shape (traces, longest); ``used`` masks the padding.
    """

    def __init__(self, traces: Sequence[ReducedTrace]) -> None:
        longest = max(len(trace.force_N) for trace in traces)
        self.used = np.zeros((len(traces), longest), dtype=bool)
        self.start, self.end, self.samples = (np.zeros_like(self.used, dtype=float) for _ in range(3))
        for row, trace in enumerate(traces):
            count = len(trace.force_N)
            self.used[row, :count] = True
            self.start[row, :count], self.end[row, :count] = trace.start_s, trace.end_s
            self.samples[row, :count] = trace.samples
        self._both = self.used[:, :, None] & self.used[:, None, :]
        gap = np.maximum(self.start[:, None, :] - self.end[:, :, None], 0.0)
        self._gap = np.maximum(gap, np.swapaxes(gap, 1, 2))
        self._rows = np.arange(longest)

    def stacked(self, values: NDArray) -> NDArray:
        """Put joined bins (total, ...) into the padded stack (traces, longest, ...)."""
        out = np.zeros((*self.used.shape, *values.shape[1:]))
        out[self.used] = values
        return out

    def covariance(self, noise: Noise, slope: NDArray, level: NDArray | None = None) -> NDArray:
        """Covariance of the bins, shape (traces, longest, longest), identity in the padding. [N2]

        The slow part is an Ornstein-Uhlenbeck process averaged exactly over the bins.

        Parameters
        ----------
        noise : Noise
        slope : ndarray, shape (traces, longest)
            dF / dx of each bin, for the contact position. [N/mm]
        level : ndarray, shape (traces, longest), optional
            Measured peak force of the press of each bin, needed when the noise has misfit. [N]
        """
        length = np.where(self.used, np.maximum(self.end - self.start, 1e-9), 1.0) / noise.slow_time_s
        loss = -np.expm1(-length) / length
        slow = loss[:, :, None] * loss[:, None, :] * np.exp(-self._gap / noise.slow_time_s)
        rows = self._rows
        # the small-length limit of 2 (L - 1 + exp(-L)) / L^2 is 1 - L / 3
        own = np.where(length > 1e-4, 2.0 * (1.0 - loss) / length, 1.0 - length / 3.0)
        slow[:, rows, rows] = own
        total = noise.slow_N**2 * slow
        if noise.position_mm > 0:
            total += noise.position_mm**2 * slope[:, :, None] * slope[:, None, :]
        total = np.where(self._both, total, 0.0)
        white = noise.white_N**2 / np.maximum(self.samples, 1.0)
        if level is not None:
            white = white + (noise.misfit_fraction * level) ** 2
        total[:, rows, rows] += np.where(self.used, white, 1.0)
        return total


def whitener(bins: Bins, noise: Noise, slope: NDArray, level: NDArray | None = None) -> NDArray:
    """Inverse Cholesky factors (traces, longest, longest): whitened = factor @ stacked values."""
    lower = np.linalg.cholesky(bins.covariance(noise, slope, level))
    return np.linalg.inv(lower)


def minus_two_log_likelihood(bins: Bins, factor: NDArray, residual: NDArray) -> float:
    """Minus twice the Gaussian log likelihood of stacked residuals (traces, longest) under a whitening."""
    white = (factor @ residual[..., None])[..., 0]
    diagonal = np.diagonal(factor, axis1=1, axis2=2)
    count = int(bins.used.sum())
    return float((white**2).sum() - 2.0 * np.log(diagonal).sum() + count * np.log(2.0 * np.pi))


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
    columns = np.concatenate([residual[..., None], jacobian], axis=-1)
    with_position = len(residual) >= 4
    scale = max(float(np.sqrt((residual**2).sum() / bins.used.sum())), FLOOR_N)
    first = Noise(max(min(scale, largest_slow_N), 2 * FLOOR_N), 0.5 * scale, 0.5, 5e-3 * with_position)

    def cost(noise: Noise) -> float:
        lower = np.linalg.cholesky(bins.covariance(noise, slope, level))
        white = np.linalg.solve(lower, columns).reshape(-1, columns.shape[-1])
        information = white[:, 1:].T @ white[:, 1:]
        information[np.diag_indices_from(information)] += 1e-8 * np.trace(information) / len(information)
        determinant = 2.0 * np.log(np.diagonal(lower, axis1=1, axis2=2)).sum()
        return float(white[:, 0] @ white[:, 0] + determinant + np.linalg.slogdet(information)[1])

    low = Noise(FLOOR_N, 1e-4, 5e-3, LOWEST if with_position else 0.0)
    high = Noise(1.5 * largest_slow_N, largest_slow_N, 5.0, LARGEST_POSITION_MM if with_position else 0.0)
    step = 0.6 if start is None else 0.25
    plain, plain_cost = _minimise(cost, start or first, low, high, step)
    if plain.white_N < 0.9 * high.white_N and plain.slow_N < 0.9 * high.slow_N:
        return plain  # what is left looks like the noise of the holds
    low, high = replace(low, misfit_fraction=LOWEST), replace(high, misfit_fraction=1.0)
    begin = replace(plain, misfit_fraction=max(plain.misfit_fraction, 3e-3))
    wide, wide_cost = _minimise(cost, begin, low, high, step)
    # slow noise and misfit are alike: misfit must earn its place
    if wide_cost > plain_cost - MISFIT_GAIN:
        return plain
    return replace(wide, misfit_fraction=ALIKE**0.5 * wide.misfit_fraction)


def _minimise(
    cost: Callable[[Noise], float], start: Noise, low: Noise, high: Noise, step: float
) -> tuple[Noise, float]:
    """Nelder-Mead in the logarithms of the sizes whose upper bound is not 0; sizes at their bound become 0."""
    from scipy.optimize import minimize

    names = [name for name, value in high.to_dict().items() if value > 0]
    bottom, top = (np.log([getattr(end, name) for name in names]) for end in (low, high))
    begin = np.log([max(getattr(start, name), 1e-9) for name in names])
    begin = np.clip(begin, bottom + 1e-3, top - 1e-3)

    def made(logs: NDArray) -> Noise:
        sizes = dict(zip(names, np.exp(np.clip(logs, bottom, top)).tolist()))
        sizes = {name: 0.0 if value <= 1.02 * LOWEST else value for name, value in sizes.items()}
        return Noise(**{**{name: 0.0 for name in high.to_dict()}, **sizes})

    def bounded(logs: NDArray) -> float:
        outside = np.sum(np.maximum(bottom - logs, 0) ** 2 + np.maximum(logs - top, 0) ** 2)
        return cost(made(logs)) + 10.0 * float(outside)

    simplex = np.vstack([begin, begin + step * np.eye(len(begin))])
    options = {"initial_simplex": simplex, "xatol": 0.03, "fatol": 0.05, "maxfev": 200}
    found = minimize(bounded, begin, method="Nelder-Mead", options=options)
    return made(found.x), float(found.fun)
