"""Tests solve what they test: the user's cache is neither read nor written, also by commands they start.

``pytest -m slow --part 1/3`` runs one of three parts of the long tests; together the parts are all of them.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator

import hypothesis
import pytest

os.environ["DUMMYDESIGN_CACHE"] = "off"
# At a landing the drawn examples are the same for the same code; at a desk they are new each time.
# How long a busy machine takes to draw them is no fault of the code.
BUSY = [hypothesis.HealthCheck.too_slow]
hypothesis.settings.register_profile("landing", derandomize=True, deadline=None, suppress_health_check=BUSY)
hypothesis.settings.register_profile("desk", deadline=None, suppress_health_check=BUSY)
hypothesis.settings.load_profile("landing" if os.environ.get("CI") else "desk")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--part", default="1/1", help="K/N: the tests whose name falls into part K of N")


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


@pytest.fixture(autouse=True, scope="session")
def one_thread() -> Iterator[None]:
    """As in a command: workers that each take all cores for small matrices wait for one another."""
    import scipy.linalg  # noqa: F401
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, "blas"):
        yield


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    """A user's folder, and a function that writes a changed file of the package into it."""
    home = tmp_path / "home"
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(home))

    def write(name, old="", new=""):
        from dummydesign.core.user_library import data_folder

        text = (data_folder() / name).read_text()
        assert old in text
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        (home / name).write_text(text.replace(old, new, 1))
        return home / name

    return write
