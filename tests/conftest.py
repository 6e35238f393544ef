"""Tests solve what they test: the user's cache is neither read nor written, also by commands they start.

In the rooms whose tests are about what commands choose, say and write, a solve is kept for the time of one run, so
that each pad is solved once and not by each test that asks for it. The rooms of the solvers keep nothing, and a test
that compares two ways to one answer is marked ``solves_itself``.

``pytest -m slow --part 1/3`` runs one of three parts of the long tests; together the parts are all of them.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile

import hypothesis
import pytest

CACHE, OF_THIS_RUN = "DUMMYDESIGN_CACHE", "DUMMYDESIGN_TESTS_SOLVES"
os.environ[CACHE] = "off"
KEEPING = ("tests/cli/", "tests/design/", "tests/project/", "tests/report/", "tests/test_")
if OF_THIS_RUN not in os.environ:  # its other processes find it there
    os.environ[OF_THIS_RUN] = tempfile.mkdtemp(prefix="dummydesign-tests-")
    atexit.register(shutil.rmtree, os.environ[OF_THIS_RUN], ignore_errors=True)
# At a landing the drawn examples are the same for the same code; at a desk they are new each time.
hypothesis.settings.register_profile("landing", derandomize=True)
if os.environ.get("CI"):
    hypothesis.settings.load_profile("landing")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--part", default="1/1", help="K/N: the tests whose name falls into part K of N")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Before any fixture of the test is made, whatever its scope."""
    keeping = item.nodeid.startswith(KEEPING) and item.get_closest_marker("solves_itself") is None
    os.environ[CACHE] = os.environ[OF_THIS_RUN] if keeping else "off"


def part_of(name: str, parts: int) -> int:
    """Part, from 1, that a test falls into: by its name alone, so that new tests move no others."""
    return int(hashlib.sha256(name.encode()).hexdigest(), 16) % parts + 1


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    asked, _, parts = config.getoption("--part").partition("/")
    if not (asked.isdigit() and parts.isdigit() and 1 <= int(asked) <= int(parts)):
        raise pytest.UsageError(f"--part {asked}/{parts}: K/N with whole numbers, 1 <= K <= N")
    if parts == "1":
        return
    kept = [item for item in items if part_of(item.nodeid, int(parts)) == int(asked)]
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = kept
