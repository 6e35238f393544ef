"""The box a silicone part is cast in: rigid master (complement of the part) and lift-off frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.solids import cylinders, drafted_prism, rough_bounds, single_solid
from dummydesign.mold.model.layout import Point, layout, recess_outline, sheet_outline
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec

VOLUME_EPS_MM3 = 1e-3


def to_casting(solid: Any, parting_mm: float, turned: bool, scale: float) -> Any:
    """Bring a silicone part into its casting frame: parting face on z = 0, silicone above, scaled.

    The pivot is the same for everything that is brought over: the middle of the parting face.
    """
    moved = solid.translate(cq.Vector(0, 0, -parting_mm))
    if turned:
        moved = moved.rotate(cq.Vector(), cq.Vector(1, 0, 0), 180)
    return moved.scale(scale)


def casting_box(
    spec: MouldSpec, part: Any, hull: Any, parting_mm: float, turned: bool, sockets: tuple[Any, ...] = ()
) -> tuple[Any, Any]:
    """Make master and frame for a silicone part."""
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
    narrower = inner.grown(-high * math.tan(math.radians(spec.body.outer_draft_deg)))
    rim = drafted_prism(narrower.grown(box.rim_step_mm), box.rim_mm + 1.0, 0.0, high)
    frame = walls.fuse(flange).cut(cast_hull, rim, *holes)
    return single_solid(master), single_solid(cq.Shape.cast(frame.wrapped))


def bolt_holes(spec: MouldSpec, flange: Outline, z_mm: float, height_mm: float) -> list[Any]:
    """Eight bolts through base and flange: corners and middles of the sides."""
    inset = spec.box.flange_mm / 2
    x, y = flange.length_mm / 2 - inset, flange.width_mm / 2 - inset
    # On a rounded corner the flange's middle line runs at 45 degrees inside the square one.
    cut = (1 - math.sqrt(0.5)) * (flange.radius_mm - inset)
    corners = [Point(sx * (x - cut), sy * (y - cut)) for sx in (1, -1) for sy in (1, -1)]
    places = [*corners, Point(x, 0), Point(-x, 0), Point(0, y), Point(0, -y)]
    return cylinders(places, spec.box.bolt_hole_mm / 2, height_mm, z_mm)


def let_in_sheet(
    made: Parts, part: Any, places: Sequence[tuple[float, float, float]], top_mm: float,
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Any:  # fmt: skip
    """Add the sheet that is the tested face, flush with ``top_mm``; return the part with a pocket for each."""
    box = made.spec.box
    deep = box.face_sheet_mm + box.sheet_bond_mm
    pocket = drafted_prism(recess_outline(made.spec, made.plan), deep, 0.0, top_mm - deep)
    sheet = drafted_prism(sheet_outline(made.spec, made.plan), box.face_sheet_mm, 0.0, top_mm - box.face_sheet_mm)
    made.tools["face_recess"] = [pocket.translate(place) for place in places]
    made.add("face_sheet", sheet.translate(places[0]), "glass", offset_mm)
    return single_solid(part.cut(*made.tools["face_recess"]))
