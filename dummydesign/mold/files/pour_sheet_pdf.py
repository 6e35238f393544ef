"""The pour sheet as PDF: page numbers, date, command, hash as text and as QR code. No CAD, no browser."""

from __future__ import annotations

import html
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from dummydesign.mold.files.drawing_layout import font_file
from dummydesign.mold.files.drawing_sheet import PAPERS, Drawing, binary_streams, draw
from dummydesign.mold.files.pour_sheet import Block

PAGES_MM = {"A4": (210.0, 297.0), "A3": (297.0, 420.0)}
MM = 72.0 / 25.4
MARGIN_MM, FOOT_MM, QR_MM = 16.0, 22.0, 18.0


@dataclass(frozen=True)
class Foot:
    """What stands at the foot of every page."""

    hash: str
    command: str = ""
    date: str = ""


@lru_cache(1)
def fonts() -> tuple[str, str]:
    """Names of a plain and a bold font that know more than Western letters: DejaVu Sans, which matplotlib carries."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont

    names = ("DejaVuSans", "DejaVuSans-Bold")
    files = [font_file(name) for name in names]
    if None in files:
        return "Helvetica", "Helvetica-Bold"
    for name, file in zip(names, files):
        pdfmetrics.registerFont(TTFont(name, str(file)))
    pdfmetrics.registerFontFamily(names[0], normal=names[0], bold=names[1], italic=names[0], boldItalic=names[1])
    return names


JAPANESE = re.compile("[\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef]+")


def marked(words: str) -> str:
    """Escape a paragraph's words; Japanese letters get a font of their own, which the reader's program brings."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.cidfonts import UnicodeCIDFont

    name = "HeiseiKakuGo-W5"
    if JAPANESE.search(words) and name not in pdfmetrics.getRegisteredFontNames():
        pdfmetrics.registerFont(UnicodeCIDFont(name))
    return JAPANESE.sub(lambda match: f'<font name="{name}">{match[0]}</font>', html.escape(words))


def sheet_pdf(blocks: Sequence[Block], foot: Foot, drawings: Sequence[Drawing] = (), paper: str = "A4") -> bytes:
    """Write a pour sheet as PDF."""
    from reportlab.pdfgen.canvas import Canvas
    from reportlab.platypus import BaseDocTemplate, Frame, PageTemplate

    binary_streams()
    wide, high = (MM * side for side in PAGES_MM[paper])
    margin, low = MM * MARGIN_MM, MM * (FOOT_MM + 4.0)
    story = _story(blocks, wide - 2 * margin)
    for drawing in drawings:
        story += _picture(drawing, wide - 2 * margin)

    class Numbered(Canvas):
        """Keeps its pages until the last is laid out, when their number is known."""

        def __init__(self, *given: Any, **named: Any) -> None:
            Canvas.__init__(self, *given, **named)
            self.kept: list[dict[str, Any]] = []

        def showPage(self) -> None:
            self.kept.append(dict(self.__dict__))
            self._startPage()

        def save(self) -> None:
            for page, state in enumerate(self.kept, 1):
                self.__dict__.update(state)
                _foot(self, foot, page, len(self.kept), wide, margin)
                Canvas.showPage(self)
            Canvas.save(self)

    stream = io.BytesIO()
    document = BaseDocTemplate(stream, pagesize=(wide, high), invariant=1, title=blocks[0].text, creator="dummydesign")
    frame = Frame(margin, low, wide - 2 * margin, high - low - margin, 0, 0, 0, 0)
    document.addPageTemplates(PageTemplate("page", [frame]))
    document.build(story, canvasmaker=Numbered)
    return stream.getvalue()


def _story(blocks: Sequence[Block], wide: float) -> list[Any]:
    from reportlab import platypus as flow
    from reportlab.lib.colors import HexColor
    from reportlab.lib.styles import ParagraphStyle

    plain, bold = fonts()
    text = ParagraphStyle("text", fontName=plain, fontSize=9, leading=12.5)
    cell = ParagraphStyle("cell", parent=text, fontSize=8, leading=10.5)
    heads = [ParagraphStyle(name, parent=text, fontName=bold, fontSize=size, leading=1.35 * size, spaceBefore=9,
                            spaceAfter=3, keepWithNext=1) for name, size in (("title", 14), ("head", 11))]  # fmt: skip
    grid = flow.TableStyle([
        ("GRID", (0, 0), (-1, -1), 0.4, HexColor("#8a99a5")), ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("BACKGROUND", (0, 0), (-1, 0), HexColor("#eef2f5")), ("LEFTPADDING", (0, 0), (-1, -1), 3),
        ("RIGHTPADDING", (0, 0), (-1, -1), 3), ("TOPPADDING", (0, 0), (-1, -1), 2),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
    ])  # fmt: skip
    story: list[Any] = []
    for index, block in enumerate(blocks):
        if block.kind == "head":
            story += [flow.CondPageBreak(MM * 30), flow.Paragraph(marked(block.text), heads[min(index, 1)])]
        elif block.kind == "text":
            story += [flow.Paragraph(marked(block.text), text), flow.Spacer(1, 3)]
        elif block.kind == "list":
            items = [flow.ListItem(flow.Paragraph(marked(item), text), spaceAfter=2) for item in block.items]
            story.append(flow.ListFlowable(items, bulletFontName=plain, bulletFontSize=9, leftIndent=16))
        else:
            rows = [[flow.Paragraph(marked(words), cell) for words in row] for row in block.rows]
            table = flow.Table(rows, colWidths=_widths(block.rows, wide, plain), repeatRows=1, style=grid)
            story += [flow.KeepTogether(table) if len(rows) < 9 else table, flow.Spacer(1, 5)]
    return story


def _widths(rows: Sequence[Sequence[str]], wide: float, font: str) -> list[float]:
    """Columns as wide as their longest word at least, the rest shared by the length of their texts."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    columns = list(zip(*rows))
    least = [max(stringWidth(w, font, 8) for text in one for w in text.split() or [""]) + 8 for one in columns]
    wanted = [max(stringWidth(text, font, 8) for text in one) + 8 for one in columns]
    if sum(wanted) <= wide:
        return wanted
    spare, more = max(0.0, wide - sum(least)), [a - b for a, b in zip(wanted, least)]
    share = spare / max(sum(more), 1e-9)
    return [a + share * b for a, b in zip(least, more)]


def _picture(drawing: Drawing, wide: float) -> list[Any]:
    from reportlab.lib.styles import ParagraphStyle
    from reportlab.platypus import Flowable, KeepTogether, Paragraph

    width, height = PAPERS[drawing.paper]
    factor = wide / width

    class Picture(Flowable):
        def __init__(self) -> None:
            Flowable.__init__(self)
            self.width, self.height = wide, factor * height

        def draw(self) -> None:
            self.canv.scale(factor, factor)
            draw(self.canv, drawing)

    words = f"{drawing.title}: not to scale here; the drawings' own PDF is true to scale."
    style = ParagraphStyle("under", fontName=fonts()[0], fontSize=8)
    return [KeepTogether([Picture(), Paragraph(marked(words), style)])]


def _foot(canvas: Any, foot: Foot, page: int, pages: int, wide: float, margin: float) -> None:
    """Page number, date, command and hash; the hash as QR code on the right."""
    from reportlab.lib.utils import simpleSplit

    plain, bold = fonts()
    canvas.saveState()
    canvas.setLineWidth(0.4)
    top = MM * FOOT_MM
    canvas.line(margin, top, wide - margin, top)
    canvas.setFont(bold, 8)
    canvas.drawString(margin, top - 10, f"Specification {foot.hash}    page {page} of {pages}    {foot.date}")
    canvas.setFont(plain, 7)
    room = wide - 2 * margin - MM * (QR_MM + 4)
    for row, line in enumerate(simpleSplit(foot.command, plain, 7, room)[:3]):
        canvas.drawString(margin, top - 20 - 9 * row, line)
    _code(canvas, foot.hash, wide - margin - MM * QR_MM, top - MM * (QR_MM + 1))
    canvas.restoreState()


def _code(canvas: Any, words: str, x: float, y: float) -> None:
    """A QR code as squares, its lower left at a place."""
    import segno

    rows = [list(row) for row in segno.make(words, error="m", micro=False).matrix]
    side = MM * QR_MM / len(rows)
    path = canvas.beginPath()
    for row, line in enumerate(rows):
        for column, dark in enumerate(line):
            if dark:
                path.rect(x + column * side, y + (len(rows) - 1 - row) * side, side, side)
    canvas.drawPath(path, stroke=0, fill=1)
