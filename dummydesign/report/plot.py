"""A figure and the table of its series: one object that the page, the sheet to print and the CSV are made of.

The page draws it with plotly.js, which is kept beside this module and goes into each page once.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

COLUMNS = ("figure", "series", "x_name", "y_name", "x", "y", "low", "high")
"""Of the values of figures; the names of x and y carry their units."""
MOST_POINTS, FEW_POINTS = 400, 120
"""Of a series in a page, and in a small figure; the CSV has all."""
PX = (440.0, 310.0)
"""Width and height of a figure; only their ratio matters."""
MARGINS_PX = (58.0, 14.0, 26.0, 48.0)
"""Left, right, top and bottom of the frame. [px]"""
WIDE_PX, SCALE_PX = 720.0, 62.0
"""Width of a figure to scale, which has a line of its own, and room for the scale of a map's colours."""
PLOTLY = Path(__file__).with_name("plotly-cartesian-4.1.1.min.js.gz")
DASHES = {"aim": "6px,4px", "other": "2px,3px"}


@dataclass(frozen=True, eq=False)
class Series:
    """Columns of equal length under a label, NaN where a value is missing, and how they are drawn.

    A band has ``low`` and ``high`` of y over x, or of x over y. A map has its value in both. Bars, from low to high,
    have a name each. ``style`` is one of main, aim, other, alt1 .. alt5, of bands also band, extra, cast.
    """

    label: str
    kind: str
    x: NDArray
    y: NDArray
    low: NDArray
    high: NDArray
    style: str = "main"
    names: tuple[str, ...] = ()
    limits: tuple[float, float] = (0.0, 1.0)

    @classmethod
    def _of(cls, kind: str, label: str, *columns: ArrayLike, **more: Any) -> Series:
        x, y, low, high = (np.array(one) for one in np.broadcast_arrays(*map(_column, columns)))
        return cls(label, kind, x, y, low, high, **more)

    @classmethod
    def line(cls, label: str, x: ArrayLike, y: ArrayLike, style: str = "main") -> Series:
        """A curve; NaN breaks it."""
        return cls._of("line", label, x, y, np.nan, np.nan, style=style)

    @classmethod
    def dots(cls, label: str, x: ArrayLike, y: ArrayLike, style: str = "main") -> Series:
        """Single points."""
        return cls._of("dots", label, x, y, np.nan, np.nan, style=style)

    @classmethod
    def band(
        cls, label: str, at: ArrayLike, low: ArrayLike, high: ArrayLike, sideways: bool = False, style: str = "band"
    ) -> Series:
        """Area between ``low`` and ``high`` over x; ``sideways`` gives x-ranges over y instead."""
        place = (np.nan, at) if sideways else (at, np.nan)
        return cls._of("band", label, *place, low, high, style=style)

    @classmethod
    def bars(cls, names: Sequence[str], low: ArrayLike, high: ArrayLike) -> Series:
        """Horizontal bars from low to high, one a name, the first on top."""
        return cls._of("bars", "", np.nan, np.nan, low, high, names=tuple(names))

    @classmethod
    def map(
        cls,
        label: str,
        x: ArrayLike,
        y: ArrayLike,
        value: ArrayLike,
        limits: tuple[float, float] = (0.0, 1.0),
        smooth: bool = False,
    ) -> Series:
        """Values in colours (rows over y, columns over x); NaN stays empty, ``smooth`` blends neighbours."""
        across, along = np.meshgrid(_column(x), _column(y))
        value = _column(value).ravel()
        style = "smooth" if smooth else "cells"
        return cls._of("map", label, across.ravel(), along.ravel(), value, value, style=style, limits=limits)

    @classmethod
    def ellipse(cls, label: str, x: float, y: float, half_x: float, half_y: float) -> Series:
        """An ellipse with its axes along those of the figure: their ends."""
        low, high = (np.array([x + sign * half_x, y + sign * half_y]) for sign in (-1.0, 1.0))
        return cls._of("ellipse", label, [np.nan, x], [y, np.nan], low, high, style="aim")

    @classmethod
    def words(cls, label: str, x: float, y: float, style: str = "main") -> Series:
        """The label itself, beside the curve that it names, whose values are in the CSV."""
        return cls._of("words", label, [x], [y], np.nan, np.nan, style=style)

    @property
    def sideways(self) -> bool:
        """Whether low and high are those of x."""
        return self.kind == "band" and not np.isfinite(self.x).any()

    @property
    def seen(self) -> bool:
        """Whether there is anything to draw: the band of one subject has no width."""
        return self.kind != "band" or bool(np.any(self.high > self.low))

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values of x and of y that the axes must hold."""
        ends = np.concatenate([self.low, self.high])
        if self.kind == "bars":
            return np.append(ends, 0.0), np.array([0.0, len(self.names)])
        if self.kind == "band":
            return (ends, self.y) if self.sideways else (self.x, ends)
        return self.x, self.y


def _column(values: ArrayLike) -> NDArray:
    return np.asarray(values, float)


@dataclass(frozen=True)
class Plot:
    """A figure: what it shows, its axes with units, a title, and words for those who cannot see it."""

    name: str
    title: str
    alt: str
    x_label: str
    y_label: str
    x_name: str
    y_name: str
    series: Sequence[Series]
    log_x: bool = False
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    note: str = ""
    zero: bool = True
    to_scale: bool = False
    size: tuple[float, float] = PX

    def rows(self) -> Iterator[list[str]]:
        """All values under :data:`COLUMNS`; low and high are those of bands, bars and maps."""
        for one in self.series:
            if one.kind != "words":
                table = zip(*(column.tolist() for column in (one.x, one.y, one.low, one.high)))
                for number, values in enumerate(table):
                    label = one.names[number] if one.names else one.label
                    yield [self.name, label, self.x_name, self.y_name, *map(_text, values)]

    def figure(self) -> dict[str, Any]:
        """What plotly.js draws; colours are names of the page's style."""
        kinds = {one.kind for one in self.series}
        (x_word, x_unit), (_, y_unit) = (_unit(label) for label in (self.x_label, self.y_label))
        x: dict[str, Any] = {"title": {"text": self.x_label.replace(" (", "<br>(")}, **_range(self.x_range, self.log_x)}
        y: dict[str, Any] = {"title": {"text": self.y_label}, **_range(self.y_range)}
        if self.log_x:
            x |= {"type": "log", "dtick": 1}
        if self.zero and "map" not in kinds:
            x |= {"rangemode": "tozero"}
            y |= {"rangemode": "tozero"}
        x["unifiedhovertitle"] = {"text": f"{x_word} %{{x:.4~g}}{x_unit}"}
        bars = next((one for one in self.series if one.kind == "bars"), None)
        if bars is not None:
            y |= {"tickvals": bar_places(bars).tolist(), "ticktext": [*bars.names], "automargin": True}
            y |= {"showgrid": False, "fixedrange": True}
            x["zeroline"] = True
        if self.to_scale:
            y |= {"scaleanchor": "x", "constrain": "domain"}
        mode = "closest" if kinds & {"bars", "map"} else "x unified"
        most = MOST_POINTS if self.size[0] >= PX[0] else FEW_POINTS
        layout = {"xaxis": x, "yaxis": y, "hovermode": mode}
        return {
            "data": [
                trace for one in self.series if one.seen for trace in _traces(one, self.log_x, x_unit, y_unit, most)
            ],
            "layout": layout,
        }

    def change(self, before: Mapping[str, Any], now: Mapping[str, Any]) -> dict[str, Any]:
        """What a page needs to draw ``now`` where :meth:`figure` was ``before``: traces by number, layout, words."""
        pairs = enumerate(zip(before["data"], now["data"], strict=True))
        new = {number: trace for number, (old, trace) in pairs if trace is not old}
        layout = {} if now["layout"] == before["layout"] else {"layout": now["layout"]}
        return {"name": self.name, "title": self.title, "alt": self.alt, "data": new, **layout}

    def legend(self) -> list[tuple[str, str]]:
        """Labels and their marks, as SVG."""
        named = (one for one in self.series if one.label and one.seen and one.kind in _KEYS)
        return list(
            dict.fromkeys(
                (one.label, _KEYS[one.kind].format(one.style, DASHES.get(one.style, "none"))) for one in named
            )
        )

    def html(self, keyed: bool = True) -> str:
        """The figure with caption and legend; until it is drawn its words stand in its place."""
        wide, high = self._size()
        spec = json.dumps(self.figure(), separators=(",", ":"), ensure_ascii=False)
        spec = spec.replace("&", "&amp;").replace("'", "&#39;").replace("<", "&lt;")
        keys = keys_html(self.legend()) if keyed else ""
        note = f"<small>{escape(self.note)}</small>" if self.note else ""
        return (
            f'<figure{" class=wide" if self.to_scale else ""}><div class="plot" role="img" '
            f'aria-label="{escape(self.alt)}" data-name="{escape(self.name)}" style="aspect-ratio:{wide:g}/{high:g}" '
            f"data-plot='{spec}'>{escape(self.alt)}</div>"
            f"<figcaption><strong>{escape(self.title)}</strong>{keys}{note}</figcaption></figure>"
        )

    def _size(self) -> tuple[float, float]:
        """Width and height of the figure. [px]"""
        if not self.to_scale or self.x_range is None or self.y_range is None:
            return self.size
        left, right, top, bottom = MARGINS_PX
        right = SCALE_PX if any(one.kind == "map" for one in self.series) else right
        (start, stop), (low, high) = self.x_range, self.y_range
        return WIDE_PX, top + bottom + (WIDE_PX - left - right) * (high - low) / (stop - start)


def plots_html(plots: Iterable[Plot], small: bool = False) -> str:
    """Plots in a grid, as HTML, with one legend where a mark stands for the same thing in all of them."""
    plots = list(plots)
    keys = dict.fromkeys(key for plot in plots for key in plot.legend())
    shared = len(plots) > 1 and all(len(set(side)) == len(keys) for side in zip(*keys))
    figures = "".join(plot.html(not shared) for plot in plots)
    return f'{keys_html(keys) if shared else ""}<div class="plots{" small" if small else ""}">{figures}</div>'


def keys_html(keys: Iterable[tuple[str, str]]) -> str:
    """Labels behind their marks, as HTML."""
    shown = "".join(
        f'<span class="key"><svg viewBox="0 0 22 12" aria-hidden="true">{mark}</svg>{escape(label)}</span>'
        for label, mark in keys
    )
    return f'<span class="keys">{shown}</span>' if shown else ""


def press_plot(name: str, title: str, alt: str, series: Sequence[Series], x_range: tuple[float, float]) -> Plot:
    """Plot the force of a press over time on a logarithmic axis."""
    labels = ("time since contact [s]", "force [N]", "time_s", "force_N")
    return Plot(name, title, alt, *labels, series, log_x=True, x_range=x_range)


def steady_plot(alt: str, series: Sequence[Series], note: str = "") -> Plot:
    """Plot steady force over depth."""
    labels = ("depth [mm]", "steady force [N]", "depth_mm", "force_N")
    return Plot("steady", "Steady force over depth", alt, *labels, series, note=note)


@cache
def plot_scripts() -> str:
    """What draws the plots of a page, as elements: plotly.js, packed, and the script that unpacks and calls it."""
    packed = base64.b64encode(PLOTLY.read_bytes()).decode("ascii")
    return f'<script type="text/plain" id="plotly">{packed}</script><script>{plots_js()}</script>'


@cache
def plots_js() -> str:
    """The script that draws plots."""
    return Path(__file__).with_name("plots.js").read_text(encoding="utf-8")


def thin(x: NDArray, log: bool, *others: NDArray, most: int = MOST_POINTS) -> list[NDArray]:
    """Keep about so many of more points, evenly along the axis, ends and extremes included."""
    if len(x) <= most:
        return [x, *others]
    position = np.log(np.maximum(x, 1e-12)) if log else x
    cells = np.floor((position - position[0]) / max(position[-1] - position[0], 1e-300) * (most - 1)).astype(int)
    kept = np.r_[True, np.diff(cells) > 0]
    kept[-1] = True
    for values in others:
        if np.isfinite(values).any():
            kept[[int(np.nanargmax(values)), int(np.nanargmin(values))]] = True
    return [values[kept] for values in (x, *others)]


def _text(value: float) -> str:
    """Six digits; nothing where a value is missing."""
    return f"{value:.6g}" if math.isfinite(value) else ""


def _numbers(column: NDArray) -> list[float | None]:
    """The values as they stand in the CSV."""
    return [float(text) if (text := _text(value)) else None for value in column.tolist()]


def _unit(label: str) -> tuple[str, str]:
    """Name and unit of an axis by its label."""
    word, _, unit = label.partition("[")
    unit = unit.rstrip("]")
    return word.partition("(")[0].strip(), f" {unit}" if unit not in ("", "-") else ""


def _range(ends: tuple[float, float] | None, log: bool = False) -> dict[str, Any]:
    return {} if ends is None else {"range": [math.log10(end) if log else float(end) for end in ends]}


def bar_places(bars: Series) -> NDArray:
    """Where bars lie along y, the first on top."""
    return len(bars.names) - 0.5 - np.arange(len(bars.names))


@lru_cache(maxsize=64)
def _traces(one: Series, log_x: bool, x_unit: str, y_unit: str, most: int) -> list[dict[str, Any]]:
    """A series as plotly.js draws it; the same object for the same series, so that what changed is seen."""
    colour = f"var(--{one.style})"
    trace: dict[str, Any] = {"name": one.label, "hovertemplate": f"%{{y:.4~g}}{y_unit}"}
    if one.kind == "band":
        return _band(one, log_x, x_unit, y_unit, most)
    if one.kind == "bars":
        base, end = _numbers(one.low), _numbers(one.high)
        words = f"%{{text}}: %{{base:.4~g}} to %{{customdata:.4~g}}{x_unit}<extra></extra>"
        wide = _numbers(one.high - one.low)
        return [
            {
                "type": "bar",
                "orientation": "h",
                "width": 0.6,
                "y": bar_places(one).tolist(),
                "base": base,
                "x": wide,
                "customdata": end,
                "text": [*one.names],
                "textposition": "none",
                "hovertemplate": words,
                "marker": {"color": "var(--main)"},
            }
        ]
    if one.kind == "map":
        words = f"{one.label} %{{z:.4~g}}<br>at %{{x:.4~g}}{x_unit}, %{{y:.4~g}}{y_unit}<extra></extra>"
        return [
            {
                "type": "heatmap",
                **{side: _numbers(getattr(one, side)) for side in "xy"},
                "z": _numbers(one.low),
                "zmin": one.limits[0],
                "zmax": one.limits[1],
                "colorscale": "Viridis",
                "hovertemplate": words,
                "zsmooth": "best" if one.style == "smooth" else False,
                "hoverongaps": False,
                "colorbar": {"thickness": 12, "outlinewidth": 0},
            }
        ]
    if one.kind == "ellipse":
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        (x_low, y_low), (x_high, y_high) = one.low, one.high
        across, along = (
            0.5 * (low + high + (high - low) * wave(turn))
            for low, high, wave in ((x_low, x_high, np.cos), (y_low, y_high, np.sin))
        )
        return [
            trace
            | {
                "x": _numbers(across),
                "y": _numbers(along),
                "mode": "lines",
                "hoverinfo": "skip",
                "line": {"color": colour},
            }
        ]
    x, y = thin(one.x, log_x, one.y, most=most) if one.kind == "line" else (one.x, one.y)
    trace |= {"x": _numbers(x), "y": _numbers(y)}
    if one.kind == "words":
        return [
            trace
            | {
                "mode": "text",
                "text": [one.label],
                "textposition": "top center",
                "hoverinfo": "skip",
                "textfont": {"color": colour},
            }
        ]
    if one.kind == "dots":
        words = f"{trace['hovertemplate']} at %{{x:.4~g}}{x_unit}"
        return [trace | {"mode": "markers", "marker": {"color": colour}, "hovertemplate": words}]
    return [trace | {"mode": "lines", "line": {"color": colour, "dash": DASHES.get(one.style, "solid")}}]


def _band(one: Series, log_x: bool, x_unit: str, y_unit: str, most: int) -> list[dict[str, Any]]:
    """Both ends of a band as curves with the area between them; the upper one says both."""
    at = one.y if one.sideways else one.x
    known = np.isfinite(at) & np.isfinite(one.low) & np.isfinite(one.high)
    columns = thin(at[known], log_x and not one.sideways, one.low[known], one.high[known], most=most)
    places, low, high = map(_numbers, columns)
    own, across = ("y", "x") if one.sideways else ("x", "y")
    unit, where = (x_unit, f" at %{{y:.4~g}}{y_unit}") if one.sideways else (y_unit, "")
    words = f"%{{customdata:.4~g}} to %{{{across}:.4~g}}{unit}{where}"
    ends = {own: places, "mode": "lines", "line": {"width": 0}}
    area = {"fill": f"tonext{across}", "fillcolor": f"var(--{one.style})", "name": one.label, "customdata": low}
    return [ends | {across: low, "hoverinfo": "skip"}, ends | {across: high, "hovertemplate": words} | area]


_KEYS = {
    "line": '<path d="M1 6L21 6" style="stroke:var(--{0});stroke-width:2;stroke-dasharray:{1}"/>',
    "dots": '<circle cx="11" cy="6" r="4" style="fill:var(--{0})"/>',
    "band": '<rect x="1" y="1" width="20" height="10" style="fill:var(--{0})"/>',
    "ellipse": '<ellipse cx="11" cy="6" rx="9" ry="4" style="fill:none;stroke:var(--{0});stroke-width:2"/>',
}
"""Marks of the legend."""
