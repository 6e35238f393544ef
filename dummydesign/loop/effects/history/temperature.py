"""The modulus depends on the temperature of the room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, HistoryEffect, Parameter, Values


class Temperature(HistoryEffect):
    """E x (1 - modulus_loss_per_K (T - 23 C)); relaxation times shift as exp(-times_over_modulus
    modulus_loss_per_K (T - 23 C)), little in gels."""

    name = "temperature"
    designed_for = "23 C"
    needs = ("temperature_C",)
    parameters = (
        Parameter("modulus_loss_per_K", "1/K", 0.0, -0.1, 0.1, 0.005),
        Parameter("times_over_modulus", "1", 0.0, -20.0, 20.0, 1.0, spread=3.0),
    )
    signature = "scale that follows the temperature of the trial"
    cause = "room that is not kept at one temperature"
    remedy = "keep pads and room within 1 K, or give temperature_C of every trial"
    reference = "Treloar, The Physics of Rubber Elasticity (1975); Ferry (1980)"

    def untestable(self, presses: Presses) -> str:
        value = presses.history.temperature_C
        return "" if value.max() - value.min() > 0.5 else "needs temperatures that differ by more than 0.5 K"

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return 1.0 - values["modulus_loss_per_K"] * (presses.history.temperature_C[:, None] - REFERENCE_C)

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        if not values["times_over_modulus"]:
            return arms
        shift = values["times_over_modulus"] * values["modulus_loss_per_K"]
        factor = np.exp(-shift * (presses.history.temperature_C[:, None] - REFERENCE_C))
        return tuple(arm.changed(tau_s=arm.tau_s * factor) for arm in arms)


REFERENCE_C = 23.0
