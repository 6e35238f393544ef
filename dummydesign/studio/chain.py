"""The panel of several commands, one after the other: each starts when the one before it is done."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import Studio, command_line, html, tell_problem
from dummydesign.studio.work import jobs
from dummydesign.studio.work.jobs import Job

Steps = list[list[str]]
WORDS = {"running": "at work", "done": "done", "failed": "no result", "stopped": "stopped", "lost": "ended"}


class Chain:
    """Command lines with one button; the jobs in the folder say how far they are, so that a reload goes on."""

    def __init__(
        self, studio: Studio, name: str, label: str, steps: Callable[[], Steps], show: Callable[[list[Job]], None],
        ended: Callable[[list[Job]], None], check: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        """Build it.

        Parameters
        ----------
        studio : Studio
        name : str
            Of the step.
        label : str
            On the button.
        steps : callable
            The command lines of what is chosen, in their order.
        show : callable
            Shows the jobs of all steps once all are done.
        ended : callable
            Called once with them, when they ended while the page was open.
        check : callable, optional
            Raises InputError for what cannot be begun.
        """
        self._root, self._name, self._steps = studio.root, name, steps
        self._show, self._ended, self._check = show, ended, check
        self._going: Steps = []
        self._since = 0.0
        self._seen: object = None
        with ui.element("section").classes("work"):
            self._lines = ui.element("div").style("width:100%")
            with ui.element("div").classes("state"):
                self._button = ui.button(label, on_click=self._begin).props(f'data-test="run-{name}"')
                self._stop = ui.button("Stop", on_click=self._end, color=None).props(f'outline data-test="stop-{name}"')
                self._spinner = ui.spinner(size="1.4em")
                self._said = ui.label("").props('role="status" aria-live="polite"')
            self._problem = ui.element("div")
            self._found = ui.element("div").props(f'data-test="found-{name}"').style("width:100%")
        self._adopt()
        self.renew()
        ui.timer(0.5, self._update)

    def renew(self) -> None:
        """Write the command lines anew, after something was chosen, and show what belongs to them."""
        self._lines.clear()
        with self._lines:
            try:
                for words in self._steps():
                    command_line(words)
            except InputError as said:
                html(f'<p class="note">{escape(str(said))}</p>')
        self._update()

    def _chosen(self) -> Steps:
        try:
            return self._steps()
        except InputError:
            return []

    def _adopt(self) -> None:
        """Go on with what another page, or this one before a reload, began."""
        every, steps = jobs.named(self._root, self._name), self._chosen()
        if not every or every[-1].state != "running" or list(every[-1].words) not in steps:
            return
        self._going = steps
        for job, wanted in zip(reversed(every), reversed(steps[: steps.index(list(every[-1].words)) + 1])):
            if list(job.words) != wanted:
                break
            self._since = job.started

    def _begin(self) -> None:
        self._problem.clear()
        try:
            steps = self._steps()
            self._check()
            first = jobs.start(self._root, self._name, steps[0])
        except InputError as said:
            with self._problem:
                tell_problem(str(said))
            return
        self._going, self._since = steps, first.started
        self._update()

    def _end(self) -> None:
        self._going = []
        job = jobs.latest(self._root, self._name)
        if job is not None:
            jobs.stop(job)

    def _jobs(self, steps: Steps, since: float) -> list[Job | None]:
        """The newest job of each step, none that is older than the one of the step before."""
        every = jobs.named(self._root, self._name)
        found: list[Job | None] = []
        for words in steps:
            job = next((one for one in reversed(every) if list(one.words) == words and one.started >= since), None)
            found.append(job)
            since = job.started if job is not None else float("inf")
        return found

    def _update(self) -> None:
        """Start what comes next, and show how far the chain is."""
        going = self._going
        if going:
            found = self._jobs(going, self._since)
            at = next((k for k, job in enumerate(found) if job is None or job.state != "done"), len(going))
            job = found[at] if at < len(going) else None
            if at == len(going) or (job is not None and job.state != "running"):
                self._going = []
            elif job is None:
                try:
                    jobs.start(self._root, self._name, going[at])
                except InputError as said:
                    # two commands are at work: this one waits its turn
                    self._said.set_text(f"waiting: {said}")
                    return
        latest = jobs.latest(self._root, self._name)
        running = latest is not None and latest.state == "running"
        steps = going or self._chosen()
        found = self._jobs(steps, self._since if going else 0.0)
        self._button.set_enabled(not (running or self._going))
        self._stop.set_visibility(running)
        self._spinner.set_visibility(running)
        done = sum(job is not None and job.state == "done" for job in found)
        if running and latest is not None:
            at_work = f"step {min(done + 1, len(steps))} of {len(steps)}: {latest.progress or 'at work'}"
            self._said.set_text(f"{at_work} – {latest.seconds:.0f} s")
        seen = [(job.folder.name, job.state) if job is not None else None for job in found], running
        if seen == self._seen:
            return
        self._seen = seen
        self._tell(found, running)
        if going and not self._going and found and done == len(found):
            self._ended([job for job in found if job is not None])

    def _tell(self, found: list[Job | None], running: bool) -> None:
        self._problem.clear()
        self._found.clear()
        known = [job for job in found if job is not None]
        if not running:
            wrong = next((job for job in known if job.state not in ("done", "running")), None)
            whole = bool(known) and all(job.state == "done" for job in known) and len(known) == len(found)
            self._said.set_text(f"done, {len(found)} steps" if whole else WORDS[wrong.state] if wrong else "")
            if wrong is not None:
                with self._problem:
                    tell_problem(wrong.error)
            if whole:
                with self._found:
                    self._show(known)
