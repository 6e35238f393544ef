"""Links, commands and options that the documents name are there."""

from __future__ import annotations

import argparse
import re
from functools import cache
from pathlib import Path

import pytest

from dummydesign.cli.entry import parser_of

ROOT = Path(__file__).resolve().parents[1]
TOP = ("README.md", "CONTRIBUTING.md", "VERIFICATION.md")
PAGES = [*(ROOT / name for name in TOP), *sorted((ROOT / "docs").glob("*.md"))]
FENCED = re.compile(r"```.*?```", re.DOTALL)
LINE = re.compile(r"^ *(?:\$ |\S*bin[/\\]|uv run )?dummydesign ([a-z].*)$", re.MULTILINE)
INLINE = re.compile(r"`dummydesign ([a-z][^`]*)`")


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


@cache
def options_of(command: str) -> tuple[set[str], dict[str, set[str]]]:
    """Options of a command, and those of each of its subcommands."""
    own: set[str] = set()
    below: dict[str, set[str]] = {}
    for action in parser_of(command)._actions:
        own |= set(action.option_strings)
        if isinstance(action, argparse._SubParsersAction):
            below = {name: set(one._option_string_actions) for name, one in action.choices.items()}
    return own, below


def unknown_words(text: str) -> list[str]:
    """Commands, subcommands and options of a text that the command line does not know."""
    joined = re.sub(r"\\\n", " ", text)
    plain = re.sub(r"\s+", " ", FENCED.sub("", joined))
    out = []
    for line in [*LINE.findall(joined), *INLINE.findall(plain)]:
        command, *words = line.partition(" #")[0].split()
        try:
            own, below = options_of(command)
        except ModuleNotFoundError:
            out.append(command)
            continue
        second = words[0] if words and below else ""
        if second and second not in below and not second.startswith("-"):
            out.append(f"{command} {second}")
        known = own | below.get(second, set())
        out += [f"{command} {word}" for word in words if word.startswith("--") and word.partition("=")[0] not in known]
    return out


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_commands_of_a_page_are_there(page):
    text = page.read_text(encoding="utf-8")
    assert dead_links(page, text) == []
    assert unknown_words(text) == []


def test_what_is_missing_is_seen():
    text = "[a](docs/loop.md#no-such) [b](no.md) `dummydesign suggest --tisue palm`\n\n    dummydesign mold recrd x\n"
    assert dead_links(ROOT / "README.md", text) == ["docs/loop.md#no-such", "no.md"]
    assert unknown_words(text) == ["mold recrd", "suggest --tisue"]
    assert unknown_words("`dummydesign sugest`") == ["sugest"]
    assert sum(len(LINE.findall(page.read_text(encoding="utf-8"))) for page in PAGES) > 50
