"""The process that runs a command of the studio: ``python -m dummydesign.studio.job_process FOLDER [LOCK]``.

It is started in the project folder, and FOLDER is named from there: a project folder that is renamed is followed.

LOCK is the number of an open file that holds the folder's lock already, handed on by the studio. The process outlives
page and studio, holds the lock as long as it runs, ends its command when a file ``stop`` appears, and writes
``status.json`` at the end. Its command holds the lock too, so that one whose runner was killed is still known.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext, suppress
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked, read_json, write_text
from dummydesign.core.progress import VARIABLE
from dummydesign.core.user_library import user_folder

COMMAND, ANSWER, ERRORS, PROGRESS, STATUS = "command.json", "answer.json", "errors.txt", "progress.txt", "status.json"
LOCK, PID, STOP, CHILD, AWAKE = "lock", "pid", "stop", "child", "awake"
"""Files of the folder; ``awake`` is a lock of the runner alone."""
PATIENCE_S = 5.0
"""How long to wait for a lock that someone only looks at. [s]"""
GRACE_S = 120.0
"""How long a command that was stopped may take to clear up. [s]"""
POLL_S = 0.25
MOST_AT_ONCE = 2
"""Commands of a project that may run at once, each may fill a processor; later ones wait for their turn."""
WAITING = "waits for its turn"


def answer_name(number: int, of: int) -> str:
    """Name of the file with the answer of one of several commands; that of the last is the answer of the job."""
    return ANSWER if number == of else f"{number}-{ANSWER}"


def main(folder: Path, handed_on: int | None = None) -> int:
    """Run the command of a folder, after those that come first, and write how it ended; return its exit status."""
    lock = acquire_lock(folder / LOCK, PATIENCE_S) if handed_on is None else open(handed_on, "a", encoding="utf-8")
    if lock is None:
        return 2
    with lock, acquire_lock(folder / AWAKE, PATIENCE_S) or nullcontext():
        asked = json.loads((folder / COMMAND).read_text(encoding="utf-8"))
        _note(folder / PID, os.getpid())
        signals: list[int] = []
        signal.signal(signal.SIGTERM, lambda number, frame: signals.append(number))

        def asked_to_stop() -> bool:
            return bool(signals) or (folder / STOP).exists()

        while not (stopped := asked_to_stop()) and not is_turn(folder):
            _note(folder / PROGRESS, WAITING)
            time.sleep(POLL_S)
        start, status = time.time(), 0
        environment = {**os.environ, VARIABLE: str(folder / PROGRESS)}
        commands = [*asked.get("first", []), asked["words"]]
        for number, words in enumerate([] if stopped else commands, 1):
            # The command that ends the job is the last that writes its errors.
            with (
                open(folder / answer_name(number, len(commands)), "wb") as answer,
                open(folder / ERRORS, "wb") as errors,
            ):
                child = subprocess.Popen(
                    [sys.executable, "-m", "dummydesign", *words, "--json"],
                    stdout=answer,
                    stderr=errors,
                    stdin=subprocess.DEVNULL,
                    env=environment,
                    pass_fds=() if os.name == "nt" else (lock.fileno(),),
                )
            _note(folder / CHILD, child.pid)
            status, stopped = _wait(child, asked_to_stop)
            if status or stopped:
                break
        ended = {"status": status, "stopped": stopped, "start": start, "end": time.time()}
        write_text(folder / STATUS, json.dumps(ended))
    if status in (0, 1) and not stopped:
        remember(asked.get("name", ""), ended["end"] - start)
    return status


def is_turn(folder: Path) -> bool:
    """Whether fewer than ``MOST_AT_ONCE`` jobs that were started before this one are not done yet."""
    earlier = (one for one in folder.parent.glob("[0-9]*-*") if place_in_queue(one) < place_in_queue(folder))
    return sum(not (one / STATUS).exists() and is_locked(one / LOCK) for one in earlier) < MOST_AT_ONCE


def place_in_queue(folder: Path) -> tuple[int, str]:
    """Return what the folders of jobs are ordered by: their numbers, of which the ten-thousandth has a digit more."""
    return folder.name.index("-"), folder.name


def _note(path: Path, text: object) -> None:
    """Write a number or a word; a disk that is full just now must not leave a command without its runner."""
    with suppress(InputError):
        write_text(path, str(text))


def times_file() -> Path:
    """File of the user with how long the last runs of each step took on this machine. [s]"""
    return user_folder() / "studio-times.json"


def remember(name: str, seconds: float) -> None:
    """Keep how long a step took; where that cannot be written, the next time left is less sure, no more."""
    kept = read_json(times_file())
    kept[name] = [*kept.get(name, []), round(seconds, 1)][-5:]
    with suppress(InputError, OSError):
        times_file().parent.mkdir(parents=True, exist_ok=True)
        write_text(times_file(), json.dumps(kept))


def _wait(child: subprocess.Popen[bytes], asked_to_stop: Callable[[], bool]) -> tuple[int, bool]:
    """Wait for the child; one that is to stop and does not end is killed. Return its status and whether it was."""
    since = math.inf
    while True:
        with suppress(subprocess.TimeoutExpired):
            return child.wait(POLL_S), since < math.inf
        if since == math.inf and asked_to_stop():
            since = time.monotonic()
            child.terminate()
        elif time.monotonic() - since > GRACE_S:
            child.kill()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), *map(int, sys.argv[2:3])))
