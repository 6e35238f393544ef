"""The sensor reads something without load."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values


class ForceBias(SensorEffect):
    """A constant added to every force (zero not set)."""

    name = "force_bias"
    parameters = (Parameter("bias_N", "N", 0.0, -5.0, 5.0, 0.03),)
    signature = "the same force everywhere, also before contact"
    cause = "load cell that was not tared, or that carries the punch's weight"
    remedy = "tare before every press with the punch hanging free"
    reference = "sensor zero"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N + values["bias_N"]
