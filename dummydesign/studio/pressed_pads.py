"""Pads that were cast and pressed: of campaigns, of imported files, of files that were dropped; and their records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_file import read_campaign_toml
from dummydesign.measurement.campaign_from_files import read_trials
from dummydesign.studio import choices, made
from dummydesign.studio import file_transfer as files
from dummydesign.studio.state import State

SIZE = ("shape", "thickness_mm")
DROPPED = "measured/cast-pad"
"""Where presses go that are dropped for a comparison."""


@dataclass(frozen=True)
class PressedPad:
    """A pad with its presses."""

    label: str
    files: tuple[str, ...]
    punch: str
    lowpass: str = ""
    campaign: str = ""
    shape: str = ""
    thickness_mm: float | None = None


@dataclass(frozen=True)
class GaugePoint:
    """Where the thickness of a cast pad is gauged, and what it may be. [mm]"""

    name: str
    low_mm: float
    high_mm: float


def pads(root: Path, state: State) -> list[PressedPad]:
    """Every pad of the project with presses: those of the chosen campaign first, then others, then loose files."""
    known = choices.campaigns(root)
    own_first = sorted(known, key=lambda name: name != state.campaign)
    found = [pad for name in own_first for pad in _of_campaign(root, name)]
    loose = [(DROPPED, "files dropped here"), *(
        (path.relative_to(root).as_posix(), f"{path.name} of the measured files")
        for path in sorted((root / "measured").glob("import-*")) if path.is_dir()
    )]  # fmt: skip
    for folder, words in loose:
        presses = tuple(sorted(path.relative_to(root).as_posix() for path in (root / folder).glob("*.csv")))
        if presses:
            found.append(PressedPad(f"{words}: {_count(presses)}", presses, state.punch))
    return found


def nearest(found: Sequence[PressedPad], state: State) -> PressedPad | None:
    """The pad that is chosen, where one of this shape and thickness was pressed; else the first."""
    same = [one for one in found
            if one.thickness_mm is not None and made.same_pad(vars(one), vars(state), SIZE)]  # fmt: skip
    return next(iter([*same, *found]), None)


def keep_press(root: Path, name: str, content: bytes) -> str:
    """Keep a trace that was dropped; return its path from the project folder on."""
    files.plain_name(name)
    files.check_press(name, content)
    return files.save_upload(files.inside(root, DROPPED), name, content).relative_to(root).as_posix()


def records(root: Path, pad: PressedPad) -> list[str]:
    """Records of castings whose mould is of this pad, the newest last."""
    found = []
    for mould in made.moulds(root):
        if pad.thickness_mm is None or made.same_pad(mould.pad, vars(pad), SIZE):
            paths = sorted((root / mould.folder).glob("record*.json"), key=lambda path: path.stat().st_mtime)
            found += [path.relative_to(root).as_posix() for path in paths]
    return found


def gauge_points(folder: Path) -> list[GaugePoint]:
    """Gauge points of a mould; empty where its specification cannot be read."""
    points = files.read_json(folder / "spec.json").get("gauge_points", [])
    try:
        return [GaugePoint(str(one["name"]), float(one["low_mm"]), float(one["high_mm"])) for one in points]
    except (ValueError, KeyError, TypeError):
        return []


def _count(presses: Sequence[str]) -> str:
    return f"{len(presses)} press{'es' * (len(presses) != 1)}"


def _of_campaign(root: Path, folder: str) -> list[PressedPad]:
    try:
        trials = read_trials(root / folder)
        data = read_campaign_toml(root / folder).data
    except InputError:
        return []
    by_pad: dict[tuple[str, float], list[str]] = {}
    for trial in trials:
        thickness = trial["thickness_mm"]
        if isinstance(thickness, int | float) and trial["file"] and (root / folder / trial["file"]).is_file():
            by_pad.setdefault((trial["shape"], float(thickness)), []).append(f"{folder}/{trial['file']}")
    punch, lowpass = _punch(data.get("punch"), folder), _lowpass(data.get("sensor"))
    return [
        PressedPad(f"{folder}: {shape}, {thickness:g} mm, {_count(presses)}", tuple(presses), punch, lowpass, folder,
                   shape, thickness)
        for (shape, thickness), presses in by_pad.items() if shape != "cylinder"
    ]  # fmt: skip


def _punch(table: Any, folder: str) -> str:
    """The punch of a campaign as an option of ``compare``; the standard one where the file has another form."""
    table = table if isinstance(table, dict) else {}
    shape = str(table.get("shape", "square"))
    if shape == "profile":
        return f"profile:{folder}/{table.get('file', '')}"
    size = table.get("side_mm" if shape == "square" else "diameter_mm", 14.0)
    return f"{shape}:{size:g}" if isinstance(size, int | float) else "square:14"


def _lowpass(table: Any) -> str:
    table = table if isinstance(table, dict) else {}
    if "lowpass_hz" not in table:
        return ""
    return f"{table['lowpass_hz']:g}:{table.get('lowpass_order', 2)}:{table.get('lowpass_passes', 1)}"
