"""A place to drop several files: each is taken or refused by itself, with the reason."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import html
from dummydesign.studio.pages.measured import HEADER
from dummydesign.studio.server import guard

REJECTED = "(entries) => emit(entries.map((one) => [one.file.name, one.failedPropValidation]))"


def drop_place(
    take: Callable[[str, bytes], str], then: Callable[[], None], words: str, test: str = "drop"
) -> Callable[[], None]:
    """A place to drop files; what became of each file is listed under it.

    Parameters
    ----------
    take : callable
        Keeps a file by its name and content; returns a sentence. InputError refuses it.
    then : callable
        Called after each file that was taken.
    words : str
        What belongs here.
    test : str
        Name for tests.

    Returns
    -------
    callable
        Clears the list.
    """
    html(f'<p class="note">{escape(words)}</p>')

    async def took(event: events.UploadEventArguments) -> None:
        try:
            sentence = take(event.file.name, await event.file.read())
        except InputError as problem:
            _line(listed, f"{event.file.name} was refused: {problem}", "refused")
            return
        _line(listed, sentence, "taken")
        then()

    def rejected(event: events.GenericEventArguments) -> None:
        for name, why in rejections(event.args):
            _line(listed, f"{name} was refused: {why}", "refused")

    place = ui.upload(on_upload=took, multiple=True, auto_upload=True, max_file_size=guard.LARGEST_BYTES)
    place.props(f'flat data-test="{test}"').add_slot("header", HEADER)
    place.on("rejected", rejected, js_handler=REJECTED)
    listed = ui.element("div").props(f'role="status" aria-live="polite" data-test="{test}-said"').style("width:100%")
    return listed.clear


def rejections(given: Any) -> list[tuple[str, str]]:
    """Name and reason of each file that the browser did not send."""
    large = f"it is larger than {guard.LARGEST_BYTES // 2**20} MB"
    return [(str(name), large if why == "max-file-size" else "the browser did not send it") for name, why in given]


def _line(listed: ui.element, sentence: str, kind: str) -> None:
    with listed:
        style = "problem" if kind == "refused" else "note"
        html(f'<p class="{style}" data-kind="{kind}">{escape(sentence)}</p>')
