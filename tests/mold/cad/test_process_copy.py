"""Work in a copy of the process: its result, its files, its faults, its end."""

from __future__ import annotations

import filecmp
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from dummydesign.core.blas_threads import surroundings
from dummydesign.mold.build_files import produce
from dummydesign.mold.cad.kernel import beside
from dummydesign.mold.client import make_mold, papers
from dummydesign.mold.files.pour_sheet import Foot
from dummydesign.mold.model.preset import mould_spec

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="copies of a process are made on Linux alone")
BEGIN = "import os, signal, sys, time; from dummydesign.mold.cad.kernel import beside; "


def run(text: str, **options) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", BEGIN + text], capture_output=True, encoding="utf-8", env=surroundings(), **options
    )


@ON_LINUX
def test_work_is_done_by_other_processes_whose_files_and_faults_come_back_and_whose_changes_do_not(tmp_path):
    done = run(
        f"""
held = []
first = beside(lambda: (held.append(1), open({str(tmp_path / "made")!r}, "w").write("there"), os.getpid())[-1])
second, wrong = beside(os.getpid), beside(lambda: [][0])
print(*{{first(), second(), os.getpid()}}, *held)
wrong()"""
    )
    assert len(done.stdout.split()) == 3, done.stderr
    assert (tmp_path / "made").read_text() == "there"
    assert done.stderr.splitlines()[-1] == "RuntimeError: IndexError: list index out of range" and done.returncode == 1


def test_a_process_with_threads_is_not_copied():
    ended = threading.Event()
    threading.Thread(target=ended.wait, daemon=True).start()
    assert beside(os.getpid)() == os.getpid()
    ended.set()


@ON_LINUX
def test_a_process_that_has_typeset_is_not_copied_as_typsts_threads_are_not():
    done = run(
        """
print(beside(os.getpid)() == os.getpid())
import typst
typeset = lambda: (typst.compile(b"x", format="svg"), os.getpid())[1]
typeset()
print(beside(typeset)() == os.getpid())""",
        timeout=120,
    )
    assert done.stdout.split() == ["False", "True"], done.stderr


@ON_LINUX
def test_without_room_for_another_process_the_work_is_done_by_this_one(monkeypatch):
    def full():
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(threading, "active_count", lambda: 1)
    monkeypatch.setattr(os, "fork", full)
    open_before = len(os.listdir("/proc/self/fd"))
    assert beside(os.getpid)() == os.getpid() and len(os.listdir("/proc/self/fd")) == open_before


@ON_LINUX
@pytest.mark.slow
def test_a_signal_that_ends_the_copy_ends_both():
    """So that the limit on the processor's time says the same wherever it is reached."""
    done = run("beside(lambda: os.kill(os.getpid(), signal.SIGXCPU))(); print('on')")
    assert done.returncode == -signal.SIGXCPU and done.stdout == ""


@ON_LINUX
@pytest.mark.slow
def test_the_copy_ends_with_the_process():
    done = run(
        "beside(lambda: (print(os.getpid(), flush=True), time.sleep(60))); time.sleep(0.5); os._exit(0)", timeout=30
    )
    copy = int(done.stdout)
    for _ in range(50):
        try:
            os.kill(copy, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise AssertionError(f"process {copy} is still there")


@pytest.mark.slow
def test_a_mould_is_the_same_made_by_one_process_or_by_copies_of_it(tmp_path, monkeypatch):
    """In a process with a thread nothing is copied."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    spec, ended = (
        mould_spec(5.0, 60.0, 50.0, kind="crowned", parameters=(("radius", 20.0), ("height", 1.5))),
        threading.Event(),
    )
    threading.Thread(target=ended.wait, daemon=True).start()
    by_copies, alone = tmp_path / "copies", tmp_path / "alone"
    make_mold(spec, by_copies)
    alone.mkdir()
    made = produce(spec, alone, Foot(spec.hash, **papers("A4")))
    ended.set()
    assert made["step_sha256"] and len(list(alone.iterdir())) > 15
    assert filecmp.cmpfiles(by_copies, alone, sorted(path.name for path in alone.iterdir()), shallow=False)[1:] == (
        [],
        [],
    )
