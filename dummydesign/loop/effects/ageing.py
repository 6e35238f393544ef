"""The modulus grows with the age of the pad."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.effects.base import Effect, Parameter, Values
from dummydesign.loop.presses import Presses


class Ageing(Effect):
    """E x (1 + growth_per_doubling log2(age / 7 days)): curing that goes on, logarithmic in time."""

    name = "ageing"
    stage = "batch"
    parameters = (Parameter("growth_per_doubling", "1", 0.0, -0.3, 0.5, 0.03),)
    signature = "scale that steps from day to day"
    reference = "physical ageing, Struik (1978); after-cure of polyurethane"

    def unavailable(self, presses: Presses, shape: str) -> str:
        age = presses.history.age_days
        return "" if age.min() > 0 and age.max() > 1.1 * age.min() else "needs age_days of every trial, at two ages"

    def scale(self, presses: Presses, depth_mm: NDArray, values: Values) -> NDArray:
        return 1.0 + values["growth_per_doubling"] * np.log2(presses.history.age_days[:, None] / REFERENCE_DAYS)


REFERENCE_DAYS = 7.0
