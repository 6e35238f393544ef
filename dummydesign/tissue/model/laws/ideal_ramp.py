"""The closed form of the paper for an ideal ramp, as printed and made continuous at the stop."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, MotionResponse


class IdealRamp(MaxwellLaw):
    """Equation (5) of the paper, which knows speed v and stop time t_p only.

    An arm of rate r carries v / r (1 - exp(-r v^2 t^3)) while it is loaded, times exp(-r (v t_p)^2 (t - t_p)) after.
    ``running_clock`` puts t for t_p there, as the exponent is printed.
    """

    ideal_ramp = True
    reference = (
        "'Development of Dummy Based on Impedance Properties of Human Soft Tissue Using a Nonlinear Viscoelastic "
        "Model', IEEE Access, equations (4) to (6)"
    )
    running_clock: ClassVar[bool]

    def drive(self, motion: Motion) -> RampDrive:
        """Drive by the ideal ramp with the contact, stop and depth of the motion."""
        return RampDrive(motion, self.running_clock)


class Consistent(IdealRamp):
    """With the stop time in the exponent: the force is continuous at the stop."""

    name = "consistent"
    words = "equation (5) for an ideal ramp, continuous at the stop"
    running_clock = False


class Published(IdealRamp):
    """With the running time in the exponent, as printed."""

    name = "published"
    words = "equation (5) for an ideal ramp, as printed"
    running_clock = True


class RampDrive(MotionResponse):
    """X and A of the ideal ramp that stands in for a motion."""

    def __init__(self, motion: Motion, running_clock: bool) -> None:
        contact, stop, depth = ramps_of(motion)
        self._running_clock = running_clock
        self._rise, self._depth = (stop - contact)[..., None], depth[..., None]
        self._velocity = self._depth / self._rise
        self._since = np.maximum(np.asarray(motion.time_s, float) - contact[..., None], 0.0)
        self.elastic = (self._velocity * np.minimum(self._since, self._rise)) ** 3

    def arm(self, rate: ArrayLike) -> NDArray:
        """A(t; r). [mm3]"""
        r = np.maximum(np.asarray(rate, float)[..., None], 1e-300)
        v, peak_time = self._velocity, self._rise
        rising = np.minimum(self._since, peak_time)
        held = np.maximum(self._since - peak_time, 0.0)
        clock = np.maximum(self._since, peak_time) if self._running_clock else peak_time
        loaded = -np.expm1(-r * v**2 * rising**3) * v / r
        return loaded * np.exp(-r * (v * clock) ** 2 * held)


def ramps_of(motion: Motion) -> tuple[NDArray, NDArray, NDArray]:
    """Contact time [s], stop time [s] and depth [mm] of each motion, each of shape (...)."""
    from dummydesign.measurement.ramp_detection import find_ramp

    time, x = np.broadcast_arrays(motion.time_s, motion.displacement_mm)
    ramps = [find_ramp(*row) for row in zip(time.reshape(-1, time.shape[-1]), x.reshape(-1, x.shape[-1]))]
    names = ("contact_time_s", "stop_time_s", "depth_mm")
    contact, stop, depth = (np.reshape([getattr(one, name) for one in ramps], time.shape[:-1]) for name in names)
    return contact, stop, depth


CONSISTENT, PUBLISHED = Consistent(), Published()
