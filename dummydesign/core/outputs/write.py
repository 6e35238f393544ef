"""Write an answer whole or not at all: into a folder with a dotted name beside its place, renamed when complete."""

from __future__ import annotations

import os
import platform
import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from secrets import token_hex
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.outputs.manifest import Question, manifest_text
from dummydesign.core.outputs.place import MARKS, Place, choose_files, choose_folder
from dummydesign.core.outputs.progress import check_stop
from dummydesign.core.outputs.records import KEY, records_of


@dataclass(frozen=True)
class Output:
    """An answer that is being written.

    Attributes
    ----------
    place : Place
        Where it will lie.
    work : Path
        Folder to write into now.
    extra : dict
        Further fields for the manifest.
    """

    place: Place
    work: Path
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Where the files will lie."""
        return self.place.folder

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
        """Finish an answer: paths as they will be, the manifest among its ``files``, what must be told among its
        ``warnings``."""
        found = self.settled(result)
        found["files"] = {**found.get("files", {}), "manifest": str(self.folder / self.place.manifest)}
        found["warnings"] = [*found.get("warnings", []), *self.place.warnings]
        return found


@contextmanager
def new_folder(out: str | os.PathLike[str], question: Question, *, replace: bool = False) -> Iterator[Output]:
    """Write an answer into a folder of its own; see :func:`~dummydesign.core.outputs.place.choose_folder`.

    Nothing is left when the body raises. When it ends, the manifest is written, the files of an earlier answer to
    the same question (or, with ``replace``, of the earlier answer) go, and the new ones are renamed into place.

    Parameters
    ----------
    out : path
        The folder that is wished for.
    question : Question
        What is answered: command, inputs, files that are read.
    replace : bool
        Whether an answer to another question that lies there goes; else the next free number is taken.

    Yields
    ------
    Output
        Whose ``work`` the body writes into.

    Raises
    ------
    InputError
        When the place cannot be written, tried before the body starts, or when a file that no command is known to
        have written stands in the way.
    """
    with _written(choose_folder(Path(out), question, replace), question) as output:
        yield output


@contextmanager
def new_files(out: str | os.PathLike[str], question: Question, *, replace: bool = False) -> Iterator[Output]:
    """Write a set of files with one stem into a folder that others share; ``place.stem`` is the stem to use.

    See :func:`new_folder`.

    Parameters
    ----------
    out : path
        Path of the first file; its stem is that of all.
    question, replace
        As for :func:`new_folder`.
    """
    with _written(choose_files(Path(out), question, replace), question) as output:
        yield output


@contextmanager
def growing_folder(
    out: str | os.PathLike[str], question: Question, *, replace: bool = False, go_on: bool = False
) -> Iterator[Output]:
    """Write rows that an interrupted command keeps, to go on with later: straight into the folder.

    The manifest says ``finished: false`` until the body has ended. A folder that was made for nothing but it goes
    when the body raises without having written a file.

    Parameters
    ----------
    out, question, replace
        As for :func:`new_folder`.
    go_on : bool
        Whether the rows that lie there already are kept.
    """
    place = choose_folder(Path(out), question, replace, go_on)
    made = _make(place.folder)
    output = Output(place, place.folder)
    before = set(_names(place.folder))
    try:
        _try(place.folder)
        for name in () if go_on else place.old:
            (place.folder / name).unlink(missing_ok=True)
        write_text(place.folder / place.manifest, manifest_text(question, place.folder, None))
        yield output
        # rows of earlier runs are part of the answer
        ours = {*place.old, *MARKS, *(name for name in _names(place.folder) if name not in before)} - {place.manifest}
        names = [name for name in _names(place.folder) if name in ours]
        write_text(place.folder / place.manifest, manifest_text(question, place.folder, names, output.extra))
    except BaseException:
        if made and not [name for name in _names(place.folder) if name != place.manifest]:
            (place.folder / place.manifest).unlink(missing_ok=True)
            _unmake(made)
        raise


@contextmanager
def _written(place: Place, question: Question) -> Iterator[Output]:
    question.key  # noqa: B018  the files that are read are counted as they are now
    new = not place.folder.exists()
    made = _make(place.folder.parent if new else place.folder)
    beside = place.folder.parent if new else place.folder
    head = f".{place.folder.resolve().name}.part-{platform.node()}-"
    _sweep(beside, head)
    work = beside / f"{head}{os.getpid()}-{token_hex(3)}"
    try:
        try:
            work.mkdir()
        except OSError as problem:
            raise InputError(f"output folder '{place.folder}' cannot be written: {_why(problem)}") from None
        output = Output(place, work)
        try:
            yield output
        except InputError as problem:
            raise InputError(output.settled(str(problem))) from None
        kept = records_of(place.folder / place.manifest, question)
        extra = {**output.extra, KEY: kept} if kept else output.extra
        write_text(work / place.manifest, manifest_text(question, work, _names(work), extra))
        check_stop()
        _settle(work, place)
        made = []
    finally:
        shutil.rmtree(work, ignore_errors=True)
        _unmake(made)


def _settle(work: Path, place: Place) -> None:
    """Rename the finished folder, or its files into one that is there; undone when something fails on the way."""
    try:
        if not place.folder.exists():
            os.rename(work, place.folder)
            return
        _merge(work, place)
    except OSError as problem:
        raise InputError(f"output folder '{place.folder}' cannot be written: {_why(problem)}") from None


def _merge(work: Path, place: Place) -> None:
    new = _names(work)
    for name in new:
        there = place.folder / name
        if there.is_dir():
            raise InputError(f"'{there}' is a folder; a file of that name has to be written")
        if there.exists() and name not in place.old and name != place.manifest and not place.takes_over:
            raise InputError(f"'{there}' is in the way: no command is known to have written it; name another --out")
    trash = work.with_name(work.name.replace(".part-", ".old-"))
    moves: list[tuple[Path, Path]] = []
    try:
        for name in sorted({*place.old, place.manifest, *new}):
            if (place.folder / name).is_file():
                _move(place.folder / name, trash / name, moves)
        for name in new:
            _move(work / name, place.folder / name, moves)
    except BaseException:
        for source, target in reversed(moves):
            os.replace(target, source)
        raise
    finally:
        if all((place.folder / name).exists() for name in new):
            shutil.rmtree(trash, ignore_errors=True)


def _move(source: Path, target: Path, moves: list[tuple[Path, Path]]) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    os.replace(source, target)
    moves.append((source, target))


def _names(folder: Path) -> list[str]:
    """Files of a folder, those with dotted names and in dotted folders left out."""
    found = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in found if not any(part.startswith(".") for part in path.parts))


def _make(folder: Path) -> list[Path]:
    """Make a folder and its parents; return those that are new, the innermost last."""
    missing = []
    for path in (folder, *folder.parents):
        if path.exists():
            break
        missing.append(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise InputError(f"output folder '{folder}' cannot be written: {_why(problem)}") from None
    return missing[::-1]


def _unmake(made: list[Path]) -> None:
    for path in reversed(made):
        try:
            path.rmdir()
        except OSError:
            return


def _try(folder: Path) -> None:
    probe = folder / f".try-{os.getpid()}"
    try:
        probe.touch()
        probe.unlink()
    except OSError as problem:
        raise InputError(f"output folder '{folder}' cannot be written: {_why(problem)}") from None


def _why(problem: OSError) -> str:
    return problem.strerror or str(problem)


def _sweep(beside: Path, head: str) -> None:
    """Take away what a command of this machine left that was killed without a chance to clear up."""
    if sys.platform == "win32":
        return
    for path in beside.iterdir():
        number = path.name[len(head) :].partition("-")[0]
        if path.name.startswith(head) and number.isdigit() and not _alive(int(number)):
            shutil.rmtree(path, ignore_errors=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
