"""A pad cut through its highest point, to scale, with its dimensions, the punch that presses it and its base."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch
from dummydesign.mold.files.drawing_layout import SCALES, Measure, View, lay_out_view, put, ratio
from dummydesign.mold.files.drawing_sheet import Drawing, Point, number_text, to_svg

SIZE = (111.6, 58.0)
"""Width and height of the drawing. [mm]"""
POINTS = 401
SHOWN_MM, TICK_MM, KINK_MM = 7.0, 1.6, 1.4
"""On the drawing: how much of the punch is shown, the base's hatch, the kink of a side where the pad goes on. [mm]"""


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
        How the pad lies on its base, written above it.
    """
    edge, (wide, high) = 0.5 * (pad_mm[1] if shape.runs_out else pad_mm[0]), SIZE
    for scale in SCALES:
        placed = lay_out_view(_view(shape, thickness_mm, edge, punch, condition, scale), scale)
        if placed.width <= wide and placed.height <= high:
            break
    words = f"Section of the pad, {shape.title}, {thickness_mm:g} mm thick, under the punch {punch.text}."
    sheet, (left, low, right, top) = Drawing(words, scale), placed.box
    put(sheet, placed, (0.5 * (wide - left - right), 0.5 * (high - low - top)))
    return {"svg": to_svg(sheet, SIZE), "high": high, "alt": words}


def _view(shape: PadShape, thickness_mm: float, edge: float, punch: Punch, condition: str, scale: float) -> View:
    """The section in its own coordinates: from its axis, and from its base up."""
    foot = _foot(shape, edge)
    half = min(max(1.35 * foot, 1.4 * punch.half_width_mm, 1.2 * thickness_mm, 8.0), edge)
    x = np.union1d(np.linspace(-half, half, POINTS), [-foot, 0.0, foot])
    face, bone = thickness_mm - _height(shape.drop_mm, shape, x), _height(shape.bone_mm, shape, x)
    flat, top, tick = float(face[-1]), thickness_mm + SHOWN_MM / scale, TICK_MM / scale
    layers, ends, boned = shape.layers(), ((half, 0.0), (-half, 0.0)), bool(bone.max() > 0.0)
    lower = shape.bone_height_mm if layers is None else thickness_mm - layers[0]

    def run(heights: NDArray) -> tuple[Point, ...]:
        return tuple(zip(x.tolist(), heights.tolist()))

    runs = [((*run(face), *ends), "gel")]
    runs += [(((-half, lower), (half, lower), *ends), "lower gel")] if layers is not None else []
    runs += [((*run(bone), *ends), "hard")] if boned else []
    runs += [(_punch(punch, thickness_mm, top), "steel"), (run(face), "outline"), (ends, "outline")]
    runs += [(((at, 0.0), (at - tick, -tick)), "hatch") for at in np.arange(-half + tick, half, 1.4 * tick).tolist()]
    runs += [(_side(side, flat, 0.0 if half >= edge else KINK_MM / scale), "thin") for side in (-half, half)]
    runs.append((((0.0, 0.0), (0.0, top)), "thin"))
    # all heights on one side: the line to the radius crosses none
    measures = [Measure((0.0, thickness_mm), (0.0, 0.0), "right")]
    if flat < thickness_mm - 1e-6:
        measures += [Measure((half, 0.0), (half, flat), "right"), Measure((half, flat), (0.0, thickness_mm), "right")]
    elif lower > 0.0:
        measures += [Measure((0.0, 0.0), (0.0, lower), "right"), Measure((0.0, lower), (half, thickness_mm), "right")]
    measures += [Measure((0.0, 0.0), (foot, 0.0 if boned else flat), "below")] if foot else []
    at, radius = -0.55 * foot, shape.tip_radius_mm or (getattr(shape, "radius_mm", None) if boned else None)
    leaders = (((at, float(np.interp(at, x, bone if boned else face))), f"R {number_text(radius)}"),) if radius else ()
    kind, _, size = punch.text.partition(":")
    pressed = "punch" if kind == "profile" else f"punch {size} x {size}" if punch.square else f"{kind} punch {size}"
    name = "; ".join(words for words in (pressed, condition, f"scale {ratio(scale)}") if words)
    return View(name, tuple(runs), tuple(measures), leaders)


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


def _side(x: float, high: float, kink: float) -> tuple[Point, ...]:
    """A side of the pad; with a kink in its middle where the pad goes on."""
    middle, kink = 0.5 * high, min(kink, 0.12 * high)
    inner = ((x - kink, middle - 0.4 * kink), (x + kink, middle + 0.4 * kink))
    return ((x, 0.0), (x, middle - kink), *inner, (x, middle + kink), (x, high))


def _punch(punch: Punch, foot_mm: float, top_mm: float) -> tuple[Point, ...]:
    """The punch at first touch, as much of it as is shown."""
    out, up = ([0.0, punch.half_width_mm], [0.0, 0.0]) if punch.profile_mm is None else punch.profile_mm
    right = [(float(a), foot_mm + float(b)) for a, b in zip(out, up) if foot_mm + b <= top_mm]
    right.append((right[-1][0], top_mm))
    return (*((-a, b) for a, b in right[::-1]), *right)
