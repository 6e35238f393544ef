"""A drawing in millimetres on paper: lines, texts, dimensions, hatching, title block; as DXF, SVG and PDF."""

from __future__ import annotations

import html
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from dummydesign.core.typeset import FONTS, typeset

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""x low, y low, x high, y high. [mm]"""
PAPERS = {"A3": (420.0, 297.0), "A4": (297.0, 210.0)}
"""Papers, landscape. [mm]"""
LAYERS = {
    "outline": 0.5,
    "thin": 0.18,
    "cut": 0.7,
    "bound": 0.18,
    "hatch": 0.13,
    "dimension": 0.18,
    "text": 0.25,
    "frame": 0.5,
}
"""Width of the lines of each layer. [mm]"""
TEXT_MM, CAP_SHARE = 2.5, 0.718
"""Height of the capital letters of the smallest text [mm], and their share of the font size (Helvetica)."""
ARROW_MM = 2.8
TEMPLATE = Path(__file__).with_name("drawings.typ")
FONT_SIZE = 2048
"""Size at which letters are measured: that of the font's own grid."""


@cache
def _letter_width(letter: str) -> float:
    """Width of a letter over the size of its text."""
    return float(_font().getlength(letter)) / FONT_SIZE


@cache
def _font() -> Any:
    from PIL import ImageFont

    return ImageFont.truetype(
        str(FONTS / "LiberationSans-Regular.ttf"), FONT_SIZE, layout_engine=ImageFont.Layout.BASIC
    )


def text_width(words: str, height: float) -> float:
    """Width of a text in Helvetica, as wide as which Liberation Sans is. [mm]"""
    return sum(map(_letter_width, words)) * height / CAP_SHARE


@dataclass(frozen=True)
class Line:
    """A run of straight pieces; ``of_part`` where it is the part at the scale of the sheet, not frame or detail."""

    points: tuple[Point, ...]
    layer: str
    of_part: bool = False


@dataclass(frozen=True)
class Text:
    """Text with its lower left (or lower middle) at a point; ``height`` is that of its capital letters. [mm]"""

    at: Point
    words: str
    height: float = TEXT_MM
    middle: bool = False
    upright: bool = False

    @property
    def box(self) -> Box:
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
    between the arrows, or stands ``aside``, is beyond the upper or right end, or before the other one, so far off.
    """

    start: Point
    end: Point
    at: float
    vertical: bool
    value: float
    before: bool = False
    enlarged: float = 1.0
    aside: float = 0.0

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
        words = number_text(self.value)
        wide, axis = text_width(words, TEXT_MM), int(self.vertical)
        middle = (a[axis] + b[axis]) / 2
        if self.aside or abs(b[axis] - a[axis]) < wide + 2 * ARROW_MM:
            offset = ARROW_MM + 1.5 + wide / 2 + self.aside
            middle = min(a[axis], b[axis]) - offset if self.before else max(a[axis], b[axis]) + offset
        at = (self.at - 1.0, middle) if self.vertical else (middle, self.at + 1.0)
        return Text(at, words, TEXT_MM, True, self.vertical)

    @property
    def reach(self) -> tuple[float, float]:
        """What the dimension takes of its lane, arrows and number included. [mm]"""
        axis, box = int(self.vertical), self.text.box
        low, high = sorted(end[axis] for end in self.line)
        outside = 0.0 if high - low > 3 * ARROW_MM else ARROW_MM
        return min(low - outside, box[axis]), max(high + outside, box[axis + 2])

    @property
    def boxes(self) -> list[Box]:
        """Boxes of the number and of each line. [mm]"""
        lines = ((min(p[0], q[0]), min(p[1], q[1]), max(p[0], q[0]), max(p[1], q[1])) for p, q in self.marks()[0])
        return [self.text.box, *lines]

    def marks(self) -> tuple[list[tuple[Point, Point]], list[tuple[Point, ...]]]:
        """Lines and filled arrow heads."""
        a, b = self.line
        length = math.dist(a, b)
        ux, uy = ((b[0] - a[0]) / length, (b[1] - a[1]) / length) if length else (1.0, 0.0)
        # Arrows point outwards in a narrow gap, so that they do not cross.
        inwards = 1.0 if length > 3 * ARROW_MM else -1.0
        heads: list[tuple[Point, ...]] = []
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

    @property
    def all_texts(self) -> list[Text]:
        """Every text, those of the dimensions among them."""
        return [*self.texts, *(d.text for d in self.dimensions)]


def number_text(value: float) -> str:
    """Length as drawn: two decimals, trailing zeros off."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


FORBIDDEN = r"""[<>/\\":;?*=`|]"""
"""Signs that the name of a layout must not have."""


def to_dxf(sheets: Sequence[Drawing]) -> str:
    """Write sheets as one DXF R2010 in millimetres; equal sheets, equal files.

    Model space holds the parts side by side at 1:1 with dimensions that measure them, so that they can be cut from.
    Each sheet, with frame, texts and enlarged details, is a layout of its own; its viewport scales the model.
    """
    import ezdxf
    from ezdxf.sections.classes import REQ_R2000

    fixed, ezdxf.options.write_fixed_meta_data_for_testing = ezdxf.options.write_fixed_meta_data_for_testing, True
    try:
        document = ezdxf.new("R2010", setup=["dimstyles:metric"])
        document.units = ezdxf.units.MM
        for name, width in LAYERS.items():
            document.layers.add(name, lineweight=round(100 * width))
        document.layers.add("viewport").off()
        left = 0.0
        for number, sheet in enumerate(sheets, 1):
            name = f"{number} {re.sub(FORBIDDEN, '-', sheet.title.partition(',')[0])}"
            if number == 1:
                document.layouts.rename("Layout1", name)
            page: Any = document.layout(name) if number == 1 else document.layouts.new(name)
            _dxf_sheet(document.modelspace(), page, sheet, left)
            left += sheet.size[0] / sheet.scale
        # Left to itself the library adds the last of these in the order of a set, which differs between processes.
        for name in REQ_R2000:
            document.classes.add_class(name)
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue()
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = fixed


def _dxf_sheet(model: Any, page: Any, sheet: Drawing, left: float) -> None:
    """One sheet on its layout, its part in model space from ``left`` on. [mm]"""
    (wide, high), whole = sheet.size, 1.0 / sheet.scale
    page.page_setup(size=sheet.size, margins=(0, 0, 0, 0), units="mm")
    view = page.add_viewport(
        (wide / 2, high / 2), sheet.size, (left + whole * wide / 2, whole * high / 2), whole * high, status=2
    )
    view.dxf.layer = "viewport"
    # edges come from the solid in an order that differs between processes
    for line in sorted(sheet.lines, key=lambda one: (one.layer, one.points)):
        space, factor, shift = (model, whole, left) if line.of_part else (page, 1.0, 0.0)
        points = [(shift + factor * x, factor * y) for x, y in line.points]
        space.add_lwpolyline(points, dxfattribs={"layer": line.layer})
    _dxf_texts(page, sheet)
    for d in sheet.dimensions:
        space, factor, shift = (page, 1.0, 0.0) if d.enlarged != 1.0 else (model, whole, left)
        _dxf_dimension(space, factor, shift, d, sheet)


def _dxf_texts(page: Any, sheet: Drawing) -> None:
    """The texts of the sheet on its page."""
    from ezdxf.enums import TextEntityAlignment

    for text in sheet.texts:
        alignment = TextEntityAlignment.BOTTOM_CENTER if text.middle else TextEntityAlignment.BOTTOM_LEFT
        turn = 90.0 if text.upright else 0.0
        entity = page.add_text(text.words, height=text.height, rotation=turn, dxfattribs={"layer": "text"})
        entity.set_placement(text.at, align=alignment)


def _dxf_dimension(space: Any, factor: float, shift: float, d: Dimension, sheet: Drawing) -> None:
    """A dimension that measures its own length; one of a detail on the page divides by the detail's scale."""
    measured = 1.0 / (factor * sheet.scale * d.enlarged)
    base, start, end = ((shift + factor * x, factor * y) for x, y in (d.line[0], d.start, d.end))
    style = {
        "dimtxt": factor * TEXT_MM,
        "dimasz": factor * ARROW_MM,
        "dimexe": factor * 1.25,
        "dimexo": 0.0,
        "dimgap": factor * 0.6,
        "dimscale": 1.0,
        "dimlfac": measured,
        "dimdec": 2,
        "dimzin": 8,
        "dimrnd": 0.0,
        "dimclrt": 7,
    }
    space.add_linear_dim(
        base=base,
        p1=start,
        p2=end,
        angle=90 if d.vertical else 0,
        dimstyle="EZDXF",
        override=style,
        dxfattribs={"layer": "dimension"},
    ).render()


FILLED = {"gel": "#dbe8f5", "lower gel": "#b9cfe4", "hard": "#8d99a5", "steel": "#e3e7eb"}
"""Colours of areas, which are no lines of a mould's drawings."""


def to_svg(sheet: Drawing, size: tuple[float, float] | None = None) -> str:
    """Write the sheet as SVG in the size of its paper, or in another. [mm]"""
    w, h = size or sheet.size
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w:g}mm" height="{h:g}mm" viewBox="0 0 {w:g} {h:g}" '
        'xml:space="preserve">',
        f"<title>{html.escape(sheet.title)}</title>",
        f'<rect width="{w:g}" height="{h:g}" fill="#fff"/>',
        '<g fill="none" stroke="#111" stroke-linejoin="round" stroke-linecap="round">',
    ]
    for line in sheet.lines:
        points = " ".join(f"{x:.3f},{h - y:.3f}" for x, y in line.points)
        filled = f' fill="{FILLED[line.layer]}"' if line.layer in FILLED else ""
        out.append(f'<polyline stroke-width="{LAYERS.get(line.layer, 0.18)}"{filled} points="{points}"/>')
    out.append("</g>")
    for d in sheet.dimensions:
        lines, heads = d.marks()
        drawn = "".join(f'<path d="M{p[0]:.3f} {h - p[1]:.3f}L{q[0]:.3f} {h - q[1]:.3f}"/>' for p, q in lines)
        for corners in heads:
            drawn += '<path fill="#111" d="M' + "L".join(f"{x:.3f} {h - y:.3f}" for x, y in corners) + 'Z"/>'
        out.append(f'<g stroke="#111" stroke-width="{LAYERS["dimension"]}" fill="none">{drawn}</g>')
    return "\n".join([*out, *(_svg_text(text, h) for text in sheet.all_texts), "</svg>", ""])


def _svg_text(text: Text, h: float) -> str:
    x, y = text.at[0], h - text.at[1]
    anchor = ' text-anchor="middle"' if text.middle else ""
    turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if text.upright else ""
    return (
        f'<text x="{x:.3f}" y="{y:.3f}" font-family="Helvetica, Liberation Sans, Arial, sans-serif" '
        f'font-size="{text.height / CAP_SHARE:.2f}" fill="#111"{anchor}{turn}>{html.escape(text.words)}</text>'
    )


def to_pdf(sheets: Sequence[Drawing], title: str) -> bytes:
    """Write sheets as PDF, a page each; a millimetre of the drawing is a millimetre of the page."""
    pages = [{"title": one.title, "size": one.size, "svg": to_svg(one)} for one in sheets]
    return typeset(TEMPLATE, {"title": title, "pages": pages})
