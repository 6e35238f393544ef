"""A campaign: plan what to press, print the sheet, drop the files of the presses, see what is missing or wrong."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import run, ui

from dummydesign.core.errors import InputError
from dummydesign.measurement.planning.check import Status, check_campaign
from dummydesign.project.folder import Project
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    Work,
    command_line,
    file_links,
    html,
    lay_out,
    open_page,
    state_link,
    table,
    tell_problem,
    warnings,
    zip_link,
)  # fmt: skip
from dummydesign.studio.pages.measured import uploader
from dummydesign.studio.server import files
from dummydesign.studio.state import State
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/campaign", "Campaign", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    html("<p>What to press of the pads that were cast, in a drawn order, so that the model can be held against it.</p>")
    _plan(studio, project, state)
    html("<h2>The presses</h2>")
    known = choices.folders(studio.root, "campaigns", "campaign.toml")
    if not known:
        html("<p>no campaign yet</p>")
        return
    start = state.campaign
    known = known if start in known else [start, *known]
    chosen = ui.select(known, value=start, label="Campaign").props('data-test="campaign"').style("width:100%")
    chosen.on_value_change(lambda: open_page("/campaign", state.changed(campaign=chosen.value)))
    _presses(studio, state)


def _plan(studio: Studio, project: Project, state: State) -> None:
    resin, ratio = state.resin, state.ratio
    none_yet = not choices.folders(studio.root, "campaigns", "campaign.toml")
    with ui.expansion("Plan a new campaign", value=none_yet).style("width:100%"):
        with ui.element("div").classes("fields"):
            name = ui.input("Name", value=choices.free_name(studio.root, "campaigns", "first"))
            pads = ui.input("Pads [mm]", value="5,15,20")
            speeds = ui.input("Speeds [mm/s]", value="10,250")
            forces = ui.input("Steady forces [N]", value="3,7,12")
            repeats = ui.number("Repeats", value=2, min=1, max=9, step=1)
            ages = ui.input("Age of the pads on each day [days]", value="9,14,29")
            hold = ui.number("Hold [s]", value=10, min=1, max=600)
            known = choices.resins()
            material = ui.select(known if resin in known else {resin: resin, **known}, value=resin, label="Resin")
            mixed = ui.number("Ratio", value=ratio, step=0.1)
        for field, test in ((name, "name"), (pads, "pads"), (speeds, "speeds"), (forces, "forces"), (ages, "ages"),
                            (repeats, "repeats")):  # fmt: skip
            field.props(f'data-test="plan-{test}"')

        def words() -> list[str]:
            folder = files.plain_name((name.value or "").strip())
            if repeats.value is None or mixed.value is None:
                raise InputError("repeats and ratio must be numbers")
            given = {
                "pads": pads.value, "velocity": speeds.value, "force": forces.value, "repeats": int(repeats.value),
                "ages": ages.value, "hold": None if hold.value is None else float(hold.value), "resin": material.value,
                "ratio": float(mixed.value), "punch": state.punch,
            }  # fmt: skip
            return ["campaign", "new", f"campaigns/{folder}", *options(given)]

        def show(job: Job) -> None:
            answer = job.answer
            if "trials" not in answer:
                return
            folder = answer["inputs"]["folder"]
            html(f'<p data-test="planned">{len(answer["trials"])} presses planned in {escape(folder)}</p>')
            power = answer.get("power")
            if power:
                html(f"<p>Seen at their usual size: {escape(', '.join(power['seen']) or 'nothing')}.</p>")
            warnings(answer)
            on = state_link("/campaign", "Go on to the presses", state.changed(campaign=folder), "presses")
            html(f'<p class="note">{on}</p>')

        work = Work(studio, "campaign", "Plan it", words, show)
        for field in (name, pads, speeds, forces, repeats, ages, hold, material, mixed):
            field.on_value_change(work.renew_line)


def _presses(studio: Studio, chosen: State) -> None:
    folder = chosen.campaign
    path = studio.root / folder
    links = [("the sheet to press from", f"{folder}/sheet.html")] if (path / "sheet.html").is_file() else []
    file_links([*links, ("campaign.toml", f"{folder}/campaign.toml")])
    zip_link(folder)
    state = ui.element("div").props('data-test="state"')
    said, holder = ui.element("div"), ui.element("div")
    names: set[str] = set()
    # one look for all files that came in the meantime
    looks = {"wanted": 0, "at_work": False}

    def show(found: Status) -> None:
        names.update((*found.pressed, *found.missing, *(str(one["file"]) for one in found.wrong)))
        state.clear()
        with state:
            command_line(["campaign", "check", folder])
            _state(found, chosen)

    def check(name: str) -> None:
        if name not in names:
            raise InputError(f"'{name}' is not in the plan: name each file as the sheet says")

    async def look() -> None:
        if looks["at_work"]:
            return
        looks["at_work"], seen = True, -1
        try:
            while seen != looks["wanted"]:
                seen = looks["wanted"]
                show(await run.io_bound(check_campaign, path))
        except InputError as problem:
            with said:
                tell_problem(str(problem))
        finally:
            looks["at_work"] = False

    def renew(new: str) -> None:
        looks["wanted"] += 1
        if not looks["at_work"]:
            with holder:
                ui.timer(0.2, look, once=True)

    uploader(path, said, renew, check)
    show(check_campaign(path))


def _state(found: Status, chosen: State) -> None:
    """How far a campaign is, in words."""
    done, left = len(found.pressed), len(found.missing)
    html(f'<p role="status"><b>{done} of {done + left} presses are there</b></p>')
    if found.missing:
        html(f"<p>To press: {escape(', '.join(found.missing[:6]))}{' …' if left > 6 else ''}</p>")
    if found.wrong:
        table(["file", "looks wrong"], [[one["file"], one["message"]] for one in found.wrong], words=True)
    for one in found.warnings:
        html(f'<p class="note">{escape(one["message"])}</p>')
    if found.ready:
        html(f'<p class="note">All is there: {state_link("/learn", "learn from it", chosen, "learn")}.</p>')
