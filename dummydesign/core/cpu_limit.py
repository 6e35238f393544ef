"""A budget of processor time for work of this thread, and a limit on that of a process."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar


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
