"""Where a sweep runs: here, in processes of this machine, or on a Dask cluster; one interface for all."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from dummydesign.core.errors import DummydesignError, InputError, NoAnswerError, out_of_range

CONNECT_S = 10
RETRIES = 3
"""How often a cluster tries a task again whose worker was lost."""


@contextmanager
def open_executor(workers: int = 1, scheduler: str | None = None) -> Iterator[Executor | None]:
    """Open what runs the tasks; None stands for this process.

    Parameters
    ----------
    workers : int
        Processes on this machine.
    scheduler : str, optional
        Address of a running Dask scheduler, such as ``tcp://host:8786``; ``workers`` is then the cluster's.

    Raises
    ------
    InputError
        For a number of workers below 1, a scheduler that does not answer, or Dask not being installed.
    """
    if workers < 1:
        raise out_of_range("workers", workers, 1, "any number of processes")
    if scheduler is not None:
        with _dask(scheduler) as executor:
            yield executor
    elif workers == 1:
        yield None
    else:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        # spawned, not forked: a fork copies the threads of numerical libraries in any state they are in
        with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
            yield pool


@contextmanager
def _dask(address: str) -> Iterator[Executor]:
    # Dask's client leaves a thread and a traceback behind when it is given what is no address
    if not re.fullmatch(r"([a-z]+://)?[^/\s]+:\d+", address):
        raise InputError(f"--scheduler '{address}' is not an address such as tcp://host:8786")
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            f"--scheduler {address}: Dask is not installed; pip install 'dummydesign[cluster]'"
        ) from None
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as problem:
        text = str(problem).split("\n")[0] or type(problem).__name__
        raise InputError(f"--scheduler {address} does not answer within {CONNECT_S} s: {text}") from None
    try:
        with client.get_executor(pure=False, retries=RETRIES) as executor:
            yield executor
    finally:
        client.close()


def completed(function: Callable[[Any], Any], tasks: Iterable[Any], executor: Executor | None) -> Iterator[Any]:
    """Yield results as they are done; each task's exactly once.

    Parameters
    ----------
    function : callable
        Takes one task; must be importable by a worker.
    tasks : iterable
        What it is called with.
    executor : concurrent.futures.Executor or None
        Where it runs; here, one after the other, when None.

    Raises
    ------
    NoAnswerError
        ``worker_lost`` when a worker died and the work could not be done elsewhere.
    """
    if executor is None:
        yield from map(function, tasks)
        return
    from concurrent.futures import as_completed

    waiting = [executor.submit(function, task) for task in tasks]
    try:
        for future in as_completed(waiting):
            try:
                yield future.result()
            except (DummydesignError, GeneratorExit):
                raise
            except Exception as problem:
                raise NoAnswerError(
                    "worker_lost",
                    f"a worker failed ({type(problem).__name__}: {problem}); what was done is kept: "
                    "run the same command with --resume",
                ) from problem
    finally:
        for future in waiting:
            future.cancel()
