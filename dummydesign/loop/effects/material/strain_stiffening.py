"""The material stiffens (or softens) with strain beyond the neo-Hookean law."""

from __future__ import annotations

from numpy.typing import NDArray

from dummydesign.loop.model.base_law import UnitForce, wrap
from dummydesign.loop.model.effect import Effect, Parameter, Values


class StrainStiffening(Effect):
    """Elastic force x (1 + coefficient (d/h)^2): the first term of a Yeoh law under a punch.

    A Yeoh c2/mu of 0.05 gives a factor 1.23 on 5 mm and 1.11 on 15 mm at d/h 0.3, so one coefficient for
    all pads is a first approximation.
    """

    name = "strain_stiffening"
    hook = "pad"
    belongs_to = "pad"
    parameters = (Parameter("coefficient", "1", 0.0, -1.0, 20.0, 0.3),)
    signature = "factor that grows with depth over thickness, same at all speeds and times"
    cause = "network that is stretched towards its limit"
    remedy = "press a thin pad to 0.4 of its thickness, or compress a puck of this batch"
    reference = "Yeoh, Rubber Chem. Technol. 63 (1990) 792"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        coefficient = values["coefficient"]

        def stiffer(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            return law(depth_mm, thickness_mm) * (1.0 + coefficient * (depth_mm / thickness_mm) ** 2)

        return wrap(law, stiffer)
