"""A campaign from files one has: their names, a table of trials, or what is said of all of them."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.measurement.landmarks import approach_velocity, find_ramp
from dummydesign.measurement.trace import Trace, read_trace

COLUMNS = (
    *("file", "thickness_mm", "velocity_mm_s", "target_force_N", "target_depth_mm", "hold_s", "repeat", "sequence"),
    *("rest_s", "temperature_C", "age_days", "unload"),
)
_WHOLE = ("repeat", "sequence")
_NUMBER = r"(\d+(?:\.\d+)?)"
_IN_NAME = {
    "thickness_mm": re.compile(rf"(?:^|[_ -])[th]{_NUMBER}(?:mm)?(?=[_ .-]|$)", re.IGNORECASE),
    "velocity_mm_s": re.compile(rf"(?:^|[_ -])v{_NUMBER}(?=[_ .-]|$)", re.IGNORECASE),
    "target_force_N": re.compile(rf"(?:^|[_ -])f{_NUMBER}N?(?=[_ .-]|$)", re.IGNORECASE),
    "target_depth_mm": re.compile(rf"(?:^|[_ -])d{_NUMBER}(?:mm)?(?=[_ .-]|$)", re.IGNORECASE),
    "repeat": re.compile(r"[_-](\d{1,3})$"),
}


def trials_of(
    files: Sequence[str | Path], table: str | Path | None, thickness_mm: float | None
) -> tuple[list[dict[str, Any]], list[dict[str, str]]]:
    """Say of each file what was pressed: by the table, else by its name, else by its trace or what holds for all.

    Parameters
    ----------
    files : sequence of path
        Traces.
    table : path, optional
        CSV with ``file`` and any of :data:`COLUMNS`.
    thickness_mm : float, optional
        Of the pad of files whose name and row do not say. [mm]

    Returns
    -------
    trials : list of dict
        In the order of ``sequence`` where it is known, else of the files.
    decisions : list of {what, value, why}

    Raises
    ------
    InputError
        For a file that is no trace, and for what is left open, with the option that settles it.
    """
    paths = [Path(file) for file in files]
    names = [path.name for path in paths]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise InputError(f"two files are called '{twice}'; a campaign holds plain file names, each once")
    rows = {} if table is None else _read_table(Path(table), names)
    trials, decisions = [], []
    for path in paths:
        row = rows.get(path.name, {})
        trace = read_trace(path, row.get("velocity_mm_s", named_values(path).get("velocity_mm_s")))
        trial, why = _trial(path, trace, row, thickness_mm)
        trials.append(trial)
        decisions.append({"what": path.name, "value": _words(trial), "why": why})
    _number_repeats(trials)
    if all("sequence" in trial for trial in trials):
        trials.sort(key=lambda trial: trial["sequence"])
    return trials, decisions


def _trial(
    path: Path, trace: Trace, row: Mapping[str, Any], thickness_mm: float | None
) -> tuple[dict[str, Any], str]:
    named = named_values(path)
    if thickness_mm is not None:
        named.setdefault("thickness_mm", thickness_mm)
    known = {**named, **row}
    if "thickness_mm" not in known:
        raise InputError(
            f"{path.name}: how thick was the pad? the name does not say (such as t05_v010_f05_1.csv); give "
            "--table trials.csv with file,thickness_mm,..., or --thickness MM for all files"
        )
    sources = ["table"] if row else []
    sources += ["name"] if set(named) - set(row) else []
    if "velocity_mm_s" not in known:
        try:
            ramp = find_ramp(trace.time_s, trace.displacement_mm, "slowed")
        except InputError as problem:
            raise InputError(f"{path.name}: {problem}") from None
        speed = approach_velocity(trace.time_s, trace.displacement_mm, ramp)
        known["velocity_mm_s"] = float(f"{speed:.2g}")
        sources.append("speed as the trace moves")
    trial = {"file": path.name, **{key: known[key] for key in COLUMNS[1:] if key in known}}
    return trial, ", ".join(sources)


def named_values(path: Path) -> dict[str, Any]:
    """What the name of a file says of its press."""
    named: dict[str, Any] = {}
    for key, pattern in _IN_NAME.items():
        found = pattern.search(path.stem)
        if found:
            named[key] = int(found[1]) if key in _WHOLE else float(found[1])
    return named


def _number_repeats(trials: list[dict[str, Any]]) -> None:
    """Count presses of one condition where nothing numbers them."""
    seen: dict[tuple[Any, ...], int] = {}
    for trial in trials:
        keys = ("thickness_mm", "velocity_mm_s", "target_force_N", "target_depth_mm")
        condition = tuple(trial.get(key) for key in keys)
        seen[condition] = seen.get(condition, 0) + 1
        trial.setdefault("repeat", seen[condition])


def _words(trial: Mapping[str, Any]) -> str:
    text = f"{trial['thickness_mm']:g} mm pad, {trial['velocity_mm_s']:g} mm/s"
    if "target_force_N" in trial:
        text += f", {trial['target_force_N']:g} N"
    if "target_depth_mm" in trial:
        text += f", {trial['target_depth_mm']:g} mm deep"
    return f"{text}, repeat {trial.get('repeat', 1)}"


def _read_table(path: Path, names: Sequence[str]) -> dict[str, dict[str, Any]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"table '{path}' cannot be read as UTF-8 text: {problem}") from None
    lines = list(csv.reader(text.splitlines()))
    head = [cell.strip() for cell in lines[0]] if lines else []
    if "file" not in head:
        raise InputError(f"{path.name}: needs a column 'file' parted by commas; known are {', '.join(COLUMNS)}")
    for name in head:
        if name not in COLUMNS:
            raise InputError(f"{path.name}:1: {unknown_name('column', name, COLUMNS)}")
    rows: dict[str, dict[str, Any]] = {}
    for number, cells in enumerate(lines[1:], start=2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(head):
            raise InputError(f"{path.name}:{number}: {len(cells)} cells, the header has {len(head)}")
        row = {key: cell.strip() for key, cell in zip(head, cells) if cell.strip()}
        file = row.pop("file", "")
        if file not in names:
            raise InputError(f"{path.name}:{number}: {unknown_name('file', file, names)}")
        if file in rows:
            raise InputError(f"{path.name}:{number}: '{file}' stands in two rows")
        rows[file] = {key: _cell(key, cell, path, number) for key, cell in row.items()}
    return rows


def _cell(key: str, cell: str, path: Path, number: int) -> Any:
    if key == "unload" and cell.lower() in ("true", "false", "yes", "no", "1", "0"):
        return cell.lower() in ("true", "yes", "1")
    try:
        return int(cell) if key in _WHOLE else float(cell)
    except ValueError:
        raise InputError(f"{path.name}:{number}: {key} = '{cell}' is not a number") from None
