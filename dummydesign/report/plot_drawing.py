"""A plot on a sheet: its table of series as paths and texts, with axes and round numbers beside them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import true_runs
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
    rectangle,
    shortened,
    text_width_mm,
)

DOT_MM, MOST_DOTS = 0.9, 40
FLAT_MM = 0.01
"""A point that lies nearer to the straight line between its neighbours is left out."""
MARGIN = 0.05
"""Room of an axis beyond its values, as a share of them, where the plot names no range."""
ROUND = (1.0, 2.0, 2.5, 5.0, 10.0)


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


@dataclass(frozen=True)
class _Frame:
    """The rectangle between the axes and the values at its sides, those of x as logarithms on a logarithmic axis."""

    box: Box
    x: tuple[float, float]
    y: tuple[float, float]
    log_x: bool

    def place(self, x: NDArray, y: NDArray) -> NDArray:
        """Places of values, shape (n, 2). [mm]"""
        left, high, right, low = self.box
        across = np.log10(np.maximum(x, 1e-300)) if self.log_x else x
        return np.stack(
            [
                left + (right - left) * (across - self.x[0]) / (self.x[1] - self.x[0]),
                low - (low - high) * (y - self.y[0]) / (self.y[1] - self.y[0]),
            ],
            axis=-1,
        )


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
    line = PITCH * size_pt * PT_MM
    curves = {one.label: one for one in reversed(plot.series) if one.kind in ("line", "dots")} if named else {}
    names_mm = max((text_width_mm(name, size_pt) for name in curves), default=-1.5)
    names_mm = min(names_mm, 0.35 * (right - left)) + 1.5
    bars = next((one for one in plot.series if one.kind == "bars"), None)
    x, y = (_range(plot, side, y_range) for side in (0, 1))
    if bars is not None:
        places = len(bars.names) - 0.5 - np.arange(len(bars.names))
        up = [(float(at), shortened(name, 40.0, size_pt)) for at, name in zip(places, bars.names)]
    else:
        up = [(at, f"{at:g}") for at in _round_numbers(*y, max(min(round((low - high) / 8.0), 6), 4))]
    widest = max((text_width_mm(text, size_pt) for _, text in up), default=0.0)
    start = min(max(widest + 1.5, 5.0), 0.45 * (right - left - names_mm))
    frame = _Frame((left + start, high + 0.3, right - names_mm - 1.5, low - line - 0.4), x, y, plot.log_x)
    items = [rectangle(frame.box, PAPER, None), *_along_x(frame, (right - left - names_mm) / 16.0, unit, size_pt)]
    items += _along_y(frame, up, bars is None, size_pt)
    for kind in ("band", "bars", "line", "dots"):
        for one in plot.series:
            if one.kind == kind and one.seen:
                items += _drawn(frame, one)
    x0, y0, x1, y1 = frame.box
    items += [Path(((x0, y0), (x0, y1)), SOFT), Path(((x0, y1), (x1, y1)), SOFT)]
    if words:
        at = 0.5 * (x0 + x1), y1 - 0.15 * (y1 - y0)
        items.append(Text(*at, words, size_pt + 2.5, anchor="middle", colour=INK))
    return items + _names(frame, curves, names_mm, size_pt)


def _range(plot: Plot, side: int, y_range: tuple[float, float] | None) -> tuple[float, float]:
    """Values at both ends of the axis of x (0) or y (1); logarithms of a logarithmic one."""
    log, own = plot.log_x and side == 0, (plot.x_range, y_range or plot.y_range)[side]
    if own is not None:
        return (math.log10(own[0]), math.log10(own[1])) if log else own
    drawn = [one for one in plot.series if one.kind in ("band", "bars", "line", "dots") and one.seen]
    values = np.concatenate([np.zeros(0), *(np.ravel(one.extent()[side]) for one in drawn)])
    values = values[np.isfinite(values) & ((values > 0.0) | (not log))]
    if log:
        values = np.log10(values)
    first, last = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    room = MARGIN * (last - first) or 0.5
    bars = any(one.kind == "bars" for one in drawn)
    low = 0.0 if plot.zero and not bars and not log and first >= 0.0 else first - room
    return low, last + room


def _round_numbers(low: float, high: float, count: int) -> list[float]:
    """Round numbers inside a range, at most so many steps of it, but at least two numbers."""
    wanted = (high - low) / max(count, 1)
    power = math.floor(math.log10(wanted))
    steps = [step * 10.0 ** (power + more) for more in (-1, 0, 1) for step in ROUND[:-1]]
    first = next(number for number, step in enumerate(steps) if step >= wanted * (1.0 - 1e-9))
    found: list[float] = []
    for step in reversed(steps[: first + 1]):
        ends = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        found = [round(number * step, 12) for number in range(ends[0], ends[1] + 1)]
        if len(found) > 1:
            break
    return found


def _along_y(frame: _Frame, numbers: list[tuple[float, str]], ruled: bool, size_pt: float) -> list[Item]:
    """Numbers or names beside the axis of y, and lines across."""
    x0, _, x1, _ = frame.box
    items: list[Item] = []
    for value, text in numbers:
        at = float(frame.place(np.array([10.0 ** frame.x[0] if frame.log_x else frame.x[0]]), np.array([value]))[0, 1])
        if ruled:
            items.append(Path(((x0, at), (x1, at)), RULE, width_mm=0.15))
        items.append(Text(x0 - 1.0, at + 0.36 * size_pt * PT_MM, text, size_pt, anchor="end", colour=SOFT))
    return items


def _along_x(frame: _Frame, count: float, unit: str, size_pt: float) -> list[Item]:
    """Numbers under the axis of x, every second one where they are too many, with their ticks."""
    x0, _, x1, y1 = frame.box
    if frame.log_x:
        values = [10.0**n for n in range(math.ceil(frame.x[0] - 1e-9), math.floor(frame.x[1] + 1e-9) + 1)]
    else:
        values = _round_numbers(*frame.x, max(round(count), 2))
    if values and 16.0 * count / len(values) < 1.6 * max(text_width_mm(f"{value:g}", size_pt) for value in values):
        values = values[::2]
    items: list[Item] = []
    for value in values:
        at = float(frame.place(np.array([value]), np.array([frame.y[0]]))[0, 0])
        last = value == values[-1]
        anchor = "end" if last and at > x1 - 0.05 * (x1 - x0) else "middle"
        text = f"{value:g}{unit if last else ''}"
        under = y1 + 1.3 + 0.72 * size_pt * PT_MM
        items += [Path(((at, y1), (at, y1 + 0.7)), SOFT, width_mm=0.2),
                  Text(at, under, text, size_pt, anchor=anchor, colour=SOFT)]  # fmt: skip
    return items


def _drawn(frame: _Frame, one: Series) -> Iterator[Item]:
    """One series inside the frame."""
    colour, dash = STYLES.get(one.style, STYLES["other"])
    if one.kind == "band":
        tint, at = (BAND if one.style == "band" else RULE), one.y if one.sideways else one.x
        for first, end in true_runs(np.isfinite(at) & np.isfinite(one.low) & np.isfinite(one.high)):
            run = slice(first, end)
            place, ends = np.r_[at[run], at[run][::-1]], np.r_[one.low[run], one.high[run][::-1]]
            yield from _area(frame, frame.place(ends, place) if one.sideways else frame.place(place, ends), tint)
    elif one.kind == "bars":
        for number, (low, high) in enumerate(zip(one.low, one.high)):
            up = len(one.names) - 0.5 - number + np.array([-0.3, -0.3, 0.3, 0.3])
            yield from _area(frame, frame.place(np.array([low, high, high, low]), up), STYLES["main"][0])
    elif one.kind == "dots":
        x, y = one.x, one.y
        shown = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        if len(shown) > MOST_DOTS:
            # of very many a part, evenly along the axis
            along = np.log(np.maximum(x[shown], 1e-12)) if frame.log_x else x[shown]
            wanted = np.linspace(along.min(), along.max(), MOST_DOTS)
            shown = shown[np.unique(np.abs(along[:, None] - wanted).argmin(axis=0))]
        half = 0.5 * DOT_MM
        for across, down in frame.place(x[shown], y[shown]):
            corners = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
            yield from _area(frame, corners + (across, down), colour)
    else:
        for first, end in true_runs(np.isfinite(one.x) & np.isfinite(one.y)):
            for points in _inside(frame.box, frame.place(one.x[first:end], one.y[first:end])):
                yield Path(_plain(points), colour, None, 0.5, dash)


def _area(frame: _Frame, points: NDArray, fill: str) -> Iterator[Path]:
    """A filled area, what is outside the frame cut off side by side (Sutherland and Hodgman 1974)."""
    for axis, limit, sign in zip(
        (0, 0, 1, 1), (frame.box[0], frame.box[2], frame.box[1], frame.box[3]), (1, -1, 1, -1)
    ):
        room = sign * (points[:, axis] - limit)
        if (room >= 0.0).all():
            continue
        kept: list[NDArray] = []
        for here, after, own, other in zip(points, np.roll(points, -1, axis=0), room, np.roll(room, -1)):
            if own >= 0.0:
                kept.append(here)
            if (own >= 0.0) != (other >= 0.0):
                kept.append(here + own / (own - other) * (after - here))
        points = np.array(kept).reshape(-1, 2)
    if len(points) > 2:
        yield Path(_plain(points), None, fill, 0.25, closed=True)


def _inside(box: Box, points: NDArray) -> Iterator[NDArray]:
    """The pieces of a curve inside a box (Liang and Barsky 1984)."""
    start, way = points[:-1], np.diff(points, axis=0)
    low, high = np.array(box[:2]), np.array(box[2:])
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(low - start) / way, (high - start) / way])
    still = (way == 0.0) & (start >= low) & (start <= high)
    enter = np.where(still, 0.0, np.fmin(*ends)).max(axis=-1).clip(0.0)
    leave = np.where(still, 1.0, np.fmax(*ends)).min(axis=-1).clip(None, 1.0)
    for first, end in true_runs((enter < leave) & np.isfinite(enter) & np.isfinite(leave)):
        run = slice(first, end)
        into, out = (start[run] + share[run, None] * way[run] for share in (enter, leave))
        breaks = np.flatnonzero((leave[run][:-1] < 1.0) | (enter[run][1:] > 0.0)) + 1
        for begins, one in zip(np.split(into, breaks), np.split(out, breaks)):
            yield np.vstack([begins[:1], one])


def _plain(points: NDArray) -> tuple[tuple[float, float], ...]:
    """Points of a run without those that lie on the line between the last one kept and the next."""
    kept: list[tuple[float, float]] = []
    run = [(float(x), float(y)) for x, y in points]
    for here, after in zip(run, [*run[1:], None]):
        if kept and after is not None:
            (x0, y0), (x, y), (x1, y1) = kept[-1], here, after
            along = math.hypot(x1 - x0, y1 - y0)
            off = abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0))
            if off <= FLAT_MM * along and (x - x0) * (x1 - x) + (y - y0) * (y1 - y) >= 0.0:
                continue
        kept.append(here)
    return tuple(kept)


def _names(frame: _Frame, curves: dict[str, Series], room_mm: float, size_pt: float) -> list[Item]:
    """Write the names of curves and points right of the axes, at the height of their ends and clear of each other."""
    _, top, right, _ = frame.box
    step, ends = PITCH * size_pt * PT_MM, list[tuple[float, str, str]]()
    for name, one in curves.items():
        known = np.flatnonzero(np.isfinite(one.x) & np.isfinite(one.y))[-1:]
        heights = frame.place(one.x[known], one.y[known])[:, 1].tolist()
        ends += [(height, name, STYLES.get(one.style, STYLES["other"])[0]) for height in heights]
    items, low = list[Item](), np.inf
    for height, name, colour in sorted(ends, reverse=True):
        low = min(max(height, top) + 0.25 * size_pt * PT_MM, low - step)
        items.append(Text(right + 1.0, low, shortened(name, room_mm, size_pt), size_pt, colour=colour))
    return items
