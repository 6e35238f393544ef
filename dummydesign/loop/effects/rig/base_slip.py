"""The pad is not held by its base."""

from __future__ import annotations

from dummydesign.loop.model.effect import Parameter, RigEffect, UnitForce, Values, root_law, wrap


class BaseSlip(RigEffect):
    """A share of the base slides: F = (1 - w) F_bonded + w F_sliding, both from finite elements.

    One factor per pad once the modulus is free: 0.45 to 0.42 of the glued force on 5 mm, 0.81 to 0.78 on 20 mm.
    """

    name = "base_slip"
    needs = ("base_that_can_slip",)
    parameters = (Parameter("slip_fraction", "1", 0.0, 0.0, 1.0, 0.1, starts=(0.5,)),)
    signature = "scale, mostly the thin pad, growing slowly with depth"
    cause = "oil, powder or a dry film between pad and plate"
    remedy = "glue the pad or pour it onto its plate; press again with the base declared as it lies"
    reference = "layer on a slipping base: Hayes et al., J. Biomech. 5 (1972) 541; response tables of the pad model"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        slip, sliding = values["slip_fraction"], root_law(law).sliding()
        return wrap(law, lambda *at: (1.0 - slip) * law(*at) + slip * sliding(*at))
