"""The plates hold the faces of a puck."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.errors import NoAnswerError
from dummydesign.loop.effects.base import Effect, Parameter, Values
from dummydesign.loop.law import UnitForce, root_law
from dummydesign.pad.puck_table import PuckTable, grip, load_puck_table


class PlateFriction(Effect):
    """Coulomb friction between the plates and the faces of a puck.

    Pucks of the shape 50 x 30 mm: the stiffening that finite elements give for this friction. Other shapes:
    F x (1 + mu D / (3 h)) at the current diameter and height (slab method of upsetting), ending at the bonded
    puck, 1 + 2 S^2 with the current shape factor S = D / (4 h) (7 % low below S = 0.5).
    """

    name = "plate_friction"
    stage = "pad"
    belongs_to = "rig"
    shapes = ("cylinder",)
    parameters = (Parameter("friction", "1", 0.0, 0.0, 2.0, 0.1),)
    signature = "extra stiffening that grows as the puck flattens; more on flat pucks"
    reference = (
        "finite elements of the pad model; Siebel (1923), slab method; "
        "Gent and Lindley, Proc. Inst. Mech. Eng. 173 (1959) 111"
    )

    def law(self, law: UnitForce, values: Values) -> UnitForce:
        diameter, friction = root_law(law).diameter_mm, values["friction"]

        def rubbed(depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
            share = np.clip(depth_mm / thickness_mm, 0.0, 0.95)
            table = _table_for(diameter, thickness_mm)
            if table is not None:
                return law(depth_mm, thickness_mm) * table.factor(NEO_HOOKEAN, float(grip(friction)), share)
            flatness = diameter / thickness_mm * (1.0 - share) ** -1.5
            slip = 1.0 + friction * flatness / 3.0
            return law(depth_mm, thickness_mm) * np.minimum(slip, 1.0 + 2.0 * (flatness / 4.0) ** 2)

        rubbed.__wrapped__ = law
        return rubbed


NEO_HOOKEAN = 2.0
"""Exponent of the one-term Ogden law that is neo-Hookean."""


def _table_for(diameter_mm: float, thickness_mm: NDArray) -> PuckTable | None:
    """The table of finite elements when all pucks have its shape."""
    try:
        table = load_puck_table()
    except NoAnswerError:
        return None
    shape = 0.5 * diameter_mm / np.asarray(thickness_mm)
    return table if np.all(np.abs(shape / table.radius_over_height - 1.0) < 0.005) else None
