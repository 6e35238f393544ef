"""Learn from a campaign: run the loop, read what it found, design again with it."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    Work,
    html,
    keep_state,
    lay_out,
    page_link,
    shown_file,
    state_link,
    table,
    warnings,
    zip_link,
)  # fmt: skip
from dummydesign.studio.state import State
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/learn", "Learn", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    html("<p>The model against a pressed campaign: what it lacks, how large that is, and what to measure next.</p>")
    known = choices.folders(studio.root, "campaigns", "campaign.toml")
    if not known:
        html(f'<p class="note">No campaign yet: {page_link("/campaign", "plan one")}.</p>')
        return
    start = state.campaign
    priors = {"": "none"} | {f"{one}/calibration.json": one for one in
                             choices.folders(studio.root, "calibrations", "calibration.json")}  # fmt: skip
    known = known if start in known else [start, *known]
    with ui.element("div").classes("fields"):
        chosen = ui.select(known, value=start, label="Campaign").props('data-test="campaign"')
        prior = ui.select(priors, value="", label="Earlier calibration of the same material")

    def words() -> list[str]:
        if not chosen.value:
            raise InputError("choose a campaign")
        name = chosen.value.partition("/")[2]
        return ["loop", chosen.value, *options({"prior": prior.value}), "--out", f"calibrations/loop-{name}"]

    def belongs(job: Job) -> bool:
        return job.words[1:2] == (chosen.value,)

    work = Work(studio, "loop", "Learn from it", words, lambda job: _show(studio, state, job), belongs)

    def renew() -> None:
        keep_state(state.changed(campaign=chosen.value))
        work.renew_line()

    chosen.on_value_change(renew)
    prior.on_value_change(work.renew_line)


def _show(studio: Studio, state: State, job: Job) -> None:
    answer = job.answer
    if "answer" not in answer:
        return
    html("".join(f"<p>{escape(text)}</p>" for text in answer["answer"]))
    rows = [
        [effect["name"], name, value["value"], value["low"], value["high"]]
        for effect in answer["effects"] for name, value in effect["parameters"].items()
    ]  # fmt: skip
    if rows:
        table(["effect", "parameter", "value", "95 % low", "95 % high"], rows)
    warnings(answer)
    folder = Path(answer["calibration_file"]).parent.as_posix()
    zip_link(folder)
    again = state.changed(calibration=answer["calibration_file"], campaign=job.words[1])
    html(f'<p class="note next">{state_link("/design", "Design again with what was learned", again, "again")}</p>')
    if (studio.root / folder / "report.html").is_file():
        shown_file(f"/files/{folder}/report.html", "report of the loop")
