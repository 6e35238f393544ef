"""A sheet of lines, areas and texts in millimetres, y downwards: one description, written as SVG and as PDF.

Widths of texts are those of Helvetica and Courier, from the tables below, so that a page is laid out alike with and
without the library that writes PDF. The SVG fixes each text to its width, whatever font a browser takes for it.
"""

from __future__ import annotations

import io
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from html import escape
from itertools import accumulate
from typing import Any

from dummydesign.mold.files.drawing_sheet import packed_pages

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""x low, y low, x high, y high. [mm]"""

PT_MM = 25.4 / 72.0
INK, SOFT, RULE, PANEL, PAPER = "#1b232b", "#4f5b66", "#c9d1d8", "#f3f5f7", "#ffffff"
BAND = "#b9cfe4"
STYLES: dict[str, tuple[str, tuple[float, ...]]] = {
    "main": ("#0b5cad", ()),
    "aim": ("#b3500f", (1.2, 0.8)),
    "other": ("#6b7782", (0.4, 0.6)),
    "alt1": ("#2f8f5b", ()),
    "alt2": ("#8a4fb0", ()),
    "alt3": ("#c2417c", ()),
    "alt4": ("#8c7a10", ()),
    "alt5": ("#2a8c9c", ()),
}
"""Colour and dashes of curves by the names that plots use."""
PITCH = 1.28
"""Distance of lines over the size of their text."""
# Adobe's metrics of the 95 printable characters of ASCII, in thousandths of the font's size.
_PLAIN = (
    "278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 278 "
    "278 584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778 667 778 722 667 611 722 "
    "667 944 667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 "
    "556 333 500 278 556 500 722 500 500 500 334 260 334 584"
)
_BOLD = (
    "278 333 474 556 556 889 722 238 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 333 "
    "333 584 584 584 611 975 722 722 722 722 667 611 778 722 278 556 722 611 833 722 778 667 778 722 667 611 722 "
    "667 944 667 667 611 333 278 333 584 556 333 556 611 556 611 556 333 611 611 278 278 556 278 889 611 611 611 "
    "611 389 556 333 611 556 778 556 556 500 389 280 389 584"
)
_WIDTHS = {face: tuple(map(int, text.split())) for face, text in (("plain", _PLAIN), ("bold", _BOLD))}
_MONO, _OTHER, _WIDE = 600, 667, 1000
"""Thousandths of the size: of every letter of Courier, of letters that no table holds, of East Asian ones."""
PDF_FONTS = {"plain": "Helvetica", "bold": "Helvetica-Bold", "mono": "Courier"}
CSS_FONTS = {
    "plain": "font-family=\"Helvetica,Arial,'Liberation Sans',sans-serif\"",
    "bold": 'font-family="Helvetica,Arial,\'Liberation Sans\',sans-serif" font-weight="bold"',
    "mono": "font-family=\"Courier,'Courier New','Liberation Mono',monospace\"",
}


def text_width_mm(words: str, size_pt: float, face: str = "plain") -> float:
    """Width of a text. [mm]"""
    return sum(_letter(letter, face) for letter in words) * size_pt * PT_MM / 1000.0


@lru_cache(maxsize=4096)
def _letter(letter: str, face: str) -> int:
    """Width of a letter in thousandths of the size; one with an accent is as wide as without."""
    if unicodedata.east_asian_width(letter) in "WF":
        return _WIDE
    if face == "mono":
        return _MONO
    base = unicodedata.normalize("NFD", letter)[0]
    return _WIDTHS[face][ord(base) - 32] if " " <= base <= "~" else _OTHER


def _fitting(words: str, room_mm: float, size_pt: float, face: str) -> int:
    """How many of the first letters fit a width."""
    room = room_mm * 1000.0 / (size_pt * PT_MM)
    return sum(total <= room for total in accumulate(_letter(letter, face) for letter in words))


def wrapped(words: str, room_mm: float, size_pt: float, face: str = "plain", most: int | None = None) -> list[str]:
    """Break a text into lines that fit a width.

    Parameters
    ----------
    words : str
        The text; a line break in it stays one.
    room_mm, size_pt : float
        Width of the lines [mm] and size of the font. [pt]
    face : str
        ``plain``, ``bold`` or ``mono``.
    most : int, optional
        Largest number of lines; what does not fit is replaced by three dots.

    Returns
    -------
    list of str
        The lines, none wider than the room.
    """
    lines: list[str] = []
    for part in words.split("\n"):
        line, wide, blank = "", 0.0, text_width_mm(" ", size_pt, face)
        for word in _broken(part.split(), room_mm, size_pt, face):
            own = text_width_mm(word, size_pt, face)
            if line and wide + blank + own <= room_mm:
                line, wide = f"{line} {word}", wide + blank + own
                continue
            lines += [line] if line else []
            line, wide = word, own
        lines += [line] if line else []
        if most is not None and len(lines) > most:
            break
    if most is not None and len(lines) > most:
        lines = [*lines[: most - 1], shortened(f"{lines[most - 1]} ...", room_mm, size_pt, face)]
    return lines


def _broken(words: Iterable[str], room_mm: float, size_pt: float, face: str) -> list[str]:
    """The words; one that no line holds, such as a path, in pieces."""
    pieces = []
    for word in words:
        while (cut := max(_fitting(word, room_mm, size_pt, face), 1)) < len(word):
            pieces.append(word[:cut])
            word = word[cut:]
        pieces.append(word)
    return pieces


def shortened(words: str, room_mm: float, size_pt: float, face: str = "plain") -> str:
    """The text, cut at its end where it is wider than the room."""
    if text_width_mm(words, size_pt, face) <= room_mm:
        return words
    kept = words.removesuffix(" ...")
    fits = _fitting(kept, room_mm - text_width_mm(" ...", size_pt, face), size_pt, face)
    return f"{kept[:fits].rstrip()} ..."


@dataclass(frozen=True)
class Path:
    """A run of straight pieces, or the area inside when it is filled; colours are CSS, lengths in mm."""

    points: tuple[Point, ...]
    stroke: str | None = INK
    fill: str | None = None
    width_mm: float = 0.25
    dash_mm: tuple[float, ...] = ()
    closed: bool = False


@dataclass(frozen=True)
class Text:
    """Words at the start, middle or end of their line; y is that of the base line."""

    x_mm: float
    y_mm: float
    words: str
    size_pt: float = 8.0
    face: str = "plain"
    anchor: str = "start"
    colour: str = INK

    @property
    def width_mm(self) -> float:
        """Width of the words. [mm]"""
        return text_width_mm(self.words, self.size_pt, self.face)

    @property
    def left_mm(self) -> float:
        """Where the words begin. [mm]"""
        return self.x_mm - {"start": 0.0, "middle": 0.5, "end": 1.0}[self.anchor] * self.width_mm


Item = Path | Text


def rectangle(box: Box, fill: str | None = None, stroke: str | None = None, width_mm: float = 0.25) -> Path:
    """A box as a path."""
    x, y, right, low = box
    return Path(((x, y), (right, y), (right, low), (x, low)), stroke, fill, width_mm, closed=True)


@dataclass
class VectorSheet:
    """A sheet of a size with its items, the lowest first."""

    title: str
    width_mm: float
    height_mm: float
    items: list[Item] = field(default_factory=list)

    def svg(self) -> str:
        """Write the sheet as SVG, without a size of its own."""
        drawn = "".join(_svg_text(item) if isinstance(item, Text) else _svg_path(item) for item in self.items)
        return (
            f'<svg class="sheet" viewBox="0 0 {self.width_mm:g} {self.height_mm:g}" role="group" '
            f'aria-label="{escape(self.title)}" stroke-linejoin="round" stroke-linecap="butt">'
            f'<rect width="{self.width_mm:g}" height="{self.height_mm:g}" fill="{PAPER}"/>{drawn}</svg>'
        )

    def pdf(self, paper_mm: Point) -> bytes:
        """Write the sheet as PDF with even margins; equal sheets give equal bytes."""
        from reportlab.pdfgen.canvas import Canvas

        stream = io.BytesIO()
        size = tuple(side / PT_MM for side in paper_mm)
        canvas = Canvas(stream, pagesize=size, invariant=1, pageCompression=1)
        canvas.setTitle(self.title)
        canvas.setCreator("dummydesign")
        canvas.setLineJoin(1)
        left, top = (paper_mm[0] - self.width_mm) / 2.0, (paper_mm[1] + self.height_mm) / 2.0
        for item in self.items:
            if isinstance(item, Text):
                _pdf_text(canvas, item, left, top)
            else:
                _pdf_path(canvas, item, left, top)
        with packed_pages():
            canvas.showPage()
            canvas.save()
        return stream.getvalue()


def _svg_path(path: Path) -> str:
    points = "L".join(f"{x:.2f} {y:.2f}" for x, y in path.points)
    dash = f' stroke-dasharray="{" ".join(f"{d:g}" for d in path.dash_mm)}"' if path.dash_mm else ""
    line = f' stroke="{path.stroke}" stroke-width="{path.width_mm:g}"{dash}' if path.stroke else ""
    return f'<path d="M{points}{"Z" if path.closed else ""}" fill="{path.fill or "none"}"{line}/>'


def _svg_text(text: Text) -> str:
    fixed = f' textLength="{text.width_mm:.2f}" lengthAdjust="spacingAndGlyphs"' if len(text.words) > 1 else ""
    return (
        f'<text x="{text.left_mm:.2f}" y="{text.y_mm:.2f}" font-size="{text.size_pt * PT_MM:.3f}" '
        f'{CSS_FONTS[text.face]} fill="{text.colour}"{fixed}>{escape(text.words)}</text>'
    )


def _pdf_path(canvas: Any, path: Path, left: float, top: float) -> None:
    from reportlab.lib.colors import HexColor

    run = canvas.beginPath()
    (x, y), *rest = [((left + x) / PT_MM, (top - y) / PT_MM) for x, y in path.points]
    run.moveTo(x, y)
    for x, y in rest:
        run.lineTo(x, y)
    if path.closed:
        run.close()
    canvas.setLineWidth(path.width_mm / PT_MM)
    canvas.setDash([d / PT_MM for d in path.dash_mm])
    if path.stroke:
        canvas.setStrokeColor(HexColor(path.stroke))
    if path.fill:
        canvas.setFillColor(HexColor(path.fill))
    canvas.drawPath(run, stroke=int(path.stroke is not None), fill=int(path.fill is not None))


def _pdf_text(canvas: Any, text: Text, left: float, top: float) -> None:
    from reportlab.lib.colors import HexColor
    from reportlab.pdfbase.pdfmetrics import stringWidth

    font = _font(text)
    long = stringWidth(text.words, font, text.size_pt)
    run = canvas.beginText((left + text.left_mm) / PT_MM, (top - text.y_mm) / PT_MM)
    run.setFont(font, text.size_pt)
    run.setFillColor(HexColor(text.colour))
    # a font with wider letters than those that were laid out must not run into what stands next to it
    run.setHorizScale(100.0 * min(1.0, text.width_mm / PT_MM / long) if long else 100.0)
    run.textOut(text.words)
    canvas.drawText(run)


def _font(text: Text) -> str:
    """A font that has the letters of a text: the one that it was laid out in, where it can."""
    try:
        text.words.encode("cp1252")
    except UnicodeEncodeError:
        from dummydesign.mold.files.pour_sheet import fonts

        return fonts()[int(text.face == "bold")]
    return PDF_FONTS[text.face]


def paragraph(
    items: list[Item],
    x_mm: float,
    y_mm: float,
    lines: Sequence[str],
    size_pt: float,
    face: str = "plain",
    colour: str = INK,
    pitch: float = PITCH,
) -> float:
    """Add texts of lines from a top edge on; return the edge under the last. [mm]"""
    step = pitch * size_pt * PT_MM
    items += [
        Text(x_mm, y_mm + (row + 0.8) * step, line, size_pt, face, colour=colour) for row, line in enumerate(lines)
    ]
    return y_mm + len(lines) * step
