"""The pad is not quite incompressible (bubbles, open cells)."""

from __future__ import annotations

from dummydesign.loop.model.effect import PadEffect, Parameter, UnitForce, Values, root_law, wrap


class Compressibility(PadEffect):
    """Poisson's ratio below 1/2 at the same Young's modulus: F / (1 + (1 - 2 nu) c(a/h, d/h)).

    The bulk gives way in series with the shear; c comes from finite elements (tabulated for slabs) and grows from 1.2
    on 20 mm to 7.7 on 5 mm, so the thin pad softens most.
    """

    name = "compressibility"
    needs = ("bulk_that_gives",)
    parameters = (Parameter("poisson_ratio", "1", 0.5, 0.3, 0.5, -0.005),)
    signature = "scale, mostly the thin pad"
    cause = "air bubbles, or a foam"
    remedy = "degas the resin and weigh a pad against its volume"
    reference = "finite elements of the pad model; Hayes et al., J. Biomech. 5 (1972) 541 at small depth"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        coefficient = root_law(law).compressibility_coefficient
        excess = 1.0 - 2.0 * values["poisson_ratio"]
        return wrap(law, lambda *at: law(*at) / (1.0 + excess * coefficient(*at)))
