"""Refuse what cannot be made, with the reason, before any CAD is loaded."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import asdict, fields, is_dataclass, replace
from typing import Any

from dummydesign.core.errors import InputError, accepts, out_of_range, quantity_name, unknown_name
from dummydesign.geometry.dimensions import RIM_FREE_MM
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import Layout, Outline, layout, plug_top_mm, sheet_outline
from dummydesign.mold.model.printed_parts import part_title, printed_parts, tray_covers
from dummydesign.mold.model.products import Surface
from dummydesign.mold.model.spec import MouldSpec, PadGeometry

THICKNESS_MM = (3.0, 30.0)
CORNER_MM = 0.5
MOST_CAVITIES = 20
DEGAS_PLACES = ("cup", "mould", "none")
SMALLEST_MM = {"open": 20.0, "lidded": 50.0, "printed": 20.0}
# The sheet let in as the tested face: thicknesses, least side, least plastic under it.
SHEET_MM, LEAST_SHEET_MM, LEAST_FLOOR_MM = (1.0, 8.0), 20.0, 3.0


def validate(spec: MouldSpec) -> Layout:
    """Check a specification and return its layout; what is advised instead was tried with the same checks."""
    plan = _check_makeable(spec)
    if (fault := _machine_fault(spec)) is None:
        return plan
    counts = range(spec.count - 1, 0, -1)
    fewer = next((count for count in counts if _machine_fault(replace(spec, count=count)) is None), 0)
    if fewer:
        raise InputError(
            f"count = {spec.count} cavities of {spec.pad.length_mm:g} x {spec.pad.width_mm:g} mm do not fit machines "
            f"'{spec.machines.name}'; {fewer} fit{'s' if fewer == 1 else ''} in one mould",
            "out_of_range",
            "count",
            spec.count,
            (1, fewer),
        ) from fault
    advice = "name other machines in a preset file"
    if turned_fits(spec):
        advice = f"turned by 90 degrees, {spec.pad.width_mm:g} x {spec.pad.length_mm:g} mm, it fits"
    elif (size := largest_pad_mm(replace(spec, count=1))) is not None:
        advice = f"a pad of {size[0]:g} x {size[1]:g} mm fits, or {advice}"
    raise InputError(f"{fault}; {advice}", fault.code, fault.quantity, fault.value, fault.allowed)


def _check_makeable(spec: MouldSpec) -> Layout:
    """Check all but the machines."""
    _all_finite(spec, "")
    _check_pad(spec)
    _check_body(spec)
    if spec.body.style == "lidded":
        _check_closure(spec)
    if spec.is_printed:
        _check_surface(spec.surface, spec.pad.draft_deg)
    _check_process(spec)
    if spec.base is not None:
        _check_process(replace(spec, pour=spec.base.pour))
    _check_count(spec)
    plan = layout(spec)
    _check_face_sheet(spec, plan)
    return plan


def _check_count(spec: MouldSpec) -> None:
    """Several cavities stand side by side where one strike-off plate closes them all."""
    if not 1 <= spec.count <= MOST_CAVITIES:
        raise out_of_range("count", spec.count, 1, MOST_CAVITIES, "cavities of one mould")
    if spec.count > 1 and (spec.body.style == "lidded" or spec.base is not None or spec.pad.shape.bone_height_mm):
        what = "a lidded mould" if spec.body.style == "lidded" else f"a mould for {spec.pad.shape.name} pads"
        message = f"count = {spec.count}: {what} has one cavity; cast the pads one after the other"
        raise InputError(message, "out_of_range", "count", spec.count, (1, 1))


def _all_finite(value: Any, name: str) -> None:
    if is_dataclass(value):
        for item in fields(value):
            _all_finite(getattr(value, item.name), item.name)
    elif isinstance(value, tuple):
        for item in value:
            _all_finite(item, name)
    elif isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{name} = {value} is not a finite number", "out_of_range", name, value)


def _between(name: str, value: float, low: float, high: float, advice: str = "") -> None:
    if not low <= value <= high:
        raise out_of_range(name, f"{value:g}", f"{low:g}", f"{high:g}", advice)


def _all_between(table: object, before: str = "", /, **limits: tuple[float, float]) -> None:
    """Check fields of a table against their limits, one after the other; ``before`` stands before their names."""
    for name, ends in limits.items():
        _between(before + name, getattr(table, name), *ends)


def _check_pad(spec: MouldSpec) -> None:
    pad = spec.pad
    if spec.body.style not in SMALLEST_MM:
        raise unknown_name("style of mould", spec.body.style, tuple(SMALLEST_MM))
    _all_between(pad, thickness_mm=THICKNESS_MM)
    least = SMALLEST_MM[spec.body.style]
    for name, value in (("length_mm", pad.length_mm), ("width_mm", pad.width_mm)):
        if value < least:
            message = f"{name} = {value:g} is below {least:g}, the least for a mould of style {spec.body.style}"
            raise InputError(message, "out_of_range", name, value, (least, None))
    _all_between(pad, draft_deg=(0.0, 10.0))
    if pad.is_puck:
        if pad.length_mm != pad.width_mm:
            given = f"length_mm = {pad.length_mm:g} and width_mm = {pad.width_mm:g}"
            message = f"{given} of a puck must both be its diameter"
            raise InputError(message, "inconsistent", "width_mm", pad.width_mm, pad.length_mm)
    else:
        most = min(pad.length_mm, pad.width_mm) / 2 * 0.999
        _between("corner_radius_mm", pad.corner_radius_mm, CORNER_MM, most, "a sharper corner tears the silicone")
    _check_shape(spec, pad)


def _check_shape(spec: MouldSpec, pad: PadGeometry) -> None:
    """What the shape itself allows, what its preset allows, and an edge that leaves its curves alone."""
    shape = pad.shape
    shape.check(pad.thickness_mm, pad.length_mm, pad.width_mm)
    if spec.body.style == "lidded" and shape.open_mould_only:
        raise InputError(f"{shape.open_mould_only}; use --preset open", "conflict", "preset", spec.preset)
    if (shape.layers() is None) != (spec.base is None):
        message = "a layered pad, and no other, needs a second resin for its base (base_ratio)"
        raise InputError(message, "inconsistent", "base_ratio")
    highest = min(pad.corner_radius_mm, pad.edge_room_mm)
    advice = "it fits below the corner radius and 0.9 of the rim's thickness"
    if shape.layers():
        advice = f"{advice}, and the edge stays in the upper layer"
    if not shape.flat_top and highest > RIM_FREE_MM / 2:
        highest, advice = RIM_FREE_MM / 2, "it keeps off the curved top"
    _between("edge_radius_mm", pad.edge_radius_mm, 0.0, highest, advice)
    if shape.runs_out:
        _between("corner_radius_mm", pad.corner_radius_mm, CORNER_MM, RIM_FREE_MM, f"the {shape.name} top runs out")
    if shape.sharp_edge and pad.edge_radius_mm:
        message = f"edge_radius_mm = {pad.edge_radius_mm:g} of {shape.sharp_edge}"
        raise InputError(message, "not_applicable", "edge_radius_mm", pad.edge_radius_mm, 0)


def _check_body(spec: MouldSpec) -> None:
    body, box, aids = spec.body, spec.box, spec.aids
    height = spec.pad.thickness_mm * 1.02 + body.freeboard_mm + body.floor_mm
    shrink = height * math.tan(math.radians(body.outer_draft_deg))
    _all_between(
        body,
        wall_mm=(6.0, 50.0),
        floor_mm=(5.0, 50.0),
        outer_draft_deg=(0.0, 3.0),
        outer_corner_radius_mm=(shrink + 0.5, body.wall_mm + 10.0),
    )
    if body.style != "lidded":
        _all_between(body, brim_step_mm=(0.5, body.wall_mm / 2), freeboard_mm=(1.0, 20.0))
        _all_between(aids, plate_clearance_mm=(0.2, body.brim_step_mm))
    elif body.brim_step_mm or body.freeboard_mm:
        message = "brim_step_mm and freeboard_mm must be 0 for a lidded mould: its lid closes the fill plane"
        raise InputError(message, "not_applicable", "brim_step_mm" if body.brim_step_mm else "freeboard_mm", allowed=0)
    _all_between(
        body,
        label_depth_mm=(0.2, body.floor_mm / 4),
        label_height_mm=(2.5, body.wall_mm - 3.0),
        label_stroke_mm=(0.4, body.label_height_mm / 5),
    )
    _all_between(
        box,
        base_mm=(4.0, 30.0),
        frame_wall_mm=(2.0, 20.0),
        flange_mm=(box.bolt_hole_mm + 2.0, 40.0),
        rim_mm=(2.0, 30.0),
        rim_step_mm=(0.3, box.frame_wall_mm - 1.0),
    )
    _all_between(aids, tray_rim_height_mm=(1.0, body.floor_mm))


def _check_closure(spec: MouldSpec) -> None:
    c, body, pad = spec.closure, spec.body, spec.pad
    if pad.is_puck:
        raise InputError("a puck is poured in an open mould; use --preset open", "conflict", "preset", spec.preset)
    if c is None:
        raise InputError("a lidded mould needs the table [closure] in its preset", "missing", "closure")
    socket = 2 * (c.key_radius_mm + c.key_clearance_mm)
    least_wall = c.gutter_distance_mm + c.gutter_radius_mm + socket + 2.0
    if body.wall_mm < least_wall:
        message = f"wall_mm = {body.wall_mm:g} is too small: gutter and keys with 1 mm beside them need {least_wall:g}"
        raise InputError(message, "out_of_range", "wall_mm", body.wall_mm, (least_wall, None))
    least_distance = c.gutter_radius_mm + 1.5
    if c.gutter_distance_mm < least_distance:
        message = f"gutter_distance_mm = {c.gutter_distance_mm:g} leaves less than 1.5 mm beside the cavity"
        raise InputError(
            f"{message}; at least {least_distance:g}",
            "out_of_range",
            "gutter_distance_mm",
            c.gutter_distance_mm,
            (least_distance, None),
        )
    _all_between(
        c,
        key_clearance_mm=(0.05, 0.5),
        key_shift_mm=(socket + 1.0, pad.length_mm / 2),
        key_radius_mm=(1.5, min(c.lid_mm, body.floor_mm) - 2.0),
        sprue_large_mm=(c.sprue_small_mm, 2 * c.sprue_inset_mm - 2.0),
        vent_large_mm=(c.vent_small_mm, 2 * c.vent_inset_mm - 2.0),
        sprue_inset_mm=(4.0, pad.length_mm / 4),
        vent_inset_mm=(3.0, min(pad.length_mm, pad.width_mm) / 4),
    )


def _check_process(spec: MouldSpec) -> None:
    pour, silicone = spec.pour, spec.silicone
    _all_between(pour, density_g_per_cm3=(0.5, 3.0), shrinkage_percent=(0.0, 5.0))
    if silicone is not None:
        _between("density_g_per_cm3 of the silicone", silicone.density_g_per_cm3, 0.8, 2.0)
        _between("shrinkage_percent of the silicone", silicone.shrinkage_percent, 0.0, 3.0)
    _all_between(pour, cure_temperature_C=(0.0, 150.0))
    plastic, hot = spec.plastic, spec.pour.cure_temperature_C
    if plastic is not None and hot > plastic.service_temperature_C:
        raise InputError(
            f"plastic '{plastic.name}' bears {plastic.service_temperature_C:g} C, the resin cures at {hot:g} C and the "
            'tray stays in the oven: name a plastic in the preset that bears it, such as plastic = "asa"',
            "out_of_range",
            "plastic.service_temperature_C",
            plastic.service_temperature_C,
            (hot, None),
        )
    _all_between(spec.acceptance, "acceptance ", **dict.fromkeys(asdict(spec.acceptance), (0.1, 50.0)))
    _all_between(pour, foam_factor=(1.5, 8.0))
    if pour.degas not in DEGAS_PLACES:
        raise unknown_name("place to degas", pour.degas, DEGAS_PLACES)
    if pour.degas == "mould" and spec.body.style != "open":
        message = f"degas = 'mould' needs an open mould of silicone, not a {spec.body.style} one; use 'cup'"
        raise InputError(message, "conflict", "degas", pour.degas, "cup")
    if pour.pour_and_degas_min >= pour.pot_life_min:
        raise InputError(
            f"pour_and_degas_min = {pour.pour_and_degas_min:g} is not below the pot life of {pour.resin}, "
            f"{pour.pot_life_min:g} min{pour.mark('pot_life_min')}. It is in [process] of mould preset "
            f"'{spec.preset}': copy its file, write the minutes that you need and pass the copy with --preset. Without "
            'a vacuum write degas = "none" there, and the minutes to pour alone',
            "out_of_range",
            "pour_and_degas_min",
            pour.pour_and_degas_min,
            (None, pour.pot_life_min),
        )
    if not pour.components or not math.isclose(sum(share for _, share in pour.components), 1.0, abs_tol=1e-9):
        raise InputError("the mass fractions of the resin's components must sum to 1", "inconsistent", "components")
    _all_between(spec.machines, balance_resolution_g=(0.001, 10.0))


def _check_surface(surface: Surface | None, draft_deg: float) -> None:
    """Refuse a printed mould that would not let go."""
    if surface is None:
        message = "a printed mould needs the table [surface] in its preset: depth_mm and the draft it asks for"
        raise InputError(message, "missing", "surface")
    _all_between(surface, "surface ", depth_mm=(0.001, 0.2), least_draft_deg=(0.0, 5.0), draft_deg_per_mm=(0.0, 200.0))
    if draft_deg < surface.draft_needed_deg:
        deep = max(0.0, (draft_deg - surface.least_draft_deg) / surface.draft_deg_per_mm)
        raise InputError(
            f"draft_deg = {draft_deg:g} of a printed mould: valleys of {surface.depth_mm:g} mm need at least "
            f"{surface.draft_needed_deg:.2f} deg; give more draft, or finish it to {deep:.3f} mm (surface depth_mm)",
            "out_of_range",
            "draft_deg",
            draft_deg,
            (surface.draft_needed_deg, None),
        )


def _check_face_sheet(spec: MouldSpec, plan: Layout) -> None:
    """Refuse a sheet that cannot be the tested face."""
    box, shape = spec.box, spec.pad.shape
    if not box.face_sheet_mm:
        return
    if shape.relief_mm:
        raise InputError(
            f"face_sheet_mm = {box.face_sheet_mm:g}: the tested face of {shape} is curved, a sheet is flat; use 0",
            "not_applicable",
            "face_sheet_mm",
            box.face_sheet_mm,
            0,
        )
    under = spec.body.floor_mm if spec.is_printed else plug_top_mm(plan) + box.base_mm
    most = min(SHEET_MM[1], under - LEAST_FLOOR_MM - box.sheet_bond_mm)
    if not SHEET_MM[0] <= box.face_sheet_mm <= most:
        raise out_of_range(
            "face_sheet_mm",
            f"{box.face_sheet_mm:g}",
            f"{SHEET_MM[0]:g}",
            f"{most:.3g}",
            f"{LEAST_FLOOR_MM:g} mm of plastic stay under it",
        )
    _all_between(box, sheet_bond_mm=(0.0, 0.5), sheet_rim_mm=(2.0, 20.0))
    sheet = sheet_outline(spec, plan)
    if min(sheet.length_mm, sheet.width_mm) < LEAST_SHEET_MM:
        raise InputError(
            f"a sheet of {sheet.length_mm:g} x {sheet.width_mm:g} mm is all that fits on the tested face inside its "
            f"rim; at least {LEAST_SHEET_MM:g} mm each way are of use: leave face_sheet_mm at 0 or take a larger pad",
            "cannot_be_made",
            "face_sheet_mm",
            box.face_sheet_mm,
        )


def footprint(spec: MouldSpec) -> Outline:
    """What stands in the oven: the tray, or the base of a printed mould."""
    if spec.is_printed:
        return layout(spec).flange
    return tray_covers(spec, layout(spec))


def chamber_spare_mm(spec: MouldSpec) -> float:
    """Room that a mould with its collar leaves in the vacuum chamber, the lesser of diameter and height. [mm]"""
    m, plan = spec.machines, layout(spec)
    tall = plan.height_mm + formula.collar_height_mm(plan.depth_mm, spec.pour.foam_factor)
    return min(m.chamber_diameter_mm - plan.top.diagonal_mm, m.chamber_height_mm - tall)


def _machine_fault(spec: MouldSpec) -> InputError | None:
    """Why the machines do not take the mould, with what is needed and what is there."""
    m, plan = spec.machines, layout(spec)
    for part in printed_parts(spec):
        name = part_title(part.name, spec.is_printed)
        if part.outline.spare_mm(m.bed_mm) < 0:
            return _too_large("printer bed", f"the {name}", part.outline, m.bed_mm, spec)
        if part.height_mm > m.printer_height_mm:
            return InputError(
                f"the {name} is {part.height_mm:.0f} mm high as it is printed, the printer of machines '{m.name}' "
                f"prints up to {m.printer_height_mm:g} mm",
                "cannot_be_made",
                "printer_height_mm",
                part.height_mm,
                (None, m.printer_height_mm),
            )
    shelf = m.shelf_x_mm, m.shelf_y_mm
    if spec.pour.cures_warm and footprint(spec).spare_mm(shelf) < 0:
        return _too_large("oven shelf", "the mould" if spec.is_printed else "the tray", footprint(spec), shelf, spec)
    if spec.pour.degas == "mould" and chamber_spare_mm(spec) < 0:
        high = plan.height_mm + formula.collar_height_mm(plan.depth_mm, spec.pour.foam_factor)
        return InputError(
            f"the mould with its collar ({plan.top.diagonal_mm:.0f} mm across, {high:.0f} mm high) does not fit "
            f"the vacuum chamber of machines '{m.name}' ({m.chamber_diameter_mm:g} x {m.chamber_height_mm:g} mm); "
            "degas in the cup or use a smaller pad",
            "cannot_be_made",
            "vacuum_chamber",
        )
    return None


def _too_large(machine: str, part: str, size: Outline, room_mm: tuple[float, ...], spec: MouldSpec) -> InputError:
    """What is wrong with a part larger than a machine."""
    pad, room = spec.pad, tuple(sorted(room_mm, reverse=True))
    usable = " x ".join(f"{side:g}" for side in room) + (" mm across" if len(room) == 1 else " mm")
    message = (
        f"pad of {pad.length_mm:g} x {pad.width_mm:g} mm: {part} of {size.length_mm:.1f} x {size.width_mm:.1f} "
        f"mm does not fit the {machine} of machines '{spec.machines.name}' ({usable} "
        "usable)"
    )
    return InputError(message, "cannot_be_made", quantity_name(machine), (size.length_mm, size.width_mm), room)


def _can_be_made(spec: MouldSpec) -> bool:
    """Whether nothing is wrong with a mould, nor with its size; tried."""
    return accepts(_check_makeable, spec) and _machine_fault(spec) is None


def turned_fits(spec: MouldSpec) -> bool:
    """Whether the same pad with length and width exchanged can be made; tried."""
    pad = spec.pad
    # Places of several crowns lie in the pad and would have to be turned with it.
    if pad.length_mm == pad.width_mm or len(pad.shape.places_mm) > 1:
        return False
    turned = replace(spec, pad=replace(pad, length_mm=pad.width_mm, width_mm=pad.length_mm))
    return _can_be_made(turned)


def largest_pad_mm(spec: MouldSpec) -> tuple[float, float] | None:
    """Largest pad in whole millimetres, no longer and no wider than asked, whose mould the machines take; tried.

    None where none was found. Of a puck both sides are its diameter.
    """
    pad, least = spec.pad, math.ceil(SMALLEST_MM[spec.body.style])
    asked = math.floor(pad.length_mm), math.floor(pad.width_mm)
    if any(part.height_mm > spec.machines.printer_height_mm for part in printed_parts(spec)):
        return None

    def sized(length_mm: float, width_mm: float) -> MouldSpec:
        corner = length_mm / 2 if pad.is_puck else pad.corner_radius_mm
        return replace(spec, pad=replace(pad, length_mm=length_mm, width_mm=width_mm, corner_radius_mm=corner))

    def largest(sides: Callable[[int], tuple[float, float]], low: int, high: int) -> tuple[float, float]:
        """Sides at the largest whole number at which the machines take the mould, at least ``low``."""
        tried = range(low + 1, high + 1)
        return sides(low + bisect_left(tried, True, key=lambda one: _machine_fault(sized(*sides(one))) is not None))

    def side(longest: int, asked_mm: int) -> float:
        return float(max(least, longest * asked_mm // max(asked)))

    # First both sides in proportion, then each alone.
    found = largest(lambda one: (side(one, asked[0]), side(one, asked[1])), least, max(asked))
    if not pad.is_puck:
        found = largest(lambda one: (float(one), found[1]), int(found[0]), asked[0])
        found = largest(lambda one: (found[0], float(one)), int(found[1]), asked[1])
    return found if _can_be_made(sized(*found)) else None
