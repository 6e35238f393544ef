"""The modulus depends on the temperature of the room."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, Parameter, Values


class Temperature(Effect):
    """E x (1 - modulus_loss_per_K (T - 23 C)). The shift of relaxation times is left out."""

    name = "temperature"
    hook = "batch"
    belongs_to = "pad"
    designed_for = "23 C"
    needs = ("temperature_C",)
    parameters = (Parameter("modulus_loss_per_K", "1/K", 0.0, -0.1, 0.1, 0.005),)
    signature = "scale that follows the temperature of the trial"
    cause = "room that is not kept at one temperature"
    remedy = "keep pads and room within 1 K, or give temperature_C of every trial"
    reference = "Treloar, The Physics of Rubber Elasticity (1975); Ferry (1980)"

    def untestable(self, presses: Presses) -> str:
        value = presses.history.temperature_C
        return "" if value.max() - value.min() > 0.5 else "needs temperatures that differ by more than 0.5 K"

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return 1.0 - values["modulus_loss_per_K"] * (presses.history.temperature_C[:, None] - REFERENCE_C)


REFERENCE_C = 23.0
