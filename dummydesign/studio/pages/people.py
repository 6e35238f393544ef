"""Several people in one tissue: fits of one subject, presses assigned to people."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import choices, jobs, parts
from dummydesign.studio import file_transfer as files
from dummydesign.studio.jobs import Job, options
from dummydesign.studio.parts import html
from dummydesign.studio.work_panel import Chain, Steps, Work

if TYPE_CHECKING:
    from dummydesign.studio.pages.tissue import TissuePage


FIT_STATE = ("presses", "name", "touched")
"""Choices of this panel in the address."""
SEPARATOR = "\n"
CONTACT = {"": "as the files were read", "per-press": "fitted for each press"}


def fit_panel(page: TissuePage) -> None:
    """Fields, command and result of a fit."""
    root = page.studio.root
    known = choices.traces(root)
    start, start_name, touched = _start(page, known)
    missing = [path for path in start if path not in known]
    for path in missing:
        parts.tell_problem(f"The press '{path}' is not there (any more). Choose others, or bring it back.")
    picked = parts.select_several("Presses of one subject", known, [path for path in start if path in known], "traces")
    picked.set_enabled(bool(known))
    with ui.element("div").classes("fields"):
        name = ui.input("Name of the tissue", value=start_name).props('data-test="fit-name"')
        contact = parts.select("Where each press touched", CONTACT, touched, "fit-contact")
        lowpass = ui.input("Filter of the force, HZ[:ORDER[:PASSES]] (optional)")

    def words() -> list[str]:
        if not picked.value:
            raise InputError("Choose the presses to fit.", "missing", "trace")
        given = {"contact": contact.value, "lowpass": lowpass.value}
        kept = files.plain_name(f"{(name.value or '').strip() or 'mine'}.toml")
        return ["fit", *picked.value, *options(given), "--out", f"tissue/{kept}"]

    def belongs(job: Job, chosen: list[str]) -> bool:
        """Whether a fit is of the chosen presses and name, and its tissue is still there."""
        if set(_presses(job.words)) != set(_presses(chosen)) or [job.words[-1]] != chosen[-1:]:
            return False
        tissue = _tissue_of(job)
        return not tissue or ((root / tissue).is_file() and jobs.is_last(root, job, _tissue_of))

    def ended(job: Job, mine: bool) -> None:
        """Choose what was fitted, when it answers what is chosen."""
        if mine and _tissue_of(job):
            page.choose(_tissue_of(job))

    work = Work(page.studio, "fit", "Fit the tissue", words, lambda job: _show(page, job), belongs, ended)

    def renew() -> None:
        page.keep(presses=SEPARATOR.join(picked.value or []), name=name.value or "", touched=contact.value)
        work.renew()

    parts.on_change(renew, picked, name, contact, lowpass)


def _start(page: TissuePage, known: dict[str, str]) -> tuple[list[str], str, str]:
    """Presses, name and contact: of the address, of the fit that made the tissue, or all presses and a free name."""
    root, query = page.studio.root, page.query
    if query.get("presses"):
        touched = query.get("touched", "")
        return query["presses"].split(SEPARATOR), query.get("name", ""), touched if touched in CONTACT else ""
    for job in reversed(jobs.all_jobs(root, "fit")):
        if _tissue_of(job) == page.tissue:
            return _presses(job.words), Path(job.words[-1]).stem, "per-press" if "per-press" in job.words else ""
    return list(known), query.get("name") or choices.free_name(root, "tissue", "mine"), ""


def _tissue_of(job: Job) -> str:
    return str(job.answer.get("files", {}).get("tissue") or "")


def _presses(words: Sequence[str]) -> list[str]:
    return [word for word in words if word.endswith(".csv")]


def _show(page: TissuePage, job: Job) -> None:
    answer, root, tissue = job.answer, page.studio.root, _tissue_of(job)
    if "parameters" not in answer:
        return
    parts.tell_changes(root, answer["files"].get("manifest", ""), "Fit the tissue again.")
    html(
        f"<p><b>{escape(tissue)}</b>: {escape(str(answer['elements']))} elements, {escape(answer['mode'])}. Residual "
        f"{answer['rmse_N']:.3g} N rms, noise {answer['noise_floor_N']:.3g} N.</p>"
    )
    page.use_button(tissue)
    parts.warnings(answer)
    show_curves(root, answer)
    rows = parameter_rows(answer["parameters"], lambda one: "at bound" if one["at_bound"] else "")
    parts.table(["parameter", "value", "95 % low", "95 % high", ""], rows)


def show_curves(root: Path, answer: Mapping[str, Any]) -> None:
    """Measured force with the fitted curve over it, and the report."""
    from dummydesign.studio import figures

    # several fits on a page have presses of the same name
    own = Path(answer["files"]["tissue"]).with_suffix("").as_posix().replace("/", "-")
    plots = figures.measured_over_fitted(root, answer)
    html(figures.plots_html(replace(one, name=f"{own}-{one.name}") for one in plots))
    report = answer["files"].get("report", "")
    if report and (root / report).is_file():
        parts.file_links([("report of the fit, with its residuals", report)])


def parameter_rows(
    parameters: Mapping[str, Any], note_of: Callable[[Mapping[str, Any]], object]
) -> list[list[object]]:
    """Rows of a table of a tissue's parameters with a note each, dampers by speed."""
    rows = []
    for label, entry in parameters.items():
        by_label = {label: entry} if "value" in entry else {f"{label} at {v} mm/s": one for v, one in entry.items()}
        rows += [[key, one["value"], one["low"], one["high"], note_of(one)] for key, one in by_label.items()]
    return rows


OWN = ("people", "group")
"""Choices of this panel in the address."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
ELEMENTS = {"3": "3", "5": "5 (usual)", "7": "7"}


def people_panel(page: TissuePage) -> None:
    """Build it into the page, where the tissue is chosen once it is made."""
    with ui.expansion("Assign presses to people", value="people" in page.query).style("width:100%") as panel:
        panel.props('data-test="people"')
        _People(page)


class _People:
    def __init__(self, page: TissuePage) -> None:
        self._page, self._root = page, page.studio.root
        traces = choices.traces(self._root)
        start, start_name = self._read()
        html("<p>Write the person's name beside each press. A press without a name is left out. "
             "Each person is fitted, then all make one tissue.</p>")  # fmt: skip
        for path in start.keys() - traces.keys():
            parts.tell_problem(f"The press '{path}' is not there (any more). It is left out until you bring it back.")
        parts.button("Take the names from the file names", self._guess, "guess-people")
        self._fields: dict[str, ui.input] = {}
        with ui.element("div").classes("people"):
            for path, words in traces.items():
                name = ui.input(f"Person of {words}", value=start.get(path, "")).style("width:100%")
                self._fields[path] = name.props('dense data-test="person"')
                name.props["data-press"] = words
        with ui.element("div").classes("fields"):
            self._name = ui.input("Name of the tissue", value=start_name).props('data-test="people-name"')
            self._elements = parts.select("Elements of the law", ELEMENTS, "5")
            self._lowpass = ui.input("Filter of the force, HZ[:ORDER[:PASSES]] (optional)")
            self._lowpass.props('data-test="people-lowpass"')
            self._replace = ui.checkbox("Replace my tissue of this name").props('data-test="people-replace"')
        self._chain = Chain(self._page.studio, "people", "Fit all and make the tissue", self._steps, self._show,
                            self._ended, self._check)  # fmt: skip
        parts.on_change(self._renew, *self._fields.values(), self._name, self._elements, self._lowpass, self._replace)

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
                message = f"The name '{person}' is not allowed: use letters, digits, '-' and '_'."
                raise InputError(message, "bad_name", "person", person)
            people.setdefault(person, []).append(path)
        if len({person.lower() for person in people}) < len(people):
            message = "Two people differ only in capital letters: give them different names."
            raise InputError(message, "duplicate", "person")
        if len(people) < 2:
            raise InputError("Assign presses to at least two people.", "not_enough_data", "person")
        name = (self._name.value or "").strip()
        if not NAME.fullmatch(name):
            message = f"The tissue name '{name}' is not allowed: use letters, digits, '-' and '_'."
            raise InputError(message, "bad_name", "tissue", name)
        given = options({"elements": self._elements.value, "mode": "per-speed", "lowpass": self._lowpass.value})
        files = {person: f"tissue/{name}/{person}.toml" for person in people}
        fits = [["fit", *presses, *given, "--out", files[person], "--replace"] for person, presses in people.items()]
        replace = ["--replace"] if self._replace.value else []
        return [*fits, ["tissues", "add", name, *files.values(), *replace]]

    def _check(self) -> None:
        """Refuse a name that is taken before anything is fitted."""
        choices.check_name("tissue", self._name.value or "", bool(self._replace.value))

    def _read(self) -> tuple[dict[str, str], str]:
        """People and name: of the address, of the chain that made the chosen tissue, or none."""
        query = self._page.query
        if query.get("people"):
            rows = (line.partition("\t") for line in query["people"].split("\n"))
            return {path: person for path, _, person in rows}, query.get("group", "")
        every = list(reversed(jobs.all_jobs(self._root, "people")))
        last = next((job for job in every if job.words[:3] == ("tissues", "add", self._page.tissue)), None)
        if last is None:
            return {}, choices.free_library_name("tissue", "people")
        persons: dict[str, str] = {}
        for file in (word for word in last.words if word.endswith(".toml")):
            fit = next((job for job in every if file in job.words and job.words[0] == "fit"), None)
            persons |= dict.fromkeys(_presses(fit.words) if fit is not None else (), Path(file).stem)
        return persons, last.words[2]

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
        parts.table(["person", "presses", "residual N rms", "noise N"], rows)
        parts.warnings(answer)
        for job in fits:
            self._show_fit(job)

    def _show_fit(self, job: Job) -> None:
        parts.tell_changes(self._root, job.answer["files"].get("manifest", ""), "Fit all again.")
        person = Path(_tissue_of(job)).stem
        with ui.expansion(f"{person}: measured and fitted force").style("width:100%") as panel:
            panel.on_value_change(lambda event: self._open(panel, job))

    def _open(self, panel: ui.expansion, job: Job) -> None:
        panel.clear()
        if panel.value:
            with panel, parts.area():
                show_curves(self._root, job.answer)

    def _ended(self, done: list[Job]) -> None:
        self._page.choose(done[-1].answer["name"])
