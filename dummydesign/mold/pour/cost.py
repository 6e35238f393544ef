"""What a mould takes: hours of printing, grams of filament, silicone and resin, from its specification. No CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dummydesign.mold.model.layout import (
    DOWEL_MM,
    bone_volume_mm3,
    cavity_volume_mm3,
    drafted_volume_mm3,
    layout,
    parting_mm,
)
from dummydesign.mold.model.printed_parts import EAR_MM2, tray_outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import (
    CARRIER_VENT_MM,
    CARRIER_VENTS,
    FILLED_SHARE,
    GRAM_PER_HOUR,
    batch_of,
    pour_plan,
    pours_of,
)

BOLTS, SCREWS = 8, 3
PLAIN_DENSITY = 1.24
"""Of filament where a preset names no plastic. [g/cm3]"""


@dataclass(frozen=True)
class MouldCost:
    """Estimates; hours and filament are None for a lidded mould. ``cost`` is None: presets hold no prices.

    ``resin_g`` is the whole mix of one casting, of a layered pad both.
    """

    printing_h: float | None
    filament_g: float | None
    silicone_g: float
    resin_g: float
    cost: float | None = None


def mould_cost(spec: MouldSpec) -> MouldCost:
    """Estimate what a mould and one casting of it take; loads no CAD.

    Printed volumes are in closed form, but for the label; of them
    :data:`~dummydesign.mold.pour.plan.FILLED_SHARE` is plastic.
    """
    plan = pour_plan(spec)
    resin = sum(batch_of(spec, *one).mix.total_g for one in pours_of(spec, plan))
    volumes = printed_volumes_mm3(spec)
    silicone = plan.silicone_mass_g + plan.lid_silicone_mass_g
    if volumes is None:
        return MouldCost(None, None, silicone, resin)
    density = spec.plastic.density_g_per_cm3 if spec.plastic else PLAIN_DENSITY
    filament = 1e-3 * FILLED_SHARE * density * sum(volumes.values())
    return MouldCost(filament / GRAM_PER_HOUR, filament, silicone, resin)


def printed_volumes_mm3(spec: MouldSpec) -> dict[str, float] | None:
    """Return the volume of each printed part of an open or a printed mould; None for a lidded one."""
    if spec.body.style == "lidded":
        return None
    plan, body, box, aids = layout(spec), spec.body, spec.box, spec.aids
    bolts = BOLTS * math.pi / 4 * box.bolt_hole_mm**2
    brim = drafted_volume_mm3(plan.brim_outline, body.freeboard_mm, spec.pad.draft_deg)
    cavities = spec.count * (cavity_volume_mm3(spec) + brim)
    if spec.is_printed:
        part = parting_mm(spec, plan)
        screws = math.pi / 4 * (SCREWS * aids.level_screw_hole_mm**2 + 2 * (DOWEL_MM + 2 * spec.machines.gap_mm) ** 2)
        flange_mm = min(box.flange_thickness_mm, plan.land_mm - part)
        # what of the cavity lies in the base is a slice of its lowest part
        low = spec.count * drafted_volume_mm3(plan.floor_outline, part, spec.pad.draft_deg)
        base = (plan.flange.area_mm2 - bolts - screws) * (part + body.floor_mm) - low
        ring = plan.top.area_mm2 * (plan.land_mm - part) - (cavities - low)
        ring += (plan.flange.area_mm2 - plan.top.area_mm2 - bolts - screws) * flange_mm
        volumes = {"mould": base, "frame": ring}
    else:
        grow, high = plan.silicone_scale, plan.height_mm * plan.silicone_scale
        hull = drafted_volume_mm3(plan.bottom, plan.height_mm, body.outer_draft_deg)
        inner = plan.top.scaled(grow)
        walls = inner.grown(box.frame_wall_mm).area_mm2
        step = inner.grown(box.rim_step_mm - high * math.tan(math.radians(body.outer_draft_deg))).area_mm2
        frame = walls * (high + box.rim_mm) - grow**3 * hull - step * box.rim_mm
        frame += (plan.flange.area_mm2 - walls - bolts) * min(box.flange_thickness_mm, high + box.rim_mm)
        pocket = plan.bottom.grown(aids.tray_clearance_mm)
        ears = SCREWS * (EAR_MM2 - math.pi / 4 * aids.level_screw_hole_mm**2)
        floor = tray_outline(spec, plan).area_mm2
        tray = (floor + ears) * aids.tray_floor_mm + (floor - pocket.area_mm2) * aids.tray_rim_height_mm
        volumes = {
            "master": (plan.flange.area_mm2 - bolts) * box.base_mm + grow**3 * cavities,
            "frame": frame,
            "tray": tray,
        }
    dip = drafted_volume_mm3(plan.brim_outline.grown(-aids.plate_clearance_mm), body.freeboard_mm, spec.pad.draft_deg)
    plate = plan.top.grown(-1.0).area_mm2 * aids.plate_mm + spec.count * dip
    if spec.pad.shape.bone_height_mm:
        holes = 4 * spec.box.bolt_hole_mm**2 + CARRIER_VENTS * CARRIER_VENT_MM**2
        holes_mm3 = math.pi / 4 * (holes * aids.plate_mm + CARRIER_VENTS * CARRIER_VENT_MM**2 * body.freeboard_mm)
        volumes["carrier"] = plate + plan.scale**3 * bone_volume_mm3(spec) - holes_mm3
    else:
        volumes["strike_off"] = plate
    if spec.base is not None:
        under = plan.interface_outline.grown(-aids.plate_clearance_mm)
        volumes["spacer"] = plate + drafted_volume_mm3(under, plan.depth_mm - plan.interface_mm, spec.pad.draft_deg)
    return volumes
