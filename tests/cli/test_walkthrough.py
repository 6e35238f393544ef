"""The page from test machine to design: its commands run and print what it shows, its pictures are there.

When answers change: ``python -m tests.support.walkthrough`` renews the blocks.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from dummydesign.cli.entry import parser_of
from dummydesign.measurement.campaign_presses import check_campaign
from tests.support.walkthrough import blocks, fault, run_blocks

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "from-machine-to-design.md"
COMMANDS = re.findall(r"^(?:\$ )?dummydesign (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_goes_through_every_step_in_order():
    names = [command.split()[0] for command in COMMANDS]
    wanted = ["import", "fit", "tissues", "suggest", "resins", "campaign", "compare", "loop"]
    places = [names.index(name) for name in wanted]
    assert places == sorted(places)


@pytest.mark.parametrize("command", COMMANDS)
def test_its_commands_are_understood(command):
    name, *words = shlex.split(command)
    parser_of(name).parse_args(words)


def test_its_links_and_pictures_are_there():
    for target in re.findall(r"\]\(([^)#]+)\)", PAGE.read_text(encoding="utf-8")):
        assert (PAGE.parent / target).exists(), target


def test_the_example_campaign_is_ready_for_the_loop():
    status = check_campaign(ROOT / "examples" / "campaign")
    assert status.ready and len(status.pressed) == 16 and not status.warnings


def faults_of(count: int | None, folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """First differing line of each of the page's answers, from its first commands on."""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(folder / "home"))
    monkeypatch.setenv("COLUMNS", "100")
    page = blocks(PAGE.read_text(encoding="utf-8"))
    assert len(page) == len(COMMANDS)
    answers = run_blocks(folder / "walk", page[:count])
    return [fault(block, answer) for block, answer in answers if block.shown and fault(block, answer)]


@pytest.mark.slow
def test_the_way_to_tissue_and_resin_prints_what_the_page_shows(tmp_path, monkeypatch):
    assert faults_of(4, tmp_path, monkeypatch) == []


@pytest.mark.slow
def test_the_whole_page_prints_what_it_shows(tmp_path, monkeypatch):
    assert faults_of(None, tmp_path, monkeypatch) == []
