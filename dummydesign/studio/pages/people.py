"""Several people in one tissue: presses are assigned to people, each is fitted, and all make one tissue."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from nicegui import ui

from dummydesign.core.datafiles import entries
from dummydesign.core.errors import InputError
from dummydesign.studio import choices
from dummydesign.studio.chain import Chain, Steps
from dummydesign.studio.frame import html, table, tell_problem, warnings
from dummydesign.studio.pages.fits import show_curves
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.inputs import changed_inputs
from dummydesign.studio.work.jobs import Job

if TYPE_CHECKING:
    from dummydesign.studio.pages.tissue import TissuePage

OWN = ("people", "group")
"""Choices of this panel in the address."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
ELEMENTS = {"3": "3", "5": "5 (usual)", "7": "7"}


def people_panel(page: TissuePage) -> None:
    """Build it into the page, where the tissue is chosen once it is made."""
    with ui.expansion("Assign presses to people", value="people" in page.query).style("width:100%") as place:
        place.props('data-test="people"')
        _People(page).build()


class _People:
    def __init__(self, page: TissuePage) -> None:
        self._page, self._root = page, page.studio.root
        self._traces = choices.traces(self._root)
        self._start, self._start_name = self._read()

    def build(self) -> None:
        html("<p>Write the person's name beside each press. A press without a name is left out. "
             "Each person is fitted, then all make one tissue.</p>")  # fmt: skip
        for path in self._start.keys() - self._traces.keys():
            tell_problem(f"The press '{path}' is not there (any more). It is left out until you bring it back.")
        ui.button("Take the names from the file names", on_click=self._guess, color=None).props(
            'outline data-test="guess-people"'
        )
        self._fields: dict[str, ui.input] = {}
        with ui.element("div").classes("people"):
            for path, words in self._traces.items():
                field = ui.input(f"Person of {words}", value=self._start.get(path, "")).style("width:100%")
                self._fields[path] = field.props('dense data-test="person"')
                field.props["data-press"] = words
        with ui.element("div").classes("fields"):
            self._name = ui.input("Name of the tissue", value=self._start_name).props('data-test="people-name"')
            self._elements = ui.select(ELEMENTS, value="5", label="Elements of the law")
            self._lowpass = ui.input("Filter of the force, HZ[:ORDER[:PASSES]] (optional)")
            self._lowpass.props('data-test="people-lowpass"')
            self._replace = ui.checkbox("Replace my tissue of this name").props('data-test="people-replace"')
        self._chain = Chain(self._page.studio, "people", "Fit all and make the tissue", self._steps, self._show,
                            self._ended, self._check)  # fmt: skip
        for field in (*self._fields.values(), self._name, self._elements, self._lowpass, self._replace):
            field.on_value_change(self._renew)

    def _renew(self) -> None:
        people = "\n".join(f"{path}\t{name}" for path, name in self._assigned().items())
        self._page.keep(people=people, group=self._name.value or "")
        self._chain.renew()

    def _guess(self) -> None:
        """Fill in what stands before the first underscore, as ``tissues add`` reads single traces."""
        for path, field in self._fields.items():
            field.value = Path(path).stem.split("_")[0]

    def _assigned(self) -> dict[str, str]:
        return {path: name for path, field in self._fields.items() if (name := (field.value or "").strip())}

    def _steps(self) -> Steps:
        people: dict[str, list[str]] = {}
        for path, person in self._assigned().items():
            if not NAME.fullmatch(person):
                raise InputError(f"The name '{person}' is not allowed: use letters, digits, '-' and '_'.")
            people.setdefault(person, []).append(path)
        if len({person.lower() for person in people}) < len(people):
            raise InputError("Two people differ only in capital letters: give them different names.")
        if len(people) < 2:
            raise InputError("Assign presses to at least two people.")
        name = (self._name.value or "").strip()
        if not NAME.fullmatch(name):
            raise InputError(f"The tissue name '{name}' is not allowed: use letters, digits, '-' and '_'.")
        given = options({"elements": self._elements.value, "mode": "per-speed", "lowpass": self._lowpass.value})
        files = {person: f"tissue/{name}/{person}.toml" for person in people}
        fits = [["fit", *presses, *given, "--out", files[person], "--replace"] for person, presses in people.items()]
        replace = ["--replace"] if self._replace.value else []
        return [*fits, ["tissues", "add", name, *files.values(), *replace]]

    def _check(self) -> None:
        """Refuse a name that is taken before anything is fitted."""
        known = entries("materials/tissues").get((self._name.value or "").strip().lower())
        if known is not None and known.origin != "user":
            raise InputError(f"'{known.name}' is a tissue of the library: choose another name.")
        if known is not None and not self._replace.value:
            raise InputError(f"You have a tissue '{known.name}': choose another name, or tick Replace.")

    def _read(self) -> tuple[dict[str, str], str]:
        """People and name: of the address, of the chain that made the chosen tissue, or none."""
        query = self._page.query
        if query.get("people"):
            rows = (line.partition("\t") for line in query["people"].split("\n"))
            return {path: person for path, _, person in rows}, query.get("group", "")
        every = list(reversed(jobs.named(self._root, "people")))
        last = next((job for job in every if job.words[:3] == ("tissues", "add", self._page.tissue)), None)
        if last is None:
            return {}, _free_name()
        found: dict[str, str] = {}
        for file in (word for word in last.words if word.endswith(".toml")):
            fit = next((job for job in every if file in job.words and job.words[0] == "fit"), None)
            for path in fit.words if fit is not None else ():
                if path.endswith(".csv"):
                    found[path] = Path(file).stem
        return found, last.words[2]

    def _show(self, done: list[Job]) -> None:
        answer = done[-1].answer
        name, fits = answer["name"], done[:-1]
        if not jobs.is_last(self._root, done[-1], lambda job: " ".join(job.words[:3])):
            html(f'<p class="note">The tissue {escape(name)} was made anew since, from other presses.</p>')
            return
        if name not in choices.tissues(self._root):
            html(f'<p class="note">The tissue {escape(name)} is no longer in your library.</p>')
            return
        html(f"<p><b>{escape(name)}</b>: {len(fits)} people. It is in your own library, for all projects.</p>")
        self._page.use_button(name)
        rows = [[Path(job.answer["inputs"]["out"]).stem, len(job.answer["by_trace"]), job.answer["rmse_N"],
                 job.answer["noise_floor_N"]] for job in fits]  # fmt: skip
        table(["person", "presses", "residual N rms", "noise N"], rows)
        warnings(answer)
        for job in fits:
            self._show_fit(job)

    def _show_fit(self, job: Job) -> None:
        files = job.answer["files"]
        for path in changed_inputs(self._root, self._root / files.get("manifest", "")):
            tell_problem(f"{path} has changed since the fit. Fit all again.")
        person = Path(files["tissue"]).stem
        with ui.expansion(f"{person}: measured and fitted force").style("width:100%") as place:
            place.on_value_change(lambda event: self._open(place, job))

    def _open(self, place: ui.expansion, job: Job) -> None:
        place.clear()
        if place.value:
            with place, ui.element("div").style("width:100%"):
                show_curves(self._root, job.answer)

    def _ended(self, done: list[Job]) -> None:
        self._page.choose(done[-1].answer["name"])


def _free_name() -> str:
    """A name that no tissue of the library has."""
    known, number = entries("materials/tissues"), 1
    name = "people"
    while name in known:
        number += 1
        name = f"people-{number}"
    return name
