"""The process that runs one command of the studio: ``python -m dummydesign.studio.work.job FOLDER``.

It outlives page and studio, holds the lock of its folder as long as it runs, and writes ``status.json`` at the end.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import FrameType

from dummydesign.core.files import write_text
from dummydesign.core.outputs.progress import VARIABLE
from dummydesign.studio.work.lock import take

COMMAND, ANSWER, ERRORS, PROGRESS, STATUS, LOCK, PID = (
    "command.json", "answer.json", "errors.txt", "progress.txt", "status.json", "lock", "pid",
)  # fmt: skip
GRACE_S = 20.0
"""How long a command that was stopped may take to clear up. [s]"""


def main(folder: Path) -> int:
    """Run the command of a folder and write how it ended; return its exit status."""
    lock = take(folder / LOCK)
    if lock is None:
        return 2
    asked = json.loads((folder / COMMAND).read_text(encoding="utf-8"))
    (folder / PID).write_text(str(os.getpid()), encoding="utf-8")
    stopped = False
    start = time.time()
    environment = {**os.environ, VARIABLE: str((folder / PROGRESS).resolve())}
    with open(folder / ANSWER, "wb") as answer, open(folder / ERRORS, "wb") as errors:
        child = subprocess.Popen(
            [sys.executable, "-m", "dummydesign", *asked["words"], "--json"], cwd=asked["cwd"], stdout=answer,
            stderr=errors, stdin=subprocess.DEVNULL, env=environment,
        )  # fmt: skip

        def stop(number: int, frame: FrameType | None) -> None:
            nonlocal stopped
            stopped = True
            child.terminate()

        signal.signal(signal.SIGTERM, stop)
        status = _wait(child, lambda: stopped)
    told = {"status": status, "stopped": stopped, "start": start, "end": time.time()}
    write_text(folder / STATUS, json.dumps(told))
    lock.close()
    return status


def _wait(child: subprocess.Popen[bytes], stopped: object) -> int:
    """Wait for the child; one that was stopped and does not end is killed."""
    since: float | None = None
    while True:
        try:
            return child.wait(0.5)
        except subprocess.TimeoutExpired:
            if callable(stopped) and stopped():
                since = since or time.monotonic()
                if time.monotonic() - since > GRACE_S:
                    child.kill()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
