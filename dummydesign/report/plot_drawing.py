"""A plot on a sheet: matplotlib draws its table of series, and what it draws becomes paths and texts of the sheet."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dummydesign.report.plot import Plot, Series
from dummydesign.report.vector_sheet import (
    BAND,
    INK,
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
    shortened,
    text_width_mm,
)

PX_MM = 0.1
"""Of the figures; positions on the sheet are no finer than what a printer shows."""
DOT_MM, MOST_DOTS = 0.9, 40


def plot_drawing(plot: Plot, size_pt: float = 7.5) -> Callable[[Box], list[Item]]:
    """Return what draws a plot with the labels of its axes and the names of its curves into a box."""

    def drawn(box: Box) -> list[Item]:
        left, high, right, low = box
        line = PITCH * size_pt * PT_MM
        items = draw_plot(plot, (left, high + line, right, low - line), size_pt, named=True)
        across = shortened(plot.x_label, right - left, size_pt)
        items.append(Text(0.5 * (left + right), low - 0.25 * line, across, size_pt, anchor="middle", colour=SOFT))
        if plot.y_label:
            words = shortened(plot.y_label, right - left, size_pt)
            items.append(Text(left, high + 0.6 * line, words, size_pt, colour=SOFT))
        return items

    return drawn


def draw_plot(
    plot: Plot,
    box: Box,
    size_pt: float,
    y_range: tuple[float, float] | None = None,
    unit: str = "",
    named: bool = False,
    words: str = "",
) -> list[Item]:
    """Draw bands, curves, points and bars of a plot inside their axes; maps, ellipses and words are left out.

    Parameters
    ----------
    plot : Plot
        Its ranges are those of the report.
    box : Box
        With the numbers of the axes. [mm]
    size_pt : float
        Of the letters. [pt]
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
    list of items
        What is drawn.
    """
    left, high, right, low = box
    wide, tall, line = right - left, low - high, PITCH * size_pt * PT_MM
    curves = {one.label: one for one in reversed(plot.series) if one.kind in ("line", "dots")} if named else {}
    names_mm = max((text_width_mm(name, size_pt) for name in curves), default=-1.5)
    names_mm = min(names_mm, 0.35 * wide) + 1.5
    figure = _figure()((wide / 25.4, tall / 25.4), dpi=25.4 / PX_MM, frameon=False)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    for one in sorted(plot.series, key=lambda one: one.kind == "dots"):
        _draw_series(axes, one, plot.log_x)
    widest = _scale(axes, plot, y_range, unit, size_pt, (wide - names_mm, tall))
    start = min(max(widest + 1.5, 5.0), 0.45 * (wide - names_mm))
    room = max(wide - names_mm - start - 1.5, 1.0), max(tall - line - 0.7, 1.0)
    axes.set_position((start / wide, (line + 0.4) / tall, room[0] / wide, room[1] / tall))
    axes.text(0.5, 0.15, words, transform=axes.transAxes, ha="center", size=size_pt, color=INK)
    sheet = _sheet(left, low, wide, tall)
    figure.draw(sheet)
    top = low - (line + 0.4) - room[1]
    return sheet.items + _name_curves(axes, curves, (left + start + room[0] + 1.0, top, low), names_mm, size_pt)


def _figure() -> Any:
    """Matplotlib's class of figures, loaded without the help of its hundreds of properties: two fifths of its time."""
    from matplotlib.artist import Artist

    name = "_update_set_signature_and_docstring"
    helped = Artist.__dict__.get(name)
    if helped is not None:
        setattr(Artist, name, classmethod(lambda cls: None))
    from matplotlib.figure import Figure

    if helped is not None:
        setattr(Artist, name, helped)
    return Figure


def _draw_series(axes: Any, one: Series, log_x: bool) -> None:
    colour, dash = STYLES.get(one.style, STYLES["other"])
    if one.kind == "band" and one.seen:
        fill = axes.fill_betweenx if one.sideways else axes.fill_between
        tint = BAND if one.style == "band" else RULE
        fill(one.y if one.sideways else one.x, one.low, one.high, color=tint, linewidth=0.0, zorder=1.5)
    elif one.kind == "bars":
        places = len(one.names) - 0.5 - np.arange(len(one.names))
        axes.barh(places, one.high - one.low, left=one.low, height=0.6, color=STYLES["main"][0])
    elif one.kind == "dots":
        x, y = one.x, one.y
        shown = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        if len(shown) > MOST_DOTS:
            # of very many a part, evenly along the axis
            along = np.log(np.maximum(x[shown], 1e-12)) if log_x else x[shown]
            wanted = np.linspace(along.min(), along.max(), MOST_DOTS)
            shown = shown[np.unique(np.abs(along[:, None] - wanted).argmin(axis=0))]
        axes.plot(x[shown], y[shown], "s", color=colour, markersize=DOT_MM / PT_MM, markeredgewidth=0.0)
    elif one.kind == "line":
        width = 0.5 / PT_MM
        style = (0, [part / 0.5 for part in dash]) if dash else "solid"
        axes.plot(one.x, one.y, color=colour, linewidth=width, linestyle=style)


def _scale(
    axes: Any,
    plot: Plot,
    y_range: tuple[float, float] | None,
    unit: str,
    size_pt: float,
    room_mm: tuple[float, float],
) -> float:
    """Ranges, numbers and lines of the axes; returns the width of the widest number of y. [mm]"""
    from matplotlib.ticker import LogLocator, MaxNLocator

    bars = next((one for one in plot.series if one.kind == "bars"), None)
    if plot.log_x:
        axes.set_xscale("log")
    for side, own in (("x", plot.x_range), ("y", y_range or plot.y_range)):
        limits = getattr(axes, f"set_{side}lim")
        if own is not None:
            limits(*own)
        elif plot.zero and bars is None and not (side == "x" and plot.log_x):
            if getattr(axes.dataLim, f"{side}0") >= 0.0:
                limits(0.0)

    def ticks(ends: tuple[float, float], locator: Any) -> list[float]:
        return [
            float(value)
            for value in locator.tick_values(*ends)
            if ends[0] <= value * (1 + 1e-9) + 1e-12 and value <= ends[1] * (1 + 1e-9) + 1e-12
        ]

    steps = [1, 2, 2.5, 5, 10]
    count = max(round(room_mm[0] / 16.0), 2)
    across = ticks(axes.get_xlim(), LogLocator() if plot.log_x else MaxNLocator(count, steps=steps))
    numbers = [f"{value:g}" for value in across]
    if across and room_mm[0] / len(across) < 1.6 * max(text_width_mm(text, size_pt) for text in numbers):
        across, numbers = across[::2], numbers[::2]
    axes.set_xticks(across, [*numbers[:-1], *(f"{text}{unit}" for text in numbers[-1:])])
    axes.minorticks_off()
    places = ticks(axes.get_ylim(), MaxNLocator(max(min(round(room_mm[1] / 8.0), 6), 4), steps=steps))
    texts = [f"{value:g}" for value in places]
    if bars is not None:
        places = (len(bars.names) - 0.5 - np.arange(len(bars.names))).tolist()
        texts = [shortened(name, 40.0, size_pt) for name in bars.names]
    axes.set_yticks(places, texts)
    thin = {"width": 0.2 / PT_MM, "color": SOFT, "labelcolor": SOFT, "labelsize": size_pt}
    axes.tick_params(axis="x", length=0.7 / PT_MM, pad=0.6 / PT_MM, **thin)
    axes.tick_params(axis="y", length=0.0, pad=1.0 / PT_MM, **thin)
    if bars is None:
        axes.grid(axis="y", color=RULE, linewidth=0.15 / PT_MM)
    axes.set_axisbelow(True)
    axes.patch.set_facecolor(PAPER)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set(color=SOFT, linewidth=0.25 / PT_MM)
    if across and across[-1] > axes.get_xlim()[1] - 0.05 * np.ptp(axes.get_xlim()):
        axes.get_xticklabels()[-1].set_ha("right")
    return max((text_width_mm(text, size_pt) for text in texts), default=0.0)


def _name_curves(
    axes: Any, curves: dict[str, Series], place: tuple[float, float, float], room_mm: float, size_pt: float
) -> list[Item]:
    """Write the names of curves and points right of the axes, at the height of their ends and clear of each other."""
    left, top, bottom = place
    step, ends = PITCH * size_pt * PT_MM, list[tuple[float, str, str]]()
    for name, one in curves.items():
        known = np.flatnonzero(np.isfinite(one.x) & np.isfinite(one.y))
        if len(known):
            at = axes.transData.transform((one.x[known[-1]], one.y[known[-1]]))[1]
            ends.append((bottom - PX_MM * float(at), name, STYLES.get(one.style, STYLES["other"])[0]))
    items, low = list[Item](), np.inf
    for height, name, colour in sorted(ends, reverse=True):
        low = min(max(height, top) + 0.25 * size_pt * PT_MM, low - step)
        items.append(Text(left, low, shortened(name, room_mm, size_pt), size_pt, colour=colour))
    return items


def _sheet(left_mm: float, low_mm: float, wide_mm: float, tall_mm: float) -> Any:
    """What matplotlib draws on: it keeps paths and texts in millimetres, y downwards."""
    from matplotlib.backend_bases import RendererBase
    from matplotlib.colors import to_hex

    class Sheet(RendererBase):
        def __init__(self) -> None:
            super().__init__()
            self.items: list[Item] = []

        def get_canvas_width_height(self) -> tuple[float, float]:
            return wide_mm / PX_MM, tall_mm / PX_MM

        def points_to_pixels(self, points: Any) -> Any:
            return points * PT_MM / PX_MM

        def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> tuple[float, float, float]:
            size = prop.get_size_in_points()
            return text_width_mm(s, size) / PX_MM, 0.72 * size * PT_MM / PX_MM, 0.0

        def draw_text(self, gc: Any, x: float, y: float, s: str, prop: Any, *more: Any, **others: Any) -> None:
            at = left_mm + PX_MM * x, low_mm - PX_MM * (tall_mm / PX_MM - y)
            self.items.append(Text(*at, s, prop.get_size_in_points(), colour=to_hex(gc.get_rgb())))

        def draw_path(self, gc: Any, path: Any, transform: Any, rgbFace: Any = None) -> None:
            clip = gc.get_clip_rectangle()
            width = PT_MM * gc.get_linewidth()
            drawn = path.cleaned(transform, True, None, simplify=True)
            if clip is not None:
                drawn = (
                    drawn.clip_to_bbox(clip)
                    if rgbFace is not None
                    else path.cleaned(transform, True, clip.extents, simplify=True)
                )
            stroke = to_hex(gc.get_rgb()) if width > 0.0 else None
            dash = tuple(PT_MM * part for part in gc.get_dashes()[1] or ())
            for run in drawn.to_polygons(closed_only=rgbFace is not None):
                if len(run) > 1:
                    run = run if rgbFace is None else run[:-1]  # it ends where it begins
                    points = tuple((left_mm + PX_MM * float(x), low_mm - PX_MM * float(y)) for x, y in run)
                    fill = None if rgbFace is None else to_hex(rgbFace)
                    self.items.append(Path(points, stroke, fill, width or 0.25, dash, fill is not None))

    return Sheet()
