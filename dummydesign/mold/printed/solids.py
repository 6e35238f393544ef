"""Base and ring of a printed mould. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.casting_box import bolt_holes
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.model.face_sheet import recess_outline, sheet_outline
from dummydesign.mold.printed.layout import DOWEL_MM, dowel_places, level_places, parting_mm


def add_printed(made: Parts, brims: list[Any], bars: list[Any]) -> None:
    """Build ``mould`` (base plate with the floor) and ``frame`` (ring with the walls) into ``made``.

    Parameters
    ----------
    made : Parts
        With the pad.
    brims : list of cadquery.Solid
        Brims over the fill planes.
    bars : list of cadquery.Solid
        Letters of the label.
    """
    spec, plan = made.spec, made.plan
    part, low = parting_mm(spec, plan), -spec.body.floor_mm
    base = drafted_prism(plan.flange, part - low, 0.0, low)
    flange = drafted_prism(plan.flange, min(spec.box.flange_thickness_mm, plan.land_mm - part), 0.0, part)
    ring = single_solid(drafted_prism(plan.top, plan.land_mm - part, 0.0, part).fuse(flange))
    made.hull = single_solid(base.fuse(ring).clean())
    holes = _holes(made, low - 1.0, plan.land_mm - low + 2.0)
    base = base.cut(*made.cavities, *holes)
    if spec.box.face_sheet_mm:
        base = _let_in_sheet(made, base)
    made.add("mould", single_solid(base), "rigid")
    made.add("frame", single_solid(ring.cut(*made.cavities, *brims, *bars, *holes)), "rigid")
    made.whole = single_solid(made.hull.cut(*made.cavities, *brims, *bars, *holes))


def _holes(made: Parts, low_mm: float, high_mm: float) -> list[Any]:
    """Bolts, pins and levelling screws through both flanges."""
    import cadquery as cq

    spec, plan = made.spec, made.plan
    pin = DOWEL_MM + 2 * spec.machines.gap_mm
    places = [(place, pin) for place in dowel_places(spec, plan)]
    places += [(place, spec.aids.level_screw_hole_mm) for place in level_places(spec, plan)]
    loose = [
        cq.Solid.makeCylinder(across / 2, high_mm, cq.Vector(place.x_mm, place.y_mm, low_mm))
        for place, across in places
    ]
    return [*bolt_holes(spec, plan.flange, low_mm, high_mm), *loose]


def _let_in_sheet(made: Parts, base: Any) -> Any:
    """The sheet that is the tested face, flush with the floor, and the base with a pocket for it."""
    spec, plan = made.spec, made.plan
    deep = spec.box.face_sheet_mm + spec.box.sheet_bond_mm
    pocket = drafted_prism(recess_outline(spec, plan), deep, 0.0, -deep)
    made.tools["face_recess"] = plan.at_places(pocket)
    sheet = drafted_prism(sheet_outline(spec, plan), spec.box.face_sheet_mm, 0.0, -spec.box.face_sheet_mm)
    made.add("face_sheet", plan.at_places(sheet)[0], "glass")
    return single_solid(base.cut(*made.tools["face_recess"]))
