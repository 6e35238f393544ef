"""Presses of a campaign: from existing files, their values as a table to fill in, what is missing or looks wrong."""

from __future__ import annotations

import csv
import math
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import reading, write_bytes
from dummydesign.measurement.campaign import held_force
from dummydesign.measurement.campaign_file import (
    FILE,
    TRIAL_NUMBERS,
    TRIAL_REQUIRED,
    read_campaign,
    read_campaign_toml,
    trial_tables,
)
from dummydesign.measurement.importing.press_checks import copies_among, doubts_of
from dummydesign.measurement.ramp_detection import planned_velocity, ramp_of
from dummydesign.measurement.trace import Trace, read_trace

KEYS = (
    "sequence",
    "thickness_mm",
    "velocity_mm_s",
    "target_force_N",
    "target_depth_mm",
    "hold_s",
    "age_days",
    "temperature_C",
    "rest_s",
)
"""Values of a press that can be filled in."""
MARK = "\ufeff"


def read_trials(folder: str | Path) -> list[dict[str, Any]]:
    """Read the file name, the pad's shape and the values of each press; None where one is unknown."""
    top = read_campaign_toml(Path(folder))
    pad = top.data.get("pad")
    shape = pad.get("shape", "slab") if isinstance(pad, dict) else "slab"
    return [
        {
            "file": str(trial.get("file", "")),
            "shape": str(trial.get("shape", shape)),
            **{key: trial.get(key) for key in KEYS},
        }
        for trial in (table.data for table in trial_tables(top))
    ]


def write_trial_values(folder: str | Path, changes: Mapping[int, Mapping[str, float | None]]) -> None:
    """Write values of presses into ``campaign.toml``; all else of the file stays."""
    path = Path(folder) / FILE
    top = read_campaign_toml(Path(folder))
    trials = [table.data for table in trial_tables(top)]
    text = path.read_bytes().decode()
    lines = text.splitlines(keepends=True)
    end = "\r\n" if "\r\n" in text else "\n"
    for index in sorted(changes, reverse=True):
        if not 0 <= index < len(trials):
            raise InputError(
                f"{FILE} has no trial {index + 1}: load the page again",
                "changed_meanwhile",
                "campaign.trials",
                index + 1,
            )
        trial = trials[index]
        for key, value in changes[index].items():
            checked = _check_value(key, value, str(trial.get("file", f"trial {index + 1}")))
            trial[key] = checked
            if checked is None:
                del trial[key]
            heads = [at for at, line in enumerate(lines) if line.strip().startswith("[[trial]]")]
            if index < len(heads):
                _write_line(lines, heads[index], key, checked, end)
    after = "".join(lines)
    try:
        same = tomllib.loads(after.removeprefix(MARK)) == top.data
    except tomllib.TOMLDecodeError:
        same = False
    if not same:
        message = "is written in another form than [[trial]] with a line a value: change it in an editor"
        raise InputError(f"{FILE} {message}", "unsupported", "campaign")
    write_bytes(path, after.encode())


def _check_value(key: str, value: float | None, file: str) -> float | int | None:
    if key not in KEYS:
        raise unknown_name("value", key, KEYS, "unknown_key", "trial").within(file)
    name = f"trial.{key}"
    if value is None:
        if key in TRIAL_REQUIRED:
            raise InputError(f"{file}: {key} must not be empty", "missing", name)
        return None
    low, high = TRIAL_NUMBERS.get(key, (1, math.inf))
    if not (math.isfinite(value) and low <= value <= high and (key != "sequence" or value == int(value))):
        allowed = "a whole number from 1" if key == "sequence" else f"a number from {low:g} to {high:g}"
        raise InputError(f"{file}: {key} = {value:g} must be {allowed}", "out_of_range", name, value, (low, high))
    return int(value) if key == "sequence" else float(value)


def _write_line(lines: list[str], head: int, key: str, value: float | None, end: str) -> None:
    """Write one value of the trial at a head: over its line, over its empty comment, or as a new line."""
    last = next((at for at in range(head + 1, len(lines)) if lines[at].lstrip().startswith("[")), len(lines))
    given, empty = (
        next((at for at in range(head + 1, last) if re.match(rf"\s*{mark}{key}\s*=", lines[at])), None)
        for mark in ("", r"#\s*")
    )
    at = empty if given is None else given
    if at is not None:
        match = re.match(rf"[ \t]*(?:#[ \t]*)?{key}[ \t]*=[^#\r\n]*?([ \t]*(?:#[^\r\n]*)?)(\r?\n|$)", lines[at])
        comment, newline = (match[1].rstrip(), match[2]) if match else ("", end)
        lines[at] = (f"# {key} =" if value is None else f"{key} = {value!r}") + comment + newline
    elif value is not None:
        at = max(at for at in range(head, last) if lines[at].strip() and not lines[at].lstrip().startswith("#"))
        if not lines[at].endswith("\n"):
            lines[at] += end
        lines.insert(at + 1, f"{key} = {value!r}{end}")


CONDITION = ("thickness_mm", "velocity_mm_s", "target_force_N", "target_depth_mm")
COLUMNS = (
    *("file", *CONDITION, "hold_s", "repeat", "sequence"),
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
    """Find what was pressed in each file: by the table, else by its name, else by its trace or what holds for all."""
    paths = [Path(file) for file in files]
    names = [path.name for path in paths]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(
            f"two files are called '{twice}'; a campaign holds plain file names, each once", "duplicate", "file", twice
        )
    rows = {} if table is None else read_table(Path(table), names)
    trials, decisions = [], []
    repeats: Counter[tuple[Any, ...]] = Counter()
    for path in paths:
        trial, why = _trial(path, rows.get(path.name, {}), thickness_mm)
        condition = tuple(trial.get(key) for key in CONDITION)
        repeats[condition] += 1
        trial.setdefault("repeat", repeats[condition])
        words = f"{trial['thickness_mm']:g} mm pad, {trial['velocity_mm_s']:g} mm/s"
        words += f", {trial['target_force_N']:g} N" if "target_force_N" in trial else ""
        words += f", {trial['target_depth_mm']:g} mm deep" if "target_depth_mm" in trial else ""
        decisions.append({"what": path.name, "value": f"{words}, repeat {trial['repeat']}", "why": why})
        trials.append(trial)
    if all("sequence" in trial for trial in trials):
        trials.sort(key=lambda trial: trial["sequence"])
    return trials, decisions


def _trial(path: Path, row: Mapping[str, Any], thickness_mm: float | None) -> tuple[dict[str, Any], str]:
    named = ({} if thickness_mm is None else {"thickness_mm": thickness_mm}) | named_values(path)
    known = {**named, **row}
    trace = read_trace(path, known.get("velocity_mm_s"))
    if "thickness_mm" not in known:
        raise InputError(
            f"{path.name}: how thick was the pad? the name does not say (such as t05_v010_f05_1.csv); "
            "give --table trials.csv with file,thickness_mm,..., or --thickness MM for all files",
            "missing",
            "thickness_mm",
        )
    sources = [word for word, used in (("table", row), ("name", set(named) - set(row))) if used]
    if "velocity_mm_s" not in known:
        known["velocity_mm_s"] = float(f"{ramp_of(trace).speed.value_mm_s:.2g}")
        sources.append("speed as the trace moves")
    return {"file": path.name, **{key: known[key] for key in COLUMNS[1:] if key in known}}, ", ".join(sources)


def named_values(path: Path) -> dict[str, Any]:
    """Return what the name of a file tells of its press."""
    matches = {key: pattern.search(path.stem) for key, pattern in _IN_NAME.items()}
    return {key: int(one[1]) if key in _WHOLE else float(one[1]) for key, one in matches.items() if one}


def read_table(path: Path, names: Sequence[str] | None = None) -> dict[str, dict[str, Any]]:
    """Read what a table of trials says of each file; of those named alone, where they are known."""
    with reading("table", path, "table"):
        text = path.read_text(encoding="utf-8-sig")
    lines = list(csv.reader(text.splitlines()))
    head = [cell.strip() for cell in lines[0]] if lines else []
    if "file" not in head:
        raise InputError(
            f"{path.name}: needs a column 'file', comma-separated; known are {', '.join(COLUMNS)}", "missing", "file"
        )
    if unknown := [name for name in head if name not in COLUMNS]:
        raise unknown_name("column", unknown[0], COLUMNS, "unknown_key", "table").within(f"{path.name}:1")
    rows: dict[str, dict[str, Any]] = {}
    for number, cells in enumerate(lines[1:], start=2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(head):
            raise InputError(
                f"{path.name}:{number}: {len(cells)} cells, the header has {len(head)}",
                "malformed",
                "table",
                len(cells),
                len(head),
            )
        row = {key: cell.strip() for key, cell in zip(head, cells) if cell.strip()}
        file = row.pop("file", "")
        if names is not None and file not in names:
            raise unknown_name("file", file, names).within(f"{path.name}:{number}")
        if file in rows:
            raise InputError(f"{path.name}:{number}: '{file}' is listed twice", "duplicate", "file", file)
        rows[file] = {key: _cell(key, cell, path, number) for key, cell in row.items()}
    return rows


def _cell(key: str, cell: str, path: Path, number: int) -> Any:
    if key == "unload" and cell.lower() in ("true", "false", "yes", "no", "1", "0"):
        return cell.lower() in ("true", "yes", "1")
    try:
        return int(cell) if key in _WHOLE else float(cell)
    except ValueError:
        raise InputError(f"{path.name}:{number}: {key} = '{cell}' is not a number", "not_a_number", key, cell) from None


FORCE_SHARE, SPEED_SHARE, HOLD_SHARE, DEPTH_SHARE = 0.3, 0.2, 0.8, 0.2
"""Steady force, speed and depth may differ by so much from what was planned; holds may be this share of it."""

OWN_TABLES = ("trials.csv", "sheet.csv")
"""Tables in the folder of a campaign that are no presses."""


@dataclass(frozen=True)
class CampaignStatus:
    """How far a campaign is: files pressed, files to press, and what is wrong ({code, file, message})."""

    name: str
    pressed: tuple[str, ...]
    missing: tuple[str, ...]
    wrong: tuple[dict[str, str], ...]
    warnings: tuple[dict[str, str], ...]

    @property
    def ready(self) -> bool:
        """Whether ``loop`` can read it and nothing looks wrong."""
        return not self.missing and not self.wrong


def check_campaign(folder: str | Path) -> CampaignStatus:
    """Check a campaign folder, also one that is pressed in part."""
    folder = Path(folder)
    top = read_campaign_toml(folder)
    trials = [table.data for table in trial_tables(top)]
    wrong: list[dict[str, str]] = []
    warnings: list[dict[str, str]] = []
    pressed: list[str] = []
    missing: list[str] = []
    traces: list[Trace] = []

    def problem(code: str, file: str, message: object) -> None:
        wrong.append({"code": code, "file": file, "message": str(message).removeprefix(f"{file}: ")})

    for number, trial in enumerate(trials, start=1):
        name = trial.get("file")
        if not isinstance(name, str) or not name.strip() or Path(name).name != name:
            problem("file_name", FILE, f"trial {number} has no plain file name")
        elif not (folder / name).is_file():
            missing.append(name)
        else:
            pressed.append(name)
            try:
                trace = read_trace(folder / name, _positive(trial, "velocity_mm_s") or None)
                for message in differences_from_plan(trace, trial):
                    problem("not_as_planned", name, message)
                traces.append(trace)
            except InputError as fault:
                problem("not_readable", name, fault)
    sensor = top.data.get("sensor")
    resolution = _positive(sensor, "force_resolution_N") if isinstance(sensor, dict) else 0.0
    for trace in traces:
        for doubt in doubts_of(trace, resolution):
            if doubt["code"] == "hold_too_short":  # a matter of the plan
                warnings.append(doubt)
            else:
                problem(doubt["code"], trace.name, doubt["message"])
    for copy in copies_among(traces):
        problem(copy["code"], "", copy["message"])
    for key in ("temperature_C", "age_days", "rest_s", "sequence"):
        if lacking := [trial["file"] for trial in trials if trial.get("file") in pressed and key not in trial]:
            some = ", ".join(lacking[:3]) + (f" and {len(lacking) - 3} more" if len(lacking) > 3 else "")
            warnings.append(
                {"code": f"no_{key}", "message": f"{key} is missing for {some}: fill it in before you learn"}
            )
    listed = {*(str(trial.get("file")) for trial in trials), *OWN_TABLES}
    if extra := sorted(path.name for path in folder.glob("*.csv") if path.name not in listed):
        message = f"in the folder and in no trial: {', '.join(extra[:5])}{' ...' if len(extra) > 5 else ''}"
        warnings.append({"code": "not_listed", "message": message})
    if not missing and not wrong:
        try:
            read_campaign(folder)
        except InputError as fault:
            wrong.append({"code": "campaign_file", "file": FILE, "message": str(fault)})
    name = str(top.data.get("name", folder.name))
    return CampaignStatus(name, tuple(pressed), tuple(missing), tuple(wrong), tuple(warnings))


def _positive(table: dict[str, Any], key: str) -> float:
    """A number above 0, else 0; whoever reads the campaign refuses another entry."""
    value = table.get(key)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and value > 0 else 0.0


def differences_from_plan(trace: Trace, trial: dict[str, Any]) -> Iterator[str]:
    """Return the differences between a press and what was planned."""
    ramp = ramp_of(trace)
    differences = {
        "velocity_mm_s": (planned_velocity(ramp, _positive(trial, "velocity_mm_s")), SPEED_SHARE, "mm/s"),
        "target_force_N": (held_force(trace, ramp), FORCE_SHARE, "N in the hold"),
        "target_depth_mm": (ramp.depth_mm, DEPTH_SHARE, "mm"),
    }
    for key, (value, share, unit) in differences.items():
        wanted = trial.get(key)
        if isinstance(wanted, int | float) and wanted > 0 and abs(value / wanted - 1.0) > share:
            yield f"{value:.3g} {unit}, planned {wanted:g}; press again, or write what was meant into {FILE}"
    hold = trial.get("hold_s")
    if isinstance(hold, int | float) and ramp.hold_end_s - ramp.stop_time_s < HOLD_SHARE * hold:
        yield f"held for {ramp.hold_end_s - ramp.stop_time_s:.3g} s, planned {hold:g} s"
    after = trace.displacement_mm[trace.time_s > ramp.hold_end_s]
    if trial.get("unload") is True and not (len(after) and after.min() < 0.2 * ramp.depth_mm):
        yield "the way back was planned and is not recorded"
