"""A campaign: plan what to press, print the sheet, drop the presses, mend what is wrong, fill in what is known."""

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
    command_line,
    file_links,
    html,
    lay_out,
    open_page,
    state_link,
    table,
    tell_problem,
    zip_link,
)  # fmt: skip
from dummydesign.studio.manage import manage, undo_bar
from dummydesign.studio.pages.bringing_in import BringIn
from dummydesign.studio.pages.dropping import drop_place
from dummydesign.studio.pages.plan import PlanForm
from dummydesign.studio.pages.trials import TrialTable
from dummydesign.studio.presses import incoming
from dummydesign.studio.presses.plans import plan_of
from dummydesign.studio.state import State


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/campaign", "Campaign", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    html("<p>What to press of the pads that were cast, in random order. The model is then compared with it.</p>")
    undo_bar(studio)
    known = choices.folders(studio.root, "campaigns", "campaign.toml")
    with ui.expansion("Plan a new campaign", value=not known).props('data-test="plan-new"').style("width:100%"):
        PlanForm(studio, state)
    with ui.expansion("Bring in a campaign that was pressed earlier").props('data-test="bring-in"').style("width:100%"):
        BringIn(studio, state)
    html("<h2>The presses</h2>")
    if not known:
        html("<p>No campaign yet.</p>")
        return
    start = state.campaign
    known = known if start in known else [start, *known]
    chosen = ui.select(known, value=start, label="Campaign").props('data-test="campaign"').style("width:100%")
    chosen.on_value_change(lambda: open_page("/campaign", state.changed(campaign=chosen.value)))
    if (studio.root / start / "campaign.toml").is_file():
        manage(studio, start, "plan", lambda old, new: open_page("/campaign", state.changed(campaign=new)))
        Presses(studio, state)


class Presses:
    """The presses of the campaign that is chosen."""

    def __init__(self, studio: Studio, state: State) -> None:
        self.studio, self.root, self.state, self.campaign = studio, studio.root, state, state.campaign
        self.folder = self.root / self.campaign
        self.wanted, self.at_work = 0, False
        links = [("the sheet to press from", f"{self.campaign}/{name}") for name in ("sheet.html", "sheet.csv")
                 if (self.folder / name).is_file()]  # fmt: skip
        file_links([*links, ("campaign.toml", f"{self.campaign}/campaign.toml")])
        zip_link(self.campaign)
        drop_place(self.take, self.renew, "Drop the presses (CSV). A file with a planned name takes its place; the "
                   "earlier one goes to the bin. Any other file is assigned to a press below.")  # fmt: skip
        self.undone = ui.element("div").style("width:100%")
        self.held = ui.element("div").style("width:100%")
        self.found = ui.element("div").props('data-test="state"').style("width:100%")
        self.holder = ui.element("div")
        with ui.expansion("Values of the presses: order, age, temperature, rest") as values:
            self.values = ui.element("div").style("width:100%")
        values.props('data-test="values"').style("width:100%")
        values.on_value_change(self.show_values)
        self.change = ui.element("div").style("width:100%")
        self.show_held()
        found = check_campaign(self.folder)
        self.show(found)
        if not found.pressed and plan_of(self.root, self.campaign):
            with self.change, ui.expansion("Change this plan: nothing was pressed yet") as change:
                PlanForm(studio, state, self.campaign)
            change.props('data-test="replan"').style("width:100%")

    def take(self, name: str, content: bytes) -> str:
        """Take a file that was dropped."""
        taken = incoming.take(self.root, self.campaign, name, content)
        self._offer_undo(taken)
        self.show_held()
        return taken.text

    def _offer_undo(self, taken: incoming.Taken) -> None:
        gone = taken.gone
        if gone is None:
            return
        name = gone.path.rpartition("/")[2]
        with self.undone:
            line = ui.element("p").classes("note")

            def undo() -> None:
                line.clear()
                with line:
                    try:
                        incoming.undo(self.root, gone)
                        html(f"The earlier {escape(name)} is back. The other one is in the bin.")
                    except InputError as problem:
                        tell_problem(str(problem))
                self.renew()

            with line:
                html(f"{escape(name)} took the place of an earlier file.")
                back = ui.button(f"Bring back the earlier {name}", on_click=undo, color=None)
                back.props('outline data-test="bring-back"')

    def show_held(self) -> None:
        """Files without a planned name, each with the presses it may be."""
        self.held.clear()
        with self.held:
            for name in incoming.held(self.root, self.campaign):
                self._held(name)

    def _held(self, name: str) -> None:
        choices_of = incoming.presses_for(self.root, self.campaign, name)
        with ui.element("div").classes("fields").props('data-test="held"'):
            pressed = ui.select(choices_of, label=f"{name} is the press").props('data-test="assign-to"')

            def assign() -> None:
                self.undone.clear()
                try:
                    taken = incoming.assign(self.root, self.campaign, name, pressed.value or "")
                except InputError as problem:
                    with self.undone:
                        tell_problem(str(problem))
                    return
                with self.undone:
                    html(f'<p class="note" role="status">{escape(taken.text)}</p>')
                self._offer_undo(taken)
                self.show_held()
                self.renew()

            def discard() -> None:
                gone = incoming.discard(self.root, self.campaign, name)
                bar = undo_bar(self.studio)
                bar.offer(gone, lambda old, new: self.show_held())
                bar.run(self.show_held)

            assign_it = ui.button("Assign", on_click=assign).props('data-test="assign"')
            assign_it.props["aria-label"] = f"assign {name}"
            bin_it = ui.button("Move to the bin", on_click=discard, color=None)
            bin_it.props('outline data-test="discard"').props["aria-label"] = f"move {name} to the bin"

    def show_values(self) -> None:
        """The table of values, once it is opened."""
        if self.values.default_slot.children:
            return
        with self.values:
            try:
                TrialTable(self.folder, self.renew)
            except InputError as problem:
                tell_problem(str(problem))

    def renew(self) -> None:
        """Check the campaign anew, once for all that changed in the meantime."""
        self.wanted += 1
        if not self.at_work:
            with self.holder:
                ui.timer(0.2, self.check, once=True)

    async def check(self) -> None:
        """Check the campaign, apart from the page."""
        if self.at_work:
            return
        self.at_work, seen = True, -1
        try:
            while seen != self.wanted:
                seen = self.wanted
                self.show(await run.io_bound(check_campaign, self.folder))
        except InputError as problem:
            self.found.clear()
            with self.found:
                tell_problem(str(problem))
        finally:
            self.at_work = False

    def show(self, found: Status) -> None:
        """How far the campaign is."""
        if found.pressed:
            self.change.clear()
        self.found.clear()
        with self.found:
            command_line(["campaign", "check", self.campaign])
            _state(found, self.state)


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
    if done:
        html(f'<p class="note">{state_link("/cast", "Check a cast pad", chosen, "cast")}: its presses against the '
             "tissue.</p>")  # fmt: skip
    if found.ready:
        html(f'<p class="note">All is there: {state_link("/learn", "learn from it", chosen, "learn")}.</p>')
