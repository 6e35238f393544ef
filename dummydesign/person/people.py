"""Persons in numbers, many at once: the law's parameters as arrays, and its force step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, stack

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters


@dataclass(frozen=True)
class People:
    """Persons of one law at one speed.

    Attributes
    ----------
    law : MaxwellLaw
    gamma1 : ndarray, shape (p,)
        Steady coefficient. [N/mm^power]
    gamma, c : ndarray, shape (p, arms)
        Springs and dampers of the arms. [N/mm3, N s/mm]
    """

    law: MaxwellLaw
    gamma1: NDArray
    gamma: NDArray
    c: NDArray

    @classmethod
    def of(cls, subjects: Sequence[Parameters], velocity_mm_s: float) -> People:
        """Collect subjects with their dampers at a speed; see :func:`~.maxwell_law.stack`."""
        law, gamma1, gamma, c = stack(subjects, velocity_mm_s)
        return cls(law_named(law), gamma1, gamma, c)

    def __len__(self) -> int:
        return len(self.gamma1)

    @cached_property
    def rate(self) -> NDArray:
        """gamma / c. [1/(mm2 s)]"""
        return self.gamma / self.c

    def force(self, time_s: NDArray, depth_mm: NDArray) -> NDArray:
        """Force under a motion of shape (n,) or (p, n); never below 0, as skin does not pull. [N]"""
        force = self.law.force(Motion(time_s, depth_mm), self.gamma1, self.gamma, self.c)
        return np.maximum(np.broadcast_to(force, (len(self), force.shape[-1])), 0.0)

    def at_rest(self) -> NDArray:
        """Stretches of the arms before contact, shape (p, arms). [mm]"""
        return np.zeros(self.gamma.shape)

    def carried(self, depth: NDArray, stretch: NDArray, new: NDArray, step: float) -> tuple[NDArray, NDArray]:
        """Return the stretches after a step at even speed, and their slopes over the new depth, both (p, arms).

        Stretch q' = gain x' - decay q; the decay is its mean over the step (Simpson), the rest exact.
        """
        low, high = np.maximum(depth, 0.0), np.maximum(new, 0.0)
        rates = [self.law.stretch_rates(at, self.rate) for at in (low, 0.5 * (low + high), high)]
        decay = (rates[0][1] + 4.0 * rates[1][1] + rates[2][1]) * (step / 6.0)
        gain = rates[1][0] * np.where(decay > 1e-9, -np.expm1(-decay) / np.maximum(decay, 1e-9), 1.0)
        return stretch * np.exp(-decay) + gain * (high - low)[:, None], gain

    def force_of(self, depth: NDArray, stretch: NDArray) -> NDArray:
        """Force at depths (p,) with stretches (p, arms), not below 0. [N]"""
        x = np.maximum(depth, 0.0)
        return np.maximum(self.gamma1 * x**self.law.power + (self.gamma * stretch).sum(axis=-1) * x**2, 0.0)

    def slope_of(self, depth: NDArray, stretch: NDArray, gain: NDArray) -> NDArray:
        """Slope of the force over depth within a step, shape (p,). [N/mm]"""
        x, power = np.maximum(depth, 0.0), self.law.power
        steady = self.gamma1 * power * x ** (power - 1.0) * (depth >= 0.0)
        arms = (self.gamma * (2.0 * x[:, None] * stretch + (x**2)[:, None] * gain)).sum(axis=-1)
        return np.maximum(steady + arms, 0.0)

    def depth_taking(self, energy_mJ: float) -> NDArray:
        """Depth at which an energy is taken if nothing relaxes, shape (p,). [mm]"""
        low, high = np.zeros(len(self)), np.full(len(self), 1e3)
        power, arms = self.law.power, self.gamma.sum(axis=-1)
        for _ in range(60):
            middle = 0.5 * (low + high)
            enough = self.gamma1 * middle ** (power + 1) / (power + 1) + 0.25 * arms * middle**4 > energy_mJ
            low, high = np.where(enough, low, middle), np.where(enough, middle, high)
        return high
