"""``tissues add-curves``: a tissue from one table of curves, by a law where it follows them, else by the curves."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.own_files import make_room
from dummydesign.measurement.landmarks import find_ramp
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.measurement.trace_checks import copies_among
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.model.curve_numbers import subjects_of
from dummydesign.tissue.model.laws import DEFAULT, fitted_law
from dummydesign.tissue.model.laws.curves import curves_words
from dummydesign.tissue.model.measured_curves import LAW
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import KIND, tissue_toml
from dummydesign.tissue.population.cells import read_cells
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
COLUMNS = ("subject", "velocity_mm_s", "time_s", "depth_mm", "force_N")
FEWEST, HELD_S = 10, 0.5
CONTRADICTION = 1.5
"""Forces of one person at one depth and speed that differ by more than this factor contradict each other."""
SAME_SPEED = 1.05


@dataclass(frozen=True)
class Curve:
    """One press of one person: the line it begins at, and arrays of shape (n,)."""

    subject: str
    velocity_mm_s: float
    line: int
    time_s: NDArray
    depth_mm: NDArray
    force_N: NDArray

    @property
    def held_s(self) -> float:
        """Time after the depth has come within 1 % of its largest. [s]"""
        deep = np.nonzero(self.depth_mm >= 0.99 * self.depth_mm.max())[0]
        return float(self.time_s[-1] - self.time_s[deep[0]])

    def rising_force_N(self, depth_mm: float) -> float:
        """Force when the depth is first reached. [N]"""
        last = int(np.argmax(self.depth_mm >= depth_mm))
        rows = slice(max(last - 1, 0), last + 1)
        return float(np.interp(depth_mm, self.depth_mm[rows], self.force_N[rows]))


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
    read, speeds = _traces(curves)
    warnings = copies_among([replace(one, name=f"{who}: {one.name}") for who, own in read.items() for one in own])
    held, left_out = _held(read)
    people = {
        who: person_of([reduce_trace(trace) for trace in own], [speeds[trace.name] for trace in own])
        for who, own in held.items()
    }
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
        warnings.append({"code": "measured_curves", "message": curves_words(name)})
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


def _traces(curves: list[Curve]) -> tuple[dict[str, list[Trace]], dict[str, float]]:
    """Curves as traces by person, with all that is checked of traces, and the speed of each. [mm/s]"""
    read: dict[str, list[Trace]] = {}
    speeds: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        for number, curve in enumerate(curves, start=1):
            rows = zip(curve.time_s, curve.depth_mm, curve.force_N)
            text = "".join(f"{t:.9g},{x:.9g},{f:.9g}\n" for t, x, f in rows)
            file = Path(folder) / f"curve_{number}_line_{curve.line}.csv"
            file.write_text(f"time_s,displacement_mm,force_N\n{text}", encoding="utf-8")
            read.setdefault(curve.subject, []).append(read_trace(file))
            speeds[file.name] = curve.velocity_mm_s
    return read, speeds


def read_curves(path: Path) -> list[Curve]:
    """Read a table of curves.

    Raises
    ------
    InputError
        With file and line.
    """
    header, rows = read_cells(path, "curves", skip_space=True)
    for column in COLUMNS:
        if column not in header and column != "time_s":
            raise InputError(f"{path.name}:1: column '{column}' is missing; the header must be {','.join(COLUMNS)}")
    groups: list[tuple[str, float, int, list[list[float]]]] = []
    before: tuple[str, float, str] | None = None
    for line, row in rows:
        subject = (row["subject"] or "").strip()
        if not subject:
            raise InputError(f"{path.name}:{line}: has no subject")
        speed = _number(row, "velocity_mm_s", path, line)
        if not speed > 0.0:
            raise InputError(f"{path.name}:{line}: velocity_mm_s = {speed:g} must be above 0")
        values = [_number(row, key, path, line) for key in ("time_s", "depth_mm", "force_N")]
        here = (subject, speed, (row.get("press") or "").strip())
        back = bool(groups) and values[0] <= groups[-1][3][-1][0]
        if here != before or back:
            groups.append((subject, speed, line, []))
        groups[-1][3].append(values)
        before = here
    if not groups:
        raise InputError(f"{path.name}: holds no curve")
    return [_curve(path, *group) for group in groups]


def _number(row: dict[str, str], key: str, path: Path, line: int) -> float:
    """A cell as a number; a missing time is NaN."""
    text = (row.get(key) or "").strip()
    if not text and key == "time_s":
        return math.nan
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path.name}:{line}: {key} = '{text}' is not a number")
    return value


def _curve(path: Path, subject: str, speed: float, line: int, rows: list[list[float]]) -> Curve:
    where = f"{path.name}:{line}: subject {subject} at {speed:g} mm/s"
    if len(rows) < FEWEST:
        raise InputError(f"{where}: the curve has {len(rows)} rows; at least {FEWEST} are needed")
    time, depth, force = np.array(rows).T
    if np.isnan(time).all():
        if np.any(np.diff(depth) <= 0.0):
            raise InputError(f"{where}: without time_s the depth must rise from row to row")
        time = (depth - depth[0]) / speed
    elif np.isnan(time).any():
        raise InputError(f"{where}: time_s is given in some rows and not in others")
    if not (depth.max() > 0.05 and force.max() > 0.0):
        raise InputError(f"{where}: nothing is pressed (depth to {depth.max():g} mm, force to {force.max():g} N)")
    return Curve(subject, speed, line, time, depth, force)


def check_curves(curves: list[Curve], file: str) -> None:
    """Refuse curves of one person that contradict each other, or of which none is held.

    Raises
    ------
    InputError
        Naming the two lines and forces.
    """
    for number, first in enumerate(curves):
        for second in curves[number + 1 :]:
            slow, fast = sorted((first, second), key=lambda curve: curve.velocity_mm_s)
            depth = 0.8 * float(min(first.depth_mm.max(), second.depth_mm.max()))
            forces = slow.rising_force_N(depth), fast.rising_force_N(depth)
            ratio = forces[0] / max(forces[1], 1e-12)
            same = fast.velocity_mm_s <= SAME_SPEED * slow.velocity_mm_s
            if ratio > CONTRADICTION or (same and ratio < 1.0 / CONTRADICTION):
                why = "the same speed" if same else "the slower press carries more"
                raise InputError(
                    f"{file}: curves of {first.subject} contradict each other at {depth:.2g} mm: {forces[0]:.3g} N at "
                    f"{slow.velocity_mm_s:g} mm/s (line {slow.line}) and {forces[1]:.3g} N at "
                    f"{fast.velocity_mm_s:g} mm/s (line {fast.line}), {why}; name them as two subjects or leave one out"
                )
    if all(curve.held_s < HELD_S for curve in curves):
        raise InputError(
            f"{file}: no curve of {curves[0].subject} is held for {HELD_S:g} s, so the steady force is not known; give "
            "the hold with its times, or depths at steady forces by 'dummydesign tissues add-points'"
        )
