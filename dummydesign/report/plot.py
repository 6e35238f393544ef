"""Plots as inline SVG: axes, maps, and their values as CSV."""

from __future__ import annotations

import base64
import math
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.interpolation import true_runs
from dummydesign.report.plot_layers import Band, Bars, Cells, Dots, Ellipse, Label, Layer, Line, corners, edges, thin

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


# Dark violet to yellow with even steps of lightness, readable without colour vision.
STOPS = np.array(
    [(68, 1, 84), (70, 50, 127), (54, 92, 141), (39, 127, 142), (31, 161, 135), (74, 194, 109), (159, 218, 58),
     (253, 231, 37)], float,
)  # fmt: skip


def colours(share: NDArray) -> NDArray:
    """Colours (..., 3) from 0 to 255 of shares between 0 and 1."""
    position = np.clip(np.nan_to_num(share), 0.0, 1.0) * (len(STOPS) - 1)
    return np.stack([np.interp(position, np.arange(len(STOPS)), STOPS[:, band]) for band in range(3)], axis=-1)


def css(share: float) -> str:
    """One colour as CSS."""
    red, green, blue = colours(np.array(share)).round().astype(int)
    return f"#{red:02x}{green:02x}{blue:02x}"


def png_uri(share: NDArray) -> str:
    """Map (rows, columns) of shares as a data URI, first row at the bottom, cells without a value transparent.

    References
    ----------
    W3C, Portable Network Graphics (second edition), chapters 10 and 11.
    """
    opaque = np.where(np.isfinite(share), 255, 0)[..., None]
    pixels = np.concatenate([colours(share).round(), opaque], axis=-1).astype(np.uint8)[::-1]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", share.shape[1], share.shape[0], 8, 6, 0, 0, 0)
    parts = [chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows, 9)), chunk(b"IEND", b"")]
    return "data:image/png;base64," + base64.b64encode(b"\x89PNG\r\n\x1a\n" + b"".join(parts)).decode("ascii")


WIDTH, HEIGHT = 440.0, 310.0
WIDE = 720.0
"""Of a figure to scale, which has a line of its own. The unit of all lengths is a pixel at the smallest size."""
LEFT, RIGHT, TOP, BOTTOM = 58.0, 14.0, 14.0, 48.0
MAP_RIGHT, BAR_LEFT = 62.0, 170.0
_STOPS = " ".join(css(k / (len(STOPS) - 1)) for k in range(len(STOPS)))
LETTER = 6.6  # mean width of a letter of 13 px


COLUMNS = ("figure", "series", "x_name", "y_name", "x", "y", "low", "high")
"""Of the values of figures; the names of x and y carry their units."""


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
    layers: Sequence[Layer]
    log_x: bool = False
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    note: str = ""
    zero: bool = True
    to_scale: bool = False
    size: tuple[float, float] = (WIDTH, HEIGHT)

    def rows(self) -> Iterator[list[str]]:
        """All plotted values under :data:`COLUMNS`; low and high are those of bands, bars and maps."""
        for layer in self.layers:
            for series, *values in layer.records():
                yield [self.name, series, self.x_name, self.y_name, *map(_text, values)]

    def svg(self) -> str:
        """The figure as SVG with its alternative text, and the ends of its axes for the page's script."""
        x, y = self.axes()
        clip = f"clip-{escape(self.name)}"
        return "".join(
            [
                f'<svg class="plot" viewBox="0 0 {self._width:g} {self._height:g}" role="img" '
                f'aria-label="{escape(self.alt)}" data-x="{_ends(x)}" data-y="{_ends(y)}">',
                f"<title>{escape(self.title)}</title><desc>{escape(self.alt)}</desc>",
                f'<clipPath id="{clip}"><rect x="{x.start:g}" y="{y.stop:g}" width="{x.stop - x.start:g}" '
                f'height="{y.start - y.stop:g}"/></clipPath>',
                f'<g class="ticks">{self._ticks(x, y)}</g>{self._labels(x, y)}',
                f'<g clip-path="url(#{clip})">',
                *(_DRAW[type(layer)](layer, x, y) for layer in self.layers),
                "</g>",
                *(_scale(layer, x, y) for layer in self.layers if isinstance(layer, Cells)),
                f'<rect class="frame" x="{x.start:g}" y="{y.stop:g}" width="{x.stop - x.start:g}" '
                f'height="{y.start - y.stop:g}"/></svg>',
            ]
        )

    def legend(self) -> str:
        """Names beside their colours, as HTML."""
        entries: dict[str, tuple[str, str]] = {}
        for layer in self.layers:
            if not isinstance(layer, Bars | Cells | Label):
                entries.setdefault(layer.name, (_KEYS[type(layer)], getattr(layer, "style", "main")))
        return "".join(
            f'<span class="key"><svg viewBox="0 0 22 12" aria-hidden="true">{shape.format(style=style)}</svg>'
            f"{escape(name)}</span>"
            for name, (shape, style) in entries.items()
            if name
        )

    def html(self) -> str:
        """The figure with caption and legend."""
        note = f"<small>{escape(self.note)}</small>" if self.note else ""
        wide = ' class="wide"' if self.to_scale else ""
        return (
            f"<figure{wide}>{self.svg()}<figcaption><strong>{escape(self.title)}</strong>"
            f'<span class="keys">{self.legend()}</span>{note}</figcaption></figure>'
        )

    def axes(self) -> tuple[Axis, Axis]:
        """Both axes with their ranges and places."""
        parts = [layer.extent() for layer in self.layers]
        xs = np.concatenate([part[0] for part in parts]).tolist() if parts else []
        ys = np.concatenate([part[1] for part in parts]).tolist() if parts else []
        cells, bars = self._has(Cells), self._has(Bars)
        x_range = self.x_range or span(xs, self.zero and not bars and not cells, 0.0 if cells else 0.04)
        y_range = self.y_range or span(ys, self.zero and not cells, 0.0 if cells or bars else 0.04)
        left, right = (BAR_LEFT if bars else LEFT), (MAP_RIGHT if cells else RIGHT)
        if bars:
            longest = max(len(label) for layer in self.layers if isinstance(layer, Bars) for label in layer.labels)
            left = min(max(BAR_LEFT, LETTER * longest + 14.0), 0.55 * self._width)
        across = Axis(self.x_label, *x_range, left, self._width - right, self.log_x)
        return across, Axis(self.y_label, *y_range, self._height - BOTTOM, TOP)

    @property
    def _width(self) -> float:
        return WIDE if self.to_scale else self.size[0]

    @property
    def _height(self) -> float:
        if not self.to_scale or self.x_range is None or self.y_range is None:
            return self.size[1]
        right = MAP_RIGHT if self._has(Cells) else RIGHT
        (left_end, right_end), (low, high) = self.x_range, self.y_range
        return TOP + BOTTOM + (self._width - LEFT - right) * (high - low) / (right_end - left_end)

    def _has(self, kind: type) -> bool:
        return any(isinstance(layer, kind) for layer in self.layers)

    def _ticks(self, x: Axis, y: Axis) -> str:
        parts = []
        for value, text in x.ticks(round(6 * self._width / WIDTH)):
            at = x.position(value)
            parts.append(f'<line class="grid" x1="{at:.1f}" x2="{at:.1f}" y1="{y.start:g}" y2="{y.stop:g}"/>')
            parts.append(f'<text x="{at:.1f}" y="{y.start + 16:g}" text-anchor="middle">{text}</text>')
        for value, text in [] if self._has(Bars) else y.ticks(round(5 * min(self._height / HEIGHT, 1.0))):
            at = y.position(value)
            parts.append(f'<line class="grid" x1="{x.start:g}" x2="{x.stop:g}" y1="{at:.1f}" y2="{at:.1f}"/>')
            parts.append(f'<text x="{x.start - 6:g}" y="{at + 4:.1f}" text-anchor="end">{text}</text>')
        return "".join(parts)

    def _labels(self, x: Axis, y: Axis) -> str:
        middle, height, foot = 0.5 * (x.start + x.stop), 0.5 * (y.start + y.stop), self._height - 10.0
        across = f'<text class="label" x="{middle:g}" y="{foot:g}" text-anchor="middle">{escape(x.label)}</text>'
        if self._has(Bars):
            return across
        return (
            f'{across}<text class="label" transform="translate(15 {height:g}) rotate(-90)" '
            f'text-anchor="middle">{escape(y.label)}</text>'
        )


def press_plot(name: str, title: str, alt: str, layers: Sequence[Layer], x_range: tuple[float, float]) -> Plot:
    """Plot the force of a press over time on a logarithmic axis."""
    return Plot(
        name,
        title,
        alt,
        "time since contact [s]",
        "force [N]",
        "time_s",
        "force_N",
        layers,
        log_x=True,
        x_range=x_range,
    )


def steady_plot(alt: str, layers: Sequence[Layer], note: str = "") -> Plot:
    """Plot steady force over depth."""
    return Plot(
        "steady",
        "Steady force over depth",
        alt,
        "depth [mm]",
        "steady force [N]",
        "depth_mm",
        "force_N",
        layers,
        note=note,
    )


def _text(value: float | str) -> str:
    """Six digits; nothing where a value is missing."""
    if isinstance(value, str):
        return value
    return f"{value:.6g}" if math.isfinite(value) else ""


def _ends(axis: Axis) -> str:
    """Values and places of both ends of an axis; ``log`` behind them where it is logarithmic."""
    return f"{axis.low:.7g} {axis.high:.7g} {axis.start:g} {axis.stop:g}{' log' if axis.log else ''}"


def _path(x: Axis, y: Axis, xs: np.ndarray, ys: np.ndarray) -> str:
    """Path through points, broken where one is missing, without those that no one would see."""
    across, along = x.positions(xs), y.positions(ys)
    words = []
    for start, stop in true_runs(np.isfinite(across) & np.isfinite(along)):
        kept = corners(across[start:stop], along[start:stop])
        points = zip(across[start:stop][kept].tolist(), along[start:stop][kept].tolist())
        words.append("M" + "L".join([f"{_short(a)} {_short(b)}" for a, b in points]))
    return "".join(words)


def _short(value: float) -> str:
    """Hundredths of a pixel, so that an enlarged curve is smooth."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _line(layer: Line, x: Axis, y: Axis) -> str:
    xs, ys = thin(np.asarray(layer.x, float), x.log, np.asarray(layer.y, float))
    return f'<path class="line {layer.style}" data-n="{escape(layer.name)}" d="{_path(x, y, xs, ys)}"/>'


def _dots(layer: Dots, x: Axis, y: Axis) -> str:
    circles = "".join(
        f'<circle class="dot {layer.style}" cx="{x.position(a):.1f}" cy="{y.position(b):.1f}" r="4"/>'
        for a, b in zip(np.asarray(layer.x, float).tolist(), np.asarray(layer.y, float).tolist())
        if a == a and b == b
    )
    return f'<g data-n="{escape(layer.name)}">{circles}</g>'


def _band(layer: Band, x: Axis, y: Axis) -> str:
    log = x.log and not layer.sideways
    at, low, high = thin(np.asarray(layer.at, float), log, np.asarray(layer.low, float), np.asarray(layer.high, float))
    at, ends = np.r_[at, at[::-1]], np.r_[low, high[::-1]]
    path = _path(x, y, ends, at) if layer.sideways else _path(x, y, at, ends)
    sideways = ' data-s="1"' if layer.sideways else ""
    return f'<path class="area {layer.style}" data-n="{escape(layer.name)}"{sideways} d="{path}Z"/>'


def _bars(layer: Bars, x: Axis, y: Axis) -> str:
    bars, labels, zero, count = "", "", x.position(0.0), len(layer.labels)
    ends = (x.positions(np.asarray(end, float)) for end in (layer.low, layer.high))
    for row, (label, left, right) in enumerate(zip(layer.labels, *ends)):
        top, middle, bottom = (y.position(count - row - share) for share in (0.2, 0.5, 0.8))
        bars += (
            f'<rect class="bar" data-n="{escape(label)}" x="{left:.1f}" y="{top:.1f}" '
            f'width="{max(right - left, 1):.1f}" height="{bottom - top:.1f}"/>'
        )
        labels += f'<text x="{x.start - 6:g}" y="{middle + 4:.1f}" text-anchor="end">{escape(label)}</text>'
    bars += f'<line class="line other" x1="{zero:.1f}" x2="{zero:.1f}" y1="{y.start:g}" y2="{y.stop:g}"/>'
    # the labels stand left of the frame, outside the clipped group
    return f"{bars}</g><g>{labels}"


def _cells(layer: Cells, x: Axis, y: Axis) -> str:
    value = (np.asarray(layer.value, float) - layer.low) / (layer.high - layer.low)
    across, along = edges(np.asarray(layer.x, float)), edges(np.asarray(layer.y, float))
    if all(np.ptp(np.diff(side)) < 1e-6 * np.ptp(side) for side in (across, along)):
        drawn = "auto" if layer.smooth else "pixelated"
        left, right = x.position(across[0]), x.position(across[-1])
        top, bottom = y.position(along[-1]), y.position(along[0])
        return (
            f'<image data-n="{escape(layer.name)}" data-v="{layer.low:g} {layer.high:g}" data-c="{_STOPS}" '
            f'href="{png_uri(value)}" x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
            f'height="{bottom - top:.1f}" preserveAspectRatio="none" style="image-rendering:{drawn}"/>'
        )
    sides, heights = x.positions(across), y.positions(along)
    return "".join(
        f'<rect fill="{css(value[row, column])}" x="{sides[column]:.1f}" y="{heights[row + 1]:.1f}" '
        f'width="{sides[column + 1] - sides[column]:.2f}" height="{heights[row] - heights[row + 1]:.2f}"/>'
        for row, column in zip(*np.nonzero(np.isfinite(value)))
    )


def _scale(layer: Cells, x: Axis, y: Axis) -> str:
    """Colour bar beside a map."""
    left, count = x.stop + 10.0, 32
    step = (y.start - y.stop) / count
    parts = [
        f'<rect fill="{css((row + 0.5) / count)}" x="{left:g}" y="{y.start - (row + 1) * step:.1f}" width="12" '
        f'height="{step + 0.3:.1f}"/>'
        for row in range(count)
    ]
    for value, text in Axis("", layer.low, layer.high, y.start, y.stop).ticks(4):
        height = y.position(y.low + (value - layer.low) / (layer.high - layer.low) * (y.high - y.low))
        parts.append(f'<text x="{left + 16:g}" y="{height + 4:.1f}">{text}</text>')
    return "".join(parts)


def _ellipse(layer: Ellipse, x: Axis, y: Axis) -> str:
    wide = abs(x.position(layer.x + layer.half_x) - x.position(layer.x))
    high = abs(y.position(layer.y + layer.half_y) - y.position(layer.y))
    centre = f'cx="{x.position(layer.x):.1f}" cy="{y.position(layer.y):.1f}"'
    geometry = f'{centre} rx="{max(wide, 1):.1f}" ry="{max(high, 1):.1f}"'
    return f'<ellipse class="ellipse halo" {geometry}/><ellipse class="ellipse" {geometry}/>'


def _label(layer: Label, x: Axis, y: Axis) -> str:
    right = x.position(layer.x) > 0.6 * x.stop + 0.4 * x.start
    side = ("end", -5) if right else ("start", 5)
    anchor = f'x="{x.position(layer.x) + side[1]:.1f}" y="{y.position(layer.y) - 5:.1f}" text-anchor="{side[0]}"'
    return f'<text class="direct {layer.style}" {anchor}>{escape(layer.name)}</text>'


_KEYS: dict[type, str] = {
    Line: '<path class="line {style}" d="M1 6L21 6"/>',
    Dots: '<circle class="dot {style}" cx="11" cy="6" r="4"/>',
    Band: '<rect class="area {style}" x="1" y="1" width="20" height="10"/>',
    Ellipse: '<ellipse class="ellipse" cx="11" cy="6" rx="9" ry="4"/>',
}
"""Marks of the legend."""
_DRAW: dict[type, Any] = {
    Line: _line,
    Dots: _dots,
    Band: _band,
    Bars: _bars,
    Cells: _cells,
    Ellipse: _ellipse,
    Label: _label,
}
