"""Drawings as PDF, one page each, in their true size. No CAD."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.files.drawings.sheet import CAP_SHARE, LAYERS, Drawing, Text

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


def draw(canvas: Any, sheet: Drawing) -> None:
    """Draw a sheet on a canvas whose unit is a millimetre."""
    canvas.setLineJoin(1)
    canvas.setLineCap(1)
    for line in sheet.lines:
        canvas.setLineWidth(LAYERS[line.layer])
        path = canvas.beginPath()
        path.moveTo(*line.points[0])
        for point in line.points[1:]:
            path.lineTo(*point)
        canvas.drawPath(path)
    canvas.setLineWidth(LAYERS["dimension"])
    for d in sheet.dimensions:
        lines, heads = d.marks()
        for start, end in lines:
            canvas.line(*start, *end)
        for corners in heads:
            path = canvas.beginPath()
            path.moveTo(*corners[0])
            for point in corners[1:]:
                path.lineTo(*point)
            path.close()
            canvas.drawPath(path, stroke=0, fill=1)
    for text in (*sheet.texts, *(d.text for d in sheet.dimensions)):
        _text(canvas, text)


def _text(canvas: Any, text: Text) -> None:
    canvas.saveState()
    canvas.translate(*text.at)
    if text.upright:
        canvas.rotate(90)
    canvas.setFont("Helvetica", text.height / CAP_SHARE)
    (canvas.drawCentredString if text.middle else canvas.drawString)(0, 0, text.words)
    canvas.restoreState()
