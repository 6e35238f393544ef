"""What a motion did: contact, stop, hold, and the speed that the robot was sent with."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dummydesign.measurement.commanded_speed import CommandedSpeed, commanded_speed
from dummydesign.measurement.motion import Motion

NOWHERE = Motion(np.zeros(0), np.zeros(0))


@dataclass(frozen=True)
class Ramp:
    """What a motion did: contact, stop, the depth it held and until when.

    ``velocity_mm_s`` is the mean speed from contact to stop, the v of an ideal ramp with the same t_p. A punch that
    overshot went ``overshoot_mm`` beyond the depth and rang with ``period_s`` until ``settled_s``; without that the
    first and the last are 0. A press without a hold ends at its stop. ``path`` is the motion that was read.
    """

    contact_time_s: float
    stop_time_s: float
    hold_end_s: float
    depth_mm: float
    velocity_mm_s: float
    overshoot_mm: float = 0.0
    settled_s: float = 0.0
    period_s: float = 0.0
    path: Motion = field(default=NOWHERE, repr=False, compare=False)

    @cached_property
    def speed(self) -> CommandedSpeed:
        """Speed that the robot was sent with, and its braking."""
        return commanded_speed(self.path, self.contact_time_s, self.stop_time_s, self.depth_mm, self.overshoot_mm > 0.0)

    @property
    def rise_time_s(self) -> float:
        """Time from contact to stop, t_p of the ideal ramp. [s]"""
        return self.stop_time_s - self.contact_time_s
