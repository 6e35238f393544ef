"""Bring in a campaign that was pressed elsewhere: its files at once, with campaign.toml or with a table of trials."""

from __future__ import annotations

from html import escape
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import bin, choices
from dummydesign.studio.frame import Studio, Work, html, open_page, state_link, table, tell_problem, warnings
from dummydesign.studio.pages.dropping import drop_place
from dummydesign.studio.pages.value_table import HEADS, number_of, value_table
from dummydesign.studio.presses import bring_in
from dummydesign.studio.state import State
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job

FIELDS = {
    "young": "Modulus of the pads [kPa]", "ratio": "Ratio", "punch": "Punch", "pad": "Outline [mm]", "shape": "Shape",
    "base": "Base", "contact": "Contact under the punch", "lowpass": "Filter of the force, HZ[:ORDER[:PASSES]]",
}  # fmt: skip


class BringIn:
    """Files that wait, and the two ways to a campaign."""

    def __init__(self, studio: Studio, state: State) -> None:
        self.studio, self.root, self.state = studio, studio.root, state
        self.clear = drop_place(self.take, self.show, "Drop all files of the campaign at once: the presses (CSV) and, "
                                "where there is one, campaign.toml or a table trials.csv.", "campaign")  # fmt: skip
        self.name = ui.input("Name of the campaign", value=choices.free_name(self.root, "campaigns", "earlier"))
        self.name.props('data-test="bring-name"').on_value_change(self.renew)
        self.problem = ui.element("div").style("width:100%")
        self.as_it_is = ui.element("div").style("width:100%")
        with self.as_it_is:
            html("<p>campaign.toml is among the files. They are taken as they are.</p>")
            ui.button("Bring it in", on_click=self.bring).props('data-test="bring"')
        self.by_table = ui.element("div").style("width:100%")
        with self.by_table:
            self._by_table()
        self.files = ui.element("div").style("width:100%")
        self.empty = ui.button("Remove these files", on_click=self.remove, color=None)
        self.empty.props('outline data-test="bring-remove"')
        self.show()

    def _by_table(self) -> None:
        html("<p>No campaign.toml: say of each press what it was. Pad and speed are needed; empty means unknown.</p>")
        self.words_of_table = ui.element("div").props('role="status" aria-live="polite"')
        self.table = ui.element("div").style("width:100%")
        resin = self.state.resin
        known = choices.resins()
        known = known if resin in known else {resin: resin, **known}
        start = {"ratio": f"{self.state.ratio:g}", "punch": self.state.punch, "pad": "150x120", "shape": "slab",
                 "base": "bonded", "contact": "bonded"}  # fmt: skip
        self.given: dict[str, Any] = {}
        with ui.element("div").classes("fields"):
            self.given["resin"] = ui.select({"": "unknown", **known}, value=resin, label="Resin of the pads")
            for key, label in FIELDS.items():
                self.given[key] = ui.input(label, value=start.get(key, "")).props(f'data-test="bring-{key}"')
        self.work = Work(self.studio, "fromfiles", "Make the campaign", self.words, self.done, self.belongs)
        for field in self.given.values():
            field.on_value_change(self.work.renew_line)

    def take(self, name: str, content: bytes) -> str:
        """Keep a file that was dropped."""
        return f"{bring_in.keep(self.root, name, content)} was added."

    def show(self) -> None:
        """Show what waits, and the way it goes in."""
        names = [name for name in bring_in.waiting(self.root) if name != bring_in.TABLE]
        as_it_is = bring_in.has_campaign_file(self.root)
        self.as_it_is.set_visibility(as_it_is)
        # what was made stays in sight once its files are gone
        self.by_table.set_visibility(not as_it_is)
        self.empty.set_visibility(bool(names))
        self.files.clear()
        with self.files:
            if names:
                html(f'<p data-test="waiting">{len(names)} files wait: {escape(", ".join(names[:8]))}'
                     f"{' …' if len(names) > 8 else ''}</p>")  # fmt: skip
        self.rows = [] if as_it_is else bring_in.table(self.root)
        self.table.clear()
        if self.rows:
            with self.table:
                value_table(bring_in.KEYS, self.rows, self.changed)
            self.write()
        self.renew()

    def changed(self, row: int, key: str, text: str) -> bool:
        """Take over a value of the table; return whether it was kept.

        Parameters
        ----------
        row : int
            Of the table.
        key : str
            Of the value.
        text : str
            As typed.
        """
        self.words_of_table.clear()
        file = self.rows[row]["file"]
        try:
            self.rows[row][key] = number_of(text, f"{file}: {HEADS[key]}")
            self.write()
        except InputError as problem:
            with self.words_of_table:
                tell_problem(f"Not kept: {problem}")
            return False
        return True

    def write(self) -> None:
        """Write the table for the command."""
        bring_in.write_table(self.root, self.rows)

    def renew(self) -> None:
        """Write the command anew."""
        self.problem.clear()
        self.work.renew_line()

    def words(self) -> list[str]:
        """The campaign as a command."""
        given = {key: field.value for key, field in self.given.items()}
        if given["young"]:
            given["resin"] = given["ratio"] = None
        return bring_in.words(self.root, self.name.value or "", options(given))

    def belongs(self, job: Job) -> bool:
        """Whether a job made the campaign that is named, and it is still there."""
        folder = str(job.answer.get("inputs", {}).get("folder", ""))
        same = job.words[2:3] == (f"campaigns/{(self.name.value or '').strip()}",)
        return same and (not folder or (self.root / folder).is_dir())

    def done(self, job: Job) -> None:
        """What was made."""
        answer = job.answer
        folder = str(answer.get("inputs", {}).get("folder", ""))
        if not folder:
            return
        warnings(answer)
        rows = [[str(one.get("what")), str(one.get("value")), str(one.get("why"))]
                for one in answer.get("decisions", [])]  # fmt: skip
        if rows:
            table(["file", "taken as", "because"], rows, words=True, under=f"how {len(rows)} files were read")
        on = state_link("/campaign", f"Go on with {folder}", self.state.changed(campaign=folder), "brought")
        html(f'<p class="note">{on}. The files that waited can be removed.</p>')

    def bring(self) -> None:
        """Make a campaign of the files as they are."""
        self.problem.clear()
        try:
            folder = bring_in.bring_in(self.root, self.name.value or "")
        except InputError as problem:
            with self.problem:
                tell_problem(str(problem))
            return
        open_page("/campaign", self.state.changed(campaign=folder))

    def remove(self) -> None:
        """Move the files that wait to the bin."""
        self.problem.clear()
        try:
            bin.delete(self.root, bring_in.FOLDER)
        except InputError as problem:
            with self.problem:
                tell_problem(str(problem))
            return
        self.clear()
        self.show()
