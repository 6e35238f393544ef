"""Build the parts of a mould: silicone from the pad, everything rigid from the silicone. CAD child only.

The mould is the single source of truth: the master is its boolean complement in the block it is cast in,
turned over and scaled by the silicone's shrinkage, so that no feature can be forgotten.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dummydesign.mold.cad.casting_box import add_lid, bolt_holes, casting_box, let_in_sheet, mould_tools
from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.label import Bar, label_corners, letter_bars
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.shapes import solids_of
from dummydesign.mold.cad.solids import cylinders, drafted_prism, single_solid
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model import layout as dimensions
from dummydesign.mold.model.layout import Layout, Outline, PlanPoint, layout, plug_top_mm
from dummydesign.mold.model.printed_parts import (
    CARRIER_BORDER_MM,
    COLLAR_GAP_MM,
    COLLAR_LIP_MM,
    EAR_OUT_MM,
    EAR_RADIUS_MM,
    ear_side_mm,
    tray_outline,
)
from dummydesign.mold.model.spec import MouldSpec, PadGeometry
from dummydesign.mold.pour.plan import CARRIER_VENT_MM, CARRIER_VENTS


def build(spec: MouldSpec) -> Parts:
    """Build every part that the specification asks for.

    Parts in use (pad, mould, lid, strike-off, tray, ...) share the mould's frame; parts of the casting
    boxes lie next to them in the assembly.
    """
    plan = layout(spec)
    made, bone = Parts(spec, plan, pad_solid(spec.pad)), bone_solid(spec.pad)
    made.with_bone = None if bone is None else single_solid(cavity_solid(spec.pad).scale(plan.scale))
    made.add("pad", plan.at_places(single_solid(made.pad_nominal.scale(plan.scale)))[0], "resin")
    shift = plan.flange.length_mm / 2 + plan.top.length_mm / 2 + 40.0
    if spec.is_printed:
        _add_printed(made)
    else:
        _add_silicone(made, shift)
    if spec.body.style == "lidded":
        add_lid(made, shift)
    elif bone is not None:
        made.add("carrier", carrier(spec, plan, bone), "rigid")
    else:
        made.add("strike_off", strike_off(spec, plan), "rigid")
    if len(spec.pad.shape.places_mm) > 1:
        made.add("carrier", marked_carrier(spec, plan), "rigid", (0, -plan.flange.width_mm - 40.0, 0))
    if spec.base is not None:
        _add_layers(made, -plan.flange.width_mm - 40.0)
    if not spec.is_printed:
        made.add("tray", tray(spec, plan), "rigid")
    if spec.pour.degas == "mould":
        made.add("collar", collar(spec, plan), "rigid", (0, plan.flange.width_mm + 40.0, 0))
    return made


def _add_silicone(made: Parts, shift_mm: float) -> None:
    """The silicone mould with its label, and the master and frame it is cast in."""
    spec, plan = made.spec, made.plan
    made.hull = drafted_prism(plan.bottom, plan.height_mm, spec.body.outer_draft_deg, -spec.body.floor_mm)
    mould = made.hull.cut(*made.cavities)
    lidded = spec.body.style == "lidded"
    mould = mould.cut(*(mould_tools(made) if lidded else plan.at_places(brim_tool(spec, plan))))
    bars = made.tools["label"] = label_tools(spec, plan)
    if bars:
        mould = mould.cut(*bars)
    made.add("mould", single_solid(mould), "silicone")
    master, frame = casting_box(spec, made.solid("mould"), made.hull, True)
    if spec.box.face_sheet_mm:
        # The casting frame is the mould's turned over about x, and larger by the silicone's shrinkage.
        places = [(point.x_mm * plan.silicone_scale, -point.y_mm * plan.silicone_scale, 0.0) for point in plan.places]
        master = let_in_sheet(made, master, places, plug_top_mm(plan), (shift_mm, 0, 0))
    made.add("master", master, "rigid", (shift_mm, 0, 0))
    made.add("frame", frame, "rigid", (shift_mm, 0, 0))


def _add_layers(made: Parts, shift_mm: float) -> None:
    """Both layers of the pad, one on the other beside the mould, and the spacer between their pours."""
    plan, pad = made.plan, made.solid("pad")
    low = drafted_prism(plan.fill_outline.grown(1.0), plan.interface_mm + 1.0, 0.0, -1.0)
    made.add("layer_top", single_solid(pad.intersect(low)), "resin", (0, shift_mm, 0))
    made.add("layer_base", single_solid(pad.cut(low)), "resin_base", (0, shift_mm, 0))
    made.add("spacer", spacer(made.spec, plan), "rigid")


def brim_tool(spec: MouldSpec, plan: Layout) -> Any:
    """The step outwards at the fill plane and the freeboard above it; reaches 1 mm above the land."""
    return drafted_prism(plan.brim_outline, spec.body.freeboard_mm + 1.0, spec.pad.draft_deg, plan.depth_mm)


def label_tools(spec: MouldSpec, plan: Layout) -> list[Any]:
    """Solids of the letters, from the label's depth to 1 mm above the land; a letter that comes again is moved."""
    made: dict[str, tuple[float, list[Any]]] = {}
    tools = []
    for letter, (x, y) in label_corners(spec):
        if letter not in made:
            made[letter] = (
                x,
                _letter(
                    letter_bars(letter, spec.body.label_height_mm, spec.body.label_stroke_mm, (x, y)),
                    spec.body.label_depth_mm,
                    plan.land_mm,
                ),
            )
        first, solids = made[letter]
        tools += solids if x == first else [one.translate(cq.Vector(x - first, 0.0, 0.0)) for one in solids]
    return tools


def _letter(bars: list[Bar], deep_mm: float, land_mm: float) -> list[Any]:
    """Strokes of a letter, fused and without seams."""
    boxes = []
    for bar in bars:
        box = cq.Solid.makeBox(bar.length_mm, bar.width_mm, deep_mm + 1.0)
        box = box.translate(cq.Vector(-bar.length_mm / 2, -bar.width_mm / 2, land_mm - deep_mm))
        box = box.rotate(cq.Vector(), cq.Vector(0, 0, 1), bar.angle_deg)
        boxes.append(box.translate(cq.Vector(*bar.middle, 0)))
    if len(boxes) < 2:
        return boxes
    solids: list[Any] = boxes[0].fuse(*boxes[1:]).clean().Solids()
    return solids


def _add_printed(made: Parts) -> None:
    """Base plate with the floor (``mould``) and ring with the walls (``frame``) of a printed mould."""
    spec, plan = made.spec, made.plan
    brims = plan.at_places(brim_tool(spec, plan))
    bars = made.tools["label"] = label_tools(spec, plan)
    part, low = dimensions.parting_mm(spec, plan), -spec.body.floor_mm
    base = drafted_prism(plan.flange, part - low, 0.0, low)
    flange = drafted_prism(plan.flange, min(spec.box.flange_thickness_mm, plan.land_mm - part), 0.0, part)
    ring = single_solid(drafted_prism(plan.top, plan.land_mm - part, 0.0, part).fuse(flange))
    made.hull = single_solid(base.fuse(ring).clean())
    holes = _holes(made, low - 1.0, plan.land_mm - low + 2.0)
    base = base.cut(*made.cavities, *holes)
    if spec.box.face_sheet_mm:
        base = let_in_sheet(made, base, [(point.x_mm, point.y_mm, 0.0) for point in plan.places], 0.0)
    made.add("mould", single_solid(base), "rigid")
    made.add("frame", single_solid(ring.cut(*made.cavities, *brims, *bars, *holes)), "rigid")
    made.whole = single_solid(made.hull.cut(*made.cavities, *brims, *bars, *holes))


def _holes(made: Parts, low_mm: float, high_mm: float) -> list[Any]:
    """Bolts, pins and levelling screws through both flanges."""
    spec, plan = made.spec, made.plan
    pin_mm = dimensions.DOWEL_MM / 2 + spec.machines.gap_mm
    pins = cylinders(dimensions.dowel_places(spec, plan), pin_mm, high_mm, low_mm)
    screws = cylinders(dimensions.level_places(spec, plan), spec.aids.level_screw_hole_mm / 2, high_mm, low_mm)
    return [*bolt_holes(spec, plan.flange, low_mm, high_mm), *pins, *screws]


def cavity_solid(pad: PadGeometry) -> Any:
    """Make what fills the mould, the pad with its bone: a drafted slab, rounded around its lower face, and its tops."""
    tops, low = solids_of(pad.shape).tops(pad), pad.face_height_mm
    outline = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    block = drafted_prism(outline, pad.thickness_mm - low, pad.draft_deg, low)
    if pad.edge_radius_mm > 0:
        block = cq.Workplane(obj=block).faces("<Z").edges().fillet(pad.edge_radius_mm).val()
    block = single_solid(block)
    return single_solid(block.fuse(*tops)) if tops else block


def bone_solid(pad: PadGeometry) -> Any:
    """Make the rigid bone below the free face, or None for a shape without one."""
    return solids_of(pad.shape).bone(pad) if pad.shape.bone_height_mm else None


def pad_solid(pad: PadGeometry) -> Any:
    """Make the gel of a pad: the cavity's solid less the bone."""
    whole, bone = cavity_solid(pad), bone_solid(pad)
    return whole if bone is None else single_solid(whole.cut(bone))


def strike_off(spec: MouldSpec, plan: Layout) -> Any:
    """Plate that rests on the land and dips through the freeboard to the fill plane, a film gap around it.

    Lowered hinged from one edge it drives the air and the excess out through the gap and leaves the free
    face flat at the pad's thickness.
    """
    aids = spec.aids
    inner = plan.brim_outline.grown(-aids.plate_clearance_mm)
    dip = drafted_prism(inner, spec.body.freeboard_mm, spec.pad.draft_deg, plan.depth_mm)
    plate = drafted_prism(plan.top.grown(-1.0), aids.plate_mm, 0.0, plan.land_mm)
    return single_solid(plate.fuse(*plan.at_places(dip)))


def tray(spec: MouldSpec, plan: Layout) -> Any:
    """Flat stiff carrier with a rim that leaves room for thermal growth and three ears for level screws."""
    aids, body = spec.aids, spec.body
    pocket = plan.bottom.grown(aids.tray_clearance_mm)
    outer = tray_outline(spec, plan)
    low = -body.floor_mm - aids.tray_floor_mm
    solid = drafted_prism(outer, aids.tray_floor_mm + aids.tray_rim_height_mm, 0.0, low)
    reach, side = outer.width_mm / 2 + EAR_OUT_MM, ear_side_mm(outer)
    places = [PlanPoint(-side, reach), PlanPoint(side, reach), PlanPoint(0.0, -reach)]
    ears = cylinders(places, EAR_RADIUS_MM, aids.tray_floor_mm, low)
    holes = cylinders(places, aids.level_screw_hole_mm / 2, aids.tray_floor_mm + 2, low - 1)
    solid = solid.fuse(*ears)
    return single_solid(solid.cut(drafted_prism(pocket, aids.tray_rim_height_mm + 1.0, 0.0, -body.floor_mm), *holes))


def collar(spec: MouldSpec, plan: Layout) -> Any:
    """Ring on the land that holds foaming resin while it is degassed in the mould; a lip centres it outside."""
    aids = spec.aids
    high = formula.collar_height_mm(plan.depth_mm, spec.pour.foam_factor)
    gap, lip = COLLAR_GAP_MM + spec.machines.elephant_foot_mm, COLLAR_LIP_MM
    ring = drafted_prism(plan.top.grown(gap + aids.collar_wall_mm), high + lip, 0.0, plan.land_mm - lip)
    seat = drafted_prism(plan.top.grown(gap), lip, 0.0, plan.land_mm - lip)
    return single_solid(ring.cut(drafted_prism(plan.openings.grown(1.0), high + 1.0, 0.0, plan.land_mm), seat))


# Clear width between a vent and the wall of the cavity. [mm]
VENT_INSET_MM = 3.0
# Marks on the carrier of several crowns: gap to the pad, width and depth. [mm]
MARK_GAP_MM, MARK_WIDTH_MM, MARK_DEPTH_MM = 2.0, 0.8, 0.6


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
    # The corners of the fill plane are the last to be reached when the carrier is lowered.
    vents = plan.fill_outline.corners(VENT_INSET_MM + CARRIER_VENT_MM / 2)[:CARRIER_VENTS]
    # Half-way between the cavity and the rim.
    screws = plan.top.corners((plan.top.length_mm - plan.opening.length_mm) / 4)
    tools = cylinders(vents, CARRIER_VENT_MM / 2, high - low, low)
    tools += cylinders(screws, spec.box.bolt_hole_mm / 2, high - low, low)
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
    grooves = [
        (x, side * (pad.width_mm / 2 + off), MARK_WIDTH_MM, long)
        for x in sorted({x for x, _ in places})
        for side in (1.0, -1.0)
    ]
    grooves += [
        (side * (pad.length_mm / 2 + off), y, long, MARK_WIDTH_MM)
        for y in sorted({y for _, y in places})
        for side in (1.0, -1.0)
    ]
    tools = [
        cq.Solid.makeBox(dx, dy, MARK_DEPTH_MM + 1.0).translate(cq.Vector(x - dx / 2, y - dy / 2, low - 1.0))
        for x, y, dx, dy in grooves
    ]
    return single_solid(solid.cut(*tools))
