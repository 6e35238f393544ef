"""The page from test machine to design: its commands are understood, its files are made, its pictures are there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from dummydesign.cli.entry import parser_of
from dummydesign.measurement.campaign_status import check_campaign

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "from-machine-to-design.md"
COMMANDS = re.findall(r"^(?:\$ )?dummydesign (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_goes_through_every_step_in_order():
    names = [command.split()[0] for command in COMMANDS]
    wanted = ["import", "fit", "tissues", "resins", "suggest", "campaign", "compare", "loop"]
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
