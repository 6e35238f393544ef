"""What stands on a drawing, in millimetres on paper: lines, texts, dimensions. No CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

Point = tuple[float, float]
PAPERS = {"A3": (420.0, 297.0), "A4": (297.0, 210.0)}
"""Papers, landscape. [mm]"""
LAYERS = {"outline": 0.5, "thin": 0.18, "cut": 0.7, "bound": 0.18, "hatch": 0.13, "dimension": 0.18, "text": 0.25,
          "frame": 0.5}  # fmt: skip
"""Width of the lines of each layer. [mm]"""
TEXT_MM, CAP_SHARE = 2.5, 0.718
"""Height of the capital letters of the smallest text [mm], and their share of the font size (Helvetica)."""
ARROW_MM = 2.8


@lru_cache(maxsize=4096)
def text_width(words: str, height: float) -> float:
    """Width of a text in Helvetica. [mm]

    Parameters
    ----------
    words : str
    height : float
        Of its capital letters. [mm]
    """
    from reportlab.pdfbase.pdfmetrics import stringWidth

    return float(stringWidth(words, "Helvetica", height / CAP_SHARE))


@dataclass(frozen=True)
class Line:
    """A run of straight pieces."""

    points: tuple[Point, ...]
    layer: str


@dataclass(frozen=True)
class Text:
    """Text with its lower left (or lower middle) at a point; ``height`` is that of its capital letters. [mm]"""

    at: Point
    words: str
    height: float = TEXT_MM
    middle: bool = False
    upright: bool = False

    @property
    def box(self) -> tuple[float, float, float, float]:
        """x low, y low, x high, y high, with descenders. [mm]"""
        long, (x, y) = text_width(self.words, self.height), self.at
        first, last = (-long / 2, long / 2) if self.middle else (0.0, long)
        low, high = -0.3 * self.height, self.height
        if self.upright:
            return x - high, y + first, x - low, y + last
        return x + first, y + low, x + last, y + high


@dataclass(frozen=True)
class Dimension:
    """A linear dimension between two points along x or y; ``at`` is the coordinate of its line.

    ``value`` is the true length [mm], ``enlarged`` the scale of its view over the sheet's. A number that has no room
    between the arrows stands beyond the upper or right end, or before the other one.
    """

    start: Point
    end: Point
    at: float
    vertical: bool
    value: float
    before: bool = False
    enlarged: float = 1.0

    @property
    def line(self) -> tuple[Point, Point]:
        """Ends of the dimension line."""
        if self.vertical:
            return (self.at, self.start[1]), (self.at, self.end[1])
        return (self.start[0], self.at), (self.end[0], self.at)

    @property
    def text(self) -> Text:
        """The number, on the line's upper side, or outside it where the gap is too narrow."""
        a, b = self.line
        words = number(self.value)
        wide, axis = text_width(words, TEXT_MM), int(self.vertical)
        middle = (a[axis] + b[axis]) / 2
        if abs(b[axis] - a[axis]) < wide + 2 * ARROW_MM:
            beside = ARROW_MM + 1.5 + wide / 2
            middle = min(a[axis], b[axis]) - beside if self.before else max(a[axis], b[axis]) + beside
        at = (self.at - 1.0, middle) if self.vertical else (middle, self.at + 1.0)
        return Text(at, words, TEXT_MM, True, self.vertical)

    @property
    def reach(self) -> tuple[float, float]:
        """What the dimension takes of its lane, arrows and number included. [mm]"""
        a, b = self.line
        axis = int(self.vertical)
        low, high = sorted((a[axis], b[axis]))
        box = self.text.box
        outside = 0.0 if high - low > 3 * ARROW_MM else ARROW_MM
        return min(low - outside, box[axis]), max(high + outside, box[axis + 2])

    def marks(self) -> tuple[list[tuple[Point, Point]], list[tuple[Point, ...]]]:
        """Lines and filled arrow heads."""
        a, b = self.line
        length = math.dist(a, b)
        ux, uy = ((b[0] - a[0]) / length, (b[1] - a[1]) / length) if length else (1.0, 0.0)
        # Arrows point outwards in a narrow gap, so that they do not cross.
        inwards = 1.0 if length > 3 * ARROW_MM else -1.0
        heads = []
        for tip, sign in ((a, inwards), (b, -inwards)):
            bx, by = tip[0] + sign * ARROW_MM * ux, tip[1] + sign * ARROW_MM * uy
            nx, ny = -0.5 * uy, 0.5 * ux
            heads.append((tip, (bx + nx, by + ny), (bx - nx, by - ny)))
        return [(self.start, a), (self.end, b), (a, b)], heads


@dataclass
class Drawing:
    """A sheet: lines, texts and dimensions in paper millimetres, ``scale`` paper over part."""

    title: str
    scale: float
    paper: str = "A3"
    lines: list[Line] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)
    dimensions: list[Dimension] = field(default_factory=list)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the paper. [mm]"""
        return PAPERS[self.paper]

    def boxes(self) -> list[tuple[str, tuple[float, float, float, float]]]:
        """Every text with its box, those of the dimensions among them."""
        texts = [*self.texts, *(d.text for d in self.dimensions)]
        return [(text.words, text.box) for text in texts]


def number(value: float) -> str:
    """Length as drawn: two decimals, trailing zeros off."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def ratio(scale: float) -> str:
    """Scale as it stands in a title block: ``1:2``."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"
