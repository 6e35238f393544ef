"""A limit on processor time: set in a process of its own, whole seconds, never above what the system allows."""

import signal
import subprocess
import sys

import pytest

from dummydesign.core.blas_threads import ran_out

resource = pytest.importorskip("resource")


def limits(asked: float, hard: int | None = None) -> list[int]:
    lower = f"resource.setrlimit(resource.RLIMIT_CPU, ({hard}, {hard})); " if hard else ""
    code = (
        f"import resource; from dummydesign.core.blas_threads import limit_processor_time; {lower}"
        f"limit_processor_time({asked}); "
        "print(*resource.getrlimit(resource.RLIMIT_CPU), resource.getrlimit(resource.RLIMIT_CORE)[0])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return [int(word) for word in done.stdout.split()]


def test_a_limit_is_rounded_up_and_never_above_the_hard_one():
    own = resource.getrlimit(resource.RLIMIT_CPU)[1]
    assert limits(7.2) == [8, own, 0]
    assert limits(0.1, hard=50) == [1, 50, 0] and limits(60.0, hard=50) == [50, 50, 0]


def test_only_the_signal_of_that_limit_means_that_a_child_ran_out():
    assert ran_out(-signal.SIGXCPU) and not ran_out(signal.SIGXCPU) and not ran_out(0) and not ran_out(-signal.SIGKILL)
