"""The progress line of a long command, and its end when the user asks for it."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path


def leave() -> None:
    """End this process at once: what a CAD kernel or a graphics library holds is not taken apart piece by piece."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


COMMAND_LINE: ContextVar[Sequence[str] | None] = ContextVar("command_line", default=None)
"""Words of the command line that is being run; None in a call from Python."""


VARIABLE = "DUMMYDESIGN_PROGRESS"
"""Environment variable with the path of that file; nothing is written without it."""


STOP = threading.Event()
"""Set when the user asks a command to end: the interrupt alone is lost when it comes while a C library loads."""


def check_stop() -> None:
    """Raise KeyboardInterrupt when the user has asked the command to end."""
    if STOP.is_set():
        raise KeyboardInterrupt


Progress = Callable[[str], None]


def quiet(step: str) -> None:
    """Ignore progress messages."""


_REPORT: ContextVar[Callable[[float], None] | None] = ContextVar("report_depth", default=None)


@contextmanager
def reporting_depths(tell: Callable[[float], None] | None) -> Iterator[None]:
    """Report every depth that is solved inside, d / h, to ``tell``; None reports to nobody."""
    before = _REPORT.set(tell)
    try:
        yield
    finally:
        _REPORT.reset(before)


def tell_depth(depth: float) -> None:
    """Say that a depth is solved."""
    tell = _REPORT.get()
    if tell is not None:
        tell(depth)


def write_progress(text: str) -> None:
    """Replace the line; a file that cannot be written stops no work. Ends a command that was asked to end."""
    check_stop()
    path = os.environ.get(VARIABLE)
    if not path:
        return
    part = Path(f"{path}.part-{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, path)
    except OSError:
        part.unlink(missing_ok=True)
