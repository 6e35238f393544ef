"""The frame, arm and sensor give way under the force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, RigEffect, Values

AT_N, TOUCHING_N = 10.0, 0.5
"""Force at which the compliance means the same whatever the exponent; force below which a joint hardens no more."""


class MachineCompliance(RigEffect):
    """Pad depth = displacement - compliance x force x (force / 10 N)^(exponent - 1), solved together with the force.

    A spring in series: the same softening for equal force, whatever the pad, so stiff (thin) pads lose most;
    in the hold the relaxing force lets the punch sink further. Joints and films harden under force: the exponent, 1
    for a spring and 2/3 for a contact of Hertz, is a form.
    """

    name = "machine_compliance"
    hook = "motion"
    parameters = (
        Parameter("compliance_mm_per_N", "mm/N", 0.0, 0.0, 0.08, 0.003),
        Parameter("exponent", "1", 1.0, 0.6, 1.4, 0.15, spread=1.0),
    )
    signature = "softening proportional to force, same at all speeds, most on the thin pad"
    cause = "frame, robot arm, load cell or glue that gives way in series with the pad"
    remedy = "press a steel block to find the compliance, and subtract compliance times force from the displacement"
    reference = "Oliver and Pharr, J. Mater. Res. 7 (1992) 1564 (load-frame compliance)"
    feeds_back = True

    def yielding(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        hard = (np.abs(force_N) + TOUCHING_N) / (AT_N + TOUCHING_N)
        return values["compliance_mm_per_N"] * force_N * hard ** (values["exponent"] - 1.0)
