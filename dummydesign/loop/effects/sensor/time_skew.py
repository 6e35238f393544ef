"""The clocks of force and displacement differ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values


class TimeSkew(SensorEffect):
    """The force clock is late by ``skew_s``: what is saved at t belongs to t - skew."""

    name = "time_skew"
    parameters = (Parameter("skew_s", "s", 0.0, -0.05, 0.05, 0.002),)
    signature = "pure shift in time at the fast stop, shape unchanged"
    cause = "force and position from two clocks"
    remedy = "record both by one device, or tap the punch to line them up"
    reference = "unsynchronised acquisition"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return np.stack(
            [np.interp(time - values["skew_s"], time, force) for time, force in zip(presses.time_s, force_N)]
        )
