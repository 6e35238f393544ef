"""One file to its presses: zero at contact, tared, compression positive, each from before contact to its end."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Decision, Notes, Settings, question
from dummydesign.measurement.importing.core.units import BASE, known_units, scaled_unit
from dummydesign.measurement.importing.press.contact import LEAST_LEAD_IN, Contact, find_contact
from dummydesign.measurement.importing.press.sanity import check_press
from dummydesign.measurement.importing.press.signs import Signs, find_signs
from dummydesign.measurement.importing.press.split import HIGH, Span, find_presses
from dummydesign.measurement.importing.press.summary import SHALLOWEST_MM, Summary, summarise
from dummydesign.measurement.importing.press.zero import find_contacts, find_tares
from dummydesign.measurement.importing.table import Columns, read_columns
from dummydesign.measurement.trace import magnitude_fault


@dataclass(frozen=True)
class Press:
    """One press as it is written, and where it stood in the file.

    Attributes
    ----------
    number : int
        From 1.
    time_s, displacement_mm, force_N : ndarray, shape (n,)
        Time from 0 at the first sample; zero at contact; tared; compression positive.
    summary : Summary
    contact_low_mm, contact_high_mm : float
        95 % interval of the contact that the force alone gives, about the zero that was taken.
    begins_s : float
        Time of the file at the first sample.
    """

    number: int
    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    summary: Summary
    contact_low_mm: float
    contact_high_mm: float
    begins_s: float


@dataclass(frozen=True)
class Imported:
    """A file that was read: its presses, what was decided, what looks wrong, and the layout for a profile."""

    source: Path
    presses: tuple[Press, ...]
    decisions: tuple[Decision, ...]
    warnings: tuple[dict[str, Any], ...]
    columns: Columns


def import_file(path: str | Path, settings: Settings | None = None) -> Imported:
    """Read a file as a test machine wrote it.

    Parameters
    ----------
    path : path
        Text in any usual encoding, or .xlsx where its reader is installed.
    settings : Settings, optional
        What the user settled; everything else is found.

    Raises
    ------
    InputError
        With file and line where there is one, and what to do.
    QuestionError
        Where the file leaves a decision open, with the option that settles it.
    """
    settings = settings or Settings()
    path, notes = Path(path), Notes()
    columns = read_columns(path, settings, notes)
    file = columns.file
    tare = _reading("tare", settings.tare, "force", columns)
    given = _reading("contact", settings.contact, "displacement", columns)
    signs = find_signs(file, columns.displacement_mm, columns.force_N, settings, tare, notes)
    time, x = columns.time_s, signs.displacement * columns.displacement_mm
    load = signs.force * (columns.force_N - signs.rest_force_N)
    spans = _spans(file, x, load, columns, settings, notes)
    _magnitudes(file, time, x, load, spans, settings)
    contacts = [_contact(file, time, x, load, span, signs, settings, tare) for span in spans]
    rest = signs.force * signs.rest_force_N
    tares = _tares(file, contacts, rest, signs, settings, tare, notes)
    zeros = _zeros(file, contacts, x, spans, signs, settings, given, notes)
    presses = []
    for number, (span, contact, zero, level) in enumerate(zip(spans, contacts, zeros, tares), 1):
        part = slice(span.start, span.stop)
        name = file if len(spans) == 1 else f"{file} press {number}"
        t, way = time[part] - time[span.start], x[part] - zero + 0.0
        force = load[part] + rest - level + 0.0
        summary = summarise(name, t, way, force)
        fault = magnitude_fault(t, way, force, seconds="time" in settings.units)
        if fault:
            raise question(name, fault, "--units time=.., displacement=.. or force=.. with the unit that it is in")
        check_press(name, t, way, force, contact, summary, notes.warn)
        presses.append(
            Press(
                number, t, way, force, summary, contact.low_mm - zero, contact.high_mm - zero, float(time[span.start])
            )
        )
    return Imported(path, tuple(presses), tuple(notes.decisions), tuple(notes.warnings), columns)


def _reading(option: str, word: str, role: str, columns: Columns) -> float | None:
    """A reading given by the user, as the file counts it, in N or mm; None for auto and none."""
    if word in ("auto", "none"):
        return None
    kind = "force" if role == "force" else "length"
    parts = re.fullmatch(r"\s*([+-]?[0-9.]+(?:[eE][+-]?\d+)?)\s*(\S*)\s*", word)
    unit = scaled_unit(parts[2] or BASE[kind], kind) if parts else None
    try:
        value = float(parts[1]) if parts else None
    except ValueError:
        value = None
    if value is None or unit is None:
        raise InputError(
            f"--{option} {word} is not auto, none or a reading in {BASE[kind]} (or with a unit: {known_units(kind)})"
        )
    return value * unit.factor


def _spans(file: str, x: NDArray, load: NDArray, columns: Columns, settings: Settings, notes: Notes) -> list[Span]:
    """Presses of all recordings of the file."""
    several, spans = settings.split == "auto", []
    for first, stop in columns.recordings:
        part = slice(first, stop)
        shift = float(np.median(load[part][:5])) if first else 0.0
        if abs(shift) > HIGH * float(load.max()):
            raise InputError(
                f"{file}: the recording that begins at sample {first + 1} begins pressed, with {shift:.3g} N; "
                "record from "
                "before contact, or leave it out of the file"
            )
        try:
            found = find_presses(file, x[part], load[part] - shift, several, columns.time_s[part])
        except InputError:
            if len(columns.recordings) == 1:
                raise
            notes.warn(
                "nothing_pressed",
                f"{file}: nothing is pressed in the recording that begins at sample {first + 1}; it is left out",
            )
            continue
        spans += [Span(span.start + first, span.stop + first, span.onset + first) for span in found]
    if not spans:
        raise InputError(f"{file}: nothing is pressed in any of its {len(columns.recordings)} recordings")
    why = (
        "force and depth return to zero between them"
        if len(spans) > 1
        else ("force and depth do not return to zero and rise again" if several else "--split none")
    )
    notes.decide("presses", str(len(spans)), why)
    return spans


def _contact(
    file: str,
    time: NDArray,
    x: NDArray,
    load: NDArray,
    span: Span,
    signs: Signs,
    settings: Settings,
    tare: float | None,
) -> Contact:
    """Contact of one press; where nothing was recorded before it, with the force counted from zero.

    Raises
    ------
    InputError
        When the punch stands still while the force rises.
    """
    way = x[span.onset : span.stop]
    if float(way.max() - x[span.start : span.onset + 1].min()) < SHALLOWEST_MM:
        raise InputError(
            f"{file}: the force rises to {load[span.start : span.stop].max():.3g} N while the position stands at "
            f"{x[span.onset]:.4g} mm; does the recording begin pressed, or is this another column? "
            "(--columns displacement=NAME)"
        )
    if tare is not None:
        return find_contact(time, x, load, span, 0.0)
    contact = find_contact(time, x, load, span)
    if contact.lead_in < LEAST_LEAD_IN:
        rest = signs.force * signs.rest_force_N
        return find_contact(time, x, load, span, -rest if settings.tare == "none" else 0.0)
    return contact


def _tares(
    file: str,
    contacts: Sequence[Contact],
    rest: float,
    signs: Signs,
    settings: Settings,
    tare: float | None,
    notes: Notes,
) -> list[float]:
    if settings.tare == "none":
        notes.decide("tare", "none", "given by --tare")
        return [0.0] * len(contacts)
    if tare is not None:
        notes.decide("tare", f"{signs.force * tare:.6g} N", "given by --tare (compression positive)")
        return [signs.force * tare] * len(contacts)
    return find_tares(file, contacts, rest, signs.force < 0, notes)


def _zeros(
    file: str,
    contacts: Sequence[Contact],
    x: NDArray,
    spans: Sequence[Span],
    signs: Signs,
    settings: Settings,
    given: float | None,
    notes: Notes,
) -> list[float]:
    if settings.contact == "none" or given is not None:
        zero = 0.0 if given is None else signs.displacement * given
        notes.decide("contact", f"{zero:.6g} mm" if given is not None else "the file's own zero", "given by --contact")
        return [zero] * len(spans)
    depths = [float(x[s.start : s.stop].max()) - c.position_mm for s, c in zip(spans, contacts)]
    return find_contacts(file, contacts, depths, float(x[spans[0].start]), signs.displacement, notes)


def _magnitudes(file: str, time: NDArray, x: NDArray, load: NDArray, spans: Sequence[Span], settings: Settings) -> None:
    """Ask for the unit where a press would be beyond what any such machine does."""
    force = max(float(load[s.start : s.stop].max()) for s in spans)
    depth = max(float(x[s.start : s.stop].max() - x[s.onset]) for s in spans)
    step = float(np.median(np.diff(time)))
    speed = max(float(x[s.onset : s.stop].max() - x[s.onset]) / max(time[s.start + int(np.argmax(x[s.start : s.stop]))]
                - time[s.onset], step) for s in spans)  # fmt: skip
    doubts = (
        ("force", force > 2000.0, f"the largest force would be {force:.4g} N, above 2000 N", "mN"),
        ("force", force < 0.03, f"the largest force would be {force:.4g} N, below 0.03 N", "kN"),
        ("displacement", depth > 300.0, f"the punch would press {depth:.4g} mm deep, above 300 mm", "um"),
        ("displacement", depth < 0.03, f"the punch would press {depth:.4g} mm deep, below 0.03 mm", "m"),
        ("time", speed > 5000.0, f"the punch would move at {speed:.4g} mm/s, above 5000 mm/s", "s"),
    )
    for role, wrong, text, guess in doubts:
        if wrong and role in settings.units:
            raise InputError(f"{file}: with --units {role}={settings.units[role]} {text}; check the unit")
        if wrong:
            raise question(file, text, f"--units {role}={guess} (or the unit that it is in)")
