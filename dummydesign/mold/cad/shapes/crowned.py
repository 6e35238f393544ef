"""A conic crown, or a ridge whose ends go on in the drafted walls. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.conic_solids import cap_solid, ridge_solid
from dummydesign.mold.cad.shapes import FlatSolids
from dummydesign.mold.model.spec import PadGeometry


class CrownedSolids(FlatSolids):
    """One cap or ridge on the block."""

    def tops(self, pad: PadGeometry) -> list[Any]:
        """The crown."""
        shape = pad.shape
        return [ridge_solid(shape.conic, *shape.ends(pad)) if shape.along else cap_solid(shape.conic)]


SOLIDS = CrownedSolids()
