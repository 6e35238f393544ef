"""Files are written whole or not at all, also by several at once."""

import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked, write_bytes
from tests.support.refusal import raises_code


def test_two_that_write_one_file_at_once_both_succeed_and_one_of_them_stands(tmp_path):
    contents = [bytes([65 + number]) * 20_000 for number in range(2)]

    def write(content):
        for _ in range(100):
            write_bytes(tmp_path / "a.csv", content)

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(write, contents))
    assert (tmp_path / "a.csv").read_bytes() in contents
    assert os.listdir(tmp_path) == ["a.csv"]


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_an_interrupted_write_leaves_what_was_there_and_nothing_else(tmp_path, monkeypatch, step, failure):
    write_bytes(tmp_path / "a.csv", b"old")

    def fail(*_):
        raise failure

    monkeypatch.setattr(os, step, fail)
    with pytest.raises(InputError if isinstance(failure, OSError) else KeyboardInterrupt):
        write_bytes(tmp_path / "a.csv", b"new")
    assert os.listdir(tmp_path) == ["a.csv"] and (tmp_path / "a.csv").read_bytes() == b"old"


def test_an_unfinished_file_is_hidden(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(os, "fsync", lambda _: seen.extend(os.listdir(tmp_path)))
    write_bytes(tmp_path / "a.csv", b"1")
    assert len(seen) == 1 and seen[0].startswith(".")


@pytest.mark.parametrize("place", ["none/a.csv", "file/a.csv", "folder"])
def test_a_place_that_cannot_be_written_is_one_line(tmp_path, place):
    (tmp_path / "file").write_text("x", encoding="utf-8")
    (tmp_path / "folder").mkdir()
    with raises_code("file_unwritable", "file"):
        write_bytes(tmp_path / place, b"1")
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]


def test_a_written_file_has_the_rights_of_any_new_file(tmp_path):
    (tmp_path / "plain").touch()
    write_bytes(tmp_path / "a.csv", b"1")
    assert (tmp_path / "a.csv").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_name_as_long_as_the_disk_allows_is_written(tmp_path):
    assert write_bytes(tmp_path / ("指" * 85), b"1").read_bytes() == b"1"


def test_a_lock_is_held_until_it_is_let_go_and_patience_waits_for_it(tmp_path):
    place = tmp_path / "new" / "lock"
    assert not is_locked(place)
    mine = acquire_lock(place)
    assert mine is not None and is_locked(place)
    begun = time.monotonic()
    assert acquire_lock(place) is None
    assert acquire_lock(place, 0.05) is None and time.monotonic() - begun > 0.04
    threading.Timer(0.05, mine.close).start()
    later = acquire_lock(place, 60.0)
    assert later is not None
    later.close()
    assert not is_locked(place)
