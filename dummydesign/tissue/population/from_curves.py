"""``tissues add-curves``: a tissue from one table of curves, by a law where it follows them, else by the curves."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.own_files import make_room
from dummydesign.measurement.landmarks import approach_velocity, find_ramp
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.measurement.trace_checks import copies_among
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.model.curve_numbers import subjects_of
from dummydesign.tissue.model.laws import DEFAULT, fitted_law
from dummydesign.tissue.model.laws.curves import curves_words
from dummydesign.tissue.model.measured_curves import LAW
from dummydesign.tissue.model.tissue import Tissue, behind_ranges, share_a_speed
from dummydesign.tissue.model.tissue_file import KIND, tissue_toml
from dummydesign.tissue.population.curve_table import HELD_S, Curve, check_curves, read_curves
from dummydesign.tissue.population.from_traces import (
    fit_people,
    fit_row,
    fit_warnings,
    subject_of_fit,
    tissue_folder,
    tissue_of,
)
from dummydesign.tissue.population.without_law.curve_people import person_of
from dummydesign.tissue.population.without_law.law_misfit import FOLLOWS, Misfit, misfit_of

AUTO, NONE = "auto", "none"
FASTER, SLOWER = 1.3, 3.0
"""Factors beyond which a press did not move as it was told; a shallow one that brakes all the way is at half."""


def add_curves(name: str, table: str, law: str, elements: str, replace_own: bool = False) -> dict[str, Any]:
    """Make a tissue from a table of curves and keep it in the user's folder.

    Parameters
    ----------
    name : str
        Name of the tissue.
    table : str
        CSV with ``subject``, ``velocity_mm_s``, ``time_s``, ``depth_mm``, ``force_N``; a curve ends where subject,
        speed or an optional ``press`` changes, or where time goes back. Without times the depth rises at the speed.
    law : str
        Law that is fitted, per speed; ``none`` to keep the curves themselves; ``auto`` for the law ode where it follows
        the curves of everyone (:mod:`dummydesign.tissue.population.without_law.law_misfit`), else the curves.
    elements : str
        Of the law.
    replace_own : bool
        Take the place of a tissue of the user with this name.

    Returns
    -------
    dict
        As :func:`dummydesign.tissue.population.from_traces.add_tissue`, with ``law_misfit`` of everyone where a law was
        fitted.

    Raises
    ------
    InputError
        With file and line for what cannot be read, for curves of one person that contradict each other, for a person
        without a curve that is held, whose steady force is not known, and for people who share no speed or force.
    """
    path = Path(table)
    if law not in (AUTO, NONE):
        fitted_law(law)
    if elements not in ("3", "5", "7"):
        raise InputError(f"--elements {elements} is not one of 3, 5, 7: the subjects of a tissue share one number")
    folder = tissue_folder(name)
    hidden = make_room(KIND, "tissue", name, replace_own)
    curves = read_curves(path)
    for subject in dict.fromkeys(curve.subject for curve in curves):
        check_curves([curve for curve in curves if curve.subject == subject], path.name)
    read = _traces(curves)
    warnings = copies_among([replace(one, name=f"{who}: {one.name}") for who, own in read.items() for one in own])
    held, left_out = _held(read)
    warnings += _unlike_told(held)
    people = {who: person_of([reduce_trace(trace) for trace in own]) for who, own in held.items()}
    if law != NONE:
        share_a_speed({who: one.velocities_mm_s for who, one in people.items()})
    form = DEFAULT if law == AUTO else law
    fits = {} if law == NONE else fit_people(held, form, elements, intervals=False)
    misfits = [misfit_of(who, fit, people[who]) for who, fit in fits.items()]
    missed = [one for one in misfits if not one.follows]
    by_law = law != NONE and not (law == AUTO and missed)
    if by_law:
        fits = fit_people(held, form, elements)
    rows = [fit_row(who, path.name, fit) for who, fit in fits.items()]
    if not by_law:
        kept = f"curves of {path.name}"
        named = [(who, one, "measured", f"{kept}, {len(one.presses)} presses of {who}") for who, one in people.items()]
        found = subjects_of(named)
        title = f"{len(found)} subject{'s' if len(found) > 1 else ''}, measured curves"
        tissue = Tissue(name, title, LAW, found, (), (f"{curves_words('This tissue')}.",), "user")
        said = f"{curves_words(name)}; {behind_ranges(len(found))}"
        warnings.append({"code": "measured_curves", "message": said})
        if missed:
            warnings.append({"code": "law_does_not_follow", "message": _why(missed)})
    else:
        tissue = tissue_of(name, [subject_of_fit(who, fit) for who, fit in fits.items()])
        warnings += [warning for who, fit in fits.items() for warning in fit_warnings(who, fit)]
        if missed:
            warnings.append({"code": "law_does_not_follow", "message": f"{_why(missed)}; --law none keeps the curves"})
    place = write_text(folder / f"{name}.toml", tissue_toml(tissue))
    return {
        "inputs": {"action": "add-curves", "name": name, "curves": table, "law": law, "elements": elements},
        **tissue.to_dict(), "fits": rows, "law_misfit": [one.to_dict() for one in misfits],
        "warnings": warnings + left_out + _few(tissue) + hidden, "files": {"tissue": str(place)},
    }  # fmt: skip


def _why(missed: list[Misfit]) -> str:
    return (
        "the law does not follow the curves: it misses peaks, steady forces and energies (rms) of "
        f"{', '.join(one.words for one in missed)}; more than {FOLLOWS:g} times what repeats differ by is not taken"
    )


def _few(tissue: Tissue) -> list[dict[str, str]]:
    """That one person makes no range, and one speed none at another."""
    said = []
    if len(tissue.subjects) < 2:
        text = f"{tissue.name} has one subject, who makes no range: nothing can be inside it"
        said.append({"code": "one_subject", "message": text})
    if len(tissue.velocities_mm_s) == 1:
        speed = tissue.velocities_mm_s[0]
        text = f"{tissue.name} is known at {speed:g} mm/s only: give --velocity {speed:g} where a pad is made for it"
        said.append({"code": "one_speed", "message": text})
    return said


def _held(read: dict[str, list[Trace]]) -> tuple[dict[str, list[Trace]], list[dict[str, str]]]:
    """Presses that were held long enough to end in a steady force, and a warning that names the others."""
    held: dict[str, list[Trace]] = {who: [] for who in read}
    short = []
    for who, own in read.items():
        for trace in own:
            ramp = find_ramp(trace.time_s, trace.displacement_mm)
            if ramp.hold_end_s - ramp.stop_time_s >= HELD_S:
                held[who].append(trace)
            else:
                short.append(f"{who}: {trace.name.removesuffix('.csv').replace('_', ' ')}")
    if not short:
        return held, []
    message = f"left out, held for less than {HELD_S:g} s: {', '.join(short)}"
    return held, [{"code": "hold_too_short", "message": message}]


def _unlike_told(read: dict[str, list[Trace]]) -> list[dict[str, str]]:
    """A warning that names presses which moved faster than they were told, or less than a third as fast."""
    found = []
    for who, own in read.items():
        for trace in own:
            time, x, told = trace.time_s, trace.displacement_mm, trace.told_mm_s or np.nan
            seen = approach_velocity(time, x, find_ramp(time, x))
            if not told / SLOWER < seen < FASTER * told:
                name = trace.name.removesuffix(".csv").replace("_", " ")
                found.append(f"{who}, {name}: {seen:.2g} for {told:g} mm/s")
    if not found:
        return []
    message = f"velocity_mm_s is not how these moved: {'; '.join(found)}; they count at the speed in the table"
    return [{"code": "speed_unlike_told", "message": message}]


def _traces(curves: list[Curve]) -> dict[str, list[Trace]]:
    """Curves as traces by person, each with the speed it was told, and with all that is checked of traces."""
    read: dict[str, list[Trace]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for number, curve in enumerate(curves, start=1):
            rows = zip(curve.time_s, curve.depth_mm, curve.force_N)
            text = "".join(f"{t:.9g},{x:.9g},{f:.9g}\n" for t, x, f in rows)
            file = Path(folder) / f"curve_{number}_line_{curve.line}.csv"
            file.write_text(f"time_s,displacement_mm,force_N\n{text}", encoding="utf-8")
            told = replace(read_trace(file), told_mm_s=curve.velocity_mm_s)
            read.setdefault(curve.subject, []).append(told)
    return read
