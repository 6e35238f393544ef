"""A relaxation faster than the two arms."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.effects.base import Arm, Effect, Parameter, Values
from dummydesign.loop.presses import Presses


class FastRelaxationMode(Effect):
    """A third arm (tau, beta), its time bounded away from the usual two."""

    name = "fast_relaxation_mode"
    stage = "pad"
    parameters = (
        Parameter("beta", "1", 0.0, 0.0, 5.0, 0.05),
        Parameter("tau_s", "s", 0.01, 0.002, 0.03, 0.01, log=True, starts=(0.02,)),
    )
    signature = "extra force in the fast ramp that is gone some hundredths of a second after the stop"
    reference = "Pawluk and Howe, J. Biomech. Eng. 121 (1999) 178 (modes of 4 ms, 70 ms, 1.4 s)"

    always_fitted = True

    def unavailable(self, presses: Presses, shape: str) -> str:
        return ""

    def base_start(self, logs: NDArray) -> NDArray:
        # the fast arm of the base sits between its own time and that of the mode
        moved = logs.copy()
        moved[1] += 0.4
        return moved

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        return (*arms, Arm(values["tau_s"], values["beta"]))
