"""The mass between sensor and pad is braked with the robot."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values


class Inertia(SensorEffect):
    """Force + mass x acceleration of the robot: a pulse where it brakes, nothing in the hold."""

    name = "inertia"
    parameters = (Parameter("mass_kg", "kg", 0.0, 0.0, 2.0, 0.02),)
    signature = "pulse at the stop, at the high speed only, the same on all pads"
    cause = "mass of the punch below the load cell"
    remedy = "use a lighter punch, a slower stop, or subtract mass times acceleration"
    reference = "Newton; tip mass in front of a force sensor"

    def untestable(self, presses: Presses) -> str:
        return "" if (presses.acceleration_mm_s2 != 0).any() else "needs motion sampled at 400 Hz or faster"

    def sensor(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N + 1e-3 * values["mass_kg"] * presses.acceleration_mm_s2
