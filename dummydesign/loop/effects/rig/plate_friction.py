"""The plates hold the faces of a puck."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.effect import Parameter, RigEffect, SetupLaw, UnitForce, Values, root_law, wrap
from dummydesign.pad.tables.puck import PuckTable, grip, shape_range, table_for


class PlateFriction(RigEffect):
    """Coulomb friction between the plates and the faces of a puck: F x B(friction, D / h, d / h).

    B is the stiffening that finite elements give for this friction on a neo-Hookean puck of this proportion,
    tabulated to the compression at which the bonded puck folds; beyond it the last value is held.
    """

    name = "plate_friction"
    by_convention = lubricated = True
    shapes = ("cylinder",)
    needs = ("frictionless_plates",)
    parameters = (Parameter("friction", "1", 0.0, 0.0, 2.0, 0.3),)
    signature = "extra stiffening that grows as the puck flattens; more on flat pucks"
    cause = "plates that hold the faces of the puck"
    remedy = 'lubricate the plates with silicone oil or water, or glue the faces and declare contact = "bonded"'
    reference = "finite elements of the pad model; Gent and Lindley, Proc. Inst. Mech. Eng. 173 (1959) 111"

    def undefined(self, presses: Presses, law: SetupLaw) -> str:
        reason = super().undefined(presses, law)
        if reason:
            return reason
        for thickness, depth in zip(presses.thickness_mm, presses.depth_mm):
            try:
                solved = table_for(2.0 * root_law(law).radius_mm, float(thickness)).compression[-1]
            except InputError as outside:
                return str(outside)
            if depth > solved * thickness:
                pressed = f"a {thickness:g} mm puck is pressed by {100.0 * depth / thickness:.0f} %"
                return f"{pressed}, friction is solved to {100.0 * solved:.0f} %: press less deep, or a taller puck"
        return ""

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        diameter, held = 2.0 * root_law(law).radius_mm, float(grip(values["friction"]))

        def rubbed(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            share = np.clip(depth_mm / thickness_mm, 0.0, 0.95)
            rows = np.broadcast_to(np.asarray(thickness_mm, float), (len(share), 1))[:, 0]
            factor = [_table(diameter, float(h)).factor(NEO_HOOKEAN, held, row) for h, row in zip(rows, share)]
            return law(depth_mm, thickness_mm) * np.stack(factor)

        return wrap(law, rubbed)


NEO_HOOKEAN = 2.0  # exponent of the one-term Ogden law that is neo-Hookean


@lru_cache(maxsize=256)
def _table(diameter_mm: float, thickness_mm: float) -> PuckTable:
    """Table of a puck; of the nearest proportion where a thickness that is being fitted leaves those solved."""
    low, high = shape_range()
    return table_for(diameter_mm, diameter_mm / float(np.clip(diameter_mm / thickness_mm, low, high)))
