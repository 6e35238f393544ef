"""Bill of materials of a mould and its first pad. No CAD: grams of printed parts come from measured volumes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from dummydesign.mold.model.layout import DOWEL_MM, layout, parting_mm, sheet_outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import CUP_FACTOR, FILLED_SHARE, GRAM_PER_HOUR, PourPlan, batch_of, pours_of

# Lengths in which machine screws are sold, and grip beyond the flanges for nut and washer. [mm]
SCREW_MM = (10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 60, 70)
NUT_MM = 5.0
LEVEL_TRAVEL_MM = 12.0
CUPS_LITRE = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0)


def sold(sizes: Sequence[float], least: float) -> float:
    """Smallest size sold that is large enough, else the largest."""
    return next((size for size in sizes if size >= least), sizes[-1])


def screw_length_mm(grip_mm: float) -> float:
    """Shortest screw sold that goes through ``grip_mm`` and a nut. [mm]"""
    return sold(SCREW_MM, grip_mm + NUT_MM)


HEAD = ("what", "how much", "what for")


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
        MaterialItem(bolts, 8 if spec.closure is None else 16, "{:.0f}", bolted),
        MaterialItem(levels, 3, "{:.0f}", f"levelling the {levelled}"),
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
    gram = 1e-3 * FILLED_SHARE * (spec.plastic.density_g_per_cm3 if spec.plastic else 1.24)
    return needs + [
        MaterialItem(f"{filament}: {name}", volume * gram, "about {:.0f} g", "")
        for name, volume in (printed_mm3 or {}).items()
    ]


def bill_of_materials(needs: Iterable[MaterialItem]) -> list[tuple[str, str, str]]:
    """Everything to buy or to have, as (what, how much, what for), the first row the head."""
    return [HEAD, *(need.row for need in needs)]
