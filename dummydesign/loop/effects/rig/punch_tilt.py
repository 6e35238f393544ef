"""The face of the punch is not parallel to the surface."""

from __future__ import annotations

import numpy as np

from dummydesign.loop.model.effect import Parameter, RigEffect, UnitForce, Values, root_law, wrap
from dummydesign.pad.tables.square import SIDE_OVER_RADIUS


class PunchTilt(RigEffect):
    """The punch leans by an angle about one axis of its face; its centre stays at the displacement.

    Strips across the face press at depth x + u tan(angle) and carry the law's force at their own depth
    (independent strips). One edge touches early: a quadratic toe as wide as the gap, then a force that is
    larger by half the curvature of the law. Sign of the angle cannot be seen.
    """

    name = "punch_tilt"
    shapes = ("slab", "shaped")
    needs = ("flat_faces",)
    parameters = (Parameter("tilt_deg", "deg", 0.0, 0.0, 8.0, 1.0, starts=(2.0,)),)
    signature = "rounded toe of fixed width in mm, largest share at small depth"
    cause = "punch or base plate that is not level"
    remedy = (
        "level the punch with a feeler gauge or marking paper, and turn the pad by 90 degrees to see the force change"
    )
    reference = "Kauzlarich, J. Mater. Sci. Lett. 11 (1992); strip (Winkler) estimate"

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        node, weight = np.polynomial.legendre.leggauss(9)
        half = SIDE_OVER_RADIUS * root_law(law).radius_mm
        lever = half * np.tan(np.deg2rad(values["tilt_deg"])) * node
        strips = [(u, 0.5 * w) for u, w in zip(lever, weight)]
        return wrap(law, lambda depth_mm, h_mm: np.asarray(sum(w * law(depth_mm + u, h_mm) for u, w in strips)))
