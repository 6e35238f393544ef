"""Bill of materials of a mould and its first pad. No CAD: grams of printed parts come from measured volumes."""

from __future__ import annotations

import math
from collections.abc import Mapping

from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import PourPlan

# Share of a printed part that is plastic: 4 perimeters and 15 % infill fill plates of 5 to 8 mm by about half
# (judgement; a slicer knows better), and grams an hour of a 0.4 mm nozzle (judgement).
FILLED_SHARE = 0.5
GRAM_PER_HOUR = 18.0
# Lengths in which machine screws are sold, and grip beyond the flanges for nut and washer. [mm]
SCREW_MM = (10, 12, 16, 20, 25, 30, 35, 40)
NUT_MM = 5.0
LEVEL_TRAVEL_MM = 12.0
CUPS_LITRE = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0)


def screw_length_mm(grip_mm: float) -> int:
    """Shortest screw sold that goes through ``grip_mm`` and a nut. [mm]"""
    return next((length for length in SCREW_MM if length >= grip_mm + NUT_MM), SCREW_MM[-1])


def cup_litre(volume_mm3: float) -> float:
    """Smallest usual cup that holds a volume. [l]"""
    return next((size for size in CUPS_LITRE if size >= volume_mm3 * 1e-6), CUPS_LITRE[-1])


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
    box, aids = spec.box, spec.aids
    bolt, level = math.floor(box.bolt_hole_mm), math.floor(aids.level_screw_hole_mm)
    boxes = 2 if spec.closure is not None else 1
    screw = f"M{bolt} x {screw_length_mm(box.base_mm + box.flange_thickness_mm)}"
    rows = [("what", "how much", "what for")]
    rows.append((f"screws {screw} with nuts and washers", f"{8 * boxes}", "frame on master"))
    long = screw_length_mm(aids.tray_floor_mm + LEVEL_TRAVEL_MM)
    rows.append((f"screws M{level} x {long} with nuts", "3", "levelling the tray"))
    rows.append((f"mould silicone {spec.silicone.name}", f"{plan.silicone_mass_g:.0f} g", "mould"))
    for part, name in ((plan, ""), (plan.base, " (base layer)")):
        if part is not None:
            rows += [(f"{what}{name}", f"{mass:.1f} g", "pad") for what, mass in part.components]
    foam = max(part.cup_mm3 for part in (plan, plan.base) if part is not None)
    rows.append((f"cups of {cup_litre(foam):g} l", f"{2 if plan.base is None else 4}", "mixing and pouring over"))
    if spec.body.style == "open" and not spec.pad.shape.bone_height_mm:
        films = 1 if plan.base is None else 2
        rows.append(
            (f"release film, {spec.pad.length_mm + 40:.0f} x {spec.pad.width_mm + 40:.0f} mm", f"{films}", "plate")
        )
    else:
        rows.append(("release agent", "a little", "parting faces; never the tested face"))
    rows.append(("spirit level or inclinometer", f"to {plan.level_deg:.2f} deg", "level"))
    rows.append(("gloves, goggles, extraction", "1 set", "resin and silicone"))
    for name, volume in (printed_mm3 or {}).items():
        grams = volume * 1e-3 * FILLED_SHARE * (spec.plastic.density_g_per_cm3 if spec.plastic else 1.24)
        what = spec.plastic.name.upper() if spec.plastic else "filament"
        rows.append(
            (f"{what}: {name}", f"about {grams:.0f} g", f"about {max(0.1, grams / GRAM_PER_HOUR):.1f} h of printing")
        )
    return rows
