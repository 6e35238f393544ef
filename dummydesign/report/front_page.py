"""The first page of a report: verdict, a drawing, facts, presses as small multiples, a table, what to do next.

A command fills a :class:`FrontPage`; :func:`lay_out` sets it on one sheet of A4, ``report.pdf``. What is drawn is a
plot as ``plot.typ`` reads it, or a pad cut through its highest point, to scale, with its dimensions, punch and base.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign._version import __version__
from dummydesign.core.tables import Table
from dummydesign.core.typeset import typeset
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch
from dummydesign.mold.files.drawing_layout import SCALES, Measure, View, lay_out_view, put, ratio
from dummydesign.mold.files.drawing_sheet import Drawing, Point, number_text, to_svg
from dummydesign.report.plot import Plot, Series, bar_places, thin

TEMPLATE = Path(__file__).with_name("front_page.typ")
MOST_PANELS, MOST_NUMBERS = 6, 5
MOST_ROWS, MOST_NOTES = 9, 4
"""Rows of the table and warnings that are shown; the report has all."""
COMMAND_WORDS = re.compile(r"(?:'[^']*'|\S)+")
"""Words of a command: what stands in quotes is not broken."""

FOOT = "report.html continues with all figures and tables, the warnings and the sources."


@dataclass(frozen=True)
class Fact:
    """A value with its label; ``large`` for the one number that is read from afar."""

    label: str
    text: str
    large: bool = False


@dataclass(frozen=True)
class Panel:
    """A press as a small multiple: its plot, the test at its upper left, how it reads at its upper right."""

    plot: Plot
    test: str
    reads: str
    bad: bool = False
    level: str = ""
    """Panels of one level share the scale of their forces; those without a level have their own."""


@dataclass(frozen=True)
class FrontPage:
    """What stands on the first page.

    Attributes
    ----------
    title, basis : str
        Name of the answer, and for what it holds.
    verdict : tuple of (str or None, str)
        Light (green, amber, red or none) and words; the words up to the first full stop are set in bold.
    drawing : tuple of (str, dict)
        Heading and what is drawn, by :func:`dummydesign.report.front_page.plot_drawing` or
        :func:`dummydesign.report.front_page.pad_section`.
    facts_title, facts : str, sequence of Fact
        What stands right of the drawing.
    panels_title, panels : str, sequence of Panel
        The presses; six are shown.
    keys : sequence of (str, str)
        Style (``band``, ``dots``, ``main``, ``aim``, ``other``) and name of each curve; without any, the curves are
        named where they end.
    table : Table
        Texts under the presses; ``marked`` rows are in the colour of what is outside.
    blocks : sequence of (str, sequence of str)
        Heading and paragraphs right of the table.
    notes : sequence of str
        Warnings, each with what to do.
    steps : sequence of str
        What to do next, in its order; commands begin with ``dummydesign``.
    foot : str
        Where the rest is.
    """

    title: str
    basis: str
    verdict: tuple[str | None, str]
    drawing: tuple[str, dict[str, Any]]
    facts_title: str
    facts: Sequence[Fact]
    panels_title: str
    panels: Sequence[Panel]
    keys: Sequence[tuple[str, str]]
    table: Table
    blocks: Sequence[tuple[str, Sequence[str]]] = ()
    notes: Sequence[str] = ()
    steps: Sequence[str] = ()
    foot: str = ""


def lay_out(page: FrontPage) -> bytes:
    """Set the page on one sheet of A4 as PDF, in the largest letters for which there is room.

    Long texts end in three dots; what no size makes room for is left to the report.
    """
    light, words = page.verdict
    first, _, rest = words.partition(". ")
    table = page.table
    rows = [list(row) for row in table.rows]
    if len(rows) > MOST_ROWS + 1:
        rows = [*rows[: MOST_ROWS + 1], [f"... and {len(rows) - MOST_ROWS} more in the report"]]
    # of more presses those that lie evenly in their order
    at = np.linspace(0, len(page.panels) - 1, min(len(page.panels), MOST_PANELS)).round().astype(int)
    shown = [page.panels[number] for number in at]
    ranges = {panel.level: _range([one for one in shown if one.level == panel.level]) for panel in shown}
    left_out = f": {MOST_PANELS} of {len(page.panels)}" if len(page.panels) > MOST_PANELS else ""
    content = {
        "title": page.title,
        "version": f"dummydesign {__version__}",
        "basis": page.basis,
        "light": light or "none",
        "strong": f"{light.upper()}: {first.rstrip('.').upper()}" if light else f"{first.rstrip('.')}.",
        "rest": rest,
        "drawing": {"title": page.drawing[0], **page.drawing[1]},
        "facts_title": page.facts_title,
        "facts": [asdict(fact) for fact in page.facts],
        "panels_title": f"{page.panels_title}{left_out}",
        "panels": [_panel(one, ranges[one.level], bool(page.keys)) for one in shown],
        "keys": page.keys,
        "table": {"head": table.head, "rows": rows, "marked": sorted(table.marked)},
        "blocks": page.blocks,
        "notes": page.notes[:MOST_NOTES],
        "steps_title": "What to do next",
        "steps": [COMMAND_WORDS.findall(one) if one.startswith("dummydesign ") else one for one in page.steps],
        "foot": page.foot,
    }
    return typeset(TEMPLATE, content)


def full_sentence(text: str) -> str:
    """The text with a capital, unless it begins with a file's name, and a full stop."""
    first = text.partition(" ")[0].rstrip(",;:")
    return text and f"{text[0].upper() if first.isalpha() else text[0]}{text[1:].removesuffix('.')}."


def warning_texts(warnings: Sequence[Mapping[str, str]]) -> list[str]:
    """The first warning of each kind, and how many more there are of it."""
    kinds: dict[str, list[str]] = {}
    for item in warnings:
        kinds.setdefault(item["code"], []).append(item["message"])
    return [
        full_sentence(texts[0]) + (f" ({len(texts) - 1} more)" if len(texts) > 1 else "") for texts in kinds.values()
    ]


def _range(panels: Sequence[Panel]) -> tuple[float, float] | None:
    """The range of forces of the panels of one level; None for their own."""
    if not panels[0].level:
        return None
    ends = [one.extent() for panel in panels for one in panel.plot.series if one.kind in ("band", "line", "dots")]
    most = [float(np.nanmax(y)) for _, y in ends if np.isfinite(y).any()]
    return 0.0, 1.06 * max(most, default=1.0)


def _panel(panel: Panel, y_range: tuple[float, float] | None, keyed: bool) -> dict[str, Any]:
    """One press: its test and how it reads over its plot; without a key its curves have their names."""
    reached = any(one.kind in ("line", "dots") and one.style == "main" for one in panel.plot.series)
    unit = " s" if panel.plot.x_name == "time_s" else ""
    words = "not reached" if keyed and not reached else ""
    plot = draw_plot(panel.plot, MOST_NUMBERS, y_range, unit, named=not keyed, words=words)
    return {"test": panel.test, "reads": panel.reads, "bad": panel.bad, "plot": plot}


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
