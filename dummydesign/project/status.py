"""Where a project stands: what lies in each folder, the past answers, and the one thing to do next."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from shlex import quote
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.core.levels import level_name
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.core.user_library import find
from dummydesign.measurement.campaign_file import FILE as CAMPAIGN
from dummydesign.measurement.campaign_presses import check_campaign
from dummydesign.mold.moulded_pads import mould_command
from dummydesign.mold.puck.plan import BATCH, command, trace_names
from dummydesign.project.folder import FOLDERS, Project

STANDARD_RESIN = "polyurethane-nagoya"
TEXTS = (".csv", ".txt", ".dat", ".tsv", ".asc", ".xlsx", ".xls", ".ods")
"""Endings of files of test machines, for what counts as measured."""


@dataclass(frozen=True)
class ProjectFile:
    """Something that lies in a project: an import, a design, a mould, a campaign, a calibration."""

    folder: str
    command: str
    date: str = ""
    summary: dict[str, Any] | None = None

    @property
    def line(self) -> str:
        """What is known of it, in a few words."""
        summary = self.summary or {}
        if "pressed" in summary:
            left = f", {summary['wrong']} problem{'s' * (summary['wrong'] > 1)}" if summary["wrong"] else ""
            return f"{summary['pressed']} of {summary['pressed'] + summary['missing']} presses are there{left}"
        if {"thickness_mm", "ratio", "shape"} <= set(summary):
            verdict = f": {level_name(summary['verdict'])}" if summary.get("verdict") else ""
            return f"{summary['thickness_mm']:g} mm {summary['shape']}, ratio {summary['ratio']:g}{verdict}"
        if "traces" in summary:
            return f"{summary['traces']} presses"
        if {"effects", "verdict"} <= set(summary):
            return f"{summary['verdict']}: {', '.join(summary['effects']) or 'no effect'}"
        return str(summary.get("text") or self.command or "as measured" * self.folder.startswith("measured/"))


@dataclass(frozen=True)
class ProjectStatus:
    """How far a project is."""

    project: Project
    files: dict[str, tuple[ProjectFile, ...]]
    next_text: str
    next_command: str
    problems: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "name": self.project.name,
            "folder": str(self.project.root),
            "given": self.project.given(),
            "found": {room: [asdict(one) for one in items] for room, items in self.files.items()},
            "next": {"text": self.next_text, "command": self.next_command},
            "problems": list(self.problems),
        }


def finished_manifest(path: Path) -> dict[str, Any] | None:
    """Return the content of a finished manifest, its summary as a command writes it or None; None without any."""
    try:
        content = _manifest(path, path.stat().st_mtime_ns)
    except OSError:
        return None
    if not (content.get("command") and content.get("finished")):
        return None
    summary = content.get("summary")
    return content | {"summary": summary if isinstance(summary, dict) and _is_plain(summary) else None}


NUMBERS = ("thickness_mm", "ratio", "usable_fraction", "correction_factor")


def _is_plain(summary: dict[str, Any]) -> bool:
    """Whether numbers and names of a pad are such, also in a file that was edited or comes from elsewhere."""
    numbers, names = (summary.get(key, 0.0) for key in NUMBERS), summary.get("shape", "")
    return all(isinstance(one, int | float) and abs(one) < 1e6 for one in numbers) and isinstance(names, str)


@lru_cache(maxsize=4096)
def _manifest(path: Path, stamp: int) -> dict[str, Any]:
    return read_json(path)


def status_of(project: Project) -> ProjectStatus:
    """Look at every folder of a project, and say what comes next."""
    problems: list[str] = []
    files = {room: tuple(things_in(project.root, room, problems)) for room in FOLDERS}
    text, command = _next(project, files)
    return ProjectStatus(project, files, text, command, tuple(problems))


def things_in(root: Path, room: str, problems: list[str] | None = None) -> list[ProjectFile]:
    """List what lies in one folder of a project, the oldest first; only a list of campaigns reads their presses."""
    folder = root / room
    if not folder.is_dir():
        return []
    rows = []
    for path in sorted(folder.iterdir()):
        name = f"{room}/{path.name}"
        if path.name.startswith("."):
            continue
        if room == "campaigns":
            if (path / CAMPAIGN).is_file():
                rows.append(_campaign(path, name, [] if problems is None else problems))
        elif path.is_dir() and room != "tissue":
            if manifest := finished_manifest(path / MANIFEST):
                rows.append(_made(name, manifest, manifest["summary"]))
        elif room == "tissue" and path.suffix == ".toml":
            rows.append(_made(name, finished_manifest(path.with_name(f"{path.stem}-report") / MANIFEST)))
        elif room == "measured" and path.suffix.lower() in TEXTS:
            rows.append(ProjectFile(name, ""))
    return sorted(rows, key=lambda one: one.date)


def _campaign(path: Path, name: str, problems: list[str]) -> ProjectFile:
    try:
        state = check_campaign(path)
    except InputError as problem:
        problems.append(f"{name}: {problem}")
        return ProjectFile(name, "", "", {"pressed": 0, "missing": 0, "wrong": 1})
    counts = {key: len(getattr(state, key)) for key in ("pressed", "missing", "wrong")}
    return _made(name, finished_manifest(path / MANIFEST), counts)


def _made(name: str, manifest: dict[str, Any] | None, summary: dict[str, Any] | None = None) -> ProjectFile:
    """A thing with command and date of its manifest, where there is one."""
    known = manifest or {}
    return ProjectFile(name, str(known.get("command", "")), str(known.get("date", "")), summary)


def _next(project: Project, files: dict[str, tuple[ProjectFile, ...]]) -> tuple[str, str]:
    """The first thing that is not done, in the order of the work."""
    raw = [one for one in files["measured"] if not one.command]
    imported = [one for one in files["measured"] if one.command == "import"]
    designs = [one for one in files["designs"] if one.command == "suggest"]
    designed_for = str((designs[-1].summary or {}).get("tissue", "")) if designs else ""
    if project.tissue is None and not files["tissue"] and (imported or raw or not designed_for):
        if imported:
            traces = f"{quote(imported[-1].folder)}/*.csv"
            return "fit the tissue law to the imported presses", f"dummydesign fit {traces} --out tissue/mine.toml"
        if raw:
            return "read the measured files", "dummydesign import " + " ".join(quote(one.folder) for one in raw)
        text = 'choose a tissue (tissue = "..." in project.toml), or put files of your test machine into measured/'
        return text, "dummydesign tissues list"
    given = files["tissue"][-1].folder if files["tissue"] else designed_for
    tissue = "" if project.tissue else f" --tissue {quote(given)}"
    learned = files["calibrations"][-1] if files["calibrations"] else None
    if not designs and learned is None:
        return "design a pad", f"dummydesign suggest{tissue} --no-cad"
    if not designs and learned and (learned.summary or {}).get("designable", True):
        return _learned(learned, tissue, again=False)
    best = (designs[-1].summary or {}) if designs else {}
    red = best.get("verdict") == "not_representative"
    first = red or (best.get("verdict") == "not_settled" and not measured(str(best.get("resin"))))
    if designs and ((first and not files["campaigns"]) or (not pads_of(files) and "mould" not in best)):
        return _after_design(project, designs[-1], len(files["moulds"]) > len(pads_of(files)), tissue)
    open_plans = [one for one in files["campaigns"] if one.summary and (one.summary["missing"] or one.summary["wrong"])]
    if designs and not files["campaigns"]:
        moulds = [one for one in pads_of(files) if one.command == "mold"]
        return "cast the pads, then plan what to press", _plan(best, moulds[-1].folder if moulds else "")
    done = {str((one.summary or {}).get("campaign", "")) for one in files["calibrations"]}
    for one in files["campaigns"]:
        if one not in open_plans and Path(one.folder).name not in done:
            return "learn from the campaign", f"dummydesign loop {quote(one.folder)}"
    if open_plans:
        left = open_plans[-1].summary or {}
        rest = f"press the rest ({left['missing']} of {left['missing'] + left['pressed']} presses)"
        text = "fix the problems of the campaign" if left["wrong"] else rest
        return text, f"dummydesign campaign check {quote(open_plans[-1].folder)}"
    if learned and all(one.date < learned.date for one in designs):
        return _learned(learned, tissue, bool(designs))
    if red:
        return _after_design(project, designs[-1], len(files["moulds"]) > len(pads_of(files)), tissue)
    if designs and files["campaigns"]:
        campaign = files["campaigns"][-1].folder
        press = check_campaign(project.root / campaign).pressed[0]
        used = f"dummydesign on-person {quote(f'{campaign}/{press}')}{tissue} --drive steady"
        return f"all steps are done: read {designs[-1].folder}/report.html, use the pad", used
    return "all steps are done", "dummydesign history"


def _learned(latest: ProjectFile, tissue: str, again: bool) -> tuple[str, str]:
    """What comes after a calibration: a design with it, or more presses where it leaves the modulus open."""
    summary = latest.summary or {}
    if summary.get("designable", True):
        given = quote(f"{latest.folder}/calibration.json")
        text = f"design {'again' if again else 'a pad'} with what was learned"
        return text, f"dummydesign suggest{tissue} --shape slab --calibration {given}"
    campaign = f"campaigns/{summary.get('campaign', 'first')}"
    text = "the presses do not settle the modulus: plan the next measurement"
    return text, f"dummydesign loop {quote(campaign)} --plan {quote(f'{campaign}-next')}"


def witness_size() -> str:
    """Diameter and height of the witness puck, as ``--puck`` takes them. [mm]"""
    from dummydesign.mold.pour.plan import WITNESS_MM

    return "{:g}x{:g}".format(*WITNESS_MM)


def pads_of(files: dict[str, tuple[ProjectFile, ...]]) -> list[ProjectFile]:
    """Moulds of pads; the rings of pucks have no thickness."""
    return [one for one in files["moulds"] if not one.summary or "thickness_mm" in one.summary]


def _after_design(project: Project, design: ProjectFile, ring: bool, tissue: str) -> tuple[str, str]:
    """What a design without a mould asks for: another search where it is red, a puck where that settles it."""
    best = design.summary or {}
    given = best.get("next")
    step = given if isinstance(given, dict) else {}
    level, resin = best.get("verdict"), str(best.get("resin"))
    if level == "not_representative":
        text = str(step.get("do") or "do not cast this pad")
        return f"{text}; then design again with another resin or test", "dummydesign resins list"
    if level == "not_settled" and "ratio" in best and not measured(resin):
        other = project.resin not in (None, resin)
        if other or measured(BATCH, design.date):
            batch = "" if other else f" --resin {BATCH}"
            return "design again with the batch that was measured", f"dummydesign suggest{tissue}{batch} --no-cad"
        size = witness_size()
        if ring:
            diameter, height = size.split("x")
            added = command(trace_names(size), diameter, height, best["ratio"], quote(resin))
            return "cast and press the puck, then read it", added
        made = f"dummydesign mold --puck {size} --resin {quote(resin)} --ratio {best['ratio']:g}"
        return str(step.get("do") or "measure one puck of the resin first"), str(step.get("command") or made)
    return "make the mould", _mould(project, best)


def measured(resin: str, since: str = "") -> bool:
    """Whether a batch was measured, after a date; of it no other puck is needed. False where it cannot be read."""
    from dummydesign.resin.model.resin_file import KIND, read_resin

    try:
        entry = find(KIND, "resin", resin)
        written = datetime.fromtimestamp(entry.path.stat().st_mtime, UTC).isoformat()
        return written >= since and read_resin(entry).measured
    except (InputError, OSError):
        return False


def _mould(project: Project, best: dict[str, Any]) -> str:
    if not {"thickness_mm", "ratio", "shape"} <= set(best):
        return "dummydesign mold --thickness MM"
    shape, resin = (str(best.get(name, "")) for name in ("shape", "resin"))
    usual = project.resin or STANDARD_RESIN
    return mould_command(
        best["thickness_mm"], best["ratio"], "" if shape == "slab" else shape, "" if resin == usual else resin
    )


def _plan(best: dict[str, Any], mould: str) -> str:
    if mould:
        return f"dummydesign campaign new campaigns/first --from-mould {quote(mould)}"
    if not {"ratio", "resin"} <= set(best):
        return "dummydesign campaign new campaigns/first --young KPA"
    return f"dummydesign campaign new campaigns/first --resin {quote(str(best['resin']))} --ratio {best['ratio']:g}"


DEEPEST = 3
"""Folders below the one named that are looked into."""


@dataclass(frozen=True)
class PastAnswer(ProjectFile):
    """One answer: its folder from the one named on, command, date, what its manifest sums up, and the version."""

    version: str = ""


def history_of(folder: Path) -> tuple[PastAnswer, ...]:
    """List the answers in a folder and up to three folders below it, the newest first.

    Raises
    ------
    InputError
        When there is no such folder.
    """
    if not folder.is_dir():
        message = f"folder '{folder}' does not exist; name one that holds answers"
        raise InputError(message, "file_not_found", "folder", str(folder))
    answers = []
    for path in _manifests(folder):
        if content := finished_manifest(path):
            made = _made(path.parent.relative_to(folder).as_posix(), content, content["summary"])
            answers.append(PastAnswer(**vars(made), version=str(content.get("version", ""))))
    return tuple(sorted(answers, key=lambda one: one.date, reverse=True))


def _manifests(folder: Path) -> Iterator[Path]:
    for path, below, names in os.walk(folder):
        deep = len(Path(path).relative_to(folder).parts)
        below[:] = [] if deep >= DEEPEST else sorted(name for name in below if not name.startswith("."))
        if MANIFEST in names:
            yield Path(path) / MANIFEST
