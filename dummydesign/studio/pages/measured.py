"""Bring in files of the test machine: drop them, read them, answer what they leave open, look at what was read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import FILE
from dummydesign.project.status import TEXTS
from dummydesign.studio import uploads
from dummydesign.studio.frame import (
    Studio,
    Work,
    html,
    keep_state,
    lay_out,
    page_link,
    shown_file,
    table,
    tell_problem,
    warnings,
)  # fmt: skip
from dummydesign.studio.manage import drop_zone, manage, undo_bar
from dummydesign.studio.server import files, guard
from dummydesign.studio.state import State
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.inputs import changed_inputs
from dummydesign.studio.work.jobs import Job

OPEN = {
    "columns": "columns, as time=NAME,displacement=NAME,force=NAME",
    "units": "units, as time=s,displacement=mm,force=N",
    "separator": "separator: tab, semicolon, comma, bar, spaces", "decimal": "decimal sign: . or ,",
    "skip": "lines to leave out at the start", "flip": "turn round: displacement, force, both, or none",
    "tare": "reading at no force: auto, none or a number", "contact": "reading at contact: auto, none or a number",
    "split": "parts: auto, or none for one press",
}  # fmt: skip
SEPARATOR = "\n"
"""Between names in the address; no file name has one."""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/measured", "Measured files", query,
            lambda project, state: _Measured(studio, state, query.get("files")).build())  # fmt: skip


class _Measured:
    """The page: which files are chosen, and what was read from them."""

    def __init__(self, studio: Studio, state: State, asked: str | None) -> None:
        self._studio, self._state, self._folder = studio, state, studio.root / "measured"
        self._asked = asked.split(SEPARATOR) if asked else _last_read(studio.root)
        self._missing = [name for name in self._asked if asked and name not in self._names()]
        self._let_go: set[str] = set()

    def build(self) -> None:
        html(
            "<p>Files of your test machine: text with columns of time, displacement and force, or .xlsx. "
            f"They are copied into <code>measured/</code>, up to {guard.LARGEST_BYTES // 2**20} MB each.</p>"
        )
        for name in self._missing:
            tell_problem(f"'{name}' is not in measured/ (any more). Choose another file, or bring it back.")
        said = ui.element("div")
        uploader(self._folder, said, self._add)
        self._chosen = ui.select([], multiple=True, label="Files to read").props('use-chips data-test="files"')
        self._chosen.style("width:100%")
        self._fields: dict[str, ui.input] = {}
        with ui.expansion("What the file leaves open (only when asked)").style("width:100%"):
            with ui.element("div").classes("fields"):
                for name, words in OPEN.items():
                    self._fields[name] = ui.input(words).props(f'data-test="open-{name}"')
        self._change = ui.expansion("Rename, replace or delete files").props('data-test="change-files"')
        self._change.style("width:100%").on_value_change(self._list_files)
        self._work = Work(self._studio, "import", "Read the files", self._words, self._show, self._belongs,
                          lambda job: self._list_imports())  # fmt: skip
        self._choose(self._asked)
        for field in (self._chosen, *self._fields.values()):
            field.on_value_change(self._renew)
        self._imports = ui.element("section").props('data-test="imports"').style("width:100%")
        self._list_imports()
        html(f'<p class="note">A puck of resin was pressed: {page_link("/resin", "find its modulus", "resin")}.</p>')

    def _names(self) -> list[str]:
        found = (path for path in self._folder.glob("*.*") if path.suffix.lower() in TEXTS and path.is_file())
        return sorted(path.name for path in found if not path.name.startswith("."))

    def _choose(self, names: list[str]) -> None:
        found = self._names()
        self._chosen.set_options(found, value=[name for name in names if name in found])
        self._chosen.set_enabled(bool(found))
        self._work.renew_line()

    def _add(self, name: str) -> None:
        """Choose a file that came in; one that is gone is let go."""
        kept = [one for one in self._chosen.value if one != name]
        self._choose([*kept, name])
        self._list_files()

    def _renew(self) -> None:
        keep_state(self._state, files=SEPARATOR.join(self._chosen.value or []))
        self._work.renew_line()

    def _words(self) -> list[str]:
        if not self._chosen.value:
            raise InputError("Choose a file to read.")
        names = list(self._chosen.value)
        stem = names[0].rpartition(".")[0] if len(names) == 1 else "all"
        given = options({name: field.value for name, field in self._fields.items()})
        return ["import", *(f"measured/{name}" for name in names), *given, "--out", f"measured/import-{stem}"]

    def _belongs(self, job: Job) -> bool:
        """Whether a job read the chosen files, and its presses are still there."""
        asked = {f"measured/{name}" for name in self._chosen.value or []}
        if set(_sources(job)) != asked:
            return False
        return not job.answer.get("files") or (self._studio.root / _out(job)).is_dir()

    def _list_files(self) -> None:
        self._change.clear()
        if not self._change.value:
            return
        with self._change:
            found = self._names()
            if not found:
                html("<p>No files yet.</p>")
            for name in found:
                with ui.element("div").classes("thing"):
                    html(f"<span>{escape(name)}</span>")
                    with ui.element("div"):
                        manage(self._studio, f"measured/{name}", "file", self._moved)

    def _moved(self, old: str, new: str) -> None:
        """Follow a file that was renamed, replaced, deleted or brought back; what was chosen stays chosen."""
        before, now = Path(old).name, Path(new).name
        names = list(self._chosen.value)
        if before in names and not now:
            self._let_go.add(before)
        elif before not in names and before in self._let_go:
            names.append(now)
        self._choose([now if one == before else one for one in names])
        self._renew()
        self._list_files()

    def _list_imports(self) -> None:
        self._imports.clear()
        found = sorted(path for path in self._folder.glob("import-*") if path.is_dir())
        with self._imports:
            if not found:
                return
            html("<h2>Presses that were read</h2>")
            for path in found:
                count = len(list(path.glob("*.csv")))
                title = f"{path.name}: {count} press{'es' * (count != 1)}"
                one = ui.expansion(title).style("width:100%").props('data-test="import"')
                one.on_value_change(lambda event, one=one, path=path: self._open_import(one, path))

    def _open_import(self, place: ui.expansion, path: Path) -> None:
        place.clear()
        if not place.value:
            return
        inner = f"measured/{path.name}"
        with place:
            manage(self._studio, inner, "import", lambda old, new: self._list_imports())
            if (path / "preview.html").is_file():
                with ui.element("div").style("width:100%"):
                    shown_file(f"/files/{inner}/preview.html", f"presses of {path.name}")

    def _show(self, job: Job) -> None:
        answer = job.answer
        if not isinstance(answer.get("files"), list):
            return
        out = _out(job)
        html(f"<p><b>{escape(', '.join(Path(one['source']).name for one in answer['files']))}</b></p>")
        for name in changed_inputs(self._studio.root, self._studio.root / out / "manifest.json"):
            tell_problem(f"{Path(name).name} has changed since it was read. Read the files again.")
        warnings(answer)
        if answer.get("preview") and (self._studio.root / answer["preview"]).is_file():
            shown_file(f"/files/{answer['preview']}", "preview of the presses")
        for one in answer["files"]:
            html(f"<h2>{escape(one['source'].rpartition('/')[2])}</h2>")
            rows = [
                [t["file"], t["samples"], t["velocity_mm_s"], t["hold_s"], t["depth_mm"], t["peak_force_N"],
                 t["steady_force_N"]] for t in one["traces"]
            ]  # fmt: skip
            table(["press", "samples", "mm/s", "hold s", "depth mm", "peak N", "steady N"], rows)
            rows = [[d["what"], str(d["value"]), d["why"]] for d in one["decisions"]]
            under = f"how {len(rows)} things were decided, and why"
            table(["decided", "value", "because"], rows, words=True, under=under)
        html(f'<p class="note">Next: {page_link("/tissue", "fit a tissue to these presses")}</p>')


def _sources(job: Job) -> list[str]:
    """Files that an import read."""
    words = job.words[1:]
    return list(words[: next((at for at, word in enumerate(words) if word.startswith("--")), len(words))])


def _out(job: Job) -> str:
    """Folder that an import wrote; it has a number where the one asked for was taken."""
    return str(Path(job.answer.get("preview") or "measured/none/preview.html").parent.as_posix())


def _last_read(root: Path) -> list[str]:
    """Files of the newest import, when nothing else was chosen."""
    job = jobs.latest(root, "import")
    return [Path(name).name for name in _sources(job)] if job is not None else []


def uploader(
    folder: Path, said: ui.element, then: Callable[[str], None], check: Callable[[str], None] | None = None,
    replace: bool = False,
) -> None:  # fmt: skip
    """A place to drop files, which go into a folder of the project; what became of each is said, in one list a drop.

    Parameters
    ----------
    folder : Path
        Where they go.
    said : element
        Where it is said what was taken or refused.
    then : callable
        Called with the name of each file that was taken, also of one whose content is there already.
    check : callable, optional
        Raises InputError for a name that is not wanted.
    replace : bool
        Whether a file takes the place of another of its name, which goes to the bin. Otherwise it gets a number, and
        a button offers to replace the earlier one.
    """
    root = next(place for place in (folder, *folder.parents) if (place / FILE).is_file())
    bar = undo_bar(Studio(root))

    def note(text: str, problem: bool = False) -> None:
        with said:
            tell_problem(text) if problem else html(f'<p class="note" role="status">{escape(text)}</p>')

    def back(old: str, new: str) -> None:
        said.clear()
        then(Path(new).name)

    async def took(event: events.UploadEventArguments) -> None:
        name = event.file.name
        try:
            files.plain_name(name)
            if check is not None:
                check(name)
            stored = uploads.store(root, folder, name, await event.file.read(), replace)
        except InputError as problem:
            note(f"{name} was refused: {problem}", problem=True)
            return
        if stored.outcome == "numbered":
            ask(stored)
        else:
            note(stored.text)
        if stored.gone is not None:
            bar.offer(stored.gone, back)
        then(stored.name)

    def ask(stored: uploads.Stored) -> None:
        with said, ui.element("div").classes("note thing") as row:
            html(f'<span role="status">{escape(stored.text)}</span>')
            button = ui.button(f"Replace the earlier {stored.sent}", color=None, on_click=lambda: swap(stored, row))
            button.props('outline dense data-test="replace-earlier"')

    def swap(stored: uploads.Stored, row: ui.element) -> None:
        try:
            done = uploads.take_place(root, folder, stored.name, stored.sent)
        except InputError as problem:
            note(str(problem), problem=True)
            return
        row.delete()
        note(done.text)
        if done.gone is not None:
            bar.offer(done.gone, back)
        bar.run(lambda: then(done.name))

    drop_zone(took, lambda name, why: note(f"{name} was refused: it {why}", problem=True), "choose", said.clear)
