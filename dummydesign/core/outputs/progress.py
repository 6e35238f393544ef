"""What a long command is doing, for whoever watches it from outside: one line in the file that is named for it."""

from __future__ import annotations

import os
import threading
from pathlib import Path

VARIABLE = "DUMMYDESIGN_PROGRESS"
"""Environment variable with the path of that file; nothing is written without it."""


STOP = threading.Event()
"""Set when the user asks a command to end: the interrupt alone is lost when it comes while a C library loads."""


def check_stop() -> None:
    """Raise KeyboardInterrupt when the user has asked the command to end."""
    if STOP.is_set():
        raise KeyboardInterrupt


def tell(text: str) -> None:
    """Replace the line; a file that cannot be written stops no work. Ends a command that was asked to end."""
    check_stop()
    place = os.environ.get(VARIABLE)
    if not place:
        return
    part = Path(f"{place}.part-{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, place)
    except OSError:
        part.unlink(missing_ok=True)
