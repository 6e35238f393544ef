"""Sweeps that stop, go on, and run elsewhere: no row is lost, none is there twice, all are the same."""

import csv
import json
import math
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.sweep import run as module
from dummydesign.design.sweep.rows import RowsFile, key_of, settings_of
from dummydesign.design.sweep.run import completed, open_executor, whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code

SQUARE = (("square:14", 14.0 / math.sqrt(math.pi)),)
STUDY = Study((5.0, 10.0, 20.0), (15.0, 15.5, 16.0, 17.0), SQUARE, bases=("bonded", "sliding"))


def open_file(folder, study=STUDY, resume=False):
    return RowsFile(folder, study, settings_of(study, load_resin(study.resin), None), resume)


def finished(folder, study=STUDY):
    return whatif(study, file=open_file(folder, study))["rows"]


def test_a_row_read_back_is_the_row_that_was_written(tmp_path):
    rows = finished(tmp_path)
    with closing(open_file(tmp_path, resume=True)) as again:
        assert [again.rows[key] for key in STUDY.keys()] == rows
    assert any(row["limit"] for row in rows) and any(row["limit"] is None for row in rows)


@pytest.mark.parametrize("share", [0.0, 0.03, 0.31, 0.5, 0.77, 0.999])
def test_a_file_torn_anywhere_is_completed_to_the_same_bytes(tmp_path, share, monkeypatch):
    rows = finished(tmp_path)
    path = tmp_path / "rows.csv"
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    left = open_file(tmp_path, resume=True)
    kept = len(left.rows)
    assert kept == max(whole[: int(share * len(whole))].count(b"\n") - 1, 0)
    worked = []
    monkeypatch.setattr(module, "work", lambda task, real=module.work: worked.append(len(task.ratio)) or real(task))
    assert whatif(STUDY, file=left)["rows"] == rows
    assert sum(worked) == STUDY.size - kept
    assert path.read_bytes() == whole


def test_damaged_and_doubled_lines_are_worked_out_again_once(tmp_path):
    rows = finished(tmp_path)
    path = tmp_path / "rows.csv"
    whole = path.read_text()
    lines = whole.splitlines(keepends=True)
    lines[3] = lines[3].replace("15.", "1x5.", 1)
    lines[5] = lines[5][:20] + "\n"
    path.write_text("".join([*lines, lines[7], lines[8]]))
    assert whatif(STUDY, file=open_file(tmp_path, resume=True))["rows"] == rows
    assert path.read_text() == whole


def test_a_wider_study_takes_over_what_is_there_and_a_narrower_one_loses_nothing(tmp_path):
    small = Study((10.0,), (15.0, 16.0), SQUARE)
    first = finished(tmp_path, small)
    file = open_file(tmp_path, STUDY, resume=True)
    assert len(file.rows) == 2
    rows = whatif(STUDY, file=file)["rows"]
    assert [row for row in rows if key_of(row) in set(small.keys())] == first
    assert whatif(small, file=open_file(tmp_path, small, resume=True))["rows"] == first
    with open(tmp_path / "rows.csv", newline="") as stream:
        assert len(list(csv.DictReader(stream))) == STUDY.size


def test_rows_made_with_other_settings_are_refused_and_left_alone(tmp_path):
    finished(tmp_path)
    before = (tmp_path / "rows.csv").read_bytes()
    for study, name in (
        (Study((5.0,), (15.0,), SQUARE, forces_N=(2.0,)), "forces_N"),
        (Study((5.0,), (15.0,), SQUARE, fidelity="axisymmetric"), "fidelity"),
    ):
        with pytest.raises(InputError, match=name):
            open_file(tmp_path, study, resume=True)
    (tmp_path / "study.json").unlink()
    with raises_code("file_unreadable", "resume"):
        open_file(tmp_path, resume=True)
    assert (tmp_path / "rows.csv").read_bytes() == before


def test_without_resume_the_file_is_made_anew(tmp_path):
    finished(tmp_path)
    with closing(open_file(tmp_path)) as again:
        assert not again.rows
    assert len((tmp_path / "rows.csv").read_text().splitlines()) == 1


def test_rows_are_on_disk_before_the_next_ones_are_worked_out(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 4)
    seen = []

    def watch(task, real=module.work):
        seen.append(len((tmp_path / "rows.csv").read_text().splitlines()) - 1)
        return real(task)

    monkeypatch.setattr(module, "work", watch)
    finished(tmp_path)
    assert seen == [0, 4, 8, 12, 16, 20]


def test_an_executor_gives_the_same_rows_in_the_same_order(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 3)
    here = finished(tmp_path)
    with ThreadPoolExecutor(4) as pool:
        assert whatif(STUDY, executor=pool, file=open_file(tmp_path))["rows"] == here
        assert whatif(STUDY, executor=pool)["rows"] == here


@pytest.mark.slow
def test_processes_give_the_same_rows(tmp_path):
    with open_executor(2) as pool:
        assert whatif(STUDY, executor=pool)["rows"] == finished(tmp_path)


def test_a_worker_that_fails_keeps_what_was_done_and_says_how_to_go_on(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "CHUNK", 4)
    calls = []

    def fails_once(task, real=module.work):
        calls.append(task)
        if len(calls) == 3:
            raise MemoryError("out of memory")
        return real(task)

    monkeypatch.setattr(module, "work", fails_once)
    with ThreadPoolExecutor(1) as pool, raises_code("worker_lost", "workers") as problem:
        whatif(STUDY, executor=pool, file=open_file(tmp_path))
    assert problem.value.code == "worker_lost"
    monkeypatch.undo()
    left = open_file(tmp_path, resume=True)
    assert 8 <= len(left.rows) < STUDY.size
    rows = whatif(STUDY, file=left)["rows"]
    assert [key_of(row) for row in rows] == STUDY.keys()


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
def test_a_cluster_that_loses_a_worker_in_the_middle_loses_and_doubles_no_row(tmp_path, cluster, monkeypatch):
    address, workers = cluster
    monkeypatch.setattr(module, "CHUNK", 20)
    study = Study(tuple(np.linspace(4.0, 30.0, 30)), tuple(np.round(np.linspace(14.0, 20.0, 20), 6)), SQUARE)
    from distributed import Client

    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
    path = tmp_path / "rows.csv"
    killed_at = []

    def kill_in_the_middle():
        while not killed_at:
            lines = len(path.read_text().splitlines()) - 1 if path.exists() else 0
            if lines >= 60:
                workers[0].kill()
                killed_at.append(lines)
            time.sleep(0.002)

    with open_executor(1, address) as executor:
        file = open_file(tmp_path, study)
        threading.Thread(target=kill_in_the_middle, daemon=True).start()
        rows = whatif(study, executor=executor, file=file)["rows"]
    assert killed_at and killed_at[0] < study.size and workers[0].wait(10) != 0
    assert [key_of(row) for row in rows] == study.keys()
    with open(path, newline="") as stream:
        found = [(float(row["thickness_mm"]), float(row["ratio"])) for row in csv.DictReader(stream)]
    assert found == [(thickness, ratio) for thickness in study.thickness_mm for ratio in study.ratio]
    monkeypatch.undo()
    assert rows == whatif(study)["rows"]
    assert json.loads((tmp_path / "study.json").read_text())["resin"].startswith("polyurethane-nagoya")
