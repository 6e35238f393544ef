"""What a mould is built of: block, box, lid, aids; design choices of a preset."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Body:
    """The silicone block around the cavity and the label cut into its land."""

    style: str
    wall_mm: float
    floor_mm: float
    outer_corner_radius_mm: float
    outer_draft_deg: float
    brim_step_mm: float
    freeboard_mm: float
    label_height_mm: float
    label_stroke_mm: float
    label_depth_mm: float


@dataclass(frozen=True)
class Closure:
    """Lid, keys, gutter, sprue and vents of a lidded mould."""

    lid_mm: float
    backer_mm: float
    key_radius_mm: float
    key_clearance_mm: float
    key_shift_mm: float
    gutter_radius_mm: float
    gutter_distance_mm: float
    sprue_small_mm: float
    sprue_large_mm: float
    vent_small_mm: float
    vent_large_mm: float
    sprue_inset_mm: float
    vent_inset_mm: float
    pin_handle_mm: float
    pin_spigot_mm: float


@dataclass(frozen=True)
class Box:
    """The rigid master's base plate and the lift-off frame.

    ``face_sheet_mm`` is the thickness of a sheet of glass or acrylic let into the plug's top as the tested face, with
    a bond of ``sheet_bond_mm`` under it; 0 without one.
    """

    base_mm: float
    frame_wall_mm: float
    flange_mm: float
    flange_thickness_mm: float
    bolt_hole_mm: float
    rim_mm: float
    rim_step_mm: float
    face_sheet_mm: float = 0.0
    sheet_bond_mm: float = 0.1
    sheet_rim_mm: float = 4.0


@dataclass(frozen=True)
class Aids:
    """Strike-off plate, carrier tray and degassing collar."""

    plate_mm: float
    plate_clearance_mm: float
    tray_floor_mm: float
    tray_rim_mm: float
    tray_rim_height_mm: float
    tray_clearance_mm: float
    level_screw_hole_mm: float
    collar_wall_mm: float
