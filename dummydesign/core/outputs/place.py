"""Where an answer goes: the folder asked for, or the next free number when another question's answer lies there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.outputs.manifest import NAME, Earlier, Question, read_manifest

MARKS = (NAME, "report.html", "preview.html", "rows.csv", "study.json", "calibration.json", "compare.json")
"""Files by which a folder without a manifest is known as one that a command wrote."""
MOST = 1000


@dataclass(frozen=True)
class Place:
    """Folder and stem to write to, the files of an earlier answer that go, and what the user has to be told."""

    folder: Path
    stem: str
    manifest: str
    old: tuple[str, ...] = ()
    warnings: tuple[dict[str, str], ...] = ()
    takes_over: bool = False


def choose_folder(out: Path, question: Question, replace: bool, go_on: bool = False) -> Place:
    """Choose the folder of an answer.

    Parameters
    ----------
    out : Path
        The folder asked for.
    question : Question
    replace : bool
        Take the place of whatever a command wrote there.
    go_on : bool
        Keep what is there: the same command goes on with its own rows.

    Returns
    -------
    Place
        ``out`` itself when it is new, empty, holds nothing that a command wrote, or the answer to the same question,
        unchanged since; else the first of ``OUT-2``, ``OUT-3``, ... of which this is true.
    """

    def state(folder: Path) -> Earlier | None:
        found = read_manifest(folder / NAME)
        if found is None and folder.is_dir() and _marked(folder):
            return Earlier(None, None, {})
        return found

    def at(folder: Path) -> Place:
        return Place(folder, folder.name, NAME)

    return _choose(out, lambda number: _numbered(out, number), state, at, question, replace, go_on)


def choose_files(out: Path, question: Question, replace: bool) -> Place:
    """Choose the stem of a set of files that share a folder with others: ``STEM.toml``, ``STEM-manifest.json``, ...

    Parameters
    ----------
    out : Path
        The main file asked for.
    question, replace
        See :func:`choose_folder`.
    """

    def state(path: Path) -> Earlier | None:
        found = read_manifest(path.with_name(f"{path.stem}-{NAME}"))
        return Earlier(None, None, {}) if found is None and path.exists() else found

    def at(path: Path) -> Place:
        return Place(path.parent, path.stem, f"{path.stem}-{NAME}")

    return _choose(
        out, lambda number: out.with_name(f"{out.stem}-{number}{out.suffix}"), state, at, question, replace, False
    )


def _choose(
    out: Path,
    numbered: Callable[[int], Path],
    state: Callable[[Path], Earlier | None],
    at: Callable[[Path], Place],
    question: Question,
    replace: bool,
    go_on: bool,
) -> Place:
    why = "was written by other inputs"
    for number in range(1, MOST):
        path = out if number == 1 else numbered(number)
        found, place = state(path), at(path)
        if found is None:
            break
        old = tuple(found.sha256)
        if replace and number == 1:
            return _replaced(place, old, path)
        if go_on and number == 1 and found.command in (None, question.command):
            return Place(place.folder, place.stem, place.manifest, old)
        if found.key == question.key:
            changed = found.changed(place.folder)
            if not changed:
                return Place(place.folder, place.stem, place.manifest, old)
            if number == 1:
                why = f"was changed since it was written ({', '.join(changed[:3])})"
    else:
        raise InputError(f"'{out}' and {MOST - 2} numbers after it are taken; remove some, or use --replace")
    if number == 1:
        return place
    message = f"'{out}' {why} and stays as it is; this answer is in '{path}' (--replace takes the other's place)"
    return Place(
        place.folder, place.stem, place.manifest, warnings=({"code": "output_numbered", "message": message},)
    )


def _replaced(place: Place, old: tuple[str, ...], path: Path) -> Place:
    """Take the place of an earlier answer; what no manifest lists is not removed, and is named."""
    known = {*old, place.manifest}
    left = []
    if path.is_dir():
        left = sorted(one.name for one in path.iterdir() if one.name not in known and not one.name.startswith("."))
    warnings = []
    if left:
        some = ", ".join(left[:5]) + (f" and {len(left) - 5} more" if len(left) > 5 else "")
        message = f"'{path}' also holds files that its earlier manifest does not list, and they stay: {some}"
        warnings = [{"code": "output_left", "message": message}]
    return Place(place.folder, place.stem, place.manifest, old, tuple(warnings), takes_over=True)


def _numbered(out: Path, number: int) -> Path:
    """``OUT-2`` beside ``OUT``, also where it is given as ``.`` or ``..``."""
    named = out if out.name not in ("", "..") else out.resolve()
    return named.with_name(f"{named.name}-{number}")


def _marked(folder: Path) -> bool:
    return any((folder / name).exists() for name in MARKS) or any(folder.glob("*.step"))
