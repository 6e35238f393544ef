"""One HTML page with everything in it: style, figures, tables, scripts; it asks nothing of the outside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

from dummydesign._version import __version__
from dummydesign.core.files import write_text
from dummydesign.report.figures.plot import Plot
from dummydesign.report.html.glossary import folded_glossary

# A browser that honours this refuses any request of the page, and says so in its console.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


@dataclass(frozen=True)
class Table:
    """Head and rows of plain values; numbers are written with four digits."""

    head: Sequence[str]
    rows: Sequence[Sequence[Any]]

    def html(self) -> str:
        """The table, scrolling sideways by itself on a narrow screen."""
        head = "".join(f'<th scope="col">{escape(text)}</th>' if text else "<td></td>" for text in self.head)
        rows = "".join("<tr>" + "".join(f"<td>{escape(cell(v))}</td>" for v in row) + "</tr>" for row in self.rows)
        return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def cell(value: Any) -> str:
    """Write one value of a table."""
    if value is None:
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class Section:
    """A headed part of a page: words, facts, plots, a table, and HTML of its own (already safe)."""

    title: str
    text: str = ""
    plots: Sequence[Plot] = ()
    table: Table | None = None
    html: str = ""

    def to_html(self) -> str:
        """The section as HTML."""
        plots = f'<div class="plots">{"".join(plot.html() for plot in self.plots)}</div>' if self.plots else ""
        text = "".join(f"<p>{escape(part)}</p>" for part in self.text.split("\n\n") if part)
        table = self.table.html() if self.table else ""
        return f"<section><h2>{escape(self.title)}</h2>{text}{self.html}{plots}{table}</section>"


def page(
    title: str,
    lead: str,
    sections: Iterable[Section],
    facts: Sequence[tuple[str, str]] = (),
    warnings: Sequence[dict[str, str]] = (),
    sources: Sequence[str] = (),
    scripts: Sequence[str] = (),
    tables: str = "report",
    verdict: Mapping[str, Any] | None = None,
) -> str:
    """Lay out one page.

    Parameters
    ----------
    title, lead : str
        Heading of the page and the sentence under it; escaped here.
    sections : iterable of Section
        In the order of the page.
    facts : sequence of (value with unit, what it is)
        Shown large at the top.
    warnings : sequence of {code, message}
        Listed under the facts.
    sources : sequence of str
        Where numbers come from, at the foot.
    scripts : sequence of str
        JavaScript, put at the end.
    tables : str
        What the names of the CSV files beside the page begin with; empty where there are none.
    verdict : dict, optional
        ``light`` and ``text``, the first thing on the page.

    Returns
    -------
    str
        HTML that asks nothing of the outside.
    """
    style = (Path(__file__).parent / "page.css").read_text(encoding="utf-8")
    body = "".join(section.to_html() for section in sections)
    if '<svg class="plot"' in body:
        scripts = [*scripts, plots_js()]
    boxes = "".join(f'<div class="fact"><b>{escape(v)}</b><span>{escape(what)}</span></div>' for v, what in facts)
    said = "".join(f"<li>{escape(item['message'])}</li>" for item in warnings)
    warned = f'<ul class="warnings">{said}</ul>' if said else ""
    listed = "".join(f"<li>{escape(text)}</li>" for text in sources)
    cited = f'<section><h2>Sources</h2><ul class="sources">{listed}</ul></section>' if listed else ""
    beside = ""
    if tables:
        beside = f" The values of every figure are in the {escape(tables)}-*.csv files beside this page."
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style></head><body><main>"
        + _banner(verdict)
        + f'<h1>{escape(title)}</h1><p class="lead">{escape(lead)}</p>'
        + (f'<div class="facts">{boxes}</div>' if boxes else "")
        + warned
        + body
        + cited
        + folded_glossary(f"{lead} {boxes} {warned} {body}")
        + f"<footer>dummydesign {__version__}. Lengths in mm, forces in N, times in s; moduli are long-term "
        f"(relaxed) Young's moduli.{beside}</footer>"
        "</main>" + "".join(f"<script>{script}</script>" for script in scripts) + "</body></html>\n"
    )


@cache
def plots_js() -> str:
    """The script that shows values of plots under the pointer and enlarges them, without indents and comments."""
    text = (Path(__file__).parent / "plots.js").read_text(encoding="utf-8")
    lines = (line.strip() for line in text.splitlines())
    return "\n".join(line for line in lines if line and not line.startswith("//"))


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
    facts: Sequence[tuple[str, str]] = (),
    warnings: Sequence[dict[str, str]] = (),
    sources: Sequence[str] = (),
    scripts: Sequence[str] = (),
    stem: str = "report",
    verdict: Mapping[str, Any] | None = None,
) -> dict[str, str]:
    """Write ``report.html`` and a CSV of every plot (``report-NAME.csv``) into a folder; see :func:`page`.

    Parameters
    ----------
    folder : Path
        Made when it is not there.
    title, lead, sections, facts, warnings, sources, scripts
        As for :func:`page`.
    stem : str
        Takes the place of ``report`` in the names of the files.
    verdict : dict, optional
        ``light`` and ``text``.

    Returns
    -------
    dict
        ``{"report": path}`` and one ``report_NAME`` a plot.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    files = {}
    for plot in (plot for section in sections for plot in section.plots):
        path = write_text(folder / f"{stem}-{plot.name}.csv", plot.csv_text())
        files[f"report_{plot.name.replace('-', '_')}"] = str(path)
    text = page(title, lead, sections, facts, warnings, sources, scripts, stem, verdict)
    return {"report": str(write_text(folder / f"{stem}.html", text)), **files}


def script_json(value: Any) -> str:
    """JSON that may stand inside a script element."""
    import json

    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
