"""Changed sources or tables never serve old numbers."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from dummydesign.core import cache
from tests.support.counted_solve import CountedSolve


def test_changed_code_never_serves_old_numbers(place, monkeypatch):
    solve = CountedSolve()
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
    [
        "package/shape.py",
        "package/pad/slab/newton.py",
        "data/materials/tables/slab-bonded.json",
        "data/materials/tables/shapes/crowned.json",
    ],
)
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
    solve = CountedSolve()
    for _ in range(2):
        assert cache.cached("test", {"a": 1}, solve) == {"force": 2.5}
    assert solve.calls == 2 and not place.exists()


def test_the_code_version_covers_what_cached_shaped_results_are_made_of():
    """The tables that a shaped pad multiplies, and every module of the package wherever it lies."""
    from dummydesign.core.user_library import data_folder

    hashed = {path.resolve() for path in cache.sources()}
    ours = (module for name, module in sys.modules.items() if name.split(".")[0] == "dummydesign")
    loaded = [file for module in ours if (file := getattr(module, "__file__", None))]  # toys of tests have no file
    assert {Path(file).resolve() for file in loaded} <= hashed
    tables = {path.resolve() for path in (data_folder() / "materials" / "tables").iterdir()}
    assert tables and tables <= hashed
