"""The tissue: one of the library or of the project; its band, the project's choice, and fits to presses."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import parameter_rows
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.project.folder import Project, project_of
from dummydesign.report.plot import plots_html
from dummydesign.studio import figures, file_transfer, jobs, project_index, select_options, widgets
from dummydesign.studio.file_actions import manage
from dummydesign.studio.job_panel import JobPanel, Steps
from dummydesign.studio.markup import Markup, joined
from dummydesign.studio.state import SEPARATOR, State, absolute, options_of, page_link
from dummydesign.studio.trash import choose_for_project
from dummydesign.studio.widgets import html, keep_state, open_page
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.maxwell_law import arm_names, parameter_words


class TissuePage:
    """The page: which tissue is chosen, and what the fits below make."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.root, self.state, self.query = project.root, state, query
        self._project = project
        with widgets.fields():
            self._chosen = widgets.select("Tissue that the dummy imitates", {}, "", "tissue")
            with ui.element("div"):
                widgets.button("Design a pad for it", lambda: self.use(self.state.tissue), "use", main=True)
        fits = widgets.area()
        self._shown = widgets.area("tissue-shown")
        if self.state.tissue.startswith("tissue/"):
            fits = widgets.area()
        self._renew()
        # by the user alone: what is fitted chooses itself
        self._chosen.on("update:model-value", lambda: self.choose(self._chosen.value))
        if not select_options.traces(self.root):
            html('<p class="note">Your own tissue: {} of presses first.</p>', page_link("/measured", "bring in files"))
            return
        # who has presses and no tissue of their own came to fit one
        with fits, widgets.fold("Fit a tissue to your own presses", "fit", opened=True):
            fit_panel(self)
        with widgets.fold("Several people in one tissue: assign presses to them", "people", opened="people" in query):
            _People(self)

    def choose(self, tissue: str) -> None:
        """Choose a tissue: it is shown, and the address keeps it."""
        self.state = self.state.changed(tissue=tissue, aim="average")
        if self.state.missing:
            # what the page says at its top is no longer true
            open_page("/tissue", self.state)
        else:
            self._renew()
            keep_state(self.state)

    def use(self, tissue: str) -> None:
        """Make a tissue the project's, and go on to the design."""
        after = self.state if tissue == self.state.tissue else self.state.changed(tissue=tissue, aim="average")
        if tissue not in select_options.tissues(self.root) and not (self.root / tissue).is_file():
            # the page says at its top that there is none, or that it is gone
            open_page("/tissue", after)
            return
        choose_for_project(
            project_of(self.root) or self._project, tissue=tissue, aim=None if after.aim == "average" else after.aim
        )
        open_page("/design", after)

    def use_button(self, tissue: str) -> None:
        """A button that makes a fitted tissue the project's."""
        widgets.button(f"Use {tissue} for this project", lambda: self.use(tissue), "use-fitted")

    def _renew(self) -> None:
        widgets.offer(self._chosen, select_options.tissues(self.root), self.state.tissue)
        with widgets.problems_in(self._shown), self._shown:
            if self.state.tissue.startswith("tissue/") and (self.root / self.state.tissue).is_file():
                manage(self.root, self.state.tissue, "tissue")
            _show_tissue(self.root, self.state.tissue)


def _show_tissue(root: Path, name: str) -> None:
    if not name or (name.endswith(".toml") and not (root / name).is_file()):
        return  # said at the top of the page
    tissue = load_tissue(absolute(root, name))
    targets = make_targets(tissue, "average", Sampling())
    plot = figures.steady(targets)
    subjects, deep = f"{len(tissue.subjects)} subject{'s' * (len(tissue.subjects) != 1)}", figures.depth_text(targets)
    with ui.element("div").classes("pair"):
        html("{}", Markup(plot.html()))
        with ui.element("div"):
            html("<p><b>{}</b>: {}, {}. {}</p>", name, tissue.title, subjects, deep)
            parameter_table(("mean", "lowest", "highest", "kind"), tissue.to_dict()["bands"], lambda one: one["kind"])
            widgets.command_line(["tissues", "show", name])
    report = f"{name.removesuffix('.toml')}-report/report.html"
    if name.endswith(".toml") and (root / report).is_file():
        widgets.file_links([("report of the fit", report)])
    html("{}", joined('<p class="source">{}</p>', ([note] for note in tissue.notes)))


LOWPASS = "Filter of the force, HZ[:ORDER[:PASSES]] (optional)"
POOR = 10.0
"""Residual over noise from which a fit is called poor."""
CONTACT = {"": "as the files were read", "per-press": "fitted for each press"}


def fit_panel(page: TissuePage) -> None:
    """Fields, command and result of a fit."""
    root = page.root
    known = select_options.traces(root)
    start, start_name, touched = _start(page, known)
    for path in start:
        if path not in known:
            widgets.tell_problem(f"The press '{path}' is not there (any more). Choose others, or bring it back.")
    picked = widgets.select_several(
        "Presses of one subject", known, [path for path in start if path in known], "traces"
    )
    form = widgets.Form(
        "fit",
        lambda: {
            "name": ui.input("Name of the tissue", value=start_name),
            "contact": widgets.select("Where each press touched", CONTACT, touched),
            "lowpass": ui.input(LOWPASS),
        },
    )

    def words() -> list[str]:
        if not picked.value:
            raise InputError("Choose the presses to fit.", "missing", "trace")
        given = form.values()
        kept = file_transfer.plain_name(f"{(given.pop('name') or '').strip() or 'mine'}.toml")
        return jobs.command("fit", *picked.value, **given, out=f"tissue/{kept}")

    def belongs(job: jobs.Job, chosen: list[str]) -> bool:
        """Whether a fit is of the chosen presses and name."""
        return set(_presses(job.words)) == set(_presses(chosen)) and [job.words[-1]] == chosen[-1:]

    def ended(job: jobs.Job, mine: bool) -> None:
        """Choose what was fitted, when it answers what is chosen."""
        if mine and _tissue_of(job):
            page.choose(_tissue_of(job))

    work = JobPanel(
        root,
        "fit",
        "Fit the tissue",
        words,
        lambda job: _show(page, job),
        belongs,
        _tissue_of,
        ended,
        needs="parameters",
        main=False,
    )

    def renew() -> None:
        typed = form.kept()
        pressed = SEPARATOR.join(picked.value or [])
        keep_state(page.state, presses=pressed, name=typed["name"], touched=typed["contact"])
        work.renew()

    widgets.on_change(renew, picked, *form.fields.values())


def _start(page: TissuePage, known: dict[str, str]) -> tuple[list[str], str, str]:
    """Presses, name and contact: of the address, of the fit that made the tissue, or all presses and a free name."""
    root, query = page.root, page.query
    if query.get("presses"):
        touched = query.get("touched", "")
        return query["presses"].split(SEPARATOR), query.get("name", ""), touched if touched in CONTACT else ""
    for job in reversed(jobs.all_jobs(root, "fit")):
        if _tissue_of(job) == page.state.tissue:
            return _presses(job.words), Path(job.words[-1]).stem, "per-press" if "per-press" in job.words else ""
    # presses of several people are not those of one subject: which are is for the user to say
    people = {Path(path).stem.split("_")[0] for path in known}
    return (
        list(known) if len(people) == 1 else [],
        query.get("name") or select_options.free_name(root, "tissue", "mine"),
        "",
    )


def _tissue_of(job: jobs.Job) -> str:
    return str(job.answer.get("files", {}).get("tissue") or "")


def _presses(words: Sequence[str]) -> list[str]:
    return [word for word in words if word.endswith(".csv")]


def _show(page: TissuePage, job: jobs.Job) -> None:
    answer, root, tissue = job.answer, page.root, _tissue_of(job)
    widgets.tell_changes(root, answer["files"].get("manifest", ""), "Fit the tissue again.")
    html(
        "<p><b>{}</b>: {} elements, {}. Residual {:.3g} N rms, noise {:.3g} N.</p>",
        tissue,
        answer["elements"],
        answer["mode"],
        answer["rmse_N"],
        answer["noise_floor_N"],
    )
    if answer["rmse_N"] > POOR * answer["noise_floor_N"]:
        times = answer["rmse_N"] / answer["noise_floor_N"]
        widgets.tell_problem(
            f"The residual is {times:.0f} times the noise: one law does not fit these presses. "
            "Check whose they are, and fit each person alone."
        )
    page.use_button(tissue)
    show_curves(root, answer)
    parameter_table(
        ("value", "95 % low", "95 % high", ""), answer["parameters"], lambda one: "at bound" if one["at_bound"] else ""
    )


def show_curves(root: Path, answer: Mapping[str, Any]) -> None:
    """Measured force with the fitted curve over it, and the report."""

    # several fits on a page have presses of the same name
    own = Path(answer["files"]["tissue"]).with_suffix("").as_posix().replace("/", "-")
    plots = figures.measured_presses(root / answer["files"].get("report_values", ""))
    html("{}", Markup(plots_html(replace(one, name=f"{own}-{one.name}") for one in plots)))
    report = answer["files"].get("report", "")
    if report and (root / report).is_file():
        widgets.file_links([("report of the fit, with its residuals", report)])


def parameter_table(
    head: Sequence[str], parameters: Mapping[str, Any], note_of: Callable[[Mapping[str, Any]], object]
) -> None:
    """Show a tissue's parameters in words, with a note each where they differ; their symbols under the pointer."""
    listed, arms = parameter_rows(parameters), arm_names(parameters)
    rows = []
    for label, one in listed:
        name, at, speed = label.partition(" at ")
        words, unit = parameter_words(name, arms) or project_index.name_and_unit(name)
        rows.append([f"{words}{at}{speed}", unit, one["value"], one["low"], one["high"], str(note_of(one))])
    exact, notes = all(one["low"] == one["value"] == one["high"] for _, one in listed), {row[-1] for row in rows}
    heads = ["parameter", "", "value" if exact else head[0], *head[1:]]
    kept = [0, 1, 2, *[3, 4] * (not exact), *[5] * (len(notes) > 1)]
    shown = [[row[column] for column in kept] for row in rows]
    widgets.table([heads[column] for column in kept], shown, symbols=[label for label, _ in listed])
    if len(notes) == 1 and notes != {""}:
        html("<p class=source>All values: {}.</p>", *notes)


NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
NOT_ALLOWED = "is not allowed: use letters, digits, '-' and '_'."
ELEMENTS = {"3": "3", "5": "5 (usual)", "7": "7"}
FITS: dict[str, str | Callable[[Any], object]] = {
    "person": lambda fit: Path(fit["inputs"]["out"]).stem,
    "presses": lambda fit: len(fit["by_trace"]),
    "residual N rms": "rmse_N",
    "noise N": "noise_floor_N",
}


class _People:
    def __init__(self, page: TissuePage) -> None:
        self._page, self._root = page, page.root
        traces = select_options.traces(page.root)
        start, start_name = self._read()
        html(
            "<p>Write the person's name beside each press. A press without a name is left out. "
            "Each person is fitted, then all make one tissue.</p>"
        )
        for path in start.keys() - traces.keys():
            widgets.tell_problem(f"The press '{path}' is not there (any more). It is left out until you bring it back.")
        widgets.button("Take the names from the file names", self._guess, "guess-people")
        self._persons = widgets.Form(
            "person",
            lambda: {
                path: widgets.having(ui.input(f"Person of {words}"), data_test="person", data_press=words)
                for path, words in traces.items()
            },
            start,
        )
        self._form = widgets.Form(
            "people",
            lambda: {
                "name": ui.input("Name of the tissue", value=start_name),
                "elements": widgets.select("Elements of the law", ELEMENTS, "5"),
                "lowpass": ui.input(LOWPASS),
                "replace": ui.checkbox("Replace my tissue of this name"),
            },
        )
        self._work = JobPanel(
            page.root,
            "people",
            "Fit all and make the tissue",
            self._words,
            self._show,
            ended=self._ended,
            needs="name",
            first=self._fits,
            check=self._check,
            main=False,
        )
        widgets.on_change(self._renew, *self._persons.fields.values(), *self._form.fields.values())

    def _renew(self) -> None:
        people = SEPARATOR.join(f"{path}\t{name}" for path, name in self._assigned().items())
        keep_state(self._page.state, people=people, group=self._form.values()["name"] or "")
        self._work.renew()

    def _guess(self) -> None:
        """Fill in what stands before the first underscore, as ``tissues add`` reads single traces."""
        for path, field in self._persons.fields.items():
            field.value = Path(path).stem.split("_")[0]

    def _assigned(self) -> dict[str, str]:
        return {path: name.strip() for path, name in self._persons.kept().items() if name.strip()}

    def _people(self) -> dict[str, list[str]]:
        """Presses of each person."""
        people: dict[str, list[str]] = {}
        for path, person in self._assigned().items():
            if not NAME.fullmatch(person):
                raise InputError(f"The name '{person}' {NOT_ALLOWED}", "bad_name", "person", person)
            people.setdefault(person, []).append(path)
        if len({person.lower() for person in people}) < len(people):
            message = "Two people differ only in capital letters: give them different names."
            raise InputError(message, "duplicate", "person")
        if len(people) < 2:
            raise InputError("Assign presses to at least two people.", "not_enough_data", "person")
        return people

    def _tissue(self) -> str:
        name = (self._form.values()["name"] or "").strip()
        if not NAME.fullmatch(name):
            raise InputError(f"The tissue name '{name}' {NOT_ALLOWED}", "bad_name", "tissue", name)
        return str(name)

    def _fits(self) -> Steps:
        people, name = self._people(), self._tissue()
        typed = self._form.values()
        law = {"elements": typed["elements"], "mode": "per-speed", "lowpass": typed["lowpass"]}
        return [
            jobs.command("fit", *presses, **law, out=f"tissue/{name}/{person}.toml", replace=True)
            for person, presses in people.items()
        ]

    def _words(self) -> list[str]:
        name, fits = self._tissue(), [f"tissue/{self._tissue()}/{person}.toml" for person in self._people()]
        return jobs.command("tissues", "add", name, *fits, replace=self._form.values()["replace"])

    def _check(self) -> None:
        """Refuse a name that is taken before anything is fitted."""
        given = self._form.values()
        select_options.check_name("tissue", given["name"] or "", bool(given["replace"]))

    def _read(self) -> tuple[dict[str, str], str]:
        """People and name: of the address, of the chain that made the chosen tissue, or none."""
        query = self._page.query
        if query.get("people"):
            rows = (line.partition("\t") for line in query["people"].split(SEPARATOR))
            return {path: person for path, _, person in rows}, query.get("group", "")
        last = next(
            (
                job
                for job in reversed(jobs.all_jobs(self._root, "people"))
                if job.words[:3] == ("tissues", "add", self._page.state.tissue)
            ),
            None,
        )
        if last is None:
            return {}, select_options.free_library_name("tissue", "people")
        fits = {Path(options_of(fit)["out"]).stem: _presses(fit) for fit in last.commands[:-1]}
        return {path: person for person, presses in fits.items() for path in presses}, last.words[2]

    def _show(self, job: jobs.Job) -> None:
        name = job.answer["name"]
        fits = [job.answer_of(number) for number in range(1, len(job.commands))]
        if not jobs.is_last(self._root, job, lambda one: str(one.answer.get("name") or "")):
            html('<p class="note">The tissue {} was made anew since, from other presses.</p>', name)
            return
        if name not in select_options.tissues(self._root):
            html('<p class="note">The tissue {} is no longer in your library.</p>', name)
            return
        html("<p><b>{}</b>: {} people. It is in your own library, for all projects.</p>", name, len(fits))
        self._page.use_button(name)
        widgets.records(FITS, fits)
        for fit in fits:
            widgets.tell_changes(self._root, fit["files"].get("manifest", ""), "Fit all again.")
            widgets.fold(
                f"{Path(fit['files']['tissue']).stem}: measured and fitted force",
                fill=partial(show_curves, self._root, fit),
            )

    def _ended(self, job: jobs.Job, mine: bool) -> None:
        if mine and job.state == "done":
            self._page.choose(job.answer["name"])
