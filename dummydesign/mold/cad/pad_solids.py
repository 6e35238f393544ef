"""Solids of pads by shape: the one place that knows what a shape looks like. CadQuery is imported inside.

A shape's solids stand in the pad's frame: its tested face points to -z, its highest point touches z = 0, and its
free face is the plane z = thickness. The cavity is cut with the pad and its bone together.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dummydesign.core.errors import unknown_name
from dummydesign.geometry.shapes import Boned, Conic, sphere_foot_mm
from dummydesign.mold.cad.conic_solids import cap_solid, ridge_solid
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import PadGeometry
from dummydesign.mold.model.volumes import ridge_ends


def drafted_prism(outline: Outline, height_mm: float, draft_deg: float, z_mm: float = 0.0) -> Any:
    """Make the solid over ``outline`` at ``z_mm`` whose walls move outwards by z tan(draft)."""
    import cadquery as cq

    if outline.is_circle:
        flat = cq.Sketch().circle(outline.radius_mm)
    else:
        flat = cq.Sketch().rect(outline.length_mm, outline.width_mm)
        if outline.radius_mm > 0:
            flat = flat.vertices().fillet(outline.radius_mm)
    plane = cq.Workplane("XY", origin=(0, 0, z_mm)).placeSketch(flat)
    # CadQuery's taper narrows when positive; ours widens.
    return plane.extrude(height_mm, taper=-draft_deg).val()


def slab(pad: PadGeometry) -> Any:
    """A drafted rectangular slab with rounded corners and a rounded edge around its tested face."""
    return _rounded_prism(pad, 0.0)


def _rounded_prism(pad: PadGeometry, low_mm: float) -> Any:
    """The slab from a height up to the free face."""
    import cadquery as cq

    outline = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    solid = drafted_prism(outline, pad.thickness_mm - low_mm, pad.draft_deg, low_mm)
    if pad.edge_radius_mm > 0:
        solid = cq.Workplane(obj=solid).faces("<Z").edges().fillet(pad.edge_radius_mm).val()
    return single_solid(solid)


def crowned(pad: PadGeometry) -> Any:
    """A slab with a conic crown on its tested face, or with a ridge whose ends go on in the drafted walls."""
    conic = pad.shape.conic
    top = ridge_solid(conic, *ridge_ends(pad)) if pad.shape.ridge else cap_solid(conic)
    return single_solid(_rounded_prism(pad, pad.face_height_mm).fuse(top))


def bumped(pad: PadGeometry) -> Any:
    """A slab with spherical caps on its tested face, joined in one boolean."""
    shape, high = pad.shape, pad.face_height_mm
    made: dict[float, Any] = {}
    caps = []
    for x, y, height in shape.caps_mm():
        if height not in made:
            made[height] = cap_solid(Conic(shape.radius_mm, height, sphere_foot_mm(shape.radius_mm, height)))
        caps.append(made[height].translate((x, y, high - height)))
    return single_solid(_rounded_prism(pad, high).fuse(*caps))


# A puck is a slab whose corners meet: preset.py gives it radius = diameter / 2, no draft, sharp edges.
SHAPES: dict[str, Callable[[PadGeometry], Any]] = {
    "slab": slab, "puck": slab, "crowned": crowned, "bumped": bumped, "layered": slab, "boned": slab,
}  # fmt: skip


def cavity_solid(pad: PadGeometry) -> Any:
    """Make what fills the mould: the pad with its bone.

    Raises
    ------
    InputError
        When the shape is not known.
    """
    if pad.kind not in SHAPES:
        raise unknown_name("shape", pad.kind, SHAPES)
    return SHAPES[pad.kind](pad)


def bone_solid(pad: PadGeometry) -> Any:
    """Make the rigid bone below the free face, or None for a shape without one."""
    shape = pad.shape
    if not isinstance(shape, Boned):
        return None
    low = pad.thickness_mm - shape.height_mm
    if shape.bar:
        return ridge_solid(shape.conic, *ridge_ends(pad), low)
    return cap_solid(shape.conic, z_mm=low)


def pad_solid(pad: PadGeometry) -> Any:
    """Make the gel of a pad: the cavity's solid less the bone.

    Raises
    ------
    InputError
        When the shape is not known.
    """
    whole, bone = cavity_solid(pad), bone_solid(pad)
    return whole if bone is None else single_solid(whole.cut(bone))


def single_solid(shape: Any) -> Any:
    """Unwrap a boolean's compound when it holds exactly one solid, else return it as it is."""
    solids = shape.Solids()
    return solids[0] if len(solids) == 1 else shape


def rough_bounds(shape: Any) -> tuple[float, float, float, float, float, float]:
    """Bounds (x, y, z low, x, y, z high) that surely hold the shape, a hundred times faster than tight ones."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape.wrapped, box, False)
    return box.Get()
