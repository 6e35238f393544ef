"""One holder at a time: a lock on a file that ends with the process that holds it, however it ends."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import IO


def take(path: Path, patience_s: float = 0.0) -> IO[str] | None:
    """Lock a file, made when needed; None when another process holds it. Keep what is returned as long as it counts.

    Parameters
    ----------
    path : Path
    patience_s : float
        How long to try; ``held`` holds a lock for a moment. [s]
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    until = time.monotonic() + patience_s
    stream = open(path, "a+", encoding="utf-8")
    while True:
        try:
            _lock(stream)
            return stream
        except OSError:
            if time.monotonic() >= until:
                stream.close()
                return None
        time.sleep(0.01)


def held(path: Path) -> bool:
    """Whether another process holds the lock of a file."""
    if not path.exists():
        return False
    # for reading alone: a folder that cannot be written any more still tells what runs in it
    with open(path, encoding="utf-8") as stream:
        try:
            _lock(stream)
        except OSError:
            return True
    return False


def _lock(stream: IO[str]) -> None:
    if os.name == "nt":
        import msvcrt

        stream.seek(0)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        return
    import fcntl

    fcntl.flock(stream.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
