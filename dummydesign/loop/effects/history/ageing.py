"""The modulus grows with the age of the pad."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import HistoryEffect, Parameter, SetupLaw, Values


class Ageing(HistoryEffect):
    """E x (1 + growth_per_doubling log2(age / 7 days)): curing that goes on, logarithmic in time."""

    name = "ageing"
    designed_for = "a pad 7 days old"
    needs = ("age_days",)
    parameters = (Parameter("growth_per_doubling", "1", 0.0, -0.3, 0.5, 0.03),)
    signature = "scale that steps from day to day"
    cause = "cure that goes on"
    remedy = "press at the age at which the pad will be used, or wait until the modulus stands still"
    reference = "physical ageing, Struik (1978); after-cure of polyurethane"

    def undefined(self, presses: Presses, law: SetupLaw) -> str:
        reason = super().undefined(presses, law)
        return reason or ("" if presses.history.age_days.min() > 0 else "needs age_days above 0")

    def untestable(self, presses: Presses) -> str:
        age = presses.history.age_days
        return "" if age.max() > 1.1 * age.min() else "needs pads at two ages"

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return 1.0 + values["growth_per_doubling"] * np.log2(presses.history.age_days[:, None] / REFERENCE_DAYS)


REFERENCE_DAYS = 7.0
