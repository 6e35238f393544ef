"""Commands the studio starts: a process of their own, that is stopped, outlives the studio, and is known again."""

import os
import signal
import time

import pytest

from dummydesign.core.errors import InputError
from dummydesign.studio.work import job as runner
from dummydesign.studio.work import jobs
from dummydesign.studio.work.lock import held, take


def wait_for(folder, *states, seconds=60):
    deadline = time.monotonic() + seconds
    while (found := jobs.read_job(folder)).state not in states:
        assert time.monotonic() < deadline, found
        time.sleep(0.1)
    return found


def test_a_command_is_run_in_the_folder_and_its_answer_is_kept(tmp_path):
    job = wait_for(jobs.start(tmp_path, "list", ["tissues", "list"]).folder, "done")
    assert job.answer["schema"] == "dummydesign.tissues/1" and job.error == ""
    assert jobs.latest(tmp_path, "list") == job and jobs.latest(tmp_path, "other") is None


def test_what_is_wrong_is_the_line_of_the_command(tmp_path):
    job = wait_for(jobs.start(tmp_path, "show", ["tissues", "show", "palms"]).folder, "failed")
    assert job.error.startswith("unknown tissue 'palms'") and job.answer == {}


def test_a_command_can_be_stopped_and_leaves_no_half_written_folder(tmp_path):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"]
    job = jobs.start(tmp_path, "suggest", words)
    with pytest.raises(InputError, match="still at work"):
        jobs.start(tmp_path, "suggest", words)
    deadline = time.monotonic() + 60
    while not list(tmp_path.glob("designs/.a.part-*")) and time.monotonic() < deadline:
        time.sleep(0.05)
    jobs.stop(job)
    found = wait_for(job.folder, "stopped", "done", "failed")
    assert found.state == "stopped" and "stopped" in found.error
    assert not list(tmp_path.glob("designs/*")) and not list(tmp_path.glob("designs/.a*"))


def test_a_command_whose_process_was_killed_is_lost_and_says_so(tmp_path):
    job = jobs.start(tmp_path, "suggest", ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"])
    deadline = time.monotonic() + 60
    while not (job.folder / runner.PID).exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    number = int((job.folder / runner.PID).read_text(encoding="utf-8"))
    os.killpg(number, signal.SIGKILL)
    assert "run it again" in wait_for(job.folder, "lost").error
    again = jobs.start(tmp_path, "suggest", ["tissues", "list"])
    assert wait_for(again.folder, "done").folder != job.folder


def test_a_lock_is_held_by_one_and_ends_with_its_holder(tmp_path):
    lock = take(tmp_path / "a" / "lock")
    assert lock is not None and take(tmp_path / "a" / "lock") is None and held(tmp_path / "a" / "lock")
    lock.close()
    assert not held(tmp_path / "a" / "lock")
