"""Path of a robot that pressed one body, to press another: shifted along its way, so that it ends at another depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import LATE, Motion

RISE, COARSE = 128, 32
"""Even steps from contact to the stop, for curves and to find depths."""


@dataclass(frozen=True, eq=False)
class RobotPath:
    """Path of a robot on the pad, from before contact on.

    Attributes
    ----------
    time_s, x_mm : ndarray, shape (n,)
        From contact to the end of the hold.
    stop_s : float
    contact_mm_s, approach_mm_s : float
        Speed at contact, and before the robot braked.
    braking_mm_s2 : float
        Deceleration before contact, where the two differ.
    """

    time_s: NDArray
    x_mm: NDArray
    stop_s: float
    contact_mm_s: float
    approach_mm_s: float
    braking_mm_s2: float

    @property
    def depth_mm(self) -> float:
        """At the end of the hold."""
        return float(self.x_mm[-1])

    def contact_s(self, deeper_mm: NDArray) -> NDArray:
        """Time at which a body is touched that is pressed deeper than the pad by so much. [s]"""
        rise = self.time_s <= self.stop_s
        inside = np.interp(-deeper_mm, np.maximum.accumulate(self.x_mm[rise]), self.time_s[rise])
        braking, gain = self.braking_mm_s2, self.approach_mm_s - self.contact_mm_s
        way = 0.5 * gain * (self.approach_mm_s + self.contact_mm_s) / braking
        slow = np.minimum(np.maximum(deeper_mm, 0.0), way)
        time = (np.sqrt(self.contact_mm_s**2 + 2.0 * braking * slow) - self.contact_mm_s) / braking
        before = time + np.maximum(deeper_mm - way, 0.0) / self.approach_mm_s
        return np.where(deeper_mm > 0.0, -before, inside)

    def at(self, time_s: NDArray) -> NDArray:
        """Place of the punch, 0 at contact with the pad. [mm]"""
        back = np.maximum(-time_s, 0.0)
        slow = np.minimum(back, (self.approach_mm_s - self.contact_mm_s) / self.braking_mm_s2)
        before = self.contact_mm_s * slow + 0.5 * self.braking_mm_s2 * slow**2 + self.approach_mm_s * (back - slow)
        return np.where(time_s < 0.0, -before, np.interp(time_s, self.time_s, self.x_mm))

    def to(self, depth_mm: NDArray, coarse: bool = False) -> Motion:
        """Motion to depths at the end of the hold, shape (p,): time from contact, shapes (p, n).

        A coarse one ends halfway through the last twentieth of the hold, where the force is the steady force.
        """
        deeper = np.asarray(depth_mm, float) - self.depth_mm
        contact = np.minimum(self.contact_s(deeper), 0.999 * self.stop_s)[..., None]
        after = self.time_s[self.time_s > self.stop_s]
        if coarse:
            end = float(self.time_s[-1]) - 0.5 * LATE * (float(self.time_s[-1]) - self.stop_s)
            after = np.r_[after[after < end][:: RISE // COARSE], end]
        share = np.linspace(0.0, 1.0, (COARSE if coarse else RISE) + 1)
        rise = contact + (self.stop_s - contact) * share
        time = np.concatenate([rise, np.broadcast_to(after, (*deeper.shape, len(after)))], axis=-1)
        x = self.at(time) + deeper[..., None]
        x[..., 0] = 0.0
        return Motion(time - contact, x)
