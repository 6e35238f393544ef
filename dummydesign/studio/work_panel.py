"""The panel of work: one command, or several one after the other; how far they are, and what they found."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import jobs, parts
from dummydesign.studio.parts import html

ENDED = {"failed": "no result", "stopped": "stopped", "lost": "ended"}
Steps = list[list[str]]


class Panel:
    """Command lines with a button, a sentence on how far they are, and a place for what they found."""

    def __init__(self, root: Path, name: str, label: str, commands: Callable[[], Steps]) -> None:
        self.root, self.name, self.commands = root, name, commands
        self._seen: object = None
        with ui.element("section").classes("work"):
            self._lines = parts.area()
            with ui.element("div").classes("state"):
                self._button = parts.button(label, self.begin, f"run-{name}", main=True)
                self._stop = parts.button("Stop", self.end, f"stop-{name}")
                self._spinner = ui.spinner(size="1.4em")
                self._status = ui.label("").props('role="status" aria-live="polite"')
            self._problem = ui.element("div")
            self._result_area = parts.area(f"found-{name}")

    def watch(self) -> None:
        """Show what there is, and follow it."""
        self.renew()
        ui.timer(0.5, self.update)

    def begin(self) -> None:
        """Start the first command."""
        raise NotImplementedError

    def update(self) -> None:
        """Show how far the commands are, and what they found."""
        raise NotImplementedError

    def chosen(self) -> Steps:
        """Return the commands of what is chosen; none when that is refused."""
        try:
            return self.commands()
        except InputError:
            return []

    def renew(self) -> None:
        """Write the command lines anew, after something was chosen, and show what belongs to them."""
        with parts.fresh(self._lines):
            parts.command_lines(self.commands)
        self.update()

    def end(self) -> None:
        """Stop the command that runs."""
        job = jobs.latest(self.root, self.name)
        if job is not None:
            jobs.stop(job)
            self._status.set_text("stopping …")

    def _show_running(self, running: bool, busy: bool) -> None:
        self._button.set_enabled(not busy)
        self._stop.set_visibility(running)
        self._spinner.set_visibility(running)


def _same(job: jobs.Job, words: list[str]) -> bool:
    return list(job.words) == words


class Work(Panel):
    """The panel of a long command.

    What is shown comes from the jobs of this name in the folder, so that every tab and a restart see the same: the
    newest one that belongs to what is chosen and has an answer. A later one that failed is shown over it.
    """

    def __init__(
        self, root: Path, name: str, label: str, words: Callable[[], list[str]], show: Callable[[jobs.Job], None],
        belongs: Callable[[jobs.Job, list[str]], bool] = _same, ended: Callable[[jobs.Job, bool], None] | None = None,
        stamp: Callable[[], object] = lambda: None, needs: str = "",
    ) -> None:  # fmt: skip
        """Build it.

        ``belongs`` is given a job and the command that is chosen (empty when that is refused), ``ended`` a job that
        ended and whether it belongs to what is chosen; what is shown is renewed when ``stamp`` changes. Answers without
        the key ``needs`` are not shown.
        """
        super().__init__(root, name, label, lambda: [words()])
        self._show, self._belongs, self._ended, self._stamp, self._needs = show, belongs, ended, stamp, needs
        self._watched = ""
        self._pressed = self.running = self.answered = False
        self.watch()

    def show_again(self) -> None:
        """Show anew what is there, after the panel was hidden."""
        self._seen = ()
        self.renew()

    def begin(self) -> None:
        """Start the command as it is shown."""
        with parts.problems_in(self._problem):
            jobs.start(self.root, self.name, self.commands()[0])
            self._pressed = True
            self.update()
            _move_focus(self._button, self._stop)

    def update(self) -> None:
        """Show how the newest command of this step stands, and the newest answer to what is chosen."""
        every = jobs.all_jobs(self.root, self.name)
        words = next(iter(self.chosen()), [])
        newest = every[-1] if every else None
        mine = newest is not None and self._belongs(newest, words)
        self.running = newest is not None and newest.state == "running"
        self._show_running(self.running, self.running)
        if self._pressed and not self.running:
            self._pressed = False
            _move_focus(self._stop, self._button)
        answer = next((one for one in reversed(every) if self._belongs(one, words) and one.has_answer), None)
        self.answered = answer is not None
        if newest is not None and self.running:
            self._watched = newest.folder.name
            self._status.set_text(f"{newest.progress or 'at work'} – {newest.seconds:.0f} s")
        as_chosen = answer is not None and _same(answer, words)
        ours = newest and (newest.folder.name, newest.state, mine)
        seen = ours, answer and (answer.folder.name, as_chosen), self._stamp()
        if seen == self._seen:
            return
        self._seen = seen
        self._tell_end(newest, mine)
        with parts.fresh(self._result_area):
            if answer is not None:
                if answer is not newest or not as_chosen:
                    when = time.strftime("%d %b %H:%M", time.localtime(answer.started))
                    html(f'<p class="source">Result of {when}: <code>{escape(jobs.shown(answer.words))}</code></p>')
                if not self._needs or self._needs in answer.answer:
                    self._show(answer)
        if newest is not None and not self.running and newest.folder.name == self._watched:
            self._watched = ""
            if self._ended is not None and newest.answer:
                self._ended(newest, mine)

    def _tell_end(self, job: jobs.Job | None, mine: bool) -> None:
        """Say how a command ended; one for another choice is jobs.shown with its line."""
        self._problem.clear()
        if job is None or job.state == "running":
            return
        self._status.set_text(ENDED.get(job.state, f"done in {job.seconds:.0f} s") if mine else "")
        if mine and job.error and job.state != "done":
            with self._problem:
                parts.tell_problem(job.error)
            if job.state == "failed" and job.answer:
                self._status.set_text(f"done in {job.seconds:.0f} s, but the answer is not acceptable")


def _move_focus(gone: ui.button, stays: ui.button) -> None:
    """Hand the focus on from a button that cannot be used any more, unless the user went elsewhere."""
    ui.run_javascript(
        "setTimeout(() => { const at = document.activeElement; "
        f"if (at === document.body || at.id === '{gone.html_id}') "
        f"document.getElementById('{stays.html_id}')?.focus({{preventScroll: true}}); }}, 200)"
    )


class Chain(Panel):
    """The panel of several commands; the jobs in the folder say how far they are, so that a reload goes on."""

    def __init__(
        self, root: Path, name: str, label: str, steps: Callable[[], Steps], show: Callable[[list[jobs.Job]], None],
        ended: Callable[[list[jobs.Job]], None], check: Callable[[], None],
    ) -> None:  # fmt: skip
        """Build it; ``check`` refuses what is chosen before anything is started."""
        super().__init__(root, name, label, steps)
        self._show, self._ended, self._check = show, ended, check
        self._going: Steps = []
        self._since = 0.0
        self._adopt()
        self.watch()

    def _adopt(self) -> None:
        """Go on with what another page, or this one before a reload, began."""
        every, steps = jobs.all_jobs(self.root, self.name), self.chosen()
        words = list(every[-1].words) if every and every[-1].state == "running" else []
        if words not in steps:
            return
        self._going = steps
        for job, wanted in zip(reversed(every), reversed(steps[: steps.index(words) + 1])):
            if list(job.words) != wanted:
                break
            self._since = job.started

    def begin(self) -> None:
        """Start the first command."""
        with parts.problems_in(self._problem):
            steps = self.commands()
            self._check()
            self._since = jobs.start(self.root, self.name, steps[0]).started
            self._going = steps
            self.update()

    def end(self) -> None:
        """Stop the command that runs, and start no other."""
        self._going = []
        super().end()

    def _jobs(self, steps: Steps, since: float) -> list[jobs.Job | None]:
        """Return the newest job of each step, none that is older than the one of the step before."""
        every = jobs.all_jobs(self.root, self.name)
        own_jobs: list[jobs.Job | None] = []
        for words in steps:
            job = next((one for one in reversed(every) if list(one.words) == words and one.started >= since), None)
            own_jobs.append(job)
            since = job.started if job is not None else float("inf")
        return own_jobs

    def update(self) -> None:
        """Start what comes next, and show how far the chain is."""
        going = self._going
        begun = zip(going, self._jobs(going, self._since))
        left = [(words, job) for words, job in begun if job is None or job.state != "done"]
        words, job = left[0] if left else ([], None)
        if not left or (job is not None and job.state != "running"):
            self._going = []
        elif job is None:
            try:
                jobs.start(self.root, self.name, words)
            except InputError as refused:
                # two commands are at work: this one waits its turn
                self._status.set_text(f"waiting: {refused}")
                return
        latest = jobs.latest(self.root, self.name)
        running = latest is not None and latest.state == "running"
        steps = going or self.chosen()
        own_jobs = self._jobs(steps, self._since if going else 0.0)
        self._show_running(running, running or bool(self._going))
        done = [job for job in own_jobs if job is not None and job.state == "done"]
        if running and latest is not None:
            at_work = f"step {min(len(done) + 1, len(steps))} of {len(steps)}: {latest.progress or 'at work'}"
            self._status.set_text(f"{at_work} – {latest.seconds:.0f} s")
        seen = [(job.folder.name, job.state) if job is not None else None for job in own_jobs], running
        if seen == self._seen:
            return
        self._seen = seen
        self._problem.clear()
        whole = bool(done) and len(done) == len(own_jobs)
        with parts.fresh(self._result_area):
            if not running:
                self._tell_end(own_jobs, whole)
            if not running and whole:
                self._show(done)
        if going and not self._going and whole:
            self._ended(done)

    def _tell_end(self, own_jobs: Sequence[jobs.Job | None], whole: bool) -> None:
        """Say how the chain ended: at its last step, or at one without a result."""
        wrong = next((job for job in own_jobs if job is not None and job.state in ENDED), None)
        self._status.set_text(f"done, {len(own_jobs)} steps" if whole else ENDED[wrong.state] if wrong else "")
        if wrong is not None:
            with self._problem:
                parts.tell_problem(wrong.error)
