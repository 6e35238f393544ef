"""Strengths of relaxation that are known together with the modulus: drawn given it, not by themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class RelaxationGivenModulus:
    """ln beta = ln of the stated strength + slope (ln E - mean) + spread z, with independent normal z.

    Attributes
    ----------
    log_young_kPa : float
        Mean of ln E at the reference ratio.
    slope : ndarray, shape (arms,)
    spread : ndarray, shape (arms, arms)
        A root of the covariance of ln beta at a known modulus.
    """

    log_young_kPa: float
    slope: NDArray
    spread: NDArray

    @classmethod
    def of(cls, log_young_kPa: float, covariance: NDArray) -> RelaxationGivenModulus:
        """From the covariance (1 + arms, 1 + arms) of ln E and the ln beta."""
        slope = covariance[1:, 0] / covariance[0, 0]
        left = covariance[1:, 1:] - np.outer(slope, covariance[0, 1:])
        values, turn = np.linalg.eigh(0.5 * (left + left.T))
        return cls(log_young_kPa, slope, turn * np.sqrt(np.maximum(values, 0.0)))

    def draw(self, beta: ArrayLike, young_kPa: NDArray, rng: np.random.Generator) -> NDArray:
        """Strengths (n, arms) of draws of the modulus.

        Parameters
        ----------
        beta : array_like, shape (arms,)
            The stated strengths.
        young_kPa : ndarray, shape (n,)
            The modulus at the reference ratio in each draw. [kPa]
        rng : numpy Generator
            Of the draws.
        """
        away = np.log(np.maximum(young_kPa, 1e-9)) - self.log_young_kPa
        own = rng.standard_normal((len(away), len(self.slope))) @ self.spread.T
        return np.asarray(beta, float) * np.exp(np.outer(away, self.slope) + own)
