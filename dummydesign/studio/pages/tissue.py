"""The tissue: one of the library or of the project; its band, the project's choice, and fits to presses."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project, change_project
from dummydesign.studio import choices, parts
from dummydesign.studio.manage import manage, undo_bar
from dummydesign.studio.page_frame import Studio, keep_state, open_page
from dummydesign.studio.pages import people
from dummydesign.studio.parts import html
from dummydesign.studio.state import State, absolute, page_link


class TissuePage:
    """The page: which tissue is chosen, and what the fits below make."""

    def __init__(self, studio: Studio, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.studio, self.query = studio, query
        self._project, self._state = project, state
        self._own = {name: query[name] for name in (*people.FIT_STATE, *people.OWN) if name in query}
        html("<p>The tissue that the dummy imitates. Its band is the range of the subjects that were measured.</p>")
        self._chosen = ui.select({}, label="Tissue").props('data-test="tissue"').style("width:100%")
        undo_bar(studio)
        self._list()
        self._shown = parts.area()
        parts.button("Use it for this project", lambda: self.use(self.tissue), "use", main=True)
        self._problem = parts.area()
        self._renew()
        self._chosen.on_value_change(self._choose_shown)
        html("<h2>Fit a tissue to your own presses</h2>")
        if not choices.traces(studio.root):
            html(f'<p class="note">No presses yet: {page_link("/measured", "bring in files")} first.</p>')
            return
        people.fit_panel(self)
        html("<h2>Several people in one tissue</h2>")
        people.people_panel(self)

    @property
    def tissue(self) -> str:
        """The chosen tissue."""
        return self._state.tissue

    def _choose_shown(self) -> None:
        if self._chosen.value != self.tissue:
            self.choose(self._chosen.value)

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
                parts.tell_problem(f"'{tissue}' is not there. Choose another tissue, or bring its file back.")
            return
        after = self._state if tissue == self.tissue else self._state.changed(tissue=tissue, aim="average")
        aim = None if after.aim == "average" else after.aim
        change_project(self.studio.project or self._project, tissue=tissue, aim=aim)
        open_page("/design", after)

    def use_button(self, tissue: str) -> None:
        """A button that makes a fitted tissue the project's."""
        parts.button(f"Use {tissue} for this project", lambda: self.use(tissue), "use-fitted", main=True)

    def _list(self) -> None:
        known = choices.offered(choices.tissues(self.studio.root), self.tissue, f"{self.tissue} (missing)")
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

    parts.command_line(["tissues", "show", name])
    path = studio.root / name
    if name.endswith(".toml") and not path.is_file():
        parts.tell_problem(f"'{name}' is not there. Choose another tissue, or bring its file back.")
        return
    try:
        tissue = load_tissue(absolute(studio.root, name))
        plot = figures.steady(tissue, make_targets(tissue, "average", Sampling()))
    except InputError as problem:
        parts.tell_problem(str(problem))
        return
    count = len(tissue.subjects)
    subjects = f"{count} subject{'s' * (count != 1)}"
    html(f"<p><b>{escape(name)}</b>: {escape(tissue.title)}, {escape(subjects)}, law {escape(tissue.law)}</p>")
    html(f'<div class="plots">{plot.html()}</div>')
    report = f"{name.removesuffix('.toml')}-report.html"
    if name.endswith(".toml") and (studio.root / report).is_file():
        parts.file_links([("report of the fit", report)])
    rows = people.parameter_rows(tissue.to_dict()["bands"], lambda one: one["kind"])
    parts.table(["parameter", "mean", "lowest", "highest", "kind"], rows)
    for note in tissue.notes:
        html(f"<p>{escape(note)}</p>")
