"""Derived dimensions, outlines and volumes of a mould, computed once from its specification; no CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from dummydesign.mold.model.products import Machines
from dummydesign.mold.model.spec import Closure, MouldSpec, Pour


@dataclass(frozen=True)
class Outline:
    """A rectangle ``length_mm`` by ``width_mm`` about the origin with corners of ``radius_mm``."""

    length_mm: float
    width_mm: float
    radius_mm: float

    @property
    def is_circle(self) -> bool:
        """Whether the corners meet, so that nothing of the sides is left."""
        return abs(self.length_mm - self.width_mm) < 1e-9 and abs(self.length_mm - 2 * self.radius_mm) < 1e-6

    @property
    def area_mm2(self) -> float:
        """Area inside. [mm2]"""
        return self.length_mm * self.width_mm - (4 - math.pi) * self.radius_mm**2

    @property
    def perimeter_mm(self) -> float:
        """Length of the outline. [mm]"""
        return 2 * (self.length_mm + self.width_mm) - (8 - 2 * math.pi) * self.radius_mm

    @property
    def diagonal_mm(self) -> float:
        """Largest distance between two of its points, the corners rounded. [mm]"""
        inner = math.hypot(self.length_mm - 2 * self.radius_mm, self.width_mm - 2 * self.radius_mm)
        return inner + 2 * self.radius_mm

    def spare_mm(self, room_mm: tuple[float, ...]) -> float:
        """Room that it leaves in a rectangle, laid either way, or in a circle; negative where it does not fit. [mm]

        A circle (one diameter) takes what its own smallest circle holds: :attr:`diagonal_mm`, however it is turned.
        """
        if len(room_mm) == 1:
            return room_mm[0] - self.diagonal_mm
        sides = zip(sorted(room_mm), sorted((self.length_mm, self.width_mm)))
        return min(room - side for room, side in sides)

    def grown(self, by_mm: float) -> Outline:
        """Return the outline moved outwards by ``by_mm`` (inwards when negative); corners stay rounded."""
        return Outline(self.length_mm + 2 * by_mm, self.width_mm + 2 * by_mm, self.radius_mm + by_mm)

    def scaled(self, factor: float) -> Outline:
        """Return the outline with all lengths multiplied."""
        return Outline(self.length_mm * factor, self.width_mm * factor, self.radius_mm * factor)

    def corners(self, inset_mm: float) -> tuple[PlanPoint, ...]:
        """Return the four places on the diagonals of its corners that lie ``inset_mm`` inside of it."""
        # On a rounded corner the parallel line runs at 45 degrees inside the square one.
        cut = (1 - math.sqrt(0.5)) * max(0.0, self.radius_mm - inset_mm)
        x, y = self.length_mm / 2 - inset_mm - cut, self.width_mm / 2 - inset_mm - cut
        return PlanPoint(x, y), PlanPoint(x, -y), PlanPoint(-x, y), PlanPoint(-x, -y)


def drafted_volume_mm3(base: Outline, height_mm: float, draft_deg: float) -> float:
    """Volume of a drafted prism whose outline moves outwards by z tan(draft). [mm3]"""
    k = math.tan(math.radians(draft_deg))
    return base.area_mm2 * height_mm + base.perimeter_mm * k * height_mm**2 / 2 + math.pi * k**2 * height_mm**3 / 3


def edge_fillet_volume_mm3(base: Outline, radius_mm: float, draft_deg: float) -> float:
    """Volume that a fillet takes off the lower edge of a drafted prism.

    The cross-section lost (a kite of two tangent lengths less the sector of the arc) is the same all along
    the outline; straight sides give area times length, the four corners together one turn about their
    axes (second theorem of Pappus and Guldinus), its radius taken at the section's centroid.
    """
    if radius_mm == 0:
        return 0.0
    inside = math.pi / 2 + math.radians(draft_deg)
    turn = math.pi - inside
    tangent = radius_mm / math.tan(inside / 2)
    area = radius_mm * tangent - radius_mm**2 * turn / 2
    # First moments about the outline, u inwards: kite = two triangles; sector about the arc's centre.
    wall_u = tangent * math.cos(inside)
    kite = radius_mm * tangent / 2 * ((tangent + tangent) / 3 + (wall_u + tangent) / 3)
    reach = 2 * radius_mm * math.sin(turn / 2) / (3 * turn / 2)
    sector_u = tangent + reach * math.cos(math.pi / 2 + turn / 2)
    moment = kite - radius_mm**2 * turn / 2 * sector_u
    straight = base.perimeter_mm - 2 * math.pi * base.radius_mm
    return area * straight + 2 * math.pi * (base.radius_mm * area - moment)


def slab_volume_mm3(base: Outline, height_mm: float, draft_deg: float, edge_radius_mm: float) -> float:
    """Volume of a drafted slab with a filleted lower edge, exact for corner radius >= edge radius. [mm3]"""
    whole = drafted_volume_mm3(base, height_mm, draft_deg)
    return whole - edge_fillet_volume_mm3(base, edge_radius_mm, draft_deg)


def best_grid(
    count: int, length_mm: float, width_mm: float, wall_mm: float, border_mm: float, room_mm: tuple[float, ...]
) -> tuple[tuple[float, float], tuple[tuple[float, float], ...]]:
    """How far the outermost middles of cavities in rows are apart, and all middles about the mould's, front row first.

    Of the arrangements that fit a printer's bed the one with the smallest block; its last row may be short. [mm]
    """
    pitch_x_mm, pitch_y_mm = length_mm + wall_mm, width_mm + wall_mm

    def reach(columns: int) -> tuple[float, float]:
        return (columns - 1) * pitch_x_mm, (-(-count // columns) - 1) * pitch_y_mm

    def rank(columns: int) -> tuple[bool, float, int]:
        along, across = (far + side + 2 * border_mm for far, side in zip(reach(columns), (length_mm, width_mm)))
        return Outline(along, across, 0.0).spare_mm(room_mm) < 0.0, along * across, columns

    best = min(range(1, count + 1), key=rank)
    along, across = reach(best)
    return (along, across), tuple(
        (i % best * pitch_x_mm - along / 2, i // best * pitch_y_mm - across / 2) for i in range(count)
    )


def pad_scale(spec: MouldSpec) -> float:
    """Factor from the finished pad to the cold cavity.

    (1 / (1 - shrinkage)) (1 + a_pad dT) / (1 + a_mould dT), dT from room to the temperature at which
    the resin gels: the hot cavity is larger by the expansion of silicone or plastic, the pad shrinks back by its own.
    """
    return cavity_scale(spec.pour, spec.tool.expansion_per_K or 0.0)


def cavity_scale(pour: Pour, expansion_per_K: float) -> float:
    """Factor from a finished casting to its cold cavity in a material of this expansion; see :func:`pad_scale`."""
    warmer = pour.cure_temperature_C - pour.room_temperature_C
    shrink = 1.0 / (1.0 - pour.shrinkage_percent / 100)
    return shrink * (1 + pour.resin_expansion_per_K * warmer) / (1 + expansion_per_K * warmer)


@dataclass(frozen=True)
class PlanPoint:
    """A place in plan. [mm]"""

    x_mm: float
    y_mm: float


@dataclass(frozen=True)
class Funnel(PlanPoint):
    """A sprue or vent through the lid, narrow at the pad so that its stem breaks there. [mm]"""

    small_mm: float
    large_mm: float

    def volume_mm3(self, high_mm: float) -> float:
        """Room in it through a lid of this height. [mm3]"""
        return math.pi / 12 * high_mm * (self.small_mm**2 + self.small_mm * self.large_mm + self.large_mm**2)


@dataclass(frozen=True)
class Layout:
    """Derived dimensions as heights above the cavity's lowest point.

    ``face_mm`` is the flat of the tested face (0 without a crown), where ``floor_outline`` lies;
    ``interface_mm`` the top of the layer poured first (0 without layers) with its outline, ``depth_mm`` the fill
    plane and ``land_mm`` the mould's top face. Outlines up to ``opening`` are those of one cavity about its own middle;
    ``places`` are the middles of all of them, ``openings`` the rectangle that holds their openings. Of ``funnels`` the
    first is the sprue, the others are vents.
    """

    scale: float
    silicone_scale: float
    face_mm: float
    interface_mm: float
    depth_mm: float
    land_mm: float
    floor_outline: Outline
    interface_outline: Outline
    fill_outline: Outline
    brim_outline: Outline
    opening: Outline
    openings: Outline
    top: Outline
    bottom: Outline
    flange: Outline
    height_mm: float
    keys: tuple[PlanPoint, ...]
    funnels: tuple[Funnel, ...]
    label_y_mm: float
    label_room_mm: float
    places: tuple[PlanPoint, ...] = (PlanPoint(0.0, 0.0),)

    def at_places(self, tool: Any) -> list[Any]:
        """A solid of one cavity at the middle of each, one after the other."""
        if len(self.places) == 1:
            return [tool]
        return [tool.translate((point.x_mm, point.y_mm, 0.0)) for point in self.places]


@lru_cache(maxsize=64)
def layout(spec: MouldSpec) -> Layout:
    """Compute the derived dimensions of a specification (see :class:`Layout`)."""
    pad, body, box = spec.pad, spec.body, spec.box
    scale = pad_scale(spec)
    grow = 1.0 if spec.silicone is None else 1.0 / (1.0 - spec.silicone.shrinkage_percent / 100)
    depth = scale * pad.thickness_mm
    k = math.tan(math.radians(pad.draft_deg))
    floor = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm).scaled(scale)
    face = scale * pad.face_height_mm
    fill = floor.grown(k * (depth - face))
    brim = fill.grown(body.brim_step_mm)
    opening = brim.grown(k * body.freeboard_mm)
    land = depth + body.freeboard_mm
    height = land + body.floor_mm
    # Where the outside draws in faster than the cavity, the wall is thinnest at the floor: start wider.
    thinner = math.tan(math.radians(body.outer_draft_deg)) - k
    rim = box.flange_mm if spec.is_printed else box.frame_wall_mm + box.flange_mm
    openings, places = _side_by_side(spec, opening, body.wall_mm + rim)
    wide = openings.grown(body.wall_mm + max(0.0, land * thinner))
    top = Outline(wide.length_mm, wide.width_mm, min(body.outer_corner_radius_mm, wide.radius_mm))
    bottom = top.grown(-height * math.tan(math.radians(body.outer_draft_deg)))
    layers = pad.shape.layers()
    interface = scale * layers[0] if layers else 0.0
    c = spec.closure
    gutter = 0.0 if c is None else c.gutter_distance_mm + c.gutter_radius_mm
    keys = () if c is None else _key_places(spec, c, fill, gutter)
    return Layout(
        scale=scale,
        silicone_scale=grow,
        face_mm=face,
        interface_mm=interface,
        depth_mm=depth,
        land_mm=land,
        floor_outline=floor,
        interface_outline=floor.grown(k * interface),
        fill_outline=fill,
        brim_outline=brim,
        opening=opening,
        openings=openings,
        top=top,
        bottom=bottom,
        flange=top.scaled(grow).grown(rim),
        height_mm=height,
        keys=keys,
        funnels=() if c is None else _funnels(c, fill),
        label_y_mm=-(openings.width_mm / 2 + (gutter + body.wall_mm) / 2),
        label_room_mm=_label_room_mm(c, openings, keys),
        places=places,
    )


def _side_by_side(spec: MouldSpec, opening: Outline, border_mm: float) -> tuple[Outline, tuple[PlanPoint, ...]]:
    """The rectangle that holds the openings of all cavities, and their middles."""
    if spec.count == 1:
        return opening, (PlanPoint(0.0, 0.0),)
    bed, wall = spec.machines.bed_mm, spec.body.wall_mm
    (x, y), middles = best_grid(spec.count, opening.length_mm, opening.width_mm, wall, border_mm, bed)
    held = Outline(opening.length_mm + x, opening.width_mm + y, opening.radius_mm)
    return held, tuple(PlanPoint(*middle) for middle in middles)


def _key_places(spec: MouldSpec, c: Closure, fill: Outline, gutter_mm: float) -> tuple[PlanPoint, ...]:
    """Place keys at the corners, one shifted, so that the lid fits in one way only."""
    x = fill.length_mm / 2 + spec.body.wall_mm / 2 + 0.5
    y = fill.width_mm / 2 + (gutter_mm + spec.body.wall_mm) / 2
    return PlanPoint(x, y), PlanPoint(x, -y), PlanPoint(-x, -y), PlanPoint(-x + c.key_shift_mm, y)


def _funnels(c: Closure, fill: Outline) -> tuple[Funnel, ...]:
    """Place the sprue at one end, a vent at the other and one in every corner."""
    x, y = fill.length_mm / 2 - c.vent_inset_mm, fill.width_mm / 2 - c.vent_inset_mm
    sprue = Funnel(-(fill.length_mm / 2 - c.sprue_inset_mm), 0.0, c.sprue_small_mm, c.sprue_large_mm)
    vents = ((x, 0.0), (x, y), (x, -y), (-x, y), (-x, -y))
    return sprue, *(Funnel(*centre, c.vent_small_mm, c.vent_large_mm) for centre in vents)


def _label_room_mm(c: Closure | None, opening: Outline, keys: tuple[PlanPoint, ...]) -> float:
    """Length that is free for the label on the land's front side. [mm]"""
    if c is None:
        return opening.length_mm - 4.0
    front = min(abs(key.x_mm) for key in keys if key.y_mm < 0)
    return 2 * (front - c.key_radius_mm - c.key_clearance_mm) - 4.0


def bed_spare_mm(machines: Machines, part: Outline, height_mm: float) -> float:
    """Room that a printed part leaves on the bed within its margin, or under the printer's height. [mm]"""
    return min(part.spare_mm(machines.bed_mm), machines.printer_height_mm - height_mm)


BACKER_PLAY_MM = 2.0
"""How much wider a hole of the backer is than the sprue or vent under it."""
DOWEL_MM = 4.0
"""Diameter of the two steel pins that keep ring and base in line."""
# The second pin stands off the first one's mirror image, so that the ring goes on in one way.
SHIFT_MM = 3.0


def parting_mm(spec: MouldSpec, plan: Layout) -> float:
    """Height at which ring and base meet: over the rounding of the tested face's edge, off the tested face."""
    return plan.face_mm + spec.pad.edge_radius_mm * plan.scale


def _line(spec: MouldSpec, plan: Layout) -> tuple[float, float]:
    inset = spec.box.flange_mm / 2
    return plan.flange.length_mm / 2 - inset, plan.flange.width_mm / 2 - inset


def dowel_places(spec: MouldSpec, plan: Layout) -> tuple[PlanPoint, ...]:
    """Two pins in the front flange."""
    x, y = _line(spec, plan)
    return PlanPoint(x / 2, -y), PlanPoint(-x / 2 + SHIFT_MM, -y)


def level_places(spec: MouldSpec, plan: Layout) -> tuple[PlanPoint, ...]:
    """Three screws to level by, off the bolts in corners and middles."""
    x, y = _line(spec, plan)
    return PlanPoint(x, -y / 2), PlanPoint(-x, -y / 2), PlanPoint(x / 3, y)


STEP_MM = 0.5


def sheet_outline(spec: MouldSpec, plan: Layout) -> Outline:
    """Outline to cut the sheet to: within the flat of the tested face, a rim of plastic around it, in half millimetres.

    A rectangle keeps its sharp corners, so near a round corner of the face it stays further inside; a round face takes
    a round sheet.
    """
    face = plan.floor_outline.scaled(plan.silicone_scale)
    inset = spec.pad.edge_radius_mm * plan.scale * plan.silicone_scale + spec.box.sheet_rim_mm
    if face.is_circle:
        across = _step(face.length_mm - 2 * inset)
        return Outline(across, across, across / 2)
    if face.radius_mm > inset:
        inset = max(inset, face.radius_mm - (face.radius_mm - inset) / math.sqrt(2))
    return Outline(_step(face.length_mm - 2 * inset), _step(face.width_mm - 2 * inset), 0.0)


def recess_outline(spec: MouldSpec, plan: Layout) -> Outline:
    """Pocket in the plug: the sheet and the gap of the machine's prints on each side."""
    sheet, gap = sheet_outline(spec, plan), spec.machines.gap_mm
    return sheet.grown(gap) if sheet.is_circle else Outline(sheet.length_mm + 2 * gap, sheet.width_mm + 2 * gap, 0.0)


def plug_top_mm(plan: Layout) -> float:
    """Height of the plug over the base plate. [mm]"""
    return plan.land_mm * plan.silicone_scale


def _step(length_mm: float) -> float:
    return math.floor(length_mm / STEP_MM) * STEP_MM


def cavity_volume_mm3(spec: MouldSpec) -> float:
    """Room in the mould up to the fill plane, a bone's room included: drafted slab and what its top adds. [mm3]

    See :func:`dummydesign.mold.model.layout.slab_volume_mm3`.
    """
    plan, pad = layout(spec), spec.pad
    flat = _slab_mm3(spec, plan.depth_mm - plan.face_mm)
    return flat + plan.scale**3 * pad.shape.top_volume_mm3(pad)


def _slab_mm3(spec: MouldSpec, height_mm: float) -> float:
    plan, pad = layout(spec), spec.pad
    return slab_volume_mm3(plan.floor_outline, height_mm, pad.draft_deg, pad.edge_radius_mm * plan.scale)


def resin_volume_mm3(spec: MouldSpec) -> float:
    """Resin of the pad in the cold cavity: the cavity less the bone. [mm3]"""
    return cavity_volume_mm3(spec) - layout(spec).scale ** 3 * bone_volume_mm3(spec)


def bone_volume_mm3(spec: MouldSpec) -> float:
    """The finished bone in the gel: dome or bar in closed form. [mm3]"""
    return spec.pad.shape.bone_volume_mm3(spec.pad)


def layer_volumes_mm3(spec: MouldSpec) -> tuple[float, float]:
    """Volumes of the upper layer (at the mould's floor, poured first) and of the base layer. [mm3]"""
    upper = _slab_mm3(spec, layout(spec).interface_mm)
    return upper, cavity_volume_mm3(spec) - upper


def mould_volume_mm3(spec: MouldSpec) -> float:
    """Silicone of a mould: block less cavities, brims, and what its lid needs; the label is neglected. [mm3]"""
    plan, c = layout(spec), spec.closure
    block = drafted_volume_mm3(plan.bottom, plan.height_mm, spec.body.outer_draft_deg)
    brim = drafted_volume_mm3(plan.brim_outline, spec.body.freeboard_mm, spec.pad.draft_deg)
    block -= spec.count * (cavity_volume_mm3(spec) + brim)
    if c is None:
        return block
    gutter = math.pi / 2 * c.gutter_radius_mm**2 * plan.fill_outline.grown(c.gutter_distance_mm).perimeter_mm
    return block - gutter - _half_balls_mm3(plan, c.key_radius_mm + c.key_clearance_mm)


def lid_volume_mm3(spec: MouldSpec) -> float:
    """Silicone of the lid with its keys, less sprue and vents; 0 without a lid. [mm3]"""
    plan, c = layout(spec), spec.closure
    if c is None:
        return 0.0
    hull = drafted_volume_mm3(plan.top, c.lid_mm, -spec.body.outer_draft_deg)
    return hull + _half_balls_mm3(plan, c.key_radius_mm) - sum(one.volume_mm3(c.lid_mm) for one in plan.funnels)


def _half_balls_mm3(plan: Layout, radius_mm: float) -> float:
    return len(plan.keys) * 2 / 3 * math.pi * radius_mm**3
