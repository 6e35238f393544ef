"""The base parameters: long-term modulus and two Prony arms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

NAMES = ("young_kPa", "tau_1_s", "beta_1", "tau_2_s", "beta_2")
LOW = np.log([0.2e-3, 2e-3, 1e-3, 0.05, 1e-3])
HIGH = np.log([20.0, 3.0, 20.0, 100.0, 20.0])
"""Bounds of the logarithms of modulus [MPa], tau_1 [s], beta_1, tau_2 [s], beta_2."""


@dataclass(frozen=True)
class BaseParameters:
    """Long-term modulus [MPa] and two arms (tau [s], beta relative to the long-term modulus), fast arm first."""

    young_MPa: float
    tau_s: tuple[float, float]
    beta: tuple[float, float]

    @classmethod
    def from_logs(cls, logs: NDArray) -> BaseParameters:
        """Build from the logarithms in the order of :data:`NAMES`."""
        young, tau1, beta1, tau2, beta2 = (float(v) for v in np.exp(logs))
        return cls(young, (tau1, tau2), (beta1, beta2))

    def to_logs(self) -> NDArray:
        """Return the logarithms in the order of :data:`NAMES` (modulus in MPa)."""
        return np.log([self.young_MPa, self.tau_s[0], self.beta[0], self.tau_s[1], self.beta[1]])

    def to_dict(self) -> dict[str, Any]:
        """Return named values, modulus in kPa."""
        values = np.exp(self.to_logs()) * [1e3, 1, 1, 1, 1]
        return dict(zip(NAMES, (float(v) for v in values)))
