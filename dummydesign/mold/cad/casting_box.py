"""The box a silicone part is cast in, rigid master (complement of the part) and lift-off frame; the lid's too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.solids import cylinders, drafted_prism, rough_bounds, single_solid
from dummydesign.mold.model.layout import (
    BACKER_PLAY_MM,
    Funnel,
    Layout,
    Outline,
    PlanPoint,
    layout,
    recess_outline,
    sheet_outline,
)
from dummydesign.mold.model.spec import MouldSpec

VOLUME_EPS_MM3 = 1e-3


def to_casting(solid: Any, plan: Layout, turned: bool) -> Any:
    """Bring a silicone part into its casting frame: parting face on z = 0, silicone above, scaled.

    The pivot is the same for everything that is brought over: the middle of the parting face, the mould's land.
    """
    moved = solid.translate(cq.Vector(0, 0, -plan.land_mm))
    if turned:
        moved = moved.rotate(cq.Vector(), cq.Vector(1, 0, 0), 180)
    return moved.scale(plan.silicone_scale)


def casting_box(spec: MouldSpec, part: Any, hull: Any, turned: bool, sockets: tuple[Any, ...] = ()) -> tuple[Any, Any]:
    """Make master and frame for a silicone part."""
    plan = layout(spec)
    box, grow = spec.box, plan.silicone_scale
    cast_part, cast_hull, plug = (to_casting(one, plan, turned) for one in (part, hull, hull.cut(part)))
    base = drafted_prism(plan.flange, box.base_mm, 0.0, -box.base_mm)
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
    places = [*flange.corners(inset), PlanPoint(x, 0), PlanPoint(-x, 0), PlanPoint(0, y), PlanPoint(0, -y)]
    return cylinders(places, spec.box.bolt_hole_mm / 2, height_mm, z_mm)


def let_in_sheet(
    made: Parts,
    part: Any,
    places: Sequence[tuple[float, float, float]],
    top_mm: float,
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Any:
    """Add the sheet that is the tested face, flush with ``top_mm``; return the part with a pocket for each."""
    box = made.spec.box
    deep = box.face_sheet_mm + box.sheet_bond_mm
    pocket = drafted_prism(recess_outline(made.spec, made.plan), deep, 0.0, top_mm - deep)
    sheet = drafted_prism(sheet_outline(made.spec, made.plan), box.face_sheet_mm, 0.0, top_mm - box.face_sheet_mm)
    made.tools["face_recess"] = [pocket.translate(at) for at in places]
    made.add("face_sheet", sheet.translate(places[0]), "glass", offset_mm)
    return single_solid(part.cut(*made.tools["face_recess"]))


def mould_tools(made: Parts) -> list[Any]:
    """Sockets for the keys and the gutter, as cut into the mould's land."""
    plan, c = made.plan, made.spec.lid
    keys = [ball(point, plan.land_mm, c.key_radius_mm + c.key_clearance_mm) for point in plan.keys]
    made.tools |= {"keys": keys, "gutter": [_gutter(made.spec, plan)]}
    return [*keys, *made.tools["gutter"]]


def _gutter(spec: MouldSpec, plan: Layout) -> Any:
    """Groove of half-round section around the cavity that takes what is squeezed out of the parting gap."""
    line = plan.fill_outline.grown(spec.lid.gutter_distance_mm)
    path = _wire(line, plan.land_mm)
    start = cq.Plane(origin=(0, -line.width_mm / 2, plan.land_mm), xDir=(0, 1, 0), normal=(1, 0, 0))
    return cq.Workplane(start).circle(spec.lid.gutter_radius_mm).sweep(cq.Workplane(obj=path)).val()


def add_lid(made: Parts, shift_mm: float) -> None:
    """Build lid, backer, loose pins and the lid's casting box into ``made``."""
    spec, plan, c = made.spec, made.plan, made.spec.lid
    land, row = plan.land_mm, plan.flange.width_mm + 40.0
    # Cast parting face down, so it narrows away from the parting plane and the frame lifts off.
    hull = drafted_prism(plan.top, c.lid_mm, -spec.body.outer_draft_deg, land)
    full = single_solid(hull.fuse(*[ball(point, land, c.key_radius_mm) for point in plan.keys]))
    funnels = [_funnel(one, c.lid_mm, land) for one in plan.funnels]
    made.tools["sprue"], made.tools["vents"] = funnels[:1], funnels[1:]
    made.tools["lid_hull"] = [hull]
    made.add("lid", single_solid(full.cut(*funnels)), "silicone")
    made.add("backer", _backer(spec, plan), "rigid")
    # Blind holes in the base plate for the spigots of the pins.
    sockets = made.tools["sockets"] = [
        tool
        for one in plan.funnels
        for tool in cylinders(
            [PlanPoint(one.x_mm * plan.silicone_scale, one.y_mm * plan.silicone_scale)],
            _spigot_radius_mm(spec, one) + spec.machines.gap_mm,
            c.pin_spigot_mm,
            -c.pin_spigot_mm,
        )
    ]
    master, frame = casting_box(spec, full, hull, False, tuple(sockets))
    made.add("lid_master", master, "rigid", (shift_mm, row, 0))
    made.add("lid_frame", frame, "rigid", (shift_mm, row, 0))
    made.add("sprue_pin", _pin(spec, plan.funnels[0]), "rigid", (0.0, row, 0))
    made.add("vent_pin", _pin(spec, plan.funnels[1]), "rigid", (30.0, row, 0))


def ball(point: PlanPoint, z_mm: float, radius_mm: float) -> Any:
    """Make a ball about a place at a height. [mm]"""
    return cq.Workplane(origin=(point.x_mm, point.y_mm, z_mm)).sphere(radius_mm).val()


def _wire(outline: Outline, z_mm: float) -> Any:
    """Outline as a closed wire that starts halfway along the front side."""
    x, y, r = outline.length_mm / 2, outline.width_mm / 2, outline.radius_mm
    path = cq.Workplane(origin=(0, 0, z_mm)).moveTo(0, -y).lineTo(x - r, -y).radiusArc((x, -y + r), -r)
    path = path.lineTo(x, y - r).radiusArc((x - r, y), -r).lineTo(-x + r, y).radiusArc((-x, y - r), -r)
    return path.lineTo(-x, -y + r).radiusArc((-x + r, -y), -r).close().val()


def _funnel(funnel: Funnel, high_mm: float, z_mm: float) -> Any:
    """Cone through the lid, half a millimetre longer at both ends."""
    slope, more = (funnel.large_mm - funnel.small_mm) / 2 / high_mm, 0.5
    return cq.Solid.makeCone(
        funnel.small_mm / 2 - slope * more,
        funnel.large_mm / 2 + slope * more,
        high_mm + more + more,
        cq.Vector(funnel.x_mm, funnel.y_mm, z_mm - more),
    )


def _backer(spec: MouldSpec, plan: Layout) -> Any:
    """Stiff plate on the lid: a lid of soft silicone alone is not flat; holes let sprue and vents through."""
    c = spec.lid
    low = plan.land_mm + c.lid_mm
    plate = drafted_prism(plan.top.grown(-1.0), c.backer_mm, 0.0, low)
    holes = [cylinders([one], (one.large_mm + BACKER_PLAY_MM) / 2, c.backer_mm + 2, low - 1)[0] for one in plan.funnels]
    return single_solid(plate.cut(*holes))


def _spigot_radius_mm(spec: MouldSpec, funnel: Funnel) -> float:
    """Radius of a pin's spigot: with its gap less than the pin's foot, so that the foot seats on the base."""
    return max(0.8, funnel.small_mm / 2 - 0.3 - spec.machines.gap_mm)


def _pin(spec: MouldSpec, funnel: Funnel) -> Any:
    """Loose pin that keeps a funnel open while the lid is cast: spigot, cone, handle above the silicone."""
    c, grow, middle = spec.lid, layout(spec).silicone_scale, [PlanPoint(0.0, 0.0)]
    high = c.lid_mm * grow
    cone = cq.Solid.makeCone(funnel.small_mm * grow / 2, funnel.large_mm * grow / 2, high)
    spigot = cylinders(middle, _spigot_radius_mm(spec, funnel), c.pin_spigot_mm - 0.5 + 0.01, -c.pin_spigot_mm + 0.5)
    handle = cylinders(middle, funnel.large_mm * grow / 2, c.pin_handle_mm, high)
    return single_solid(cone.fuse(*spigot, *handle))
