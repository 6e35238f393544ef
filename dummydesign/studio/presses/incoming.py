"""Presses of a campaign that come in: under their planned names, or held until each is assigned to a planned press."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_file import FILE
from dummydesign.measurement.planning.check import differences_from_plan
from dummydesign.measurement.planning.trial_values import read_trials
from dummydesign.measurement.trace import Trace, read_trace
from dummydesign.studio import bin
from dummydesign.studio.server import files

HELD = "unassigned"
"""Folder in that of a campaign, for files that have no planned name."""


@dataclass(frozen=True)
class Taken:
    """What became of a file: a sentence, and the file whose place it took."""

    text: str
    gone: bin.Deleted | None = None


def take(root: Path, campaign: str, name: str, content: bytes) -> Taken:
    """Take a press: under its planned name at once, under another name for later.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder, from the project folder on.
    name : str
        As sent.
    content : bytes
        The whole file.

    Raises
    ------
    InputError
        For a file that is no trace, or the same as another press; nothing is changed.
    """
    files.plain_name(name)
    folder = root / campaign
    planned = {trial["file"]: trial for trial in read_trials(folder)}
    _read(name, content, planned.get(name, {}).get("velocity_mm_s"))
    if name not in planned:
        kept = files.keep(files.inside(root, f"{campaign}/{HELD}"), name, content).name
        return Taken(f"{kept} is not a planned name. Assign it to a press below.")
    return _put(root, campaign, name, content)


def held(root: Path, campaign: str) -> list[str]:
    """Files of a campaign that wait for their press."""
    return sorted(path.name for path in (root / campaign / HELD).glob("*") if path.is_file())


def presses_for(root: Path, campaign: str, name: str) -> dict[str, str]:
    """Planned presses that a held file may be, with words: those that fit and are missing first.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder.
    name : str
        Of the held file.
    """
    folder = root / campaign
    trials, trace = _trials(folder), _read_or_none(folder / HELD / name)
    rows = []
    for number, trial in enumerate(trials):
        fits = trace is not None and not list(differences_from_plan(trace, trial))
        there = (folder / str(trial.get("file"))).is_file()
        words = f"{trial.get('file')}{' (as planned)' if fits else ''}{', replaces the one there' if there else ''}"
        rows.append((not fits, there, number, str(trial.get("file")), words))
    return {file: words for *_, file, words in sorted(rows)}


def assign(root: Path, campaign: str, name: str, planned: str) -> Taken:
    """Give a held file the name of a planned press; an earlier file of that press goes to the bin.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder.
    name, planned : str
        Of the held file, and of the press.

    Raises
    ------
    InputError
        For a press that is not planned, or a file that is not there.
    """
    folder = root / campaign
    if planned not in {trial["file"] for trial in read_trials(folder)}:
        raise InputError(f"'{planned}' is not in the plan")
    place = folder / HELD / files.plain_name(name)
    try:
        content = place.read_bytes()
    except OSError:
        raise InputError(f"'{name}' is not there (any more)") from None
    taken = _put(root, campaign, planned, content)
    try:
        place.unlink()
    except OSError as problem:
        raise InputError(f"{planned} was added; '{name}' stays: {problem.strerror or problem}") from None
    return Taken(f"{name} is now {planned}. {taken.text}", taken.gone)


def discard(root: Path, campaign: str, name: str) -> bin.Deleted:
    """Move a held file to the bin.

    Parameters
    ----------
    root : Path
        The project folder.
    campaign : str
        Its folder.
    name : str
        Of the held file.
    """
    return bin.delete(root, f"{campaign}/{HELD}/{files.plain_name(name)}")


def undo(root: Path, gone: bin.Deleted) -> None:
    """Bring a replaced file back; the one in its place goes to the bin.

    Parameters
    ----------
    root : Path
        The project folder.
    gone : Deleted
        From :func:`take` or :func:`assign`.
    """
    if not gone.folder.is_dir():
        raise InputError(f"'{gone.path}' is not in the bin any more")
    if (root / gone.path).is_file():
        bin.delete(root, gone.path, "undone")
    bin.restore(root, gone)


def _put(root: Path, campaign: str, name: str, content: bytes) -> Taken:
    files.plain_name(name)  # a plan can name another file of its folder as a press, such as itself
    folder = files.inside(root, campaign)
    for trial in read_trials(folder):
        other = folder / trial["file"]
        if trial["file"] != name and other.is_file() and other.read_bytes() == content:
            raise InputError(f"{name} is the same as {trial['file']}, which is there: press it again")
    place, gone = folder / name, None
    if place.is_file():
        if place.read_bytes() == content:
            return Taken(f"{name} is there already.")
        gone = bin.delete(root, f"{campaign}/{name}", "replaced")
    with bin.undone_if_refused(root, gone):
        files.keep(folder, name, content)
    return Taken(f"{name} was added." + (" The earlier one is in the bin." if gone else ""), gone)


def _read(name: str, content: bytes, speed: Any) -> Trace:
    try:
        with TemporaryDirectory() as away:
            path = Path(away) / name
            path.write_bytes(content)
            return read_trace(path, speed if isinstance(speed, int | float) and speed > 0 else None)
    except OSError as problem:
        raise InputError(f"{name} cannot be read: {problem.strerror or problem}") from None
    except InputError as problem:
        raise InputError(f"{name} is no press: {str(problem).removeprefix(f'{name}: ')}") from None


def _read_or_none(path: Path) -> Trace | None:
    try:
        return read_trace(path)
    except InputError:
        return None


def _trials(folder: Path) -> list[dict[str, Any]]:
    data = tomllib.loads((folder / FILE).read_text(encoding="utf-8-sig"))
    return [trial for trial in data.get("trial", []) if isinstance(trial, dict)]
