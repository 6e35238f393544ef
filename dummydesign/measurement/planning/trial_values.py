"""What is known of each press of a campaign, as a table to fill in; written into ``campaign.toml`` line by line."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import write_bytes
from dummydesign.measurement.campaign_file import FILE, TRIAL_NUMBERS, TRIAL_REQUIRED
from dummydesign.measurement.campaign_lines import CampaignLines

KEYS = (
    "sequence", "thickness_mm", "velocity_mm_s", "target_force_N", "target_depth_mm", "hold_s", "age_days",
    "temperature_C", "rest_s",
)  # fmt: skip
"""Values of a press that can be filled in."""
MARK = "\ufeff"


def read_trials(folder: str | Path) -> list[dict[str, Any]]:
    """Read the file name, the pad's shape and the values of each press; None where one is unknown.

    Parameters
    ----------
    folder : path
        Holds ``campaign.toml``; the presses need not be there yet.

    Raises
    ------
    InputError
        When the file cannot be read or has no trials.
    """
    _, data = _content(Path(folder))
    pad = data.get("pad")
    shape = pad.get("shape", "slab") if isinstance(pad, dict) else "slab"
    return [
        {"file": str(trial.get("file", "")), "shape": str(trial.get("shape", shape)),
         **{key: trial.get(key) for key in KEYS}} for trial in data["trial"]
    ]  # fmt: skip


def write_trial_values(folder: str | Path, changes: Mapping[int, Mapping[str, float | None]]) -> None:
    """Write values of presses into ``campaign.toml``; all else of the file stays.

    Parameters
    ----------
    folder : path
    changes : mapping
        Values by key for each trial, counted from 0; None for unknown.

    Raises
    ------
    InputError
        For values that are out of range, by name; nothing is written then.
    """
    path = Path(folder) / FILE
    text, data = _content(Path(folder))
    lines = text.splitlines(keepends=True)
    blocks = CampaignLines(FILE, text).blocks
    end = "\r\n" if "\r\n" in text else "\n"
    for index in sorted(changes, reverse=True):
        if not 0 <= index < len(data["trial"]):
            raise InputError(f"{FILE} has no trial {index + 1}: load the page again")
        trial = data["trial"][index]
        for key, value in changes[index].items():
            checked = _checked(key, value, str(trial.get("file", f"trial {index + 1}")))
            if checked is None:
                trial.pop(key, None)
            else:
                trial[key] = checked
            if index < len(blocks):
                _write_line(lines, *blocks[index], key, checked, end)
                blocks = CampaignLines(FILE, "".join(lines)).blocks
    after = "".join(lines)
    try:
        same = tomllib.loads(after.removeprefix(MARK)) == data
    except tomllib.TOMLDecodeError:
        same = False
    if not same:
        message = "is written in another form than [[trial]] with a line a value: change it in an editor"
        raise InputError(f"{FILE} {message}")
    write_bytes(path, after.encode())


def _content(folder: Path) -> tuple[str, dict[str, Any]]:
    try:
        text = (folder / FILE).read_bytes().decode()
        data = tomllib.loads(text.removeprefix(MARK))
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{FILE}: cannot be read as UTF-8 text: {problem}") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{FILE}: not valid TOML: {problem}") from None
    trials = data.get("trial")
    if not isinstance(trials, list) or not trials or not all(isinstance(trial, dict) for trial in trials):
        raise InputError(f"{FILE}: has no [[trial]]")
    return text, data


def _checked(key: str, value: float | None, file: str) -> float | int | None:
    if key not in KEYS:
        raise InputError(f"{file}: {unknown_name('value', key, KEYS)}")
    if value is None:
        if key in TRIAL_REQUIRED:
            raise InputError(f"{file}: {key} must not be empty")
        return None
    if not math.isfinite(value):
        raise InputError(f"{file}: {key} = {value} is not a number")
    if key == "sequence":
        if value != int(value) or value < 1:
            raise InputError(f"{file}: {key} = {value:g} must be a whole number from 1")
        return int(value)
    low, high = TRIAL_NUMBERS[key]
    if not low <= value <= high:
        raise InputError(f"{file}: {key} = {value:g} is outside the allowed range {low:g} to {high:g}")
    return float(value)


def _write_line(lines: list[str], first: int, last: int, key: str, value: float | None, end: str) -> None:
    """Write one value of a trial between two lines: over its line, over its empty comment, or as a new line."""
    last = next((at for at in range(first + 1, last) if lines[at].lstrip().startswith("[")), last)
    at = next((at for at in range(first + 1, last) if re.match(rf"\s*{key}\s*=", lines[at])), None)
    if at is None:
        at = next((at for at in range(first + 1, last) if re.match(rf"\s*#\s*{key}\s*=", lines[at])), None)
    if at is None:
        if value is None:
            return
        at = max(at for at in range(first, last) if lines[at].strip() and not lines[at].lstrip().startswith("#"))
        if not lines[at].endswith("\n"):
            lines[at] += end
        lines.insert(at + 1, f"{key} = {value!r}{end}")
        return
    given = re.match(rf"[ \t]*(?:#[ \t]*)?{key}[ \t]*=[^#\r\n]*?([ \t]*(?:#[^\r\n]*)?)(\r?\n|$)", lines[at])
    comment = given[1].rstrip() if given else ""
    lines[at] = (f"# {key} =" if value is None else f"{key} = {value!r}") + comment + (given[2] if given else end)
