"""A pad cut through its highest point, to scale, with its dimensions, the punch that presses it and its base."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch

Point = tuple[float, float]
SCALES = (20.0, 15.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.8, 0.5, 0.4, 0.3, 0.25, 0.2, 0.1)
SIDE_MM, ABOVE_MM, BELOW_MM = 17.0, 8.0, 14.0
"""Room for dimensions at each side, for the punch above the tip, and for base and widths below. [mm]"""
SIZE_MM, HEAD_MM, TAIL_MM = 2.6, 1.6, 1.2
SIZE = (111.6, 58.0)
"""Width and height of the drawing. [mm]"""
INK, SOFT, RULE = "#1b232b", "#4f5b66", "#c9d1d8"
GEL, LOWER_GEL, HARD, STEEL = "#dbe8f5", "#b9cfe4", "#8d99a5", "#e3e7eb"
POINTS = 401


def _path(
    points: Sequence[Point],
    stroke: str | None = INK,
    fill: str | None = None,
    width_mm: float = 0.25,
    dash_mm: Sequence[float] = (),
) -> str:
    """A run of straight pieces, or the area inside when it is filled."""
    run = "L".join(f"{x:.3f} {y:.3f}" for x, y in points)
    dash = f' stroke-dasharray="{" ".join(f"{d:g}" for d in dash_mm)}"' if dash_mm else ""
    line = f' stroke="{stroke}" stroke-width="{width_mm:g}"{dash}' if stroke else ""
    return f'<path d="M{run}{"Z" if fill else ""}" fill="{fill or "none"}"{line}/>'


def _text(x: float, y: float, words: str, anchor: str = "start", colour: str = INK) -> str:
    """Words at the start, middle or end of their line; y is that of the base line."""
    return (
        f'<text x="{x:.2f}" y="{y:.2f}" font-size="{SIZE_MM}" font-family="Liberation Sans" '
        f'text-anchor="{anchor}" fill="{colour}">{escape(words)}</text>'
    )


def pad_section(
    shape: PadShape, thickness_mm: float, pad_mm: tuple[float, float], punch: Punch, condition: str = ""
) -> dict[str, Any]:
    """Return the section of a pad as SVG, with its height [mm] and words for those who cannot see it.

    Parameters
    ----------
    shape : PadShape
        Of the pad; one whose profile runs along the length is cut across.
    thickness_mm, pad_mm : float, tuple of float
        Thickness at the highest point, length and width. [mm]
    punch : Punch
        Drawn at first touch.
    condition : str
        How the pad lies on its base, written under it.
    """
    wide, high = SIZE
    edge = 0.5 * (pad_mm[1] if shape.runs_out else pad_mm[0])
    foot = _foot(shape, edge)
    half = min(max(1.35 * foot, 1.4 * punch.half_width_mm, 1.2 * thickness_mm, 8.0), edge)
    room = 0.5 * wide - SIDE_MM, high - ABOVE_MM - BELOW_MM
    scale = next((s for s in SCALES if s * half <= room[0] and s * thickness_mm <= room[1]), SCALES[-1])
    axis, ground = 0.5 * wide, ABOVE_MM + 0.5 * (room[1] + scale * thickness_mm)
    x = np.union1d(np.linspace(-half, half, POINTS), [-foot, 0.0, foot])
    face, bone = thickness_mm - _height(shape.drop_mm, shape, x), _height(shape.bone_mm, shape, x)

    def at(across: float, up: float) -> Point:
        return axis + scale * across, ground - scale * up

    def run(heights: NDArray) -> tuple[Point, ...]:
        return tuple(at(float(a), float(b)) for a, b in zip(x, heights))

    ends = (at(half, 0.0), at(-half, 0.0))
    items: list[str] = [_path((*run(face), *ends), None, GEL)]
    layers = shape.layers()
    if layers is not None:
        lower = thickness_mm - layers[0]
        items.append(_path((at(-half, lower), at(half, lower), *ends), SOFT, LOWER_GEL, 0.2))
    if bone.max() > 0.0:
        items.append(_path((*run(bone), *ends), INK, HARD, 0.25))
    items += _dimensions(shape, thickness_mm, float(face[-1]), foot, half, at)
    items += [_path(run(face), INK, width_mm=0.45), *_base(at(-half, 0.0), at(half, 0.0))]
    for side in (-half, half):
        top = float(face[-1])
        items.append(
            _path((at(side, 0.0), at(side, top)), INK, width_mm=0.35)
            if half >= edge
            else _break(at(side, 0.0), at(side, top))
        )
    items += _punch(punch, at, thickness_mm)
    items.append(_path((at(0.0, 0.0), (axis, 0.0)), SOFT, None, 0.15, (3.0, 0.8, 0.6, 0.8)))
    items += _radius(shape, thickness_mm, foot, half, at)
    words = f"scale {scale:g}:1" if scale >= 1.0 else f"scale 1:{1.0 / scale:g}"
    items.append(_text(0.0, high - 1.0, f"{condition}; {words}" if condition else words, colour=SOFT))
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}mm" height="{high}mm" viewBox="0 0 {wide} {high}">'
    alt = f"Section of the pad, {shape.title}, {thickness_mm:g} mm thick, under the punch {punch.text}."
    return {"svg": f"{svg}{''.join(items)}</svg>", "high": high, "alt": alt}


def _height(of: Callable[[NDArray, NDArray], NDArray], shape: PadShape, x: NDArray) -> NDArray:
    """A height field along the cut: across what runs along the length. [mm]"""
    still = np.zeros_like(x)
    return of(still, x) if shape.runs_out else of(x, still)


def _foot(shape: PadShape, edge: float) -> float:
    """Distance from the axis at which the face is flat and the bone ends; 0 of a flat pad. [mm]"""
    x = np.linspace(0.0, edge, 4001)
    curved = np.abs(_height(shape.drop_mm, shape, x) - _height(shape.drop_mm, shape, x)[-1]) > 1e-6
    curved |= _height(shape.bone_mm, shape, x) > 1e-6
    foot = float(x[np.flatnonzero(curved)[-1]]) if curved.any() else 0.0
    return min((line for line in shape.lines_mm() if abs(line - foot) < 0.05), default=foot)


def _base(left: Point, right: Point) -> list[str]:
    """The base plane with its hatch."""
    wide = right[0] - left[0]
    count = max(int(wide / 2.2), 2)
    ticks = [left[0] + wide * (k + 0.7) / count for k in range(count)]
    return [
        _path((left, right), INK, width_mm=0.5),
        *(_path(((x, left[1]), (x - 1.4, left[1] + 1.6)), SOFT, width_mm=0.15) for x in ticks),
    ]


def _break(low: Point, high: Point) -> str:
    """A line that shows that the pad goes on."""
    (x, bottom), top = low, high[1]
    middle, kink = 0.5 * (bottom + top), min(0.12 * (bottom - top), 1.4)
    run = ((x, bottom), (x, middle + kink), (x - kink, middle + 0.4 * kink), (x + kink, middle - 0.4 * kink),
           (x, middle - kink), (x, top))  # fmt: skip
    return _path(run, SOFT, width_mm=0.2)


def _punch(punch: Punch, at: Callable[[float, float], Point], thickness_mm: float) -> list[str]:
    """The punch at first touch, up to the top of the drawing."""
    r, z = ([0.0, punch.half_width_mm], [0.0, 0.0]) if punch.profile_mm is None else punch.profile_mm
    out, up = np.asarray(r), thickness_mm + np.asarray(z)
    points = [at(float(a), float(b)) for a, b in zip([*-out[::-1], *out], [*up[::-1], *up])]
    points = [(a, b) for a, b in points if b >= 1.0]
    (first, _), (last, _) = points[0], points[-1]
    kind, _, size = punch.text.partition(":")
    words = "punch" if kind == "profile" else f"punch {size} x {size}" if punch.square else f"{kind} punch {size}"
    label = _text(last + 1.5, 3.2, words, colour=SOFT)
    return [_path((*points, (last, 0.0), (first, 0.0)), SOFT, STEEL, 0.2), label]


def _dimensions(
    shape: PadShape,
    thickness_mm: float,
    flat_mm: float,
    foot: float,
    half: float,
    at: Callable[[float, float], Point],
) -> list[str]:
    """Thicknesses left and right, widths below, the radius at the tip."""
    items = _measure(at(0.0, thickness_mm), at(0.0, 0.0), at(-half, 0.0)[0] - 6.0, "left", _number(thickness_mm))
    layers = shape.layers()
    x = at(half, 0.0)[0] + 5.0
    rights: list[tuple[float, float]] = []
    if flat_mm < thickness_mm - 1e-6:
        rights = [(0.0, flat_mm), (flat_mm, thickness_mm)]
    elif layers is not None:
        rights = [(0.0, thickness_mm - layers[0]), (thickness_mm - layers[0], thickness_mm)]
    elif shape.bone_height_mm > 0.0:
        rights = [(0.0, shape.bone_height_mm), (shape.bone_height_mm, thickness_mm)]
    for lower, upper in rights:
        starts = half if not shape.bone_height_mm else 0.0
        ends = at(0.0 if upper == thickness_mm and shape.relief_mm else starts, upper), at(starts, lower)
        items += _measure(*ends, x, "right", _number(upper - lower))
    if foot:
        y = at(0.0, 0.0)[1] + 6.0
        items += _width(at(0.0, 0.0), at(foot, 0.0 if shape.bone_height_mm else flat_mm), y, _number(foot))
    return items


def _radius(
    shape: PadShape, thickness_mm: float, foot: float, half: float, at: Callable[[float, float], Point]
) -> list[str]:
    """The radius of the tip or of the bone, on a line to it."""
    radius = shape.tip_radius_mm or (getattr(shape, "radius_mm", None) if shape.bone_height_mm else None)
    if not radius:
        return []
    share = 0.55 * foot
    height = (
        _height(shape.bone_mm, shape, np.array([share]))[0]
        if shape.bone_height_mm
        else thickness_mm - _height(shape.drop_mm, shape, np.array([share]))[0]
    )
    end = at(-0.85 * half, 0.0)[0] - 2.0, at(0.0, thickness_mm)[1] - 3.5
    return [
        _path((at(-share, float(height)), end), SOFT, width_mm=0.15),
        _text(end[0], end[1] - 0.6, f"R {_number(radius)}", anchor="middle"),
    ]


def _number(value: float) -> str:
    """A length as it is drawn: hundredths at most."""
    return f"{round(value, 2):g}"


def _arrow(tip: Point, turn: float) -> str:
    """A head that points to its tip; the angle is that of its shaft. [rad]"""
    sides = [(tip[0] + HEAD_MM * math.cos(turn + way), tip[1] + HEAD_MM * math.sin(turn + way)) for way in (-0.2, 0.2)]
    return _path((tip, *sides), None, INK)


def _measure(top: Point, bottom: Point, x: float, side: str, words: str) -> list[str]:
    """A height between two points, its line at a place beside them; short ones have their arrows outside."""
    (_, high), (_, low) = top, bottom
    reach = 1.0 if side == "right" else -1.0
    items: list[str] = [
        _path(((end[0] + 0.6 * reach, end[1]), (x + TAIL_MM * reach, end[1])), RULE, width_mm=0.2)
        for end in (top, bottom)
    ]
    inside = low - high > 3.0 * HEAD_MM
    start, stop = (high, low) if inside else (high - 3.0, low + 3.0)
    items.append(_path(((x, start), (x, stop)), INK, width_mm=0.18))
    down, up = 0.5 * math.pi, -0.5 * math.pi
    items += [_arrow((x, high), down if inside else up), _arrow((x, low), up if inside else down)]
    anchor = "start" if side == "right" else "end"
    return [*items, _text(x + 1.2 * reach, 0.5 * (high + low) + 0.9, words, anchor=anchor)]


def _width(left: Point, right: Point, y: float, words: str) -> list[str]:
    """A width between two points, its line under them."""
    items: list[str] = [_path(((x, up + 0.6), (x, y + TAIL_MM)), RULE, width_mm=0.2) for x, up in (left, right)]
    items.append(_path(((left[0], y), (right[0], y)), INK, width_mm=0.18))
    items += [_arrow((left[0], y), 0.0), _arrow((right[0], y), math.pi)]
    return [*items, _text(0.5 * (left[0] + right[0]), y + 3.2, words, anchor="middle")]
