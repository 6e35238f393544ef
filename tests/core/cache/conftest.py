"""A cache folder of the test's own."""

import pytest


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"
