"""Write an answer whole or not at all, never over the answer to another question."""

from __future__ import annotations

import dataclasses
import os
import platform
import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath, unwritable, write_text, writing
from dummydesign.core.manifest import KEY, NAME, Earlier, Question, manifest_text, read_manifest, records_of
from dummydesign.core.progress import check_stop

MARKS = (NAME, "report.html", "preview.html", "rows.csv", "study.json", "calibration.json", "compare.json")
"""Files by which a folder without a manifest is known as one that a command wrote."""
MOST = 1000


@dataclass(frozen=True)
class OutputTarget:
    """Folder and stem to write to, the files of an earlier answer that go, and warnings for the user."""

    folder: Path
    stem: str
    manifest: str
    old: tuple[str, ...] = ()
    warnings: tuple[dict[str, str], ...] = ()
    takes_over: bool = False


def choose_target(out: Path, question: Question, replace: bool, shared: bool = False) -> OutputTarget:
    """Choose where an answer goes: ``out`` or the next number after it that holds no answer to another question.

    ``shared`` is a file in a folder with others, with a folder beside it: ``STEM.toml`` and ``STEM-report``.
    """
    why = "holds the answer to other inputs"
    for number in range(1, MOST):
        path = out if number == 1 else _numbered(out, number, shared)
        target = OutputTarget(path, path.name, NAME)
        if shared:
            target = OutputTarget(path.parent, path.stem, f"{path.stem}-report/{NAME}")
        earlier = read_manifest(target.folder / target.manifest)
        if earlier is None and (path.exists() if shared else path.is_dir() and _marked(path)):
            earlier = Earlier(None, None, {})
        if earlier is None:
            break
        with_old = dataclasses.replace(target, old=tuple(earlier.sha256))
        if replace and number == 1:
            return _replaced(with_old, path)
        if earlier.key == question.key:
            changed = earlier.changed(target.folder)
            if not changed:
                return with_old
            if number == 1:
                why = f"was changed since it was written ({', '.join(changed[:3])})"
    else:
        message = f"'{out}' and {MOST - 2} numbers after it are taken; remove some, or use --replace"
        raise InputError(message, "file_exists", "out", str(out))
    if number == 1:
        return target
    message = f"'{out}' {why} and was kept; this answer is in '{path}' (--replace overwrites)"
    return dataclasses.replace(target, warnings=({"code": "output_numbered", "message": message},))


def _replaced(target: OutputTarget, path: Path) -> OutputTarget:
    """Take the place of an earlier answer; what no manifest lists is not removed, and is named."""
    known = {*target.old, target.manifest}
    there = path.iterdir() if path.is_dir() else ()
    left = sorted(one.name for one in there if one.name not in known and not one.name.startswith("."))
    warnings = []
    if left:
        some = ", ".join(left[:5]) + (f" and {len(left) - 5} more" if len(left) > 5 else "")
        message = f"'{path}' also holds files that its earlier manifest does not list, and they stay: {some}"
        warnings = [{"code": "output_left", "message": message}]
    return dataclasses.replace(target, warnings=tuple(warnings), takes_over=True)


def _numbered(out: Path, number: int, shared: bool) -> Path:
    """``OUT-2`` beside ``OUT``, also where it is given as ``.`` or ``..``; ``STEM-2.toml`` beside ``STEM.toml``."""
    if shared:
        return out.with_name(f"{out.stem}-{number}{out.suffix}")
    named = out if out.name not in ("", "..") else out.resolve()
    return named.with_name(f"{named.name}-{number}")


def _marked(folder: Path) -> bool:
    return any((folder / name).exists() for name in MARKS) or any(folder.glob("*.step"))


@dataclass(frozen=True)
class Output:
    """An answer that is being written."""

    target: OutputTarget
    work: Path
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Where the files will lie."""
        return self.target.folder

    def path(self, name: str) -> Path:
        """Where a file of this name is written now."""
        return self.work / name

    def settled(self, value: Any) -> Any:
        """The same plain value with every path as it will be: ``work`` becomes ``folder``."""
        if isinstance(value, Mapping):
            return {key: self.settled(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return type(value)(self.settled(item) for item in value)
        if isinstance(value, Path):
            value = str(value)
        if not isinstance(value, str):
            return value
        here = str(self.folder) == "."
        return (value.replace(f"{self.work}{os.sep}", "") if here else value).replace(str(self.work), str(self.folder))

    def answer(self, result: Mapping[str, Any]) -> dict[str, Any]:
        """Finish an answer: paths as they will be, the manifest among its ``files``, warnings among its
        ``warnings``."""
        answer = self.settled(result)
        answer["files"] = {**answer.get("files", {}), "manifest": str(self.folder / self.target.manifest)}
        answer["warnings"] = [*answer.get("warnings", []), *self.target.warnings]
        return answer


def new_folder(out: FilePath, question: Question, *, replace: bool = False) -> AbstractContextManager[Output]:
    """Write an answer into a folder of its own; see :func:`~dummydesign.core.outputs.choose_target`.

    Nothing is left when the body raises. When it ends, the manifest is written, the files of an earlier answer to
    the same question (or, with ``replace``, of the earlier answer) go, and the new ones are renamed into place.
    """
    return _written(choose_target(Path(out), question, replace), question)


def new_files(out: FilePath, question: Question, *, replace: bool = False) -> AbstractContextManager[Output]:
    """Write ``STEM.toml``, and ``STEM-report`` beside it, into a folder that others share; ``target.stem`` is the stem.

    See :func:`new_folder`.
    """
    return _written(choose_target(Path(out), question, replace, shared=True), question)


@contextmanager
def _written(target: OutputTarget, question: Question) -> Iterator[Output]:
    question.key  # noqa: B018  the files that are read are counted as they are now
    parent = target.folder if target.folder.exists() else target.folder.parent
    made = _make(parent)
    head = f".{target.folder.resolve().name}.part-{platform.node()}-"
    _sweep(parent, head)
    work = parent / f"{head}{os.getpid()}-{os.urandom(3).hex()}"
    try:
        with writing("output folder", target.folder, "out"):
            work.mkdir()
        output = Output(target, work)
        try:
            yield output
        except InputError as problem:
            given = output.settled([str(problem), problem.code, problem.quantity, problem.value, problem.allowed])
            raise InputError(*given) from None
        kept = records_of(target.folder / target.manifest, question)
        extra = {**output.extra, KEY: kept} if kept else output.extra
        write_text(work / target.manifest, manifest_text(question, work, _names(work), extra))
        check_stop()
        _settle(work, _met_meanwhile(target, question))
        made = []
    finally:
        shutil.rmtree(work, ignore_errors=True)
        _unmake(made)


def _met_meanwhile(target: OutputTarget, question: Question) -> OutputTarget:
    """Take the place of the same answer where another command has written it since the target was chosen."""
    now = None if target.old or target.takes_over else read_manifest(target.folder / target.manifest)
    if now is None:
        return target
    if now.key == question.key:
        return dataclasses.replace(target, old=tuple(now.sha256))
    message = f"'{target.folder}' was written by another command meanwhile; run this again, or name another --out"
    raise InputError(message, "changed_meanwhile", "out", str(target.folder))


def _settle(work: Path, target: OutputTarget) -> None:
    """Rename the finished folder, or its files into one that is there; undone when something fails on the way."""
    try:
        if not target.folder.exists():
            os.rename(work, target.folder)
            return
        _merge(work, target)
    except OSError as problem:
        raise unwritable("output folder", target.folder, problem, "out") from None


def _merge(work: Path, goal: OutputTarget) -> None:
    new = _names(work)
    for name in new:
        there = goal.folder / name
        if there.is_dir():
            message = f"'{there}' is a folder; a file of that name has to be written"
            raise InputError(message, "file_exists", "out", str(there))
        if there.exists() and name not in goal.old and name != goal.manifest and not goal.takes_over:
            message = f"'{there}' exists, and no command is known to have written it; name another --out"
            raise InputError(message, "file_exists", "out", str(there))
    trash = work.with_name(work.name.replace(".part-", ".old-"))
    moves: list[tuple[Path, Path]] = []
    try:
        for name in sorted({*goal.old, goal.manifest, *new}):
            if (goal.folder / name).is_file():
                _move(goal.folder / name, trash / name, moves)
        for name in new:
            _move(work / name, goal.folder / name, moves)
    except BaseException:
        for source, target in reversed(moves):
            os.replace(target, source)
        raise
    finally:
        if all((goal.folder / name).exists() for name in new):
            shutil.rmtree(trash, ignore_errors=True)


def _move(source: Path, target: Path, moves: list[tuple[Path, Path]]) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    os.replace(source, target)
    moves.append((source, target))


def _names(folder: Path) -> list[str]:
    """Files of a folder, those with dotted names and in dotted folders left out."""
    files = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in files if not any(part.startswith(".") for part in path.parts))


def _make(folder: Path) -> list[Path]:
    """Make a folder and its parents; return those that are new, the innermost last."""
    missing = list(takewhile(lambda path: not path.exists(), (folder, *folder.parents)))
    with writing("output folder", folder, "out"):
        folder.mkdir(parents=True, exist_ok=True)
    return missing[::-1]


def _unmake(made: list[Path]) -> None:
    with suppress(OSError):
        for path in reversed(made):
            path.rmdir()


def _sweep(parent: Path, head: str) -> None:
    """Take away what a command of this machine left that was killed without a chance to clear up."""
    if sys.platform == "win32":
        return
    for path in parent.iterdir():
        number = path.name[len(head) :].partition("-")[0]
        if path.name.startswith(head) and number.isdigit() and not _alive(int(number)):
            shutil.rmtree(path, ignore_errors=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except OSError as problem:
        return not isinstance(problem, ProcessLookupError)
    return True
