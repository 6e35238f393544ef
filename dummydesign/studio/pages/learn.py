"""Learn from a campaign: run the loop, read what it found, design again with it."""

from __future__ import annotations

from html import escape
from pathlib import Path

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.studio import choices
from dummydesign.studio.frame import Studio, Work, html, lay_out, shown_file, table, warnings, zip_link
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, which: str) -> None:
    """Build the page."""
    lay_out(studio, "/learn", "Learn", lambda project: _body(studio, project, which))


def _body(studio: Studio, project: Project, which: str) -> None:
    html("<p>The model against a pressed campaign: what it lacks, how large that is, and what to measure next.</p>")
    known = choices.folders(studio.root, "campaigns", "campaign.toml")
    if not known:
        html('<p class="note">No campaign yet: <a href="/campaign">plan one</a>.</p>')
        return
    start = f"campaigns/{which}" if f"campaigns/{which}" in known else known[-1]
    priors = {"": "none"} | {f"{one}/calibration.json": one for one in
                             choices.folders(studio.root, "calibrations", "calibration.json")}  # fmt: skip
    with ui.element("div").classes("fields"):
        chosen = ui.select(known, value=start, label="Campaign").props('data-test="campaign"')
        prior = ui.select(priors, value="", label="Earlier calibration of the same material")

    def words() -> list[str]:
        if not chosen.value:
            raise InputError("choose a campaign")
        name = chosen.value.partition("/")[2]
        return ["loop", chosen.value, *options({"prior": prior.value}), "--out", f"calibrations/loop-{name}"]

    work = Work(studio, "loop", "Learn from it", words, lambda job: _show(studio, job))
    for field in (chosen, prior):
        field.on_value_change(work.renew_line)


def _show(studio: Studio, job: Job) -> None:
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
    again = f"/design?which={escape(answer['calibration_file'])}"
    html(f'<p class="note next"><a data-test="again" href="{again}">Design again with what was learned</a></p>')
    if (studio.root / folder / "report.html").is_file():
        shown_file(f"/files/{folder}/report.html", "report of the loop")
