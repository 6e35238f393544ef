"""The pour sheet of witness pucks: ring, weights, pour, acceptance by size and mass, protocol. No CAD."""

from __future__ import annotations

import math

from dummydesign.mold.files.pour_sheet import SheetBlock, ratio_text, safety_words, volume_blocks, weight_rows
from dummydesign.mold.pour.bill_of_materials import (
    CUPS_LITRE,
    MaterialItem,
    bill_of_materials,
    sold,
)
from dummydesign.mold.pour.plan import CUP_FACTOR
from dummydesign.mold.pour.steps import BLANK, cup_words, degas_words
from dummydesign.mold.puck.plan import PuckPlan, command, press_rows, protocol_steps, spec_cost, trace_names
from dummydesign.mold.puck.ring import PuckSpec, ring_mass_g

ROUND_MM, PARALLEL_SHARE, SIZE_SHARE = 0.5, 0.01, 0.02
"""Largest difference of three diameters [mm]; of four heights, over the height; of the size from the planned one."""


def puck_sheet(spec: PuckSpec, plan: PuckPlan) -> list[SheetBlock]:
    """Put together the sheet of some pucks, in the order of the work."""
    blocks = [
        SheetBlock("head", f"Pour sheet: {spec.title}"),
        SheetBlock("text", f"Specification {spec.hash}. Date {BLANK}  Operator {BLANK}  Resin batch {BLANK}"),
        SheetBlock(
            "text", "A puck measures the modulus and the relaxation of a batch. Do not reject it for its modulus."
        ),
        SheetBlock("text", safety_words(spec.pour)),
        SheetBlock("head", "1. The ring"),
        SheetBlock("list", items=_ring_steps(spec)),
        SheetBlock("head", "2. Weigh the resin"),
        *_weighing(spec, plan),
        SheetBlock("head", "3. Pour"),
        SheetBlock("list", items=_pour_steps(spec, plan)),
        SheetBlock("head", "4. Accept or reject, each puck"),
        SheetBlock("table", rows=tuple(acceptance_rows(spec, plan))),
        SheetBlock("head", "5. Press"),
        SheetBlock(
            "list",
            items=protocol_steps(
                max(ring.diameter_mm for ring in spec.rings),
                spec.pour.age_before_test_days,
                spec.pour.mark("age_before_test_days"),
            ),
        ),
    ]
    for ring in spec.rings:
        for number in range(1, ring.count + 1):
            names = trace_names(ring.tag, number, ring.count)
            typed = command(names, "MEASURED", "MEASURED", spec.pour.ratio, spec.pour.resin, mass="MEASURED")
            blocks += [
                SheetBlock("table", rows=tuple(press_rows(names, ring.height_mm))),
                SheetBlock("text", f"Then type, with the measured sizes in mm and the mass in g: {typed}"),
            ]
    return [*blocks, SheetBlock("head", "What is needed"), SheetBlock("table", rows=tuple(needed(spec, plan)))]


def _ring_steps(spec: PuckSpec) -> tuple[str, ...]:
    cost = spec_cost(spec)
    rings = ", ".join(f"half of ring {ring.tag}: {2 * ring.count} times" for ring in spec.rings)
    fit = spec.machines
    foot = f" Let the slicer take off {fit.elephant_foot_mm:g} mm from the first layer." if fit.elephant_foot_mm else ""
    return (
        f"Print ({rings}) upright as it lies in the file, walls solid, no support, {spec.plastic.name.upper()} (bears "
        f"{spec.plastic.service_temperature_C:g} C): about {cost.printing_h:.1f} h, {cost.filament_g:.0f} g.{foot}",
        "Sand the inside smooth. Scrape seams off the joint faces and off both rims: the puck's faces must be flat and "
        f"parallel. Measured height of the ring: {BLANK} mm (planned "
        f"{', '.join(f'{spec.scale * ring.height_mm:.2f}' for ring in spec.rings)})",
        "Wax the inside and the joint faces, polish, twice.",
        "Press the two halves together, ridge into groove. Put a foldback clip on each pair of lugs.",
        "Tape release film on a flat plate of glass. Stand the ring on it and seal it from outside with a bead of wax "
        "or plasticine, also up the two joints.",
    )


def _weighing(spec: PuckSpec, plan: PuckPlan) -> list[SheetBlock]:
    resolution, pour = spec.machines.balance_resolution_g, spec.pour
    digits = max(0, -math.floor(math.log10(resolution)))
    each = "; ".join(f"{mass:.1f} g into each ring {ring.tag}" for ring, mass in zip(spec.rings, plan.pour_g))
    why = f"The balance leaves up to {plan.mix.error_percent:.2f} % error in a component's share."
    if plan.raised:
        why = (
            f"With the loss in the cup and the spare {plan.wanted_g:.0f} g would do; less than this mix the balance "
            f"does not weigh in the right ratio. {why} A finer balance saves resin."
        )
    return [
        SheetBlock(
            "text", f"{pour.resin}, ratio {pour.ratio:.6g} ({ratio_text(pour)}); balance step {resolution:g} g."
        ),
        SheetBlock("table", rows=tuple(weight_rows([plan.mix], digits))),
        *volume_blocks(pour),
        SheetBlock(
            "text", f"Mix {plan.mix.total_g:.{digits}f} g. Pour {each}. {why} {cup_words(pour, plan.cup_mm3 * 1e-6)}"
        ),
    ]


def _pour_steps(spec: PuckSpec, plan: PuckPlan) -> tuple[str, ...]:
    pour = spec.pour
    cure = f"Cure {pour.cure_time_h:g} h{pour.mark('cure_time_h')} {pour.cure_place}"
    return (
        f"Level the plate to {plan.level_deg:.2f} deg where it stays until the resin is cured. Level read: {BLANK}",
        f"Weigh {', then '.join(name for name, _ in pour.components)}; stir slowly for two minutes, scrape wall and "
        f"floor, pour it into a second cup and stir again. Start of mixing: {BLANK}",
        degas_words(pour),
        "Fill each ring in a thin stream until the resin stands a little over the rim. Prick bubbles.",
        "Strike off at the rim: lay release film on a second flat plate, set it down on one edge of the rim and lower "
        "it like a hinge until it rests on the rim all round; excess runs out. Put a weight of about 100 g on it.",
        f"All of this within {pour.pot_life_min - 2.0:.0f} min of mixing (pot life {pour.pot_life_min:g} min"
        f"{pour.mark('pot_life_min')}). Done at: {BLANK}",
        f"{cure}, where it stands.",
        "Take off plate, clips and wax. Pull the halves apart sideways. Peel the film off both faces; do not pull the "
        "puck. Cut the seam at the two joints flush.",
    )


def acceptance_rows(spec: PuckSpec, plan: PuckPlan) -> list[tuple[str, ...]]:
    """Table of what is measured on a puck, what is allowed and what to do; sizes and mass, not the modulus."""
    rows: list[tuple[str, ...]] = [("measured", "planned", "allowed", "effect", "measured value", "if outside")]
    several = len(spec.rings) > 1
    for ring, mass in zip(spec.rings, plan.puck_g):
        puck = f" of {ring.tag}" if several else ""
        light, heavy = (mass * (1 + sign * spec.acceptance.mass_percent / 100) for sign in (-1, 1))
        rows += [
            (
                f"diameter{puck}, mean of top, middle and bottom",
                f"{ring.diameter_mm:g} mm",
                _size(ring.diameter_mm),
                "none if the measured one is typed; else 2 % of modulus per 1 %",
                BLANK,
                "type the measured diameter",
            ),
            (
                f"largest minus smallest diameter{puck}",
                "0 mm",
                f"{ROUND_MM:g} mm",
                "not a cylinder: modulus off by as much as the area",
                BLANK,
                "cast again; scrape the joint faces",
            ),
            (
                f"height{puck}, mean of four places",
                f"{ring.height_mm:g} mm",
                _size(ring.height_mm),
                "none if the measured one is typed; else 1 % of modulus per 1 %",
                BLANK,
                "type the measured height",
            ),
            (
                f"largest minus smallest height{puck}",
                "0 mm",
                f"{PARALLEL_SHARE * ring.height_mm:.2f} mm",
                "a tilted face looks soft at the start",
                BLANK,
                "cast again, plate level",
            ),
            (
                f"mass{puck}",
                f"{mass:.1f} g",
                f"{light:.1f} to {heavy:.1f} g, for the planned size",
                "air inside is softer",
                BLANK,
                "first correct for the measured size; still light: air inside, cast again",
            ),
            (f"bubbles over 1 mm{puck}", "none", "none", "softer", BLANK, "cast again; degas longer"),
        ]
    return rows


def _size(planned_mm: float) -> str:
    off = SIZE_SHARE * planned_mm
    return f"{planned_mm - off:.1f} to {planned_mm + off:.1f} mm"


def needed(spec: PuckSpec, plan: PuckPlan) -> list[tuple[str, str, str]]:
    """Everything to buy or to have; the first row is the head."""
    filament = spec.plastic.name.upper()
    wide = max(ring.diameter_mm for ring in spec.rings) + 60.0
    several = {ring: f" ({ring.count} rings)" if ring.count > 1 else "" for ring in spec.rings}
    items = [
        MaterialItem(f"{filament}: ring {ring.tag}{words}", ring.count * ring_mass_g(spec, ring), "about {:.0f} g", "")
        for ring, words in several.items()
    ]
    items += [MaterialItem(name, mass, "{:.1f} g", "pucks") for name, mass in plan.mix.components]
    cup = sold(CUPS_LITRE, CUP_FACTOR * plan.mix.total_g / spec.pour.density_g_per_cm3 * 1e-3)
    items += [
        MaterialItem(f"cups of {cup:g} l", 2, "{:.0f}", "mixing and pouring over"),
        MaterialItem("foldback clips, 19 mm", 2 * spec.pucks, "{:.0f}", "ring halves"),
        MaterialItem(f"flat plates of glass, {wide:.0f} x {wide:.0f} mm", 2 * spec.pucks, "{:.0f}", "base, strike-off"),
        MaterialItem("release film", 2 * spec.pucks, "{:.0f} pieces", "plates"),
        MaterialItem("hard wax, plasticine, abrasive paper to 400", 1, "a little", "ring"),
        MaterialItem("silicone oil", 1, "a little", "plates of the press"),
        MaterialItem("gloves, goggles, extraction", 1, "{:.0f} set", "resin"),
    ]
    if spec.pour.cures_warm:
        items.append(MaterialItem("vented oven", spec.pour.cure_temperature_C, "to {:.0f} C", "cure"))
    return bill_of_materials(items)
