"""A relaxation slower than the two arms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, Effect, Parameter, Values
from dummydesign.pad.material.relaxation import PronyTerm


class SlowRelaxationMode(Effect):
    """A third arm (tau, beta), its time bounded away from the usual two."""

    name = "slow_relaxation_mode"
    stage = "pad"
    belongs_to = "pad"
    parameters = (
        Parameter("beta", "1", 0.0, 0.0, 5.0, 0.05),
        Parameter("tau_s", "s", 10.0, 4.0, 200.0, 10.0, log=True, starts=(30.0,)),
    )
    signature = "slow drift of force through the whole hold, proportional to force"
    reference = "Pawluk and Howe, J. Biomech. Eng. 121 (1999) 178 (modes of 4 ms, 70 ms, 1.4 s)"

    always_fitted = True

    def base_starts(self, logs: NDArray) -> list[NDArray]:
        # without the mode the slow arm sits between its own time and the mode's, or is used up by the mode
        near, used_up = logs.copy(), logs.copy()
        near[3] -= 0.3
        used_up[1:] = [np.log(USUAL_FAST_S), np.log(USUAL_BETA), logs[1], logs[2]]
        return [near, used_up]

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        return (*arms, Arm(values["tau_s"], values["beta"]))

    def adds_terms(self, values: Values) -> tuple[PronyTerm, ...]:
        return (PronyTerm(values["tau_s"], values["beta"]),)


USUAL_FAST_S, USUAL_BETA = 0.05, 0.2
