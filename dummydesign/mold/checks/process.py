"""Checks of fit, level, weights and time: arithmetic on the specification and the measured volumes; no CAD."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from dummydesign.mold.checks import Check, above, below, equal, skipped
from dummydesign.mold.model.layout import bed_spare_mm
from dummydesign.mold.model.printed_parts import part_title, printed_parts
from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.model.validate import chamber_spare_mm, footprint
from dummydesign.mold.pour.plan import CUP_FACTOR, PourPlan, pours_of
from dummydesign.mold.pour.steps import order_faults, pour_steps

# The free face may end a hundredth larger at the most, both walls taken together.
BULGE_SHARE = 0.005


def check_process(spec: MouldSpec, plan: PourPlan, warnings: Sequence[Mapping[str, str]]) -> list[Check]:
    """Check machines, tray, walls, weights, cup, pot life, and that level and meniscus are warned of."""
    checks = [*_machines(spec), *_walls(spec, plan)]
    for end, one in zip(("", "_base"), pours_of(spec, plan)):
        checks += [replace(item, id=item.id + end) for item in _weights(spec, *one)]
    faults = order_faults(pour_steps(spec, plan))
    return [*checks, equal("sheet_order", len(faults), 0, "; ".join(faults)), _check_warnings(spec, warnings)]


def _machines(spec: MouldSpec) -> list[Check]:
    m, bolt = spec.machines, math.floor(spec.box.bolt_hole_mm)
    play = spec.box.bolt_hole_mm - 2 * m.elephant_foot_mm - bolt
    spare, tight = min((bed_spare_mm(m, part.outline, part.height_mm), part.name) for part in printed_parts(spec))
    checks = [
        above(
            "fits_printer",
            spare,
            0.0,
            "mm to spare on the bed, margin kept, or in height; "
            f"tightest of all printed parts as they lie: {part_title(tight, spec.is_printed)}",
        ),
        above("bolts_pass", play, 0.0, f"mm of play for M{bolt} where the print's first layer spreads"),
    ]
    if spec.pour.cures_warm:
        shelf = footprint(spec).spare_mm((m.shelf_x_mm, m.shelf_y_mm))
        checks.append(above("fits_oven", shelf, 0.0, "mm to spare on the shelf"))
    else:
        checks.append(skipped("fits_oven", f"cures {spec.pour.cure_place}"))
    if spec.plastic is None:
        checks.append(skipped("plastic_bears_oven", "the preset names no plastic"))
    else:
        spare = spec.plastic.service_temperature_C - spec.pour.cure_temperature_C
        checks.append(above("plastic_bears_oven", spare, 0.0, f"K to spare for {spec.plastic.name} in the oven"))
    if spec.pour.degas == "mould":
        checks.append(above("fits_vacuum_chamber", chamber_spare_mm(spec), 0.0, "mm to spare, mould with collar"))
    else:
        where = "is degassed in its cup" if spec.pour.is_degassed else "is poured without a vacuum"
        checks.append(skipped("fits_vacuum_chamber", f"the resin {where}"))
    return checks


def _walls(spec: MouldSpec, plan: PourPlan) -> list[Check]:
    limit = BULGE_SHARE * min(spec.pad.length_mm, spec.pad.width_mm)
    note = "mm, cantilever strip under the liquid, against 0.5 % of the shorter side"
    bulge = below("wall_deflection", plan.wall_deflection_mm, limit, note)
    if spec.surface is not None:
        spare, deep = spec.pad.draft_deg - spec.surface.draft_needed_deg, spec.surface.depth_mm
        return [bulge, above("draft_for_surface", spare, 0.0, f"deg to spare, valleys of {deep:g} mm")]
    room = spec.aids.tray_clearance_mm - plan.thermal_growth_mm / 2
    return [bulge, above("tray_growth_room", room, 0.1, "mm left on each side of the mould in its tray when hot")]


def _weights(spec: MouldSpec, pour: Pour, plan: PourPlan) -> list[Check]:
    resolution = spec.machines.balance_resolution_g
    total = sum(mass for _, mass in plan.components)
    whole = all(math.isclose(mass / resolution, round(mass / resolution), abs_tol=1e-6) for _, mass in plan.components)
    filled = spec.count * plan.fill_mass_g
    lightest = min(mass for _, mass in plan.components)
    # A cup as high as it is wide, as large as the foam needs.
    cup = (4 * plan.cup_mm3 / math.pi) ** (1 / 3)
    needed = pour.pour_and_degas_min + plan.pour_time_s / 60
    return [
        equal("weights_sum", whole and math.isclose(total, plan.batch_mass_g, abs_tol=1e-9), True),
        above("batch_covers_cavity", plan.batch_mass_g - pour.film_loss_g, filled, "g after film loss"),
        below(
            "weighing_error", plan.ratio_error_percent, 100 * resolution / lightest, "%, what one balance step allows"
        ),
        skipped("cup_fits_chamber", "poured without a vacuum")
        if not pour.is_degassed
        else below(
            "cup_fits_chamber",
            cup,
            min(spec.machines.chamber_diameter_mm, spec.machines.chamber_height_mm),
            f"mm, cup of {CUP_FACTOR:g} times the liquid, as high as wide",
        ),
        above("pot_life", pour.pot_life_min, needed, "min against degassing, pouring and levelling"),
    ]


def _check_warnings(spec: MouldSpec, warnings: Sequence[Mapping[str, str]]) -> Check:
    """Level tolerance, and for an open mould the meniscus, must be among what the answer and the sheet say."""
    needed = {"level", "meniscus"} if spec.body.style != "lidded" else {"level"}
    needed |= spec.pad.shape.required_warnings
    missing = sorted(needed - {item["code"] for item in warnings})
    return equal("warnings_told", len(missing), 0, ", ".join(missing))
