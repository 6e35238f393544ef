"""What was made, by the manifests in the project folder: moulds and whose pad they are of, calibrations, files."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.outputs.manifest import NAME as MANIFEST
from dummydesign.core.outputs.manifest import sha256_of
from dummydesign.geometry.shapes import read_shape, shape_kinds
from dummydesign.measurement.campaign_file import FILE as CAMPAIGN
from dummydesign.project.status import finished_manifest
from dummydesign.studio.state import State, design_state

GROUPS = ("Pour", "Print or machine", "Draw", "Check", "More")
PRESETS = {
    "open": "open: a silicone mould, cavity up; a plate levels the resin at the brim",
    "lidded": "lidded: a silicone mould with a silicone lid; the resin is filled through a sprue",
    "printed": "printed: no silicone; the pad is cast in the print, which is taken apart",
}
"""Kinds of mould, each in a line."""
_SOLIDS = {"step": "STEP", "stl": "STL", "3mf": "3MF", "glb": "GLB"}
_DRAWN = {"svg": "SVG", "dxf": "DXF", "pdf": "PDF"}
_TAIL = r"_(?:(?:{})_)?t\d+(?:\.\d+)?(?:_(a\d))?$"


@dataclass(frozen=True)
class Mould:
    """A mould in the project.

    Attributes
    ----------
    folder : str
        From the project folder on.
    pad : dict
        shape, thickness_mm, ratio, resin: as in the state.
    length_mm, width_mm : float
    preset : str
    """

    folder: str
    pad: dict[str, Any]
    length_mm: float
    width_mm: float
    preset: str

    def is_of(self, state: State) -> bool:
        """Whether it is a mould of the pad that is chosen, of any outline and kind."""
        same = all(abs(self.pad[name] - getattr(state, name)) < 1e-6 for name in ("thickness_mm", "ratio"))
        return same and self.pad["resin"] == state.resin and shape_key(self.pad["shape"]) == shape_key(state.shape)

    @property
    def label(self) -> str:
        """The pad and the kind of mould, in one line."""
        pad = self.pad
        return (f"{pad['shape']}, {pad['thickness_mm']:g} mm, ratio {pad['ratio']:g}, {pad['resin']}; "
                f"{self.length_mm:g} x {self.width_mm:g} mm, {self.preset}")  # fmt: skip


def design_of_pad(root: Path, state: State) -> str:
    """Folder of the newest design of the pad that is chosen, one for what is asked before all others; else empty."""
    if state.design:
        return state.design
    found = [
        folder for folder, _ in _manifests(root, "designs", "suggest")
        if (pad := design_state(root, folder)) and pad["resin"] == state.resin
        and shape_key(pad["shape"]) == shape_key(state.shape)
        and all(abs(pad[name] - getattr(state, name)) < 1e-6 for name in ("thickness_mm", "ratio"))
    ]  # fmt: skip
    asked = [folder for folder in found if answers(root, folder, state)]
    return (asked or found or [""])[-1]


def answers(root: Path, folder: str, state: State) -> bool:
    """Whether a design was made for the tissue, aim, resin, calibration and punch that are chosen.

    Parameters
    ----------
    root : Path
        The project folder.
    folder : str
        Of the design, from the project folder on.
    state : State
        Of the page.
    """
    given = design_state(root, folder)
    return bool(given) and all(given[name] == value for name, value in state.question.items())


@dataclass(frozen=True)
class Calibration:
    """What was learned from a campaign: the folder of its report, and the files that were read."""

    folder: str
    date: str
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


_UNITS = ("kPa", "MPa", "N", "mm", "s", "deg", "kg", "g", "K", "C", "um")


def unit_of(name: str) -> str:
    """The unit at the end of a parameter's name, ``mm/N`` of ``compliance_mm_per_N``; empty where there is none."""
    words = name.split("_")
    if len(words) > 2 and words[-2] == "per" and words[-1] in _UNITS:
        upper = words[-3] if words[-3] in _UNITS and len(words) > 3 else "1"
        return f"{upper}/{words[-1]}"
    return words[-1] if len(words) > 1 and words[-1] in _UNITS else ""


def plain_parameter(name: str) -> str:
    """A parameter's name without its unit, in words."""
    unit = unit_of(name)
    tail = "_" + unit.replace("1/", "per_").replace("/", "_per_") if unit else ""
    return name.removesuffix(tail).replace("_", " ")


def shape_key(text: str) -> str:
    """A shape with its lengths in one form, however it was typed; the text itself where it is none."""
    try:
        return "slab" if text.strip().lower() == "slab" else str(read_shape(text.strip()))
    except InputError:
        return text.strip()


def moulds(root: Path) -> list[Mould]:
    """Moulds of a project, the newest last; those whose manifest cannot be read are left out."""
    found = []
    for folder, told in _manifests(root, "moulds", "mold"):
        try:
            given = told["inputs"]
            pad = {"shape": str(given["shape"]), "thickness_mm": float(given["thickness_mm"]),
                   "ratio": float(given["ratio"]), "resin": str(given["resin"])}  # fmt: skip
            found.append(Mould(folder, pad, float(given["length_mm"]), float(given["width_mm"]), str(given["preset"])))
        except (KeyError, TypeError, ValueError):
            continue
    return found


def calibrations(root: Path, campaign: str) -> list[Calibration]:
    """Calibrations learned from a campaign, the newest last, also those made on the terminal.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder, from the project folder on.
    """
    found = []
    for folder, told in _manifests(root, "calibrations", "loop"):
        path = str(told.get("inputs", {}).get("campaign", ""))
        read = told.get("files_read") or []
        sums = tuple((str(one["file"]), one.get("sha256")) for one in read if _parent(one) == path.rstrip("/"))
        if not (root / folder / "calibration.json").is_file():
            continue
        if not (_names(root, path, campaign) or _was_renamed(root, path, campaign, dict(sums))):
            continue
        text = str((told.get("summary") or {}).get("text", ""))
        prior = str(told["inputs"].get("prior") or "")
        found.append(Calibration(folder, str(told.get("date", "")), text, campaign, prior, sums))
    return found


def _was_renamed(root: Path, path: str, campaign: str, sums: dict[str, str | None]) -> bool:
    """Whether a campaign that is not there any more has the file that the chosen one has."""
    old = sums.get(CAMPAIGN)
    gone = not (root / path / CAMPAIGN).is_file()
    return old is not None and gone and sha256_of(root / campaign / CAMPAIGN) == old


def _parent(one: dict[str, Any]) -> str:
    return str(one.get("name", "")).rpartition("/")[0]


def _names(root: Path, path: str, folder: str) -> bool:
    """Whether a path, typed in the project or below it, is a folder of the project."""
    if Path(path).is_absolute():
        return Path(path).resolve() == (root / folder).resolve()
    # typed in the project folder, or in one of its rooms
    parts = tuple(part for part in Path(path).parts if part not in (".", ".."))
    return bool(parts) and Path(folder).parts[-len(parts) :] == parts


def _manifests(root: Path, room: str, command: str) -> list[tuple[str, dict[str, Any]]]:
    rows = []
    for path in (root / room).glob(f"*/{MANIFEST}"):
        told = finished_manifest(path)
        if told is not None and told["command"] == command:
            rows.append((path.parent.relative_to(root).as_posix(), told))
    return sorted(rows, key=lambda row: (str(row[1].get("date", "")), row[0]))


def grouped_files(names: Iterable[str]) -> list[tuple[str, list[tuple[str, str]]]]:
    """Files of a mould by what one does with them: group, then (words, file name); empty groups are left out.

    Parameters
    ----------
    names : iterable of str
        File names.
    """
    rows: dict[str, list[tuple[str, str]]] = {group: [] for group in GROUPS}
    for name in sorted(names):
        group, words = _group(name)
        rows[group].append((words, name))
    rows["Pour"].sort(key=lambda row: ("start here" not in row[0], row[0]))
    return [(group, found) for group, found in rows.items() if found]


def _group(name: str) -> tuple[str, str]:
    stem, _, ending = name.rpartition(".")
    tail = re.search(_TAIL.format("|".join(shape_kinds())), stem)
    part = stem[: tail.start()] if tail else stem
    paper = f", {tail[1].upper()}" if tail and tail[1] else ""
    words = part.replace("_", " ").capitalize()
    if part == "pour":
        first = "Pour sheet (PDF): start here"
        kinds = {"pdf": f"Pour sheet (PDF{paper})" if paper else first, "html": "Pour sheet (web page)",
                 "md": "Pour sheet (text)"}  # fmt: skip
        return "Pour", kinds.get(ending, f"Pour sheet ({ending})")
    if part == "drawings":
        return "Draw", f"All drawings (PDF{paper})"
    if part.startswith("drawing_") and ending in _DRAWN:
        return "Draw", f"Drawing of the {part.removeprefix('drawing_').replace('_', ' ')}, {_DRAWN[ending]}"
    if part == "assembly":
        parts = {"html": "All parts, to turn (web page)", "step": "All parts, STEP", "glb": "All parts, GLB"}
        return ("Print or machine", parts[ending]) if ending in parts else ("More", name)
    if tail and ending in _SOLIDS:
        return "Print or machine", f"{words}, {_SOLIDS[ending]}"
    if tail and ending == "png":
        return "Draw", f"Picture of the {words.lower()}"
    known = {"checks.json": "Checks of the solids", "manifest.json": "What was asked, and sums of all files",
             "spec.json": "All dimensions and settings"}  # fmt: skip
    if name in known:
        return "Check", known[name]
    if re.fullmatch(r"record(-\d+)?\.json", name):
        number = stem.partition("-")[2]
        return "Check", f"Record of the cast pad{' ' + number if number else ''}"
    return "More", name
