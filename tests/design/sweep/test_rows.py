"""Sweeps here and elsewhere: no row is lost, none is there twice, all are the same."""

import csv
import json
import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from dummydesign.design.sweep import run as module
from dummydesign.design.sweep.rows import key_of, settings_of, write_rows
from dummydesign.design.sweep.run import completed, open_executor, whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

SQUARE = (("square:14", 14.0 / math.sqrt(math.pi)),)
STUDY = Study((5.0, 10.0, 20.0), (15.0, 15.5, 16.0, 17.0), SQUARE, bases=("bonded", "sliding"))


def test_the_file_has_every_number_in_full_and_the_settings_that_rows_share(tmp_path):
    rows = whatif(STUDY)["rows"]
    path = write_rows(tmp_path, STUDY, settings_of(STUDY, load_resin(STUDY.resin), None), rows)
    with open(path, newline="") as stream:
        read = list(csv.DictReader(stream))
    assert len(read) == STUDY.size and any(row["limit"] for row in rows) and any(row["limit"] is None for row in rows)
    for line, row in zip(read, rows, strict=True):
        assert float(line["thickness_mm"]) == row["thickness_mm"] and line["base"] == row["base"]
        depth = row["depth_mm_at_N"]["5"]
        assert line["depth_mm_at_5_N"] == ("" if depth is None else repr(depth))
        assert line["limit"] == (row["limit"] or "")
    assert json.loads((tmp_path / "study.json").read_text())["forces_N"] == list(STUDY.forces_N)


def test_an_executor_gives_the_same_rows_in_the_same_order(monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 3)
    here = whatif(STUDY)["rows"]
    with ThreadPoolExecutor(4) as pool:
        assert whatif(STUDY, executor=pool)["rows"] == here


@pytest.mark.slow
def test_processes_give_the_same_rows():
    with open_executor(2) as pool:
        assert whatif(STUDY, executor=pool)["rows"] == whatif(STUDY)["rows"]


def test_a_worker_that_fails_ends_the_study(monkeypatch):
    def fails(task):
        raise MemoryError("out of memory")

    monkeypatch.setattr(module, "work", fails)
    with ThreadPoolExecutor(1) as pool, raises_code("worker_lost", "workers"):
        whatif(STUDY, executor=pool)


def test_every_task_is_done_once_here_and_elsewhere():
    with ThreadPoolExecutor(3) as pool:
        for executor in (None, pool):
            assert sorted(completed(lambda n: n * n, range(50), executor)) == [n * n for n in range(50)]


def test_numbers_of_workers_and_addresses_that_cannot_be_are_refused(monkeypatch):
    with raises_code("out_of_range", "workers"), open_executor(0):
        pass
    for address in ("nonsense", "tcp://host", "host:port", ""):
        with raises_code("malformed", "scheduler"), open_executor(1, address):
            pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with raises_code("program_missing", "scheduler"), open_executor(1, "tcp://127.0.0.1:1"):
        pass


@pytest.fixture
def cluster():
    """A scheduler and two workers as processes of their own; yields its address and the workers."""
    pytest.importorskip("distributed", reason="the cluster extra is not installed")
    start = "import sys; from distributed.cli.{0} import main; sys.argv = ['{0}', *sys.argv[1:]]; main()"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    import socket

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    command = [sys.executable, "-c", start.format("dask_scheduler")]
    started = [subprocess.Popen([*command, "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"], **quiet)]
    command = [sys.executable, "-c", start.format("dask_worker"), address]
    # without a nanny nobody starts the killed worker again
    options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "60"]
    workers = [subprocess.Popen([*command, *options], **quiet) for _ in range(2)]
    try:
        yield address, workers
    finally:
        for process in workers + started:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_in_the_middle_loses_and_doubles_no_row(cluster, monkeypatch):
    address, workers = cluster
    monkeypatch.setattr(module, "CHUNK", 20)
    study = Study(tuple(np.linspace(4.0, 30.0, 30)), tuple(np.round(np.linspace(14.0, 20.0, 20), 6)), SQUARE)
    from distributed import Client

    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
    done, killed_at = [], []

    def kill_in_the_middle(count, size):
        done.append(count)
        if count >= 60 and not killed_at:
            workers[0].kill()
            killed_at.append(count)

    with open_executor(1, address) as executor:
        rows = whatif(study, executor=executor, progress=kill_in_the_middle)["rows"]
    assert killed_at and killed_at[0] < study.size and workers[0].wait(10) != 0
    assert done[-1] == study.size and [key_of(row) for row in rows] == study.keys()
    monkeypatch.undo()
    assert rows == whatif(study)["rows"]
