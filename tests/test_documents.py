"""Links, commands and options that the documents name are there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from dummydesign.cli.entry import COMMANDS
from tests.support.typed_lines import (
    FENCED,
    complaints,
    lines_of_page,
    lines_of_screen,
    names_made,
    options_of_all,
)

ROOT = Path(__file__).resolve().parents[1]
TOP = ("README.md", "CONTRIBUTING.md", "VERIFICATION.md")
PAGES = [*(ROOT / name for name in TOP), *sorted((ROOT / "docs").glob("*.md"))]
PAST = "upgrade.md"
"""Names options that are gone, and wrong commands."""
ASKED_WRONG = ("help", "error-command", "error-tissue", "suggest-help")
SCREENS = [path for path in sorted((ROOT / "tests/snapshots").glob("*.txt")) if path.stem not in ASKED_WRONG]
OPTION = re.compile(r"`(--[a-z][\w-]+)")
NAMED = re.compile(r"(?<!from )(?<!import )\bdummydesign ([a-z][a-z-]+)")
OPTION_HERE = re.compile(r"(?<![\w-])(?<!var\()--[a-z][\w-]*\w(?![\w:{-])")
ELSEWHERE = {"--version", "--shapes", "--rows", "--words", "--solve", "--emcee"}
"""Options of the program itself and of studies."""


def anchors(text: str) -> set[str]:
    """Anchors of a page's headings, as GitHub and MkDocs make them."""
    heads = re.findall(r"^#+ (.+)$", FENCED.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).strip().replace(" ", "-") for head in heads}


def dead_links(page: Path, text: str) -> list[str]:
    """Links of a text whose file or heading is missing."""
    out = []
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        if link.startswith("http"):
            continue
        if not target.exists() or (anchor and anchor not in anchors(target.read_text(encoding="utf-8"))):
            out.append(link)
    return out


def unknown_options(text: str) -> list[str]:
    """Options in a page's running text that no command has."""
    return [word for word in OPTION.findall(FENCED.sub("", text)) if word not in options_of_all() | ELSEWHERE]


LINES = {page.name: lines_of_page(page.read_text(encoding="utf-8"), page.name) for page in PAGES}
MADE = names_made(line for lines in LINES.values() for line in lines)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_commands_options_and_names_of_a_page_are_there(page):
    text = page.read_text(encoding="utf-8")
    assert dead_links(page, text) == []
    lines = LINES[page.name]
    if page.name == PAST:
        lines = [line for line in lines if line.whole]
    else:
        assert unknown_options(text) == []
    assert [one for line in lines for one in complaints(line, MADE)] == []


@pytest.mark.parametrize("path", SCREENS, ids=lambda path: path.stem)
def test_every_command_that_a_screen_names_can_be_typed(path):
    lines = lines_of_screen(path.read_text(encoding="utf-8").partition("\n")[2], path.name)
    assert [one for line in lines for one in complaints(line, MADE)] == []


def test_the_program_names_no_command_and_no_option_that_it_lacks():
    known, wrong = options_of_all() | ELSEWHERE, []
    for path in sorted((ROOT / "dummydesign").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        wrong += [(path.name, word) for word in NAMED.findall(text) if not word.startswith(COMMANDS)]
        wrong += [(path.name, word) for word in OPTION_HERE.findall(text) if word not in known]
    assert wrong == []


def complaint_of(text: str) -> list[str]:
    return [one for line in lines_of_page(text, "page") for one in complaints(line)]


def test_what_is_missing_is_seen():
    text = "[a](docs/loop.md#no-such) [b](no.md) `--tisue`"
    assert dead_links(ROOT / "README.md", text) == ["docs/loop.md#no-such", "no.md"]
    assert unknown_options(text) == ["--tisue"]
    good = "    dummydesign mold record x --thickness MM --mass G  # as cast"
    assert complaint_of(good) == [] and len(lines_of_page(good, "page")) == 1
    for wrong in (
        "`suggest --tisue palm`",
        "`dummydesign sugest`",
        "    dummydesign suggest --no-cad",
        "    dummydesign suggest --tissue plam",
        "    dummydesign mold recrd x",
        "    dummydesign on-person a.csv --tissue palm --drive steddy",
        "    dummydesign mold --thickness 5 --ratio many",
        "```sh\ndummydesign resins add-hardness --shore-00 S \\\n    --nmae my-batch\n```",
        "`source <(dummydesign completion bosh)`",
    ):
        assert len(complaint_of(wrong)) == 1, wrong
    assert sum(line.whole for lines in LINES.values() for line in lines) > 50


def test_commands_are_found_on_a_screen():
    text = (
        "AMBER   Measure first.\nNEXT    1. dummydesign mold --puck 50x30\n        2. cast it\n"
        "        3. dummydesign suggest --tissue palm --resin \\\n           my-batch\n"
        "MORE    press more people: 'dummydesign tissues\n        add', or print\nWARNING see 'dummydesign sugest'\n"
    )
    found = [(line.text, line.whole) for line in lines_of_screen(text, "screen")]
    assert found == [
        ("mold --puck 50x30", True),
        ("suggest --tissue palm --resin my-batch", True),
        ("tissues add", False),
        ("sugest", False),
    ]
