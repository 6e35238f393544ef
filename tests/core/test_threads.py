"""Solves use one thread for linear algebra, give the same digits whatever the environment says, and lift the limit."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg  # noqa: F401
from threadpoolctl import ThreadpoolController, threadpool_limits

from dummydesign.core.blas_threads import ONE_THREAD, one_blas_thread
from dummydesign.design.suggest import design
from dummydesign.loop.run import close_loop, replay
from dummydesign.tissue.fitting.fit import fit_traces

ROOT = Path(__file__).parents[2]
BLAS = ThreadpoolController().select(user_api="blas")
VARIABLES = ("OMP", "OPENBLAS", "MKL", "BLIS")

COUNT = """
import json, sys
from threadpoolctl import threadpool_info

def threads():
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]
"""

SOLVE = (
    COUNT
    + """
import numpy
from dummydesign.core.progress import reporting_depths
from dummydesign.pad.spatial.square_punch import CornerCells, SquareProblem, solve_ratios

seen, before = [], threads()
with reporting_depths(lambda _: seen.append(threads())):
    found = solve_ratios(SquareProblem((0.7, 0.7), (3.0, 3.0)), [0.05, 0.1], CornerCells(0.2))
forces = [number.hex() for name in vars(found) for number in numpy.ravel(vars(found)[name]) if name != "solver"
          and isinstance(number, float)]
print(json.dumps({"before": before, "seen": seen, "after": threads(), "forces": forces}))
"""
)

COMMAND = (
    COUNT
    + """
from dummydesign import cli
from dummydesign.cli.commands import tissues

def run(options):
    import scipy.linalg
    return {"threads": threads()}

tissues.run = run
sys.argv = ["dummydesign", "tissues", "list", "--json"]
assert "numpy" not in sys.modules
cli.main()
"""
)


def limits() -> list[int]:
    return [library.num_threads for library in BLAS.lib_controllers]


def run(code: str, threads: int) -> dict:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "DUMMYDESIGN_CACHE": "off"}
    environment |= {f"{name}_NUM_THREADS": str(threads) for name in VARIABLES}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture
def two_threads():
    """Let every BLAS library of this process use two threads, whatever the environment of the tests says."""
    with threadpool_limits(2, user_api="blas"):
        if 2 not in limits():
            pytest.skip("the BLAS library here cannot be given two threads")
        yield


@pytest.fixture(scope="module")
def two():
    """What a solve tells in a process whose environment gives two threads."""
    return run(SOLVE, 2)


@pytest.mark.slow
def test_a_solve_in_space_has_one_thread_and_the_same_digits_where_the_environment_gives_two(two):
    one = run(SOLVE, 1)
    assert len(two["forces"]) >= 2 and two["seen"]
    assert two["forces"] == one["forces"]
    assert {number for counts in two["seen"] for number in counts} == {1}


def test_the_process_that_asked_for_a_solve_has_its_own_limits_back_afterwards(two):
    if set(two["before"]) != {2}:
        pytest.skip("no second thread to give back")
    assert set(two["after"]) == {2}


def test_a_command_runs_with_one_thread_where_the_environment_gives_two():
    found = run(COMMAND, 2)["threads"]
    assert set(found) == {1}


def test_the_limit_holds_inside_and_is_lifted_outside_also_nested_and_after_an_error(two_threads):
    before = limits()
    with pytest.raises(ValueError, match="folded"), one_blas_thread():
        with one_blas_thread():
            assert set(limits()) == {1}
        assert set(limits()) == {1}
        raise ValueError("folded")
    assert limits() == before


def test_blocks_of_two_python_threads_that_overlap_keep_the_limit_until_the_last_one_ends(two_threads):
    before = limits()
    first_in, second_in, first_out = (threading.Event() for _ in range(3))
    seen: list[int] = []

    def first():
        with one_blas_thread():
            first_in.set()
            second_in.wait(10)
        first_out.set()

    def second():
        first_in.wait(10)
        with one_blas_thread():
            second_in.set()
            first_out.wait(10)
            seen.extend(limits())

    workers = [threading.Thread(target=work) for work in (first, second)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert set(seen) == {1}
    assert limits() == before


def test_what_the_cache_keeps_is_computed_with_one_thread(two_threads, monkeypatch, tmp_path):
    from dummydesign.core.cache import cached

    for place in ("off", str(tmp_path)):
        monkeypatch.setenv("DUMMYDESIGN_CACHE", place)
        assert set(cached("test", {"a": 1}, lambda: {"threads": np.array(limits())})["threads"]) == {1}


class Spy:
    """Stands for an input: tells how many threads there are when it is first looked at, and ends the call there."""

    def __init__(self):
        self.seen = []

    def __getattr__(self, name):
        self.seen.extend(limits())
        raise ZeroDivisionError


CALLS = {
    "close_loop": lambda spy: close_loop(spy),
    "design": lambda spy: design(spy),
    "replay": lambda spy: replay(spy, spy),
    "fit_traces": lambda spy: fit_traces([spy], 3),
}


@pytest.mark.parametrize("name", CALLS)
def test_fits_designs_and_the_loop_called_from_python_have_one_thread(two_threads, name):
    before, spy = limits(), Spy()
    with pytest.raises(ZeroDivisionError):
        CALLS[name](spy)
    assert spy.seen and set(spy.seen) == {1}
    assert limits() == before


def test_the_environment_of_own_processes_names_one_thread_everywhere():
    assert set(ONE_THREAD.values()) == {"1"}
    assert {f"{name}_NUM_THREADS" for name in VARIABLES} <= set(ONE_THREAD)
