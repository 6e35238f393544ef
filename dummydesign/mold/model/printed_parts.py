"""The parts of a mould that are printed: how each lies on the printer's bed, and what it takes of it. No CAD."""

from __future__ import annotations

from dataclasses import dataclass, replace

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import Layout, Outline, layout, parting_mm
from dummydesign.mold.model.spec import MouldSpec

EAR_RADIUS_MM = 8.0
"""Radius of the tray's ears; their middles stand 4 mm outside its rim."""
EAR_OUT_MM = EAR_RADIUS_MM - 4.0
EAR_MM2 = 162.0
"""What an ear adds to the tray in plan."""
COLLAR_GAP_MM, COLLAR_LIP_MM = 0.3, 4.0
"""Room around silicone that a printed ring is put over, and how deep it reaches over it. [mm]"""
CARRIER_BORDER_MM = 15.0
"""Border of the carrier of several crowns around the pad. [mm]"""
MOST_OVERHANG_MM2, STEEPEST_DEG = 300.0, 45.0
"""Largest area that may overhang by more than the angle from upright without support (judgement)."""


@dataclass(frozen=True)
class PrintedPart:
    """One printed part as it lies: what it covers of the bed, its height, and which side is down.

    ``turned`` is whether it is turned over about x from the way it stands in the mould and in its STEP file.
    """

    name: str
    outline: Outline
    height_mm: float
    turned: bool
    down: str


def ear_side_mm(outer: Outline) -> float:
    """How far the two ears on one side of the tray stand from its middle; closer they would close a gap. [mm]"""
    return max(EAR_RADIUS_MM + 2.0, outer.length_mm / 2 - outer.radius_mm - EAR_RADIUS_MM)


def tray_outline(spec: MouldSpec, plan: Layout) -> Outline:
    """The tray without its ears."""
    return plan.bottom.grown(spec.aids.tray_rim_mm + spec.aids.tray_clearance_mm)


def tray_covers(spec: MouldSpec, plan: Layout) -> Outline:
    """The rounded rectangle that holds the tray with its ears."""
    outer = tray_outline(spec, plan)
    across = max(outer.length_mm, 2 * (ear_side_mm(outer) + EAR_RADIUS_MM))
    # The ears leave the rounded corners free.
    corner = across / 2 - ear_side_mm(outer) - EAR_RADIUS_MM
    return Outline(across, outer.width_mm + 2 * (EAR_OUT_MM + EAR_RADIUS_MM), min(corner, outer.radius_mm))


def printed_parts(spec: MouldSpec) -> tuple[PrintedPart, ...]:
    """Every printed part in the size of its print file, as it lies on the bed."""
    plan, grow = layout(spec), spec.machines.print_scale
    made = _printed_mould(spec, plan) if spec.is_printed else _casting_boxes(spec, plan)
    return tuple(
        replace(part, outline=part.outline.scaled(grow), height_mm=grow * part.height_mm)
        for part in (*made, *_plates(spec, plan))
    )


def _printed_mould(spec: MouldSpec, plan: Layout) -> list[PrintedPart]:
    part = parting_mm(spec, plan)
    return [
        PrintedPart("mould", plan.flange, part + spec.body.floor_mm, False, "underside"),
        PrintedPart("frame", plan.flange, plan.land_mm - part, False, "flange"),
    ]


def _casting_boxes(spec: MouldSpec, plan: Layout) -> list[PrintedPart]:
    """Master and frame of the mould, of a lidded one those of the lid and the pins, and the tray."""
    box, grow, flange = spec.box, plan.silicone_scale, plan.flange
    high = plan.height_mm * grow
    made = [
        PrintedPart("master", flange, box.base_mm + grow * plan.land_mm, False, "base plate"),
        PrintedPart("frame", flange, high + box.rim_mm, False, "flange"),
    ]
    if spec.closure is not None:
        c = spec.closure
        lid = grow * c.lid_mm
        made += [
            PrintedPart("lid_master", flange, box.base_mm, False, "base plate"),
            PrintedPart("lid_frame", flange, lid + box.rim_mm, False, "flange"),
        ]
        for name, funnel in (("sprue_pin", plan.funnels[0]), ("vent_pin", plan.funnels[1])):
            wide = grow * funnel.large_mm
            tall = lid + c.pin_handle_mm + c.pin_spigot_mm - 0.5
            made.append(PrintedPart(name, Outline(wide, wide, wide / 2), tall, True, "handle"))
    tall = spec.aids.tray_floor_mm + spec.aids.tray_rim_height_mm
    return [*made, PrintedPart("tray", tray_covers(spec, plan), tall, False, "underside")]


def _plates(spec: MouldSpec, plan: Layout) -> list[PrintedPart]:
    """What closes, divides or carries the pad, and the collar to degas in."""
    aids, shape = spec.aids, spec.pad.shape
    plate, dip = plan.top.grown(-1.0), aids.plate_mm + spec.body.freeboard_mm
    made = []
    if spec.closure is not None:
        made.append(PrintedPart("backer", plate, spec.closure.backer_mm, False, "either face"))
    elif shape.bone_height_mm:
        high = dip + plan.scale * shape.bone_height_mm
        made.append(PrintedPart("carrier", plate, high, True, "face without the bone"))
    else:
        made.append(PrintedPart("strike_off", plate, dip, True, "face without the step"))
    if len(shape.places_mm) > 1:
        border = plan.fill_outline.scaled(1.0 / plan.scale).grown(CARRIER_BORDER_MM)
        made.append(PrintedPart("carrier", border, aids.plate_mm, True, "face without the grooves"))
    if spec.base is not None:
        made.append(
            PrintedPart(
                "spacer", plate, aids.plate_mm + plan.land_mm - plan.interface_mm, True, "face without the step"
            )
        )
    if spec.pour.degas == "mould":
        gap = COLLAR_GAP_MM + spec.machines.elephant_foot_mm
        high = formula.collar_height_mm(plan.depth_mm, spec.pour.foam_factor)
        made.append(
            PrintedPart(
                "collar", plan.top.grown(gap + aids.collar_wall_mm), high + COLLAR_LIP_MM, True, "face without the lip"
            )
        )
    return made


PART_NAMES = {
    "mould": "base",
    "strike_off": "strike-off plate",
    "lid_master": "lid master",
    "lid_frame": "lid frame",
    "sprue_pin": "sprue pin",
    "vent_pin": "vent pins",
}
"""What the sheet calls a part whose file has another name."""


def part_title(name: str, printed: bool) -> str:
    """Name of a printed part in words; the frame of a printed mould is its ring."""
    return "ring" if printed and name == "frame" else PART_NAMES.get(name, name)


def lying_words(spec: MouldSpec) -> str:
    """How the parts lie in their print files: which side is down."""
    sides = ", ".join(f"{part_title(part.name, spec.is_printed)}: {part.down}" for part in printed_parts(spec))
    return f"STL and 3MF lie as they are printed, without support. Down on the bed: {sides}."
