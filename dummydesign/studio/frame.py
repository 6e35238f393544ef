"""What every page has: the steps along the top, words of one's own problems, and the panel of a long command."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from urllib.parse import urlencode

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import FILE, Project, read_project
from dummydesign.report.html import page as report_page
from dummydesign.report.html.glossary import whole_glossary
from dummydesign.studio.addresses import address
from dummydesign.studio.figures import plot_script
from dummydesign.studio.glossary import glossary_head, marked
from dummydesign.studio.screen_reader import reader_script
from dummydesign.studio.server.reconnect import page_script
from dummydesign.studio.state import State, read_state
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import shown

STEPS = (
    ("/", "Overview"), ("/measured", "1 Measured"), ("/tissue", "2 Tissue"), ("/design", "3 Design"),
    ("/mould", "4 Mould"), ("/cast", "5 Cast pad"), ("/campaign", "6 Campaign"), ("/learn", "7 Learn"),
)  # fmt: skip

# links that carry the state get it when they are used: panels come and go, and the state changes meanwhile
KEEP_STATE = """
let stateQuery = QUERY;
function keepState(query, more) {
  stateQuery = query;
  history.replaceState(history.state, '', '?' + [query, more].filter(Boolean).join('&'));
}
for (const kind of ['pointerdown', 'focusin', 'click']) addEventListener(kind, (event) => {
  const link = event.target.closest?.('a[data-state]');
  if (link) link.setAttribute('href', link.getAttribute('href').split('?')[0] + '?' + stateQuery);
}, true);
"""
# on a phone the steps do not fit beside each other: the one that is open is moved into sight
SHOW_STEP = (
    "addEventListener('load', () => setTimeout(() => document.querySelector('nav [aria-current]')"
    "?.scrollIntoView({inline: 'center', block: 'nearest'}), 300));"
)


@dataclass(frozen=True)
class Studio:
    """The folder that is open; everything else is read from it whenever a page is made."""

    root: Path

    @property
    def project(self) -> Project | None:
        """The project as it is now; None in a folder that is none yet.

        Raises
        ------
        InputError
            When ``project.toml`` is damaged.
        """
        return read_project(self.root) if (self.root / FILE).is_file() else None


@cache
def style() -> str:
    """Style of the reports, with what a page of the studio has besides."""
    report = (Path(report_page.__file__).parent / "page.css").read_text(encoding="utf-8")
    own = (Path(__file__).parent / "studio.css").read_text(encoding="utf-8")
    return report + own


Body = Callable[[Project, State], None]


def lay_out(
    studio: Studio, here: str, title: str, query: Mapping[str, str], body: Body, empty: Callable[[], None] | None = None
) -> None:
    """Lay out a page; what is wrong in the folder is said on it.

    Parameters
    ----------
    studio : Studio
    here : str
        Path of the page.
    title : str
        Heading.
    query : mapping
        Of the address: the state that the page shows.
    body : callable
        Builds the page of a project in a state.
    empty : callable, optional
        Builds it where the folder is no project yet.
    """
    ui.colors(primary="#0b5cad")
    ui.add_head_html(f"<style>{style()}</style><script>document.documentElement.lang = 'en'</script>")
    ui.add_head_html(page_script() + reader_script() + plot_script() + glossary_head())
    ui.page_title(f"{title} – dummydesign studio")
    problem, project, state = "", None, None
    try:
        project = studio.project
        state = read_state(project, query) if project else None
    except (InputError, OSError) as said:
        problem = problem_text(said)
    name = project.name if project else studio.root.name
    links = "".join(page_link(path, words, current=path == here) for path, words in STEPS)
    html(
        '<a class="skip" href="#body">to the content</a><div class="top"><div class="bar">'
        f'<span class="name">{escape(name)}</span><nav aria-label="steps">{links}</nav></div></div>'
    )
    kept = KEEP_STATE.replace("QUERY", json.dumps(state.query() if state else "").replace("<", "\\u003c"))
    ui.add_body_html(f"<script>{SHOW_STEP}{kept}</script>")
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
                body(project, state)
            elif empty is not None:
                empty()
            else:
                html(f'<p class="note">This folder is no project yet: {page_link("/", "make it one")} first.</p>')
        except (InputError, OSError) as said:
            tell_problem(problem_text(said))
        html(f'<footer class="glossary">{whole_glossary()}</footer>')


LONGEST_ADDRESS = 8000
"""Characters of what a page keeps in its address besides the state; servers refuse addresses that are too long."""


def keep_state(state: State, **more: str) -> None:
    """Write a state into the address and into all links that carry it; back, reload and other tabs then show it.

    Parameters
    ----------
    state : State
    more : str
        Choices of this page alone, by name: in its address, not in its links.
    """
    own = urlencode({name: text for name, text in more.items() if text})
    own = own if len(own) <= LONGEST_ADDRESS else ""
    ui.run_javascript(f"keepState({json.dumps(state.query())}, {json.dumps(own)})")


def page_link(path: str, words: str, test: str = "", current: bool = False) -> str:
    """HTML of a link to a page, which shows what is chosen on this one when the link is used.

    Parameters
    ----------
    path : str
        Of the page.
    words : str
        Of the link.
    test : str
        Name by which tests find it.
    current : bool
        Whether it is the page that is open.
    """
    marked = f' data-test="{escape(test)}"' if test else ""
    here = " aria-current=page" if current else ""
    return f'<a data-state{marked}{here} href="{address(path)}">{escape(words)}</a>'


def state_link(path: str, words: str, state: State, test: str = "") -> str:
    """HTML of a link to a page that shows a state of its own, whatever is chosen on this page later.

    Parameters
    ----------
    path, words, test : str
        As for :func:`page_link`.
    state : State
        That the page shows.
    """
    marked = f' data-test="{escape(test)}"' if test else ""
    return f'<a{marked} href="{address(path)}?{escape(state.query())}">{escape(words)}</a>'


def open_page(path: str, state: State) -> None:
    """Go to a page in a state."""
    ui.navigate.to(f"{address(path)}?{state.query()}")


def html(text: str) -> ui.html:
    """A piece of HTML of our own; whatever comes from a file is escaped by then."""
    return ui.html(text, sanitize=False)


def tell_problem(text: str) -> None:
    """Say on the page what is wrong."""
    html(f'<div class="problem" role="alert">{escape(text)}</div>')


def problem_text(problem: Exception) -> str:
    """What went wrong in a sentence: refused by a command or the system, or unexpected."""
    if isinstance(problem, InputError):
        return str(problem)
    if isinstance(problem, OSError):
        file = f"'{Path(str(problem.filename)).name}': " if problem.filename else ""
        return f"{file}{problem.strerror or problem}. Mend this, then try again"
    return f"This failed unexpectedly ({type(problem).__name__}: {problem}). Load this page again"


TIMER_S = 5.0
"""Longer than the time between two calls of any timer of a page. [s]"""


def _tell_failures() -> None:
    """Show on the page what a click or a timer could not do, wherever the code is that did not expect it."""
    place = ui.element("div").style("width:100%")
    seen_s: dict[str, float] = {}

    def tell(problem: Exception) -> None:
        text, now = problem_text(problem), time.monotonic()
        again = now - seen_s.get(text, -math.inf) < TIMER_S
        seen_s[text] = now
        if again:
            return  # a timer that fails again and again
        place.clear()
        with place:
            tell_problem(text)
        ui.run_javascript(f"document.getElementById('{place.html_id}')?.scrollIntoView({{block: 'center'}})")

    ui.on_exception(tell)


def tell_verdict(light: str, text: str, stage: str = "", note: str = "", label: str = "", test: str = "") -> None:
    """A verdict: its light, also for those who cannot see it, and its sentence.

    Parameters
    ----------
    light, text : str
        green, amber or red; the sentence.
    stage : str
        How far it is worked out, for tests.
    note, label : str
        Small behind it, and under it.
    test : str
        Name by which tests find it.
    """
    light, marks = escape(light), f' data-test="{escape(test)}"' if test else ""
    more = f" <small>{escape(note)}</small>" if note else ""
    more += f'<small class="label">{escape(label)}</small>' if label else ""
    html(f'<div class="verdict {light}" data-state="{escape(stage)}"{marks}><span class="light" aria-hidden="true">'
         f'</span><p><span class="hide">{light} light: </span>{marked(text)}{more}</p></div>')  # fmt: skip


def command_line(words: Sequence[str]) -> None:
    """The command that does the same as the page, to copy."""
    text = shown(words)
    with ui.element("div").classes("command"):
        html(f"<code>{escape(text)}</code>")
        copy = ui.button("Copy", on_click=lambda: ui.clipboard.write(text), color=None)
        copy.props('flat dense aria-label="copy the command"')


class Work:
    """The panel of a long command: its line, a button, how far it is, and what it found.

    What is shown comes from the jobs of this name in the folder, so that every tab and a restart see the same: the
    newest one that belongs to what is chosen and has an answer. A later one that failed is said over it.
    """

    def __init__(
        self, studio: Studio, name: str, label: str, words: Callable[[], list[str]], show: Callable[[jobs.Job], None],
        belongs: Callable[[jobs.Job], bool] = lambda job: True, ended: Callable[[jobs.Job], None] | None = None,
        stamp: Callable[[], object] = lambda: None,
    ) -> None:
        """Build it.

        Parameters
        ----------
        studio : Studio
        name : str
            Of the step.
        label : str
            On the button.
        words : callable
            The command line of what is chosen.
        show : callable
            Shows the answer of a job.
        belongs : callable
            Whether a job answers what is chosen on the page.
        ended : callable, optional
            Called once with a job that ended while the page was open.
        stamp : callable, optional
            Of the files behind an answer; it is shown anew when this is another one.
        """
        self._studio, self._name, self._words, self._show = studio, name, words, show
        self._belongs, self._ended, self._stamp = belongs, ended, stamp
        self._seen: object = None
        self._watched = ""
        self._pressed = False
        self.running = self.answered = False
        with ui.element("section").classes("work"):
            self._line = ui.element("div")
            with ui.element("div").classes("state"):
                self._button = ui.button(label, on_click=self.begin).props(f'data-test="run-{name}"')
                self._stop = ui.button("Stop", on_click=self._end, color=None).props(f'outline data-test="stop-{name}"')
                self._spinner = ui.spinner(size="1.4em")
                self._said = ui.label("").props('role="status" aria-live="polite"')
            self._problem = ui.element("div")
            self._found = ui.element("div").props(f'data-test="found-{name}"').style("width:100%")
        self.renew_line()
        self.update()
        ui.timer(0.5, self.update)

    def renew_line(self) -> None:
        """Write the command line anew, after something was chosen, and show what belongs to it."""
        self._line.clear()
        with self._line:
            try:
                command_line(self._words())
            except InputError as said:
                html(f'<p class="note">{escape(str(said))}</p>')
        if self._seen is not None:
            self.update()

    def show_again(self) -> None:
        """Show anew what is there, after the panel was hidden."""
        self._seen = ()
        self.renew_line()

    def begin(self) -> None:
        """Start the command as it is shown."""
        self._problem.clear()
        try:
            jobs.start(self._studio.root, self._name, self._words())
        except InputError as said:
            with self._problem:
                tell_problem(str(said))
            return
        self._pressed = True
        self.update()
        _move_focus(self._button, self._stop)

    def _end(self) -> None:
        job = jobs.latest(self._studio.root, self._name)
        if job is not None:
            jobs.stop(job)
            self._said.set_text("stopping …")

    def update(self) -> None:
        """Show how the newest command of this step stands, and the newest answer to what is chosen."""
        every = jobs.named(self._studio.root, self._name)
        newest = every[-1] if every else None
        running = newest is not None and newest.state == "running"
        self._button.set_enabled(not running)
        self._stop.set_visibility(running)
        self._spinner.set_visibility(running)
        self.running = running
        if self._pressed and not running:
            self._pressed = False
            _move_focus(self._stop, self._button)
        shown_job = next((one for one in reversed(every) if self._belongs(one) and has_answer(one)), None)
        self.answered = shown_job is not None
        if newest is not None and running:
            self._watched = newest.folder.name
            self._said.set_text(f"{newest.progress or 'at work'} – {newest.seconds:.0f} s")
        chosen = self._chosen()
        seen = (newest and (newest.folder.name, newest.state, self._belongs(newest)),
                shown_job and (shown_job.folder.name, list(shown_job.words) == chosen), self._stamp())  # fmt: skip
        if seen == self._seen:
            return
        self._seen = seen
        self._state_of(newest)
        self._found.clear()
        if shown_job is not None:
            with self._found:
                if shown_job is not newest or list(shown_job.words) != chosen:
                    when = time.strftime("%d %b %H:%M", time.localtime(shown_job.started))
                    html(f'<p class="source">Result of {when}: <code>{escape(shown(shown_job.words))}</code></p>')
                self._show(shown_job)
        if newest is not None and not running and newest.folder.name == self._watched:
            self._watched = ""
            if self._ended is not None and newest.answer:
                self._ended(newest)

    def _chosen(self) -> list[str]:
        try:
            return self._words()
        except InputError:
            return []

    def _state_of(self, job: jobs.Job | None) -> None:
        """Say how a command ended; one for another choice is said with its line."""
        self._problem.clear()
        if job is None or job.state == "running":
            return
        words = {"done": f"done in {job.seconds:.0f} s", "failed": "no result", "stopped": "stopped", "lost": "ended"}
        mine = self._belongs(job)
        if not mine:
            self._said.set_text("")
            return
        self._said.set_text(words[job.state])
        if job.error and job.state != "done":
            with self._problem:
                tell_problem(job.error)
            if job.state == "failed" and job.answer:
                self._said.set_text(f"done in {job.seconds:.0f} s, but the answer is not acceptable")


def _move_focus(gone: ui.button, stays: ui.button) -> None:
    """Hand the focus on from a button that cannot be used any more, unless the user went elsewhere."""
    ui.run_javascript(
        "setTimeout(() => { const at = document.activeElement; "
        f"if (at === document.body || at.id === '{gone.html_id}') "
        f"document.getElementById('{stays.html_id}')?.focus({{preventScroll: true}}); }}, 200)"
    )


def has_answer(job: jobs.Job) -> bool:
    """Whether a command ended with an answer, also with one that is not acceptable; an error is none."""
    return job.state in ("done", "failed") and bool(job.answer.keys() - {"error"})


def facts(rows: Sequence[tuple[str, str]]) -> None:
    """Values, large, with what they are."""
    html(
        '<div class="facts">'
        + "".join(f'<div class="fact"><b>{escape(value)}</b><span>{marked(what)}</span></div>' for value, what in rows)
        + "</div>"
    )


def warnings(answer: dict) -> None:
    """What a command warned of."""
    said = "".join(f"<li>{marked(str(one['message']))}</li>" for one in answer.get("warnings", []))
    if said:
        html(f'<ul class="warnings">{said}</ul>')


def table(head: Sequence[str], rows: Sequence[Sequence[object]], words: bool = False, under: str = "") -> None:
    """A table that scrolls by itself.

    Parameters
    ----------
    head : sequence of str
        Names of the columns.
    rows : sequence of sequence
        Values.
    words : bool
        Words rather than numbers: from the left, in lines.
    under : str
        What it is folded away under; shown at once without it.
    """
    text = f'<div class="words">{report_page.Table(head, rows).html()}</div>' if words else ""
    text = text or report_page.Table(head, rows).html()
    text = re.sub(r"(<th[^>]*>)([^<&]+)(</th>)", lambda found: found[1] + marked(found[2]) + found[3], text)
    html(f"<details><summary>{escape(under)}</summary>{text}</details>" if under else text)


def file_links(rows: Sequence[tuple[str, str]]) -> None:
    """Links to files of the project: (words, path from the project folder on)."""
    found = "".join(
        f'<a href="{address(f"/files/{path}")}" target="_blank" rel="noopener">{escape(words)}</a>'
        for words, path in rows
    )
    html(f'<div class="links">{found}</div>')


def zip_link(folder: str) -> None:
    """A link that downloads a folder of the project as one file."""
    link = f'<a data-test="zip" href="{address(f"/zip/{folder}")}" download>Download all files (ZIP)</a>'
    html(f'<div class="links">{link}</div>')


def shown_file(path: str, title: str, kind: str = "shown", **query: object) -> None:
    """A page of the project inside this one.

    Parameters
    ----------
    path : str
        From the server's root on, not quoted.
    title : str
        For those who cannot see it.
    kind : str
        ``shown`` or ``shown solid``.
    query : object
        Values by name, as ``address`` takes them.
    """
    source = escape(address(path, **query))
    html(f'<iframe class="{kind}" src="{source}" title="{escape(title)}" loading="lazy"></iframe>')
