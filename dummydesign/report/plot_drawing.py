"""A plot drawn on a sheet: the same axes, bands, curves, points and bars as in the report, in millimetres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import true_runs
from dummydesign.report.plot import Axis, Plot
from dummydesign.report.plot_layers import Band, Bars, Dots, Line, corners
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


def _curves(plot: Plot) -> dict[str, Line]:
    """Curves and points by their names."""
    return {layer.name: layer for layer in reversed(plot.layers) if isinstance(layer, Line)}


def names_mm(plot: Plot, size_pt: float, wide_mm: float) -> float:
    """Room that the names of the curves take at the right of the axes. [mm]"""
    widest = max((text_width_mm(name, size_pt) for name in _curves(plot)), default=0.0)
    return min(widest, 0.35 * wide_mm) + 1.5


def name_curves(plot: Plot, x: Axis, y: Axis, size_pt: float, room_mm: float) -> list[Item]:
    """Write the names of curves and points right of the axes, at the height of their ends and clear of each other."""
    step, ends = PITCH * size_pt * PT_MM, list[tuple[float, str, str]]()
    for name, layer in _curves(plot).items():
        across, along = np.asarray(layer.x, float), y.positions(np.asarray(layer.y, float))
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
    across, along = plot.axes()
    if y_range is not None:
        along = replace(along, low=y_range[0], high=y_range[1])
    bars = [layer for layer in plot.layers if isinstance(layer, Bars)]
    names = [label for layer in bars for label in layer.labels]
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
    for layer in sorted(plot.layers, key=lambda layer: isinstance(layer, Dots)):
        if isinstance(layer, Band):
            at, low, high = (np.asarray(v, float) for v in (layer.at, layer.low, layer.high))
            known = np.isfinite(at) & np.isfinite(low) & np.isfinite(high)
            sides = np.r_[at[known], at[known][::-1]], np.r_[high[known], low[known][::-1]]
            colour = BAND if layer.style == "band" else RULE
            items += _run(x, y, *(sides[::-1] if layer.sideways else sides), None, colour)
        elif isinstance(layer, Bars):
            items += _bars(layer, x, y, size_pt)
        elif isinstance(layer, Dots):
            items += _dots(layer, x, y)
        elif isinstance(layer, Line):
            colour, dash = STYLES.get(layer.style, STYLES["other"])
            xs, ys = np.asarray(layer.x, float), np.asarray(layer.y, float)
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


def _dots(layer: Dots, x: Axis, y: Axis) -> list[Item]:
    """Small squares; of very many a part, evenly along the axis."""
    colour = STYLES.get(layer.style, STYLES["other"])[0]
    across, along = x.positions(np.asarray(layer.x, float)), y.positions(np.asarray(layer.y, float))
    shown = np.flatnonzero(np.isfinite(across) & np.isfinite(along))
    if len(shown) > MOST_DOTS:
        wanted = np.linspace(across[shown].min(), across[shown].max(), MOST_DOTS)
        shown = shown[np.unique(np.abs(across[shown][:, None] - wanted).argmin(axis=0))]
    boxes = ((float(np.clip(across[k], x.start, x.stop)), float(np.clip(along[k], y.stop, y.start))) for k in shown)
    return [rectangle((a - DOT_MM, b - DOT_MM, a + DOT_MM, b + DOT_MM), colour, None) for a, b in boxes]


def _bars(layer: Bars, x: Axis, y: Axis, size_pt: float) -> list[Item]:
    """Bars with their labels at the left."""
    items: list[Item] = []
    count = len(layer.labels)
    ends = zip(layer.labels, np.asarray(layer.low, float).tolist(), np.asarray(layer.high, float).tolist())
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
