"""The first page of a report: verdict, a drawing, facts, presses as small multiples, a table, what to do next.

A command fills a :class:`FrontPage`; :func:`lay_out` sets it on one sheet of A4, ``report.pdf``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign._version import __version__
from dummydesign.core.tables import Table
from dummydesign.core.typeset import typeset
from dummydesign.report.drawing import draw_plot
from dummydesign.report.plot import Plot

TEMPLATE = Path(__file__).with_name("front_page.typ")
MOST_PANELS, MOST_NUMBERS = 6, 5
MOST_ROWS, MOST_NOTES = 9, 4
"""Rows of the table and warnings that are shown; the report has all."""
COMMAND_WORDS = re.compile(r"(?:'[^']*'|\S)+")
"""Words of a command: what stands in quotes is not broken."""

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
class FrontPage:
    """What stands on the first page.

    Attributes
    ----------
    title, basis : str
        Name of the answer, and for what it holds.
    verdict : tuple of (str or None, str)
        Light (green, amber, red or none) and words; the words up to the first full stop are set in bold.
    drawing : tuple of (str, dict)
        Heading and what is drawn, by :func:`dummydesign.report.drawing.plot_drawing` or
        :func:`dummydesign.report.drawing.pad_section`.
    facts_title, facts : str, sequence of Fact
        What stands right of the drawing.
    panels_title, panels : str, sequence of Panel
        The presses; six are shown.
    keys : sequence of (str, str)
        Style (``band``, ``dots``, ``main``, ``aim``, ``other``) and name of each curve; without any, the curves are
        named where they end.
    table : Table
        Texts under the presses; ``marked`` rows are in the colour of what is outside.
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
    drawing: tuple[str, dict[str, Any]]
    facts_title: str
    facts: Sequence[Fact]
    panels_title: str
    panels: Sequence[Panel]
    keys: Sequence[tuple[str, str]]
    table: Table
    blocks: Sequence[tuple[str, Sequence[str]]] = ()
    notes: Sequence[str] = ()
    steps: Sequence[str] = ()
    foot: str = ""


def lay_out(page: FrontPage) -> bytes:
    """Set the page on one sheet of A4 as PDF, in the largest letters for which there is room.

    Long texts end in three dots; what no size makes room for is left to the report.
    """
    light, words = page.verdict
    first, _, rest = words.partition(". ")
    table = page.table
    rows = [list(row) for row in table.rows]
    if len(rows) > MOST_ROWS + 1:
        rows = [*rows[: MOST_ROWS + 1], [f"... and {len(rows) - MOST_ROWS} more in the report"]]
    # of more presses those that lie evenly in their order
    at = np.linspace(0, len(page.panels) - 1, min(len(page.panels), MOST_PANELS)).round().astype(int)
    shown = [page.panels[number] for number in at]
    ranges = {panel.level: _range([one for one in shown if one.level == panel.level]) for panel in shown}
    left_out = f": {MOST_PANELS} of {len(page.panels)}" if len(page.panels) > MOST_PANELS else ""
    content = {
        "title": page.title,
        "version": f"dummydesign {__version__}",
        "basis": page.basis,
        "light": light or "none",
        "strong": f"{light.upper()}: {first.rstrip('.').upper()}" if light else f"{first.rstrip('.')}.",
        "rest": rest,
        "drawing": {"title": page.drawing[0], **page.drawing[1]},
        "facts_title": page.facts_title,
        "facts": [asdict(fact) for fact in page.facts],
        "panels_title": f"{page.panels_title}{left_out}",
        "panels": [_panel(one, ranges[one.level], bool(page.keys)) for one in shown],
        "keys": page.keys,
        "table": {"head": table.head, "rows": rows, "marked": sorted(table.marked)},
        "blocks": page.blocks,
        "notes": page.notes[:MOST_NOTES],
        "steps_title": "What to do next",
        "steps": [COMMAND_WORDS.findall(one) if one.startswith("dummydesign ") else one for one in page.steps],
        "foot": page.foot,
    }
    return typeset(TEMPLATE, content)


def full_sentence(text: str) -> str:
    """The text with a capital, unless it begins with a file's name, and a full stop."""
    first = text.partition(" ")[0].rstrip(",;:")
    return text and f"{text[0].upper() if first.isalpha() else text[0]}{text[1:].removesuffix('.')}."


def warning_texts(warnings: Sequence[Mapping[str, str]]) -> list[str]:
    """The first warning of each kind, and how many more there are of it."""
    kinds: dict[str, list[str]] = {}
    for item in warnings:
        kinds.setdefault(item["code"], []).append(item["message"])
    return [
        full_sentence(texts[0]) + (f" ({len(texts) - 1} more)" if len(texts) > 1 else "") for texts in kinds.values()
    ]


def _range(panels: Sequence[Panel]) -> tuple[float, float] | None:
    """The range of forces of the panels of one level; None for their own."""
    if not panels[0].level:
        return None
    ends = [one.extent() for panel in panels for one in panel.plot.series if one.kind in ("band", "line", "dots")]
    most = [float(np.nanmax(y)) for _, y in ends if np.isfinite(y).any()]
    return 0.0, 1.06 * max(most, default=1.0)


def _panel(panel: Panel, y_range: tuple[float, float] | None, keyed: bool) -> dict[str, Any]:
    """One press: its test and how it reads over its plot; without a key its curves have their names."""
    reached = any(one.kind in ("line", "dots") and one.style == "main" for one in panel.plot.series)
    unit = " s" if panel.plot.x_name == "time_s" else ""
    words = "not reached" if keyed and not reached else ""
    plot = draw_plot(panel.plot, MOST_NUMBERS, y_range, unit, named=not keyed, words=words)
    return {"test": panel.test, "reads": panel.reads, "bad": panel.bad, "plot": plot}
