"""Preview of an import: each press with its contact and hold, what was decided and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import write_text
from dummydesign.core.tables import Table
from dummydesign.measurement.importing.read import Imported, ImportedPress
from dummydesign.report.page import STYLES, Section, page
from dummydesign.report.plot import Plot, Series

MOST_PRESSES = 120
"""Presses that are drawn; more stand in the tables only."""
TOE = 0.15
"""Share of the largest force that the figure of the contact shows."""
_POINTS = 2000


def write_preview(
    folder: Path, imported: Sequence[Imported], files: Sequence[Mapping[str, Any]], warnings: Iterable[dict[str, Any]]
) -> str:
    """Write ``preview.html``, one file that asks nothing of the outside."""
    sections, drawn = [], 0
    for number, (one, written) in enumerate(zip(imported, files)):
        plots = []
        if drawn + len(one.presses) <= MOST_PRESSES:
            drawn += len(one.presses)
            plots = [_recording(number, one), *(_toe(number, one, press) for press in one.presses)]
        sections.append(Section(one.name, "", plots, _traces(written)))
        sections.append(Section(f"{one.name}: what was decided", html=_decisions(written)))
    presses = sum(len(one.presses) for one in imported)
    facts = [(str(len(imported)), "files"), (str(presses), "presses")]
    lead = (
        "What was read, one press a trace: tared, zero at contact, compression positive. Look at the contact of "
        "each press and at the decisions; where one is wrong, its option settles it."
    )
    if drawn < presses:
        lead += f" Figures of the first {drawn} presses; the rest stand in the tables."
    every = [*(warning for written in files for warning in written["warnings"]), *warnings]
    return str(write_text(folder / "preview.html", page("Import", lead, sections, facts, every, values=False)))


def _some(press: ImportedPress) -> np.ndarray:
    """Samples to draw: evenly in time, with the rise in full."""
    count = len(press.time_s)
    rise = np.flatnonzero(press.time_s <= press.summary.stop_time_s)
    keep = np.r_[np.linspace(0, count - 1, min(count, _POINTS)), rise[:: max(len(rise) // _POINTS, 1)]]
    return np.unique(keep.astype(int))


def _recording(number: int, one: Imported) -> Plot:
    """Force over the time of the file, each press in its own colour, holds as areas, contacts as points."""
    series: list[Series] = []
    top = max(press.summary.peak_force_N for press in one.presses)
    for press in one.presses:
        if press.summary.hold_s > 0:
            ends = press.begins_s + np.array([press.summary.stop_time_s, press.summary.hold_end_s])
            series.append(Series.band("hold", ends, np.zeros(2), np.full(2, top)))
    for press in one.presses:
        some = _some(press)
        style = STYLES[(press.number - 1) % len(STYLES)]
        series.append(
            Series.line(f"press {press.number}", press.begins_s + press.time_s[some], press.force_N[some], style)
        )
    touch = [press.begins_s + _contact_time(press) for press in one.presses]
    series.append(Series.dots("contact", np.array(touch), np.zeros(len(touch)), "aim"))
    count = len(one.presses)
    alt = f"Force over time of {one.name}: {count} press{'es' if count > 1 else ''}, largest force {top:.3g} N."
    return Plot(
        f"file-{number + 1}",
        "Force over time",
        alt,
        "time of the file [s]",
        "force [N]",
        "time_s",
        "force_N",
        tuple(series),
        note="Nothing of the recording is left out: presses are parted where the punch is farthest out.",
    )


def _contact_time(press: ImportedPress) -> float:
    """Time of the press at which the position passes zero. [s]"""
    peak = int(np.argmax(press.displacement_mm >= 0.5 * press.summary.depth_mm))
    before = np.flatnonzero(press.displacement_mm[: peak + 1] <= 0)
    return float(press.time_s[before[-1] if before.size else 0])


def _toe(number: int, one: Imported, press: ImportedPress) -> Plot:
    """Force over position about the contact, with the interval in which the force alone places it."""
    x, force = press.displacement_mm, press.force_N
    top = int(np.argmax(force >= TOE * press.summary.peak_force_N))
    reach = max(float(x[top]), press.contact_high_mm, 1e-3)
    part = np.flatnonzero((np.arange(len(x)) <= top) & (x >= -1.5 * reach))
    part = part[:: max(len(part) // _POINTS, 1)]
    low, high = press.contact_low_mm, press.contact_high_mm
    height = float(max(force[top], 0.0))
    interval = Series.band("contact by the force, 95 %", np.array([low, high]), np.zeros(2), np.full(2, height))
    line = Series.line(f"press {press.number}", x[part], force[part], STYLES[(press.number - 1) % len(STYLES)])
    alt = (
        f"Force over position about the contact of press {press.number} of {one.name}; by the force alone "
        f"contact lies between {low:.3g} and {high:.3g} mm of the zero that was taken."
    )
    zero = Series.dots("zero", np.zeros(1), np.zeros(1), "aim")
    return Plot(
        f"contact-{number + 1}-{press.number}",
        f"Contact of press {press.number}",
        alt,
        "displacement [mm]",
        "force [N]",
        "displacement_mm",
        "force_N",
        (interval, line, zero),
    )


def _traces(written: Mapping[str, Any]) -> Table:
    head = ["trace", "samples", "mm/s", "hold s", "depth mm", "peak N", "steady N", "+- N (95 %)"]
    keys = (
        "file",
        "samples",
        "velocity_mm_s",
        "hold_s",
        "depth_mm",
        "peak_force_N",
        "steady_force_N",
        "steady_error_N",
    )
    return Table(head, [[trace[key] for key in keys] for trace in written["traces"]])


def _decisions(written: Mapping[str, Any]) -> str:
    """What was decided, value and reason, in lines that a reader goes through from the left."""
    rows = "".join(
        f"<li><b>{escape(one['what'])}: {escape(one['value'])}</b> - {escape(one['why'])}</li>"
        for one in written["decisions"]
    )
    return f"<ul>{rows}</ul>"
