"""The force signal lags behind by more than the declared filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, Parameter, Values


class SensorLag(Effect):
    """A further first-order low-pass with a time constant, exact for piecewise-linear forces.

    Delays and rounds; a pure delay is ``time_skew``.
    """

    name = "sensor_lag"
    hook = "sensor"
    belongs_to = "sensor"
    parameters = (Parameter("time_constant_s", "s", 0.0, 0.0, 0.1, 0.002),)
    signature = "late and rounded at the fast stop, nothing in the slow parts"
    cause = "filter in the amplifier that was not declared"
    remedy = "read the amplifier's filter and declare it under [sensor]; or measure its step response"
    reference = "first-order low-pass"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        step = np.diff(presses.time_s, axis=1) / values["time_constant_s"]
        # delay D = u - y obeys D' = u' - D / tau
        rise = np.diff(force_N, axis=1) * (-np.expm1(-step) / step)
        out = force_N.copy()
        out[:, 1:] -= linear_recurrence(np.exp(-step), rise, np.zeros(len(force_N)))
        return out
