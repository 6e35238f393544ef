"""A dry friction in the rig or under the punch opposes the motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, RigEffect, Values


class FrictionHysteresis(RigEffect):
    """Loss as a fraction of the force, each way: F (1 + friction) on the way in and in the hold, F (1 - friction)
    on the way out. It turns over exponentially (Dahl's law): half of the way back ``turn_mm``, 0.1 mm as a rule, takes
    it to nothing.

    A joint that slides turns over in part where a robot wanders in the hold, a form: ``in_hold`` of :func:`dahl`.
    """

    name = "friction_hysteresis"
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
        x, turn, share = presses.displacement_mm, values["turn_mm"] / HALVINGS, values["in_hold"]
        back = 2.0 * np.exp(-np.maximum(presses.depth_mm[:, None] - x, 0.0) / turn) - 1.0
        held = 1.0 - share * (1.0 - dahl(x, turn)) if share else 1.0
        return force_N * (1.0 + values["friction_fraction"] * np.where(presses.going_back, back, held))


HALVINGS = 2.0 * np.log(2.0)  # decays in the way that turns the friction over


def dahl(displacement_mm: NDArray, decay_mm: float) -> NDArray:
    """Dry friction over its largest value (T, N) along a path, 1 while the punch goes on."""
    moved = np.diff(displacement_mm, axis=1)
    keep, toward = np.exp(-np.abs(moved) / decay_mm), np.sign(moved)
    out = np.ones_like(displacement_mm)
    for place in range(moved.shape[1]):
        out[:, place + 1] = toward[:, place] + (out[:, place] - toward[:, place]) * keep[:, place]
    return out
