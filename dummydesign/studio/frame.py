"""What every page has: the steps along the top, words of one's own problems, and the panel of a long command."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from urllib.parse import parse_qsl

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import FILE, Project, read_project
from dummydesign.report.html import page as report_page
from dummydesign.studio.addresses import address
from dummydesign.studio.server.reconnect import page_script
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import shown

STEPS = (
    ("/", "Overview"), ("/measured", "1 Measured"), ("/tissue", "2 Tissue"), ("/design", "3 Design"),
    ("/mould", "4 Mould"), ("/campaign", "5 Campaign"), ("/learn", "6 Learn"),
)  # fmt: skip

# on a phone the steps do not fit beside each other: the one that is open is moved into sight
SHOW_STEP = (
    "addEventListener('load', () => setTimeout(() => document.querySelector('nav [aria-current]')"
    "?.scrollIntoView({inline: 'center', block: 'nearest'}), 300))"
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


def lay_out(
    studio: Studio, here: str, title: str, body: Callable[[Project], None], empty: Callable[[], None] | None = None
) -> None:
    """Lay out a page; what is wrong in the folder is said on it.

    Parameters
    ----------
    studio : Studio
    here : str
        Path of the page.
    title : str
        Heading.
    body : callable
        Builds the page of a project.
    empty : callable, optional
        Builds it where the folder is no project yet.
    """
    ui.colors(primary="#0b5cad")
    ui.add_head_html(f"<style>{style()}</style><script>document.documentElement.lang = 'en'</script>")
    ui.add_head_html(page_script())
    ui.page_title(f"{title} – dummydesign studio")
    problem, project = "", None
    try:
        project = studio.project
    except InputError as said:
        problem = str(said)
    name = project.name if project else studio.root.name
    links = "".join(
        f'<a href="{path}"{" aria-current=page" if path == here else ""}>{escape(words)}</a>' for path, words in STEPS
    )
    html(
        '<a class="skip" href="#body">to the content</a><div class="top"><div class="bar">'
        f'<span class="name">{escape(name)}</span><nav aria-label="steps">{links}</nav></div></div>'
    )
    ui.add_body_html(f"<script>{SHOW_STEP}</script>")
    with ui.element("div").classes("body").props('id="body" tabindex="-1"'):
        html(f"<h1>{escape(title)}</h1>")
        if problem:
            tell_problem(f"{problem}. Mend the file with an editor, then load this page again; nothing was changed.")
            return
        try:
            if project is not None:
                body(project)
            elif empty is not None:
                empty()
            else:
                html('<p class="note">This folder is no project yet: <a href="/">make it one</a> first.</p>')
        except InputError as said:
            tell_problem(str(said))


def html(text: str) -> ui.html:
    """A piece of HTML of our own; whatever comes from a file is escaped by then."""
    return ui.html(text, sanitize=False)


def tell_problem(text: str) -> None:
    """Say on the page what is wrong."""
    html(f'<div class="problem" role="alert">{escape(text)}</div>')


def command_line(words: Sequence[str]) -> None:
    """The command that does the same as the page, to copy."""
    text = shown(words)
    with ui.element("div").classes("command"):
        html(f"<code>{escape(text)}</code>")
        copy = ui.button("Copy", on_click=lambda: ui.clipboard.write(text), color=None)
        copy.props('flat dense aria-label="copy the command"')


class Work:
    """The panel of a long command: its line, a button, how far it is, and what it found.

    What is shown comes from the newest job of this name in the folder, so that every tab and a restart see the same.
    """

    def __init__(
        self, studio: Studio, name: str, label: str, words: Callable[[], list[str]], show: Callable[[jobs.Job], None],
    ) -> None:
        self._studio, self._name, self._words, self._show = studio, name, words, show
        self._seen: tuple[str, str] | None = None
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
        self.look()
        ui.timer(0.5, self.look)

    def renew_line(self) -> None:
        """Write the command line anew, after something was chosen."""
        self._line.clear()
        with self._line:
            try:
                command_line(self._words())
            except InputError as said:
                html(f'<p class="note">{escape(str(said))}</p>')

    def begin(self) -> None:
        """Start the command as it is shown."""
        self._problem.clear()
        try:
            jobs.start(self._studio.root, self._name, self._words())
        except InputError as said:
            with self._problem:
                tell_problem(str(said))
            return
        self.look()

    def _end(self) -> None:
        job = jobs.latest(self._studio.root, self._name)
        if job is not None:
            jobs.stop(job)
            self._said.set_text("stopping …")

    def look(self) -> None:
        """Show how the newest command of this step stands."""
        job = jobs.latest(self._studio.root, self._name)
        running = job is not None and job.state == "running"
        self._button.set_enabled(not running)
        self._stop.set_visibility(running)
        self._spinner.set_visibility(running)
        if job is None:
            return
        if running:
            self._said.set_text(f"{job.progress or 'at work'} – {job.seconds:.0f} s")
        state = (job.folder.name, job.state)
        if state == self._seen:
            return
        self._seen = state
        if running:
            self._problem.clear()
            return
        words = {"done": f"done in {job.seconds:.0f} s", "failed": "no result", "stopped": "stopped", "lost": "ended"}
        self._said.set_text(words[job.state])
        self._problem.clear()
        if job.error and job.state != "done":
            with self._problem:
                tell_problem(job.error)
            if job.state == "failed" and job.answer:
                self._said.set_text(f"an answer in {job.seconds:.0f} s, but not an acceptable one")
        self._found.clear()
        with self._found:
            if job.answer:
                self._show(job)


def facts(rows: Sequence[tuple[str, str]]) -> None:
    """Values, large, with what they are."""
    html(
        '<div class="facts">'
        + "".join(f'<div class="fact"><b>{escape(value)}</b><span>{escape(what)}</span></div>' for value, what in rows)
        + "</div>"
    )


def warnings(answer: dict) -> None:
    """What a command warned of."""
    said = "".join(f"<li>{escape(str(one['message']))}</li>" for one in answer.get("warnings", []))
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
    if path.startswith("/solid/pad?"):
        path, query = "/solid/pad", dict(parse_qsl(path.partition("?")[2]))
    source = escape(address(path, **query))
    html(f'<iframe class="{kind}" src="{source}" title="{escape(title)}" loading="lazy"></iframe>')
