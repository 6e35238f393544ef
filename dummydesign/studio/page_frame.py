"""The frame of every page: style and scripts, steps, what is wrong in the folder, the glossary."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from urllib.parse import urlencode

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import FILE, Project, read_project
from dummydesign.report import page as report_page
from dummydesign.studio.parts import area, fresh, html, problem_text, tell_problem
from dummydesign.studio.state import State, address, page_link, read_state

STEPS = (
    ("/", "Overview"), ("/measured", "1 Measured"), ("/tissue", "2 Tissue"), ("/design", "3 Design"),
    ("/mould", "4 Mould"), ("/cast", "5 Cast pad"), ("/campaign", "6 Campaign"), ("/learn", "7 Learn"),
)  # fmt: skip


@dataclass(frozen=True)
class Studio:
    """The folder that is open; everything else is read from it whenever a page is made."""

    root: Path

    @property
    def project(self) -> Project | None:
        """The project as it is now; None in a folder that is none yet."""
        return read_project(self.root) if (self.root / FILE).is_file() else None


@cache
def page_head() -> str:
    """Return style and scripts of a page, for its head: those of the reports and those of the studio."""
    return (
        f"<style>{_file(report_page.__file__, 'page.css')}{_file(__file__, 'studio.css')}</style>"
        f"<script>document.documentElement.lang = 'en'</script><script>{report_page.plots_js()}</script>"
        f"<script>{_file(__file__, 'studio.js')}</script>"
    )


def _file(module: str, name: str) -> str:
    """Return the text of a file of this package, which lies beside a module."""
    return (Path(module).parent / name).read_text(encoding="utf-8")


Body = Callable[[Studio, Project, State, Mapping[str, str]], object]


def lay_out(
    studio: Studio, here: str, title: str, query: Mapping[str, str], body: Body,
    empty: Callable[[Studio], None] | None = None,
) -> None:  # fmt: skip
    """Lay out a page; with faults of the folder on it."""
    ui.colors(primary="#0b5cad")
    ui.add_head_html(page_head())
    ui.page_title(f"{title} – dummydesign studio")
    problem, project, state = "", None, None
    try:
        project = studio.project
        state = read_state(project, query) if project else None
    except (InputError, OSError) as refused:
        problem = problem_text(refused)
    name = project.name if project else studio.root.name
    links = "".join(page_link(path, words, current=path == here) for path, words in STEPS)
    html(
        '<a class="skip" href="#body">to the content</a><div class="top"><div class="bar">'
        f'<span class="name">{escape(name)}</span><nav aria-label="steps">{links}</nav></div></div>'
    )
    kept = json.dumps(state.query() if state else "").replace("<", "\\u003c")
    ui.add_body_html(f"<script>stateQuery = {kept};</script>")
    with ui.element("div").classes("body").props('id="body" tabindex="-1"'):
        html(f"<h1>{escape(title)}</h1>")
        _tell_failures()
        if problem:
            tell_problem(f"{problem}. Fix the file in an editor, then load this page again; nothing was changed.")
            return
        try:
            if project is not None and state is not None:
                for sentence in state.missing:
                    tell_problem(sentence)
                body(studio, project, state, query)
            elif empty is not None:
                empty(studio)
            else:
                html(f'<p class="note">This folder is no project yet: {page_link("/", "make it one")} first.</p>')
        except (InputError, OSError) as refused:
            tell_problem(problem_text(refused))
        html(f'<footer class="glossary">{report_page.whole_glossary()}</footer>')


LONGEST_ADDRESS = 8000
"""Characters of what a page keeps in its address besides the state; servers refuse addresses that are too long."""


def keep_state(state: State, **more: str) -> None:
    """Write a state into the address and into all links that carry it; back, reload and other tabs then show it."""
    own = urlencode({name: text for name, text in more.items() if text})
    own = own if len(own) <= LONGEST_ADDRESS else ""
    ui.run_javascript(f"keepState({json.dumps(state.query())}, {json.dumps(own)})")


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
        again = now - seen_s.get(text, -math.inf) < TIMER_S
        seen_s[text] = now
        if again:
            return  # a timer that fails again and again
        with fresh(notice):
            tell_problem(text)
        ui.run_javascript(f"document.getElementById('{notice.html_id}')?.scrollIntoView({{block: 'center'}})")

    ui.on_exception(tell)
