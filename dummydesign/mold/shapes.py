"""Solids of pads by shape: the one place that knows what a shape looks like. CadQuery is imported inside.

A shape's solid stands in the pad's frame: its tested face points to -z and touches z = 0, its free face
is the plane z = thickness. Mould, master, checks and sheets follow from the solid alone.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dummydesign.errors import unknown_name
from dummydesign.mold.outline import Outline
from dummydesign.mold.spec import PadGeometry


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
    import cadquery as cq

    outline = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    solid = drafted_prism(outline, pad.thickness_mm, pad.draft_deg)
    if pad.edge_radius_mm > 0:
        solid = cq.Workplane(obj=solid).faces("<Z").edges().fillet(pad.edge_radius_mm).val()
    return single_solid(solid)


# A puck is a slab whose corners meet: preset.py gives it radius = diameter / 2, no draft, sharp edges.
SHAPES: dict[str, Callable[[PadGeometry], Any]] = {"slab": slab, "puck": slab}


def pad_solid(pad: PadGeometry) -> Any:
    """Make the solid of a pad.

    Raises
    ------
    InputError
        When the shape is not known.
    """
    if pad.kind not in SHAPES:
        raise unknown_name("shape", pad.kind, SHAPES)
    return SHAPES[pad.kind](pad)


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
