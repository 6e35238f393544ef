"""Relaxation is faster after a faster ramp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, PadEffect, Parameter, Values


class RateDependentViscosity(PadEffect):
    """Time constants fall as (speed / 50 mm/s)^-exponent: a shear-thinning viscosity, frozen per trial.

    The speed is sqrt(v^2 + v0^2) with v the ramp's and ``plateau_mm_per_s`` v0, below which gels thin no more. On the
    way back v goes towards the speed there by the power ``way_back``: 0 is that of the ramp, 1 its own. The fast arm
    has the exponent times ``fast_arm``: the two viscosities need not thin alike.
    """

    name = "rate_dependent_viscosity"
    parameters = (
        Parameter("exponent", "1", 0.0, -0.8, 1.5, 0.1),
        Parameter("plateau_mm_per_s", "mm/s", 5.0, 0.5, 100.0, 5.0, log=True, spread=1.0),
        Parameter("way_back", "1", 0.0, 0.0, 1.0, 1.0, spread=0.5),
        Parameter("fast_arm", "1", 1.0, -1.0, 3.0, 0.5, spread=1.0),
    )
    signature = "time constants differ between speeds; one spectrum cannot serve both"
    cause = "gel whose flow thins with speed"
    remedy = "press at a speed between the two and at one beyond, to fix the exponent"
    reference = "the paper: c2 and c3 fall with speed; Cross, J. Colloid Sci. 20 (1965) 417 (shear thinning)"

    def untestable(self, presses: Presses) -> str:
        speed = presses.velocity_mm_s
        return "" if speed.max() > 1.5 * speed.min() else "needs two speeds"

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        speed = presses.velocity_mm_s[:, None]
        if values["way_back"] and presses.unloads.any():
            faster = (presses.back_mm_s[:, None] / speed) ** values["way_back"]
            speed = speed * np.where(presses.going_back, faster, 1.0)
        return self.pressed_arms(arms, depth_mm, speed, values)  # whatever the depth

    def pressed_arms(
        self, arms: tuple[Arm, ...], share: NDArray, velocity_mm_s: NDArray, values: Values
    ) -> tuple[Arm, ...]:
        speed, slow = velocity_mm_s, values["plateau_mm_per_s"]
        over = (speed**2 + slow**2) / (REFERENCE_MM_S**2 + slow**2)
        # the base's two arms come first; a fit may exchange them
        fast = min(range(len(arms[:2])), key=lambda at: np.mean(arms[at].tau_s), default=0)
        powers = [values["exponent"] * (values["fast_arm"] if at == fast else 1.0) for at in range(len(arms))]
        return tuple(arm.changed(tau_s=arm.tau_s * over ** (-0.5 * power)) for arm, power in zip(arms, powers))


REFERENCE_MM_S = 50.0
