"""The force signal lags behind by more than the declared filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values


class SensorLag(SensorEffect):
    """A further low-pass, exact for piecewise-linear forces: two stages that share the time constant.

    Delays and rounds; a pure delay is ``time_skew``. How much of the time is the second stage's is a form: none is a
    filter of first order, a half one of second order without overshoot.
    """

    name = "sensor_lag"
    parameters = (
        Parameter("time_constant_s", "s", 0.0, 0.0, 0.1, 0.002),
        Parameter("second_stage", "1", 0.0, 0.0, 0.5, 0.2, spread=1.5),
    )
    signature = "late and rounded at the fast stop, nothing in the slow parts"
    cause = "filter in the amplifier that was not declared"
    remedy = "read the amplifier's filter and declare it under [sensor]; or measure its step response"
    reference = "low-pass of first and second order"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        later = values["second_stage"]
        first = _low_pass(presses.time_s, force_N, (1.0 - later) * values["time_constant_s"])
        return _low_pass(presses.time_s, first, later * values["time_constant_s"])


def _low_pass(time_s: NDArray, force_N: NDArray, tau_s: float) -> NDArray:
    """A force (T, N) after a filter of first order."""
    if tau_s <= 0.0:
        return force_N
    step = np.diff(time_s, axis=1) / tau_s
    # delay D = u - y obeys D' = u' - D / tau
    rise = np.diff(force_N, axis=1) * (-np.expm1(-step) / step)
    out = force_N.copy()
    out[:, 1:] -= linear_recurrence(np.exp(-step), rise, np.zeros(len(force_N)))
    return out
