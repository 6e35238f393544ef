"""A drawing in millimetres on paper: lines, texts, dimensions, hatching, title block; as DXF, SVG and PDF."""

from __future__ import annotations

import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""x low, y low, x high, y high. [mm]"""
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
    """Width of a text in Helvetica. [mm]"""
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
        words = number_text(self.value)
        wide, axis = text_width(words, TEXT_MM), int(self.vertical)
        middle = (a[axis] + b[axis]) / 2
        if abs(b[axis] - a[axis]) < wide + 2 * ARROW_MM:
            offset = ARROW_MM + 1.5 + wide / 2
            middle = min(a[axis], b[axis]) - offset if self.before else max(a[axis], b[axis]) + offset
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

    def boxes(self) -> list[tuple[str, Box]]:
        """Every text with its box."""
        return [(text.words, text.box) for text in self.all_texts]


def number_text(value: float) -> str:
    """Length as drawn: two decimals, trailing zeros off."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def ratio(scale: float) -> str:
    """Scale as it stands in a title block: ``1:2``."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def hatch(loops: Sequence[Sequence[Point]], pitch: float) -> list[tuple[Point, ...]]:
    """Lines at 45 degrees inside closed loops (even-odd rule), ``pitch`` apart. [mm on paper]"""
    root = math.sqrt(0.5)
    # Turn by -45 degrees, so that hatching runs along the first axis.
    turned = [[(root * (x + y), root * (y - x)) for x, y in loop] for loop in loops]
    edges = [(loop[i], loop[(i + 1) % len(loop)]) for loop in turned for i in range(len(loop))]
    if not edges:
        return []
    low, high = min(a[1] for a, _ in edges), max(a[1] for a, _ in edges)
    pieces = []
    level = math.ceil(low / pitch) * pitch + 1e-7
    while level < high:
        crossings = sorted(a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in edges
                           if (a[1] <= level) != (b[1] <= level))  # fmt: skip
        for start, end in zip(crossings[::2], crossings[1::2]):
            pieces.append(tuple((root * (u - level), root * (u + level)) for u in (start, end)))
        level += pitch
    return pieces


MARGIN_MM, WIDE_MM, ROW_MM = 10.0, 180.0, 8.0
ROWS = 4
HIGH_MM = ROWS * ROW_MM
NOTE_MM = 4.4
HEAD_MM = 2.5


@dataclass(frozen=True)
class Title:
    """What a title block says."""

    project: str
    part: str
    material: str
    tolerance: str
    revision: str
    date: str
    number: str


def frame_and_title(sheet: Drawing, title: Title, notes: Sequence[str]) -> None:
    """Add frame, title block at the lower right and notes beside or above it."""
    w, h = sheet.size
    m = MARGIN_MM
    sheet.lines.append(Line(((m, m), (w - m, m), (w - m, h - m), (m, h - m), (m, m)), "frame"))
    left, top = w - m - WIDE_MM, m + HIGH_MM
    sheet.lines.append(Line(((left, m), (left, top), (w - m, top)), "frame"))
    for row in range(1, ROWS):
        sheet.lines.append(Line(((left, m + row * ROW_MM), (w - m, m + row * ROW_MM)), "thin"))
    middle = left + 92.0
    sheet.lines.append(Line(((middle, m), (middle, top)), "thin"))
    cells = (
        (("project", title.project), ("part", title.part)),
        (("material", title.material), ("scale", f"{ratio(sheet.scale)}  {sheet.paper}  lengths in mm")),
        (("tolerance", title.tolerance), ("revision", title.revision)),
        (("date", title.date), ("sheet", title.number)),
    )
    for row, pair in enumerate(cells):
        y = top - (row + 1) * ROW_MM + 2.7
        for x, (name, words) in zip((left + 2.0, middle + 2.0), pair):
            room = (middle if x < middle else w - m) - x - 21.0
            sheet.texts.append(Text((x, y), name, HEAD_MM))
            sheet.texts.append(Text((x + 19.0, y), shortened(words, room), TEXT_MM))
    _projection(sheet, (w - m - 21.0, m + ROW_MM / 2))
    for row, words in enumerate(wrapped(notes, notes_room(sheet.size[0]))):
        sheet.texts.append(Text((m + 3.0, m + notes_height(notes, w) - 3.2 - NOTE_MM * row), words, TEXT_MM))


def notes_room(wide_mm: float) -> float:
    """Width for notes beside the title block. [mm]"""
    return wide_mm - 2 * MARGIN_MM - WIDE_MM - 6.0


def notes_height(notes: Sequence[str], wide_mm: float) -> float:
    """Height that notes take above the frame's lower edge. [mm]"""
    return 4.0 + NOTE_MM * len(wrapped(notes, notes_room(wide_mm)))


def wrapped(notes: Sequence[str], room_mm: float) -> list[str]:
    """Notes broken into lines that fit a width."""
    lines: list[str] = []
    for note in notes:
        line = ""
        for word in note.split():
            longer = f"{line} {word}".strip()
            if line and text_width(longer, TEXT_MM) > room_mm:
                lines.append(line)
                longer = word
            line = longer
        lines.append(line)
    return lines


def shortened(words: str, room_mm: float) -> str:
    """Text cut at its end so that it fits a width."""
    if text_width(words, TEXT_MM) <= room_mm:
        return words
    while words and text_width(words + "...", TEXT_MM) > room_mm:
        words = words[:-1]
    return words.rstrip() + "..."


def _projection(sheet: Drawing, at: Point) -> None:
    """The symbol of first-angle projection: a cone's side view, its end seen from the left on the right."""
    x, y = at
    side = ((x, y - 1.5), (x + 6.0, y - 2.6), (x + 6.0, y + 2.6), (x, y + 1.5), (x, y - 1.5))
    sheet.lines.append(Line(side, "outline"))
    for radius in (1.5, 2.6):
        turn = [2 * math.pi * k / 36 for k in range(37)]
        circle = tuple((x + 12.5 + radius * math.cos(t), y + radius * math.sin(t)) for t in turn)
        sheet.lines.append(Line(circle, "outline"))
    sheet.lines.append(Line(((x - 1.5, y), (x + 7.5, y)), "thin"))
    sheet.lines.append(Line(((x + 9.0, y), (x + 16.0, y)), "thin"))
    sheet.lines.append(Line(((x + 12.5, y - 3.5), (x + 12.5, y + 3.5)), "thin"))


def to_dxf(sheet: Drawing) -> str:
    """Write the sheet as DXF R2010 in millimetres, dimensions as dimension entities; equal sheets, equal files."""
    import ezdxf
    from ezdxf.enums import TextEntityAlignment
    from ezdxf.sections.classes import REQ_R2000

    fixed, ezdxf.options.write_fixed_meta_data_for_testing = ezdxf.options.write_fixed_meta_data_for_testing, True
    try:
        document = ezdxf.new("R2010", setup=["dimstyles:metric"])
        document.units = ezdxf.units.MM
        space = document.modelspace()
        for name, width in LAYERS.items():
            document.layers.add(name, lineweight=round(100 * width))
        # edges come from the solid in an order that differs between processes
        for line in sorted(sheet.lines, key=lambda one: (one.layer, one.points)):
            space.add_lwpolyline(line.points, dxfattribs={"layer": line.layer})
        for text in sheet.texts:
            alignment = TextEntityAlignment.BOTTOM_CENTER if text.middle else TextEntityAlignment.BOTTOM_LEFT
            turn = 90.0 if text.upright else 0.0
            entity = space.add_text(text.words, height=text.height, rotation=turn, dxfattribs={"layer": "text"})
            entity.set_placement(text.at, align=alignment)
        for d in sheet.dimensions:
            space.add_linear_dim(
                base=d.line[0], p1=d.start, p2=d.end, angle=90 if d.vertical else 0, text=number_text(d.value),
                dimstyle="EZDXF", override={"dimtxt": TEXT_MM, "dimasz": 2.5, "dimclrt": 7},
                dxfattribs={"layer": "dimension"},
            ).render()  # fmt: skip
        # Left to itself the library adds the last of these in the order of a set, which differs between processes.
        for name in REQ_R2000:
            document.classes.add_class(name)
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue()
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = fixed


def to_svg(sheet: Drawing) -> str:
    """Write the sheet as SVG in the size of its paper."""
    w, h = sheet.size
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w:g}mm" height="{h:g}mm" viewBox="0 0 {w:g} {h:g}">',
        f"<title>{html.escape(sheet.title)}</title>",
        f'<rect width="{w:g}" height="{h:g}" fill="#fff"/>',
        '<g fill="none" stroke="#111" stroke-linejoin="round" stroke-linecap="round">',
    ]
    for line in sheet.lines:
        points = " ".join(f"{x:.3f},{h - y:.3f}" for x, y in line.points)
        out.append(f'<polyline stroke-width="{LAYERS[line.layer]}" points="{points}"/>')
    out.append("</g>")
    for d in sheet.dimensions:
        lines, heads = d.marks()
        drawn = "".join(f'<path d="M{p[0]:.3f} {h - p[1]:.3f}L{q[0]:.3f} {h - q[1]:.3f}"/>' for p, q in lines)
        for corners in heads:
            drawn += '<path fill="#111" d="M' + "L".join(f"{x:.3f} {h - y:.3f}" for x, y in corners) + 'Z"/>'
        out.append(f'<g stroke="#111" stroke-width="{LAYERS["dimension"]}" fill="none">{drawn}</g>')
    out += [_svg_text(text, h) for text in sheet.all_texts]
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _svg_text(text: Text, h: float) -> str:
    x, y = text.at[0], h - text.at[1]
    anchor = ' text-anchor="middle"' if text.middle else ""
    turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if text.upright else ""
    return (
        f'<text x="{x:.3f}" y="{y:.3f}" font-family="Helvetica, Arial, sans-serif" '
        f'font-size="{text.height / CAP_SHARE:.2f}" fill="#111"{anchor}{turn}>{html.escape(text.words)}</text>'
    )


POINT_PER_MM = 72.0 / 25.4


def to_pdf(sheets: Sequence[Drawing], title: str) -> bytes:
    """Write sheets as PDF; a millimetre of the drawing is a millimetre of the page; equal sheets, equal files."""
    from reportlab.pdfgen.canvas import Canvas

    binary_streams()
    stream = io.BytesIO()
    canvas = Canvas(stream, invariant=1, pageCompression=1)
    canvas.setTitle(title)
    canvas.setCreator("dummydesign")
    for sheet in sheets:
        canvas.setPageSize(tuple(POINT_PER_MM * side for side in sheet.size))
        canvas.saveState()
        canvas.scale(POINT_PER_MM, POINT_PER_MM)
        draw(canvas, sheet)
        canvas.restoreState()
        canvas.bookmarkPage(sheet.title)
        canvas.addOutlineEntry(sheet.title, sheet.title)
        canvas.showPage()
    canvas.save()
    return stream.getvalue()


def binary_streams() -> None:
    """Have pages packed as they are, not also spelt out in letters, which takes longer and a quarter more room."""
    from reportlab import rl_config

    rl_config.useA85 = 0


def draw(canvas: Any, sheet: Drawing) -> None:
    """Draw a sheet on a canvas whose unit is a millimetre."""
    canvas.setLineJoin(1)
    canvas.setLineCap(1)
    # Operators of PDF itself: w sets the width, m and l go along a path, S strokes, h closes and f fills it.
    drawn = [f"{LAYERS[line.layer]} w {_path(line.points)} S" for line in sheet.lines]
    drawn.append(f"{LAYERS['dimension']} w")
    for d in sheet.dimensions:
        lines, heads = d.marks()
        drawn += [f"{_path(ends)} S" for ends in lines]
        drawn += [f"{_path(corners)} h f" for corners in heads]
    canvas.addLiteral("\n".join(drawn))
    for text in sheet.all_texts:
        _text(canvas, text)


def _path(points: Sequence[Point]) -> str:
    (x, y), *rest = points
    return f"{x:.4f} {y:.4f} m " + " ".join([f"{x:.4f} {y:.4f} l" for x, y in rest])


def _text(canvas: Any, text: Text) -> None:
    canvas.saveState()
    canvas.translate(*text.at)
    if text.upright:
        canvas.rotate(90)
    canvas.setFont("Helvetica", text.height / CAP_SHARE)
    (canvas.drawCentredString if text.middle else canvas.drawString)(0, 0, text.words)
    canvas.restoreState()
