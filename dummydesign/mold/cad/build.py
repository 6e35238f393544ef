"""Build the parts of a mould: silicone from the pad, everything rigid from the silicone. CAD child only.

The mould is the single source of truth: the master is its boolean complement in the block it is cast in,
turned over and scaled by the silicone's shrinkage, so that no feature can be forgotten.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.mold.cad import aids, lid
from dummydesign.mold.cad.casting_box import bolt_holes, casting_box, let_in_sheet
from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.label import label_bars
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.shapes import solids_of
from dummydesign.mold.cad.solids import cylinders, drafted_prism, single_solid
from dummydesign.mold.model import layout as dimensions
from dummydesign.mold.model.layout import Layout, layout, plug_top_mm
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec, PadGeometry


def build(spec: MouldSpec, bone_file: Path | None = None) -> Parts:
    """Build every part that the specification asks for.

    Parts in use (pad, mould, lid, strike-off, tray, ...) share the mould's frame; parts of the casting
    boxes lie next to them in the assembly.
    """
    placed = None if bone_file is None else single_solid(cq.Shape.importBrep(str(bone_file)))
    plan = layout(spec)
    whole, bone = cavity_solid(spec.pad), bone_solid(spec.pad, placed)
    nominal = whole if bone is None else single_solid(whole.cut(bone))
    made = Parts(spec, plan, nominal)
    pad = plan.at_places(single_solid(nominal.scale(plan.scale)))[0]
    made.with_bone = None if bone is None else single_solid(whole.scale(plan.scale))
    made.add("pad", pad, "resin")
    beside = plan.flange.length_mm / 2 + plan.top.length_mm / 2 + 40.0
    if spec.is_printed:
        _add_printed(made)
    else:
        _add_silicone(made, beside)
    if spec.body.style == "lidded":
        lid.add_lid(made, beside)
    elif bone is not None:
        made.add("carrier", aids.carrier(spec, plan, bone), "rigid")
    else:
        made.add("strike_off", aids.strike_off(spec, plan), "rigid")
    if len(spec.pad.shape.places_mm) > 1:
        made.add("carrier", aids.marked_carrier(spec, plan), "rigid", (0, -plan.flange.width_mm - 40.0, 0))
    if spec.base is not None:
        _add_layers(made, -plan.flange.width_mm - 40.0)
    if not spec.is_printed:
        made.add("tray", aids.tray(spec, plan), "rigid")
    if spec.pour.degas == "mould":
        made.add("collar", aids.collar(spec, plan), "rigid", (0, plan.flange.width_mm + 40.0, 0))
    return made


def _add_silicone(made: Parts, beside_mm: float) -> None:
    """The silicone mould with its label, and the master and frame it is cast in."""
    spec, plan = made.spec, made.plan
    made.hull = drafted_prism(plan.bottom, plan.height_mm, spec.body.outer_draft_deg, -spec.body.floor_mm)
    mould = made.hull.cut(*made.cavities)
    if spec.body.style == "open":
        mould = mould.cut(*plan.at_places(brim_tool(spec, plan)))
    else:
        mould = mould.cut(*lid.mould_tools(spec, plan, made.tools))
    bars = label_tools(spec, plan)
    made.tools["label"] = bars
    if bars:
        mould = mould.cut(*bars)
    made.add("mould", single_solid(mould), "silicone")
    master, frame = casting_box(spec, made.solid("mould"), made.hull, plan.land_mm, True)
    if spec.box.face_sheet_mm:
        # The casting frame is the mould's turned over about x, and larger by the silicone's shrinkage.
        places = [(place.x_mm * plan.silicone_scale, -place.y_mm * plan.silicone_scale, 0.0) for place in plan.places]
        master = let_in_sheet(made, master, places, plug_top_mm(plan), (beside_mm, 0, 0))
    made.add("master", master, "rigid", (beside_mm, 0, 0))
    made.add("frame", frame, "rigid", (beside_mm, 0, 0))


def _add_layers(made: Parts, beside_mm: float) -> None:
    """Both layers of the pad, one on the other beside the mould, and the spacer between their pours."""
    plan, pad = made.plan, made.solid("pad")
    low = drafted_prism(plan.fill_outline.grown(1.0), plan.interface_mm + 1.0, 0.0, -1.0)
    made.add("layer_top", single_solid(pad.intersect(low)), "resin", (0, beside_mm, 0))
    made.add("layer_base", single_solid(pad.cut(low)), "resin_base", (0, beside_mm, 0))
    made.add("spacer", aids.spacer(made.spec, plan), "rigid")


def brim_tool(spec: MouldSpec, plan: Layout) -> Any:
    """The step outwards at the fill plane and the freeboard above it; reaches 1 mm above the land."""
    return drafted_prism(plan.brim_outline, spec.body.freeboard_mm + 1.0, spec.pad.draft_deg, plan.depth_mm)


def label_tools(spec: MouldSpec, plan: Layout) -> list[Any]:
    """Solids of the letters, from the label's depth to 1 mm above the land (strokes fused, seams removed)."""
    deep = spec.body.label_depth_mm
    tools = []
    for bar in label_bars(spec):
        box = cq.Solid.makeBox(bar.length_mm, bar.width_mm, deep + 1.0).translate(
            cq.Vector(-bar.length_mm / 2, -bar.width_mm / 2, plan.land_mm - deep)
        )
        box = box.rotate(cq.Vector(), cq.Vector(0, 0, 1), bar.angle_deg)
        tools.append(box.translate(cq.Vector(*bar.middle, 0)))
    if len(tools) < 2:
        return tools
    return tools[0].fuse(*tools[1:]).clean().Solids()


def _add_printed(made: Parts) -> None:
    """Base plate with the floor (``mould``) and ring with the walls (``frame``) of a printed mould."""
    spec, plan = made.spec, made.plan
    brims, bars = plan.at_places(brim_tool(spec, plan)), label_tools(spec, plan)
    made.tools["label"] = bars
    part, low = dimensions.parting_mm(spec, plan), -spec.body.floor_mm
    base = drafted_prism(plan.flange, part - low, 0.0, low)
    flange = drafted_prism(plan.flange, min(spec.box.flange_thickness_mm, plan.land_mm - part), 0.0, part)
    ring = single_solid(drafted_prism(plan.top, plan.land_mm - part, 0.0, part).fuse(flange))
    made.hull = single_solid(base.fuse(ring).clean())
    holes = _holes(made, low - 1.0, plan.land_mm - low + 2.0)
    base = base.cut(*made.cavities, *holes)
    if spec.box.face_sheet_mm:
        base = let_in_sheet(made, base, [(place.x_mm, place.y_mm, 0.0) for place in plan.places], 0.0)
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


def block_solid(pad: PadGeometry, low_mm: float) -> Any:
    """Make the drafted slab from a height up to the free face, rounded at its corners and around its lower face."""
    outline = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    solid = drafted_prism(outline, pad.thickness_mm - low_mm, pad.draft_deg, low_mm)
    if pad.edge_radius_mm > 0:
        solid = cq.Workplane(obj=solid).faces("<Z").edges().fillet(pad.edge_radius_mm).val()
    return single_solid(solid)


def cavity_solid(pad: PadGeometry) -> Any:
    """Make what fills the mould: the pad with its bone."""
    tops = solids_of(pad.shape).tops(pad)
    block = block_solid(pad, pad.face_height_mm)
    return single_solid(block.fuse(*tops)) if tops else block


def bone_solid(pad: PadGeometry, placed: Any = None) -> Any:
    """Make the rigid bone below the free face, or None for a shape without one; ``placed`` is one from a file."""
    if placed is not None:
        return placed
    return solids_of(pad.shape).bone(pad) if pad.shape.bone_height_mm else None


def pad_solid(pad: PadGeometry) -> Any:
    """Make the gel of a pad: the cavity's solid less the bone."""
    whole, bone = cavity_solid(pad), bone_solid(pad)
    return whole if bone is None else single_solid(whole.cut(bone))
