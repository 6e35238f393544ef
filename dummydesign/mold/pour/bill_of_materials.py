"""What a mould and its first pad take: bill of materials with the measured volumes of printed parts; before there are
any, an estimate of hours and grams from the specification. No CAD."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from dummydesign.mold.model.layout import (
    DOWEL_MM,
    bone_volume_mm3,
    cavity_volume_mm3,
    drafted_volume_mm3,
    layout,
    parting_mm,
    sheet_outline,
)
from dummydesign.mold.model.printed_parts import EAR_MM2, tray_outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import (
    CARRIER_VENT_MM,
    CARRIER_VENTS,
    CUP_FACTOR,
    FILLED_SHARE,
    GRAM_PER_HOUR,
    PourPlan,
    batch_of,
    pour_plan,
    pours_of,
)

# Lengths in which machine screws are sold, and grip beyond the flanges for nut and washer. [mm]
SCREW_MM = (10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 60, 70)
NUT_MM = 5.0
LEVEL_TRAVEL_MM = 12.0
CUPS_LITRE = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0)
BOLTS, SCREWS = 8, 3
PLAIN_DENSITY = 1.24
"""Of filament where a preset names no plastic. [g/cm3]"""


def sold(sizes: Sequence[float], least: float) -> float:
    """Smallest size sold that is large enough, else the largest."""
    return next((size for size in sizes if size >= least), sizes[-1])


def screw_length_mm(grip_mm: float) -> float:
    """Shortest screw sold that goes through ``grip_mm`` and a nut. [mm]"""
    return sold(SCREW_MM, grip_mm + NUT_MM)


@dataclass(frozen=True)
class MaterialItem:
    """One thing to buy or to have; ``form`` writes its amount."""

    what: str
    amount: float
    form: str
    purpose: str

    @property
    def row(self) -> tuple[str, str, str]:
        """As it stands in a list."""
        hours = f"about {max(0.1, self.amount / GRAM_PER_HOUR):.1f} h of printing"
        return self.what, self.form.format(self.amount), self.purpose or hours


def materials(spec: MouldSpec, plan: PourPlan, printed_mm3: Mapping[str, float] | None = None) -> list[MaterialItem]:
    """Everything to buy or to have for a mould and one casting."""
    box, aids, arrangement = spec.box, spec.aids, layout(spec)
    under = spec.body.floor_mm + parting_mm(spec, arrangement) if spec.is_printed else box.base_mm
    grip = under + box.flange_thickness_mm
    long = screw_length_mm((grip if spec.is_printed else aids.tray_floor_mm) + LEVEL_TRAVEL_MM)
    bolted, levelled = ("ring on base", "mould") if spec.is_printed else ("frame on master", "tray")
    bolts = f"screws M{math.floor(box.bolt_hole_mm)} x {screw_length_mm(grip)} with nuts and washers"
    levels = f"screws M{math.floor(aids.level_screw_hole_mm)} x {long} with nuts"
    needs = [
        MaterialItem(bolts, BOLTS if spec.closure is None else 2 * BOLTS, "{:.0f}", bolted),
        MaterialItem(levels, SCREWS, "{:.0f}", f"levelling the {levelled}"),
    ]
    if spec.silicone is not None:
        parts = (("mould", plan.silicone_mass_g), ("lid", plan.lid_silicone_mass_g))
        silicone = f"mould silicone {spec.silicone.name}"
        needs += [MaterialItem(silicone, mass, "{:.0f} g", part) for part, mass in parts if mass]
    else:
        pins = f"steel pins {DOWEL_MM:g} x {screw_length_mm(grip - NUT_MM)} mm"
        needs += [
            MaterialItem(pins, 2, "{:.0f}", "ring on base"),
            MaterialItem("filler, abrasive paper to 400", 1, "a little", "faces against the pad"),
            MaterialItem("hard wax and water-soluble film (PVA)", 1, "a little", "faces against the pad"),
        ]
    if box.face_sheet_mm:
        cut = sheet_outline(spec, arrangement)
        size = f"{cut.length_mm:g} mm across" if cut.is_circle else f"{cut.length_mm:g} x {cut.width_mm:g} mm"
        glass = f"sheet of glass, {box.face_sheet_mm:g} mm, {size}"
        needs.append(MaterialItem(glass, spec.count, "{:.0f}", "tested face"))
    mixes = [
        (name, pour, batch_of(spec, pour, its_plan).with_witness)
        for name, (pour, its_plan) in zip(("", " (base layer)"), pours_of(spec, plan))
    ]
    needs += [
        MaterialItem(f"{what}{name}", mass, "{:.1f} g", "pad and witness")
        for name, _, mix in mixes
        for what, mass in mix.components
    ]
    foam = max(CUP_FACTOR * mix.total_g / pour.density_g_per_cm3 * 1e3 for _, pour, mix in mixes)
    struck_off = spec.body.style != "lidded" and not spec.pad.shape.bone_height_mm
    film = f"release film, {arrangement.openings.length_mm + 40:.0f} x {arrangement.openings.width_mm + 40:.0f} mm"
    cure_C = spec.pour.cure_temperature_C
    needs += [
        MaterialItem(
            f"cups of {sold(CUPS_LITRE, foam * 1e-6):g} l", 2 * len(mixes), "{:.0f}", "mixing and pouring over"
        ),
        MaterialItem(film, len(mixes), "{:.0f}", "plate")
        if struck_off
        else MaterialItem("release agent", 1, "a little", "parting faces; never the tested face"),
        *([MaterialItem("plasticine", 1, "a little", "rings on the backer")] if plan.riser_mm else []),
        MaterialItem("spirit level or inclinometer", plan.level_deg, "to {:.2f} deg", "level"),
        *([MaterialItem("vented oven", cure_C, "to {:.0f} C", "cure and drying")] if spec.pour.cures_warm else []),
        *([MaterialItem("refrigerator", cure_C, "at {:.0f} C", "cure")] if spec.pour.cures_cold else []),
        MaterialItem(
            "gloves, goggles, extraction", 1, "{:.0f} set", "resin" if spec.is_printed else "resin and silicone"
        ),
    ]
    filament = spec.plastic.name.upper() if spec.plastic else "filament"
    gram = 1e-3 * FILLED_SHARE * (spec.plastic.density_g_per_cm3 if spec.plastic else PLAIN_DENSITY)
    return needs + [
        MaterialItem(f"{filament}: {name}", volume * gram, "about {:.0f} g", "")
        for name, volume in (printed_mm3 or {}).items()
    ]


def bill_of_materials(needs: Iterable[MaterialItem]) -> list[tuple[str, str, str]]:
    """Everything to buy or to have, as (what, how much, what for), the first row the head."""
    return [("what", "how much", "what for"), *(need.row for need in needs)]


@dataclass(frozen=True)
class MouldCost:
    """Estimates; hours and filament are None for a lidded mould.

    ``resin_g`` is the whole mix of one casting, of a layered pad both.
    """

    printing_h: float | None
    filament_g: float | None
    silicone_g: float
    resin_g: float


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
