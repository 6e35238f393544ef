"""The presses that a pad is judged by: steady forces and speeds of the test."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM

RADIUS_MM = PUNCH_RADIUS_MM
"""Circle of the area of the paper's 14 x 14 mm impactor. [mm]"""

LOW_SHARES = (0.1, 0.2)
"""Forces below the lowest of the test at which exponents are given, over that force."""
FINE, COARSE = 41, 10


@dataclass(frozen=True)
class Protocol:
    """Presses of a test: every steady force at every speed."""

    forces_N: tuple[float, ...] = (5.0, 10.0, 15.0)
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)

    @property
    def slow_mm_s(self) -> float:
        """The slowest ramp, at which steady curves are taken. [mm/s]"""
        return self.velocities_mm_s[0]

    @property
    def fast_mm_s(self) -> float:
        """The fastest ramp. [mm/s]"""
        return self.velocities_mm_s[-1]

    @property
    def needed_N(self) -> float:
        """The force that a design has to reach at every speed: the middle one, 10 of 5, 10 and 15 N."""
        return self.forces_N[len(self.forces_N) // 2]

    @cached_property
    def steady_grid_N(self) -> NDArray:
        """Steady forces at which the steady curve is scored, from the lowest to the highest. [N]"""
        return np.linspace(self.forces_N[0], self.forces_N[-1], FINE if len(self.forces_N) > 1 else 1)

    @cached_property
    def low_grid_N(self) -> NDArray:
        """Steady forces below those of the test, from a tenth of the lowest: reported, not scored. [N]"""
        return np.linspace(0.1 * self.forces_N[0], self.forces_N[0], COARSE)

    @cached_property
    def misfit_N(self) -> NDArray:
        """Forces over which the misfit is taken, even in the logarithm. [N]"""
        return np.geomspace(0.1 * self.forces_N[0], self.forces_N[-1], 40)

    @cached_property
    def wide_N(self) -> NDArray:
        """Forces far beyond those of the test: a flat pad's own, at the depths of a soft tissue. [N]"""
        return np.geomspace(2e-4 * self.forces_N[0], 10.0 * self.forces_N[-1], 400)

    @cached_property
    def exponent_at_N(self) -> tuple[float, ...]:
        """Forces at which exponents are given. [N]"""
        return (*(float(f"{share * self.forces_N[0]:.6g}") for share in LOW_SHARES), *self.forces_N)

    @property
    def words(self) -> str:
        """The forces as the span of the scored curve: ``5 to 15 N``."""
        low, high = self.forces_N[0], self.forces_N[-1]
        return f"{low:g} to {high:g} N" if high > low else f"{low:g} N"


NAGOYA_PROTOCOL = Protocol()
"""5, 10 and 15 N at 10 and 250 mm/s."""
