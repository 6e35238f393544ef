"""A plot drawn on a sheet: the same axes, bands, curves, points and bars as in the report, in millimetres."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import true_runs
from dummydesign.report.plot import Plot, Series
from dummydesign.report.vector_sheet import (
    BAND,
    PAPER,
    PITCH,
    PT_MM,
    RULE,
    SOFT,
    STYLES,
    Box,
    Item,
    Path,
    Text,
    rectangle,
    shortened,
    text_width_mm,
)

UNSEEN_MM, DOT_MM, MOST_DOTS = 0.02, 0.45, 40
PX_PER_MM = 4.0


LETTER_WIDTH = 7.0
"""Mean width of a letter of an axis. [px]"""


@dataclass(frozen=True)
class Axis:
    """One axis: label with unit, range of values, places of its ends, linear or logarithmic."""

    label: str
    low: float
    high: float
    start: float
    stop: float
    log: bool = False

    def position(self, value: float) -> float:
        """Position of a value along the axis."""
        return float(self.positions(np.float64(value)))

    def positions(self, values: NDArray | np.float64) -> NDArray:
        """Positions of values along the axis; those outside are put a little outside, NaN stays."""
        if self.log:
            share = np.log(np.maximum(values, 1e-300) / self.low) / math.log(self.high / self.low)
        else:
            share = (values - self.low) / (self.high - self.low)
        return self.start + np.clip(share, -1.0, 2.0) * (self.stop - self.start)

    def ticks(self, about: int = 5) -> list[tuple[float, str]]:
        """Round values inside the range and how to write them."""
        if self.log:
            first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
            ticks = [(10.0**power, f"{10.0**power:g}") for power in range(first, last + 1)]
            room = abs(self.stop - self.start) / max(len(ticks), 1)
            return ticks if room > LETTER_WIDTH * max((len(text) for _, text in ticks), default=0) else ticks[::2]
        step = round_step((self.high - self.low) / max(about, 1))
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [(index * step, f"{round(index * step, 12):g}") for index in range(first, last + 1)]


def round_step(step: float) -> float:
    """The next of 1, 2, 2.5, 5 times a power of ten that is not below ``step``."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if factor * power >= step * (1.0 - 1e-9))


def span(values: list[float], from_zero: bool = False, margin: float = 0.04) -> tuple[float, float]:
    """Range that holds all finite values with a margin; never empty."""
    known = [value for value in values if math.isfinite(value)]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    if from_zero:
        low = min(low, 0.0)
    if high <= low:
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    room = margin * (high - low)
    return (low if from_zero and low == 0.0 else low - room), high + room


def axes_of(plot: Plot) -> tuple[Axis, Axis]:
    """Both axes with their ranges, from 0 to 1."""
    parts = [one.extent() for one in plot.series]
    bars = any(one.kind == "bars" for one in plot.series)
    xs, ys = (np.concatenate(side).tolist() if parts else [] for side in (zip(*parts) if parts else ((), ())))
    x_range = plot.x_range or span(xs, plot.zero and not bars)
    y_range = plot.y_range or span(ys, plot.zero, 0.0 if bars else 0.04)
    return Axis(plot.x_label, *x_range, 0.0, 1.0, plot.log_x), Axis(plot.y_label, *y_range, 0.0, 1.0)


def plot_drawing(plot: Plot, size_pt: float = 7.5) -> Callable[[Box], list[Item]]:
    """Return what draws a plot with the labels of its axes and the names of its curves into a box."""

    def drawn(box: Box) -> list[Item]:
        left, high, right, low = box
        line = PITCH * size_pt * PT_MM
        names = names_mm(plot, size_pt, right - left)
        items, (x, y) = draw_axes(plot, (left, high + line, right - names, low - line), size_pt)
        across = shortened(plot.x_label, right - left, size_pt)
        items.append(Text(0.5 * (x.start + x.stop), low - 0.25 * line, across, size_pt, anchor="middle", colour=SOFT))
        if plot.y_label:
            items.append(
                Text(left, high + 0.6 * line, shortened(plot.y_label, right - left, size_pt), size_pt, colour=SOFT)
            )
        return items + draw_layers(plot, x, y, size_pt) + name_curves(plot, x, y, size_pt, names)

    return drawn


def _curves(plot: Plot) -> dict[str, Series]:
    """Curves and points by their names."""
    return {one.label: one for one in reversed(plot.series) if one.kind in ("line", "dots")}


def names_mm(plot: Plot, size_pt: float, wide_mm: float) -> float:
    """Room that the names of the curves take at the right of the axes. [mm]"""
    widest = max((text_width_mm(name, size_pt) for name in _curves(plot)), default=0.0)
    return min(widest, 0.35 * wide_mm) + 1.5


def name_curves(plot: Plot, x: Axis, y: Axis, size_pt: float, room_mm: float) -> list[Item]:
    """Write the names of curves and points right of the axes, at the height of their ends and clear of each other."""
    step, ends = PITCH * size_pt * PT_MM, list[tuple[float, str, str]]()
    for name, layer in _curves(plot).items():
        across, along = layer.x, y.positions(layer.y)
        known = np.flatnonzero(np.isfinite(across) & np.isfinite(along))
        if len(known):
            ends.append((float(along[known[-1]]), name, STYLES.get(layer.style, STYLES["other"])[0]))
    items, low = list[Item](), y.start + step
    for height, name, colour in sorted(ends, reverse=True):
        low = min(max(height, y.stop) + 0.25 * size_pt * PT_MM, low - step)
        items.append(Text(x.stop + 1.0, low, shortened(name, room_mm, size_pt), size_pt, colour=colour))
    return items


def draw_axes(
    plot: Plot, box: Box, size_pt: float, y_range: tuple[float, float] | None = None, unit: str = ""
) -> tuple[list[Item], tuple[Axis, Axis]]:
    """Draw ground, grid and numbers of a plot's axes.

    Parameters
    ----------
    plot : Plot
        Its ranges are those of the report.
    box : Box
        With the numbers of the axes. [mm]
    size_pt : float
        Of the numbers. [pt]
    y_range : tuple of float, optional
        Instead of the plot's own.
    unit : str
        Written behind the last number of the x-axis.

    Returns
    -------
    list of items, tuple of Axis
        What is drawn, and the axes in places of the sheet.
    """
    left, high, right, low = box
    line = PITCH * size_pt * PT_MM
    across, along = axes_of(plot)
    if y_range is not None:
        along = replace(along, low=y_range[0], high=y_range[1])
    bars = [one for one in plot.series if one.kind == "bars"]
    names = [name for one in bars for name in one.names]
    about = max(min(round((low - high) / 8.0), 6), 4)
    marks = [] if bars else replace(along, start=low - line, stop=high).ticks(about)
    widest = max((text_width_mm(words, size_pt) for words in (*names, *(words for _, words in marks))), default=0.0)
    start = left + min(max(widest + 1.5, 5.0), 0.45 * (right - left))
    x = replace(across, start=start, stop=right - 1.5)
    y = replace(along, start=low - line - 0.4, stop=high + 0.3)
    items: list[Item] = [rectangle((x.start, y.stop, x.stop, y.start), PAPER, None)]
    for value, words in marks:
        position = y.position(value)
        items.append(Path(((x.start, position), (x.stop, position)), RULE, width_mm=0.15))
        items.append(Text(x.start - 1.0, position + 0.25 * size_pt * PT_MM, words, size_pt, anchor="end", colour=SOFT))
    # in pixels, where an axis thinks that the letters of its numbers are that wide
    ticks = replace(x, start=0.0, stop=PX_PER_MM * (x.stop - x.start)).ticks(max(round((x.stop - x.start) / 16.0), 2))
    for number, (value, words) in enumerate(ticks):
        position = x.position(value)
        items.append(Path(((position, y.start), (position, y.start + 0.7)), SOFT, width_mm=0.2))
        anchor = "end" if position > x.stop - 2.0 else "middle"
        words += unit if number == len(ticks) - 1 else ""
        items.append(Text(position, y.start + line, words, size_pt, anchor=anchor, colour=SOFT))
    items.append(Path(((x.start, y.stop), (x.start, y.start), (x.stop, y.start)), SOFT, width_mm=0.25))
    return items, (x, y)


def draw_layers(plot: Plot, x: Axis, y: Axis, size_pt: float) -> list[Item]:
    """Draw bands, curves, points and bars of a plot inside its axes; maps, ellipses and labels are left out."""
    items: list[Item] = []
    for layer in sorted(plot.series, key=lambda one: one.kind == "dots"):
        if layer.kind == "band":
            at, low, high = layer.y if layer.sideways else layer.x, layer.low, layer.high
            known = np.isfinite(at) & np.isfinite(low) & np.isfinite(high)
            sides = np.r_[at[known], at[known][::-1]], np.r_[high[known], low[known][::-1]]
            colour = BAND if layer.style == "band" else RULE
            items += _run(x, y, *(sides[::-1] if layer.sideways else sides), None, colour)
        elif layer.kind == "bars":
            items += _bars(layer, x, y, size_pt)
        elif layer.kind == "dots":
            items += _dots(layer, x, y)
        elif layer.kind == "line":
            colour, dash = STYLES.get(layer.style, STYLES["other"])
            xs, ys = layer.x, layer.y
            for start, stop in true_runs(np.isfinite(xs) & np.isfinite(ys)):
                items += _run(x, y, xs[start:stop], ys[start:stop], colour, None, dash)
    return items


def _run(
    x: Axis,
    y: Axis,
    xs: NDArray,
    ys: NDArray,
    stroke: str | None,
    fill: str | None,
    dash: tuple[float, ...] = (),
) -> list[Item]:
    """A curve or an area inside its axes, without points that no one would see."""
    known = (xs > 0.0) if x.log else np.ones(len(xs), bool)
    if known.sum() < 2:
        return []
    across, along = np.clip(x.positions(xs[known]), x.start, x.stop), np.clip(y.positions(ys[known]), y.stop, y.start)
    kept = corners(across, along, UNSEEN_MM)
    points = tuple((float(a), float(b)) for a, b in zip(across[kept], along[kept]))
    return [Path(points, stroke, fill, 0.5, dash, fill is not None)]


def _dots(layer: Series, x: Axis, y: Axis) -> list[Item]:
    """Small squares; of very many a part, evenly along the axis."""
    colour = STYLES.get(layer.style, STYLES["other"])[0]
    across, along = x.positions(layer.x), y.positions(layer.y)
    shown = np.flatnonzero(np.isfinite(across) & np.isfinite(along))
    if len(shown) > MOST_DOTS:
        wanted = np.linspace(across[shown].min(), across[shown].max(), MOST_DOTS)
        shown = shown[np.unique(np.abs(across[shown][:, None] - wanted).argmin(axis=0))]
    boxes = ((float(np.clip(across[k], x.start, x.stop)), float(np.clip(along[k], y.stop, y.start))) for k in shown)
    return [rectangle((a - DOT_MM, b - DOT_MM, a + DOT_MM, b + DOT_MM), colour, None) for a, b in boxes]


def _bars(layer: Series, x: Axis, y: Axis, size_pt: float) -> list[Item]:
    """Bars with their labels at the left."""
    items: list[Item] = []
    count = len(layer.names)
    ends = zip(layer.names, layer.low.tolist(), layer.high.tolist())
    for row, (label, low, high) in enumerate(ends):
        top, bottom = y.position(count - row - 0.2), y.position(count - row - 0.8)
        left, right = (min(max(x.position(value), x.start), x.stop) for value in (low, high))
        items.append(rectangle((left, top, max(right, left + 0.3), bottom), STYLES["main"][0], None))
        words = shortened(label, 40.0, size_pt)
        items.append(
            Text(
                x.start - 1.0, 0.5 * (top + bottom) + 0.25 * size_pt * PT_MM, words, size_pt, anchor="end", colour=SOFT
            )
        )
    return items


def corners(across: NDArray, along: NDArray, tolerance: float) -> NDArray:
    """Positions of the points that a polyline needs to pass all others within a tolerance.

    Neighbours are joined in rounds. The deviations of joined parts add up, so the sum bounds the distance of every
    point that is left out.
    """
    point = across + 1j * along
    kept, error = np.arange(len(point)), np.zeros(max(len(point) - 1, 0))
    first, idle = 1, 0
    while idle < 2 and len(kept) > 2:
        middle = np.arange(first, len(kept) - 1, 2)
        start, chord = point[kept[middle - 1]], point[kept[middle + 1]] - point[kept[middle - 1]]
        length = np.abs(chord)
        turned = (point[kept[middle]] - start) * chord.conj() / np.maximum(length, 1e-12)
        # a turn back along the chord leaves its ends
        beyond = np.maximum(np.maximum(-turned.real, turned.real - length), 0.0)
        whole = np.maximum(error[middle - 1], error[middle]) + np.hypot(turned.imag, beyond)
        whole[length < tolerance] = np.inf
        dropped = middle[whole <= tolerance]
        if len(dropped):
            error[dropped - 1] = whole[whole <= tolerance]
            kept, error = np.delete(kept, dropped), np.delete(error, dropped)
        idle = 0 if len(dropped) else idle + 1
        first = 3 - first
    return kept
