"""The tacky pad pulls at the punch while it lifts off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, Parameter, Values


class Adhesion(Effect):
    """On the way back the contact carries tension up to ``pull_off_N``, and lets go over the first 0.5 mm above
    the surface."""

    name = "adhesion"
    hook = "pad"
    belongs_to = "pad"
    designed_for = "the way in and the hold, not the way back"
    parameters = (Parameter("pull_off_N", "N", 0.0, 0.0, 5.0, 0.1),)
    signature = "tension near zero depth, unloading only"
    cause = "tacky gel on a clean punch"
    remedy = "powder the surface with talc, or keep to the way in and the hold"
    reference = "Kendall, J. Phys. D 4 (1971) 1186 (flat punch)"

    def untestable(self, presses: Presses) -> str:
        return "" if presses.unloads.any() else "needs trials that go on after the hold (unloading)"

    def floor(self, presses: Presses, floor_N: NDArray, values: Values) -> NDArray:
        away = presses.time_s > presses.hold_end_s[:, None]
        held = np.clip(1.0 + presses.displacement_mm / RELEASE_MM, 0.0, 1.0)
        return floor_N - values["pull_off_N"] * np.where(away, held, 0.0)


RELEASE_MM = 0.5
