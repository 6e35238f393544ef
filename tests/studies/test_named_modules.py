"""Modules that data files, messages and documents name are there, so that what they say can be repeated."""

from __future__ import annotations

import pydoc
import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

import dummydesign
from dummydesign.core.user_library import data_folder

PACKAGE = Path(dummydesign.__file__).parent
PROJECT = PACKAGE.parent
# not schemas, dummydesign.loop/1
NAME = re.compile(r"(?<![\w./-])(?:dummydesign|studies)(?:\.[A-Za-z_]\w*+)++(?![-/])")
RUN = re.compile(r"python -m ((?:dummydesign|studies)(?:\.\w+)+)")


def texts() -> list[Path]:
    """Sources, shipped data and, in a checkout, the documents and benchmarks."""
    shipped = [path for folder in ("materials", "molds") for path in (data_folder() / folder).rglob("*")]
    documents = [*PROJECT.glob("docs/**/*.md"), *PROJECT.glob("*.md"), *PROJECT.glob("benchmarks/**/*.py")]
    kept = [*PACKAGE.rglob("*.py"), *PROJECT.glob("studies/**/*.py"), *shipped, *documents]
    return sorted(p for p in kept if p.suffix in (".py", ".md", ".toml", ".json") and p.name != "CHANGELOG.md")


@cache
def there(name: str) -> bool:
    """Whether a dotted name is a module, something inside one, or a member of a class."""
    return pydoc.locate(name) is not None


def test_every_module_that_is_named_is_there():
    gone = {
        f"{path.name}: {name}"
        for path in texts()
        for name in NAME.findall(path.read_text(encoding="utf-8"))
        if name != "dummydesign.effects" and not there(name)  # a group of entry points
    }
    assert gone == set()


@pytest.mark.parametrize("name", sorted({n for p in texts() for n in RUN.findall(p.read_text(encoding="utf-8"))}))
def test_what_is_to_be_run_by_its_name_can_be_run(name):
    spec = find_spec(name)
    if spec.submodule_search_locations is not None:
        spec = find_spec(f"{name}.__main__")
    assert '__name__ == "__main__"' in Path(spec.origin).read_text(encoding="utf-8")


FOLDERS = "dummydesign|pad|studies|tests|benchmarks|docs|examples|resin|tissue"
PATH = re.compile(rf"(?<![\w/.-])(?:{FOLDERS})/[\w/.-]*\w\.(?:py|js|md|csv)\b")


def test_every_file_that_a_document_names_is_there():
    gone = {
        f"{path.name}: {name}"
        for path in [*PROJECT.glob("docs/*.md"), *PROJECT.glob("*.md")]
        if path.name != "CHANGELOG.md"
        for name in PATH.findall(path.read_text(encoding="utf-8"))
        if "NAME" not in name and not any((base / name).exists() for base in (PROJECT, PACKAGE))
    }
    assert gone == set()


def rows_of_benchmarks() -> list[list[str]]:
    """Cells of the table of benchmarks: question, command, minutes, figure, page, rows."""
    text = (PROJECT / "benchmarks" / "README.md").read_text(encoding="utf-8")
    return [re.split(r" ?\| ?", line)[1:-1] for line in text.splitlines() if line.startswith("| ")][1:]


def test_every_result_of_a_benchmark_has_the_command_that_makes_it():
    kept = [name for row in rows_of_benchmarks() for name in re.findall(r"`([^`]+)`", row[5])]
    assert sorted(kept) == sorted(path.name for path in (PROJECT / "benchmarks" / "results").iterdir())


def test_every_benchmark_is_in_the_table_and_the_page_that_quotes_it_has_its_command():
    listed = [(row[4], name) for row in rows_of_benchmarks() for name in re.findall(r"python -m ([\w.]+)", row[1])]
    programs = {
        ".".join(path.relative_to(PROJECT).with_suffix("").parts)
        for path in PROJECT.glob("benchmarks/*/*.py")
        if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
    }
    assert {name for _, name in listed} == programs
    without = {
        f"{page}: {name}"
        for page, name in listed
        if page.endswith(".md") and page != "CHANGELOG.md" and name not in (PROJECT / page).read_text(encoding="utf-8")
    }
    assert without == set()
