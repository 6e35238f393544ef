"""What of a campaign is not yet pressed, and what looks wrong in what is there."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_file import FILE, read_campaign
from dummydesign.measurement.landmarks import approach_velocity, find_ramp
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.measurement.trace_checks import copies_among, doubts_of

FORCE_SHARE, SPEED_SHARE, HOLD_SHARE, DEPTH_SHARE = 0.3, 0.2, 0.8, 0.2
"""Steady force, speed and depth may differ by so much from what was planned; holds may be this share of it."""

OWN_TABLES = ("trials.csv", "sheet.csv")
"""Tables in the folder of a campaign that are no presses."""


@dataclass(frozen=True)
class Status:
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


def check_campaign(folder: str | Path) -> Status:
    """Check a campaign folder, also one that is pressed in part.

    Raises
    ------
    InputError
        When there is no campaign file, or it is not TOML with trials.
    """
    folder = Path(folder)
    data = _content(folder)
    trials = data["trial"]
    wrong: list[dict[str, str]] = []
    pressed: list[str] = []
    missing: list[str] = []
    traces: list[Trace] = []
    for number, trial in enumerate(trials, start=1):
        name = trial.get("file")
        if not isinstance(name, str) or not name.strip() or Path(name).name != name:
            wrong.append(_problem("file_name", FILE, f"trial {number} has no plain file name"))
            continue
        if not (folder / name).is_file():
            missing.append(name)
            continue
        pressed.append(name)
        try:
            trace = read_trace(folder / name, _speed(trial))
            wrong += [_problem("not_as_planned", name, message) for message in differences_from_plan(trace, trial)]
            traces.append(trace)
        except InputError as problem:
            wrong.append(_problem("not_readable", name, str(problem).removeprefix(f"{name}: ")))
    warnings: list[dict[str, str]] = []
    resolution = _resolution(data.get("sensor"))
    for trace in traces:
        for doubt in doubts_of(trace, resolution):
            if doubt["code"] == "hold_too_short":  # a matter of the plan
                warnings.append(doubt)
            else:
                wrong.append(_problem(doubt["code"], trace.name, doubt["message"].removeprefix(f"{trace.name}: ")))
    wrong += [_problem(copy["code"], "", copy["message"]) for copy in copies_among(traces)]
    for key in ("temperature_C", "age_days", "rest_s", "sequence"):
        lacking = [trial["file"] for trial in trials if trial.get("file") in pressed and key not in trial]
        if lacking:
            some = ", ".join(lacking[:3]) + (f" and {len(lacking) - 3} more" if len(lacking) > 3 else "")
            warnings.append({"code": f"no_{key}", "message": f"{key} is not written down for {some}"})
    listed = {trial.get("file") for trial in trials}
    extra = sorted(path.name for path in folder.glob("*.csv") if path.name not in {*listed, *OWN_TABLES})
    if extra:
        message = f"in the folder and in no trial: {', '.join(extra[:5])}{' ...' if len(extra) > 5 else ''}"
        warnings.append({"code": "not_listed", "message": message})
    if not missing and not wrong:
        try:
            read_campaign(folder)
        except InputError as problem:
            wrong.append(_problem("campaign_file", FILE, str(problem)))
    return Status(str(data.get("name", folder.name)), tuple(pressed), tuple(missing), tuple(wrong), tuple(warnings))


def _problem(code: str, file: str, message: str) -> dict[str, str]:
    return {"code": code, "file": file, "message": message}


def _resolution(sensor: object) -> float:
    """The declared step of the force; whoever reads the campaign says what is wrong with another entry. [N]"""
    value = sensor.get("force_resolution_N") if isinstance(sensor, dict) else None
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and value > 0 else 0.0


def _content(folder: Path) -> dict[str, Any]:
    try:
        data = tomllib.loads((folder / FILE).read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise InputError(f"campaign folder '{folder}' has no {FILE}; 'dummydesign campaign new' makes one") from None
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{FILE}: cannot be read as UTF-8 text: {problem}") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{FILE}: not valid TOML: {problem}") from None
    trials = data.get("trial")
    if not isinstance(trials, list) or not trials or not all(isinstance(trial, dict) for trial in trials):
        raise InputError(f"{FILE}: has no [[trial]]")
    return data


def _speed(trial: dict[str, Any]) -> float | None:
    """The declared speed, where it is one; whoever reads the campaign says what is wrong with another. [mm/s]"""
    value = trial.get("velocity_mm_s")
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and value > 0 else None


def differences_from_plan(trace: Trace, trial: dict[str, Any]) -> Iterator[str]:
    """Differences between a press and what was planned."""
    ramp = find_ramp(trace.time_s, trace.displacement_mm, "slowed")
    held = (trace.time_s >= ramp.hold_end_s - 0.2 * (ramp.hold_end_s - ramp.stop_time_s)) & (
        trace.time_s <= ramp.hold_end_s
    )
    found = {
        "velocity_mm_s": (approach_velocity(trace.time_s, trace.displacement_mm, ramp), SPEED_SHARE, "mm/s"),
        "target_force_N": (float(np.median(trace.force_N[held])), FORCE_SHARE, "N in the hold"),
        "target_depth_mm": (ramp.depth_mm, DEPTH_SHARE, "mm"),
    }
    for key, (value, share, unit) in found.items():
        wanted = trial.get(key)
        if isinstance(wanted, int | float) and wanted > 0 and abs(value / wanted - 1.0) > share:
            yield f"{value:.3g} {unit}, planned {wanted:g}; press again, or write what was meant into {FILE}"
    hold = trial.get("hold_s")
    if isinstance(hold, int | float) and ramp.hold_end_s - ramp.stop_time_s < HOLD_SHARE * hold:
        yield f"held for {ramp.hold_end_s - ramp.stop_time_s:.3g} s, planned {hold:g} s"
    after = trace.displacement_mm[trace.time_s > ramp.hold_end_s]
    if trial.get("unload") is True and not (len(after) and after.min() < 0.2 * ramp.depth_mm):
        yield "the way back was planned and is not recorded"
