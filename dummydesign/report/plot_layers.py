"""What a plot shows: lines, bands, points, bars, maps, an ellipse. Plain values, drawn by ``plot``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_POINTS = 240
UNSEEN_PX = 0.04
"""A point this near the line through its neighbours is left out; enlarged twenty times it is a pixel. [px]"""
Record = tuple[str, float | str, float | str, float | str, float | str]
"""One line of a plot's CSV: series, x, y, low, high."""


def _column(values: ArrayLike) -> NDArray:
    return np.asarray(values, float)


@dataclass(frozen=True)
class Line:
    """A curve; ``style`` is one of main, aim, other, alt1 .. alt5. NaN breaks it."""

    name: str
    x: ArrayLike
    y: ArrayLike
    style: str = "main"

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold."""
        return _column(self.x), _column(self.y)

    def records(self) -> Iterator[Record]:
        """Lines of the CSV."""
        for x, y in zip(_column(self.x).tolist(), _column(self.y).tolist()):
            yield self.name, x, y, "", ""


@dataclass(frozen=True)
class Dots(Line):
    """Single points."""


@dataclass(frozen=True)
class Label:
    """Words at a place, beside the curve that they name; ``style`` is that of the curve."""

    name: str
    x: float
    y: float
    style: str = "main"

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold."""
        return np.array([self.x]), np.array([self.y])

    def records(self) -> Iterator[Record]:
        """Nothing: the curve's own values are in the CSV."""
        return iter(())


@dataclass(frozen=True)
class Band:
    """Area between ``low`` and ``high`` over x; ``sideways`` gives x-ranges over y instead."""

    name: str
    at: ArrayLike
    low: ArrayLike
    high: ArrayLike
    sideways: bool = False
    style: str = "band"

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold."""
        at = np.concatenate([_column(self.at)] * 2)
        ends = np.concatenate([_column(self.low), _column(self.high)])
        return (ends, at) if self.sideways else (at, ends)

    def records(self) -> Iterator[Record]:
        """Lines of the CSV; low and high are of x when sideways."""
        for at, low, high in zip(*(_column(values).tolist() for values in (self.at, self.low, self.high))):
            yield (self.name, "", at, low, high) if self.sideways else (self.name, at, "", low, high)


@dataclass(frozen=True)
class Bars:
    """Horizontal bars from low to high, one a label (a tornado)."""

    name: str
    labels: Sequence[str]
    low: ArrayLike
    high: ArrayLike

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold."""
        ends = np.concatenate([_column(self.low), _column(self.high), [0.0]])
        return ends, np.array([0.0, len(self.labels)], float)

    def records(self) -> Iterator[Record]:
        """Lines of the CSV."""
        for label, low, high in zip(self.labels, _column(self.low).tolist(), _column(self.high).tolist()):
            yield label, "", "", low, high


@dataclass(frozen=True)
class Cells:
    """A map of values (rows over y, columns over x) from ``low`` to ``high``; NaN stays empty.

    ``smooth`` blends the colours of neighbours.
    """

    name: str
    x: ArrayLike
    y: ArrayLike
    value: ArrayLike
    low: float = 0.0
    high: float = 1.0
    smooth: bool = False

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold: the outer edges of the cells."""
        return edges(_column(self.x))[[0, -1]], edges(_column(self.y))[[0, -1]]

    def records(self) -> Iterator[Record]:
        """Lines of the CSV; the value stands under low and high."""
        across = _column(self.x).tolist()
        for y, row in zip(_column(self.y).tolist(), _column(self.value).tolist()):
            for x, value in zip(across, row):
                yield self.name, x, y, value, value


@dataclass(frozen=True)
class Ellipse:
    """An ellipse with its axes along those of the plot."""

    name: str
    x: float
    y: float
    half_x: float
    half_y: float

    def extent(self) -> tuple[NDArray, NDArray]:
        """Values that the axes must hold (none: it is cut off)."""
        return np.array([self.x]), np.array([self.y])

    def records(self) -> Iterator[Record]:
        """Lines of the CSV: its ends along both axes."""
        yield self.name, "", self.y, self.x - self.half_x, self.x + self.half_x
        yield self.name, self.x, "", self.y - self.half_y, self.y + self.half_y


Layer = Line | Band | Bars | Cells | Ellipse | Label


def edges(centres: NDArray) -> NDArray:
    """Edges of cells around rising centres, half-way between them."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.r_[2 * centres[0] - middle[0], middle, 2 * centres[-1] - middle[-1]]


def corners(across: NDArray, along: NDArray, tolerance: float = UNSEEN_PX) -> NDArray:
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


def thin(x: NDArray, log: bool, *others: NDArray) -> list[NDArray]:
    """Keep at most :data:`MOST_POINTS` of many points, evenly along the axis, ends and extremes included."""
    if len(x) <= MOST_POINTS:
        return [x, *others]
    position = np.log(np.maximum(x, 1e-12)) if log else x
    cells = np.floor((position - position[0]) / max(position[-1] - position[0], 1e-300) * (MOST_POINTS - 1)).astype(int)
    kept = np.r_[True, np.diff(cells) > 0]
    kept[-1] = True
    for values in others:
        if np.isfinite(values).any():
            kept[[int(np.nanargmax(values)), int(np.nanargmin(values))]] = True
    return [values[kept] for values in (x, *others)]
