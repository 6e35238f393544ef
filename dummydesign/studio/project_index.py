"""What was made and pressed in the project folder: moulds and whose pad they are of, calibrations, files, cast pads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.levels import LIGHTS
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.core.manifest import sha256_of
from dummydesign.geometry.shape_registry import read_shape, shape_kinds
from dummydesign.measurement.campaign_file import FILE as CAMPAIGN
from dummydesign.measurement.campaign_file import read_campaign_toml
from dummydesign.measurement.campaign_presses import read_trials
from dummydesign.mold.pour.acceptance import GaugePoint
from dummydesign.mold.pour.record import read_points
from dummydesign.project.status import finished_manifest, measured, things_in
from dummydesign.studio import file_transfer, select_options
from dummydesign.studio.jobs import changed_inputs
from dummydesign.studio.state import Design, State, absolute, designs_of
from dummydesign.studio.trash import Taken, keep_file

GROUPS = ("Pour", "Print or machine", "Draw", "Check", "More")
PRESETS = {
    "open": "open: a silicone mould, cavity up; a plate levels the resin at the brim",
    "lidded": "lidded: a silicone mould with a silicone lid; the resin is filled through a sprue",
    "printed": "printed: no silicone; the pad is cast in the print, which is taken apart",
}
"""Kinds of mould, each in a line."""
FILES = (
    (r"pour{pad}?\.pdf", "Pour", "Pour sheet (PDF): start here"),
    (r"pour{pad}?\.html", "Pour", "Pour sheet (web page)"),
    (r"assembly{pad}?\.html", "Print or machine", "All parts, to turn (web page)"),
    (r"assembly{pad}?\.(?P<kind>step)", "Print or machine", "All parts, {kind}"),
    (r"drawings{pad}?\.(?P<kind>\w+)", "Draw", "All drawings ({kind})"),
    (r"(?P<part>.+?){pad}\.png", "Draw", "Picture of the {part}"),
    (r"(?P<part>.+?){pad}\.(?P<kind>step|3mf)", "Print or machine", "{part}, {kind}"),
    (r"checks\.json", "Check", "Checks of the solids"),
    (r"manifest\.json", "Check", "What was asked, and sums of all files"),
    (r"spec\.json", "Check", "All dimensions and settings"),
    (r"record\.json", "Check", "Record of the cast pad"),
    (r"record-(?P<part>\d+)\.json", "Check", "Record of the cast pad {part}"),
)
"""Files of a mould by their names, in which ``{pad}`` is the kind and thickness of its pad: group, and words."""
PAD = ("shape", "thickness_mm", "ratio", "resin")
SIZE = PAD[:2]


@dataclass(frozen=True)
class Mould:
    """A mould in the project."""

    folder: str
    pad: dict[str, Any]
    length_mm: float
    width_mm: float
    preset: str

    def is_of(self, state: State) -> bool:
        """Whether it is a mould of the pad that is chosen, of any outline and kind."""
        return same_pad(self.pad, vars(state))

    @property
    def label(self) -> str:
        """The pad and the kind of mould, in one line."""
        pad = self.pad
        return (
            f"{pad['shape']}, {pad['thickness_mm']:g} mm, ratio {pad['ratio']:g}, {pad['resin']}; "
            f"{self.length_mm:g} x {self.width_mm:g} mm, {self.preset}"
        )


def design_of_pad(root: Path, state: State) -> Design | None:
    """The newest design of the pad that is chosen, one for what is asked before all others; None without any."""
    designs = designs_of(root)
    if state.design:
        return designs.get(state.design)
    same = [one for one in designs.values() if one.command == "suggest" and same_pad(one.given, vars(state))]
    return next(reversed([one for one in same if one.answers(state)] or same), None)


def verdict_of_design(root: Path, state: State) -> tuple[str, str] | None:
    """Light and sentence of the design of this pad, made for what is chosen from files that are still the same."""
    design = design_of_pad(root, state)
    if design is None or design.level not in LIGHTS or doubts_of_design(root, design, state):
        return None
    return LIGHTS[design.level], design.text


def doubts_of_design(root: Path, design: Design, state: State) -> list[str]:
    """Why a design answers what is chosen no longer: files that changed, another question."""
    changed = [f"{name} has changed since." for name in changed_inputs(root, root / design.folder / MANIFEST)]
    if design.answers(state):
        return changed
    asked = State(**design.given).label.partition("; ")
    return [*changed, f"It was judged for {asked[2]} with {asked[0].rpartition(', ')[2]}."]


def wants_puck(root: Path, state: State) -> bool:
    """Whether the design of this pad is settled by a puck of its resin, which was not measured yet."""
    design = design_of_pad(root, state)
    return design is not None and design.level == "not_settled" and not measured(absolute(root, state.resin))


@dataclass(frozen=True)
class CalibrationEntry:
    """What was learned from a campaign: the folder of its report, and the files that were read."""

    folder: str
    text: str
    campaign: str
    prior: str
    sums: tuple[tuple[str, str | None], ...]

    @property
    def file(self) -> str:
        """For ``--calibration``."""
        return f"{self.folder}/calibration.json"

    def outdated(self, root: Path) -> bool:
        """Whether the campaign changed since: a file that was read is another one now."""
        return any(sha256_of(root / self.campaign / name) != sha for name, sha in self.sums)


_UNITS = "kPa|MPa|Pa_s|N|mm|cm3|s|min|h|days|deg|kg|g|K|C|um|percent"


def name_and_unit(parameter: str) -> tuple[str, str]:
    """A parameter's name in words, and its unit: ``compliance`` and ``mm/N`` of ``compliance_mm_per_N``."""
    match = re.fullmatch(rf"(.+_at_.+|.+?)(?:_({_UNITS}))?(?:_per_({_UNITS}))?", parameter)
    name, over, under = match.groups() if match else (parameter, None, None)
    return name.replace("_", " "), (f"{over or 1}/{under}" if under else over or "").replace("_", " ")


def shape_key(text: str) -> str:
    """A shape with its lengths in one form, however it was typed; the text itself where it is none."""
    with suppress(InputError):
        return str(read_shape(text.strip()))
    return text.strip()


def same_pad(one: Mapping[str, Any], other: Mapping[str, Any], keys: Sequence[str] = PAD) -> bool:
    """Whether two pads are the same in these keys: lengths within 1e-6, shapes however they were typed."""

    def same(key: str) -> bool:
        first, second = (shape_key(pad[key]) if key == "shape" else pad[key] for pad in (one, other))
        return bool(first == second) if isinstance(first, str) else abs(first - second) < 1e-6

    return all(same(key) for key in keys)


def moulds(root: Path) -> list[Mould]:
    """Moulds of a project, the newest last; those whose manifest cannot be read are left out."""
    own = []
    for folder, manifest in _manifests(root, "moulds", "mold"):
        with suppress(KeyError, TypeError, ValueError, OverflowError):
            given = manifest["inputs"]
            pad = {
                "shape": str(given["shape"]),
                "thickness_mm": float(given["thickness_mm"]),
                "ratio": float(given["ratio"]),
                "resin": str(given["resin"]),
            }
            own.append(Mould(folder, pad, float(given["length_mm"]), float(given["width_mm"]), str(given["preset"])))
    return own


def calibrations(root: Path, campaign: str) -> list[CalibrationEntry]:
    """Calibrations learned from a campaign, the newest last, also those made on the terminal."""
    own = []
    for folder, manifest in _manifests(root, "calibrations", "loop"):
        with suppress(AttributeError, KeyError, TypeError):
            path = str(manifest["inputs"]["campaign"])
            sums = tuple(
                (str(one["file"]), one.get("sha256"))
                for one in manifest.get("files_read") or []
                if str(one.get("name", "")).rpartition("/")[0] == path.rstrip("/")
            )
            of_campaign = _names(root, path, campaign) or _was_renamed(root, path, campaign, dict(sums))
            if of_campaign and (root / folder / "calibration.json").is_file():
                text, prior = (manifest["summary"] or {}).get("text", ""), manifest["inputs"].get("prior") or ""
                own.append(CalibrationEntry(folder, str(text), campaign, str(prior), sums))
    return own


def _was_renamed(root: Path, path: str, campaign: str, sums: dict[str, str | None]) -> bool:
    """Whether a campaign that is not there any more has the file that the chosen one has."""
    old = sums.get(CAMPAIGN)
    return bool(old) and not (root / path / CAMPAIGN).is_file() and sha256_of(root / campaign / CAMPAIGN) == old


def _names(root: Path, path: str, folder: str) -> bool:
    """Whether a path, typed in the project or below it, is a folder of the project."""
    if Path(path).is_absolute():
        return Path(path).resolve() == (root / folder).resolve()
    # typed in the project folder, or in one of its rooms
    parts = tuple(part for part in Path(path).parts if part not in (".", ".."))
    return bool(parts) and Path(folder).parts[-len(parts) :] == parts


def _manifests(root: Path, room: str, command: str) -> list[tuple[str, dict[str, Any]]]:
    """Folders of a room that a command made, with their manifests, the newest last."""
    own = (one.folder for one in things_in(root, room) if one.command == command)
    return [(folder, manifest) for folder in own if (manifest := finished_manifest(root / folder / MANIFEST))]


def grouped_files(names: Iterable[str]) -> list[tuple[str, list[tuple[str, str]]]]:
    """Files of a mould by what one does with them: group, then (words, file name); empty groups are left out."""
    rows: dict[str, list[tuple[str, str]]] = {group: [] for group in GROUPS}
    for name in sorted(names):
        group, words = _group(name)
        rows[group].append((words, name))
    rows["Pour"].sort(key=lambda row: ("start here" not in row[0], row[0]))
    return [(group, entries) for group, entries in rows.items() if entries]


def _group(name: str) -> tuple[str, str]:
    pad = rf"(?:_(?:(?:{'|'.join(shape_kinds())})_)?t\d+(?:\.\d+)?)"
    for pattern, group, words in FILES:
        if match := re.fullmatch(pattern.replace("{pad}", pad), name):
            given = {"part": "", "kind": ""} | match.groupdict()
            text = words.format(part=given["part"].replace("_", " "), kind=given["kind"].upper())
            return group, f"{text[0].upper()}{text[1:]}"
    return "More", name


DROPPED = "measured/cast-pad"
"""Where presses go that are dropped for a comparison."""


@dataclass(frozen=True)
class PadWithPresses:
    """A pad with its presses; without any it stands for none."""

    label: str = ""
    files: tuple[str, ...] = ()
    punch: str = ""
    lowpass: str = ""
    campaign: str = ""
    shape: str = ""
    thickness_mm: float | None = None


def pads(root: Path, state: State) -> list[PadWithPresses]:
    """Every pad of the project with presses: those of the chosen campaign first, then others, then loose files."""
    own_first = sorted(select_options.campaigns(root), key=lambda name: name != state.campaign)
    pressed = [pad for name in own_first for pad in _of_campaign(root, name)]
    imports = sorted((root / "measured").glob("import-*"))
    loose = {root / DROPPED: "files dropped here"} | {one: f"{one.name} of the measured files" for one in imports}
    for folder, words in loose.items():
        presses = tuple(sorted(path.relative_to(root).as_posix() for path in folder.glob("*.csv")))
        if presses:
            pressed.append(PadWithPresses(f"{words}: {presses_text(presses)}", presses, state.punch))
    return pressed


def nearest(pressed: Sequence[PadWithPresses], state: State) -> PadWithPresses | None:
    """The pad that is chosen, where one of this shape and thickness was pressed; else the first."""
    same = (one for one in pressed if one.thickness_mm is not None and same_pad(vars(one), vars(state), SIZE))
    return next(chain(same, pressed), None)


def keep_press(root: Path, name: str, content: bytes) -> Taken:
    """Keep a trace that was dropped."""
    file_transfer.plain_name(name)
    file_transfer.check_press(name, content)
    return keep_file(root, root / DROPPED, name, content)


def records(root: Path, pad: PadWithPresses) -> list[str]:
    """Records of castings whose mould is of this pad, the newest last."""
    every = moulds(root) if pad.files else []
    own = (one.folder for one in every if pad.thickness_mm is None or same_pad(one.pad, vars(pad), SIZE))
    return [
        path.relative_to(root).as_posix()
        for folder in own
        for path in sorted((root / folder).glob("record*.json"), key=lambda path: path.stat().st_mtime)
    ]


def gauge_points(folder: Path) -> Sequence[GaugePoint]:
    """Gauge points of a mould; empty where its specification cannot be read."""
    with suppress(InputError):
        return read_points(folder)
    return ()


def presses_text(presses: Sequence[object]) -> str:
    """How many presses there are, in words."""
    return f"{len(presses)} press{'es' * (len(presses) != 1)}"


def _of_campaign(root: Path, folder: str) -> list[PadWithPresses]:
    try:
        trials = read_trials(root / folder)
        data = read_campaign_toml(root / folder).data
    except InputError:
        return []
    by_pad: dict[tuple[str, float], list[str]] = {}
    for trial in trials:
        thickness, shape, file = trial["thickness_mm"], trial["shape"], trial["file"]
        pad = isinstance(thickness, int | float) and shape != "cylinder"
        if pad and file and (root / folder / file).is_file():
            by_pad.setdefault((shape, float(thickness)), []).append(f"{folder}/{file}")
    punch, lowpass = _punch(data.get("punch"), folder), _lowpass(data.get("sensor"))
    return [
        PadWithPresses(
            f"{folder}: {shape}, {thickness:g} mm, {presses_text(presses)}",
            tuple(presses),
            punch,
            lowpass,
            folder,
            shape,
            thickness,
        )
        for (shape, thickness), presses in by_pad.items()
    ]


def _punch(table: Any, folder: str) -> str:
    """The punch of a campaign as an option of ``compare``; the standard one where the file has another form."""
    table = table if isinstance(table, dict) else {}
    shape = str(table.get("shape", "square"))
    if shape == "profile":
        return f"profile:{folder}/{table.get('file', '')}"
    size = table.get("side_mm" if shape == "square" else "diameter_mm", 14.0)
    return f"{shape}:{size:g}" if isinstance(size, int | float) else "square:14"


def _lowpass(table: Any) -> str:
    """The filter of a campaign as an option of ``compare``; none where the file has another form."""
    with suppress(KeyError, TypeError, ValueError):
        return f"{table['lowpass_hz']:g}:{table.get('lowpass_order', 2)}:{table.get('lowpass_passes', 1)}"
    return ""
