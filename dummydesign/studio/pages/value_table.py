"""A table of numbers to fill in: one plain field a cell, each told to the server when it was changed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import Any

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import html

HEADS = {
    "sequence": "order", "thickness_mm": "pad [mm]", "velocity_mm_s": "speed [mm/s]", "target_force_N": "force [N]",
    "target_depth_mm": "depth [mm]", "hold_s": "hold [s]", "age_days": "age [days]",
    "temperature_C": "temperature [C]", "rest_s": "rest [s]", "repeat": "repeat",
}  # fmt: skip
CHANGED = (
    "(e) => { const cell = e.target; if (cell.dataset.key) emit([Number(cell.dataset.row), cell.dataset.key, "
    "cell.value]); }"
)


def number_of(text: str, name: str) -> float | None:
    """A typed number, with a dot or a comma; None for an empty field.

    Raises
    ------
    InputError
        For anything else, by the name of the field.
    """
    given = text.strip().replace(",", ".")
    if not given:
        return None
    try:
        value = float(given)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} = '{text.strip()}' is not a number")
    return value


def table_html(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    """The table as HTML; each row has ``file`` and the keys, None where a value is unknown."""
    head = "".join(f"<th scope=col>{escape(HEADS.get(key, key))}</th>" for key in keys)
    body = []
    for number, row in enumerate(rows):
        cells = []
        for key in keys:
            value = row.get(key)
            shown = f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else ""
            label = escape(f"{HEADS.get(key, key)} of {row['file']}", quote=True)
            cells.append(f'<td><input inputmode="decimal" size="6" data-row="{number}" data-key="{key}" '
                         f'value="{shown}" aria-label="{label}"></td>')  # fmt: skip
        body.append(f"<tr><th scope=row>{escape(str(row['file']))}</th>{''.join(cells)}</tr>")
    return (f'<div class="values"><table><thead><tr><th scope=col>press</th>{head}</tr></thead>'
            f"<tbody>{''.join(body)}</tbody></table></div>")  # fmt: skip


def value_table(
    keys: Sequence[str], rows: Sequence[Mapping[str, Any]], changed: Callable[[int, str, str], bool]
) -> ui.html:
    """Show the table.

    Parameters
    ----------
    keys : sequence of str
        Columns.
    rows : sequence of mapping
        With ``file`` and values.
    changed : callable
        Called with row, key and text of a field that was changed; False where it was refused, which marks the field.
    """
    shown = html(table_html(keys, rows)).style("width:100%")

    def told(event: events.GenericEventArguments) -> None:
        row, key, text = event.args
        if key in keys and isinstance(row, int) and 0 <= row < len(rows):
            kept = changed(row, key, str(text))
            mark = "removeAttribute('aria-invalid')" if kept else "setAttribute('aria-invalid', true)"
            ui.run_javascript(f"""document.querySelector('#{shown.html_id} [data-row="{row}"][data-key="{key}"]')"""
                              f"?.{mark}")  # fmt: skip

    shown.on("change", told, js_handler=CHANGED)
    return shown
