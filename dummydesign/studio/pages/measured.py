"""Bring in files of the test machine: drop them, read them, answer what they leave open, look at what was read."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import takewhile
from pathlib import Path

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.project.status import TEXTS
from dummydesign.studio import jobs, trash, widgets
from dummydesign.studio.file_actions import DropList, manage, thing
from dummydesign.studio.file_transfer import plain_name
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.markup import filled
from dummydesign.studio.project_index import presses_text
from dummydesign.studio.state import SEPARATOR, State, page_link
from dummydesign.studio.widgets import html, keep_state

OPEN = {
    "columns": "columns, as time=NAME,displacement=NAME,force=NAME",
    "units": "units, as time=s,displacement=mm,force=N",
    "rate": "rate in Hz: samples a second, where the file has no time",
    "delay": "delay in s: by how much the force is later than the displacement",
    "separator": "separator: tab, semicolon, comma, bar, spaces",
    "decimal": "decimal sign: . or ,",
    "encoding": "encoding, such as utf-8 or cp932",
    "skip": "skip: lines to leave out at the start",
    "flip": "flip: displacement, force, both, or none",
    "tare": "tare, the reading at no force: auto, none, first, drift, slope or a number",
    "contact": "contact, the reading there: auto, none or a number",
    "split": "split: auto, or none for one press",
    "sheets": "sheets of a workbook, or not:NAME for all others",
}
COLUMNS = {
    "press": "file",
    "samples": "samples",
    "mm/s": "velocity_mm_s",
    "hold s": "hold_s",
    "depth mm": "depth_mm",
    "peak N": "peak_force_N",
    "steady N": "steady_force_N",
}


class MeasuredPage:
    """The page: which files are chosen, and what was read from them."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self._root, self._state = project.root, state
        self._folder = self._root / "measured"
        self._let_go: list[str] = []
        wanted, last = query.get("files"), jobs.latest(self._root, "import")
        chosen = wanted.split(SEPARATOR) if wanted else [Path(name).name for name in _sources(last)] if last else []
        for name in chosen:
            if wanted and name not in self._names():
                widgets.tell_problem(f"'{name}' is not in measured/ (any more). Choose another file, or bring it back.")
        DropList(self._root, self._take, self._list_files, test="measured")
        self._chosen = widgets.select_several("Files to read", {}, [], "files")
        self._all = widgets.button("Choose all files", lambda: self._choose(self._names()), "all-files")
        self._work = JobPanel(
            self._root,
            "import",
            "Read the files",
            self._words,
            self._show,
            self._belongs,
            lambda job: _out(job) if job.answer.get("files") else "",
            lambda job, mine: self._list_imports(),
            needs="files",
            warn=False,
        )
        with widgets.fold("Columns, units and signs (only where a reading asks for them)"):
            self._open = widgets.Form("open", lambda: {name: ui.input(text) for name, text in OPEN.items()})
        self._change = widgets.fold("Delete files", "change-files", self._list_files)
        self._choose(chosen)
        self._open.on_change(self._renew)
        widgets.on_change(self._renew, self._chosen)
        self._imports = widgets.area("imports")
        self._list_imports()
        link = page_link("/resin", "find its modulus", test="resin")
        html('<p class="note">A puck of resin was pressed: {}.</p>', link)

    def _take(self, name: str, content: bytes) -> trash.Taken:
        """Keep a file that was dropped and choose it."""
        if Path(name).suffix.lower() not in TEXTS:
            message = f"choose a file that ends in {', '.join(TEXTS)}"
            raise InputError(message, "unknown_name", "file_ending", name, TEXTS)
        if same := trash.twin(self._folder, name, content):
            taken = trash.Taken(same, f"{name} is the same as {same}, which is there: nothing was changed.")
        else:
            taken = trash.keep_file(self._root, self._folder, plain_name(name), content)
        self._add(taken.name)
        return taken

    def _names(self) -> list[str]:
        paths = self._folder.glob("[!.]*.*")
        return sorted(path.name for path in paths if path.suffix.lower() in TEXTS and path.is_file())

    def _choose(self, names: list[str]) -> None:
        there = self._names()
        self._chosen.set_options(there, value=[name for name in names if name in there])
        self._chosen.set_enabled(bool(there))
        self._all.set_visibility(bool(there) and not self._chosen.value)
        self._work.renew()

    def _add(self, name: str) -> None:
        """Choose a file that came in; one that is gone is let go."""
        self._choose([*(one for one in self._chosen.value if one != name), name])
        self._list_files()

    def _renew(self) -> None:
        keep_state(self._state, files=SEPARATOR.join(self._chosen.value or []))
        self._all.set_visibility(bool(self._chosen.options) and not self._chosen.value)
        self._work.renew()

    def _words(self) -> list[str]:
        if not self._chosen.value:
            raise InputError("Choose a file to read.", "missing", "file")
        names = self._chosen.value
        stem = names[0].rpartition(".")[0] if len(names) == 1 else "all"
        files = [f"measured/{name}" for name in names]
        return jobs.command("import", *files, **self._open.values(), out=f"measured/import-{stem}")

    def _belongs(self, job: jobs.Job, words: list[str]) -> bool:
        """Whether a job read the chosen files."""
        return set(_sources(job)) == {f"measured/{name}" for name in self._chosen.value or []}

    def _list_files(self) -> None:
        names = self._names() if self._change.value else []
        with widgets.fresh(self._change):
            for name in names:
                thing(filled("<span>{}</span>", name), self._root, f"measured/{name}", "file", self._moved)

    def _moved(self) -> None:
        """Follow files that were deleted or brought back: one that was chosen is chosen again."""
        chosen, there = [*self._chosen.value, *self._let_go], self._names()
        self._let_go = [name for name in chosen if name not in there]
        self._choose(chosen)
        self._renew()
        self._list_files()

    def _list_imports(self) -> None:
        folders = sorted(path for path in self._folder.glob("import-*") if path.is_dir())
        with widgets.fresh(self._imports):
            if folders:
                html("<h2>Presses that were read</h2>")
            for path in folders:
                widgets.fold(
                    f"{path.name}: {presses_text(list(path.glob('*.csv')))}", "import", partial(self._open_import, path)
                )

    def _open_import(self, path: Path) -> None:
        inner = f"measured/{path.name}"
        manage(self._root, inner, "import", self._list_imports)
        if (path / "preview.html").is_file():
            widgets.shown_file(f"/files/{inner}/preview.html", f"presses of {path.name}")

    def _show(self, job: jobs.Job) -> None:
        answer = job.answer
        files, doubts = answer["files"], len(answer.get("warnings", []))
        widgets.tell_changes(self._root, f"{_out(job)}/manifest.json", "Read the files again.")
        traces = [trace for one in files for trace in one["traces"]]
        names = ", ".join(Path(one["source"]).name for one in files)
        read = names if len(files) < 3 else f"{len(files)} files"
        with ui.element("div").classes("links"):
            widgets.go("/tissue", "Fit a tissue to these presses", test="to-tissue")
            html('<p title="{}"><b>{}</b> read from {}</p>', names, presses_text(traces), read)
        if doubts:
            widgets.fold(f"{doubts} doubt{'s' * (doubts > 1)}", "doubts", lambda: widgets.warnings(answer))
        with ui.element("div").classes("pair"):
            with ui.element("div"):
                widgets.records(COLUMNS, traces)
            if answer.get("preview") and (self._root / answer["preview"]).is_file():
                widgets.shown_file(f"/files/{answer['preview']}", "preview of the presses")
        rows = [
            [Path(one["source"]).name, made["what"], str(made["value"]), made["why"]]
            for one in files
            for made in one["decisions"]
        ]
        widgets.table(
            ["file", "decided", "value", "because"],
            rows,
            words=True,
            under=f"how {len(rows)} things were decided, and why",
        )


def _sources(job: jobs.Job) -> list[str]:
    """Files that an import read."""
    return list(takewhile(lambda word: not word.startswith("--"), job.words[1:]))


def _out(job: jobs.Job) -> str:
    """Folder that an import wrote; it has a number where the requested one was taken."""
    return Path(job.answer.get("preview") or "measured/none/preview.html").parent.as_posix()
