"""Commands the studio starts: a process of their own, that is stopped, outlives the studio, and is known again."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked
from dummydesign.project.folder import make_project
from dummydesign.studio import job_process as runner
from dummydesign.studio import jobs
from dummydesign.studio.trash import keep_file
from tests.support import lab_project as lab
from tests.support.refusal import raises_code
from tests.support.studio import until


@pytest.fixture(autouse=True, scope="module")
def every_process_is_waited_for():
    yield
    for child in jobs._CHILDREN:
        child.wait(120)


def wait_for(folder, *states, seconds=600):
    assert until(lambda: jobs.read_job(folder).state in states, seconds=seconds), jobs.read_job(folder)
    return jobs.read_job(folder)


def test_a_command_is_run_in_the_folder_takes_no_module_of_it_and_its_answer_is_kept(tmp_path):
    """A project from elsewhere may hold files that are named like modules."""
    for name in ("json", "shlex", "numpy", "dummydesign"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'was-run')!r}, 'w')\n", encoding="utf-8")
    job = wait_for(jobs.start(tmp_path, "list", ["tissues", "list"]).folder, "done")
    assert job.answer["schema"] == "dummydesign.tissues/1" and job.error == ""
    assert jobs.latest(tmp_path, "list") == job and jobs.latest(tmp_path, "other") is None
    assert not (tmp_path / "was-run").exists()


@pytest.mark.parametrize("path", ["/etc/passwd", "../tip.csv"])
def test_no_command_is_given_a_punch_from_outside_the_project(tmp_path, path):
    with raises_code("not_allowed", "path"):
        jobs.start(tmp_path, "suggest", ["tissues", "list"], ["suggest", "--punch", f"profile:{path}"])
    assert jobs.all_jobs(tmp_path) == []


def test_of_several_commands_each_keeps_its_answer_and_the_last_one_counts(tmp_path):
    started = jobs.start(tmp_path, "two", ["tissues", "list"], ["resins", "list"])
    assert started.state != "running" or started.progress.startswith(("step 1 of 2", "step 2 of 2"))
    job = wait_for(started.folder, "done")
    assert job.commands == (("tissues", "list"), ("resins", "list")) and job.words == ("resins", "list")
    assert [job.answer_of(number)["schema"] for number in (1, 2)] == ["dummydesign.tissues/1", "dummydesign.resins/1"]
    assert job.answer == job.answer_of(2)


def test_a_command_that_fails_ends_those_after_it(tmp_path):
    commands = ["tissues", "list"], ["tissues", "show", "palms"], ["tissues", "list"]
    job = wait_for(jobs.start(tmp_path, "three", *commands).folder, "failed")
    assert job.error.startswith("unknown tissue 'palms'") and job.answer == {} and not job.has_answer
    assert job.answer_of(1)["schema"] == "dummydesign.tissues/1" and job.answer_of(3) == {}


def test_several_commands_that_are_stopped_start_no_other(tmp_path):
    slow = ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"]
    job = jobs.start(tmp_path, "two", slow, ["tissues", "list"])
    jobs.stop(job)
    assert wait_for(job.folder, "stopped").answer_of(2) == {}


@pytest.mark.skipif(os.name == "nt", reason="a folder in use cannot be renamed there")
def test_a_project_folder_that_is_renamed_during_its_commands_keeps_their_answers(tmp_path):
    root, renamed = tmp_path / "thumb", tmp_path / "thumb 2"
    root.mkdir()
    job = jobs.start(root, "two", ["tissues", "list"], ["resins", "list"])
    root.rename(renamed)
    with raises_code("file_not_found", "folder") as refused:
        jobs.all_jobs(root)
    assert "\n" not in str(refused.value) and str(root) in str(refused.value)
    with raises_code("file_not_found", "folder"):
        jobs.start(root, "list", ["tissues", "list"])
    with raises_code("file_not_found", "folder"):
        keep_file(root, root / "measured", "a.csv", b"1")
    assert not root.exists()
    found = wait_for(renamed / job.folder.relative_to(root), "done")
    assert [found.answer_of(number)["schema"] for number in (1, 2)] == ["dummydesign.tissues/1", "dummydesign.resins/1"]


def test_a_file_that_is_renamed_before_a_command_reads_it_is_named_in_a_line_and_stays(tmp_path):
    root = make_project(tmp_path / "thumb").root
    (root / "measured" / "a.csv").write_text("time_s,displacement_mm,force_N\n0,0,0\n", encoding="utf-8")
    job = jobs.start(root, "import", ["import", "measured/a.csv", "--out", "measured/import-a"])
    (root / "measured" / "a.csv").rename(root / "measured" / "b.csv")
    error = wait_for(job.folder, "failed").error
    assert "measured/a.csv" in error and "\n" not in error
    assert [path.name for path in (root / "measured").iterdir()] == ["b.csv"]


def test_what_is_wrong_is_the_line_of_the_command(tmp_path):
    job = wait_for(jobs.start(tmp_path, "show", ["tissues", "show", "palms"]).folder, "failed")
    assert job.error.startswith("unknown tissue 'palms'") and job.answer == {}


def test_a_command_can_be_stopped_and_leaves_no_half_written_folder(tmp_path):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"]
    job = jobs.start(tmp_path, "suggest", words)
    with raises_code("busy", "step"):
        jobs.start(tmp_path, "suggest", words)
    until(lambda: list(tmp_path.glob("designs/.a.part-*")))
    jobs.stop(job)
    found = wait_for(job.folder, "stopped", "done", "failed")
    assert found.state == "stopped" and "stopped" in found.error
    assert not list(tmp_path.glob("designs/*")) and not list(tmp_path.glob("designs/.a*"))


def test_a_command_that_was_killed_while_its_runner_lives_says_so(tmp_path):
    job = jobs.start(tmp_path, "suggest", ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"])
    child = job.folder / runner.CHILD
    assert until(lambda: child.exists() and child.read_text(encoding="utf-8"))
    os.kill(int(child.read_text(encoding="utf-8")), signal.SIGKILL)
    assert "run it again" in wait_for(job.folder, "failed").error


def test_a_command_whose_process_was_killed_is_lost_and_says_so(tmp_path):
    job = jobs.start(tmp_path, "suggest", ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"])
    until((job.folder / runner.PID).exists)
    number = int((job.folder / runner.PID).read_text(encoding="utf-8"))
    os.killpg(number, signal.SIGKILL)
    assert "run it again" in wait_for(job.folder, "lost").error
    again = jobs.start(tmp_path, "suggest", ["tissues", "list"])
    assert wait_for(again.folder, "done").folder != job.folder


@pytest.mark.skipif(os.name == "nt", reason="a lock cannot be handed on there")
def test_a_command_whose_runner_alone_was_killed_goes_on_is_known_and_can_be_stopped(tmp_path):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"]
    job = jobs.start(tmp_path, "suggest", words)
    until(lambda: list(tmp_path.glob("designs/.a.part-*")))
    child = int((job.folder / runner.CHILD).read_text(encoding="utf-8"))
    os.kill(int((job.folder / runner.PID).read_text(encoding="utf-8")), signal.SIGKILL)
    jobs._CHILDREN[-1].wait(60)
    os.kill(child, 0)
    assert jobs.read_job(job.folder).state == "running"
    with raises_code("busy", "step"):
        jobs.start(tmp_path, "suggest", words)
    jobs.stop(job)
    wait_for(job.folder, "lost")
    assert not list(tmp_path.glob("designs/*")) and not list(tmp_path.glob("designs/.a*"))
    with pytest.raises(ProcessLookupError):
        for _ in range(600):
            os.kill(child, 0)
            time.sleep(0.1)


def test_a_job_waits_until_less_than_two_that_were_begun_before_it_are_at_work(tmp_path):
    folders = [tmp_path / f"{number:04d}-a" for number in (3, 40, 9999, 10000)]
    for folder in folders:
        folder.mkdir()
    held = [acquire_lock(folder / runner.LOCK) for folder in folders]
    assert [runner.is_turn(folder) for folder in folders] == [True, True, False, False]
    held[1].close()
    assert [runner.is_turn(folder) for folder in folders[2:]] == [True, False]
    (folders[0] / runner.STATUS).write_text("{}", encoding="utf-8")
    assert runner.is_turn(folders[3])
    for one in held:
        one.close()


@pytest.mark.slow
def test_a_third_command_waits_for_its_turn_and_one_that_waits_can_be_stopped(tmp_path):
    long = [
        jobs.start(tmp_path, name, ["suggest", "--tissue", "forefinger", "--no-cad", "--out", f"designs/{name}"])
        for name in ("a", "b")
    ]
    third, fourth = (jobs.start(tmp_path, name, ["tissues", "list"]) for name in ("c", "d"))
    assert until(lambda: jobs.read_job(fourth.folder).progress == runner.WAITING)
    assert runner.WAITING in jobs.progress_line(jobs.read_job(third.folder), 20.0)
    assert not (third.folder / runner.CHILD).exists()
    jobs.stop(fourth)
    wait_for(fourth.folder, "stopped")
    assert not (fourth.folder / runner.CHILD).exists() and jobs.read_job(third.folder).state == "running"
    jobs.stop(long[0])
    assert wait_for(third.folder, "done").answer["schema"] == "dummydesign.tissues/1"
    assert jobs.read_job(long[1].folder).state == "running"
    jobs.stop(long[1])
    wait_for(long[1].folder, "stopped", "done")


def test_one_who_looks_at_a_lock_never_keeps_it_from_one_who_waits_a_little(tmp_path):
    path = tmp_path / "lock"
    acquire_lock(path).close()
    stop = threading.Event()
    looked = []

    def look():
        while not stop.is_set():
            looked.append(is_locked(path))

    watchers = [threading.Thread(target=look) for _ in range(3)]
    for watcher in watchers:
        watcher.start()
    try:
        for _ in range(200):
            lock = acquire_lock(path, 60.0)
            assert lock is not None
            lock.close()
    finally:
        stop.set()
        for watcher in watchers:
            watcher.join()
    assert looked


def test_a_lock_that_is_held_is_not_waited_for_beyond_the_time_given(tmp_path):
    lock = acquire_lock(tmp_path / "lock")
    start = time.monotonic()
    assert acquire_lock(tmp_path / "lock", 0.3) is None and 0.3 <= time.monotonic() - start < 30.0
    lock.close()


def test_a_job_that_takes_its_lock_itself_begins_although_someone_looks_at_it(tmp_path):
    """Where a lock cannot be handed on, a look at the lock must not end the job."""
    (tmp_path / runner.COMMAND).write_text(
        json.dumps({"words": ["tissues", "list"], "cwd": str(tmp_path), "start": 0.0}), encoding="utf-8"
    )
    glance = acquire_lock(tmp_path / runner.LOCK)
    threading.Timer(0.3, glance.close).start()
    assert runner.main(tmp_path) == 0


def test_a_disk_that_is_full_for_a_moment_leaves_no_command_without_its_runner(tmp_path, monkeypatch):
    asked = {"name": "list", "words": ["tissues", "list"], "cwd": str(tmp_path), "start": 0.0}
    (tmp_path / runner.COMMAND).write_text(json.dumps(asked), encoding="utf-8")
    real = runner.write_text

    def full(path, text):
        if path.name in (runner.PID, runner.CHILD):
            raise InputError("No space left on device", "file_unwritable")
        return real(path, text)

    monkeypatch.setattr(runner, "write_text", full)
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    assert runner.main(tmp_path) == 0 and jobs.read_job(tmp_path).has_answer


def test_the_newest_command_is_the_one_of_the_highest_number_also_where_that_has_more_digits(tmp_path):
    for number in (9999, 10000):
        lab.job(tmp_path, number, "fit", ["fit", str(number)], {"a": number}, 0)
    assert jobs.latest(tmp_path, "fit").words == ("fit", "10000")


def test_an_answer_of_a_command_that_ended_is_read_once_however_many_there_are(tmp_path, monkeypatch):
    """Pages look at all of a step twice a second."""
    for number in range(1, 31):
        lab.job(tmp_path, number, "fit", ["fit", str(number)], {"a": number}, 0)
    assert [one.answer["a"] for one in jobs.all_jobs(tmp_path)] == list(range(1, 31))
    monkeypatch.setattr(jobs, "read_json", None)
    assert [one.answer["a"] for one in jobs.all_jobs(tmp_path)] == list(range(1, 31))


def test_a_lock_is_held_by_one_and_ends_with_its_holder(tmp_path):
    lock = acquire_lock(tmp_path / "a" / "lock")
    assert lock is not None and acquire_lock(tmp_path / "a" / "lock") is None and is_locked(tmp_path / "a" / "lock")
    lock.close()
    assert not is_locked(tmp_path / "a" / "lock")


@pytest.mark.slow
def test_a_command_that_starts_late_is_running_meanwhile_and_hears_that_it_is_to_stop(tmp_path, monkeypatch):
    """A busy machine takes its time to start a process: it is neither lost nor deaf."""
    slow = "import time, sys; time.sleep(2.5); from pathlib import Path;"
    slow += "from dummydesign.studio import job_process as job;"
    words = [sys.executable, "-c", f"{slow} sys.exit(job.main(Path(sys.argv[1]), *map(int, sys.argv[2:])))"]
    made = subprocess.Popen

    def late(given, **options):
        return made([*words, *given[3:]], **options)

    monkeypatch.setattr(jobs, "STARTING_S", 0.0)
    with monkeypatch.context() as patched:
        patched.setattr(jobs.subprocess, "Popen", late)
        job = jobs.start(tmp_path, "list", ["suggest", "--tissue", "forefinger", "--no-cad", "--out", "designs/a"])
    assert job.state == "running" and not (job.folder / runner.PID).exists()
    jobs.stop(job)
    assert wait_for(job.folder, "stopped", "lost", "done", "failed").state == "stopped"


def test_a_command_that_a_full_disk_lets_not_begin_is_refused_in_words_and_holds_nobody_up(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(jobs, "write_text", full)
        with raises_code("file_unwritable", "folder"):
            jobs.start(tmp_path, "list", ["tissues", "list"])
    assert jobs.all_jobs(tmp_path) == []
    assert wait_for(jobs.start(tmp_path, "list", ["tissues", "list"]).folder, "done").answer


@pytest.mark.parametrize("name", [".gitignore", "address"])
def test_a_studio_whose_folder_cannot_be_written_is_one_line_and_lets_go_of_the_folder(tmp_path, name):
    from dummydesign.studio import app as serve

    (tmp_path / ".studio" / name / "in").mkdir(parents=True)
    with raises_code("file_unwritable", "folder"):
        serve.run_studio(tmp_path, None, False, lambda line: None)
    assert not is_locked(tmp_path / ".studio" / "lock")


@pytest.mark.parametrize(
    "odd",
    [
        "null",
        "[]",
        '{"name": "a", "words": [1], "start": 1}',
        '{"name": "a", "words": null, "start": 1}',
        '{"name": "a", "words": [], "start": 1e300}',
        '{"name": "a", "words": [], "start": NaN}',
        f'{{"name": "a", "words": ["y"], "start": 1{"0" * 400}}}',
    ],
)
def test_a_record_that_no_studio_wrote_is_passed_over(tmp_path, odd):
    for number, text in ((1, odd), (2, '{"name": "a", "words": ["x"], "start": 1}')):
        folder = tmp_path / ".studio" / "jobs" / f"000{number}-a"
        folder.mkdir(parents=True)
        (folder / runner.COMMAND).write_text(text)
        (folder / runner.STATUS).write_text('{"status": 0, "stopped": false, "end": 2}')
    for found in (jobs.all_jobs(tmp_path), jobs.all_jobs(tmp_path, "a")):
        assert [job.words for job in found] == [("x",)]


def test_of_two_commands_that_made_the_same_the_later_one_counts(tmp_path):
    for number, made in enumerate(("tissue/a.toml", "tissue/b.toml", "tissue/a.toml"), 1):
        lab.job(tmp_path, number, "fit", ["fit", str(number)], {"files": {"tissue": made}}, 0)
    lab.job(tmp_path, 4, "fit", ["fit", "4"], {}, 2, "the disk is full")
    found = jobs.all_jobs(tmp_path, "fit")
    last = [jobs.is_last(tmp_path, one, lambda job: job.answer.get("files", {}).get("tissue", "")) for one in found]
    assert last == [False, True, True, True]


def test_the_time_left_is_learned_from_earlier_runs_on_this_machine_and_never_grows(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    assert jobs.usual_s("suggest") is None
    for seconds in (900.0, 40.0, 2.0, 3.0, 4.0, 5.0):
        runner.remember("suggest", seconds)
    runner.remember("mould", 70.0)
    assert jobs.usual_s("suggest") == 4.0 and jobs.usual_s("mould") == 70.0
    runner.times_file().write_text("[", encoding="utf-8")
    assert jobs.usual_s("suggest") is None
    job = jobs.Job(
        tmp_path, "suggest", (("suggest",),), "running", 0.0, 12.0, "step 8 of about 10: crowned pads, about 67 s left"
    )
    assert jobs.progress_line(job, None) == "crowned pads – 12 s"
    assert jobs.progress_line(job, 40.0) == "crowned pads – 12 s, about 28 s left"
    assert jobs.progress_line(job, 9.0) == "crowned pads – 12 s"
    assert jobs.progress_line(replace(job, progress="step 2 of 5: STEP files"), 240.0) == (
        "step 2 of 5: STEP files – 12 s, about 4 min left"
    )
    lines = [jobs.progress_line(replace(job, seconds=float(at)), 40.0) for at in range(60)]
    left = [float(line.partition("about ")[2].partition(" ")[0] or 0) for line in lines]
    assert left == sorted(left, reverse=True) and left[0] == 40.0


@pytest.mark.slow
def test_old_commands_of_a_step_go_when_the_next_one_begins(tmp_path):
    for number in range(1, jobs.MOST_KEPT + 4):
        lab.job(tmp_path, number, "list", ["tissues", "list"], {"a": number}, 0)
    lab.job(tmp_path, 900, "re-list", ["tissues", "list"], {"a": 1}, 0)
    job = jobs.start(tmp_path, "list", ["tissues", "list"])
    kept = [one.folder.name for one in jobs.all_jobs(tmp_path) if one.name == "list"]
    assert len(kept) == jobs.MOST_KEPT + 1 and kept[0] == "0004-list" and job.folder.name == "0901-list"
    assert jobs.latest(tmp_path, "re-list") is not None
