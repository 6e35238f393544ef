"""Bring in files of the test machine: drop them, read them, answer what they leave open, look at what was read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.project.status import TEXTS
from dummydesign.studio.frame import Studio, Work, html, lay_out, page_link, shown_file, table, tell_problem, warnings
from dummydesign.studio.server import files, guard
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job

OPEN = {
    "columns": "columns, as time=NAME,displacement=NAME,force=NAME",
    "units": "units, as time=s,displacement=mm,force=N",
    "separator": "separator: tab, semicolon, comma, bar, spaces", "decimal": "decimal sign: . or ,",
    "skip": "lines to leave out at the start", "flip": "turn round: displacement, force, both, or none",
    "tare": "reading at no force: auto, none or a number", "contact": "reading at contact: auto, none or a number",
    "split": "parts: auto, or none for one press",
}  # fmt: skip


HEADER = """
<div class="drop">
  <span>Drop files here, or</span>
  <q-btn outline no-caps label="choose files" data-test="choose" @click="props.pickFiles"></q-btn>
  <span class="hide" aria-hidden="true"><q-uploader-add-trigger></q-uploader-add-trigger></span>
  <q-spinner v-if="props.isUploading" size="1.4em"></q-spinner>
</div>
"""
"""Of the place for files: a button with words in the place of a plus sign without any; its file field is not in it."""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/measured", "Measured files", query, lambda project, state: _body(studio, project))


def _body(studio: Studio, project: Project) -> None:
    root = studio.root
    html(
        "<p>Files of your test machine, in any usual form: text with columns of time, displacement and force, or "
        ".xlsx. They are copied into <code>measured/</code> as they are, up to "
        f"{guard.LARGEST_BYTES // 2**20} MB each.</p>"
    )
    said = ui.element("div")
    def renew(new: str | None = None) -> None:
        found = sorted(p.name for p in (root / "measured").glob("*.*") if p.suffix.lower() in TEXTS and p.is_file())
        kept = [name for name in (chosen.value or []) if name in found]
        chosen.set_options(found, value=[*kept, new] if new and new not in kept else kept)

    uploader(root / "measured", said, renew)
    chosen = ui.select([], multiple=True, label="Files to read").props('use-chips data-test="files"')
    chosen.style("width:100%")
    fields = {}
    with ui.expansion("What the file leaves open (only when asked)").style("width:100%"):
        with ui.element("div").classes("fields"):
            for name, words in OPEN.items():
                fields[name] = ui.input(words).props(f'data-test="open-{name}"')

    def words() -> list[str]:
        if not chosen.value:
            raise InputError("choose a file to read")
        names = list(chosen.value)
        stem = names[0].rpartition(".")[0] if len(names) == 1 else "all"
        given = options({name: field.value for name, field in fields.items()})
        return ["import", *(f"measured/{name}" for name in names), *given, "--out", f"measured/import-{stem}"]

    def show(job: Job) -> None:
        _show(studio, job)

    work = Work(studio, "import", "Read the files", words, show)
    for field in (chosen, *fields.values()):
        field.on_value_change(work.renew_line)
    renew()


def uploader(
    folder: Path, said: ui.element, then: Callable[[str], None], check: Callable[[str], None] | None = None
) -> None:
    """A place to drop files, which go into a folder of the project; what is refused is said.

    Parameters
    ----------
    folder : Path
        Where they go.
    said : element
        Where it is said what was taken or refused.
    then : callable
        Called with the name of each file that was taken.
    check : callable, optional
        Raises InputError for a name that is not wanted.
    """

    async def took(event: events.UploadEventArguments) -> None:
        said.clear()
        try:
            name = files.plain_name(event.file.name)
            if check is not None:
                check(name)
            content = await event.file.read()
            kept = files.keep(folder, name, content)
        except InputError as problem:
            with said:
                tell_problem(str(problem))
            return
        with said:
            html(f'<p class="note" role="status">{escape(kept.name)} is in {escape(folder.name)}/</p>')
        then(kept.name)

    def refused() -> None:
        said.clear()
        with said:
            tell_problem(f"a file is larger than {guard.LARGEST_BYTES // 2**20} MB and was not taken")

    place = ui.upload(on_upload=took, on_rejected=refused, multiple=True, auto_upload=True,
                      max_file_size=guard.LARGEST_BYTES)  # fmt: skip
    place.props('flat data-test="drop"').add_slot("header", HEADER)


def _show(studio: Studio, job: Job) -> None:
    answer = job.answer
    if "files" not in answer or not isinstance(answer["files"], list):
        return
    warnings(answer)
    if answer.get("preview") and (studio.root / answer["preview"]).is_file():
        shown_file(f"/files/{answer['preview']}", "preview of the presses")
    for one in answer["files"]:
        html(f"<h2>{escape(one['source'].rpartition('/')[2])}</h2>")
        rows = [
            [t["file"], t["samples"], t["velocity_mm_s"], t["hold_s"], t["depth_mm"], t["peak_force_N"],
             t["steady_force_N"]] for t in one["traces"]
        ]  # fmt: skip
        table(["press", "samples", "mm/s", "hold s", "depth mm", "peak N", "steady N"], rows)
        rows = [[d["what"], str(d["value"]), d["why"]] for d in one["decisions"]]
        table(["decided", "value", "because"], rows, words=True, under=f"how {len(rows)} things were decided, and why")
    html(f'<p class="note">Next: {page_link("/tissue", "fit a tissue to these presses")}</p>')
