"""A slider of the browser's own kind: keyboard, touch and screen reader as one knows them."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from nicegui import events, ui

THROTTLE_S = 0.03
LONG_UNIT = 8
TOLD = "(e) => { e.currentTarget.querySelector('output').textContent = e.target.value; emit(e.target.value); }"


class Slider:
    """A range with its number beside it, both written by the browser itself as it moves.

    While it moves nothing is sent back: an answer to the first of several keys would take the later ones back.

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
        self._label = ui.html("", sanitize=False, tag="label").classes("slide")
        self._label.on("input", self._take, js_handler=TOLD, throttle=THROTTLE_S)
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
        self._unit, self._ends = unit, f"min={low:g} max={high:g} step={step:g}"
        self.set(min(max(self.value, low), high))

    def set(self, value: float) -> None:
        """Move it from here, without a call."""
        self.value = float(value)
        long = len(self._unit) > LONG_UNIT
        unit, below = ("", f"<small>{escape(self._unit)}</small>") if long else (escape(self._unit), "")
        # numbered, so that a text written before still replaces what the browser has moved since
        self._written += 1
        self._label.set_content(
            f'<span class="row"><span>{escape(self._name)}</span><span><output>{self.value:g}</output> {unit}</span>'
            f'</span>{below}<input type="range" {self._ends} value="{self.value:g}" '
            f'data-test="slide-{self._name.lower()}" data-written="{self._written}">'
        )

    def _take(self, event: events.GenericEventArguments) -> None:
        self.value = float(event.args)
        self._moved()
