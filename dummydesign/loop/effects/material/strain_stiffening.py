"""The material stiffens (or softens) with strain beyond the neo-Hookean law."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.model.effect import PadEffect, Parameter, UnitForce, Values, wrap

AT_SHARE = 0.3
"""Depth over thickness at which the coefficient means the same whatever the exponent."""


class StrainStiffening(PadEffect):
    """Elastic force x (1 + coefficient 0.09 (d/h / 0.3)^exponent): with 2 the first term of a Yeoh law under a punch.

    A Yeoh c2/mu of 0.05 gives a factor 1.23 on 5 mm and 1.11 on 15 mm at d/h 0.3, so one coefficient for
    all pads is a first approximation. Networks of other laws stiffen earlier or later: the exponent is a form.
    """

    name = "strain_stiffening"
    by_convention = True
    parameters = (
        Parameter("coefficient", "1", 0.0, -1.0, 20.0, 0.3),
        Parameter("exponent", "1", 2.0, 1.0, 6.0, 0.5, spread=2.0),
    )
    signature = "factor that grows with depth over thickness, same at all speeds and times"
    cause = "network that is stretched towards its limit"
    remedy = "press a thin pad to 0.4 of its thickness, or compress a puck of this batch"
    reference = "Yeoh, Rubber Chem. Technol. 63 (1990) 792"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        at_depth, exponent = values["coefficient"] * AT_SHARE**2, values["exponent"]

        def stiffer(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            share = np.maximum(depth_mm, 0.0) / thickness_mm / AT_SHARE
            return law(depth_mm, thickness_mm) * (1.0 + at_depth * share**exponent)

        return wrap(law, stiffer)
