"""Readings end at one value, whatever the force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values, usual_starts


class SensorClipping(SensorEffect):
    """F_read = F - share max(F - L, 0), with L the value at which readings end; share is 1 when all is cut off."""

    name = "sensor_clipping"
    parameters = (Parameter("share", "1", 0.0, 0.0, 1.5, 1.0),)
    signature = "readings stay at one value in the strongest presses and are right below it"
    cause = "amplifier or converter at the end of its range"
    remedy = "take a larger range, or press less deep; readings at that value are lost"
    reference = "saturation; the value is read off the raw data"
    always_fitted = True
    seen_raw = True

    # the base imitates a top that is cut off by arms far from their own
    base_starts = usual_starts

    def untestable(self, presses: Presses) -> str:
        return "" if presses.flat_top_N is not None else "needs readings that stay at one largest value"

    def reading(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        limit = presses.flat_top_N
        return force_N if limit is None else force_N - values["share"] * np.maximum(force_N - limit, 0.0)
