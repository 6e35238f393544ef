"""A conic dome, or a bar, under the free face. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.geometry.shapes.boned import Boned
from dummydesign.mold.cad.shapes import FlatSolids
from dummydesign.mold.cad.solids import cap_solid, ridge_solid
from dummydesign.mold.model.spec import PadGeometry


class BonedSolids(FlatSolids):
    """The block with a dome or a bar in it."""

    def bone(self, pad: PadGeometry) -> Any:
        """Dome or bar, its tip towards the tested face."""
        shape = pad.shape
        assert isinstance(shape, Boned)
        low = pad.thickness_mm - shape.height_mm
        return ridge_solid(shape, *shape.ends(pad), low) if shape.along else cap_solid(shape, z_mm=low)


SOLIDS = BonedSolids()
