"""Where everything sits: all derived dimensions of a mould, computed once from its specification; no CAD.

Mould frame: z = 0 is the cavity's lowest point (the tested face, or the tip of its crown), +z points out of the
cavity, the origin is the pad's middle. All lengths are those of the cold mould. [mm]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.several.grid import best_grid


def pad_scale(spec: MouldSpec) -> float:
    """Factor from the finished pad to the cold cavity.

    (1 / (1 - shrinkage)) (1 + a_pad dT) / (1 + a_mould dT), dT from room to the temperature at which
    the resin gels: the hot cavity is larger by the expansion of silicone or plastic, the pad shrinks back by its own.
    """
    warmer = spec.pour.cure_temperature_C - spec.pour.room_temperature_C
    shrink = 1.0 / (1.0 - spec.pour.shrinkage_percent / 100)
    return shrink * (1 + spec.pour.resin_expansion_per_K * warmer) / (1 + (spec.tool.expansion_per_K or 0.0) * warmer)


def silicone_scale(spec: MouldSpec) -> float:
    """Factor from the silicone mould to the rigid master: 1 / (1 - shrinkage of the silicone); 1 without silicone."""
    if spec.silicone is None:
        return 1.0
    return 1.0 / (1.0 - spec.silicone.shrinkage_percent / 100)


@dataclass(frozen=True)
class Point:
    """A place in plan. [mm]"""

    x_mm: float
    y_mm: float


@dataclass(frozen=True)
class Layout:
    """Derived dimensions as heights above the cavity's lowest point.

    ``face_mm`` is the flat of the tested face (0 without a crown), where ``floor_outline`` lies;
    ``interface_mm`` the top of the layer poured first (0 without layers) with its outline, ``depth_mm`` the fill
    plane and ``land_mm`` the mould's top face. Outlines up to ``opening`` are those of one cavity about its own middle;
    ``places`` are the middles of all of them, ``openings`` the rectangle that holds their openings.
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
    keys: tuple[Point, ...]
    sprue: Point | None
    vents: tuple[Point, ...]
    label_y_mm: float
    label_room_mm: float
    places: tuple[Point, ...] = (Point(0.0, 0.0),)

    def at_places(self, tool: Any) -> list[Any]:
        """A solid of one cavity at the middle of each, one after the other."""
        if len(self.places) == 1:
            return [tool]
        return [tool.translate((place.x_mm, place.y_mm, 0.0)) for place in self.places]


def layout(spec: MouldSpec) -> Layout:
    """Compute the derived dimensions of a specification (see :class:`Layout`)."""
    pad, body, box = spec.pad, spec.body, spec.box
    scale, grow = pad_scale(spec), silicone_scale(spec)
    depth = scale * pad.thickness_mm
    k = math.tan(math.radians(pad.draft_deg))
    nominal = Outline(pad.length_mm, pad.width_mm, pad.corner_radius_mm)
    floor = nominal.scaled(scale)
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
    keys, sprue, vents = _closure_places(spec, fill)
    strip_in = _gutter_reach(spec)
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
        sprue=sprue,
        vents=vents,
        label_y_mm=-(openings.width_mm / 2 + (strip_in + body.wall_mm) / 2),
        label_room_mm=_label_room(spec, openings, keys),
        places=places,
    )


def _side_by_side(spec: MouldSpec, opening: Outline, border_mm: float) -> tuple[Outline, tuple[Point, ...]]:
    """The rectangle that holds the openings of all cavities, and their middles."""
    if spec.count == 1:
        return opening, (Point(0.0, 0.0),)
    m = spec.machines
    bed = (m.bed_x_mm - 2 * m.bed_margin_mm, m.bed_y_mm - 2 * m.bed_margin_mm)
    grid = best_grid(spec.count, opening.length_mm, opening.width_mm, spec.body.wall_mm, border_mm, bed)
    x, y = grid.reach_mm
    held = Outline(opening.length_mm + x, opening.width_mm + y, opening.radius_mm)
    return held, tuple(Point(*place) for place in grid.places_mm)


def _gutter_reach(spec: MouldSpec) -> float:
    """Distance from the opening to the outer side of the gutter, 0 without one. [mm]"""
    c = spec.closure
    return 0.0 if c is None else c.gutter_distance_mm + c.gutter_radius_mm


def _closure_places(spec: MouldSpec, fill: Outline) -> tuple[tuple[Point, ...], Point | None, tuple[Point, ...]]:
    """Keys at the corners (one shifted, so that only one assembly is possible), sprue and vents."""
    c = spec.closure
    if c is None:
        return (), None, ()
    x = fill.length_mm / 2 + spec.body.wall_mm / 2 + 0.5
    y = fill.width_mm / 2 + (_gutter_reach(spec) + spec.body.wall_mm) / 2
    keys = (Point(x, y), Point(x, -y), Point(-x, -y), Point(-x + c.key_shift_mm, y))
    sx = fill.length_mm / 2 - c.sprue_inset_mm
    vx, vy = fill.length_mm / 2 - c.vent_inset_mm, fill.width_mm / 2 - c.vent_inset_mm
    vents = (Point(vx, 0.0), Point(vx, vy), Point(vx, -vy), Point(-vx, vy), Point(-vx, -vy))
    return keys, Point(-sx, 0.0), vents


def _label_room(spec: MouldSpec, opening: Outline, keys: tuple[Point, ...]) -> float:
    """Length that is free for the label on the land's front side. [mm]"""
    front = [abs(key.x_mm) for key in keys if key.y_mm < 0]
    if front:
        reach = min(front) - spec.closure.key_radius_mm - spec.closure.key_clearance_mm
        return 2 * reach - 4.0
    return opening.length_mm - 4.0
