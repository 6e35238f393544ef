"""Files dropped on a page; buttons that delete what lies in a project, and take a change back."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.studio import trash, widgets
from dummydesign.studio.access import LARGEST_BYTES
from dummydesign.studio.markup import Markup, filled, joined
from dummydesign.studio.widgets import html

HEADER = """
<div class="drop">
  <span>Drop files here, or</span>
  <q-btn outline no-caps label="choose files" aria-label="choose files" data-test="TEST"
    @click="props.pickFiles"></q-btn>
  <span class="hide" aria-hidden="true"><q-uploader-add-trigger></q-uploader-add-trigger></span>
  <q-spinner v-if="props.isUploading" size="1.4em"></q-spinner>
</div>
"""
"""Of the place for files: a button with words in the place of a plus sign without any; its file field is not in it."""
REASONS = {"max-file-size": f"is larger than {LARGEST_BYTES // 2**20} MB"}
STILL_OFFERED_S = 60.0
"""How long a deletion can be undone right where it happened, also after the page was loaded again. [s]"""
REJECTED = "(entries) => emit(performance.now(), entries.map((e) => [e.file.name, e.failedPropValidation]))"
ADDED = "(files) => emit(performance.now())"

Then = Callable[[], object]


def manage(root: Path, path: str, kind: str, then: Then = ui.navigate.reload) -> None:
    """Add a button that deletes a thing of the project; ``then`` is called after that, and after it is taken back."""
    name, bar = path.rpartition("/")[2], undo_bar(root)

    def remove() -> None:
        with widgets.problems_in(refused):
            bar.offer(trash.delete(root, path), then)
            bar.run(then)

    made = widgets.button("Delete", remove, "delete", f"Delete the {kind} {name}").props("dense")
    widgets.having(made, data_name=name)
    refused = ui.element("div")


def thing(words: Markup, root: Path, path: str, kind: str, then: Then = ui.navigate.reload) -> ui.element:
    """Add a row with a thing of the project and its button."""
    with ui.element("div").classes("thing") as row:
        html("{}", words)
        with ui.element("div"):
            manage(root, path, kind, then)
    return row


class DropList:
    """A place to drop files; what became of each file of the last drop is listed under it."""

    def __init__(
        self,
        root: Path,
        take: Callable[[str, bytes], trash.Taken],
        then: Then,
        words: str = "",
        test: str = "presses",
    ) -> None:
        self._take, self._then, self._bar = take, then, undo_bar(root)
        self._taken: tuple[ui.html, list[str]] | None = None
        if words:
            html('<p class="note">{}</p>', words)
        self._last_ms = -1e9
        with widgets.area(f"drop-{test}"):
            upload = ui.upload(on_upload=self._took, multiple=True, auto_upload=True, max_file_size=LARGEST_BYTES)
        upload.props('flat data-test="drop"').add_slot("header", HEADER.replace("TEST", "choose"))
        upload.on("rejected", self._rejected, js_handler=REJECTED)
        upload.on("added", lambda event: self._begun(float(event.args)), js_handler=ADDED)
        upload.on("failed", self._failed, js_handler="(info) => emit(info.files.map((file) => file.name))")
        # a list that is kept would refuse the same file the next time
        upload.on("finish", lambda: upload.reset())
        self.listed = widgets.area(f"drop-{test}-said", live=True)

    def _begun(self, ms: float) -> None:
        # what is refused and what is taken of one drop come in the same moment of the browser's clock
        if abs(ms - self._last_ms) > 50.0:
            self.listed.clear()
        self._last_ms = ms

    def _rejected(self, event: events.GenericEventArguments) -> None:
        ms, entries = event.args
        self._begun(float(ms))
        for name, reason in entries:
            self.tell(f"{name} was refused: it {REASONS.get(str(reason), 'was dropped twice')}", refused=True)

    def _failed(self, event: events.GenericEventArguments) -> None:
        for name in event.args:
            self.tell(f"{name} was refused: it did not arrive: drop it again", refused=True)

    async def _took(self, event: events.UploadEventArguments) -> None:
        content = await event.file.read()
        try:
            taken = self._take(event.file.name, content)
        except InputError as problem:
            self.tell(f"{event.file.name} was refused: {problem}", refused=True)
            return
        self.tell(taken.text)
        if taken.gone is not None:
            self._bar.offer(taken.gone, self._then, focus=False)
        self._then()

    def tell(self, sentence: str, refused: bool = False) -> None:
        """Add a sentence to the list."""
        with self.listed:
            if refused:
                html('<p class="problem" data-kind="refused">{}</p>', sentence)
                return
            if self._taken is None or self._taken[0].is_deleted:
                self._taken = html(""), []
        shown, sentences = self._taken
        sentences.append(sentence)
        lines = joined('<p class="note" data-kind="taken">{}</p>', ([one] for one in sentences))
        more = filled("<details><summary>{} files were taken</summary>{}</details>", len(sentences), lines)
        shown.set_content(more if len(sentences) > 1 else lines)


class UndoBar:
    """The last change at the foot of a page, with a button that takes it back."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._content = ui.context.client.content
        with self._content:
            self._area = widgets.area("undo", live=True).classes("undo")
        newest = next(iter(trash.deleted(root)), None)
        if newest is not None and newest.why != "undone" and time.time() - newest.time < STILL_OFFERED_S:
            self.offer(newest, focus=False)

    def run(self, change: Then) -> None:
        """Run a change of the page that may take away the button that was pressed."""
        with self._content:
            change()

    def say(self, text: str) -> ui.element:
        """Show a sentence in the place of the last."""
        with widgets.fresh(self._area):
            html("<p>{}</p>", text)
            line = ui.element("div")
            widgets.button("Close", self._area.clear, label="Close this message").props("dense")
        return line

    def take_back(self, gone: trash.Deleted, then: Then) -> None:
        """Bring something back from the bin, and say so."""
        try:
            self.say(f"{trash.restore(self._root, gone)} is back.")
        except InputError as problem:
            self.say(f"{problem}.")
        else:
            self.run(then)

    def offer(self, gone: trash.Deleted, then: Then = ui.navigate.reload, focus: bool = True) -> None:
        """Show what was deleted, with its button; the button that deleted it is gone, so this one gets the focus."""
        name, undo = gone.path.rpartition("/")[2], partial(self.take_back, gone, then)
        with self.say(f"The earlier {name} was replaced." if gone.why == "replaced" else f"{name} was deleted."):
            back = widgets.button("Undo", undo, "undo-last", f"Undo: bring back {name}", main=True).props("dense")
            if focus:
                ui.run_javascript(f"setTimeout(() => document.getElementById('{back.html_id}')?.focus(), 100)")


def undo_bar(root: Path) -> UndoBar:
    """The bar of this page, made when it is first wanted."""
    client: Any = ui.context.client
    bar: UndoBar = getattr(client, "undo_bar", None) or UndoBar(root)
    client.undo_bar = bar
    return bar


BACK = '<p class="note">What you restore is listed when you <a href="">load the page again</a>.</p>'


def deleted_files(root: Path) -> None:
    """The list of what was deleted, each with a button that restores it."""
    section, bar = widgets.area("deleted"), undo_bar(root)

    def renew() -> None:
        entries = trash.deleted(root)
        with widgets.fresh(section):
            html(BACK if entries else "<p>Nothing was deleted.</p>")
            for one in entries:
                when = time.strftime("%d %b %H:%M", time.localtime(one.time))
                with ui.element("div").classes("thing"):
                    html("<span>{}, {} {}</span>", one.path, one.why, when)
                    restore = partial(bar.take_back, one, renew)
                    widgets.button("Restore", restore, "restore", f"Restore {one.path}").props("dense")

    renew()
