"""A conic crown, or a ridge whose ends go on in the drafted walls. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.mold.cad.shapes import FlatSolids
from dummydesign.mold.cad.solids import cap_solid, ridge_solid
from dummydesign.mold.model.spec import PadGeometry


class CrownedSolids(FlatSolids):
    """One ridge, or a cap at each site, on the block."""

    def tops(self, pad: PadGeometry) -> list[Any]:
        """The crowns; their solid is made once."""
        shape = pad.shape
        assert isinstance(shape, Crowned)
        if shape.along:
            return [ridge_solid(shape, *shape.ends(pad))]
        cap = cap_solid(shape)
        return [cap.translate((x, y, 0.0)) if x or y else cap for x, y in shape.places_mm]


SOLIDS = CrownedSolids()
