"""All pads are thicker or thinner than stated."""

from __future__ import annotations

from dummydesign.loop.model.effect import Parameter, RigEffect, UnitForce, Values, wrap


class ThicknessError(RigEffect):
    """True thickness = stated + error, the same for all pads (a mould that is off, a lost bottom film).

    Relative stiffness changes by about -1.4 dh/h on 5 mm and -0.7 dh/h on 15 mm.
    """

    name = "thickness_error"
    parameters = (Parameter("thickness_error_mm", "mm", 0.0, -2.0, 2.0, 0.1),)
    signature = "scale, mostly the thin pad; grows with depth as the strain does"
    cause = "mould that is off, an overfilled pour, or a bottom film that was left on"
    remedy = "measure every pad with a height gauge at three places and give thickness_mm as measured"
    reference = "finite-layer stiffness of the pad model"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        error = values["thickness_error_mm"]
        return wrap(law, lambda depth_mm, thickness_mm: law(depth_mm, thickness_mm + error))
