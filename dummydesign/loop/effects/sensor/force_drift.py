"""The sensor's zero drifts during a trial."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values


class ForceDrift(SensorEffect):
    """Force + drift x time since the start of the trial's file."""

    name = "force_drift"
    parameters = (Parameter("drift_N_per_s", "N/s", 0.0, -0.5, 0.5, 0.005),)
    signature = "straight line in time, the same whatever the force, also in the unloaded tail"
    cause = "load cell that warms up, or a tare that creeps"
    remedy = "let the sensor warm up for half an hour, and read it before and after every press"
    reference = "charge amplifiers and warming strain gauges"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N + values["drift_N_per_s"] * (presses.time_s - presses.time_s[:, :1])
