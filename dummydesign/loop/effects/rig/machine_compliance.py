"""The frame, arm and sensor give way under the force."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, Parameter, Values


class MachineCompliance(Effect):
    """Pad depth = displacement - compliance x force, solved together with the force.

    A spring in series: the same softening for equal force, whatever the pad, so stiff (thin) pads lose most;
    in the hold the relaxing force lets the punch sink further.
    """

    name = "machine_compliance"
    hook = "motion"
    belongs_to = "rig"
    parameters = (Parameter("compliance_mm_per_N", "mm/N", 0.0, 0.0, 0.08, 0.003),)
    signature = "softening proportional to force, same at all speeds, most on the thin pad"
    cause = "frame, robot arm, load cell or glue that gives way in series with the pad"
    remedy = "press a steel block to find the compliance, and subtract compliance times force from the displacement"
    reference = "Oliver and Pharr, J. Mater. Res. 7 (1992) 1564 (load-frame compliance)"
    feeds_back = True

    def yielding(self, presses: Presses, force_N: NDArray, values: Values) -> NDArray:
        return values["compliance_mm_per_N"] * force_N
