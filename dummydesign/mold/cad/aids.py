"""Rigid aids around the mould: strike-off plate, carrier tray, degassing collar. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import Layout
from dummydesign.mold.model.spec import MouldSpec

EAR_RADIUS_MM = 8.0
# Room around silicone that a printed ring is put over; its lower edge is the first layer.
COLLAR_GAP_MM = 0.3


def strike_off(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that rests on the land and dips through the freeboard to the fill plane, a film gap around it.

    Lowered hinged from one edge it drives the air and the excess out through the gap and leaves the free
    face flat at the pad's thickness.
    """
    aids = spec.aids
    dip = drafted_prism(
        plan.brim_outline.grown(-aids.plate_clearance_mm), spec.body.freeboard_mm, spec.pad.draft_deg, plan.depth_mm
    )
    plate = drafted_prism(plan.top.grown(-1.0), aids.plate_mm, 0.0, plan.land_mm)
    return single_solid(plate.fuse(*plan.at_places(dip)))


def tray(spec: MouldSpec, plan: Layout) -> Any:
    """Flat stiff carrier with a rim that leaves room for thermal growth and three ears for level screws."""
    import cadquery as cq

    aids, body = spec.aids, spec.body
    pocket = plan.bottom.grown(aids.tray_clearance_mm)
    outer = pocket.grown(aids.tray_rim_mm)
    low = -body.floor_mm - aids.tray_floor_mm
    solid = drafted_prism(outer, aids.tray_floor_mm + aids.tray_rim_height_mm, 0.0, low)
    reach = outer.width_mm / 2 + EAR_RADIUS_MM - 4.0
    # Two ears that met would close a gap between them and the rim.
    side = max(EAR_RADIUS_MM + 2.0, outer.length_mm / 2 - outer.radius_mm - EAR_RADIUS_MM)
    places = [(-side, reach), (side, reach), (0.0, -reach)]
    ears = [cq.Solid.makeCylinder(EAR_RADIUS_MM, aids.tray_floor_mm, cq.Vector(x, y, low)) for x, y in places]
    holes = [
        cq.Solid.makeCylinder(aids.level_screw_hole_mm / 2, aids.tray_floor_mm + 2, cq.Vector(x, y, low - 1))
        for x, y in places
    ]
    solid = solid.fuse(*ears)
    return single_solid(solid.cut(drafted_prism(pocket, aids.tray_rim_height_mm + 1.0, 0.0, -body.floor_mm), *holes))


def collar(spec: MouldSpec, plan: Layout) -> Any:
    """Ring on the land that holds foaming resin while it is degassed in the mould; a lip centres it outside."""
    aids = spec.aids
    high = formula.collar_height_mm(plan.depth_mm, spec.pour.foam_factor)
    gap, lip = COLLAR_GAP_MM + spec.machines.elephant_foot_mm, 4.0
    inner = plan.openings.grown(1.0)
    outside = plan.top.grown(gap + aids.collar_wall_mm)
    ring = drafted_prism(outside, high + lip, 0.0, plan.land_mm - lip)
    seat = drafted_prism(plan.top.grown(gap), lip, 0.0, plan.land_mm - lip)
    return single_solid(ring.cut(drafted_prism(inner, high + 1.0, 0.0, plan.land_mm), seat))
