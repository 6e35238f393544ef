"""Rigid aids around the mould: strike-off plate, tray, collar, spacers, carriers. CAD child only."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.solids import cylinders, drafted_prism, single_solid
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import Layout, Point
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import CARRIER_VENT_MM, CARRIER_VENTS

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
    aids, body = spec.aids, spec.body
    pocket = plan.bottom.grown(aids.tray_clearance_mm)
    outer = pocket.grown(aids.tray_rim_mm)
    low = -body.floor_mm - aids.tray_floor_mm
    solid = drafted_prism(outer, aids.tray_floor_mm + aids.tray_rim_height_mm, 0.0, low)
    reach = outer.width_mm / 2 + EAR_RADIUS_MM - 4.0
    # Two ears that met would close a gap between them and the rim.
    side = max(EAR_RADIUS_MM + 2.0, outer.length_mm / 2 - outer.radius_mm - EAR_RADIUS_MM)
    places = [Point(-side, reach), Point(side, reach), Point(0.0, -reach)]
    ears = cylinders(places, EAR_RADIUS_MM, aids.tray_floor_mm, low)
    holes = cylinders(places, aids.level_screw_hole_mm / 2, aids.tray_floor_mm + 2, low - 1)
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


# Clear width between a vent and the wall of the cavity. [mm]
VENT_INSET_MM = 3.0
# Border of the carrier of several crowns around the pad, and its marks: gap to the pad, width and depth. [mm]
CARRIER_BORDER_MM, MARK_GAP_MM, MARK_WIDTH_MM, MARK_DEPTH_MM = 15.0, 2.0, 0.8, 0.6


def spacer(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that rests on the land and dips to the interface of a layered pad, a film gap around it.

    Lowered hinged from one edge it drives out air and excess and leaves the layer poured first at its height.
    """
    aids = spec.aids
    inner = plan.interface_outline.grown(-aids.plate_clearance_mm)
    # A corner sharper than the gap stays sharp.
    inner = replace(inner, radius_mm=max(0.0, inner.radius_mm))
    dip = drafted_prism(inner, plan.depth_mm - plan.interface_mm, spec.pad.draft_deg, plan.interface_mm)
    return single_solid(strike_off(spec, plan).fuse(dip))


def carrier(spec: MouldSpec, plan: Layout, finished: Any) -> Any:
    """Plate with the ``finished`` bone under it.

    It closes the mould at the fill plane and stays on the pad as its rigid base.

    Four vents open at the corners of the cavity, four holes beyond it take the screws that hold pad and plate later.
    """
    low, high = plan.depth_mm - 1.0, plan.land_mm + spec.aids.plate_mm + 1.0
    tools = cylinders(vent_places(plan), CARRIER_VENT_MM / 2, high - low, low)
    tools += cylinders(screw_places(plan), spec.box.bolt_hole_mm / 2, high - low, low)
    return single_solid(single_solid(strike_off(spec, plan).cut(*tools)).fuse(finished.scale(plan.scale)))


def marked_carrier(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that the finished pad is glued to, its middle on the plate's, with marks of the sites around the pad.

    A groove at each end of every row and column of crowns points at their tips: where the lines between them cross,
    the punch is set down. The plate stands over the mould, the side that the pad is glued to below.
    """
    # The finished pad's free face is glued on.
    pad, low, places = plan.fill_outline.scaled(1.0 / plan.scale), plan.land_mm, spec.pad.shape.places_mm
    solid = drafted_prism(pad.grown(CARRIER_BORDER_MM), spec.aids.plate_mm, 0.0, low)
    long = CARRIER_BORDER_MM - MARK_GAP_MM + 1.0
    off = MARK_GAP_MM + long / 2
    grooves = [(x, side * (pad.width_mm / 2 + off), MARK_WIDTH_MM, long)
               for x in sorted({x for x, _ in places}) for side in (1.0, -1.0)]  # fmt: skip
    grooves += [(side * (pad.length_mm / 2 + off), y, long, MARK_WIDTH_MM)
                for y in sorted({y for _, y in places}) for side in (1.0, -1.0)]  # fmt: skip
    tools = [
        cq.Solid.makeBox(dx, dy, MARK_DEPTH_MM + 1.0).translate(cq.Vector(x - dx / 2, y - dy / 2, low - 1.0))
        for x, y, dx, dy in grooves
    ]
    return single_solid(solid.cut(*tools))


def vent_places(plan: Layout) -> tuple[Point, ...]:
    """Vents in the corners of the fill plane, the last to be reached when the carrier is lowered."""
    return _corners(plan.fill_outline, VENT_INSET_MM + CARRIER_VENT_MM / 2)[:CARRIER_VENTS]


def screw_places(plan: Layout) -> tuple[Point, ...]:
    """Screw holes in the corners of the land, half-way between the cavity and the rim."""
    border = (plan.top.length_mm - plan.opening.length_mm) / 4
    return _corners(plan.top, border)


def _corners(outline: Outline, inset_mm: float) -> tuple[Point, ...]:
    # On a rounded corner the parallel line runs at 45 degrees inside the square one.
    cut = (1 - math.sqrt(0.5)) * max(0.0, outline.radius_mm - inset_mm)
    x, y = outline.length_mm / 2 - inset_mm - cut, outline.width_mm / 2 - inset_mm - cut
    return Point(x, y), Point(x, -y), Point(-x, -y), Point(-x, y)
