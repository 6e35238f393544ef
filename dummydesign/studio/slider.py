"""A slider of the browser's own kind: keyboard, touch and screen reader as one knows them."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

from nicegui import events, ui

THROTTLE_S = 0.03
LONG_UNIT = 8


class Slider:
    """A range with its number beside it, written by the browser itself as it moves.

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
        self.value, self._moved, self._unit = value, moved, unit
        with ui.element("label").classes("slide"):
            self._head = ui.html("", sanitize=False)
            self._range = ui.element("input").props(f'type=range data-test="slide-{name.lower()}"')
        self._name = name
        self.limit(low, high, step, unit)
        self._range.on("input", self._take, js_handler="(e) => emit(e.target.value)", throttle=THROTTLE_S)

    def limit(self, low: float, high: float, step: float, unit: str) -> None:
        """Set the ends and the step; the value is moved inside.

        Parameters
        ----------
        low, high, step : float
            As for a range of the browser.
        unit : str
            Written over it.
        """
        self._unit = unit
        self._range.props(f"min={low:g} max={high:g} step={step:g}")
        self.set(min(max(self.value, low), high))

    def set(self, value: float) -> None:
        """Move it from here, without a call."""
        self.value = float(value)
        self._range.props(f"value={self.value:g}")
        self._write()

    def _take(self, event: events.GenericEventArguments) -> None:
        self.value = float(event.args)
        # so that a later set to the former value is a change
        self._range._props["value"] = f"{self.value:g}"
        self._write()
        self._moved()

    def _write(self) -> None:
        long = len(self._unit) > LONG_UNIT
        unit, below = ("", f"<small>{escape(self._unit)}</small>") if long else (escape(self._unit), "")
        text = f"<span>{escape(self._name)}</span><span><output>{self.value:g}</output> {unit}</span>"
        self._head.set_content(f'<span class="row">{text}</span>{below}')
