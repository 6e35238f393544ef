"""The first page of a report: verdict, a drawing, facts, presses as small multiples, a table, what to do next.

A command fills a :class:`FrontPage`; :func:`lay_out` places it on one sheet of A4. The same sheet is the report's first
page, as SVG, and ``report.pdf``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from dummydesign._version import __version__
from dummydesign.report.plot import Plot
from dummydesign.report.plot_drawing import draw_plot
from dummydesign.report.vector_sheet import (
    BAND,
    INK,
    PANEL,
    PITCH,
    PT_MM,
    RULE,
    SOFT,
    STYLES,
    Box,
    Item,
    Path,
    Text,
    VectorSheet,
    paragraph,
    rectangle,
    shortened,
    text_width_mm,
    wrapped,
)

PAPER_MM = (210.0, 297.0)
WIDTH_MM, HEIGHT_MM = 186.0, 272.0
"""The sheet, inside the paper's margins. [mm]"""
SIZES_PT = (9.0, 8.5, 8.0, 7.5, 7.0, 6.5, 6.0)
"""Sizes of the text that are tried, the largest first. [pt]"""
LEAST_PANEL_MM, MOST_PANEL_MM = 24.0, 52.0
"""Height of a small multiple. [mm]"""
DRAWING_MM, SPARE_MM = 46.0, 36.0
"""Least height of the drawing, and how much more it takes of a sheet that has room. [mm]"""
MOST_PANELS, GAP_MM = 6, 4.0
MOST_ROWS, MOST_NOTES = 9, 4
"""Rows of the table and warnings that are shown; the report has all."""
LIGHTS = {"green": ("#2e8b57", "#e9f5ee"), "amber": ("#d98e04", "#fdf4e1"), "red": ("#c62828", "#fbe9e7")}
NO_LIGHT = ("#0b5cad", "#e8f0f8")
BAD = "#b3261e"

FOOT = "report.html continues with all figures and tables, the warnings and the sources."


@dataclass(frozen=True)
class Fact:
    """A value with its label; ``large`` for the one number that is read from afar."""

    label: str
    text: str
    large: bool = False


@dataclass(frozen=True)
class Panel:
    """A press as a small multiple: its plot, the test at its upper left, how it reads at its upper right."""

    plot: Plot
    test: str
    reads: str
    bad: bool = False
    level: str = ""
    """Panels of one level share the scale of their forces; those without a level have their own."""


@dataclass(frozen=True)
class Grid:
    """A table of texts; rows in ``marked`` are in the colour of what is outside."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    marked: frozenset[int] = frozenset()


@dataclass(frozen=True)
class FrontPage:
    """What stands on the first page.

    Attributes
    ----------
    title, basis : str
        Name of the answer, and for what it holds.
    verdict : tuple of (str or None, str)
        Light (green, amber, red or none) and words; the words up to the first full stop are set in bold.
    drawing : tuple of (str, callable)
        Heading and what draws into a box. [mm]
    facts_title, facts : str, sequence of Fact
        What stands right of the drawing.
    panels_title, panels : str, sequence of Panel
        The presses; six are shown.
    keys : sequence of (str, str)
        Style (``band``, ``dots``, ``main``, ``aim``, ``other``) and name of each curve; without any, the curves are
        named where they end.
    table : Grid
        What stands under the presses.
    blocks : sequence of (str, sequence of str)
        Heading and paragraphs right of the table.
    notes : sequence of str
        Warnings, each with what to do.
    steps : sequence of str
        What to do next, in its order; commands begin with ``dummydesign``.
    foot : str
        Where the rest is.
    """

    title: str
    basis: str
    verdict: tuple[str | None, str]
    drawing: tuple[str, Callable[[Box], list[Item]]]
    facts_title: str
    facts: Sequence[Fact]
    panels_title: str
    panels: Sequence[Panel]
    keys: Sequence[tuple[str, str]]
    table: Grid
    blocks: Sequence[tuple[str, Sequence[str]]] = ()
    notes: Sequence[str] = ()
    steps: Sequence[str] = ()
    foot: str = ""


def lay_out(page: FrontPage) -> VectorSheet:
    """Place everything on one sheet, with the largest text at which the presses keep their least height.

    Parameters
    ----------
    page : FrontPage
        The content.

    Returns
    -------
    VectorSheet
        The sheet. Long texts end in three dots; what no size makes room for is left to the report.
    """
    count = min(len(page.panels), MOST_PANELS)
    rows = -(-count // _columns(count))
    smaller = ((page, size) for size in SIZES_PT)
    for shown, size in chain(smaller, ((shown, SIZES_PT[-1]) for shown in _shorter(page))):
        fixed = _lower([], shown, size, 0.0) + _line_mm(size + 1) + 1.8 + GAP_MM
        y = _head([], shown, size)
        room = (HEIGHT_MM - y - fixed) / max(rows, 1)
        if room >= (LEAST_PANEL_MM if rows else 0.0):
            break
    panel = min(room, MOST_PANEL_MM)
    sheet = VectorSheet(page.title, WIDTH_MM, HEIGHT_MM)
    y = _head(sheet.items, shown, size, min(max(HEIGHT_MM - y - fixed - rows * panel, 0.0), SPARE_MM))
    _lower(sheet.items, shown, size, _panels(sheet.items, shown, y, panel, size) + GAP_MM)
    return sheet


def sentence(text: str) -> str:
    """The text with a capital, unless it begins with a file's name, and a full stop."""
    first = text.partition(" ")[0].rstrip(",;:")
    return text and f"{text[0].upper() if first.isalpha() else text[0]}{text[1:].removesuffix('.')}."


def warning_texts(warnings: Sequence[Mapping[str, str]]) -> list[str]:
    """The first warning of each kind, and how many more there are of it."""
    kinds: dict[str, list[str]] = {}
    for item in warnings:
        kinds.setdefault(item["code"], []).append(item["message"])
    return [sentence(texts[0]) + (f" ({len(texts) - 1} more)" if len(texts) > 1 else "") for texts in kinds.values()]


def _shorter(page: FrontPage) -> Iterator[FrontPage]:
    """The page with less and less of what the report has as well: warnings, blocks, facts."""
    for _ in page.notes[1:]:
        yield (page := replace(page, notes=page.notes[:-1]))
    for _ in page.blocks[1:]:
        yield (page := replace(page, blocks=page.blocks[:-1]))
    for _ in page.facts[2:]:
        yield (page := replace(page, facts=page.facts[:-1]))
    yield replace(page, notes=(), blocks=())


def _line_mm(size: float) -> float:
    return PITCH * size * PT_MM


# Parts of a sheet add items to it, from an edge on; those in one column return the edge under them. [mm]
def _heading(items: list[Item], words: str, x: float, y: float, wide: float, size: float) -> float:
    """A heading over a rule."""
    low = y + _line_mm(size + 1) + 0.6
    words = shortened(words, wide, size + 1, "bold")
    items += [Text(x, y + 0.8 * _line_mm(size + 1), words, size + 1, "bold"),
              Path(((x, low), (x + wide, low)), RULE, width_mm=0.3)]  # fmt: skip
    return low + 1.2


def _head(items: list[Item], page: FrontPage, size: float, spare_mm: float = 0.0) -> float:
    """Title, for what it holds, verdict, drawing and facts; the drawing takes what is spare."""
    version = f"dummydesign {__version__}"
    room = WIDTH_MM - text_width_mm(version, 7.0) - 6.0
    items += [
        Text(0.0, 5.6, shortened(page.title, room, 16.0, "bold"), 16.0, "bold"),
        Text(WIDTH_MM, 5.6, version, 7.0, anchor="end", colour=SOFT),
    ]
    y = paragraph(items, 0.0, 7.6, wrapped(page.basis, WIDTH_MM, size, most=4), size, colour=SOFT)
    y = _verdict(items, *page.verdict, y + 2.0, size + 1.5) + GAP_MM
    wide, facts = 0.6 * WIDTH_MM, list[Item]()
    under = _heading(items, page.drawing[0], 0.0, y, wide, size)
    low = _facts(facts, page, wide + 6.0, y, WIDTH_MM - wide - 6.0, size)
    low = max(low, under + DRAWING_MM + spare_mm)
    items += [*page.drawing[1]((0.0, under, wide, low)), *facts]
    return low + GAP_MM


def _verdict(items: list[Item], light: str | None, words: str, y: float, size: float) -> float:
    """The verdict in a box in the colour of its light, which is named as well."""
    texts: list[Item] = []
    colour, pale = LIGHTS.get(light or "", NO_LIGHT)
    first, _, rest = words.partition(". ")
    strong = f"{light.upper()}: {first.rstrip('.').upper()}" if light else f"{first.rstrip('.')}."
    left, room = (14.0, WIDTH_MM - 18.0) if light else (5.0, WIDTH_MM - 9.0)
    low = paragraph(texts, left, y + 1.6, wrapped(strong, room, size + 2.0, "bold", 3), size + 2.0, "bold")
    low = paragraph(texts, left, low + 0.4, wrapped(rest, room, size, most=6), size) + 1.6
    items.append(rectangle((0.0, y, WIDTH_MM, low), pale, colour, 0.5))
    if light:
        turn = np.linspace(0.0, 2.0 * np.pi, 49)[:-1]
        ring = tuple((7.0 + 3.4 * math.cos(t), 0.5 * (y + low) + 3.4 * math.sin(t)) for t in turn)
        items.append(Path(ring, None, colour, closed=True))
    items += texts
    return low


def _facts(items: list[Item], page: FrontPage, x: float, y: float, wide: float, size: float) -> float:
    """Labels and their values, one under the other."""
    y = _heading(items, page.facts_title, x, y, wide, size)
    for fact in page.facts:
        y = paragraph(items, x, y + 0.5, [shortened(fact.label, wide, size - 1)], size - 1, colour=SOFT)
        big = size + (7.0 if fact.large else 0.5)
        y = paragraph(items, x, y, wrapped(fact.text, wide, big, "bold", 4), big, "bold")
    return y


def _columns(panels: int) -> int:
    """How many panels are in a row."""
    return 2 if panels in (1, 2, 4) else 3


def _panels(items: list[Item], page: FrontPage, y: float, high: float, size: float) -> float:
    """The presses as small multiples."""
    if not page.panels:
        return y
    left_out = f": {MOST_PANELS} of {len(page.panels)}" if len(page.panels) > MOST_PANELS else ""
    under = _heading(items, f"{page.panels_title}{left_out}", 0.0, y, WIDTH_MM, size)
    x, base = WIDTH_MM, y + 0.8 * _line_mm(size + 1)
    for style, name in reversed(page.keys):
        x -= text_width_mm(name, size - 1)
        items.append(Text(x, base, name, size - 1, colour=SOFT))
        colour, dash = STYLES.get(style, (BAND, ()))
        if style == "dots":
            items.append(rectangle((x - 3.2, base - 1.5, x - 2.2, base - 0.5), STYLES["other"][0], None))
        else:
            width = 2.0 if style == "band" else 0.5
            items.append(Path(((x - 8.0, base - 1.0), (x - 1.5, base - 1.0)), colour, None, width, dash))
        x -= 12.0
    # of more presses those that lie evenly in their order
    at = np.linspace(0, len(page.panels) - 1, min(len(page.panels), MOST_PANELS)).round().astype(int)
    shown = [page.panels[number] for number in at]
    columns = _columns(len(shown))
    wide = (WIDTH_MM - (columns - 1) * GAP_MM) / columns
    ranges = {panel.level: _range([one for one in shown if one.level == panel.level]) for panel in shown}
    for number, panel in enumerate(shown):
        row, column = divmod(number, columns)
        left, top = column * (wide + GAP_MM), under + row * high
        box = (left, top, left + wide, top + high - 1.5)
        items += _panel(panel, box, ranges[panel.level], size - 1, bool(page.keys))
    return under - (-len(shown) // columns) * high


def _range(panels: Sequence[Panel]) -> tuple[float, float] | None:
    """The range of forces of the panels of one level; None for their own."""
    if not panels[0].level:
        return None
    ends = [one.extent() for panel in panels for one in panel.plot.series if one.kind in ("band", "line", "dots")]
    most = [float(np.nanmax(y)) for _, y in ends if np.isfinite(y).any()]
    return 0.0, 1.06 * max(most, default=1.0)


def _panel(panel: Panel, box: Box, y_range: tuple[float, float] | None, size: float, keyed: bool = True) -> list[Item]:
    """One press: its test and how it reads over its plot."""
    left, high, right, low = box
    line = _line_mm(size)
    reads = shortened(panel.reads, 0.55 * (right - left), size, "bold")
    room = right - left - text_width_mm(reads, size, "bold") - 3.0
    unit = " s" if panel.plot.x_name == "time_s" else ""
    reached = any(one.kind in ("line", "dots") and one.style == "main" for one in panel.plot.series)
    words = "not reached" if keyed and not reached else ""
    under = (left, high + line + 0.7, right, low)
    items = draw_plot(panel.plot, under, size - 0.5, y_range, unit, named=not keyed, words=words)
    if reads:
        items.append(Text(right, high + 0.8 * line, reads, size, "bold", "end", BAD if panel.bad else SOFT))
    return [*items, Text(left, high + 0.8 * line, shortened(panel.test, room, size, "bold"), size, "bold")]


def _lower(items: list[Item], page: FrontPage, size: float, y: float) -> float:
    """Table and blocks, warnings, steps and foot."""
    wide = 0.6 * WIDTH_MM
    low = _grid(items, page.table, 0.0, y, wide if page.blocks else WIDTH_MM, size)
    under, x = y, wide + 6.0
    for title, texts in page.blocks:
        under = _heading(items, title, x, under, WIDTH_MM - x, size)
        for text in texts:
            under = paragraph(items, x, under, wrapped(text, WIDTH_MM - x, size, most=3), size) + 0.6
        under += 1.5
    y = max(low, under) + 1.5
    for note in page.notes[:MOST_NOTES]:
        at = len(items)
        low = paragraph(items, 5.0, y + 0.8, wrapped(note, WIDTH_MM - 6.0, size, most=2), size)
        items.insert(at, Path(((1.5, y + 0.8), (1.5, low)), LIGHTS["amber"][0], width_mm=1.0))
        y = low + 0.6
    if page.steps:
        y = _steps(items, page, y + 1.0, size)
    return paragraph(items, 0.0, y + 1.5, wrapped(page.foot, WIDTH_MM, size - 1, most=2), size - 1, colour=SOFT)


def _steps(items: list[Item], page: FrontPage, y: float, size: float) -> float:
    """What to do next, numbered, on a tinted ground; commands in the letters of a terminal."""
    texts: list[Item] = []
    low = _heading(texts, "What to do next", 4.0, y + 1.5, WIDTH_MM - 8.0, size)
    numbered = len(page.steps) > 1
    left = 9.0 if numbered else 4.0
    for number, step in enumerate(page.steps, 1):
        typed = step.startswith("dummydesign ")
        face, own = ("mono", size - 0.5) if typed else ("plain", size)
        lines = wrapped(step, WIDTH_MM - left - 8.0, own, face, 3)
        if typed:  # a shell takes the lines as one
            lines = [*(f"{line} \\" for line in lines[:-1]), lines[-1]]
        if numbered:
            texts.append(Text(5.0, low + 0.8 * _line_mm(size), str(number), size, "bold"))
        low = paragraph(texts, left, low, lines, own, face, pitch=PITCH * size / own) + 0.7
    items += [rectangle((0.0, y, WIDTH_MM, low + 1.0), PANEL, None), *texts]
    return low + 1.0


def _grid(items: list[Item], table: Grid, x: float, y: float, wide: float, size: float) -> float:
    """A table: columns as wide as their widest text, spread over the width; smaller where it has no room."""
    rows = [list(table.head), *(list(row) for row in table.rows)]
    if not table.rows:
        return y
    if len(table.rows) > MOST_ROWS + 1:
        rows = [*rows[: MOST_ROWS + 1], [f"... and {len(table.rows) - MOST_ROWS} more in the report"]]
    count = len(table.head)

    def widths(of: float) -> list[float]:
        faces = ["bold", *["plain"] * len(rows)]
        return [
            max(text_width_mm(row[k], of, face) for row, face in zip(rows, faces) if 1 < len(row) > k)
            for k in range(count)
        ]

    while size > 4.5 and sum(widths(size)) + 2.0 * (count - 1) > wide:
        size -= 0.5
    own = widths(size)
    gap = min((wide - sum(own)) / max(count - 1, 1), 9.0)
    rights = np.cumsum(own) + gap * np.arange(count)
    step = 1.5 * size * PT_MM
    for number, row in enumerate(rows):
        base = y + number * step + 0.72 * step
        colour = SOFT if number == 0 else BAD if number - 1 in table.marked else INK
        face = "plain" if number else "bold"
        for k, words in ((k, words) for k, words in enumerate(row) if words):
            first, last = k == 0, k == count - 1 and not table.head[k]
            left = x if first else x + float(rights[k]) - (own[k] if last else 0.0)
            items.append(Text(left, base, words, size, face, "start" if first or last else "end", colour))
        if number + 1 < len(rows):
            edge = y + (number + 1) * step
            items.append(Path(((x, edge), (x + float(rights[-1]), edge)), RULE, width_mm=0.3 if number == 0 else 0.15))
    return y + len(rows) * step
