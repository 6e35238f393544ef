"""Files of the project: take in, delete into a bin inside the project, bring back."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json, write_bytes, write_text, writing
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.core.manifest import read_manifest
from dummydesign.project.folder import FILE as PROJECT
from dummydesign.project.folder import FOLDERS, Project, change_project
from dummydesign.studio import jobs
from dummydesign.studio.file_transfer import holds, inside

HOME = ".studio/bin"
LIMITS = "limits"
"""Folder of a project with the user's own limits."""
ENTRY, CONTENT = "entry.json", "content"
KEPT_DAYS = 30.0
"""How long something stays in the bin; what is older goes when the next thing is deleted."""


@dataclass(frozen=True)
class Deleted:
    """Something in the bin."""

    folder: Path
    path: str
    time: float
    why: str


def deleted(root: Path) -> list[Deleted]:
    """What is in the bin of a project, the newest first."""
    entries = []
    for path in (root / HOME).glob(f"*/{ENTRY}"):
        with suppress(OSError, ValueError, KeyError, TypeError, OverflowError):
            kept = read_json(path)
            when = float(kept["time"])
            time.localtime(when)
            entries.append(Deleted(path.parent, str(kept["path"]), when, str(kept["why"])))
    return sorted(entries, key=lambda one: (one.time, one.folder.name), reverse=True)


def delete(root: Path, path: str, why: str = "deleted") -> Deleted:
    """Move a file or folder of a project into the bin."""
    parts = parts_of(root, path)
    check_idle(root, path)
    with _new_entry(root, path, why) as entry:
        _move([(part, entry.folder / CONTENT / part.name) for part in parts])
    return entry


@contextmanager
def kept_before(root: Path, path: str) -> Iterator[Deleted]:
    """Put a copy of a small file into the bin that the block is about to edit; none where the edit is refused."""
    inside(root, path)
    check_idle(root, path)
    with _new_entry(root, path, "replaced") as entry:
        with writing("bin", path, "bin"):
            (entry.folder / CONTENT).mkdir()
            shutil.copyfile(root / path, entry.folder / CONTENT / Path(path).name)
        try:
            yield entry
        except InputError:
            shutil.rmtree(entry.folder, ignore_errors=True)
            raise


@contextmanager
def _new_entry(root: Path, path: str, why: str) -> Iterator[Deleted]:
    """Make an entry of the bin for the block to fill, and throw out what is older than is kept."""
    now, home = time.time(), root / HOME
    for old in deleted(root):
        if now - old.time > KEPT_DAYS * 86400.0:
            shutil.rmtree(old.folder, ignore_errors=True)
    # of a long name the beginning: the whole of it stands inside
    begins = f"{time.strftime('%Y%m%d-%H%M%S', time.localtime(now))}-{Path(path).name[:40]}-"
    with writing("bin", home, "bin"):
        home.mkdir(parents=True, exist_ok=True)
        entry = Deleted(Path(tempfile.mkdtemp(prefix=begins, dir=home)), path, now, why)
    try:
        write_text(entry.folder / ENTRY, json.dumps({"path": path, "time": now, "why": why}))
        yield entry
    except InputError:
        _forget(entry)
        raise


def choose_for_project(project: Project, **given: str | None) -> Project:
    """Write choices into ``project.toml``; what it was goes to the bin."""
    with kept_before(project.root, PROJECT):
        return change_project(project, **given)


def _forget(entry: Deleted) -> None:
    """Remove an entry of the bin, unless something lies in it that could not be moved back."""
    if not any((entry.folder / CONTENT).glob("*")):
        shutil.rmtree(entry.folder, ignore_errors=True)


def restore(root: Path, entry: Deleted) -> str:
    """Move something from the bin back to where it was; what has its name by now goes to the bin. Return its path."""
    target, content = root / entry.path, entry.folder / CONTENT
    names = sorted(path.name for path in content.iterdir()) if content.is_dir() else []
    if target.name not in names:
        raise InputError(f"'{entry.path}' is not in the bin any more", "file_not_found", "bin", entry.path)
    inside(root, entry.path)
    check_idle(root, entry.path)
    if not target.parent.is_dir() and target.parent.parent != root:
        message = f"'{target.parent.relative_to(root).as_posix()}' is not there. Restore it first"
        raise InputError(message, "file_not_found", "folder")
    moves = [(content / name, target.parent / name) for name in names]
    gone = delete(root, entry.path, "undone") if target.exists() else None
    try:
        _move(moves)
    except InputError:
        if gone:
            restore(root, gone)
        raise
    _forget(entry)
    return entry.path


def check_idle(root: Path, path: str) -> None:
    """Refuse what a running command reads or writes (InputError)."""
    target = root / path
    for job in (one for one in jobs.all_jobs(root) if one.state == "running"):
        for word in (piece for text in chain(*job.commands) for piece in (text, *re.split("[,:]", text))):
            used = Path(os.path.normpath(root / word))
            if root in used.parents and (target.is_relative_to(used) or used.is_relative_to(target)):
                message = f"'{path}' is in use by a running command ({job.name}). Wait for it, or stop it"
                raise InputError(message, "busy", "path", path)


def parts_of(root: Path, path: str) -> list[Path]:
    """The files or the folder of a thing of the project, itself first; a tissue has its report beside it."""
    words = path.split("/")
    inside(root, path)
    if path != PROJECT and (len(words) < 2 or words[0] not in (*FOLDERS, LIMITS) or not all(words)):
        raise InputError(f"'{path}' belongs to no step of the project", "not_allowed", "path", path)
    target = root / path
    if not (target.exists() or target.is_symlink()):
        raise InputError(f"'{path}' is not there (any more)", "file_not_found", "path", path)
    if not (path.startswith("tissue/") and path.endswith(".toml")):
        return [target]
    # before 2.0.0 the manifest and the files that it lists lay beside the tissue
    report, old = (target.with_name(f"{target.stem}-{name}") for name in ("report", MANIFEST))
    listed = sorted(earlier.sha256) if (earlier := read_manifest(old)) else ()
    beside = [target.with_name(name) for name in listed if "/" not in name and not name.endswith(".toml")]
    return [target, *[report] * (report / MANIFEST).is_file(), *(one for one in (old, *beside) if one.is_file())]


def _move(pairs: Sequence[tuple[Path, Path]]) -> None:
    """Rename all, or none: a copy in the place of a refused rename could lose what it copies."""
    with writing("folder of", pairs[0][0].name, "path"), ExitStack() as back:
        for start, end in pairs:
            end.parent.mkdir(exist_ok=True)
            if end.exists():
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), end.name)
            start.rename(end)
            back.callback(end.rename, start)
        back.pop_all()


@dataclass(frozen=True)
class Taken:
    """What became of a file that was sent: its name now, a sentence, and the file whose place it took."""

    name: str
    text: str
    gone: Deleted | None = None


def keep_file(root: Path, folder: Path, name: str, content: bytes) -> Taken:
    """Write a file that was sent; an earlier one of its name goes to the bin, one that is there already stays."""
    path = folder.relative_to(root).as_posix()
    inside(root, path)
    if holds(folder / name, content):
        return Taken(name, f"{name} is there already: nothing was changed.")
    with writing("folder", path, "folder"):
        folder.mkdir(parents=True, exist_ok=True)
    with kept_before(root, f"{path}/{name}") if (folder / name).is_file() else nullcontext() as gone:
        write_bytes(folder / name, content)
    return Taken(name, f"{name} was added. The earlier one is in the bin." if gone else f"{name} was added.", gone)


def twin(folder: Path, name: str, content: bytes) -> str | None:
    """Name of another file of a folder with the same content."""
    others = (path.name for path in sorted(folder.glob("[!.]*")) if path.name != name and holds(path, content))
    return next(others, None)
