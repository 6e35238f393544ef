"""A slider of the browser's own kind with a number field beside it: keyboard, touch and screen reader as usual."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from nicegui import events, ui

THROTTLE_S = 0.03
LONG_UNIT = 8
# an input that is typed in half way says nothing; the other one follows in the browser itself
MOVED = (
    "(e) => { const t = e.target; if (t.value === '' || !t.validity.valid) return; "
    "for (const o of e.currentTarget.querySelectorAll('input')) if (o !== t) o.value = t.value; emit(t.value); }"
)


# a field that is left empty or with a number that is not allowed shows again the number that is in use
LEFT = (
    "(e) => { const t = e.target; if (t.type === 'number' && (t.value === '' || !t.validity.valid)) "
    "t.value = e.currentTarget.querySelector('input[type=range]').value; }"
)


class Slider:
    """A range and a number field that follow each other in the browser.

    While they move nothing is sent back: an answer to the first of several keys would take the later ones back.

    Attributes
    ----------
    value : float
    """

    def __init__(
        self, name: str, unit: str, low: float, high: float, step: float, value: float, moved: Callable[[], None]
    ) -> None:
        """Build it.

        Parameters
        ----------
        name, unit : str
            Written over it.
        low, high, step, value : float
            As for a range of the browser.
        moved : callable
            Called after each move.
        """
        self.value, self._name, self._moved, self._written = value, name, moved, 0
        self._box = ui.html("", sanitize=False).classes("slide")
        self._box.on("input", self._take, js_handler=MOVED, throttle=THROTTLE_S)
        self._box.on("focusout", lambda: None, js_handler=LEFT)
        self.limit(low, high, step, unit)

    def limit(self, low: float, high: float, step: float, unit: str) -> None:
        """Set the ends and the step; the value is moved inside.

        Parameters
        ----------
        low, high, step : float
            As for a range of the browser.
        unit : str
            Written over it.
        """
        self._unit, self.low, self.high, self._step = unit, low, high, step
        self.set(min(max(self.value, low), high))

    def set(self, value: float) -> None:
        """Move it from here, without a call."""
        self.value = float(value)
        short = self._unit if len(self._unit) <= LONG_UNIT else ""
        named, test = escape(self._name), escape(self._name.lower())
        ends = f"min={self.low:g} max={self.high:g} step={self._step:g} value={self.value:.6g}"
        # numbered, so that a text written before still replaces what the browser has moved since
        self._written += 1
        self._box.set_content(
            f'<div class="row" data-written="{self._written}"><span>{named}</span>'
            f'<span><input type="number" {ends} aria-label="{named} {escape(short)}" data-test="number-{test}"> '
            f"{escape(short)}</span></div>"
            f'<input type="range" {ends} aria-label="{named}, slider" data-test="slide-{test}">'
            f"<small>{self.low:g} to {self.high:g} {escape(self._unit)}</small>"
        )

    def _take(self, event: events.GenericEventArguments) -> None:
        self.value = float(event.args)
        self._moved()
