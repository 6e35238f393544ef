"""The frame of every page, and its pieces: text, problems, verdicts, values, tables, links, files."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast
from urllib.parse import urlencode

from nicegui import ui
from nicegui.elements.mixins.value_element import ValueElement

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.tables import Table
from dummydesign.project.folder import Project, project_of
from dummydesign.report import page as report_page
from dummydesign.report.plot import plots_js
from dummydesign.studio.file_transfer import check_there
from dummydesign.studio.jobs import as_typed, changed_inputs
from dummydesign.studio.markup import STEPS, Markup, filled, in_page_words, joined, verbatim
from dummydesign.studio.select_options import offered
from dummydesign.studio.state import State, address, page_link, read_state


@cache
def page_head() -> str:
    """Return style and scripts of a page, for its head: those of the reports and those of the studio."""
    return (
        f"<style>{_file(report_page.__file__, 'page.css')}{_file(__file__, 'studio.css')}</style>"
        "<script>document.documentElement.lang = 'en'</script>"
        f'<script type="text/plain" id="plotly" data-src="plotly.gz"></script><script>{plots_js()}</script>'
        f"<script>{_file(__file__, 'studio.js')}</script>"
    )


def _file(module: str, name: str) -> str:
    """Return the text of a file of this package, which lies beside a module."""
    return (Path(module).parent / name).read_text(encoding="utf-8")


Body = Callable[[Project, State, Mapping[str, str]], object]


def lay_out(
    root: Path,
    here: str,
    title: str,
    purpose: str,
    query: Mapping[str, str],
    body: Body,
    empty: Callable[[Path], None] | None = None,
) -> None:
    """Lay out a page; with faults of the folder on it."""
    client: Any = ui.context.client
    client.kept = {name: text for name, text in query.items() if name not in State.__dataclass_fields__}
    ui.colors(primary="#0b5cad")
    ui.add_head_html(page_head())
    problem, project, state = "", None, None
    try:
        check_there(root)
        project = project_of(root)
        state = read_state(project, query) if project else None
    except (InputError, OSError) as refused:
        problem = problem_text(refused)
    if empty and not (project or problem):
        title = "New project"
    links = Markup().join(page_link(path, words, current=path == here) for path, words in STEPS.items())
    html(
        '<a class="skip" href="#body">to the content</a><div class="top"><div class="bar"><span '
        'class="name">{}</span><nav aria-label="steps">{}</nav></div></div>',
        project.name if project else root.name,
        links,
    )
    ui.page_title(f"{title} – dummydesign studio")
    kept = json.dumps(state.query() if state else "").replace("<", "\\u003c")
    ui.add_body_html(f"<script>stateQuery = {kept};</script>")
    with ui.element("div").classes("body").props('id="body" tabindex="-1"'):
        html('<div class="head"><h1>{}</h1><p>{}</p></div>', title, purpose)
        _tell_failures()
        if problem:
            tell_problem(f"{problem}. Fix the file in an editor, then load this page again; nothing was changed.")
            return
        try:
            if project and state:
                for sentence in state.missing:
                    tell_problem(sentence)
                body(project, state, query)
            elif empty:
                empty(root)
            else:
                html('<p class="note">This folder is no project yet: {} first.</p>', page_link("/", "make it one"))
        except (InputError, OSError) as refused:
            tell_problem(problem_text(refused))
        html('<footer class="glossary">{}</footer>', Markup(report_page.whole_glossary()))


LONGEST_ADDRESS = 8000
"""Characters of what a page keeps in its address besides the state; servers refuse addresses that are too long."""


def keep_state(state: State, **more: str) -> None:
    """Write a state into the address and into all links that carry it; back, reload and other tabs then show it.

    ``more`` are choices of this page alone; they stand in the address beside those that are kept already.
    """
    client: Any = ui.context.client
    client.kept = {name: text for name, text in (client.kept | more).items() if text}
    own = urlencode(client.kept)
    kept = own if len(own) <= LONGEST_ADDRESS else ""
    ui.run_javascript(f"keepState({json.dumps(state.query())}, {json.dumps(kept)})")


def open_page(path: str, state: State) -> None:
    """Go to a page in a state."""
    ui.navigate.to(f"{address(path)}?{state.query()}")


TIMER_S = 5.0
"""Longer than the time between two calls of any timer of a page. [s]"""


def _tell_failures() -> None:
    """Show on the page what a click or a timer could not do, wherever the code is that did not expect it."""
    notice = area()
    seen_s: dict[str, float] = {}

    def tell(problem: Exception) -> None:
        text, now = problem_text(problem), time.monotonic()
        before, seen_s[text] = seen_s.get(text, -math.inf), now
        if now - before < TIMER_S:
            return  # a timer that fails again and again
        with fresh(notice):
            tell_problem(text)
        ui.run_javascript(f"document.getElementById('{notice.html_id}')?.scrollIntoView({{block: 'center'}})")

    ui.on_exception(tell)


for kind in (ui.expansion, ui.input, ui.select):
    kind.default_style("width:100%")


Made = TypeVar("Made", bound=ui.element)


def having(element: Made, **props: str) -> Made:
    """Give an element properties of any letters, those that are empty left out; as text a backslash would end them."""
    element.props.update({name.replace("_", "-"): value for name, value in props.items() if value})
    return element


def html(template: str, *values: object) -> ui.html:
    """Add a piece of HTML of our own; the values in it are escaped unless they are :class:`Markup`."""
    return ui.html(filled(template, *values) if values else template, sanitize=False)


def area(test: str = "", live: bool = False) -> ui.element:
    """Add an empty place as wide as the page; screen readers speak what appears in a ``live`` one."""
    place = ui.element("div").style("width:100%").props('role="status" aria-live="polite"' if live else "")
    return having(place, data_test=test)


def fresh(element: ui.element) -> ui.element:
    """Empty a place, to fill it anew in a ``with`` block."""
    element.clear()
    return element


def on_change(then: Callable[..., object], *fields: ui.element) -> None:
    """Call a function whenever one of some fields gets another value."""
    for field in fields:
        cast(ValueElement, field).on_value_change(then)


def button(words: str, action: Callable[..., object], test: str = "", label: str = "", main: bool = False) -> ui.button:
    """Add a button, outlined unless it is a main one; ``label`` is what screen readers speak for its words."""
    added = ui.button(words, on_click=action, color="primary" if main else None).props("" if main else "outline")
    return having(added, data_test=test, aria_label=label)


def number_of(text: str, name: str, key: str = "") -> float | None:
    """A typed number, with a dot or a comma; None for an empty field."""
    given = text.strip().replace(",", ".")
    if not given:
        return None
    try:
        value = float(given)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} = '{text.strip()}' is not a number", "not_a_number", key or name, text.strip())
    return value


class NumberField(ui.input):
    """A field for a number. What is not allowed stays as it was typed, with the reason under it."""

    def __init__(
        self,
        label: str,
        value: float | None = None,
        low: float = 0.0,
        high: float = 1e6,
        test: str = "",
        hint: str = "",
    ) -> None:
        self._name, self._low, self._high = label, low, high
        super().__init__(label, value="" if value is None else f"{value:.10g}", validation=self._refusal)
        having(self.props("hide-bottom-space"), inputmode="decimal", data_test=test, hint=hint)

    @property
    def number(self) -> float | None:
        """The number; None for an empty field, InputError for one that is not allowed."""
        value = number_of(self.value or "", self._name)
        if value is not None and not self._low <= value <= self._high:
            raise out_of_range(self._name, f"{value:g}", f"{self._low:g}", f"{self._high:g}")
        return value

    def _refusal(self, text: object) -> str | None:
        try:
            self.number  # noqa: B018
        except InputError as refused:
            return str(refused)
        return None


def way_back(field: ui.element, usual: object, back: Callable[[], object] | None = None) -> None:
    """Mark a field whose value is not its usual one, by a button that takes it back to that."""
    own = cast(ValueElement, field)
    with field.add_slot("append"):
        mark = ui.button(icon="undo", on_click=back or (lambda: own.set_value(usual)), color=None)
    words = f"{field.props.get('label', '')} was changed: back to the default"
    having(mark.props("flat dense round size=sm"), aria_label=words, title=words, data_test="back")
    mark.bind_visibility_from(own, "value", lambda value: value not in (usual, None))


class Form:
    """Fields by name, beside each other where there is room, each with a name for tests."""

    def __init__(
        self, test: str, make: Callable[[], Mapping[str, ui.element]] = dict, kept: Mapping[str, str] | None = None
    ) -> None:
        self._test, self._kept, self._place = test, kept or {}, fields()
        self.lay(make)

    def lay(self, make: Callable[[], Mapping[str, ui.element]]) -> None:
        """Make these fields in the place of all others; what is kept for one takes the place of its value."""
        with fresh(self._place):
            self.fields: dict[str, Any] = dict(make())
        for name, field in self.fields.items():
            field.props.setdefault("data-test", f"{self._test}-{name}")
            if usual := cast(ValueElement, field).value:
                way_back(field, usual)
            if name in self._kept:
                cast(ValueElement, field).set_value(self._kept[name])

    def values(self) -> dict[str, Any]:
        """Values by name; InputError for a number that is not allowed."""
        return {name: one.number if isinstance(one, NumberField) else one.value for name, one in self.fields.items()}

    def on_change(self, then: Callable[..., object]) -> None:
        """Call a function whenever one of the fields gets another value."""
        on_change(then, *self.fields.values())

    def filled(self, **needed: str) -> dict[str, Any]:
        """Values by name; InputError where one that is needed is empty."""
        values = self.values()
        for name, words in needed.items():
            if values[name] is None or not str(values[name]).strip():
                raise InputError(f"type {words}", "missing", name)
        return values

    def kept(self) -> dict[str, str]:
        """What is typed, for the address."""
        return {name: str(one.value or "") for name, one in self.fields.items()}


def fields() -> ui.element:
    """Add a place for fields, beside each other where there is room."""
    return ui.element("div").classes("fields")


def fold(words: str, test: str = "", fill: Callable[[], object] | None = None, opened: bool = False) -> ui.expansion:
    """Add a part that is folded; ``fill`` fills it each time it is opened."""
    panel = having(ui.expansion(words, value=opened), data_test=test)

    def turned() -> None:
        with fresh(panel):
            if panel.value and fill:
                fill()

    if fill:
        panel.on_value_change(turned)
    return panel


def tabs(names: Mapping[str, str], first: str, turned: Callable[[str], object]) -> dict[str, ui.element]:
    """Add tabs, name to words, and return the place of each."""
    with ui.tabs(on_change=lambda event: turned(event.value)).props("no-caps align=left") as row:
        made = {name: ui.tab(name, words).props(f'data-test="tab-{name}"') for name, words in names.items()}
    with (
        ui.tab_panels(row, value=made.get(first, made[next(iter(made))]), animated=False)
        .props("keep-alive")
        .style("width:100%")
    ):
        return {name: ui.tab_panel(name) for name in names}


def select(label: str, known: Mapping[str, str], value: str, test: str = "") -> ui.select:
    """Add a field to choose from value to words; what is chosen now is offered too when it is not there any more."""
    return having(ui.select(offered(known, value), value=value, label=label), data_test=test)


def offer(field: ui.select, known: Mapping[str, str], value: str) -> None:
    """Offer what there is; what is chosen and not there is offered as missing, and nothing takes its place."""
    field.set_options(offered(known, value, f"{value} (missing)" if value else "choose one"), value=value)


def select_several(label: str, known: Mapping[str, str], value: Sequence[str], test: str) -> ui.select:
    """Add a field to choose several of value to words."""
    added = ui.select(dict(known), multiple=True, value=list(value), label=label)
    return having(added.props("use-chips").style("grid-column:1/-1"), data_test=test)


def marked(text: str) -> Markup:
    """Return a text as HTML in which the first use of each term opens its definition under the pointer and by touch."""
    text, shown, at = in_page_words(text), Markup(), 0
    for start, end, term in report_page.marked_terms(text):
        shown += text[at:start] + filled('<abbr class="term" data-term="{}">{}</abbr>', term.text, text[start:end])
        at = end
    return shown + text[at:]


def tell_problem(text: str) -> None:
    """Say on the page what is wrong."""
    html('<div class="problem" role="alert">{}</div>', text)


@contextmanager
def problems_in(element: ui.element) -> Iterator[None]:
    """Empty a place, and say there why the work of this block was refused (InputError)."""
    element.clear()
    try:
        yield
    except InputError as problem:
        with element:
            tell_problem(str(problem))


def problem_text(problem: Exception) -> str:
    """Return what went wrong in a sentence: refused by a command or the system, or unexpected."""
    if isinstance(problem, InputError):
        return str(problem)
    if isinstance(problem, OSError):
        file = f"'{Path(str(problem.filename)).name}': " if problem.filename else ""
        return f"{file}{problem.strerror or problem}. Mend this, then try again"
    return f"This failed unexpectedly ({type(problem).__name__}: {problem}). Load this page again"


def tell_changes(root: Path, manifest: str, advice: str) -> None:
    """Name the files that are no longer what a command read, with what to do."""
    for name in changed_inputs(root, root / manifest):
        tell_problem(f"{name} has changed since. {advice}")


def verdict_html(light: str, text: str, state: str = "", note: str = "", label: str = "", test: str = "") -> Markup:
    """A verdict as HTML: its light, also for those who cannot see it, and its sentence."""
    more = filled(" <small>{}</small>", note) if note else Markup()
    more += filled('<small class="label">{}</small>', label) if label else ""
    return filled(
        '<div class="verdict {}" data-state="{}" data-test="{}"><span class="light" aria-hidden="true"></span><p>'
        '<span class="hide">{} light: </span>{}{}</p></div>',
        light,
        state,
        test,
        light,
        marked(text),
        more,
    )


def tell_verdict(light: str, text: str, label: str = "", test: str = "") -> None:
    """Show a verdict."""
    html("{}", verdict_html(light, text, label=label, test=test))


def command_line(words: Sequence[str]) -> None:
    """Show the command that does the same as the page, to copy."""
    text = as_typed(words)
    with ui.element("div").classes("command"):
        html('<code tabindex="0" title="{}">{}</code>', verbatim(text), verbatim(text))
        copy = ui.button(icon="content_copy", on_click=lambda: ui.clipboard.write(text), color=None)
        having(copy.props("flat dense size=sm"), aria_label="copy the command")


def facts(rows: Sequence[tuple[str, str]]) -> None:
    """Show values, large, with what they are."""
    shown = joined('<div class="fact"><b>{}</b><span>{}</span></div>', ((value, marked(what)) for value, what in rows))
    html('<div class="facts">{}</div>', shown)


MOST_WARNINGS = 4
"""Warnings in sight; further ones are folded."""


def warnings(answer: Mapping[str, Any]) -> None:
    """Show what a command warned of."""
    lines = [marked(str(one["message"])) for one in answer.get("warnings", [])]
    if lines:
        html("{}", listed(lines, MOST_WARNINGS, "warning"))


def listed(lines: Sequence[Markup], most: int, what: str) -> Markup:
    """A list as HTML: its first lines in sight, further ones folded."""
    kind, left = f"{what}s", len(lines) - most
    first, rest = (joined("<li>{}</li>", ([one] for one in some)) for some in (lines[:most], lines[most:]))
    head = f"{left} more {kind if left > 1 else what}"
    folded = filled('<details><summary>{}</summary><ul class="{}">{}</ul></details>', head, kind, rest)
    return filled('<ul class="{}">{}</ul>{}', kind, first, folded if rest else "")


def table(
    head: Sequence[str],
    rows: Sequence[Sequence[object]],
    words: bool = False,
    under: str = "",
    symbols: Sequence[str] = (),
) -> None:
    """Show a table that scrolls by itself; ``under`` is the line that it is folded under.

    ``symbols`` are what the first cells of the rows say under the pointer.
    """
    worded = [[in_page_words(cell) if isinstance(cell, str) else cell for cell in row] for row in rows]
    text = str(Table(head, worded).html())
    for row, symbol in zip(rows, symbols):
        named = filled('<td><abbr class="term" tabindex="0" data-term="{}">{}</abbr></td>', symbol, row[0])
        text = text.replace(str(filled("<td>{}</td>", row[0])), str(named), 1)
    text = re.sub(r"(<th[^>]*>)([^<&]+)(</th>)", lambda match: match[1] + str(marked(match[2])) + match[3], text)
    shown = filled('<div class="words">{}</div>', Markup(text)) if words else Markup(text)
    html(*("<details><summary>{}</summary>{}</details>", under, shown) if under else ("{}", shown))


def records(columns: Mapping[str, str | Callable[[Any], Any]], rows: Iterable[Mapping[str, Any]], **more: Any) -> None:
    """Show a table with a column for each head: a key of the rows, or what a function makes of a row."""
    made = Table.of(rows, columns)
    table(made.head, made.rows, **more)


def go(path: str, words: str, state: State | None = None, test: str = "") -> None:
    """Show a link to a page as a button: what comes next."""
    html('<p class="next">{}</p>', page_link(path, words, state, test, kind="go"))


def file_links(rows: Sequence[tuple[str, str]]) -> None:
    """Show links to files of the project: (words, path from the project folder on)."""
    html('<div class="links">{}</div>', Markup().join(file_link(*row) for row in rows))


def file_link(words: str, path: str, kind: str = "") -> Markup:
    """Return a link to a file of the project as HTML."""
    to = address(f"/files/{path}")
    return filled('<a class="{}" href="{}" target="_blank" rel="noopener">{}</a>', kind, to, words)


def zip_link(folder: str, sheets: Sequence[str] = ()) -> None:
    """Show a link that downloads a folder of the project as one file; a button beside that of its pour sheet."""
    kind, more = "go" if sheets else "", (file_link("Pour sheet (PDF)", path, "go more") for path in sheets)
    html(
        '<div class="links"><a class="{}" data-test="zip" href="{}" download>Download all files (ZIP)</a>{}</div>',
        kind,
        address(f"/zip/{folder}"),
        Markup().join(more),
    )


def show_report(root: Path, files: Mapping[str, str], title: str) -> None:
    """Show the report among the files of an answer, with a link to them all; nothing where it is gone."""
    report = files.get("report")
    if report and (root / report).is_file():
        zip_link(Path(report).parent.as_posix())
        fold(f"{title[0].upper()}{title[1:]}", "report", lambda: shown_file(f"/files/{report}", title))


def shown_file(path: str, title: str, kind: str = "shown", **query: object) -> None:
    """Show a page of the project inside this one."""
    html('<iframe class="{}" src="{}" title="{}" loading="lazy"></iframe>', kind, address(path, **query), title)
