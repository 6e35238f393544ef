"""The surface has not come back fully from the press before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import HistoryEffect, Parameter, Values


class IncompleteRecovery(HistoryEffect):
    """A dent of fraction x (depth of an earlier press) x exp(-elapsed / tau) is left; of the others ``adding`` is added
    to the deepest: none or all is a convention.

    The punch touches later by the dent, on pads that had little rest.
    """

    name = "incomplete_recovery"
    designed_for = "a pad that has rested"
    needs = ("rest_s",)
    parameters = (
        Parameter("fraction", "1", 0.0, 0.0, 0.5, 0.02),
        Parameter("tau_s", "s", 120.0, 10.0, 3000.0, 120.0, log=True, starts=(40.0, 500.0)),
        Parameter("adding", "1", 0.0, 0.0, 1.0, 1.0, spread=0.5),
    )
    signature = "contact comes later after a deep press and a short rest"
    cause = "rests that are too short after deep presses"
    remedy = "rest the pad for some minutes between presses, or press deep last"
    reference = "viscoelastic recovery, e.g. Ferry, Viscoelastic Properties of Polymers (1980)"

    def untestable(self, presses: Presses) -> str:
        return "" if np.any(presses.history.earlier_depth_mm > 0) else "no pad is pressed twice"

    def depth(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        left = presses.history.earlier_depth_mm * np.exp(-presses.history.elapsed_s / values["tau_s"])
        deepest = left.max(axis=1)
        dent = deepest + values["adding"] * (left.sum(axis=1) - deepest)
        return depth_mm - values["fraction"] * dent[:, None]
