"""Dimensioned drawings: what is drawn, in millimetres on paper, written as DXF and as SVG. No CAD."""

from __future__ import annotations

import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

Point = tuple[float, float]
SHEET_MM = (420.0, 297.0)
MARGIN_MM, TITLE_MM = 10.0, 26.0
LAYERS = {"outline": 0.5, "thin": 0.18, "cut": 0.7, "hatch": 0.13, "dimension": 0.18, "text": 0.25, "frame": 0.5}


@dataclass(frozen=True)
class Line:
    """A run of straight pieces."""

    points: tuple[Point, ...]
    layer: str


@dataclass(frozen=True)
class Text:
    """Text with its lower left (or middle) at a point."""

    at: Point
    words: str
    height: float = 3.5
    middle: bool = False
    upright: bool = False


@dataclass(frozen=True)
class Dimension:
    """A linear dimension between two points, measured along x or y; ``value`` is the true length. [mm]"""

    start: Point
    end: Point
    offset: float
    vertical: bool
    value: float


@dataclass
class Drawing:
    """A sheet: lines, texts and dimensions in paper millimetres, ``scale`` paper over part."""

    title: str
    scale: float
    lines: list[Line] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)
    dimensions: list[Dimension] = field(default_factory=list)


@dataclass(frozen=True)
class View:
    """One view in the part's own coordinates with the dimensions it shall carry."""

    name: str
    runs: tuple[tuple[tuple[Point, ...], str], ...]
    dimensions: tuple[Dimension, ...] = ()
    filled: bool = False

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x low, y low, x high, y high. [mm]"""
        xs = [x for run, _ in self.runs for x, _ in run]
        ys = [y for run, _ in self.runs for _, y in run]
        return min(xs), min(ys), max(xs), max(ys)


def arrange(title: str, views: Sequence[View], notes: Sequence[str]) -> Drawing:
    """Stack views on one A3 sheet at the largest preferred scale that fits, with a title block of notes.

    Parameters
    ----------
    title : str
        Name of the part, in the title block.
    views : sequence of View
        From top to bottom of the sheet.
    notes : sequence of str
        Lines of the title block.

    Returns
    -------
    Drawing
    """
    above, between, under = 22.0, 28.0, 13.0
    room = SHEET_MM[0] - 2 * MARGIN_MM - 70.0, SHEET_MM[1] - 2 * MARGIN_MM - TITLE_MM - above - under
    width = max(view.bounds[2] - view.bounds[0] for view in views)
    height = sum(view.bounds[3] - view.bounds[1] for view in views)
    fits = [
        s
        for s in (2.0, 1.0, 0.5, 0.2, 0.1)
        if s * width <= room[0] and s * height + between * (len(views) - 1) <= room[1]
    ]
    scale = fits[0] if fits else 0.05
    sheet = Drawing(title, scale)
    x = SHEET_MM[0] / 2
    level = SHEET_MM[1] - MARGIN_MM - above
    for view in views:
        x0, y0, x1, y1 = view.bounds
        shift = (x - scale * (x0 + x1) / 2, level - scale * y1)
        _place(sheet, view, shift)
        level -= scale * (y1 - y0) + between
    _title_block(sheet, notes)
    return sheet


def _place(sheet: Drawing, view: View, shift: Point) -> None:
    def on_paper(point: Point) -> Point:
        return point[0] * sheet.scale + shift[0], point[1] * sheet.scale + shift[1]

    first = len(sheet.lines)
    for run, layer in view.runs:
        sheet.lines.append(Line(tuple(on_paper(point) for point in run), layer))
    for d in view.dimensions:
        sheet.dimensions.append(Dimension(on_paper(d.start), on_paper(d.end), d.offset, d.vertical, d.value))
    x0, _, _, y1 = view.bounds
    left, top = on_paper((x0, y1))
    sheet.texts.append(Text((min(left, MARGIN_MM + 60.0) - 50.0, top + 6.0), view.name, 4.0))
    if view.filled:
        closed = [line.points for line in sheet.lines[first:] if line.layer == "cut"]
        sheet.lines += [Line(piece, "hatch") for piece in hatch(closed, 3.0)]


def hatch(loops: Sequence[Sequence[Point]], pitch: float) -> list[tuple[Point, Point]]:
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
        crossings = sorted(
            a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            for a, b in edges
            if (a[1] <= level) != (b[1] <= level)
        )
        for start, end in zip(crossings[::2], crossings[1::2]):
            pieces.append(tuple((root * (u - level), root * (u + level)) for u in (start, end)))
        level += pitch
    return pieces


def _title_block(sheet: Drawing, notes: Sequence[str]) -> None:
    w, h = SHEET_MM
    m, top = MARGIN_MM, MARGIN_MM + TITLE_MM
    sheet.lines.append(Line(((m, m), (w - m, m), (w - m, h - m), (m, h - m), (m, m)), "frame"))
    sheet.lines.append(Line(((m, top), (w - m, top)), "frame"))
    ratio = f"{sheet.scale:g}:1" if sheet.scale >= 1 else f"1:{1 / sheet.scale:g}"
    sheet.texts.append(Text((m + 4, top - 7), f"{sheet.title}   scale {ratio}   A3   all lengths in mm", 4.0))
    for row, note in enumerate(notes[:4]):
        sheet.texts.append(Text((m + 4, top - 12 - 4.3 * row), note, 3.0))


def number(value: float) -> str:
    """Length as drawn: two decimals, trailing zeros off."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _arrows(d: Dimension) -> tuple[Point, Point]:
    """Ends of the dimension line."""
    if d.vertical:
        x = d.start[0] + d.offset
        return (x, d.start[1]), (x, d.end[1])
    y = d.start[1] + d.offset
    return (d.start[0], y), (d.end[0], y)


def to_svg(sheet: Drawing) -> str:
    """Write the sheet as SVG, A3 in millimetres."""
    w, h = SHEET_MM
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
        out.append(_svg_dimension(d, h))
    for text in sheet.texts:
        out.append(_svg_text(text, h))
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _svg_text(text: Text, h: float) -> str:
    x, y = text.at[0], h - text.at[1]
    anchor = ' text-anchor="middle"' if text.middle else ""
    turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if text.upright else ""
    return (
        f'<text x="{x:.3f}" y="{y:.3f}" font-family="sans-serif" font-size="{1.35 * text.height:.2f}" '
        f'fill="#111"{anchor}{turn}>{html.escape(text.words)}</text>'
    )


def _svg_dimension(d: Dimension, h: float) -> str:
    a, b = _arrows(d)
    length = math.dist(a, b)
    parts = [(d.start, a), (d.end, b), (a, b)]
    lines = "".join(f'<path d="M{p[0]:.3f} {h - p[1]:.3f}L{q[0]:.3f} {h - q[1]:.3f}"/>' for p, q in parts)
    ux, uy = ((b[0] - a[0]) / length, (b[1] - a[1]) / length) if length else (1.0, 0.0)
    # Arrows point outwards in a narrow gap, so that they do not cross.
    inwards = 1.0 if length > 9 else -1.0
    heads = ""
    for tip, sign in ((a, inwards), (b, -inwards)):
        bx, by = tip[0] + sign * 2.8 * ux, tip[1] + sign * 2.8 * uy
        nx, ny = -0.5 * uy, 0.5 * ux
        corners = (tip, (bx + nx, by + ny), (bx - nx, by - ny))
        heads += '<path fill="#111" d="M' + "L".join(f"{x:.3f} {h - y:.3f}" for x, y in corners) + 'Z"/>'
    middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
    wide = 2.0 * len(number(d.value))
    if length < wide:
        middle = (
            (middle[0], max(a[1], b[1]) + wide / 2 + 4) if d.vertical else (max(a[0], b[0]) + wide / 2 + 4, middle[1])
        )
    at = (middle[0] - 1.0, middle[1]) if d.vertical else (middle[0], middle[1] + 1.0)
    words = _svg_text(Text(at, number(d.value), 3.0, True, d.vertical), h)
    return f'<g stroke="#345" stroke-width="{LAYERS["dimension"]}" fill="none">{lines}{heads}</g>{words}'


def to_dxf(sheet: Drawing) -> str:
    """Write the sheet as DXF R2010 in millimetres, dimensions as dimension entities; equal sheets, equal files."""
    import ezdxf
    from ezdxf.enums import TextEntityAlignment

    fixed, ezdxf.options.write_fixed_meta_data_for_testing = ezdxf.options.write_fixed_meta_data_for_testing, True
    try:
        document = ezdxf.new("R2010", setup=True)
        document.units = ezdxf.units.MM
        space = document.modelspace()
        for name, width in LAYERS.items():
            document.layers.add(name, lineweight=round(100 * width))
        for line in sheet.lines:
            space.add_lwpolyline(line.points, dxfattribs={"layer": line.layer})
        for text in sheet.texts:
            place = TextEntityAlignment.BOTTOM_CENTER if text.middle else TextEntityAlignment.BOTTOM_LEFT
            entity = space.add_text(text.words, height=text.height, dxfattribs={"layer": "text"})
            entity.set_placement(text.at, align=place)
        for d in sheet.dimensions:
            base, _ = _arrows(d)
            space.add_linear_dim(
                base=base, p1=d.start, p2=d.end, angle=90 if d.vertical else 0, text=number(d.value), dimstyle="EZDXF",
                override={"dimtxt": 3.0, "dimasz": 2.5, "dimclrt": 7}, dxfattribs={"layer": "dimension"},
            ).render()  # fmt: skip
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue()
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = fixed
