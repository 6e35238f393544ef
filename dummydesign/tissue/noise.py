"""The noise of binned traces: white per sample, slowly correlated, and an error of the contact position.

Samples at 1 kHz are not independent: a slow part that lives for a second does not average away in a bin,
and a bias of the contact zero moves a whole press. Sizes are estimated from the residuals by restricted
maximum likelihood, so that parameters that were fitted do not count as knowledge of the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.tissue.reduce import ReducedTrace

FLOOR_N = 1e-3
"""Smallest white noise that is believed: a tenth of the usual step of a force sensor. [N]"""


@dataclass(frozen=True)
class Noise:
    """Sizes: white and slow standard deviation [N], time of the slow one [s], contact zero [mm]."""

    white_N: float
    slow_N: float
    slow_time_s: float
    position_mm: float

    def to_dict(self) -> dict[str, Any]:
        """Return the four sizes."""
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

    def stacked(self, values: NDArray) -> NDArray:
        """Put joined bins (total, ...) into the padded stack (traces, longest, ...)."""
        out = np.zeros((*self.used.shape, *values.shape[1:]))
        out[self.used] = values
        return out

    def covariance(self, noise: Noise, slope: NDArray) -> NDArray:
        """Covariance of the bins, shape (traces, longest, longest), identity in the padding. [N2]

        The slow part is an Ornstein-Uhlenbeck process averaged exactly over the bins.

        Parameters
        ----------
        noise : Noise
        slope : ndarray, shape (traces, longest)
            dF / dx of each bin, for the contact position. [N/mm]
        """
        length = np.where(self.used, np.maximum(self.end - self.start, 1e-9), 1.0) / noise.slow_time_s
        loss = -np.expm1(-length) / length
        gap = np.maximum(self.start[:, None, :] - self.end[:, :, None], 0.0)
        gap = np.maximum(gap, np.swapaxes(gap, 1, 2)) / noise.slow_time_s
        slow = loss[:, :, None] * loss[:, None, :] * np.exp(-gap)
        rows = np.arange(self.used.shape[1])
        # the small-length limit of 2 (L - 1 + exp(-L)) / L^2 is 1 - L / 3
        own = np.where(length > 1e-4, 2.0 * (1.0 - loss) / length, 1.0 - length / 3.0)
        slow[:, rows, rows] = own
        both = self.used[:, :, None] & self.used[:, None, :]
        total = noise.slow_N**2 * slow + noise.position_mm**2 * slope[:, :, None] * slope[:, None, :]
        total = np.where(both, total, 0.0)
        white = noise.white_N**2 / np.maximum(self.samples, 1.0)
        total[:, rows, rows] += np.where(self.used, white, 1.0)
        return total


def whitener(bins: Bins, noise: Noise, slope: NDArray) -> NDArray:
    """Inverse Cholesky factors (traces, longest, longest): whitened = factor @ stacked values."""
    lower = np.linalg.cholesky(bins.covariance(noise, slope))
    return np.linalg.inv(lower)


def minus_two_log_likelihood(bins: Bins, noise: Noise, slope: NDArray, residual: NDArray) -> float:
    """Minus twice the Gaussian log likelihood of stacked residuals (traces, longest), without constants."""
    factor = whitener(bins, noise, slope)
    white = (factor @ residual[..., None])[..., 0]
    diagonal = np.diagonal(factor, axis1=1, axis2=2)
    count = int(bins.used.sum())
    return float((white**2).sum() - 2.0 * np.log(diagonal).sum() + count * np.log(2.0 * np.pi))


def estimate_noise(
    bins: Bins, slope: NDArray, residual: NDArray, jacobian: NDArray, start: Noise | None = None
) -> Noise:
    """Estimate the noise by restricted maximum likelihood.

    Parameters
    ----------
    bins : Bins
    slope, residual : ndarray, shape (traces, longest)
        dF / dx [N/mm] and residual [N] of each bin.
    jacobian : ndarray, shape (traces, longest, parameters)
        Sensitivity to what was fitted.
    start : Noise, optional
        A former estimate to start from.

    Returns
    -------
    Noise
        The contact position is left at 0 with fewer than four traces: one press cannot tell it from
        the parameters.
    """
    from scipy.optimize import minimize

    with_position = len(residual) >= 4
    scale = max(float(np.sqrt((residual**2).sum() / bins.used.sum())), FLOOR_N)
    # log white, log slow, log time, log position
    low = np.log([FLOOR_N, 1e-4, 5e-3, 1e-4])
    high = np.log([10.0, 10.0, 5.0, 0.3])
    begin = [max(scale, 2 * FLOOR_N), max(0.5 * scale, 2e-4), 0.5, 5e-3]
    if start is not None:
        begin = [start.white_N, start.slow_N, start.slow_time_s, max(start.position_mm, 1e-4)]
    free = 4 if with_position else 3

    def made(logs: NDArray) -> Noise:
        sizes = np.exp(np.clip(logs, low[:free], high[:free]))
        return Noise(*sizes, *([] if with_position else [0.0]))

    def cost(logs: NDArray) -> float:
        noise = made(logs)
        factor = whitener(bins, noise, slope)
        white = (factor @ residual[..., None])[..., 0]
        turned = (factor @ jacobian).reshape(-1, jacobian.shape[-1])
        information = turned.T @ turned
        information[np.diag_indices_from(information)] += 1e-8 * np.trace(information) / len(information)
        outside = np.sum(np.maximum(low[:free] - logs, 0) ** 2 + np.maximum(logs - high[:free], 0) ** 2)
        return float(
            (white**2).sum()
            - 2.0 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
            + np.linalg.slogdet(information)[1]
            + 10.0 * outside
        )

    begin = np.clip(np.log(begin[:free]), low[:free] + 1e-3, high[:free] - 1e-3)
    step = 0.7 if start is None else 0.2
    simplex = np.vstack([begin, begin + step * np.eye(free)])
    options = {"initial_simplex": simplex, "xatol": 0.03, "fatol": 0.05, "maxfev": 160}
    return made(minimize(cost, begin, method="Nelder-Mead", options=options).x)
