"""Entries that are damaged, in the way, too many or written at once: never trusted, never in the way."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from dummydesign.core import cache
from tests.support.counted_solve import CountedSolve, entries

DAMAGE = {
    "empty": lambda text: b"",
    "truncated": lambda text: text[: len(text) // 2],
    "last byte gone": lambda text: text[:-1],
    "one digit changed": lambda text: text.replace(b"2.5", b"2.6"),
    "binary": lambda text: bytes(range(256)),
    "other JSON": lambda text: b'{"force": 7}',
    "checksum of something else": lambda text: b"0" * 64 + text[64:],
    "lines added": lambda text: text + b"\n\n",
}


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_entry_is_made_anew(place, name):
    solve = CountedSolve()
    cache.cached("test", {"a": 1}, solve)
    (path,) = entries(place)
    path.write_bytes(DAMAGE[name](path.read_bytes()))
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2


def test_a_sound_entry_of_another_question_under_this_name_is_made_anew(place):
    one, other = CountedSolve(), CountedSolve({"force": 9.0})
    cache.cached("test", {"a": 1}, one)
    cache.cached("test", {"a": 2}, other)
    first, second = entries(place)
    first.write_bytes(second.read_bytes())
    second.write_bytes(first.read_bytes())
    assert cache.cached("test", {"a": 1}, one) == {"force": 2.5}
    assert cache.cached("test", {"a": 2}, other) == {"force": 9.0}
    assert one.calls + other.calls == 3


def test_a_folder_in_the_place_of_an_entry_is_no_error(place):
    solve = CountedSolve()
    cache.cached("test", {"a": 1}, solve)
    (path,) = entries(place)
    path.unlink()
    path.mkdir()
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert [p.name for p in place.iterdir()] == [path.name]


def test_a_folder_that_cannot_be_made_means_no_cache(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("DUMMYDESIGN_CACHE", str(tmp_path / "file" / "cache"))
    solve = CountedSolve()
    for _ in range(2):
        assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2


def test_a_full_disk_leaves_nothing_behind(place, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert cache.cached("test", {"a": 1}, CountedSolve()) == {"force": 2.5}
    assert list(place.iterdir()) == []


def test_off_keeps_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("DUMMYDESIGN_CACHE", "off")
    solve = CountedSolve()
    for _ in range(2):
        cache.cached("test", {"a": 1}, solve)
    assert solve.calls == 2 and list(tmp_path.iterdir()) == []


def test_without_a_named_folder_it_is_the_platforms_cache_folder(tmp_path, monkeypatch):
    monkeypatch.delenv("DUMMYDESIGN_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    monkeypatch.setenv("HOME", str(tmp_path))
    found = {}
    for platform in ("linux", "win32", "darwin"):
        monkeypatch.setattr(sys, "platform", platform)
        found[platform] = cache.folder().relative_to(tmp_path).as_posix()
    assert found == {"linux": "dummydesign", "win32": "local/dummydesign/Cache", "darwin": "Library/Caches/dummydesign"}


def test_beyond_its_bounds_the_entries_unused_for_longest_go_and_nothing_else(place, monkeypatch):
    monkeypatch.setattr(cache, "MOST_ENTRIES", 10)
    solve = CountedSolve()
    for number in range(10):
        cache.cached("test", {"a": number}, solve)
        newest = max(entries(place), key=lambda path: path.stat().st_mtime_ns)
        os.utime(newest, (1000.0 + number, 1000.0 + number))
    mine = place / "results.json"
    mine.write_text("a file of the user's own")
    old, new = place / ".dummydesign-1.part", place / ".dummydesign-2.part"
    old.write_text(""), new.write_text("")
    os.utime(old, (0.0, 0.0)), os.utime(mine, (0.0, 0.0))
    cache.cached("test", {"a": 0}, solve)  # read: now the one used last
    cache.cached("test", {"a": 10}, solve)
    assert mine.exists() and new.exists() and not old.exists()
    assert len(entries(place)) - 1 == 9
    solve.calls = 0
    for number in (0, 10, 9, 3):
        cache.cached("test", {"a": number}, solve)
    assert solve.calls == 0
    cache.cached("test", {"a": 1}, solve)
    assert solve.calls == 1


def test_the_bound_on_size_holds(place, monkeypatch):
    monkeypatch.setattr(cache, "MOST_BYTES", 100_000)
    for number in range(30):
        cache.cached("test", {"a": number}, CountedSolve({"force": np.full(1000, 0.1 + number)}))
        assert sum(path.stat().st_size for path in entries(place)) <= 100_000
    assert len(entries(place)) >= 5


WRITER = """
import sys
import numpy as np
from dummydesign.core.cache import cached
for number in range(60):
    found = cached("test", {"a": number % 3}, lambda: {"force": np.full(20000, number % 3 + 0.25)})
    assert (found["force"] == number % 3 + 0.25).all()
    for path in __import__("pathlib").Path(sys.argv[1]).glob("*.json"):
        path.unlink(missing_ok=True)
"""


@pytest.mark.slow
def test_writers_at_the_same_time_do_not_disturb_each_other(place):
    """Three processes write, read and remove the same entries."""
    started = [
        subprocess.Popen([sys.executable, "-c", WRITER, str(place)], stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    ended = [process.communicate()[1] for process in started]
    assert ended == ["", "", ""]
    assert [path for path in place.iterdir() if path.suffix != ".json"] == []
