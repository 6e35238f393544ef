"""Commands that the studio started: each in a folder of its own under ``.studio/jobs``, so that a restart knows all."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.studio.work import job as runner
from dummydesign.studio.work.lock import held, take

HOME = ".studio"
MOST_AT_ONCE = 2
"""Commands that may run at once: each may fill a processor."""
STARTING_S = 120.0
"""On systems where a lock cannot be handed on: a command that did not begin within this time never will. [s]"""
UNEXPECTED = "the process stopped unexpectedly (machine switched off, disk or memory full?): run it again"
_CHILDREN: list[subprocess.Popen[bytes]] = []
"""Processes that this one started; looked at now and then, so that those that ended are let go."""


@dataclass(frozen=True)
class Job:
    """A command that was started, as it is now.

    Attributes
    ----------
    folder : Path
    name : str
        Which step it belongs to.
    words : tuple of str
        The command line after ``dummydesign``.
    state : str
        running, done, failed, stopped, or lost (the machine went down, or the process was killed).
    started, seconds : float
        When it began [s since 1970], and how long it has taken. [s]
    progress : str
        What it is doing.
    """

    folder: Path
    name: str
    words: tuple[str, ...]
    state: str
    started: float
    seconds: float
    progress: str = ""

    @property
    def answer(self) -> dict[str, Any]:
        """What the command printed; empty where it printed no answer."""
        path = self.folder / runner.ANSWER
        try:
            return _answer(path, path.stat().st_mtime_ns)
        except (OSError, ValueError):
            return {}

    @property
    def error(self) -> str:
        """What the command said went wrong, without ``error:``; empty when nothing did."""
        if self.state == "stopped":
            return "stopped before it was done; nothing half-written is left"
        if self.state == "lost":
            return UNEXPECTED
        try:
            lines = (self.folder / runner.ERRORS).read_text(encoding="utf-8", errors="replace").strip().splitlines()
        except OSError:
            return ""
        said = [line.removeprefix("error: ") for line in lines if line.startswith("error: ")]
        if said or self.state != "failed":
            return said[-1] if said else ""
        return lines[-1] if lines else "" if self.answer else UNEXPECTED


@lru_cache(maxsize=16)
def _answer(path: Path, stamp: int) -> dict[str, Any]:
    found = json.loads(path.read_text(encoding="utf-8"))
    return found if isinstance(found, dict) else {}


def start(root: Path, name: str, words: Sequence[str]) -> Job:
    """Start a command in a project folder.

    Parameters
    ----------
    root : Path
        The project folder, in which it runs.
    name : str
        Which step it belongs to; only one of a step runs at a time.
    words : sequence of str
        The command line after ``dummydesign``.

    Raises
    ------
    InputError
        When one of this step is running, or too many are, or the folder cannot be written.
    """
    running = [one for one in all_jobs(root) if one.state == "running"]
    if any(one.name == name for one in running):
        raise InputError("this step is still at work: wait for it, or stop it")
    if len(running) >= MOST_AT_ONCE:
        raise InputError(f"{len(running)} commands are at work: wait for one, or stop one")
    home = root / HOME / "jobs"
    folder = None
    try:
        home.mkdir(parents=True, exist_ok=True)
        folder = _new_folder(home, name)
        asked = {"name": name, "words": list(words), "cwd": str(root), "start": time.time()}
        write_text(folder / runner.COMMAND, json.dumps(asked))
        _spawn(root, folder)
    except (OSError, InputError) as problem:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
        if isinstance(problem, InputError):
            raise
        refused = problem.filename == sys.executable
        what = f"'{sys.executable}' cannot be run" if refused else f"'{home}' cannot be written"
        raise InputError(f"{what}: {problem.strerror or problem}") from None
    return read_job(folder)


def _spawn(root: Path, folder: Path) -> None:
    apart: dict[str, Any] = {"start_new_session": True}
    if os.name == "nt":
        apart = {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
    package = str(Path(__file__).resolve().parents[3])
    path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
    _CHILDREN[:] = [child for child in _CHILDREN if child.poll() is None]
    words = [sys.executable, "-m", "dummydesign.studio.work.job", str(folder)]
    lock = None if os.name == "nt" else take(folder / runner.LOCK, runner.PATIENCE_S)
    if lock is not None:
        # held from the first moment on, however long a busy machine takes to start the process
        apart["pass_fds"] = (lock.fileno(),)
        words.append(str(lock.fileno()))
    try:
        with open(folder / "runner.txt", "wb") as said:
            child = subprocess.Popen(
                words, cwd=root, stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                env={**os.environ, "PYTHONPATH": path}, **apart,
            )  # fmt: skip
    finally:
        if lock is not None:
            lock.close()
    _CHILDREN.append(child)


def _new_folder(home: Path, name: str) -> Path:
    numbers = [int(found[1]) for path in home.iterdir() if (found := re.match(r"(\d+)-", path.name))]
    number = max(numbers, default=0)
    while True:
        number += 1
        folder = home / f"{number:04d}-{name}"
        try:
            folder.mkdir()
            return folder
        except FileExistsError:
            continue


def read_job(folder: Path) -> Job:
    """How a command stands."""
    asked = json.loads((folder / runner.COMMAND).read_text(encoding="utf-8"))
    started = float(asked["start"])
    if not (0.0 <= started < 1e11 and all(isinstance(word, str) for word in [asked["name"], *asked["words"]])):
        raise ValueError("not written by a studio")
    state, seconds = _state(folder, started)
    progress = ""
    if state == "running":
        try:
            progress = (folder / runner.PROGRESS).read_text(encoding="utf-8")
        except OSError:
            progress = ""
    return Job(folder, asked["name"], tuple(asked["words"]), state, started, seconds, progress)


def _state(folder: Path, started: float) -> tuple[str, float]:
    if not (folder / runner.STATUS).exists():
        if held(folder / runner.LOCK):
            return "running", time.time() - started
        # it may have ended between the two looks
        if not (folder / runner.STATUS).exists():
            young = os.name == "nt" and not (folder / runner.PID).exists() and time.time() - started < STARTING_S
            return ("running" if young else "lost"), time.time() - started
    told = json.loads((folder / runner.STATUS).read_text(encoding="utf-8"))
    seconds = float(told["end"]) - started
    if told["stopped"]:
        return "stopped", seconds
    return ("done" if told["status"] == 0 else "failed"), seconds


def all_jobs(root: Path) -> list[Job]:
    """All commands of a project, the oldest first."""
    found = []
    for folder in sorted((root / HOME / "jobs").glob("*-*")):
        try:
            found.append(read_job(folder))
        except (OSError, ValueError, KeyError, TypeError):
            continue
    return found


def named(root: Path, name: str) -> list[Job]:
    """All commands of a step, the oldest first; pages ask for them twice a second, so those that ended are kept."""
    found = []
    for folder in sorted((root / HOME / "jobs").glob(f"[0-9]*-{name}")):
        try:
            status = folder / runner.STATUS
            found.append(_ended_job(folder, status.stat().st_mtime_ns) if status.exists() else read_job(folder))
        except (OSError, ValueError, KeyError, TypeError):
            continue
    return found


@lru_cache(maxsize=512)
def _ended_job(folder: Path, stamp: int) -> Job:
    return read_job(folder)


def latest(root: Path, name: str) -> Job | None:
    """The newest command of a step."""
    for folder in sorted((root / HOME / "jobs").glob(f"[0-9]*-{name}"), reverse=True):
        try:
            return read_job(folder)
        except (OSError, ValueError, KeyError, TypeError):
            continue
    return None


def is_last(root: Path, job: Job, made: Callable[[Job], str]) -> bool:
    """Whether no later command of the step made the same file or folder, which took the place of this one's.

    Parameters
    ----------
    root : Path
        The project folder.
    job : Job
    made : callable
        What a job made, from the project folder on; empty for nothing.
    """
    same = [one for one in named(root, job.name) if made(one) == made(job)]
    return not same or same[-1].folder == job.folder


def stop(job: Job) -> None:
    """Ask a running command to end and to clear up; by a file, which also one that is only starting finds."""
    if not held(job.folder / runner.LOCK):
        return
    # a command without its runner, which was killed, reads no file
    number = runner.PID if held(job.folder / runner.AWAKE) else runner.CHILD
    try:
        (job.folder / runner.STOP).touch()
        if number == runner.PID:
            return
    except OSError:
        # a full disk
        pass
    with suppress(FileNotFoundError, ProcessLookupError, ValueError):
        process = int((job.folder / number).read_text(encoding="utf-8"))
        if held(job.folder / runner.LOCK) and not (job.folder / runner.STATUS).exists():
            os.kill(process, signal.SIGTERM)
