"""What each shape adds to the drafted block of a pad: one module a shape with ``SOLIDS``, found by the shape's name.

Shapes whose tested face is flat and that have no bone need no module.
"""

from __future__ import annotations

from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import part_of
from dummydesign.mold.model.spec import PadGeometry

ROLE = "SOLIDS"


class FlatSolids:
    """Exact solids of one kind of shape, in the pad's frame: tip on z = 0, free face at z = thickness. Here none."""

    def tops(self, pad: PadGeometry) -> list[Any]:
        """What stands on the flat of the tested face, up to ``pad.face_height_mm``; fused with the block."""
        return []

    def bone(self, pad: PadGeometry) -> Any:
        """The rigid bone under the free face, cut out of the gel; called when the shape has one."""
        return None


def solids_of(shape: PadShape) -> FlatSolids:
    """The solids of a shape."""
    solids: FlatSolids | None = part_of(shape.name, ROLE, __name__)
    if solids is not None:
        return solids
    if shape.relief_mm or shape.bone_height_mm:
        message = f"shape {shape.name} has no solids: the mould cannot be built; predict can press it"
        raise InputError(message, "unsupported", "shape", shape.name)
    return FlatSolids()
