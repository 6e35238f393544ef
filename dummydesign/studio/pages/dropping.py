"""A place to drop several files: each is taken or refused by itself, with the reason."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import html
from dummydesign.studio.manage import drop_zone


def drop_place(
    take: Callable[[str, bytes], str], then: Callable[[], None], words: str, test: str = "presses"
) -> Callable[[], None]:
    """A place to drop files; what became of each file of the last drop is listed under it.

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
            show(f"{event.file.name} was refused: {problem}", "refused")
            return
        show(sentence, "taken")
        then()

    def show(sentence: str, kind: str) -> None:
        with listed:
            style = "problem" if kind == "refused" else "note"
            html(f'<p class="{style}" data-kind="{kind}">{escape(sentence)}</p>')

    with ui.element("div").props(f'data-test="drop-{test}"').style("width:100%"):
        drop_zone(took, lambda name, why: show(f"{name} was refused: it {why}", "refused"), "choose",
                  lambda: listed.clear())  # fmt: skip
    listed = ui.element("div").props(f'role="status" aria-live="polite" data-test="drop-{test}-said"')
    listed.style("width:100%")
    return listed.clear
