"""The force is read by a curve, not by a straight line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, SensorEffect, Values, usual_starts

AT_N = 10.0


class SensorCurve(SensorEffect):
    """F_read = F (1 + c (|F| / 10 N)^p), after the filter: c is the change at 10 N, p = 1 a quadratic curve."""

    name = "sensor_curve"
    parameters = (
        Parameter("relative_change", "1", 0.0, -0.6, 0.6, 0.03),
        Parameter("exponent", "1", 1.0, 1.0, 3.0, 0.5, spread=2.0),
    )
    signature = "grows with the force, alike on all pads and at all speeds"
    cause = "amplifier or load cell that is not linear, or calibrated at one force only"
    remedy = "calibrate the load cell with weights at five forces and import with that curve"
    negligible = 0.01
    reference = "relative nonlinearity of a force transducer (ISO 376)"

    # the base imitates a strong curve by arms far from their own
    base_starts = usual_starts

    def reading(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return force_N * (1.0 + values["relative_change"] * (np.abs(force_N) / AT_N) ** values["exponent"])
