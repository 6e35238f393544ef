"""The pad softens where it has been pressed before (Mullins)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import HistoryEffect, Parameter, Values


class SofteningWithCycles(HistoryEffect):
    """Elastic force loses ``softening`` at the first reloading to a depth reached before, more at later ones.

    Loss after n earlier presses to this depth: softening (1 - exp(-n / cycles)) / (1 - exp(-1 / cycles)). About
    ``rejoin_share`` of the earlier depth the virgin curve is rejoined, within ``width_share`` of it. No recovery.
    """

    name = "softening_with_cycles"
    designed_for = "a pad that is pressed for the first time"
    parameters = (
        Parameter("softening", "1", 0.0, 0.0, 0.5, 0.03),
        Parameter("rejoin_share", "1", 1.0, 0.8, 1.3, 1.0, log=True, spread=0.05),
        Parameter("width_share", "1", 0.05, 0.01, 0.3, 0.05, log=True, spread=0.7),
        Parameter("cycles", "1", 1.5, 0.3, 10.0, 1.5, log=True, spread=0.3),
    )
    signature = "first press high, later ones lower; only below the depth reached before"
    cause = "filled or weakly crosslinked gel on its first presses"
    remedy = "press every pad a few times to its full depth before it is measured, and use it like that"
    reference = "Mullins, Rubber Chem. Technol. 42 (1969) 339; Liao et al. on Ecoflex"

    def untestable(self, presses: Presses) -> str:
        return "" if np.any(presses.history.earlier_depth_mm > 0) else "no pad is pressed twice"

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        count = np.zeros_like(depth_mm)
        depth = np.maximum(depth_mm, 1e-9)
        for earlier in presses.history.earlier_depth_mm.T:
            later = earlier > 0  # of the same pad
            if later.any():
                beyond = depth[later] / earlier[later, None] - values["rejoin_share"]
                count[later] += 0.5 * (1.0 - np.tanh(beyond / values["width_share"]))
        loss = np.expm1(-count / values["cycles"]) / np.expm1(-1.0 / values["cycles"])
        return 1.0 - values["softening"] * loss
