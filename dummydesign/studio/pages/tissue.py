"""The tissue: one of the library or of the project; its band, the project's choice, and fits to presses."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project, change_project
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    command_line,
    file_links,
    html,
    keep_state,
    lay_out,
    open_page,
    page_link,
    table,
    tell_problem,
)  # fmt: skip
from dummydesign.studio.manage import manage, undo_bar
from dummydesign.studio.pages import fits, people
from dummydesign.studio.state import State, absolute


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/tissue", "Tissue", query,
            lambda project, state: TissuePage(studio, project, state, query).build())  # fmt: skip


class TissuePage:
    """The page: which tissue is chosen, and what the fits below make.

    Attributes
    ----------
    studio : Studio
    query : mapping
        Of the address that was opened.
    """

    def __init__(self, studio: Studio, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.studio, self.query = studio, query
        self._project, self._state = project, state
        self._own: dict[str, str] = {name: query[name] for name in (*fits.OWN, *people.OWN) if name in query}

    @property
    def tissue(self) -> str:
        """The chosen tissue."""
        return self._state.tissue

    def build(self) -> None:
        """Build it."""
        html("<p>The tissue that the dummy imitates. Its band is the range of the subjects that were measured.</p>")
        self._chosen = ui.select({}, label="Tissue").props('data-test="tissue"').style("width:100%")
        undo_bar(self.studio)
        self._list()
        self._shown = ui.element("div").style("width:100%")
        ui.button("Use it for this project", on_click=lambda: self.use(self.tissue)).props('data-test="use"')
        self._problem = ui.element("div")
        self._renew()
        self._chosen.on_value_change(lambda: self._chosen.value != self.tissue and self.choose(self._chosen.value))
        html("<h2>Fit a tissue to your own presses</h2>")
        if not choices.traces(self.studio.root):
            html(f'<p class="note">No presses yet: {page_link("/measured", "bring in files")} first.</p>')
            return
        fits.fit_panel(self)
        html("<h2>Several people in one tissue</h2>")
        people.people_panel(self)

    def choose(self, tissue: str) -> None:
        """Choose a tissue: it is shown, and the address keeps it."""
        was_missing = self._state.missing
        self._state = self._state.changed(tissue=tissue, aim="average")
        if was_missing:
            # what the page says at its top is no longer true
            open_page("/tissue", self._state)
            return
        self._list()
        self._renew()
        self.keep()

    def keep(self, **own: str) -> None:
        """Keep what is chosen in the address; choices of this page alone by name."""
        self._own |= own
        keep_state(self._state, **self._own)

    def use(self, tissue: str) -> None:
        """Make a tissue the project's, and go on to the design."""
        self._problem.clear()
        if tissue not in choices.tissues(self.studio.root):
            with self._problem:
                tell_problem(f"'{tissue}' is not there. Choose another tissue, or bring its file back.")
            return
        after = self._state if tissue == self.tissue else self._state.changed(tissue=tissue, aim="average")
        aim = None if after.aim == "average" else after.aim
        change_project(self.studio.project or self._project, tissue=tissue, aim=aim)
        open_page("/design", after)

    def use_button(self, tissue: str) -> None:
        """A button that makes a fitted tissue the project's."""
        words = f"Use {tissue} for this project"
        ui.button(words, on_click=lambda: self.use(tissue)).props('data-test="use-fitted"')

    def _list(self) -> None:
        known = choices.tissues(self.studio.root)
        known = known if self.tissue in known else {self.tissue: f"{self.tissue} (missing)", **known}
        self._chosen.set_options(known, value=self.tissue)

    def _renew(self) -> None:
        self._shown.clear()
        self._problem.clear()
        with self._shown:
            if self.tissue.startswith("tissue/") and (self.studio.root / self.tissue).is_file():
                manage(self.studio, self.tissue, "tissue", self._moved)
            _show_tissue(self.studio, self.tissue)

    def _moved(self, old: str, new: str) -> None:
        """Follow a tissue that was renamed or brought back; one that was deleted stays chosen and is missing."""
        if new and old == self.tissue:
            self._state = self._state.changed(tissue=new)
        self._list()
        self._renew()
        self.keep()


def _show_tissue(studio: Studio, name: str) -> None:
    from dummydesign.design.scoring.presses import Sampling
    from dummydesign.design.scoring.targets import make_targets
    from dummydesign.studio import figures
    from dummydesign.tissue import load_tissue

    command_line(["tissues", "show", name])
    path = studio.root / name
    if name.endswith(".toml") and not path.is_file():
        tell_problem(f"'{name}' is not there. Choose another tissue, or bring its file back.")
        return
    try:
        tissue = load_tissue(absolute(studio.root, name))
        plot = figures.steady(tissue, make_targets(tissue, "average", Sampling()))
    except InputError as problem:
        tell_problem(str(problem))
        return
    people = f"{len(tissue.subjects)} subject{'s' * (len(tissue.subjects) != 1)}"
    html(f"<p><b>{escape(name)}</b>: {escape(tissue.title)}, {people}, law {escape(tissue.law)}</p>")
    html(f'<div class="plots">{plot.html()}</div>')
    report = f"{name.removesuffix('.toml')}-report.html"
    if name.endswith(".toml") and (studio.root / report).is_file():
        file_links([("report of the fit", report)])
    rows = []
    for label, entry in tissue.to_dict()["bands"].items():
        parts = {label: entry} if "value" in entry else {f"{label} at {v} mm/s": one for v, one in entry.items()}
        rows += [[key, one["value"], one["low"], one["high"], one["kind"]] for key, one in parts.items()]
    table(["parameter", "mean", "lowest", "highest", "kind"], rows)
    for note in tissue.notes:
        html(f"<p>{escape(note)}</p>")
