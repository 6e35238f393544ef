"""Solids of pads: a drafted block, what its shape adds on the tested face, and a rigid bone; needs CadQuery.

CadQuery is imported inside the functions.

The solids stand in the pad's frame: its tested face points to -z, its highest point touches z = 0, and its
free face is the plane z = thickness. The cavity is cut with the pad and its bone together.
"""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.cad.shapes import solids_of
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import PadGeometry


def block_solid(pad: PadGeometry, low_mm: float) -> Any:
    """Make the drafted slab from a height up to the free face, rounded at its corners and around its lower face."""
    import cadquery as cq

    outline = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    solid = drafted_prism(outline, pad.thickness_mm - low_mm, pad.draft_deg, low_mm)
    if pad.edge_radius_mm > 0:
        solid = cq.Workplane(obj=solid).faces("<Z").edges().fillet(pad.edge_radius_mm).val()
    return single_solid(solid)


def cavity_solid(pad: PadGeometry) -> Any:
    """Make what fills the mould: the pad with its bone.

    Raises
    ------
    InputError
        When the shape is not known, or the mould has no solids for it.
    """
    tops = solids_of(pad.shape).tops(pad)
    block = block_solid(pad, pad.face_height_mm)
    return single_solid(block.fuse(*tops)) if tops else block


def bone_solid(pad: PadGeometry, placed: Any = None) -> Any:
    """Make the rigid bone below the free face, or None for a shape without one; ``placed`` is one from a file."""
    if placed is not None:
        return placed
    return solids_of(pad.shape).bone(pad) if pad.shape.bone_height_mm else None


def pad_solid(pad: PadGeometry) -> Any:
    """Make the gel of a pad: the cavity's solid less the bone.

    Raises
    ------
    InputError
        When the shape is not known.
    """
    whole, bone = cavity_solid(pad), bone_solid(pad)
    return whole if bone is None else single_solid(whole.cut(bone))
