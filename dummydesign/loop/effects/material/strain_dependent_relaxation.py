"""The strength of relaxation depends on strain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Arm, PadEffect, Parameter, Values


class StrainDependentRelaxation(PadEffect):
    """beta_i goes as 1 + slope (exp(growth x) - 1) / growth with x = d/h - 0.15, the relative depth at which the arm
    is loaded (not separable).

    The share that relaxes grows with depth; the long-term force does not change. The base strengths are those
    at d/h = 0.15, where ``slope`` is their relative change. Laws of growth differ from gel to gel, so the change
    itself may change with depth as exp(growth x): 0 is linear, ``growth = slope`` exponential, below 0 saturates.
    No strength turns negative: below a tenth of its base it falls on as a hyperbola, with the same tangent.
    """

    name = "strain_dependent_relaxation"
    parameters = (
        Parameter("slope", "1", 0.0, -3.0, 15.0, 0.5),
        Parameter("growth", "1", 0.0, -6.0, 20.0, 3.0, starts=(0.0,)),
    )
    signature = "peak over steady force depends on depth over thickness"
    cause = "gel that relaxes more the further it is pressed"
    remedy = "press at three depths on one pad at one speed"
    reference = (
        "Pryse et al., Ann. Biomed. Eng. 31 (2003) 1287 (strengths that are polynomials of strain); Fung, Biomechanics "
        "(1993), ch. 7 (exponential in strain)"
    )

    def arms(self, presses: Presses, arms: tuple[Arm, ...], depth_mm: NDArray, values: Values) -> tuple[Arm, ...]:
        share = np.maximum(depth_mm, 0.0) / presses.thickness_mm[:, None]
        return self.pressed_arms(arms, share, presses.velocity_mm_s[:, None], values)

    def pressed_arms(
        self, arms: tuple[Arm, ...], share: NDArray, velocity_mm_s: NDArray, values: Values
    ) -> tuple[Arm, ...]:
        weight = strength(share, values["slope"], values["growth"])
        return tuple(arm.changed(weight=weight if arm.weight is None else arm.weight * weight) for arm in arms)


REFERENCE_DEPTH_SHARE, LEAST = 0.15, 0.1


def strength(depth_share: NDArray, slope: float, growth: float) -> NDArray:
    """Strength of an arm over that at d/h = 0.15; above zero at every depth."""
    excess = depth_share - REFERENCE_DEPTH_SHARE
    plain = 1.0 + slope * (excess if abs(growth) < 1e-9 else np.expm1(growth * excess) / growth)
    return np.where(plain > LEAST, plain, LEAST**2 / (2.0 * LEAST - np.minimum(plain, LEAST)))
