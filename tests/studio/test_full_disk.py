"""A disk that fills up: every change is refused in a sentence and leaves the folder as it was; later it works."""

from __future__ import annotations

import errno
import os

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked
from dummydesign.core.files import os as files_os
from dummydesign.project.folder import make_project
from dummydesign.studio import file_transfer, jobs
from dummydesign.studio import trash as bin
from dummydesign.studio.pages import campaign as incoming
from tests.support import lab_project as lab
from tests.support.refusal import raises_code
from tests.support.studio import browser, running
from tests.support.studio import test_id as by


@pytest.fixture
def full(monkeypatch):
    """Fill the disk for all files but those whose name begins with one of the words; call again to free it."""
    real = os.replace
    allowed = []

    def replace(part, final):
        if allowed is not None and not any(str(getattr(final, "name", final)).startswith(one) for one in allowed):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(part, final)

    def fill(*words):
        allowed[:] = words
        monkeypatch.setattr(files_os, "replace", replace)
        return lambda: monkeypatch.setattr(files_os, "replace", real)

    return fill


def content_of(root):
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_a_command_that_cannot_be_written_leaves_no_folder_and_begins_later(tmp_path, full):
    free = full()
    with pytest.raises(InputError):
        jobs.start(tmp_path, "list", ["tissues", "list"])
    assert list((tmp_path / ".studio" / "jobs").iterdir()) == []
    free()
    job = jobs.start(tmp_path, "list", ["tissues", "list"])
    assert job.folder.name == "0001-list"
    jobs._CHILDREN[-1].wait(120)


def test_a_command_whose_process_cannot_begin_is_not_taken_for_one_that_ran(tmp_path, monkeypatch):
    def refuse(*words, **more):
        raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))

    monkeypatch.setattr(jobs.subprocess, "Popen", refuse)
    with pytest.raises(InputError):
        jobs.start(tmp_path, "list", ["tissues", "list"])
    assert jobs.all_jobs(tmp_path) == []


def test_a_file_that_cannot_take_the_place_of_another_leaves_it_there(tmp_path, full):
    root = make_project(tmp_path / "thumb").root
    (root / "measured" / "a.csv").write_text("1")
    before = content_of(root)
    free = full("entry.json")
    with pytest.raises(InputError):
        bin.keep_file(root, root / "measured", "a.csv", b"2")
    assert content_of(root) == before and bin.deleted(root) == []
    free()
    bin.keep_file(root, root / "measured", "a.csv", b"2")
    assert (root / "measured" / "a.csv").read_bytes() == b"2"


def test_a_press_that_cannot_take_the_place_of_another_leaves_it_there(tmp_path, full):
    root = lab.lab_project(tmp_path / "thumb")
    folder = root / "campaigns" / "first"
    names = sorted(path.name for path in folder.glob("t06_v010_f03_*.csv"))
    content = (folder / names[0]).read_bytes().replace(b"0.0", b"0.00", 1)
    before = content_of(root)
    full("entry.json")
    with pytest.raises(InputError):
        incoming.take_press(root, "campaigns/first", names[0], content)
    assert content_of(root) == before


def test_no_room_to_read_a_press_is_a_sentence(tmp_path, monkeypatch):
    root = lab.lab_project(tmp_path / "thumb")
    name = next((root / "campaigns" / "first").glob("t*.csv")).name

    def refuse(*words, **more):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(file_transfer.tempfile, "TemporaryDirectory", refuse)
    with raises_code("file_unreadable", "trace"):
        incoming.take_press(root, "campaigns/second", name, b"1,2,3\n")


def test_a_file_in_the_place_of_a_folder_is_a_sentence(tmp_path):
    root = make_project(tmp_path / "thumb").root
    (root / "measured" / "a.csv").write_text("1")
    gone = bin.delete(root, "measured/a.csv")
    (root / "measured").rmdir()
    (root / "measured").write_text("no folder")
    with pytest.raises(InputError):
        bin.keep_file(root, root / "measured", "b.csv", b"1")
    with pytest.raises(InputError):
        bin.restore(root, gone)
    (root / "measured").unlink()
    assert bin.restore(root, gone) == "measured/a.csv"
    assert bin.keep_file(root, root / "measured", "b.csv", b"1").name == "b.csv"


def test_what_runs_is_known_in_a_folder_that_cannot_be_written(tmp_path, monkeypatch):
    import builtins

    lock = acquire_lock(tmp_path / "lock")
    assert lock is not None
    real = builtins.open

    def read_alone(file, mode="r", *words, **more):
        if set(mode) & set("wax+"):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        return real(file, mode, *words, **more)

    monkeypatch.setattr(builtins, "open", read_alone)
    assert is_locked(tmp_path / "lock")
    lock.close()
    assert not is_locked(tmp_path / "lock")


@pytest.mark.slow
def test_a_project_file_that_cannot_be_written_is_told_on_the_page_and_the_same_click_works_later(tmp_path):
    root = make_project(tmp_path / "thumb", tissue="forefinger").root
    with running(root, tmp_path / "home") as studio, browser() as page:
        page.set_default_timeout(120_000)
        page.goto(studio.address)
        page.wait_for_selector("h1")
        page.goto(f"{studio.home}tissue")
        page.wait_for_selector(by("use"))
        (root / "project.toml").rename(root / "kept.toml")
        (root / "project.toml").mkdir()
        page.locator(by("use")).click()
        page.wait_for_selector(".problem >> text=project.toml")
        (root / "project.toml").rmdir()
        (root / "kept.toml").rename(root / "project.toml")
        page.locator(by("use")).click()
        page.wait_for_selector("h1 >> text=Design")
        studio.process.terminate()
        assert "Traceback" not in studio.process.stderr.read()
