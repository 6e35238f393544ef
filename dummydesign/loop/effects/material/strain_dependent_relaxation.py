"""The strength of relaxation depends on strain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, Effect, Parameter, Values


class StrainDependentRelaxation(Effect):
    """beta_i goes as 1 + slope (d/h - 0.15) with the relative depth at which the arm is loaded (not separable).

    The share that relaxes grows with depth; the long-term force does not change. The base strengths are those
    at d/h = 0.15.
    """

    name = "strain_dependent_relaxation"
    hook = "pad"
    belongs_to = "pad"
    designed_for = "relaxation as it is at a depth of 0.15 of the thickness"
    parameters = (Parameter("slope", "1", 0.0, -3.0, 15.0, 0.5),)
    signature = "peak over steady force depends on depth over thickness"
    cause = "gel that relaxes more the further it is pressed"
    remedy = "press at three depths on one pad at one speed"
    reference = "Pryse et al., Ann. Biomed. Eng. 31 (2003) 1287 (nonlinear relaxation)"

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        share = np.maximum(depth_mm, 0.0) / presses.thickness_mm[:, None]
        weight = np.maximum(1.0 + values["slope"] * (share - REFERENCE_DEPTH_SHARE), 0.0)
        return tuple(arm.changed(weight=weight if arm.weight is None else arm.weight * weight) for arm in arms)


REFERENCE_DEPTH_SHARE = 0.15
