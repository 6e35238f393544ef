"""The documentation site: its made pages, and a build without warnings or requests to outside."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dummydesign
from dummydesign.cli.entry import COMMANDS
from studies import site

TOP = Path(__file__).parents[2]


def test_every_command_and_every_call_has_its_place_in_the_reference():
    text = site.commands_page()
    assert all(f"## {name}\n" in text for name in COMMANDS)
    assert "--thickness" in text
    calls = {name for name in dummydesign.CALLS if name != "close_loop"}
    assert all(re.search(rf"::: \S+\.{name}$", site.python_page(), re.M) for name in calls)


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_asks_nothing_of_other_hosts(tmp_path):
    pytest.importorskip("material", reason="the site needs pip install dummydesign[docs]")
    pytest.importorskip("mkdocstrings")
    environment = {**os.environ, "PYTHONPATH": str(TOP), "NO_MKDOCS_2_WARNING": "1"}
    command = [sys.executable, "-m", "mkdocs", "build", "-q", "-d", str(tmp_path / "site")]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=TOP)
    assert done.returncode == 0, done.stderr
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > 15
    for page in pages:
        text = page.read_text(encoding="utf-8")
        asked = [
            tag for tag in re.findall(r"<(?:script|img|iframe|link)[^>]*>", text) if re.search(r'(src|href)="http', tag)
        ]
        assert not asked, (page.name, asked)
