"""A relaxation faster than the two arms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, Effect, Parameter, Values
from dummydesign.pad.material.relaxation import PronyTerm


class FastRelaxationMode(Effect):
    """A third arm (tau, beta), its time bounded away from the usual two."""

    name = "fast_relaxation_mode"
    stage = "pad"
    belongs_to = "pad"
    parameters = (
        Parameter("beta", "1", 0.0, 0.0, 5.0, 0.05),
        Parameter("tau_s", "s", 0.01, 0.002, 0.03, 0.01, log=True, starts=(0.02,)),
    )
    signature = "extra force in the fast ramp that is gone some hundredths of a second after the stop"
    reference = "Pawluk and Howe, J. Biomech. Eng. 121 (1999) 178 (modes of 4 ms, 70 ms, 1.4 s)"

    always_fitted = True

    def base_starts(self, logs: NDArray) -> list[NDArray]:
        # without the mode the fast arm sits between its own time and the mode's, or is used up by the mode
        near, used_up = logs.copy(), logs.copy()
        near[1] += 0.4
        used_up[1:] = [min(logs[3], np.log(LONGEST_FAST_S)), logs[4], np.log(USUAL_SLOW_S), np.log(USUAL_BETA)]
        return [near, used_up]

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        return (*arms, Arm(values["tau_s"], values["beta"]))

    def adds_terms(self, values: Values) -> tuple[PronyTerm, ...]:
        return (PronyTerm(values["tau_s"], values["beta"]),)


USUAL_SLOW_S, LONGEST_FAST_S, USUAL_BETA = 1.5, 0.3, 0.2
