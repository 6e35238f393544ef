"""A studio on a half-way project, and a browser that looks at it."""

from __future__ import annotations

import pytest

from tests.support.lab_project import lab_project
from tests.support.studio import browser, running

WAIT_MS = 120_000
"""For what a page does at once, on a busy machine. [ms]"""


@pytest.fixture
def studio(tmp_path):
    root = lab_project(tmp_path / "thumb")
    with running(root, tmp_path / "home") as found:
        yield found, root


@pytest.fixture
def page(studio):
    with browser(viewport={"width": 1280, "height": 900}) as found:
        found.set_default_timeout(WAIT_MS)
        found.goto(studio[0].address)
        found.wait_for_selector("h1")
        yield found
        assert found.broken == [] and found.outside == []
