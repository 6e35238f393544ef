"""Buttons that rename, replace and delete what lies in a project, take it back, and list what was deleted."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable
from html import escape
from pathlib import Path
from typing import Any

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.studio import bin, uploads
from dummydesign.studio.frame import Studio, html, tell_problem
from dummydesign.studio.server import guard

HEADER = """
<div class="drop">
  <span>Drop files here, or</span>
  <q-btn outline no-caps label="choose files" aria-label="LABEL" data-test="TEST" @click="props.pickFiles"></q-btn>
  <span class="hide" aria-hidden="true"><q-uploader-add-trigger></q-uploader-add-trigger></span>
  <q-spinner v-if="props.isUploading" size="1.4em"></q-spinner>
</div>
"""
"""Of the place for files: a button with words in the place of a plus sign without any; its file field is not in it."""
REASONS = {"max-file-size": f"is larger than {guard.LARGEST_BYTES // 2**20} MB"}
STILL_OFFERED_S = 60.0
"""How long a deletion can be undone right where it happened, also after the page was loaded again. [s]"""
REJECTED = "(entries) => emit(performance.now(), entries.map((e) => [e.file.name, e.failedPropValidation]))"
ADDED = "(files) => emit(performance.now())"

Then = Callable[[str, str], None]


def manage(studio: Studio, path: str, kind: str, then: Then) -> None:
    """A row of buttons to rename and delete a thing of the project, and to replace a file.

    Parameters
    ----------
    studio : Studio
    path : str
        From the project folder on.
    kind : str
        What it is, in a word: file, import, tissue, plan, design, mould, calibration. A file can be replaced.
    then : callable
        Called with its path before and its path now, which is empty once it is deleted.
    """
    name = path.rpartition("/")[2]
    bar = undo_bar(studio)
    with ui.element("div").classes("manage").props("role=group") as row:
        row.props["aria-label"] = f"change {name}"
        buttons: dict[str, ui.button] = {}
        for word in ("Rename", "Replace", "Delete")[:: 1 if kind == "file" else 2]:
            buttons[word] = ui.button(word, color=None)
            buttons[word].props(f'outline dense data-test="{word.lower()}"')
            # not in a text of properties: a name with a backslash in it would break off there
            buttons[word].props.update({"aria-label": f"{word} the {kind} {name}", "data-name": name})
    form = ui.element("div")

    def remove() -> None:
        form.clear()
        try:
            gone = bin.delete(studio.root, path)
        except InputError as problem:
            with form:
                tell_problem(str(problem))
            return
        bar.offer(gone, then)
        bar.run(lambda: then(path, ""))

    def ask_name() -> None:
        form.clear()
        with form, ui.element("div").classes("fields"):
            field = ui.input(f"New name of {name}", value=_short(studio.root, path)).props('data-test="new-name"')
            with ui.element("div"):
                ui.button("Save", on_click=lambda: take_name(field.value or "")).props('data-test="save-name"')
                ui.button("Cancel", on_click=form.clear, color=None).props("outline")
        field.on("keydown.enter", lambda: take_name(field.value or ""))
        field.on("keydown.escape", form.clear)
        field.run_method("focus")

    def take_name(new: str) -> None:
        try:
            now = bin.rename(studio.root, path, new)
        except InputError as problem:
            ask_name()
            with form:
                tell_problem(str(problem))
            return
        form.clear()
        bar.say(f"{name} is now {now.rpartition('/')[2]}.")
        bar.run(lambda: then(path, now))

    async def take_file(event: events.UploadEventArguments) -> None:
        sent, ending = event.file.name, Path(path).suffix.lower()
        try:
            if Path(sent).suffix.lower() != ending:
                raise InputError(f"{sent} was refused: choose a file that ends in {ending}")
            folder = (studio.root / path).parent
            stored = uploads.store(studio.root, folder, name, await event.file.read(), replace=True)
        except InputError as problem:
            with form:
                tell_problem(str(problem))
            return
        form.clear()
        if stored.gone is None:
            bar.say(f"{sent} is the same as {stored.name}, which is there: nothing was changed.")
            return
        bar.offer(stored.gone, then)
        bar.run(lambda: then(path, path))

    def ask_file() -> None:
        form.clear()
        with form:
            html(f"<p>Choose the file that replaces {escape(name)}. The earlier one goes to the bin.</p>")
            drop_zone(take_file, lambda name, why: tell_problem(f"{name} was refused: it {why}"), "replace",
                      multiple=False)  # fmt: skip

    buttons["Rename"].on_click(ask_name)
    buttons["Delete"].on_click(remove)
    if "Replace" in buttons:
        buttons["Replace"].on_click(ask_file)


def _short(root: Path, path: str) -> str:
    """What can be changed of a name."""
    place = root / path
    name = place.stem if place.is_file() else place.name
    return name.removeprefix("import-") if bin.is_import(path) else name


def drop_zone(
    took: Callable[[events.UploadEventArguments], Awaitable[None]], refused: Callable[[str, str], None], test: str,
    begins: Callable[[], None] | None = None, multiple: bool = True,
) -> None:  # fmt: skip
    """A place to drop files.

    Parameters
    ----------
    took : callable
        Takes each file that was sent.
    refused : callable
        Takes the name of each that was not, and why.
    test : str
        Of the button, ``choose`` or another.
    begins : callable, optional
        Called when files are dropped, before the others.
    multiple : bool
        Whether several can be dropped at once.
    """
    last = {"ms": -1e9}

    def begun(ms: float) -> None:
        # what is refused and what is taken of one drop come in the same moment of the browser's clock
        if begins is not None and abs(ms - last["ms"]) > 50.0:
            begins()
        last["ms"] = ms

    def rejected(event: events.GenericEventArguments) -> None:
        ms, entries = event.args
        begun(float(ms))
        for name, reason in entries:
            refused(str(name), REASONS.get(str(reason), "was dropped twice"))

    def failed(event: events.GenericEventArguments) -> None:
        for name in event.args:
            refused(str(name), "did not arrive: drop it again")

    place = ui.upload(on_upload=took, multiple=multiple, auto_upload=True, max_file_size=guard.LARGEST_BYTES)
    label = "choose files" if test == "choose" else "choose the file"
    header = HEADER.replace("TEST", test).replace("LABEL", label)
    header = header if multiple else header.replace("choose files", "choose the file").replace("files here", "it here")
    place.props('flat data-test="drop"').add_slot("header", header)
    place.on("rejected", rejected, js_handler=REJECTED)
    place.on("added", lambda event: begun(float(event.args)), js_handler=ADDED)
    place.on("failed", failed, js_handler="(info) => emit(info.files.map((file) => file.name))")
    # a list that is kept would refuse the same file the next time
    place.on("finish", lambda: place.reset())


class UndoBar:
    """The last change at the foot of a page, with a button that takes it back."""

    def __init__(self, studio: Studio) -> None:
        self._studio = studio
        self._content = ui.context.client.content
        with self._content:
            self._area = ui.element("div").classes("undo").props('role="status" aria-live="polite" data-test="undo"')
        newest = next(iter(bin.deleted(studio.root)), None)
        if newest is not None and newest.why != "undone" and time.time() - newest.time < STILL_OFFERED_S:
            self.offer(newest, lambda old, new: ui.navigate.reload(), focus=False)

    def run(self, change: Callable[[], None]) -> None:
        """Run a change of the page that may take away the button that was pressed."""
        with self._content:
            change()

    def say(self, text: str) -> ui.element:
        """Show a sentence in the place of the last."""
        self._area.clear()
        with self._area:
            html(f"<p>{escape(text)}</p>")
            place = ui.element("div")
            close = ui.button("Close", on_click=self._area.clear, color=None)
            close.props('outline dense aria-label="Close this message"')
        return place

    def offer(self, gone: bin.Deleted, then: Then, focus: bool = True) -> None:
        """Show what was deleted, with its button; the button that deleted it is gone, so this one gets the focus.

        Parameters
        ----------
        gone : Deleted
        then : callable
            Called with the old and the new path once it is back.
        focus : bool
            Whether the button gets the focus.
        """
        name = gone.path.rpartition("/")[2]

        def undo() -> None:
            try:
                back = _take_back(self._studio.root, gone)
            except InputError as problem:
                self.say(f"{problem}.")
                return
            self.say(f"{gone.path} is back." if back == gone.path else f"It is back as {back}.")
            self.run(lambda: then(gone.path, back))

        place = self.say(f"The earlier {name} was replaced." if gone.why == "replaced" else f"{name} was deleted.")
        with place:
            button = ui.button("Undo", on_click=undo)
            button.props('dense data-test="undo-last"').props["aria-label"] = f"Undo: bring back {name}"
            if focus:
                ui.run_javascript(f"setTimeout(() => document.getElementById('{button.html_id}')?.focus(), 100)")


def _take_back(root: Path, gone: bin.Deleted) -> str:
    """Restore; what took the place of a file goes to the bin first."""
    if gone.why == "replaced" and (root / gone.path).is_file():
        bin.delete(root, gone.path, "undone")
    return bin.restore(root, gone)


def undo_bar(studio: Studio) -> UndoBar:
    """The bar of this page, made when it is first wanted."""
    client: Any = ui.context.client
    if not hasattr(client, "undo_bar"):
        client.undo_bar = UndoBar(studio)
    bar: UndoBar = client.undo_bar
    return bar


def deleted_files(studio: Studio) -> None:
    """The list of what was deleted, each with a button that restores it."""
    area = ui.element("section").props('data-test="deleted"').style("width:100%")
    message = ui.element("div").props('role="status" aria-live="polite"')

    def restore(one: bin.Deleted) -> None:
        message.clear()
        try:
            back = bin.restore(studio.root, one)
        except InputError as problem:
            with message:
                tell_problem(str(problem))
        else:
            with message:
                html(f'<p class="note">{escape(back)} is back. <a href="">Load the page again</a> to see it.</p>')
        renew()

    def renew() -> None:
        area.clear()
        found = bin.deleted(studio.root)
        with area:
            html(f"<h2>Deleted</h2>{'' if found else '<p>Nothing was deleted.</p>'}")
            for one in found:
                when = time.strftime("%d %b %H:%M", time.localtime(one.time))
                with ui.element("div").classes("thing"):
                    html(f"<span>{escape(one.path)}, {escape(one.why)} {when}</span>")
                    button = ui.button("Restore", on_click=lambda one=one: restore(one), color=None)
                    button.props('outline dense data-test="restore"').props["aria-label"] = f"Restore {one.path}"

    renew()
