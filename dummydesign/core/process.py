"""One BLAS thread, a limit on processor time, and the progress line of a long command."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import LibController


ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "BLIS_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
}
"""What a process of our own has in its environment before numpy is loaded."""


def leave() -> None:
    """End this process at once: what a CAD kernel or a graphics library holds is not taken apart piece by piece."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


_lock = threading.Lock()
_inside = 0
_limits: list[tuple[LibController, int]] = []


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit the BLAS libraries of this process to one thread; afterwards they have their own limits again.

    Also a decorator. Blocks may be nested or run in several threads at a time: the first one sets the limit and
    the last one lifts it. Entering costs some 20 microseconds once the libraries have been found.
    """
    global _inside
    shared, own = _libraries()
    with _lock:
        if _inside == 0:
            _limits[:] = _set([(library, 1) for library in shared])
        _inside += 1
    mine = _set([(library, 1) for library in own])
    try:
        yield
    finally:
        _set(mine)
        with _lock:
            _inside -= 1
            if _inside == 0:
                _set(_limits)


def _set(wanted: list[tuple[LibController, int]]) -> list[tuple[LibController, int]]:
    """Give each library its number of threads; return what each had."""
    had = [(library, library.num_threads) for library, _ in wanted]
    for library, number in wanted:
        # threadpoolctl listens to one thread at a time, often not the one that solves or ends last
        release = getattr(library, "clear_controlling_thread", None)
        if release:
            release(force=True)
        library.set_num_threads(number)
        if release:
            release(force=True)
    return had


@lru_cache(maxsize=1)
def _libraries() -> tuple[list[LibController], list[LibController]]:
    """BLAS libraries with one limit for the process, and those with a limit for each of its threads (OpenMP)."""
    # scipy's wheel brings a BLAS library of its own, which could not be limited before it is loaded
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    libraries = ThreadpoolController().select(user_api="blas").lib_controllers
    own = [library for library in libraries if getattr(library, "threading_layer", None) == "openmp"]
    return [library for library in libraries if library not in own], own


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


class ProcessorBudget:
    """Processor time of this thread that work may take; ``ran_out`` once something was left undone for it."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.ran_out = seconds, False
        self._end = time.thread_time() + seconds

    def spent(self) -> bool:
        """Whether the time is used up; ask where something is left undone then."""
        self.ran_out = self.ran_out or time.thread_time() >= self._end
        return self.ran_out


_BUDGET: ContextVar[ProcessorBudget | None] = ContextVar("processor_budget", default=None)


@contextmanager
def processor_budget(seconds: float) -> Iterator[ProcessorBudget]:
    """Give the work inside so much processor time. [s]"""
    budget = ProcessorBudget(seconds)
    token = _BUDGET.set(budget)
    try:
        yield budget
    finally:
        _BUDGET.reset(token)


def budget_spent() -> bool:
    """Whether the work that asks must come to its end; never without a budget."""
    budget = _BUDGET.get()
    return budget is not None and budget.spent()


HUNG_S = 3600.0
"""A child that neither works nor ends is given up after this time by the clock. [s]"""


def limit_processor_time(seconds: float) -> None:
    """Have the system end this process once it has used so much processor time; systems that cannot do nothing."""
    try:
        import resource
    except ImportError:
        return
    soft = max(1, math.ceil(seconds))
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    if hard != resource.RLIM_INFINITY:
        soft = min(soft, hard)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))
    # no image of the memory on disk for it
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def ran_out(status: int) -> bool:
    """Whether a child with this exit status was ended by :func:`limit_processor_time`."""
    import signal

    return hasattr(signal, "SIGXCPU") and status == -signal.SIGXCPU
