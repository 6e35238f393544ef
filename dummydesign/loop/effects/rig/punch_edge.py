"""The edge of the punch is rounded and was declared sharp."""

from __future__ import annotations

from dummydesign.loop.model.effect import Parameter, RigEffect, UnitForce, Values, root_law, wrap


class PunchEdge(RigEffect):
    """F = F_sharp x g(d/h, a/h, r/a), g from the response tables of filleted punches.

    The contact starts on the flat part alone and rolls on to the fillet: 0.3 mm on a punch of 14 x 14 mm takes 5 to 7 %
    off the first touch and 0 to 2 % at d/h 0.4.
    """

    name = "punch_edge"
    needs = ("sharp_edge",)
    shapes = ("slab",)
    parameters = (Parameter("edge_radius_mm", "mm", 0.0, 0.0, 3.0, 0.2),)
    signature = "weak at first touch, right at depth; most on the thin pad"
    cause = "a chamfer, a fillet or a worn edge of the punch"
    remedy = "measure the edge and give edge_radius_mm under [punch]"
    reference = "finite elements of the pad model with a filleted punch (docs/pad.md, a rounded edge)"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        root, radius = root_law(law), values["edge_radius_mm"]
        return wrap(law, lambda *at: law(*at) * root.edge_factor(radius, *at))
