"""The tacky pad pulls at the punch while it lifts off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import PadEffect, Parameter, Values


class Adhesion(PadEffect):
    """On the way back the contact carries tension up to ``pull_off_N``, and lets go over ``release_mm`` above the
    surface; below it the edge of the contact pulls, and less the deeper: pull_off exp(-depth / neck_mm).

    A contact that peels from its edge as it gets smaller pulls at every depth too, as the root of the force:
    pull_off deep sqrt(F / 10 N). ``deep`` is a form, 0 for a flat face.
    """

    name = "adhesion"
    designed_for = "the way in and the hold, not the way back"
    parameters = (
        Parameter("pull_off_N", "N", 0.0, 0.0, 50.0, 0.1),
        Parameter("release_mm", "mm", 0.5, 0.05, 5.0, 0.5, log=True, spread=0.7),
        Parameter("neck_mm", "mm", 0.05, 0.005, 1.0, 0.05, log=True, starts=(0.3,), spread=1.0),
        Parameter("deep", "1", 0.0, 0.0, 5.0, 0.3, spread=1.0),
    )
    signature = "tension near zero depth, unloading only"
    cause = "tacky gel on a clean punch"
    remedy = "powder the surface with talc, or keep to the way in and the hold"
    reference = (
        "Kendall, J. Phys. D 4 (1971) 1186 (flat punch); Johnson, Kendall, Roberts, Proc. R. Soc. A 324 (1971) 301 "
        "(root of the force)"
    )

    def untestable(self, presses: Presses) -> str:
        return "" if presses.unloads.any() else "needs trials that go on after the hold (unloading)"

    def unseen(self, presses: Presses) -> str:
        return "" if presses.pulls >= WAYS_BACK else "fewer than two presses read tension while unloading"

    def floor(self, presses: Presses, floor_N: NDArray, values: Values) -> NDArray:
        return floor_N - values["pull_off_N"] * presses.going_back

    def surface(self, presses: Presses, depth_mm: NDArray, force_N: NDArray, values: Values) -> NDArray:
        neck = np.exp(-np.maximum(depth_mm, 0.0) / values["neck_mm"])
        held = np.clip(1.0 + depth_mm / values["release_mm"], 0.0, 1.0)
        pull = values["pull_off_N"] * presses.going_back
        edge = pull * values["deep"] * np.sqrt(np.maximum(force_N, 0.0) / AT_N)
        return np.maximum(force_N - pull * neck - edge, -pull * held)


AT_N = 10.0  # force at which the pull at depth is ``deep`` of the largest
WAYS_BACK = 2
"""Presses that must show tension: an effect of one way back is of that press."""
