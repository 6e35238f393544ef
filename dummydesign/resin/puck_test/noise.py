"""Noise of a puck's binned press: white, slow, and the misfit of the elastic law along the compression.

The law's misfit is a share of the force that varies smoothly with compression: it is the same all through a hold
and never looks like relaxation. Slow noise is an Ornstein-Uhlenbeck force (drift of the load cell). Sizes are
found by restricted maximum likelihood, the white part from the samples.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from dummydesign.inference import noise as inference
from dummydesign.resin.puck_test.reduction import PuckPress

Array = np.ndarray

LEAST_MISFIT = 0.02
"""Misfit of the one-term law that is always reckoned with: the middle of 19 mixtures, ``docs/ecoflex.md``."""
ALIKE = 0.15
"""Compression, over height, within which the law misfits alike."""
RIPPLE, RIPPLE_LENGTH = 0.0025, 0.02
"""Ripple of the solved force over compression, half of its mesh error, and the compression it goes with: the
bulging side comes to lie on the plate cell by cell."""
JITTER = 1e-4
"""Relative error of taking the motion as straight between nodes."""


@dataclass(frozen=True)
class PuckNoise:
    """Standard deviations: white per sample and slow [N], life of the slow part [s], misfit over force."""

    white_N: float
    slow_N: float
    slow_time_s: float
    misfit: float

    def to_dict(self) -> dict[str, float]:
        """Return the four sizes."""
        return asdict(self)


def covariance(press: PuckPress, height_mm: float, noise: PuckNoise) -> Array:
    """Covariance of the bins' residuals of ln force, shape (bins, bins).

    Parameters
    ----------
    press : PuckPress
        The binned press.
    height_mm : float
        Undeformed height of the puck. [mm]
    noise : PuckNoise

    Returns
    -------
    ndarray, shape (bins, bins)
    """
    c = press.compression_mm / height_mm
    apart = c[:, None] - c
    total = noise.misfit**2 * np.exp(-0.5 * (apart / ALIKE) ** 2)
    total += RIPPLE**2 * np.exp(-0.5 * (apart / RIPPLE_LENGTH) ** 2)
    slow = inference.Bins([press]).slow(noise.slow_time_s)[0]
    total += noise.slow_N**2 * slow / np.outer(press.force_N, press.force_N)
    total[np.diag_indices_from(total)] += noise.white_N**2 / press.samples / press.force_N**2 + JITTER**2
    return total


def whitener(press: PuckPress, height_mm: float, noise: PuckNoise) -> Array:
    """Inverse Cholesky factor: whitened = factor @ residual.

    Parameters
    ----------
    press : PuckPress
        The binned press.
    height_mm : float
        Undeformed height of the puck. [mm]
    noise : PuckNoise

    Returns
    -------
    ndarray, shape (bins, bins)
        Lower triangle.
    """
    return inference.whitener(covariance(press, height_mm, noise))


def estimate(press: PuckPress, height_mm: float, residual: Array, jacobian: Array) -> PuckNoise:
    """Sizes of slow noise and misfit from residuals of ln force and their sensitivity to what was fitted.

    Parameters
    ----------
    press : PuckPress
        The binned press.
    height_mm : float
        Undeformed height of the puck. [mm]
    residual : ndarray, shape (bins,)
        ln of fitted over measured force of the bins.
    jacobian : ndarray, shape (bins, parameters)
        Derivative of the modelled ln force with respect to what was fitted.

    Returns
    -------
    PuckNoise
    """
    level = float(press.force_N.max())
    longest = max(hold.duration_s for hold in press.holds)
    start, low, high = np.array(
        [
            [1e-3 * level, 0.1 * longest, 1.2 * LEAST_MISFIT],
            [1e-5 * level, 1e-2 * longest, LEAST_MISFIT],
            [0.02 * level, longest, 0.3],
        ]
    )

    def made(sizes: Array) -> PuckNoise:
        return PuckNoise(press.white_N, *sizes.tolist())

    def cost(sizes: Array) -> float:
        own = covariance(press, height_mm, made(sizes))
        return inference.restricted_likelihood(own[None], residual[None], jacobian[None])

    return made(inference.likeliest(cost, start, low, high)[0])
