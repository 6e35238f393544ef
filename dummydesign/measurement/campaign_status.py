"""What of a campaign is not yet pressed, and what looks wrong in what is there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign import held_force
from dummydesign.measurement.campaign_file import FILE, read_campaign, read_campaign_toml, trial_tables
from dummydesign.measurement.importing.press_checks import copies_among, doubts_of
from dummydesign.measurement.ramp_detection import planned_velocity, ramp_of
from dummydesign.measurement.trace import Trace, read_trace

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
        lacking = [trial["file"] for trial in trials if trial.get("file") in pressed and key not in trial]
        if lacking:
            some = ", ".join(lacking[:3]) + (f" and {len(lacking) - 3} more" if len(lacking) > 3 else "")
            warnings.append(
                {"code": f"no_{key}", "message": f"{key} is missing for {some}: fill it in before you learn"}
            )
    listed = {*(str(trial.get("file")) for trial in trials), *OWN_TABLES}
    extra = sorted(path.name for path in folder.glob("*.csv") if path.name not in listed)
    if extra:
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
    sent = planned_velocity(ramp, _positive(trial, "velocity_mm_s"))
    differences = {
        "velocity_mm_s": (sent, SPEED_SHARE, "mm/s"),
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
