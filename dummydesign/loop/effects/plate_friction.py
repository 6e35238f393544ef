"""The plates hold the faces of a puck."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.effects.base import Effect, Parameter, Values
from dummydesign.loop.law import UnitForce, root_law
from dummydesign.loop.presses import Presses


class PlateFriction(Effect):
    """Friction of the plates: F x (1 + mu D / (3 h)) at the current diameter and height (slab method of upsetting).

    At large friction the faces stick; the factor ends at that of a bonded puck, 1 + 2 S^2 with the current shape
    factor S = D / (4 h) (Gent and Lindley, 7 % low below S = 0.5).
    """

    name = "plate_friction"
    stage = "pad"
    parameters = (Parameter("friction", "1", 0.0, 0.0, 2.0, 0.1),)
    signature = "extra stiffening that grows as the puck flattens; more on flat pucks"
    reference = "Siebel (1923), slab method; Gent and Lindley, Proc. Inst. Mech. Eng. 173 (1959) 111"

    def unavailable(self, presses: Presses, shape: str) -> str:
        return "" if shape == "cylinder" else "for pucks between plates only"

    def law(self, presses: Presses, law: UnitForce, values: Values) -> UnitForce:
        root = root_law(law)

        def rubbed(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            stretch = 1.0 - np.clip(depth_mm / thickness_mm, 0.0, 0.95)
            flatness = root.diameter_mm / thickness_mm * stretch**-1.5
            slip = 1.0 + values["friction"] * flatness / 3.0
            return law(depth_mm, thickness_mm) * np.minimum(slip, 1.0 + 2.0 * (flatness / 4.0) ** 2)

        rubbed.__wrapped__ = law
        return rubbed
