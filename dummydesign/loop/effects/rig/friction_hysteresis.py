"""A dry friction in the rig or under the punch opposes the motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Effect, Parameter, Values


class FrictionHysteresis(Effect):
    """Loss as a fraction of the force, each way: F (1 + friction) on the way in and in the hold, F (1 - friction)
    on the way out, turning over within ``turn_mm`` of the way back, 0.1 mm as a rule.

    A joint that slides turns over in part where a robot wanders in the hold: ``in_hold`` of the way back that
    :func:`turned_mm` follows, a form.
    """

    name = "friction_hysteresis"
    hook = "pad"
    belongs_to = "rig"
    parameters = (
        Parameter("friction_fraction", "1", 0.0, 0.0, 0.6, 0.03),
        Parameter("turn_mm", "mm", 0.1, 0.02, 0.5, 0.1, log=True, spread=0.7),
        Parameter("in_hold", "1", 0.0, 0.0, 2.0, 0.5, spread=1.0),
    )
    signature = "unloading lower than relaxation alone explains, without rate dependence"
    cause = "dry friction in the guide of the punch, or under the punch"
    remedy = "move the punch without a pad and read the force of the guide; lubricate it"
    reference = "Coulomb friction; Johnson, Contact Mechanics (1985); Dahl, AIAA J. 14 (1976) 1675 (small moves)"

    def untestable(self, presses: Presses) -> str:
        return "" if presses.unloads.any() else "needs trials that go on after the hold (unloading)"

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        back = np.clip((presses.depth_mm[:, None] - presses.displacement_mm) / values["turn_mm"], 0.0, 1.0)
        away = presses.time_s > presses.hold_end_s[:, None]
        held = values["in_hold"] * turned_mm(presses.displacement_mm, values["turn_mm"]) if values["in_hold"] else 0.0
        state = 1.0 - 2.0 * np.where(away, back, held / values["turn_mm"])
        return force_N * (1.0 + values["friction_fraction"] * state)


def turned_mm(displacement_mm: NDArray, turn_mm: float) -> NDArray:
    """How far the punch has come back (T, N) since it last slid forward, ``turn_mm`` at most. [mm]"""
    out = np.zeros_like(displacement_mm)
    for place, moved in enumerate(np.diff(displacement_mm, axis=1).T, 1):
        out[:, place] = np.clip(out[:, place - 1] - moved, 0.0, turn_mm)
    return out
