"""The cache of solved results: the same to the last bit, never stale, never trusted when damaged, never in the way."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from dummydesign.core import cache
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.material.ogden import Ogden

VALUE = {
    "force": np.array([[0.1 + 0.2, 1e-300, np.pi]]), "count": np.array([3, 4]), "none": np.array([]),
    "notes": ("a", "b\nc"), "solver": {"seconds": 1.5, "corner": {0.45: 1.0 / 3.0}}, "stop": None, "gap": float("nan"),
}  # fmt: skip


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


class Solve:
    """Counts how often it was asked."""

    def __init__(self, value=None):
        self.calls, self.value = 0, {"force": 2.5} if value is None else value

    def __call__(self):
        self.calls += 1
        return self.value


def entries(place):
    return sorted(place.glob("*.json"))


def same(one, other):
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and one.dtype == other.dtype and np.array_equal(one, other)
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[name], other[name]) for name in one)
    return type(one) is type(other) and (one == other or (one != one and other != other))


def test_a_kept_result_is_the_computed_one_to_the_last_bit(place):
    solve = Solve(VALUE)
    fresh, kept = (cache.cached("test", {"depth": np.linspace(0.0, 1.0, 3)}, solve) for _ in range(2))
    assert solve.calls == 1
    assert same(fresh, VALUE) and same(kept, VALUE)


@pytest.mark.parametrize(
    "other",
    [{"a": 1.0000000000000002, "law": Yeoh(1.0)}, {"a": 1.0, "law": Yeoh(1.0, 0.1)}, {"a": 1.0, "law": Ogden([1], [2])},
     {"a": 1.0, "law": None}, {"a": [1.0], "law": Yeoh(1.0)}],
)  # fmt: skip
def test_other_inputs_are_another_entry(place, other):
    solve = Solve()
    cache.cached("test", {"a": 1.0, "law": Yeoh(1.0)}, solve)
    cache.cached("test", other, solve)
    assert solve.calls == 2


def test_equal_inputs_in_another_order_and_form_are_the_same_entry(place):
    solve = Solve()
    cache.cached("test", {"a": (1.0, 2.0), "b": -0.0}, solve)
    cache.cached("test", {"b": np.float64(0.0), "a": np.array([1.0, 2.0])}, solve)
    assert solve.calls == 1


def test_changed_code_never_serves_old_numbers(place, monkeypatch):
    solve = Solve()
    cache.cached("test", {"a": 1}, solve)
    monkeypatch.setattr(cache, "code_version", lambda: "another")
    cache.cached("test", {"a": 1}, solve)
    assert solve.calls == 2


@pytest.fixture
def copied(tmp_path, monkeypatch):
    """A package of a few sources and its data, in the place of this one."""
    package, data = tmp_path / "package", tmp_path / "data"
    for path in ("__init__.py", "shape.py", "pad/slab/newton.py"):
        (package / path).parent.mkdir(parents=True, exist_ok=True)
        (package / path).write_text("one")
    for path in ("slab-bonded.json", "shapes/crowned.json"):
        (data / "materials" / "tables" / path).parent.mkdir(parents=True, exist_ok=True)
        (data / "materials" / "tables" / path).write_text("[1.0]")
    monkeypatch.setattr(cache, "package_folder", lambda: package)
    monkeypatch.setattr(cache, "data_folder", lambda: data)
    return tmp_path


@pytest.mark.parametrize(
    "path",
    ["package/shape.py", "package/pad/slab/newton.py", "data/materials/tables/slab-bonded.json",
     "data/materials/tables/shapes/crowned.json"],
)  # fmt: skip
def test_a_byte_in_a_source_or_a_table_at_any_depth_is_another_code_version(copied, path):
    before = cache.code_version.__wrapped__()
    assert cache.code_version.__wrapped__() == before
    (copied / path).write_text((copied / path).read_text().replace("1", "2").replace("one", "two"))
    assert cache.code_version.__wrapped__() != before


def test_a_source_or_table_that_comes_goes_or_moves_is_another_code_version(copied):
    found = [cache.code_version.__wrapped__()]
    package, tables = copied / "package", copied / "data" / "materials" / "tables"
    for old, new in (
        (package / "shape.py", package / "pad" / "shape.py"),
        (tables / "slab-bonded.json", tables / "slab-sliding.json"),
    ):
        old.rename(new)
        found.append(cache.code_version.__wrapped__())
        new.unlink()
        found.append(cache.code_version.__wrapped__())
    assert len(set(found)) == 5


def test_what_a_run_leaves_beside_the_sources_does_not_count(copied):
    before = cache.code_version.__wrapped__()
    (copied / "package" / "pad" / "__pycache__").mkdir()
    (copied / "package" / "pad" / "__pycache__" / "newton.cpython-311.pyc").write_bytes(b"x")
    assert cache.code_version.__wrapped__() == before


@pytest.mark.parametrize("gone", ["package", "data"])
def test_without_sources_or_tables_to_hash_nothing_is_kept(copied, place, monkeypatch, gone):
    """An installation without readable sources (a zip file) cannot tell old numbers from new ones."""
    shutil.rmtree(copied / gone)
    monkeypatch.setattr(cache, "code_version", cache.code_version.__wrapped__)
    solve = Solve()
    for _ in range(2):
        assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2 and not place.exists()


def test_the_code_version_covers_what_cached_shaped_results_are_made_of():
    """The tables that a shaped pad multiplies, and every module of the package wherever it lies."""
    from dummydesign.core.datafiles import data_folder

    hashed = {path.resolve() for path in cache.sources()}
    ours = (module for name, module in sys.modules.items() if name.split(".")[0] == "dummydesign")
    loaded = [file for module in ours if (file := getattr(module, "__file__", None))]  # toys of tests have no file
    assert {Path(file).resolve() for file in loaded} <= hashed
    tables = {path.resolve() for path in (data_folder() / "materials" / "tables").iterdir()}
    assert tables and tables <= hashed


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
    solve = Solve()
    cache.cached("test", {"a": 1}, solve)
    (path,) = entries(place)
    path.write_bytes(DAMAGE[name](path.read_bytes()))
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2


def test_a_sound_entry_of_another_question_under_this_name_is_made_anew(place):
    one, other = Solve(), Solve({"force": 9.0})
    cache.cached("test", {"a": 1}, one)
    cache.cached("test", {"a": 2}, other)
    first, second = entries(place)
    first.write_bytes(second.read_bytes())
    second.write_bytes(first.read_bytes())
    assert cache.cached("test", {"a": 1}, one) == {"force": 2.5}
    assert cache.cached("test", {"a": 2}, other) == {"force": 9.0}
    assert one.calls + other.calls == 3


def test_a_folder_in_the_place_of_an_entry_is_no_error(place):
    solve = Solve()
    cache.cached("test", {"a": 1}, solve)
    (path,) = entries(place)
    path.unlink()
    path.mkdir()
    assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert [p.name for p in place.iterdir()] == [path.name]


def test_a_folder_that_cannot_be_made_means_no_cache(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("DUMMYDESIGN_CACHE", str(tmp_path / "file" / "cache"))
    solve = Solve()
    for _ in range(2):
        assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2


def test_a_full_disk_leaves_nothing_behind(place, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert cache.cached("test", {"a": 1}, Solve()) == {"force": 2.5}
    assert list(place.iterdir()) == []


def test_off_keeps_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("DUMMYDESIGN_CACHE", "off")
    solve = Solve()
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
    assert found == {
        "linux": "dummydesign", "win32": "local/dummydesign/Cache", "darwin": "Library/Caches/dummydesign"
    }  # fmt: skip


@dataclass(frozen=True)
class ForeignLaw:
    """A law whose code this package does not know."""

    shear_MPa: float = 1.0


@pytest.mark.parametrize("what", [ForeignLaw(), lambda r: r, object()])
def test_what_has_no_canonical_form_is_computed_each_time(place, what):
    solve = Solve()
    for _ in range(2):
        cache.cached("test", {"law": what}, solve)
    assert solve.calls == 2 and not place.exists()


def test_an_error_is_passed_on_and_not_kept(place):
    def fail():
        raise ValueError("folded")

    for _ in range(2):
        with pytest.raises(ValueError, match="folded"):
            cache.cached("test", {"a": 1}, fail)
    assert not place.exists()


def test_beyond_its_bounds_the_entries_unused_for_longest_go_and_nothing_else(place, monkeypatch):
    monkeypatch.setattr(cache, "MOST_ENTRIES", 10)
    solve = Solve()
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
        cache.cached("test", {"a": number}, Solve({"force": np.full(1000, 0.1 + number)}))
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


def test_writers_at_the_same_time_do_not_disturb_each_other(place):
    """Three processes write, read and remove the same entries."""
    started = [
        subprocess.Popen([sys.executable, "-c", WRITER, str(place)], stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    ended = [process.communicate()[1] for process in started]
    assert ended == ["", "", ""]
    assert [path for path in place.iterdir() if path.suffix != ".json"] == []


def test_an_entry_is_text_that_says_what_was_asked(place):
    cache.cached("test", {"law": Yeoh(1.0, 0.5)}, Solve())
    (path,) = entries(place)
    _, asked, value = path.read_text().split("\n")
    assert json.loads(asked)["inputs"] == {"law": {"Yeoh": {"shear_MPa": 1.0, "c2_MPa": 0.5}}}
    assert json.loads(value)["values"] == [["force", 2.5]]


def test_a_prediction_from_the_cache_is_the_fresh_one_and_serves_other_moduli(place, monkeypatch):
    """A puck by elements: the second time nothing is solved, seconds and counts are those of the solve."""
    from dummydesign.pad import puck
    from dummydesign.pad.predict import Pad, predict_static

    def pressed(young_MPa):
        pad = Pad(30.0, young_MPa, 25.0, condition="frictionless", cylinder=True)
        return predict_static(pad, [3.0, 6.0], "axisymmetric").to_dict()

    fresh = pressed(0.03)
    monkeypatch.setattr(puck, "compress", None)
    assert json.dumps(pressed(0.03)) == json.dumps(fresh)
    assert pressed(0.06)["force_N"] == pytest.approx(2.0 * np.array(fresh["force_N"]), rel=1e-12)
    assert len(entries(place)) == 1
