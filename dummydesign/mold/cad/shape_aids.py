"""Rigid aids that only some shapes need: spacer between two pours, carriers of bone or crowns. CAD child only."""

from __future__ import annotations

import math
from typing import Any

from dummydesign.mold.cad.aids import strike_off
from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.model.layout import Layout, Point
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import CARRIER_VENT_MM, CARRIER_VENTS

# Clear width between a vent and the wall of the cavity. [mm]
VENT_INSET_MM = 3.0
# Border of the carrier of several crowns around the pad, and its marks: gap to the pad, width and depth. [mm]
CARRIER_BORDER_MM, MARK_GAP_MM, MARK_WIDTH_MM, MARK_DEPTH_MM = 15.0, 2.0, 0.8, 0.6


def spacer(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that rests on the land and dips to the interface of a layered pad, a film gap around it.

    Lowered hinged from one edge it drives out air and excess and leaves the layer poured first at its height.
    """
    aids = spec.aids
    inner = _within(plan.interface_outline, aids.plate_clearance_mm)
    dip = drafted_prism(inner, plan.depth_mm - plan.interface_mm, spec.pad.draft_deg, plan.interface_mm)
    return single_solid(strike_off(spec, plan).fuse(dip))


def carrier(spec: MouldSpec, plan: Layout, finished: Any) -> Any:
    """Plate with the ``finished`` bone under it.

    It closes the mould at the fill plane and stays on the pad as its rigid base.

    Four vents open at the corners of the cavity, four holes beyond it take the screws that hold pad and plate later.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    plan : Layout
        Its layout.
    finished : cadquery.Solid
        The bone at its finished size, in the pad's frame.
    """
    import cadquery as cq

    bone = finished.scale(plan.scale)
    low, high = plan.depth_mm - 1.0, plan.land_mm + spec.aids.plate_mm + 1.0
    holes = [(place, CARRIER_VENT_MM) for place in vent_places(plan)]
    holes += [(place, spec.box.bolt_hole_mm) for place in screw_places(plan)]
    tools = [
        cq.Solid.makeCylinder(across / 2, high - low, cq.Vector(place.x_mm, place.y_mm, low)) for place, across in holes
    ]
    return single_solid(single_solid(strike_off(spec, plan).cut(*tools)).fuse(bone))


def marked_carrier(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that the finished pad is glued to, its middle on the plate's, with marks of the sites around the pad.

    A groove at each end of every row and column of crowns points at their tips: where the lines between them cross,
    the punch is set down. The plate stands over the mould, the side that the pad is glued to below.

    Parameters
    ----------
    spec : MouldSpec
    plan : Layout
        Its layout.
    """
    import cadquery as cq

    pad, thick = carrier_outline(plan), spec.aids.plate_mm
    plate, low = pad.grown(CARRIER_BORDER_MM), plan.land_mm
    solid = drafted_prism(plate, thick, 0.0, low)
    long = CARRIER_BORDER_MM - MARK_GAP_MM + 1.0
    grooves = []
    places = spec.pad.shape.places_mm
    for x in sorted({x for x, _ in places}):
        for side in (1.0, -1.0):
            at = side * (pad.width_mm / 2 + MARK_GAP_MM + long / 2)
            grooves.append((x, at, MARK_WIDTH_MM, long))
    for y in sorted({y for _, y in places}):
        for side in (1.0, -1.0):
            at = side * (pad.length_mm / 2 + MARK_GAP_MM + long / 2)
            grooves.append((at, y, long, MARK_WIDTH_MM))
    tools = [
        cq.Solid.makeBox(dx, dy, MARK_DEPTH_MM + 1.0).translate(cq.Vector(x - dx / 2, y - dy / 2, low - 1.0))
        for x, y, dx, dy in grooves
    ]
    return single_solid(solid.cut(*tools))


def carrier_outline(plan: Layout) -> Outline:
    """The finished pad's free face, which is glued to the carrier."""
    return plan.fill_outline.scaled(1.0 / plan.scale)


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


def _within(outline: Outline, gap_mm: float) -> Outline:
    """Outline moved inwards; a corner sharper than the gap stays sharp."""
    inner = outline.grown(-gap_mm)
    return Outline(inner.length_mm, inner.width_mm, max(0.0, inner.radius_mm))
