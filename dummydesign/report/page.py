"""One HTML page with everything in it: style, figures, tables, scripts, solid viewer."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape, unescape
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from dummydesign._version import __version__
from dummydesign.core.files import csv_text, write_bytes, write_text
from dummydesign.core.serialise import parameter_rows
from dummydesign.core.tables import Table
from dummydesign.core.user_library import data_folder, read_toml
from dummydesign.mold.files.solid_view import stack, view_html
from dummydesign.report.front_page import FrontPage, lay_out
from dummydesign.report.plot import COLUMNS, Plot, plot_scripts, plots_html

NOT_READ = re.compile(r"<(script|style|title|desc)\b.*?</\1>|<[^>]+>", re.DOTALL)


@dataclass(frozen=True)
class Term:
    """A term with its definition, and the other ways in which it is written."""

    name: str
    text: str
    forms: tuple[str, ...] = ()

    @property
    def pattern(self) -> str:
        """Regular expression of the term and its plural."""
        return "|".join(rf"{re.escape(form)}s?" for form in (self.name, *self.forms))


@cache
def terms() -> dict[str, Term]:
    """Terms by lower-case name and form, in the order of the alphabet."""
    content, _ = read_toml(data_folder() / "materials" / "glossary.toml")
    every = [Term(name, entry["text"], tuple(entry.get("forms", ()))) for name, entry in content["terms"].items()]
    every.sort(key=lambda term: term.name.lower())
    return {form.lower(): term for term in every for form in (term.name, *term.forms)}


@cache
def _patterns() -> tuple[tuple[Term, re.Pattern[str]], ...]:
    every = dict.fromkeys(terms().values())
    return tuple((term, re.compile(rf"(?<![\w-])(?:{term.pattern})(?![\w-])", re.IGNORECASE)) for term in every)


def terms_in(page: str) -> list[Term]:
    """Terms that the visible words of a piece of HTML use."""
    text = " ".join(unescape(NOT_READ.sub(" ", page)).split())
    return [term for term, pattern in _patterns() if pattern.search(text)]


def folded_glossary(page: str) -> str:
    """The terms that a page uses, folded away, as HTML; empty where it uses none."""
    return _folded(terms_in(page))


def whole_glossary() -> str:
    """All terms, folded away, as HTML."""
    return _folded(list(dict.fromkeys(terms().values())))


def marked_terms(text: str) -> list[tuple[int, int, Term]]:
    """Where a text uses a term for the first time: start, end and term, in the order of the text."""
    hits = [(*hit.span(), term) for term, pattern in _patterns() if (hit := pattern.search(text))]
    # of terms that overlap the longest is meant
    hits.sort(key=lambda one: (one[0] - one[1], one[0]))
    kept: list[tuple[int, int, Term]] = []
    for one in hits:
        if all(one[1] <= other[0] or one[0] >= other[1] for other in kept):
            kept.append(one)
    return sorted(kept, key=lambda one: one[0])


def _folded(used: list[Term]) -> str:
    if not used:
        return ""
    rows = "".join(f"<dt>{escape(term.name)}</dt><dd>{escape(term.text)}</dd>" for term in used)
    return f'<details class="terms"><summary>Terms on this page</summary><dl>{rows}</dl></details>'


def glossary_page() -> str:
    """The page of the documentation, ``docs/glossary.md``."""
    lines = ["# Glossary", "", "One line a term. Reports and the studio show the same lines.", ""]
    lines += [f"- **{term.name}**: {term.text}" for term in dict.fromkeys(terms().values())]
    return "\n".join(lines) + "\n"


# A browser that honours this refuses any request of the page, and reports it in its console.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


@dataclass(frozen=True)
class Section:
    """A headed part of a page: words, facts, plots, a table, and HTML of its own (already safe)."""

    title: str
    text: str = ""
    plots: Sequence[Plot] = ()
    table: Table | None = None
    html: str = ""

    def to_html(self, anchor: str = "") -> str:
        """The section as HTML; an anchor is what a link goes to."""
        plots = plots_html(self.plots) if self.plots else ""
        text = "".join(f"<p>{escape(part)}</p>" for part in self.text.split("\n\n") if part)
        table = self.table.html() if self.table else ""
        named = f' id="{anchor}"' if anchor else ""
        return f"<section{named}><h2>{escape(self.title)}</h2>{text}{self.html}{plots}{table}</section>"


def page(
    title: str,
    lead: str,
    sections: Iterable[Section],
    facts: Sequence[tuple[str, str]] = (),
    warnings: Sequence[Mapping[str, str]] = (),
    sources: Sequence[str] = (),
    scripts: Sequence[str] = (),
    values: bool = True,
    verdict: Mapping[str, Any] | None = None,
    steps: Sequence[str] | None = None,
) -> str:
    """Lay out one page; where steps are given, what to do next, a list of contents follows them."""
    style = (Path(__file__).parent / "page.css").read_text(encoding="utf-8")
    sections = list(sections)
    body = "".join(section.to_html(f"part-{number}") for number, section in enumerate(sections, 1))
    boxes = "".join(f'<div class="fact"><b>{escape(v)}</b><span>{escape(what)}</span></div>' for v, what in facts)
    items = "".join(f"<li>{escape(item['message'])}</li>" for item in warnings)
    warned = f'<ul class="warnings">{items}</ul>' if items else ""
    listed = "".join(f"<li>{escape(text)}</li>" for text in sources)
    cited = f'<section id="sources"><h2>Sources</h2><ul class="sources">{listed}</ul></section>' if listed else ""
    where = " The values of every figure are in report.csv beside this page." if values else ""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style></head><body><main>"
        + _banner(verdict)
        + f'<h1>{escape(title)}</h1><p class="lead">{escape(lead)}</p>'
        + (f'<div class="facts">{boxes}</div>' if boxes else "")
        + warned
        + _steps(steps or ())
        + ("" if steps is None else _contents([section.title for section in sections], bool(cited)))
        + body
        + cited
        + folded_glossary(f"{lead} {boxes} {warned} {body}")
        + f"<footer>dummydesign {__version__}. Lengths in mm, forces in N, times in s; moduli are long-term "
        f"(relaxed) Young's moduli.{where}</footer>"
        "</main>"
        + (plot_scripts() if '<div class="plot"' in body else "")
        + "".join(f"<script>{script}</script>" for script in scripts)
        + "</body></html>\n"
    )


def _contents(titles: Sequence[str], sources: bool) -> str:
    """Links to the parts of a page."""
    parts = [(f"part-{number}", title) for number, title in enumerate(titles, 1)]
    parts += [("sources", "Sources")] if sources else []
    links = "".join(f'<li><a href="#{anchor}">{escape(title)}</a></li>' for anchor, title in parts)
    return f'<nav class="contents" aria-label="Contents"><h2>Contents</h2><ol>{links}</ol></nav>'


def _steps(steps: Sequence[str]) -> str:
    """What to do next; commands in the letters of a terminal."""
    typed = (f"<code>{escape(one)}</code>" if one.startswith("dummydesign ") else escape(one) for one in steps)
    listed = "".join(f"<li>{one}</li>" for one in typed)
    return f'<section class="steps"><h2>What to do next</h2><ol>{listed}</ol></section>' if listed else ""


def _banner(verdict: Mapping[str, Any] | None) -> str:
    """The verdict with its light, in colour and in words."""
    if verdict is None:
        return ""
    word, _, rest = verdict["text"].partition(". ")
    light = escape(verdict["light"])
    return (
        f'<div class="verdict {light}" role="status"><span class="light" aria-hidden="true"></span>'
        f"<p><b>{light.upper()}: {escape(word.upper().rstrip('.'))}.</b> {escape(rest)}</p></div>"
    )


def write_report(
    folder: Path,
    title: str,
    lead: str,
    sections: Sequence[Section],
    front: FrontPage | None = None,
    **parts: Any,
) -> dict[str, str]:
    """Write ``report.html`` and the values of all plots (``report.csv``); see :func:`page` for the other parts.

    A front is ``report.pdf``; its steps are in the page as well.

    Examples
    --------
    Series of a plot are made by ``Series.line``, ``dots``, ``band``, ``bars``, ``map`` and ``ellipse``.

    >>> import tempfile
    >>> import numpy as np
    >>> from dummydesign.report.plot import Plot, Series
    >>> time, noise = np.linspace(0.0, 1.0, 5), np.full(5, 0.2)
    >>> series = (Series.band("noise", time, -noise, noise), Series.line("trace 1", time, 0.1 * time))
    >>> plot = Plot(
    ...     name="residual", title="Residual over time", alt="Residual of the fit over time; largest 0.1 N.",
    ...     x_label="time [s]", y_label="residual [N]", x_name="time_s", y_name="force_N", series=series)
    >>> table = Table(["trace", "rms N"], [["1", "0.05"]])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     files = write_report(Path(folder), "Fit", "Five elements.", [Section("Residual", "", [plot], table)])
    >>> sorted(files)
    ['report', 'report_values']
    """
    files = {}
    if front is not None:
        parts["steps"] = front.steps
        files["first_page"] = str(write_bytes(folder / "report.pdf", lay_out(front)))
    rows = [row for section in sections for plot in section.plots for row in plot.rows()]
    if rows:
        files["report_values"] = str(write_text(folder / "report.csv", csv_text(COLUMNS, rows)))
    text = page(title, lead, sections, values=bool(rows), **parts)
    return {"report": str(write_text(folder / "report.html", text)), **files}


def figure_values(path: str | Path) -> dict[str, list[dict[str, str]]]:
    """Rows of the values that :func:`write_report` wrote, by the name of the figure."""
    figures: dict[str, list[dict[str, str]]] = {}
    with open(path, newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            figures.setdefault(row["figure"], []).append(row)
    return figures


PAD_UP = "pad, tested face up"


def solid_section(parts: Mapping[str, NDArray], text: str) -> Section:
    """A section with a view of parts that can be turned; the pad beside its mould lies with its tested face up."""
    shown = {PAD_UP if name == "pad" and "mould" in parts else name: triangles for name, triangles in parts.items()}
    if PAD_UP in shown:
        from dummydesign.mold.files.picture import turned_over

        shown[PAD_UP] = turned_over(shown[PAD_UP])
    return Section("Pad and mould", text, html=view_html(stack(shown)))


STYLES = ("main", "alt1", "alt2", "alt3", "alt4", "alt5")
"""Styles of several curves in a figure, in their order."""


def log_start(rise_s: float) -> float:
    """Where a logarithmic axis of time since contact begins: a power of ten below a tenth of the rise. [s]"""
    return 10.0 ** math.floor(math.log10(max(0.1 * rise_s, 1e-4)))


def digits(value: float | None) -> str | None:
    """Five digits: intervals of a good fit are narrower than four show."""
    return None if value is None else f"{value:.5g}"


def unique(name: str, taken: set[str]) -> str:
    """The name, with a number behind it when it is taken; it is then."""
    free, count = name, 1
    while free in taken:
        count += 1
        free = f"{name}-{count}"
    taken.add(free)
    return free


def table_of_parameters(parameters: Mapping[str, Any]) -> Table:
    """Parameters with intervals and what a reader must know of each; dampers of several speeds in rows."""
    rows = []
    for label, one in parameter_rows(parameters):
        notes = ("at the limit of its range" if one.get("at_bound") else "", one.get("reason", ""))
        note = "; ".join(part for part in notes if part)
        rows.append([label, *(digits(one[key]) for key in ("value", "low", "high")), note])
    return Table(["parameter", "value", "95 % low", "95 % high", ""], rows)
