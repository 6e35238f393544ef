"""Bill of materials of a mould and its first pad. No CAD: grams of printed parts come from measured volumes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from dummydesign.mold.model.face_sheet import sheet_outline
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.batch import batch_of
from dummydesign.mold.pour.plan import CUP_FACTOR, PourPlan
from dummydesign.mold.printed.layout import DOWEL_MM, parting_mm

# Share of a printed part that is plastic: 4 perimeters and 15 % infill fill plates of 5 to 8 mm by about half
# (judgement; a slicer knows better), and grams an hour of a 0.4 mm nozzle (judgement).
FILLED_SHARE = 0.5
GRAM_PER_HOUR = 18.0
# Lengths in which machine screws are sold, and grip beyond the flanges for nut and washer. [mm]
SCREW_MM = (10, 12, 16, 20, 25, 30, 35, 40, 45, 50, 60, 70)
NUT_MM = 5.0
LEVEL_TRAVEL_MM = 12.0
CUPS_LITRE = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0)


def screw_length_mm(grip_mm: float) -> int:
    """Shortest screw sold that goes through ``grip_mm`` and a nut. [mm]"""
    return next((length for length in SCREW_MM if length >= grip_mm + NUT_MM), SCREW_MM[-1])


def cup_litre(volume_mm3: float) -> float:
    """Smallest usual cup that holds a volume. [l]"""
    return next((size for size in CUPS_LITRE if size >= volume_mm3 * 1e-6), CUPS_LITRE[-1])


HEAD = ("what", "how much", "what for")
ONCE, POUR, SHARED = "once", "pour", "shared"
"""Needed for the mould, for every casting, or once for all moulds of a job."""


@dataclass(frozen=True)
class Need:
    """One thing to buy or to have; ``form`` writes its amount. Of what is shared the larger amount is taken."""

    what: str
    amount: float
    form: str
    purpose: str
    kind: str = ONCE

    @property
    def row(self) -> tuple[str, str, str]:
        """As it stands in a list."""
        hours = f"about {max(0.1, self.amount / GRAM_PER_HOUR):.1f} h of printing"
        return self.what, self.form.format(abs(self.amount)), self.purpose or hours

    def times(self, count: int) -> Need:
        """For so many castings."""
        return replace(self, amount=self.amount * count) if self.kind == POUR else self

    def with_(self, other: Need) -> Need:
        """Together with the same thing of another mould."""
        both = max(self.amount, other.amount) if self.kind == SHARED else self.amount + other.amount
        return replace(self, amount=both)


def materials(
    spec: MouldSpec, plan: PourPlan, printed_mm3: Mapping[str, float] | None = None
) -> list[Need]:
    """Everything to buy or to have for a mould and one casting.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    plan : PourPlan
        Weights of its pours.
    printed_mm3 : mapping, optional
        Volume of each printed part, as measured on its solid. [mm3]

    Returns
    -------
    list of Need
    """
    box, aids = spec.box, spec.aids
    bolt, level = math.floor(box.bolt_hole_mm), math.floor(aids.level_screw_hole_mm)
    boxes = 2 if spec.closure is not None else 1
    place = layout(spec)
    under = spec.body.floor_mm + parting_mm(spec, place) if spec.is_printed else box.base_mm
    screw = f"M{bolt} x {screw_length_mm(under + box.flange_thickness_mm)}"
    carried = under + box.flange_thickness_mm if spec.is_printed else aids.tray_floor_mm
    long = screw_length_mm(carried + LEVEL_TRAVEL_MM)
    bolted, levelled = ("ring on base", "mould") if spec.is_printed else ("frame on master", "tray")
    needs = [
        Need(f"screws {screw} with nuts and washers", 8 * boxes, "{:.0f}", bolted),
        Need(f"screws M{level} x {long} with nuts", 3, "{:.0f}", f"levelling the {levelled}"),
    ]
    if spec.silicone is not None:
        needs.append(Need(f"mould silicone {spec.silicone.name}", plan.silicone_mass_g, "{:.0f} g", "mould"))
    else:
        needs += [
            Need(f"steel pins {DOWEL_MM:g} x {screw_length_mm(under + box.flange_thickness_mm - NUT_MM)} mm", 2,
                 "{:.0f}", "ring on base"),
            Need("filler, abrasive paper to 400", 1, "a little", "faces against the pad", SHARED),
            Need("hard wax and water-soluble film (PVA)", 1, "a little", "faces against the pad", SHARED),
        ]  # fmt: skip
    if box.face_sheet_mm:
        cut = sheet_outline(spec, layout(spec))
        size = f"{cut.length_mm:g} mm across" if cut.is_circle else f"{cut.length_mm:g} x {cut.width_mm:g} mm"
        needs.append(Need(f"sheet of glass, {box.face_sheet_mm:g} mm, {size}", spec.count, "{:.0f}", "tested face"))
    mixes = [("", spec.pour, batch_of(spec, spec.pour, plan).with_witness)]
    if spec.base is not None and plan.base is not None:
        mixes.append((" (base layer)", spec.base.pour, batch_of(spec, spec.base.pour, plan.base).with_witness))
    for name, _, mix in mixes:
        needs += [Need(f"{what}{name}", mass, "{:.1f} g", "pad and witness", POUR) for what, mass in mix.components]
    foam = max(CUP_FACTOR * mix.total_g / pour.density_g_per_cm3 * 1e3 for _, pour, mix in mixes)
    cups = 2 if plan.base is None else 4
    needs.append(Need(f"cups of {cup_litre(foam):g} l", cups, "{:.0f}", "mixing and pouring over", POUR))
    if spec.body.style != "lidded" and not spec.pad.shape.bone_height_mm:
        film = f"release film, {place.openings.length_mm + 40:.0f} x {place.openings.width_mm + 40:.0f} mm"
        needs.append(Need(film, 1 if plan.base is None else 2, "{:.0f}", "plate", POUR))
    else:
        needs.append(Need("release agent", 1, "a little", "parting faces; never the tested face", SHARED))
    # The finest level of a job counts.
    needs.append(Need("spirit level or inclinometer", -plan.level_deg, "to {:.2f} deg", "level", SHARED))
    if spec.pour.cures_warm:
        needs.append(Need("vented oven", spec.pour.cure_temperature_C, "to {:.0f} C", "cure and drying", SHARED))
    against = "resin" if spec.is_printed else "resin and silicone"
    needs.append(Need("gloves, goggles, extraction", 1, "{:.0f} set", against, SHARED))
    filament = spec.plastic.name.upper() if spec.plastic else "filament"
    density = spec.plastic.density_g_per_cm3 if spec.plastic else 1.24
    for name, volume in (printed_mm3 or {}).items():
        needs.append(Need(f"{filament}: {name}", volume * 1e-3 * FILLED_SHARE * density, "about {:.0f} g", ""))
    return needs


def bill_of_materials(
    spec: MouldSpec, plan: PourPlan, printed_mm3: Mapping[str, float] | None = None
) -> list[tuple[str, str, str]]:
    """Everything to buy or to have, as (what, how much, what for); the first row is the head.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    plan : PourPlan
        Weights of its pours.
    printed_mm3 : mapping, optional
        Volume of each printed part, as measured on its solid. [mm3]

    Returns
    -------
    list of (str, str, str)
    """
    return [HEAD, *(need.row for need in materials(spec, plan, printed_mm3))]
