"""Frame, title block and notes of a drawing (fields after ISO 7200, projection symbol after ISO 5456-2). No CAD."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.mold.files.drawings.sheet import TEXT_MM, Drawing, Line, Point, Text, ratio, text_width

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
    """Add frame, title block at the lower right and notes beside or above it.

    Parameters
    ----------
    sheet : Drawing
        To add to.
    title : Title
    notes : sequence of str
        Lines that have room beside the block, see :func:`notes_height`.
    """
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
