"""A limit on the processor time of a process."""

from __future__ import annotations

import math

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
