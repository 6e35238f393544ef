"""Motions of the punch: ramp and hold, measured and planned; the path of a robot, shifted to press another body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import out_of_range
from dummydesign.core.serialise import Serialised

DECELERATION_MM_S2 = 30_000.0
"""Default braking of the robot, 30 m/s2: 250 mm/s are stopped in 8.3 ms and 1.04 mm."""
HOLD_S = 10.0
"""Default hold after the stop, that of the published presses. [s]"""
LATE = 0.05
"""Share of the hold, at its end, whose mean force is the steady force."""


@dataclass(frozen=True, eq=False)
class Motion(Serialised):
    """Displacement of the punch over time, piecewise linear between its samples.

    ``time_s`` and ``displacement_mm`` have shape (n,) or (..., n) for many motions at once; compression
    is positive and zero is the nominal surface.
    """

    time_s: NDArray
    displacement_mm: NDArray


def work_mJ(displacement_mm: NDArray, force_N: NDArray) -> NDArray:
    """Integral of F dx along a press, by trapezoids. [mJ]"""
    return (0.5 * (force_N[..., 1:] + force_N[..., :-1]) * np.diff(displacement_mm, axis=-1)).sum(axis=-1)


def work_to_deepest_mJ(displacement_mm: NDArray, force_N: NDArray) -> NDArray:
    """Integral of F dx from the first sample, contact, to the largest displacement of each press. [mJ]

    This is the energy that a press puts into a body up to its deepest compression. A punch that rings gives and takes
    more afterwards: to the end of the hold only what the body dissipated is added, and what it gave back is missing.

    Parameters
    ----------
    displacement_mm, force_N : ndarray, shape (..., n)

    Returns
    -------
    ndarray, shape (...)
    """
    parts = 0.5 * (force_N[..., 1:] + force_N[..., :-1]) * np.diff(displacement_mm, axis=-1)
    reached = np.arange(parts.shape[-1]) < np.argmax(displacement_mm, axis=-1)[..., None]
    return np.asarray((parts * reached).sum(axis=-1))


def contact_velocity(velocity_mm_s: ArrayLike, depth_mm: ArrayLike, deceleration_mm_s2: float) -> NDArray:
    """Speed at first touch: as commanded, or sqrt(2 a depth) if braking begins above the surface. [mm/s]"""
    return np.minimum(np.asarray(velocity_mm_s, float), np.sqrt(2.0 * deceleration_mm_s2 * np.asarray(depth_mm, float)))


def ramp_and_hold(
    velocity_mm_s: ArrayLike,
    depth_mm: ArrayLike,
    hold_s: float = HOLD_S,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
    ramp_points: int = 60,
    brake_points: int = 24,
    hold_points: int = 60,
) -> Motion:
    """Move at constant speed, brake at constant deceleration to stop exactly at the depth, and hold.

    Time starts at contact. When the stopping distance v^2 / (2 a) is larger than the depth, the robot
    has to begin braking above the surface to end at the depth: it then touches at the lower speed
    sqrt(2 a depth) and brakes all the way (see :func:`contact_velocity`). An infinite deceleration
    gives the ideal ramp of the paper.
    """
    velocity, depth = np.broadcast_arrays(np.asarray(velocity_mm_s, float), np.asarray(depth_mm, float))
    for name, value in (("velocity_mm_s", velocity), ("depth_mm", depth), ("hold_s", np.asarray(hold_s))):
        wrong = value[~(np.isfinite(value) & (value > 0))]
        if wrong.size:
            raise out_of_range(name, wrong.flat[0], "above 0", "any finite value")
    if not deceleration_mm_s2 > 0:
        raise out_of_range("deceleration_mm_s2", deceleration_mm_s2, "above 0", "inf")
    touch = contact_velocity(velocity, depth, deceleration_mm_s2)
    braking = np.maximum(touch / deceleration_mm_s2, 0.0)
    straight = np.maximum(depth - 0.5 * touch * braking, 0.0) / touch
    # No part may have zero length, or times would repeat; a part of 1e-9 of the rise is nothing in force.
    floor = 1e-9 * (straight + braking)
    straight, braking = np.maximum(straight, floor)[..., None], np.maximum(braking, floor)[..., None]
    share = np.linspace(0.0, 1.0, ramp_points + 1)
    left = 1.0 - np.linspace(0.0, 1.0, brake_points + 1)[1:]
    after = np.geomspace(min(1e-4, hold_s / (10 * max(hold_points, 1))), hold_s, hold_points)
    stopped = straight + braking
    time = np.concatenate([straight * share, straight + braking * (1.0 - left), stopped + after], axis=-1)
    distance, stop = 0.5 * touch[..., None] * braking, depth[..., None]
    held = np.broadcast_to(stop, (*depth.shape, hold_points))
    return Motion(time, np.concatenate([(stop - distance) * share, stop - distance * left**2, held], axis=-1))


RISE_STEPS, COARSE_STEPS = 128, 32
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
            after = np.r_[after[after < end][:: RISE_STEPS // COARSE_STEPS], end]
        share = np.linspace(0.0, 1.0, (COARSE_STEPS if coarse else RISE_STEPS) + 1)
        rise = contact + (self.stop_s - contact) * share
        time = np.concatenate([rise, np.broadcast_to(after, (*deeper.shape, len(after)))], axis=-1)
        x = self.at(time) + deeper[..., None]
        x[..., 0] = 0.0
        return Motion(time - contact, x)
