"""The box a silicone part is cast in: rigid master (complement of the part) and lift-off frame."""

from __future__ import annotations

import math
from typing import Any

from dummydesign.mold.cad.prisms import drafted_prism, rough_bounds, single_solid
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec

VOLUME_EPS_MM3 = 1e-3


def to_casting(solid: Any, parting_mm: float, turned: bool, scale: float) -> Any:
    """Bring a silicone part into its casting frame: parting face on z = 0, silicone above, scaled.

    The pivot is the same for everything that is brought over: the middle of the parting face.

    Parameters
    ----------
    solid : cadquery.Shape
        Part in the mould's frame.
    parting_mm : float
        Height of the parting face in the mould's frame. [mm]
    turned : bool
        Turned over about the x axis: a part that is used face up is cast face down.
    scale : float
        Casting size over finished size, for the shrinkage of the silicone; at least 1.

    Returns
    -------
    cadquery.Shape
    """
    import cadquery as cq

    moved = solid.translate(cq.Vector(0, 0, -parting_mm))
    if turned:
        moved = moved.rotate(cq.Vector(), cq.Vector(1, 0, 0), 180)
    return moved.scale(scale)


def casting_box(
    spec: MouldSpec, part: Any, hull: Any, parting_mm: float, turned: bool, sockets: tuple[Any, ...] = ()
) -> tuple[Any, Any]:
    """Make master and frame for a silicone part.

    Parameters
    ----------
    spec : MouldSpec
    part : Solid
        The silicone part in the mould's frame, holes that loose pins make filled.
    hull : Solid
        The drafted block the part was cut from; what is in it but not in the part becomes the plug.
    parting_mm : float
        Height of the parting face in the mould's frame. [mm]
    turned : bool
        Cast upside down.
    sockets : tuple of Solid
        Further holes in the base plate, in the casting frame.

    Returns
    -------
    master, frame : Solid
        In the casting frame (base plate below z = 0).
    """
    import cadquery as cq

    plan = layout(spec)
    box, grow = spec.box, plan.silicone_scale
    cast_part = to_casting(part, parting_mm, turned, grow)
    cast_hull = to_casting(hull, parting_mm, turned, grow)
    base = drafted_prism(plan.flange, box.base_mm, 0.0, -box.base_mm)
    plug = to_casting(hull.cut(part), parting_mm, turned, grow)
    # Keys of a lid reach into the base plate; a mould's parting face only touches it.
    master = base.cut(cast_part) if rough_bounds(cast_part)[2] < -0.1 else base
    if plug.Volume() > VOLUME_EPS_MM3:
        master = master.fuse(*plug.Solids())
    high = cast_hull.BoundingBox().zmax
    holes = bolt_holes(spec, plan.flange, -box.base_mm - 1.0, box.base_mm + box.flange_thickness_mm + 2.0)
    master = master.cut(*holes, *sockets)
    inner = plan.top.scaled(grow)
    walls = drafted_prism(inner.grown(box.frame_wall_mm), high + box.rim_mm, 0.0)
    flange = drafted_prism(plan.flange, min(box.flange_thickness_mm, high + box.rim_mm), 0.0)
    # The step at the fill height is the mark to pour the silicone to.
    rim = drafted_prism(
        _narrow(inner, high * math.tan(math.radians(spec.body.outer_draft_deg))).grown(box.rim_step_mm),
        box.rim_mm + 1.0,
        0.0,
        high,
    )
    frame = walls.fuse(flange).cut(cast_hull, rim, *holes)
    return single_solid(master), single_solid(cq.Shape.cast(frame.wrapped))


def _narrow(outline: Outline, by_mm: float) -> Outline:
    return outline.grown(-by_mm)


def bolt_holes(spec: MouldSpec, flange: Outline, z_mm: float, height_mm: float) -> list[Any]:
    """Eight bolts through base and flange: corners and middles of the sides.

    Parameters
    ----------
    spec : MouldSpec
        Diameter, and width of the flange.
    flange : Outline
        Its outer edge.
    z_mm, height_mm : float
        Lower end and length of the tools. [mm]
    """
    import cadquery as cq

    inset = spec.box.flange_mm / 2
    x, y = flange.length_mm / 2 - inset, flange.width_mm / 2 - inset
    # On a rounded corner the flange's middle line runs at 45 degrees inside the square one.
    cut = (1 - math.sqrt(0.5)) * (flange.radius_mm - inset)
    corners = [(sx * (x - cut), sy * (y - cut)) for sx in (1, -1) for sy in (1, -1)]
    places = [*corners, (x, 0), (-x, 0), (0, y), (0, -y)]
    radius = spec.box.bolt_hole_mm / 2
    return [cq.Solid.makeCylinder(radius, height_mm, cq.Vector(px, py, z_mm)) for px, py in places]
