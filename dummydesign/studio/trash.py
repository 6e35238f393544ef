"""Files of the project: take in, rename, delete into a bin inside the project, bring back."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json, unwritable, write_bytes, write_text, writing
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.core.manifest import sha256_of
from dummydesign.core.user_library import with_name
from dummydesign.project.folder import FOLDERS, Project, change_project, project_of
from dummydesign.studio import jobs
from dummydesign.studio.file_transfer import holds, inside, numbered, plain_name, save_upload

HOME = ".studio/bin"
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
    now, home = time.time(), root / HOME
    for old in deleted(root):
        if now - old.time > KEPT_DAYS * 86400.0:
            shutil.rmtree(old.folder, ignore_errors=True)
    # of a long name the beginning: the whole of it stands inside
    begins = f"{time.strftime('%Y%m%d-%H%M%S', time.localtime(now))}-{parts[0].name[:40]}-"
    with writing("bin", home, "bin"):
        home.mkdir(parents=True, exist_ok=True)
        entry = Deleted(Path(tempfile.mkdtemp(prefix=begins, dir=home)), path, now, why)
    try:
        write_text(entry.folder / ENTRY, json.dumps({"path": path, "time": now, "why": why}))
        _move([(part, entry.folder / CONTENT / part.name) for part in parts])
    except InputError:
        _forget(entry)
        raise
    return entry


def _forget(entry: Deleted) -> None:
    """Remove an entry of the bin, unless something lies in it that could not be moved back."""
    if not any((entry.folder / CONTENT).glob("*")):
        shutil.rmtree(entry.folder, ignore_errors=True)


def restore(root: Path, entry: Deleted) -> str:
    """Move something from the bin back to where it was; return its path from the project folder on.

    Where another thing has its name by now, it gets a number. Nothing is overwritten.
    """
    target = root / entry.path
    content = entry.folder / CONTENT
    names = sorted(path.name for path in content.iterdir()) if content.is_dir() else []
    if target.name not in names:
        raise InputError(f"'{entry.path}' is not in the bin any more", "file_not_found", "bin", entry.path)
    inside(root, entry.path)
    check_idle(root, entry.path)
    if not target.parent.is_dir() and target.parent.parent != root:
        message = f"'{target.parent.relative_to(root).as_posix()}' is not there. Restore it first"
        raise InputError(message, "file_not_found", "folder")
    old = _stem(content / target.name)
    stem = next(
        one for one in numbered(old) if not any((target.parent / name).exists() for name in _renamed(names, old, one))
    )
    after = _renamed(names, old, stem)
    _move([(content / name, target.parent / new) for name, new in zip(names, after)])
    _forget(entry)
    if stem != old:
        _follow_inside(target.parent, after, old, stem)
    return f"{target.parent.relative_to(root).as_posix()}/{after[names.index(target.name)]}"


@contextmanager
def undone_if_refused(root: Path, entry: Deleted) -> Iterator[None]:
    """Restore what was replaced when what takes its place is refused, so that a full disk changes nothing."""
    try:
        yield
    except InputError:
        restore(root, entry)
        raise


def rename(root: Path, path: str, name: str) -> str:
    """Give a file or folder of a project another name; return its new path from the project folder on.

    ``project.toml`` and the manifests of the project follow where they name a tissue or calibration that moved.
    """
    parts = parts_of(root, path)
    check_idle(root, path)
    source = parts[0]
    old, wanted = _stem(source), name.strip()
    if source.is_file() and wanted.lower().endswith(source.suffix.lower()):
        wanted = wanted[: len(wanted) - len(source.suffix)]
    if source.is_dir() and is_import(path) and not wanted.startswith("import-"):
        wanted = f"import-{wanted}" if wanted else ""
    if _is_tissue(path) and wanted.endswith(MANIFEST.removesuffix(".json")):
        raise InputError(f"a tissue cannot be called '{wanted}': choose another name", "bad_name", "name", wanted)
    plain_name(wanted)
    if wanted == old:
        return path
    after = [plain_name(one) for one in _renamed([part.name for part in parts], old, wanted)]
    taken = next((one for one in after if (source.parent / one).exists()), None)
    if taken is not None:
        raise InputError(f"'{taken}' is there already: choose another name", "file_exists", "name", taken)
    project = project_of(root)
    moves = [(part, source.parent / one) for part, one in zip(parts, after)]
    others = [] if source.parent.name not in ("tissue", "calibrations") else sorted(root.glob(f"*/*/{MANIFEST}"))
    before = {file: file.read_bytes() for file in [*others, *(parts if _is_tissue(path) else [])] if file.is_file()}
    new = f"{path.rpartition('/')[0]}/{after[0]}"
    _move(moves)
    try:
        _follow_inside(source.parent, after, old, wanted)
        for manifest in (one for one in others if one.is_file()):
            _follow_in_manifest(root, manifest, path, new)
        if project is not None:
            _follow_in_project(project, path, new)
    except Exception:
        _move([(now, part) for part, now in moves])
        for part, content in before.items():
            if part.read_bytes() != content:
                write_bytes(part, content)
        raise
    return new


def _follow_in_manifest(root: Path, manifest: Path, old: str, new: str) -> None:
    """Write the new path into a manifest that names a renamed tissue or calibration, so that its answer stays open."""
    kept, files = read_json(manifest), []
    with suppress(AttributeError, KeyError, TypeError):  # no command wrote such a manifest
        inputs = {key: follow(root, value, old, new) for key, value in kept["inputs"].items()}
        if inputs == kept["inputs"]:
            return
        for one in kept.get("files_read") or []:
            name = follow(root, one["name"], old, new)
            now = root / name.removeprefix("tissue ")
            files.append(one if name == one["name"] else {"name": name, "file": now.name, "sha256": sha256_of(now)})
        write_text(manifest, json.dumps(kept | {"inputs": inputs, "files_read": files}, indent=1) + "\n")


def _follow_in_project(project: Project, old: str, new: str) -> None:
    given = {key: text for key, text in project.given().items() if key in ("tissue", "calibration")}
    moved = {key: follow(project.root, text, old, new) for key, text in given.items()}
    if moved != given:
        change_project(project, **moved)


def follow(root: Path, text: Any, old: str, new: str) -> Any:
    """A path after something was renamed, for the thing itself and for what lies in it; all else as it is.

    It may be typed from the project folder on or whole, and have the word before it that manifests give a tissue.
    """
    named = rf"\A((?:tissue )?(?:{re.escape(f'{root}/')})?){re.escape(old)}(?=/|\Z)"
    return re.sub(named, lambda found: found[1] + new, text) if isinstance(text, str) else text


def is_import(path: str) -> bool:
    """Whether a path is that of a folder of imported presses."""
    return re.fullmatch(r"measured/import-[^/]*", path) is not None


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
    """The files or the folder of a thing of the project, itself first; a tissue has its report and data beside it."""
    words = path.split("/")
    inside(root, path)
    if len(words) < 2 or words[0] not in FOLDERS or not all(words):
        raise InputError(f"'{path}' belongs to no step of the project", "not_allowed", "path", path)
    target = root / path
    if not (target.exists() or target.is_symlink()):
        raise InputError(f"'{path}' is not there (any more)", "file_not_found", "path", path)
    if not _is_tissue(path):
        return [target]
    manifest = target.with_name(f"{target.stem}-{MANIFEST}")
    names = [name for name in _sums(manifest) if name.startswith(target.stem) and "/" not in name]
    others = [target.with_name(name) for name in dict.fromkeys([manifest.name, *names]) if name != target.name]
    return [target, *(one for one in others if one.is_file())]


def _is_tissue(path: str) -> bool:
    return path.startswith("tissue/") and path.endswith(".toml")


def short_name(root: Path, path: str) -> str:
    """What can be changed of the name of a thing."""
    return _stem(root / path).removeprefix("import-" if is_import(path) else "")


def _stem(path: Path) -> str:
    return path.name if path.is_dir() else path.stem


def _renamed(names: Sequence[str], old: str, new: str) -> list[str]:
    return [new + name[len(old) :] for name in names]


def _sums(manifest: Path) -> dict[str, Any]:
    sums = read_json(manifest).get("sha256")
    return sums if isinstance(sums, dict) else {}


def _follow_inside(folder: Path, names: Sequence[str], old: str, new: str) -> None:
    """Write a tissue's new name into its file and its manifest, so that a later fit knows its files again."""
    tissue, manifest = folder / f"{new}.toml", folder / f"{new}-{MANIFEST}"
    if folder.name != "tissue" or tissue.name not in names:
        return
    write_bytes(tissue, with_name(tissue.read_bytes(), new))
    if manifest.name not in names or not _sums(manifest):
        return
    kept = read_json(manifest)
    sums = {new + name[len(old) :] if name.startswith(old) else name: sum for name, sum in kept["sha256"].items()}
    write_text(manifest, json.dumps(kept | {"sha256": sums | {tissue.name: sha256_of(tissue)}}, indent=1) + "\n")


def _move(pairs: Sequence[tuple[Path, Path]]) -> None:
    """Rename all, or none: a copy in the place of a refused rename could lose what it copies."""
    done: list[tuple[Path, Path]] = []
    try:
        for start, end in pairs:
            end.parent.mkdir(exist_ok=True)
            start.rename(end)
            done.append((start, end))
    except OSError as problem:
        for start, end in reversed(done):
            with suppress(OSError):
                end.rename(start)
        raise unwritable("folder of", pairs[0][0].name, problem, "path") from None


@dataclass(frozen=True)
class Stored:
    """What became of a file that was sent."""

    name: str
    outcome: str
    sent: str
    gone: Deleted | None = None

    @property
    def text(self) -> str:
        """The same in a sentence."""
        return {
            "new": f"{self.name} was added.",
            "same": f"{self.sent} is there already: not copied."
            if self.name == self.sent
            else f"{self.sent} is the same as {self.name}, which is there: not copied.",
            "numbered": f"{self.sent} differs from the {self.sent} that is there. It was added as {self.name}.",
            "replaced": f"{self.name} was added. It replaces the earlier {self.name}.",
        }[self.outcome]


def store(root: Path, folder: Path, name: str, content: bytes) -> Stored:
    """Store a file that was sent."""
    plain_name(name)
    inside(root, folder.relative_to(root).as_posix())
    same = twin(folder, name, content)
    if same is not None:
        return Stored(same, "same", name)
    kept = save_upload(folder, name, content).name
    return Stored(kept, "new" if kept == name else "numbered", name)


def replace_file(root: Path, folder: Path, name: str, content: bytes) -> Deleted:
    """Write a file in the place of the one of its name, which goes to the bin; return that."""
    gone = delete(root, (folder / name).relative_to(root).as_posix(), "replaced")
    with undone_if_refused(root, gone):
        save_upload(folder, name, content)
    return gone


def take_back(root: Path, gone: Deleted) -> str:
    """Restore; what took the place of a file goes to the bin first."""
    there = (gone.folder / CONTENT).is_dir()
    if there and gone.why in ("replaced", "undone") and (root / gone.path).is_file():
        delete(root, gone.path, "undone")
    return restore(root, gone)


def twin(folder: Path, name: str, content: bytes) -> str | None:
    """Name of the file of a folder with the same content; the one of this name first."""
    for path in sorted(folder.glob("[!.]*"), key=lambda path: (path.name != name, path.name)):
        if holds(path, content):
            return path.name
    return None


def rename_over(root: Path, folder: Path, kept: str, name: str) -> Stored:
    """Let a file that got a number take the place of the one whose name it was sent with."""
    home = folder.relative_to(root).as_posix()
    gone = delete(root, f"{home}/{name}", "replaced")
    with undone_if_refused(root, gone):
        rename(root, f"{home}/{kept}", name)
    return Stored(name, "replaced", name, gone)
