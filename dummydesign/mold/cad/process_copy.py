"""Do work beside the work of this process, in a copy of it. CAD child only."""

from __future__ import annotations

import ctypes
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from dummydesign.core.progress import VARIABLE
from dummydesign.mold.cad.kernel import occ

T = TypeVar("T")
_SIGNAL_WHEN_PARENT_ENDS = 1
"""PR_SET_PDEATHSIG of prctl(2)."""


def beside(work: Callable[[], T]) -> Callable[[], T]:
    """Begin work in a copy of this process, which has all solids already; what is returned waits for its result.

    The kernel keeps Python's lock, so that a thread would wait for it. Files that the work writes are there, anything
    else that it changes is not. An exception of the work is raised as a RuntimeError with its type and text. Where the
    system copies no process, or has no room for one, or this one has threads, the work is done once its result is
    wanted.
    """
    if sys.platform != "linux" or threading.active_count() > 1:
        return work
    # a copy has none of the threads that the kernel would wait for
    occ.OSD_ThreadPool.DefaultPool_s().Init(1)
    reading, writing = os.pipe()
    try:
        copy = os.fork()
    except OSError:
        os.close(reading)
        os.close(writing)
        return work
    if not copy:
        os.close(reading)
        _work_and_leave(work, writing)
    os.close(writing)

    def result() -> T:
        with os.fdopen(reading, "rb") as stream:
            answer = stream.read()
        status = os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1])
        if status < 0:  # out of its processor time, or a fault of the kernel: both end together
            signal.raise_signal(-status)
        found, fault = pickle.loads(answer)
        if fault:
            raise RuntimeError(fault)
        return found  # type: ignore[no-any-return]

    return result


def _work_and_leave(work: Callable[[], object], answer: int) -> None:
    """Do the work of a copy, write its result to a pipe and end; never returns."""
    with suppress(OSError):
        ctypes.CDLL(None).prctl(_SIGNAL_WHEN_PARENT_ENDS, signal.SIGKILL)
    os.environ.pop(VARIABLE, None)
    try:
        found: tuple[object, str] = work(), ""
    except BaseException as problem:
        found = None, f"{type(problem).__name__}: {problem}"
    try:
        with os.fdopen(answer, "wb") as stream:
            pickle.dump(found, stream)
    finally:
        os._exit(0)
