"""Commands that the pages start, each in a process and a folder of its own."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from pathlib import Path
from typing import Any

from dummydesign.core.blas_threads import surroundings
from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked, read_json, unwritable, write_text
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.core.manifest import sha256_of
from dummydesign.core.user_library import find
from dummydesign.geometry.punch import PROFILE
from dummydesign.studio import job_process as runner
from dummydesign.studio.file_transfer import check_there, inside


def as_typed(words: Sequence[str]) -> str:
    """A command line as it is typed; names with other letters than these are quoted."""
    return shlex.join(["dummydesign", *words])


def command(*words: str, **options: object) -> list[str]:
    """A command with those of its options that are not empty: numbers short, True as a bare flag."""
    typed = list(words)
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        text = f"{value:g}" if isinstance(value, int | float) else str(value or "").strip()
        if value is True:
            typed.append(option)
        elif value is not False and text:
            typed += [option, text]
    return typed


KINDS = {
    "tissue": "materials/tissues",
    "resin": "materials/resins",
    "mould preset": "molds",
    "silicone": "molds/silicones",
    "plastic": "molds/plastics",
    "machine": "molds/machines",
}
"""Files that a manifest lists by what they are and their name or path."""
SETTINGS = "materials/"
"""Weights, limits and the puck's error are listed by this and their name."""


def changed_inputs(root: Path, manifest: Path) -> list[str]:
    """Files that are gone or have another content than when a command read them."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        read = [(str(one["name"]), one["sha256"]) for one in read_json(manifest)["files_read"]]
        paths = [_path_of(root, name) for name, _ in read]
        # one that was gone already when its sum was taken has none, then as now
        return [name for (name, sha), path in zip(read, paths) if sha256_of(path) != sha or not path.exists()]
    return []


def _path_of(root: Path, name: str) -> Path:
    """Where a file of a manifest lies now: in the library by its kind and name, else in the project."""
    what = next((one for one in KINDS if name.startswith(f"{one} ")), "")
    called = name.removeprefix(f"{what} ")
    kind, _, stem = called.rpartition("/") if called.startswith(SETTINGS) else (KINDS.get(what, ""), "", called)
    if kind and not called.endswith(".toml"):
        with suppress(InputError):
            return find(kind, what or stem, stem).path
    return root / called


def holds_answer(root: Path, folder: str, answer: Mapping[str, Any]) -> bool:
    """Whether a folder still holds an answer: it may be gone, or another command has written it since."""
    kept, asked = read_json(root / folder / MANIFEST).get("inputs"), answer.get("inputs") or {}
    same = not isinstance(kept, dict) or all(kept[name] == asked[name] for name in kept.keys() & asked.keys())
    return (root / folder).exists() and same


def changed_since(paths: Iterable[Path], started: float) -> bool:
    """Whether a file was written after a command began."""
    return any(path.stat().st_mtime > started for path in paths if path.is_file())


HOME = ".studio"
STARTING_S = 120.0
"""On systems where a lock cannot be handed on: a command that did not begin within this time never will. [s]"""
MOST_KEPT = 100
"""Commands of a step that ended and are kept, the newest ones: pages look at all of them twice a second."""
UNEXPECTED = "the process stopped unexpectedly (machine switched off, disk or memory full?): run it again"
_CHILDREN: list[subprocess.Popen[bytes]] = []
"""Processes that this one started; looked at now and then, so that those that ended are let go."""


@dataclass(frozen=True)
class Job:
    """Commands that were started one after the other, mostly one, as they are now."""

    folder: Path
    name: str
    commands: tuple[tuple[str, ...], ...]
    state: str
    started: float
    seconds: float
    progress: str = ""

    @property
    def words(self) -> tuple[str, ...]:
        """The command; of several the last, whose answer counts."""
        return self.commands[-1]

    @property
    def begun(self) -> str:
        """The commands that were begun, as they are typed."""
        count = len(self.commands)
        files = (self.folder / runner.answer_name(number, count) for number in range(1, count + 1))
        return "; ".join(
            [as_typed(words) for words, file in zip(self.commands, files) if file.is_file()]
            or [as_typed(self.commands[0])]
        )

    @property
    def has_answer(self) -> bool:
        """Whether it ended with an answer, also with one that is not acceptable; an error is none."""
        return self.state in ("done", "failed") and bool(self.answer)

    @cached_property
    def answer(self) -> dict[str, Any]:
        """What the command printed; empty where it printed no answer, or only an error."""
        content = self.answer_of(len(self.commands))
        return {} if set(content) == {"error"} else content

    def answer_of(self, number: int) -> dict[str, Any]:
        """What one of several commands printed, the first being number 1."""
        return read_json(self.folder / runner.answer_name(number, len(self.commands)))

    @property
    def log(self) -> str:
        """What the command wrote beside its answer."""
        try:
            return (self.folder / runner.ERRORS).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:
            return ""

    @property
    def error(self) -> str:
        """What went wrong by the command's own words, without ``error:``; empty when nothing did."""
        if self.state == "stopped":
            return "stopped before it was done; nothing half-written is left"
        if self.state == "lost":
            return UNEXPECTED
        lines = self.log.splitlines()
        errors = [line.removeprefix("error: ") for line in lines if line.startswith("error: ")]
        if errors or self.state != "failed":
            return errors[-1] if errors else ""
        return lines[-1] if lines else "" if self.answer else UNEXPECTED


def start(root: Path, name: str, *commands: Sequence[str]) -> Job:
    """Start a command in a project folder, or several one after the other."""
    for word in chain(*commands):
        if word.startswith(PROFILE):
            inside(root, word.removeprefix(PROFILE))
    own = [one for one in all_jobs(root, name) if one.name == name]
    if any(one.state == "running" for one in own):
        raise InputError("this step is still at work: wait for it, or stop it", "busy", "step", name)
    home = root / HOME / "jobs"
    for one in own[:-MOST_KEPT]:
        shutil.rmtree(one.folder, ignore_errors=True)
    try:
        home.mkdir(parents=True, exist_ok=True)
        numbers = [int(match[1]) for path in home.iterdir() if (match := re.match(r"(\d+)-", path.name))]
        folder = home / f"{max(numbers, default=0) + 1:04d}-{name}"
        folder.mkdir()
        try:
            asked = {"name": name, "first": commands[:-1], "words": commands[-1], "start": time.time()}
            write_text(folder / runner.COMMAND, json.dumps(asked))
            _spawn(root, folder)
        except (OSError, InputError):
            shutil.rmtree(folder, ignore_errors=True)
            raise
    except OSError as problem:
        if problem.filename == sys.executable:
            message = f"'{sys.executable}' cannot be run: {problem.strerror or problem}"
            raise InputError(message, "program_failed", "python") from None
        raise unwritable("folder", home, problem, "folder") from None
    return read_job(folder)


def usual_s(name: str) -> float | None:
    """How long the last runs of a step took on this machine, in all projects, the middle; None before the first. [s]"""
    taken = read_json(runner.times_file()).get(name)
    return statistics.median(map(float, taken)) if taken else None


def progress_line(job: Job, usual: float | None) -> str:
    """How far a running command is; the time left is learned from earlier runs, not extrapolated from its steps."""
    # how many steps a search has is known at its end alone
    text = re.sub(r"step \d+ of about \d+: |, about \d+ (s|min) left$", "", job.progress) or "at work"
    left = (usual or 0.0) - job.seconds
    if left < 1.0 or text.endswith(runner.WAITING):
        return f"{text} – {job.seconds:.0f} s"
    rest = f"{left:.0f} s" if left < 90.0 else f"{left / 60.0:.0f} min"
    return f"{text} – {job.seconds:.0f} s, about {rest} left"


def _spawn(root: Path, folder: Path) -> None:
    _CHILDREN[:] = [child for child in _CHILDREN if child.poll() is None]
    # held from the first moment on, however long a busy machine takes to start the process
    lock = None if os.name == "nt" else acquire_lock(folder / runner.LOCK, runner.PATIENCE_S)
    handed_on = () if lock is None else (lock.fileno(),)
    with lock or nullcontext(), open(folder / "runner.txt", "wb") as output:
        _CHILDREN.append(
            subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "dummydesign.studio.job_process",
                    str(folder.relative_to(root)),
                    *map(str, handed_on),
                ],
                cwd=root,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                env=surroundings(),
                pass_fds=handed_on,
                start_new_session=True,
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        )


def read_job(folder: Path) -> Job:
    """How a command stands."""
    asked = json.loads((folder / runner.COMMAND).read_text(encoding="utf-8"))
    started, commands = float(asked["start"]), [*asked.get("first", []), asked["words"]]
    if not (0.0 <= started < 1e11 and all(isinstance(word, str) for word in chain([asked["name"]], *commands))):
        raise ValueError("not written by a studio")
    state, seconds = _state(folder, started)
    progress = ""
    if state == "running":
        with suppress(OSError):
            progress = (folder / runner.PROGRESS).read_text(encoding="utf-8")
        if len(commands) > 1:
            number = sum((folder / runner.answer_name(k + 1, len(commands))).exists() for k in range(len(commands)))
            progress = f"step {max(number, 1)} of {len(commands)}: {progress or 'at work'}"
    return Job(folder, asked["name"], tuple(map(tuple, commands)), state, started, seconds, progress)


def _state(folder: Path, started: float) -> tuple[str, float]:
    # in this order: it may end between the two looks
    held = is_locked(folder / runner.LOCK)
    if not (folder / runner.STATUS).exists():
        young = os.name == "nt" and not (folder / runner.PID).exists() and time.time() - started < STARTING_S
        return ("running" if held or young else "lost"), time.time() - started
    ended = json.loads((folder / runner.STATUS).read_text(encoding="utf-8"))
    seconds = float(ended["end"]) - started
    if ended["stopped"]:
        return "stopped", seconds
    return ("done" if ended["status"] == 0 else "failed"), seconds


def all_jobs(root: Path, name: str = "*") -> list[Job]:
    """Return all commands of a project, or of a step, the oldest first; pages ask for them twice a second."""
    check_there(root)
    jobs = []
    folders = (root / HOME / "jobs").glob(f"[0-9]*-{name}")
    for folder in sorted(folders, key=runner.place_in_queue):
        with suppress(OSError, ValueError, KeyError, TypeError, OverflowError):
            status = folder / runner.STATUS
            jobs.append(_ended_job(folder, status.stat().st_mtime_ns) if status.exists() else read_job(folder))
    return jobs


@lru_cache(maxsize=4096)
def _ended_job(folder: Path, stamp: int) -> Job:
    return read_job(folder)


def latest(root: Path, name: str) -> Job | None:
    """Return the newest command of a step."""
    return next(reversed(all_jobs(root, name)), None)


def is_last(root: Path, job: Job, made: Callable[[Job], str]) -> bool:
    """Whether no later command of the step made the same file or folder, which took the place of this one's."""
    return next((one for one in reversed(all_jobs(root, job.name)) if made(one) == made(job)), job).folder == job.folder


def is_there(root: Path, job: Job, made: Callable[[Job], str]) -> bool:
    """Whether what a command made is still there, and no other command has written it since."""
    path = made(job)
    return not path or (holds_answer(root, path, job.answer) and is_last(root, job, made))


def stop(job: Job) -> None:
    """Ask a running command to end and to clear up; by a file, which also one that is only starting finds."""
    if not is_locked(job.folder / runner.LOCK):
        return
    # a command without its runner, which was killed, reads no file
    number = runner.PID if is_locked(job.folder / runner.AWAKE) else runner.CHILD
    with suppress(OSError):  # a full disk
        (job.folder / runner.STOP).touch()
        if number == runner.PID:
            return
    with suppress(FileNotFoundError, ProcessLookupError, ValueError):
        process = int((job.folder / number).read_text(encoding="utf-8"))
        if is_locked(job.folder / runner.LOCK) and not (job.folder / runner.STATUS).exists():
            os.kill(process, signal.SIGTERM)
