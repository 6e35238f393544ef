"""One BLAS thread in this process and in processes of our own, and the processors that these may use."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
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


def surroundings() -> dict[str, str]:
    """The environment of a Python of our own: this package, one thread, no module of the folder that it is run in.

    A folder from elsewhere may hold a ``json.py``.
    """
    path = os.pathsep.join(filter(None, (str(Path(__file__).resolve().parents[2]), os.environ.get("PYTHONPATH"))))
    return {**os.environ, **ONE_THREAD, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}


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
