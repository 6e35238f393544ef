"""Build the parts of a mould: silicone from the pad, everything rigid from the silicone. CAD child only.

The mould is the single source of truth: the master is its boolean complement in the block it is cast in,
turned over and scaled by the silicone's shrinkage, so that no feature can be forgotten.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.mold.cad import aids, lid, shape_aids
from dummydesign.mold.cad.casting_box import casting_box
from dummydesign.mold.cad.label import label_bars
from dummydesign.mold.cad.pad_solids import bone_solid, cavity_solid
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.model.face_sheet import plug_top_mm, recess_outline, sheet_outline
from dummydesign.mold.model.layout import Layout, layout
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.printed.solids import add_printed


def build(spec: MouldSpec, bone_file: Path | None = None) -> Parts:
    """Build every part that the specification asks for.

    Parts in use (pad, mould, lid, strike-off, tray, ...) share the mould's frame; parts of the casting
    boxes stand beside them in the assembly.

    Parameters
    ----------
    spec : MouldSpec
        What is made.
    bone_file : Path, optional
        Placed solid of a bone that comes from a file.
    """
    import cadquery as cq

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
        made.tools["label"] = label_tools(spec, plan)
        add_printed(made, plan.at_places(brim_tool(spec, plan)), made.tools["label"])
    else:
        _add_silicone(made, beside)
    if spec.body.style == "lidded":
        lid.add_lid(made, beside)
    elif bone is not None:
        made.add("carrier", shape_aids.carrier(spec, plan, bone), "rigid")
    else:
        made.add("strike_off", aids.strike_off(spec, plan), "rigid")
    if len(spec.pad.shape.places_mm) > 1:
        made.add("carrier", shape_aids.marked_carrier(spec, plan), "rigid", (0, -plan.flange.width_mm - 40.0, 0))
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
        master = _let_in_sheet(made, master, (beside_mm, 0, 0))
    made.add("master", master, "rigid", (beside_mm, 0, 0))
    made.add("frame", frame, "rigid", (beside_mm, 0, 0))


def _let_in_sheet(made: Parts, master: Any, offset_mm: tuple[float, float, float]) -> Any:
    """The sheet that is the tested face, flush with the plug's top, and the master with a pocket for it."""
    spec, plan = made.spec, made.plan
    thick, top = spec.box.face_sheet_mm, plug_top_mm(plan)
    deep = thick + spec.box.sheet_bond_mm
    pocket = drafted_prism(recess_outline(spec, plan), deep, 0.0, top - deep)
    sheet = drafted_prism(sheet_outline(spec, plan), thick, 0.0, top - thick)
    # The casting frame is the mould's turned over about x, and larger by the silicone's shrinkage.
    places = [(place.x_mm * plan.silicone_scale, -place.y_mm * plan.silicone_scale, 0.0) for place in plan.places]
    made.tools["face_recess"] = [pocket.translate(place) for place in places]
    made.add("face_sheet", sheet.translate(places[0]), "glass", offset_mm)
    return single_solid(master.cut(*made.tools["face_recess"]))


def _add_layers(made: Parts, beside_mm: float) -> None:
    """Both layers of the pad, one on the other beside the mould, and the spacer between their pours."""
    plan, pad = made.plan, made.solid("pad")
    low = drafted_prism(plan.fill_outline.grown(1.0), plan.interface_mm + 1.0, 0.0, -1.0)
    made.add("layer_top", single_solid(pad.intersect(low)), "resin", (0, beside_mm, 0))
    made.add("layer_base", single_solid(pad.cut(low)), "resin_base", (0, beside_mm, 0))
    made.add("spacer", shape_aids.spacer(made.spec, plan), "rigid")


def brim_tool(spec: MouldSpec, plan: Layout) -> Any:
    """The step outwards at the fill plane and the freeboard above it; reaches 1 mm above the land."""
    return drafted_prism(plan.brim_outline, spec.body.freeboard_mm + 1.0, spec.pad.draft_deg, plan.depth_mm)


def label_tools(spec: MouldSpec, plan: Layout) -> list[Any]:
    """Solids of the letters, from the label's depth to 1 mm above the land (strokes fused, seams removed)."""
    import cadquery as cq

    deep = spec.body.label_depth_mm
    tools = []
    for bar in label_bars(spec, plan):
        box = cq.Solid.makeBox(bar.length_mm, bar.width_mm, deep + 1.0).translate(
            cq.Vector(-bar.length_mm / 2, -bar.width_mm / 2, plan.land_mm - deep)
        )
        box = box.rotate(cq.Vector(), cq.Vector(0, 0, 1), bar.angle_deg)
        tools.append(box.translate(cq.Vector(*bar.middle, 0)))
    if len(tools) < 2:
        return tools
    return tools[0].fuse(*tools[1:]).clean().Solids()
