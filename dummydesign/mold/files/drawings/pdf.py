"""Drawings as PDF, one page each, in their true size. No CAD."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.files.drawings.sheet import CAP_SHARE, LAYERS, Drawing, Point, Text

POINT_PER_MM = 72.0 / 25.4


def to_pdf(sheets: Sequence[Drawing], title: str) -> bytes:
    """Write sheets as PDF; a millimetre of the drawing is a millimetre of the page; equal sheets, equal files.

    Parameters
    ----------
    sheets : sequence of Drawing
        A page each, in the size of its paper.
    title : str
        In the file's properties.

    Returns
    -------
    bytes
    """
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
    for text in (*sheet.texts, *(d.text for d in sheet.dimensions)):
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
