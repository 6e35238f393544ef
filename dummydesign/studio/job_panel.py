"""The panel of work: one command, or several one after the other; how far they are, and what they found."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from pathlib import Path

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import jobs, widgets
from dummydesign.studio.markup import verbatim
from dummydesign.studio.widgets import html

ENDED = {"failed": "no result", "stopped": "stopped", "lost": "ended"}
Steps = list[list[str]]
IDLE_S, AT_WORK_S = 0.5, 0.1
"""How often the jobs are looked at. [s]"""


class JobPanel:
    """The panel of a long command: its line with a button, a sentence on how far it is, and what it found.

    What is shown comes from the jobs of this name in the folder, so that every tab and a restart see the same: the
    newest one that belongs to what is chosen and has an answer. A later one that failed is shown over it.
    """

    def __init__(
        self,
        root: Path,
        name: str,
        label: str,
        words: Callable[[], list[str]],
        show: Callable[[jobs.Job], None],
        belongs: Callable[[jobs.Job, list[str]], bool] | None = None,
        made: Callable[[jobs.Job], str] = lambda job: "",
        ended: Callable[[jobs.Job, bool], None] | None = None,
        stamp: Callable[[], object] = lambda: None,
        needs: str = "",
        first: Callable[[], Steps] = list,
        check: Callable[[], object] = lambda: None,
        found: ui.element | None = None,
        main: bool = True,
        warn: bool = True,
        reads: Callable[[], Iterable[Path]] = tuple,
    ) -> None:
        """Build it.

        ``belongs`` is given a job and the command that is chosen (empty when that is refused); ``made`` tells the file
        or folder of a job, without which it belongs to nothing any more, as it does once a file of ``reads`` was
        written after it began. ``ended`` is given a job that ended and whether it belongs to what is chosen; what is
        shown is renewed when ``stamp`` changes. Answers without the key ``needs`` are not shown. The commands of
        ``first`` run before. ``check`` refuses what is chosen before anything is started. What was found stands in
        ``found``, else under the button, which is the ``main`` one; what the command warned of follows it, unless
        ``show`` shows that itself (``warn`` False).
        """
        self.root, self.name = root, name
        self._commands: Callable[[], Steps] = lambda: [*first(), words()]
        self._show, self._belongs, self._made, self._ended, self._stamp = show, belongs, made, ended, stamp
        self._reads, self._needs, self._check, self.main, self._warn = reads, needs, check, main, warn
        self._seen: object = None
        self.shown: jobs.Job | None = None
        self._watched = ""
        self._pressed = self.running = False
        with ui.element("section").classes("work"):
            with ui.element("div").classes("state"):
                self._button = widgets.button(label, self.begin, f"run-{name}", main=main)
                self._stop = widgets.button("Stop", self.end, f"stop-{name}")
                self._spinner = ui.spinner(size="1.4em")
                self._status = ui.label("").props('role="status" aria-live="polite"')
                self._lines = ui.element("div")
            self._problem = ui.element("div")
            self._result_area = (found or widgets.area()).props(f'data-test="found-{name}"')
        self._timer = ui.timer(IDLE_S, self.update)
        self.renew()

    def renew(self) -> None:
        """Write the command lines anew, after something was chosen, and show what belongs to them."""
        with widgets.fresh(self._lines):
            try:
                for words in self._commands():
                    widgets.command_line(words)
            except InputError as refused:
                html('<p class="note">{}</p>', str(refused))
        self.update()

    def end(self) -> None:
        """Stop the command that runs."""
        job = jobs.latest(self.root, self.name)
        if job is not None:
            jobs.stop(job)
            self._status.set_text("stopping …")

    def begin(self) -> None:
        """Start the command as it is shown."""
        with widgets.problems_in(self._problem):
            commands = self._commands()
            self._check()
            jobs.start(self.root, self.name, *commands)
            self._pressed = True
            self.update()
            _move_focus(self._button, self._stop)

    def update(self) -> None:
        """Show how the newest command of this step stands, and the newest answer to what is chosen."""
        every = jobs.all_jobs(self.root, self.name)
        try:
            commands = self._commands()
        except InputError:
            commands = [[]]

        def same(job: jobs.Job, words: list[str]) -> bool:
            return [list(one) for one in job.commands] == commands

        def belongs(job: jobs.Job) -> bool:
            mine = (self._belongs or same)(job, commands[-1]) and jobs.is_there(self.root, job, self._made)
            return mine and not jobs.changed_since(self._reads(), job.started)

        newest = every[-1] if every else None
        mine = newest is not None and belongs(newest)
        self.running = newest is not None and newest.state == "running"
        self._timer.interval = AT_WORK_S if self.running else IDLE_S
        self._button.set_enabled(not self.running)
        self._stop.set_visibility(self.running)
        self._stop.set_text("Stop" if mine else "Stop the other one")
        self._spinner.set_visibility(self.running)
        if self._pressed and not self.running:
            self._pressed = False
            _move_focus(self._stop, self._button)
        answer = next((one for one in reversed(every) if belongs(one) and one.has_answer), None)
        self.shown = answer if answer is not None and self._needs in ("", *answer.answer) else None
        if newest is not None and self.running:
            self._watched = newest.folder.name
            line = jobs.progress_line(newest, jobs.usual_s(self.name))
            self._status.set_text(line if mine else f"At work for another choice: {line}")
        as_chosen = answer is not None and same(answer, commands[-1])
        # what was asked is there: the button that comes next is the main one
        if ("outline" in self._button.props) != (quiet := as_chosen or not self.main):
            self._button.props("outline") if quiet else self._button.props(remove="outline")
        ours = newest and (newest.folder.name, newest.state, mine)
        seen = ours, answer and (answer.folder.name, as_chosen), self._stamp()
        if seen == self._seen:
            return
        self._seen = seen
        self._tell_end(newest, mine)
        with widgets.fresh(self._result_area):
            if answer is not None:
                if answer is not newest or not as_chosen:
                    when = time.strftime("%d %b %H:%M", time.localtime(answer.started))
                    html('<p class="source">Result of {}: <code>{}</code></p>', when, verbatim(answer.begun))
                if self.shown is not None:
                    self._show(answer)
                    widgets.warnings(answer.answer if self._warn else {})
        if newest is not None and not self.running and newest.folder.name == self._watched:
            self._watched = ""
            if self._ended is not None and newest.answer:
                self._ended(newest, mine)

    def _tell_end(self, job: jobs.Job | None, mine: bool) -> None:
        """Say how a command ended; one for another choice is shown with its line."""
        self._problem.clear()
        if job is None or job.state == "running":
            return
        state = "done" if job.has_answer else job.state
        self._status.set_text(ENDED.get(state, f"done in {job.seconds:.0f} s") if mine else "")
        # an answer with a verdict says by itself what is wrong
        tells = self.shown is not None and {"verdict", "accepted"} & job.answer.keys()
        if mine and job.error and job.state != "done" and not tells:
            with self._problem:
                widgets.tell_problem(job.error)


def _move_focus(gone: ui.button, stays: ui.button) -> None:
    """Hand the focus on from a button that cannot be used any more, unless the user went elsewhere."""
    ui.run_javascript(
        "setTimeout(() => { const at = document.activeElement; "
        f"if (at === document.body || at.id === '{gone.html_id}') "
        f"document.getElementById('{stays.html_id}')?.focus({{preventScroll: true}}); }}, 200)"
    )
