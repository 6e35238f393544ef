"""Learn from a campaign: run the loop, read what it found, design again with it, plan the next measurement."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.project.folder import Project
from dummydesign.project.status import things_in
from dummydesign.report.plot import plots_html
from dummydesign.studio import figures, project_index, select_options, widgets
from dummydesign.studio.file_actions import thing
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.jobs import Job, command
from dummydesign.studio.markup import Markup, filled, joined
from dummydesign.studio.state import State, page_link
from dummydesign.studio.widgets import html, keep_state

INTERVAL = ("value", "low", "high")


class LearnPage:
    """The page: a campaign, and what was learned from it."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.root, self.state = project.root, state
        known = select_options.campaigns(self.root)
        if not known:
            html('<p class="note">No campaign yet: {}.</p>', page_link("/campaign", "plan one"))
            return
        with widgets.fields():
            self.campaign = widgets.select("Campaign", known, state.campaign, "campaign")
            self.prior = widgets.select(
                "Earlier calibration of the same material", select_options.calibrations(self.root), ""
            )
        self.lacking = widgets.area("lacking")
        self.work = JobPanel(
            self.root,
            "loop",
            "Learn from it",
            self.words,
            self.show,
            self.belongs,
            lambda job: str(job.answer.get("calibration_file") or ""),
            lambda job, mine: self.list_calibrations(),
            needs="answer",
        )
        self.others = widgets.area()
        html("<h2 id=next>The next measurement</h2><p>Plans the presses that tell most, as a new campaign.</p>")
        self.next = JobPanel(
            self.root,
            "next",
            "Plan the next measurement",
            self.next_words,
            self.show_plan,
            self.belongs,
            lambda job: _plan_folder(job.answer),
            lambda job, mine: self.list_calibrations(),
            main=False,
        )
        self.campaign.on_value_change(self.renew)
        self.prior.on_value_change(self.renew_lines)
        self.show_campaign()

    def words(self) -> list[str]:
        """The loop as a command."""
        out = f"calibrations/loop-{self.campaign.value.partition('/')[2]}"
        return command("loop", self.campaign.value, prior=self.prior.value, out=out)

    def next_words(self) -> list[str]:
        """The loop with a plan of what to press next, as a command."""
        words = self.words()
        name = select_options.free_name(self.root, "campaigns", f"{self.campaign.value.partition('/')[2]}-next")
        # learned from the same files with the same prior: the same calibration, which needs no second folder
        same = any(
            one.folder == words[-1] and one.prior == self.prior.value and not one.outdated(self.root)
            for one in project_index.calibrations(self.root, self.campaign.value)
        )
        return command(*words, plan=f"campaigns/{name}", replace=same)

    def belongs(self, job: Job, words: list[str]) -> bool:
        """Whether a job was of the campaign that is chosen."""
        return job.words[1:2] == (self.campaign.value,)

    def renew(self) -> None:
        """Another campaign was chosen."""
        keep_state(self.chosen())
        self.show_campaign()

    def show_campaign(self) -> None:
        """Whether the campaign is pressed, both commands, and what was learned from it."""
        plans = (one for one in things_in(self.root, "campaigns") if one.folder == self.campaign.value)
        left = sum((one.summary or {}).get("missing", 0) for one in plans)
        self.work.main = not left
        with widgets.fresh(self.lacking):
            if left:
                widgets.tell_problem(f"{left} presses of this campaign are missing: press them, or choose another one.")
                widgets.go("/campaign", "Go on to the presses", self.chosen())
        self.renew_lines()
        self.list_calibrations()

    def renew_lines(self) -> None:
        """Write both commands anew."""
        self.work.renew()
        self.next.renew()

    def chosen(self) -> State:
        """The state with the campaign that is chosen."""
        return self.state.changed(campaign=self.campaign.value)

    def show(self, job: Job) -> None:
        """What a command learned."""
        answer = job.answer
        folder = Path(answer["calibration_file"]).parent.as_posix()
        self._outdated(folder)
        first, *more = answer["answer"] or [""]
        html('<p class="lead" data-test="verdict"><b>{}</b></p>', first)
        html("{}", joined("<p>{}</p>", ([text] for text in more)))
        rows = [
            [effect["name"].replace("_", " "), *project_index.name_and_unit(name), *(value[key] for key in INTERVAL)]
            for effect in answer["effects"]
            for name, value in effect["parameters"].items()
        ]
        if rows:
            widgets.table(["effect", "parameter", "unit", "value", "95 % low", "95 % high"], rows)
        with ui.element("div").classes("links"):
            kind = "go more" if self._again(answer["calibration_file"]) else "go"
            html('<a class="{}" href="#next">Plan the next measurement</a>', kind)
        _curves(self.root, folder)

    def _again(self, calibration: str) -> bool:
        """The way on to a design, where the calibration settles the modulus; whether it does."""
        summaries = {
            f"{one.folder}/calibration.json": one.summary or {} for one in things_in(self.root, "calibrations")
        }
        known = bool(summaries.get(calibration, {}).get("designable", True))
        if known:
            learned = self.chosen().changed(calibration=calibration)
            widgets.go("/design", "Design again with what was learned", learned, "again")
        else:
            widgets.tell_problem("These presses do not settle the modulus: no pad can be designed with them alone.")
        return known

    def _outdated(self, folder: str) -> None:
        for one in project_index.calibrations(self.root, self.campaign.value):
            if one.folder == folder and one.outdated(self.root):
                with widgets.area("outdated"):
                    widgets.tell_problem("The campaign changed after this was learned. Learn again.")

    def list_calibrations(self) -> None:
        """Calibrations of this campaign in the folder, also those made on the terminal."""
        known = list(reversed(project_index.calibrations(self.root, self.campaign.value)))
        job = self.work.shown
        shown = Path(job.answer["calibration_file"]).parent.as_posix() if job else ""
        with widgets.fresh(self.others):
            if known:
                html("<h2>Calibrations of this campaign</h2>")
            for one in known:
                above = ": it is shown above" if one.folder == shown else ""
                words = filled('<span data-test="calibration"><b>{}</b>{}</span>', one.folder, above)
                thing(words, self.root, one.folder, "calibration")
                if above:
                    continue
                self._outdated(one.folder)
                html("<p>{}</p>", one.text)
                self._again(one.file)
                with widgets.fold("Measured and predicted force", opened=not shown and one is known[0]):
                    _curves(self.root, one.folder)

    def show_plan(self, job: Job) -> None:
        """Show what was planned."""
        plan = _plan_folder(job.answer)
        if plan:
            widgets.go("/campaign", f"Go on to {plan}", self.chosen().changed(campaign=plan), "next-plan")


def _plan_folder(answer: Mapping[str, Any]) -> str:
    """Folder of the plan of an answer; empty without one."""
    file = str((answer.get("files") or {}).get("plan_campaign") or "")
    return Path(file).parent.as_posix() if file else ""


def _curves(root: Path, folder: str) -> None:
    """Measured over predicted force of each press; the report where the folder does not have the curves."""
    report = f"{folder}/report.html"
    there = (root / report).is_file()
    try:
        plots = figures.measured_presses(root / folder / "report.csv")
    except (OSError, ValueError, KeyError):
        plots = []
    with ui.element("div").classes("links"):
        widgets.zip_link(folder)
        if plots and there:
            widgets.file_links([("the whole report", report)])
    if plots:
        html('<div data-test="curves">{}</div>', Markup(plots_html(plots, small=True)))
    elif there:
        widgets.shown_file(f"/files/{report}", "report of the loop")
