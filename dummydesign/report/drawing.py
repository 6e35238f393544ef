"""What a first page draws: a plot as ``plot.typ`` reads it, runs of points in shares of the axes, numbers at their
places, names of curves; a pad cut through its highest point, to scale, with its dimensions, punch and base."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.typeset import typeset
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch
from dummydesign.mold.files.drawing_layout import SCALES, Measure, View, lay_out_view, put, ratio
from dummydesign.mold.files.drawing_sheet import Drawing, Point, number_text, to_svg
from dummydesign.report.plot import Plot, Series, bar_places, thin

MOST_DOTS, MOST_ACROSS, MOST_NAMES = 40, 5, 12


def picture(title: str, plots: Sequence[Plot]) -> bytes:
    """Plots side by side, their areas named, as PNG."""
    areas = (dict.fromkeys(part.label for part in one.series if part.kind == "band" and part.seen) for one in plots)
    shown = [
        {"title": f"{one.title}; area: {'; '.join(names)}" if names else one.title, **plot_drawing(one)}
        for one, names in zip(plots, areas)
    ]
    return typeset(Path(__file__).with_name("plots.typ"), {"title": title, "plots": shown}, "png")


def plot_drawing(plot: Plot) -> dict[str, Any]:
    """Return a plot with the labels of its axes and the names of its curves."""
    labels = {"x_label": plot.x_label, "y_label": plot.y_label}
    return {"plot": draw_plot(plot, 6, named=True) | labels}


def draw_plot(
    plot: Plot,
    most_numbers: int,
    y_range: tuple[float, float] | None = None,
    unit: str = "",
    named: bool = False,
    words: str = "",
) -> dict[str, Any]:
    """Return bands, curves, points and bars of a plot inside their axes; maps, ellipses and words are left out.

    Parameters
    ----------
    plot : Plot
        Its ranges are those of the report.
    most_numbers : int
        Of intervals between the numbers of y.
    y_range : tuple of float, optional
        Instead of the plot's own.
    unit : str
        Written behind the last number of the x-axis.
    named : bool
        Whether the names of the curves stand right of the axes, at the height of their ends.
    words : str
        Written into the axes.

    Returns
    -------
    dict
        What ``plot.typ`` reads.
    """
    shown = [one for one in plot.series if one.kind in ("band", "line", "dots", "bars") and one.seen]
    shown.sort(key=lambda one: ("band", "bars", "line", "dots").index(one.kind))
    bars = next((one for one in shown if one.kind == "bars"), None)
    x_all, y_all = (np.concatenate([[]] + [one.extent()[side] for one in shown]) for side in (0, 1))
    x_axis = _Axis(x_all, plot.x_range, plot.zero and bars is None and not plot.log_x, plot.log_x)
    y_axis = _Axis(y_all, y_range or plot.y_range, plot.zero and bars is None)
    across = [(at, f"{value:g}") for at, value in x_axis.ticks(MOST_ACROSS)]
    across = across[::2] if len(across) > MOST_ACROSS + 1 else across
    across[-1:] = [(at, f"{number}{unit}") for at, number in across[-1:]]
    along = [(at, f"{value:g}") for at, value in y_axis.ticks(most_numbers)]
    if bars is not None:
        along = [(float(y_axis(place)), name) for place, name in zip(bar_places(bars), bars.names)]
    drawn = [{"kind": one.kind, "style": one.style, "runs": _runs(one, x_axis, y_axis)} for one in shown]
    ends = {
        one.label: {"name": one.label, "style": one.style, "at": made["runs"][-1][-1][1]}
        for one, made in zip(shown, drawn)
        if one.kind in ("line", "dots") and made["runs"]
    }
    return {
        "alt": plot.alt or plot.title or plot.name,
        "x": across,
        "y": along,
        "series": drawn,
        "names": [*ends.values()] if named and len(ends) <= MOST_NAMES else [],
        "bars": bars is not None,
        "words": words,
        "x_label": "",
        "y_label": "",
    }


class _Axis:
    """An axis over values: from its given ends, else with a margin, from zero where it may be.

    Calling it gives the shares of the axis at which values lie.
    """

    def __init__(
        self, values: NDArray, given: tuple[float, float] | None, zero: bool = False, log: bool = False
    ) -> None:
        known = values[np.isfinite(values) & (values > (0.0 if log else -np.inf))] if given is None else np.array(given)
        known = np.log10(known) if log else known
        self.low, self.high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        self.log = log
        if given is None or self.low == self.high:
            margin = 0.05 * (self.high - self.low) or 0.05 * abs(self.high) or 1.0
            self.low = 0.0 if zero and self.low >= 0.0 else self.low - margin
            self.high += margin

    def __call__(self, values: NDArray) -> NDArray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.round(
                ((np.log10(np.maximum(values, 1e-12)) if self.log else values) - self.low) / (self.high - self.low), 5
            )

    def ticks(self, most: int) -> list[tuple[float, float]]:
        """Shares and values of round numbers, at most so many intervals; on a logarithmic axis of powers of ten."""
        power = 10.0 ** math.floor(math.log10((self.high - self.low) / most))
        steps = (factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0))
        step = 1.0 if self.log else next(one for one in steps if one * most >= (self.high - self.low) * (1 - 1e-9))
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        values = [number * step for number in range(first, last + 1)]
        return [((one - self.low) / (self.high - self.low), 10.0**one if self.log else one) for one in values]


def _runs(one: Series, x_axis: _Axis, y_axis: _Axis) -> list[list[list[float]]]:
    """Points of each part of a series between its gaps; of a band and of bars those around the area."""
    if one.kind == "bars":
        corners = ((one.low, -0.3), (one.high, -0.3), (one.high, 0.3), (one.low, 0.3))
        points = [np.c_[x_axis(end), y_axis(bar_places(one) + half)] for end, half in corners]
        return np.stack(points, axis=1).tolist()
    place = one.y if one.sideways else one.x
    columns = np.array([place, one.low, one.high] if one.kind == "band" else [one.x, one.y])
    known = np.isfinite(columns).all(axis=0)
    edges = np.flatnonzero(np.diff(np.r_[False, known, False])).reshape(-1, 2)
    log = x_axis.log and not one.sideways
    runs = []
    for begin, end in edges:
        most = {"most": MOST_DOTS} if one.kind == "dots" else {}
        at, *ends = thin(columns[0, begin:end], log, *columns[1:, begin:end], **most)
        if one.kind == "band":
            at, ends = np.r_[at, at[::-1]], [np.r_[ends[0], ends[1][::-1]]]
        x, y = (ends[0], at) if one.sideways else (at, ends[0])
        runs.append(np.c_[x_axis(x), y_axis(y)].tolist())
    return runs


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
