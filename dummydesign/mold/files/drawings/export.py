"""A drawing as DXF, SVG and PDF, in millimetres."""

from __future__ import annotations

import html
import io
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.files.drawings.sheet import CAP_SHARE, LAYERS, TEXT_MM, Drawing, Point, Text, number_text


def to_dxf(sheet: Drawing) -> str:
    """Write the sheet as DXF R2010 in millimetres, dimensions as dimension entities; equal sheets, equal files."""
    import ezdxf
    from ezdxf.enums import TextEntityAlignment

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
            place = TextEntityAlignment.BOTTOM_CENTER if text.middle else TextEntityAlignment.BOTTOM_LEFT
            turn = 90.0 if text.upright else 0.0
            entity = space.add_text(text.words, height=text.height, rotation=turn, dxfattribs={"layer": "text"})
            entity.set_placement(text.at, align=place)
        for d in sheet.dimensions:
            space.add_linear_dim(
                base=d.line[0], p1=d.start, p2=d.end, angle=90 if d.vertical else 0, text=number_text(d.value),
                dimstyle="EZDXF", override={"dimtxt": TEXT_MM, "dimasz": 2.5, "dimclrt": 7},
                dxfattribs={"layer": "dimension"},
            ).render()  # fmt: skip
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
