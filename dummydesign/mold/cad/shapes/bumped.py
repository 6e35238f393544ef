"""Spherical caps, joined with the block in one boolean. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.mold.cad.shapes import FlatSolids
from dummydesign.mold.cad.solids import cap_solid
from dummydesign.mold.model.spec import PadGeometry


class BumpedSolids(FlatSolids):
    """A lattice of caps on the block."""

    def tops(self, pad: PadGeometry) -> list[Any]:
        """All caps; each height is made once."""
        shape, high = pad.shape, pad.face_height_mm
        assert isinstance(shape, Bumped)
        made: dict[float, Any] = {}
        caps = []
        for x, y, height in shape.caps_mm():
            if height not in made:
                made[height] = cap_solid(shape.cap(height))
            caps.append(made[height].translate((x, y, high - height)))
        return caps


SOLIDS = BumpedSolids()
