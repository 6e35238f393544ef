"""Deleted, replaced, edited, restored: nothing is lost, nothing is overwritten."""

from __future__ import annotations

import errno
import json
import os
import pathlib
import time

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock
from dummydesign.project.folder import make_project, read_project
from dummydesign.studio import job_process as runner
from dummydesign.studio import jobs
from dummydesign.studio import trash as bin
from tests.support.refusal import raises_code


@pytest.fixture
def root(tmp_path):
    made = make_project(tmp_path / "thumb", tissue="tissue/mine.toml").root
    (made / "measured" / "a.csv").write_text("1")
    (made / "measured" / "import-a").mkdir()
    (made / "measured" / "import-a" / "a_1.csv").write_text("press")
    tissue = made / "tissue" / "mine.toml"
    tissue.write_text('schema = 1\nname = "mine"\n\n[[subject]]\nname = "mine"\n')
    report = made / "tissue" / "mine-report"
    report.mkdir()
    (report / "report.html").write_text("report")
    (made / "tissue" / "minerva.toml").write_text('name = "minerva"\n')
    (report / "manifest.json").write_text(json.dumps({"command": "fit", "sha256": {}}))
    return made


@pytest.fixture
def running(root):
    """A command that is at work: its lock is held."""
    held = []

    def start(*words):
        folder = root / ".studio" / "jobs" / "0001-step"
        folder.mkdir(parents=True)
        asked = {"name": "step", "words": list(words), "cwd": str(root), "start": time.time()}
        (folder / runner.COMMAND).write_text(json.dumps(asked))
        held.append(acquire_lock(folder / runner.LOCK))
        assert jobs.all_jobs(root)[0].state == "running"

    yield start
    for lock in held:
        lock.close()


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_what_is_deleted_lies_in_the_bin_and_comes_back_as_it_was(root):
    gone = bin.delete(root, "measured/import-a")
    assert not (root / "measured" / "import-a").exists()
    assert [one.path for one in bin.deleted(root)] == ["measured/import-a"]
    assert bin.restore(root, gone) == "measured/import-a"
    assert (root / "measured" / "import-a" / "a_1.csv").read_text() == "press"
    assert bin.deleted(root) == [] and names(root / ".studio" / "bin") == []


def test_a_tissue_goes_and_comes_back_with_its_report_and_leaves_others_alone(root):
    gone = bin.delete(root, "tissue/mine.toml")
    assert names(root / "tissue") == ["minerva.toml"]
    assert bin.restore(root, gone) == "tissue/mine.toml"
    assert names(root / "tissue") == ["mine-report", "mine.toml", "minerva.toml"]


def test_a_tissue_of_before_2_0_goes_with_the_files_that_its_manifest_beside_it_lists(root):
    tissue, before = (
        root / "tissue",
        ("mine-report.html", "mine-report.csv", "mine_residuals.csv", "mine_residuals.png"),
    )
    for name in before:
        (tissue / name).write_text(name)
    (tissue / "minerva-report.html").write_text("of another")
    listed = (*before, "mine.toml", "minerva.toml", "../project.toml", "import-a/gone.csv")
    sums = dict.fromkeys(listed, "0" * 64)
    (tissue / "mine-manifest.json").write_text(json.dumps({"command": "fit", "sha256": sums}))
    there = names(tissue)
    gone = bin.delete(root, "tissue/mine.toml")
    assert names(tissue) == ["minerva-report.html", "minerva.toml"] and (root / "project.toml").is_file()
    assert bin.restore(root, gone) == "tissue/mine.toml"
    assert names(tissue) == there and (tissue / "mine-report.csv").read_text() == "mine-report.csv"


def test_things_of_one_name_deleted_in_one_second_are_all_kept(root):
    for text in ("1", "2", "3"):
        (root / "measured" / "a.csv").write_text(text)
        bin.delete(root, "measured/a.csv")
    newest_first = [(one.folder / bin.CONTENT / "a.csv").read_text() for one in bin.deleted(root)]
    assert newest_first == ["3", "2", "1"]


def test_what_is_in_the_bin_for_longer_than_a_month_goes_with_the_next_deletion(root, monkeypatch):
    now = time.time()
    kept = {}
    for days in (31.0, 29.0, 0.0):
        monkeypatch.setattr(bin.time, "time", lambda days=days: now - days * 86400.0)
        (root / "measured" / "a.csv").write_text(f"{days}")
        kept[days] = bin.delete(root, "measured/a.csv")
    assert bin.deleted(root) == [kept[0.0], kept[29.0]]
    assert names(root / ".studio" / "bin") == sorted(one.folder.name for one in (kept[0.0], kept[29.0]))


def test_a_delete_that_is_refused_changes_nothing(root, monkeypatch):
    """A folder without the right to rename in it: no copy is made, and no part is removed."""
    design = root / "designs" / "a"
    design.mkdir()
    (design / "report.html").write_text("report")
    real = pathlib.Path.rename

    def refuse(path, target):
        if path.parent == root / "designs":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return real(path, target)

    monkeypatch.setattr(pathlib.Path, "rename", refuse)
    with raises_code("file_unwritable", "path"):
        bin.delete(root, "designs/a")
    assert (design / "report.html").read_text() == "report"
    assert names(root / "designs") == ["a"] and bin.deleted(root) == []


def test_what_cannot_be_moved_back_stays_in_the_bin(root, monkeypatch):
    """Of a tissue's files the second is refused, and so is the way back of the first: nothing is lost."""
    real, moved = pathlib.Path.rename, []

    def refuse_all_but_the_first(path, target):
        moved.append(path)
        if len(moved) > 1:
            raise OSError(errno.EIO, os.strerror(errno.EIO), str(path))
        return real(path, target)

    monkeypatch.setattr(pathlib.Path, "rename", refuse_all_but_the_first)
    with pytest.raises(InputError):
        bin.delete(root, "tissue/mine.toml")
    assert [one.path for one in bin.deleted(root)] == ["tissue/mine.toml"]
    assert (bin.deleted(root)[0].folder / bin.CONTENT / "mine.toml").is_file()


def test_a_restore_overwrites_nothing(root):
    gone = bin.delete(root, "measured/a.csv")
    (root / "measured" / "a.csv").write_text("new")
    assert bin.restore(root, gone) == "measured/a.csv"
    assert (root / "measured" / "a.csv").read_text() == "1"
    (other,) = bin.deleted(root)
    bin.restore(root, other)
    assert (root / "measured" / "a.csv").read_text() == "new" and len(bin.deleted(root)) == 1


def test_a_restore_that_would_write_over_a_part_is_refused_and_moves_nothing(root):
    gone = bin.delete(root, "tissue/mine.toml")
    (root / "tissue" / "mine-report").write_text("of another")
    with raises_code("file_unwritable", "path"):
        bin.restore(root, gone)
    assert names(root / "tissue") == ["mine-report", "minerva.toml"]
    assert (root / "tissue" / "mine-report").read_text() == "of another" and bin.deleted(root) == [gone]


def test_a_choice_for_the_project_can_be_taken_back(root):
    before = (root / "project.toml").read_bytes()
    bin.choose_for_project(read_project(root), tissue="palm")
    assert read_project(root).tissue == "palm"
    bin.restore(root, bin.deleted(root)[0])
    assert (root / "project.toml").read_bytes() == before


def test_an_edit_that_is_refused_leaves_nothing_in_the_bin(root):
    with pytest.raises(InputError), bin.kept_before(root, "measured/a.csv"):
        raise InputError("no", "malformed", "x")
    assert bin.deleted(root) == [] and names(root / ".studio" / "bin") == []


def test_what_was_restored_cannot_be_restored_again(root):
    gone = bin.delete(root, "measured/a.csv")
    bin.restore(root, gone)
    with pytest.raises(InputError):
        bin.restore(root, gone)
    assert names(root / "measured") == ["a.csv", "import-a"]


def test_a_press_of_a_plan_that_is_gone_waits_for_its_plan(root):
    plan = root / "campaigns" / "first"
    plan.mkdir()
    (plan / "t1.csv").write_text("1")
    press, whole = bin.delete(root, "campaigns/first/t1.csv"), bin.delete(root, "campaigns/first")
    with raises_code("file_not_found", "folder"):
        bin.restore(root, press)
    assert not plan.exists()
    bin.restore(root, whole)
    assert bin.restore(root, press) == "campaigns/first/t1.csv"


def test_a_file_whose_name_is_as_long_as_a_name_may_be_is_deleted_and_comes_back(root):
    name = f"{'a' * 251}.csv"
    (root / "measured" / name).write_text("1")
    assert bin.restore(root, bin.delete(root, f"measured/{name}")) == f"measured/{name}"


@pytest.mark.parametrize(
    "path",
    [
        "measured",
        "measured/",
        "../other",
        ".studio/jobs",
        "measured/b.csv",
        "measured/../project.toml",
        "/etc/hosts",
    ],
)
def test_only_things_of_the_steps_can_be_deleted(root, path):
    with pytest.raises(InputError):
        bin.delete(root, path)
    assert (root / "project.toml").is_file() and bin.deleted(root) == []


@pytest.mark.parametrize(
    ("words", "path"),
    [
        (["import", "measured/a.csv", "--out", "measured/import-b"], "measured/a.csv"),
        (["fit", "measured/import-a/a_1.csv", "--out", "tissue/x.toml"], "measured/import-a"),
        (["suggest", "--tissue", "tissue/mine.toml", "--out", "designs/a"], "tissue/mine.toml"),
        (["compare", "designs/b,measured/import-a"], "measured/import-a"),
        (["loop", "measured"], "measured/a.csv"),
        (["predict", "--punch", "profile:measured/a.csv"], "measured/a.csv"),
    ],
)
def test_what_a_running_command_reads_or_writes_stays(root, running, words, path):
    running(*words)
    with raises_code("busy", "path"):
        bin.delete(root, path)
    with raises_code("busy", "path"), bin.kept_before(root, path):
        pass
    assert (root / path).exists()
    # and nothing else is held back: '.' and numbers are no folders of it
    other = "measured/import-a" if "measured/a.csv" in words else "tissue/minerva.toml"
    bin.delete(root, other)


def test_an_upload_with_the_content_of_another_file_is_not_copied(root):
    assert bin.twin(root / "measured", "b.csv", b"1") == "a.csv"
    assert bin.twin(root / "measured", "a.csv", b"1") is None and bin.twin(root / "measured", "b.csv", b"2") is None
    assert bin.keep_file(root, root / "measured", "a.csv", b"1").gone is None
    assert names(root / "measured") == ["a.csv", "import-a"]


def test_an_upload_of_a_name_that_is_there_takes_its_place_and_the_old_file_comes_back(root):
    taken = bin.keep_file(root, root / "measured", "a.csv", b"2")
    assert (taken.name, taken.gone.why) == ("a.csv", "replaced")
    assert (root / "measured" / "a.csv").read_bytes() == b"2"
    bin.restore(root, taken.gone)
    assert (root / "measured" / "a.csv").read_bytes() == b"1"


def test_an_upload_does_not_replace_what_a_running_command_reads(root, running):
    running("import", "measured/a.csv", "--out", "measured/import-b")
    with raises_code("busy", "path"):
        bin.keep_file(root, root / "measured", "a.csv", b"2")
    assert (root / "measured" / "a.csv").read_bytes() == b"1"


@pytest.mark.parametrize("when", ["1e300", "NaN", "Infinity", "-1e300", "null"])
def test_an_entry_of_no_time_is_passed_over(root, when):
    kept = bin.delete(root, "measured/import-a")
    odd = bin.delete(root, "measured/a.csv")
    (odd.folder / bin.ENTRY).write_text(f'{{"path": "measured/a.csv", "why": "deleted", "time": {when}}}')
    assert bin.deleted(root) == [kept]


def test_an_upload_into_a_folder_that_leads_out_of_the_project_is_refused(root, tmp_path):
    (tmp_path / "theirs").mkdir()
    (root / "pucks").symlink_to(tmp_path / "theirs")
    with pytest.raises(InputError):
        bin.keep_file(root, root / "pucks", "a.csv", b"1")
    assert names(tmp_path / "theirs") == []
